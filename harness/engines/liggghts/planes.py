"""Which walls LIGGGHTS can hold as primitive planes, and the triangles that stand for the others.

A primitive plane is exact and cheap, but lies across an axis and cannot move. Any other wall is a
triangle mesh. One triangle without inner edges, larger than the whole domain, is a plane: the
contact code then only ever meets its face. Only where the plane runs along a periodic axis it must
be tiled: two triangles that fill the domain's cross-section exactly; LIGGGHTS joins their images.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from harness.engines.facts import is_periodic, is_rough
from harness.engines.text import numbers
from harness.scene.system import Constant, System, Wall


def across_axis(wall: Wall) -> int | None:
    """Return the axis the plane lies across, None for an oblique plane."""
    axes = np.flatnonzero(wall.normal)
    return int(axes[0]) if len(axes) == 1 else None


def normal_speed(wall: Wall) -> float:
    """Return the speed along the normal of a wall with constant velocity, else 0."""
    return float(np.dot(wall.motion.velocity, wall.normal)) if isinstance(wall.motion, Constant) else 0.0


def slip_velocity(system: System, wall: Wall) -> np.ndarray:
    """Return the velocity (dim,) in the plane that a rough wall has; zero for a smooth one, which shows none."""
    if not isinstance(wall.motion, Constant) or not is_rough(system, wall):
        return np.zeros(system.dimension)
    return np.subtract(wall.motion.velocity, normal_speed(wall) * np.array(wall.normal))


def mesh_velocity(system: System, wall: Wall) -> np.ndarray:
    """Return the velocity (dim,) of the mesh of a wall with constant velocity."""
    return normal_speed(wall) * np.array(wall.normal) + slip_velocity(system, wall)


def is_still(wall: Wall) -> bool:
    """Does the plane stay where it is? It may slip within itself."""
    return wall.motion is None or (isinstance(wall.motion, Constant) and normal_speed(wall) == 0.0)


def is_primitive(system: System, wall: Wall) -> bool:
    """Can the wall be a primitive plane? They slip along one axis only."""
    slips = np.count_nonzero(slip_velocity(system, wall))
    return is_still(wall) and across_axis(wall) is not None and slips <= 1


def primitives(system: System) -> list[Wall]:
    """Return the walls that are primitive planes."""
    return [w for w in system.walls if is_primitive(system, w)]


def meshes(system: System) -> list[Wall]:
    """Return the walls that are triangle meshes; their order is that of `fix wall/gran ... meshes`."""
    return [w for w in system.walls if not is_primitive(system, w)]


def anchor(system: System, wall: Wall) -> np.ndarray:
    """Return the point (dim,) of the plane nearest to the middle of the particles: the mesh's centre."""
    middle = 0.5 * (system.particles.x.min(axis=0) + system.particles.x.max(axis=0))
    return middle - np.dot(middle - wall.point, wall.normal) * np.array(wall.normal)


def stl(system: System, wall: Wall, bounds: np.ndarray) -> str:
    """Return the mesh of a wall as STL text; bounds (3, 2) are those of the domain."""
    facets = [_facet(wall, corners) for corners in triangles(system, wall, bounds)]
    return "\n".join([f"solid {wall.name}", *facets, f"endsolid {wall.name}"]) + "\n"


def triangles(system: System, wall: Wall, bounds: np.ndarray) -> list[np.ndarray]:
    """Return the triangles of a wall's mesh, arrays (3 corners, 3)."""
    if any(is_periodic(system, a) and wall.normal[a] == 0.0 for a in range(system.dimension)):
        return _tiles(wall, bounds)
    return [_triangle(system, wall, bounds)]


def reach(bounds: np.ndarray, dimension: int) -> float:
    """Return the radius around an anchor that a mesh has to cover: the diagonal of the domain, m.

    LIGGGHTS refuses meshes smaller than 1e-4 m, whatever the particles are.
    """
    return max(float(np.linalg.norm(np.diff(bounds[:dimension], axis=1))), 1e-3)


def _triangle(system: System, wall: Wall, bounds: np.ndarray) -> np.ndarray:
    """Return an equilateral triangle whose incircle covers the domain and whose centre is the anchor.

    Its corners may lie outside the domain, its centre may not.
    """
    radius = reach(bounds, system.dimension)
    first, second = _in_plane(_in_space(wall.normal))
    centre = _in_space(anchor(system, wall))
    side = np.sqrt(3.0) * radius
    return np.array([
        centre - side * first - radius * second,
        centre + side * first - radius * second,
        centre + 2.0 * radius * second,
    ])


def _tiles(wall: Wall, bounds: np.ndarray) -> list[np.ndarray]:
    """Return two triangles that fill the cross-section of the domain (a slice of it along a 2D z axis)."""
    bounds = bounds.copy()
    if len(wall.normal) == 2:
        bounds[2] *= 0.5
    axis = across_axis(wall)
    a, b = (k for k in range(3) if k != axis)
    corner = np.empty((2, 2, 3))
    corner[..., axis] = wall.point[axis]
    corner[..., a] = bounds[a][:, None]
    corner[..., b] = bounds[b][None, :]
    low, right, left, high = corner.reshape(4, 3)
    return [np.array([low, right, high]), np.array([low, high, left])]


def _in_plane(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors that span the plane; a 2D plane is spanned by its line and z."""
    axis = np.eye(3)[2] if normal[2] == 0.0 else np.eye(3)[int(np.argmin(np.abs(normal)))]
    first = np.cross(axis, normal)
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)


def space(vector: Iterable[float]) -> str:
    """Return a vector of the system as the three numbers LIGGGHTS wants."""
    return numbers(_in_space(vector))


def _in_space(vector) -> np.ndarray:
    return np.pad(np.asarray(vector, dtype=float), (0, 3 - len(vector)))


def _facet(wall: Wall, corners: np.ndarray) -> str:
    vertices = "\n".join(f"    vertex {numbers(c)}" for c in corners)
    return f"facet normal {space(wall.normal)}\n  outer loop\n{vertices}\n  endloop\nendfacet"
