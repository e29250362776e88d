"""Deck lines for the walls themselves: primitive planes, meshes, and the contact law at them.

Only one `fix wall/gran ... mesh` may exist, for all meshes together; it is called `meshes`. The force
on each of them comes from its own `mesh/surface/stress`.
"""

from __future__ import annotations

import numpy as np

from harness.engines.facts import is_rough
from harness.engines.liggghts.law import model_words, setting_words, wall_type
from harness.engines.liggghts.planes import across_axis, is_still, meshes, primitives, slip_velocity, space
from harness.engines.text import number
from harness.scene.system import System, Wall


def wall_lines(system: System) -> list[str]:
    """Return all walls at their places at step 0; `motions` moves them."""
    lines: list[str] = []
    if primitives(system):
        lines += ["", "# fixed planes", *(_primitive(system, w) for w in primitives(system))]
    if meshes(system):
        lines += ["", "# moving or oblique planes, as triangles", *(_mesh(system, w) for w in meshes(system)),
                  _mesh_contact(system)]
    return lines


def grains_have_wall_forces(system: System, wall: Wall) -> bool:
    """Does LIGGGHTS keep the force of this wall on each particle? Meshes only if contacts are asked for."""
    return wall in primitives(system) or system.contacts


def shares_are_unclear(system: System) -> bool:
    """Can the force of all meshes on one particle not be told apart by their normals alone?"""
    walls = meshes(system)
    rank = np.linalg.matrix_rank(np.array([w.normal for w in walls])) if walls else 0
    return rank < len(walls) or any(is_rough(system, w) for w in walls)


def _primitive(system: System, wall: Wall) -> str:
    axis, slip = across_axis(wall), slip_velocity(system, wall)
    shear = "".join(f" shear {'xyz'[a]} {number(slip[a])}" for a in np.flatnonzero(slip))
    return (
        f"fix {wall.name}_plane grains wall/gran {model_words(system, rough=is_rough(system, wall))} primitive type"
        f" {wall_type(system, wall)} {'xyz'[axis]}plane {number(wall.point[axis])} store_force yes{shear}"
        f" {setting_words(system)}".rstrip()
    )


def _mesh(system: System, wall: Wall) -> str:
    """Return the mesh; one that slips in place carries its particles like a conveyor."""
    slip = slip_velocity(system, wall)
    belt = f" surface_vel {space(slip)}" if is_still(wall) and np.any(slip) else ""
    kind = wall_type(system, wall)
    return f"fix {wall.name}_mesh grains mesh/surface/stress file {wall.name}.stl type {kind}{belt}"


def _mesh_contact(system: System) -> str:
    walls = meshes(system)
    rough = any(is_rough(system, w) for w in walls)
    names = f"{len(walls)} meshes {' '.join(f'{w.name}_mesh' for w in walls)}"
    store = " store_force yes" if system.contacts else ""
    return (
        f"fix meshes grains wall/gran {model_words(system, rough=rough)} mesh n_meshes {names}{store}"
        f" {setting_words(system)}".rstrip()
    )
