"""Geometry and kinematics of contacts in 3D, and the sums to the nodes, component by component.

Per pair, with d = x_i - x_j (at a wall: its part along the wall's normal)::

    delta = R_i + R_j - |d|,    n = d/|d|,    v_n = (v_i - v_j).n
    force on i: f_n n + f_t = f_n n - shear
"""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.program.buffers import lined_up
from reference.kernel.program.program import Program
from reference.kernel.program.space.contacts import SpaceContacts
from reference.kernel.program.space.nodes import SpaceNodes
from reference.kernel.program.vectors import dot


def overlaps_and_normals(p: Program, model: Model, nodes: SpaceNodes, c: SpaceContacts, *, masked: bool) -> None:
    """overlap, 0 where nothing touches, and normal. masked: touching as well, and there the normal is 0."""
    distance, inverse = c.a, c.b
    p.effect("normal contact")
    _differences(p, nodes.x, c, out=c.normal)
    _nearest_images(p, model, nodes, c)
    for wall_normal, pairs in c.wall_parts(model):
        _along_wall_normal(p, wall_normal, c.normal[:, pairs], c.a[pairs], c.b[pairs])
    dot(p, c.normal, c.normal, c.z, out=distance)
    p(np.sqrt, distance, out=distance)
    p(np.subtract, c.radius_sum, distance, out=c.overlap)
    if masked:
        c.touching, touches = c.buffer("touching"), c.buffer("touches", dtype=bool)
        p(np.greater, c.overlap, 0.0, out=touches)
        p.copy(touches, c.touching)
        p(np.divide, c.touching, distance, out=inverse)
        p(np.multiply, c.overlap, c.touching, out=c.overlap)
    else:
        p(np.reciprocal, distance, out=inverse)
        p(np.maximum, c.overlap, 0.0, out=c.overlap)
    p(np.multiply, c.normal, inverse, out=c.normal)


def relative_velocities(p: Program, nodes: SpaceNodes, c: SpaceContacts) -> None:
    """u = v_i - v_j of the centres; v_n, its part along n, 0 where nothing touches because the normal is."""
    _differences(p, nodes.c, c, out=c.u)
    dot(p, c.u, c.normal, c.z, out=c.v_n)


def sum_forces(p: Program, nodes: SpaceNodes, c: SpaceContacts) -> None:
    """Add f_n n - shear to the nodes i and take it from the nodes j."""
    p.effect("sum")
    p(np.multiply, c.normal, c.f_n, out=c.z)
    p(np.subtract, c.z, c.shear, out=c.force)
    _to_nodes(p, nodes, c)


def sum_normal_forces(p: Program, nodes: SpaceNodes, c: SpaceContacts) -> None:
    """The same without tangential forces."""
    p.effect("sum")
    p(np.multiply, c.normal, c.f_n, out=c.force)
    _to_nodes(p, nodes, c)


def _differences(p: Program, of_nodes: np.ndarray, c: SpaceContacts, out: np.ndarray) -> None:
    """out = value of i - value of j, axis by axis."""
    ends = c.ends_buffer("ends")
    for axis in range(3):
        p.take(of_nodes[axis], c.ends, ends)
        p(np.subtract, ends[1], ends[0], out=out[axis])


def _to_nodes(p: Program, nodes: SpaceNodes, c: SpaceContacts) -> None:
    """First to the nodes j, then to the nodes i: so the order at a node is that of the list, block by block."""
    for axis in range(3):
        p.scatter(np.subtract, nodes.f[axis], c.j, c.force[axis])
        p.scatter(np.add, nodes.f[axis], c.i, c.force[axis])


def _nearest_images(p: Program, model: Model, nodes: SpaceNodes, c: SpaceContacts) -> None:
    """Shift pairs across a periodic axis; which image is nearest cannot change before the list is renewed."""
    if model.periodic is None:
        return
    p.effect("periodic axes")
    for axis, length in enumerate(model.periodic):
        if length > 0:
            shift = np.zeros(c.count)
            pairs = c.particle_pairs
            apart = nodes.x[axis][c.i[pairs]] - nodes.x[axis][c.j[pairs]]
            shift[pairs] = -length * np.round(apart / length)
            p(np.add, c.normal[axis], lined_up(shift), out=c.normal[axis])
    p.effect("normal contact")


def _along_wall_normal(p: Program, n: tuple[float, ...], d: np.ndarray, a: np.ndarray, b: np.ndarray) -> None:
    """Keep the part of d along n; across an axis that is a matter of one component."""
    across = [axis for axis in range(3) if n[axis] != 0.0]
    if len(across) == 1:
        for axis in set(range(3)) - set(across):
            p.fill(d[axis], 0.0)
        return
    p(np.multiply, d[0], n[0], out=a)
    for axis in (1, 2):
        p(np.multiply, d[axis], n[axis], out=b)
        p(np.add, a, b, out=a)
    for axis in range(3):
        p(np.multiply, a, n[axis], out=d[axis])
