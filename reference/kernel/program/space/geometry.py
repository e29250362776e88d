"""Geometry and kinematics of contacts in 3D, and the sums to the nodes, component by component.

Per pair, with d = x_i - x_j (at a wall: its part along the wall's normal)::

    delta = R_i + R_j - |d|,    n = d/|d|,    v_n = (v_i - v_j).n
    slip:   v_t = v_i - v_j - v_n n - (a_i omega_i + a_j omega_j) x n,   a = R, or R - delta/2
    force on i: f_n n + f_t,   torque on i: -a_i n x f_t,   torque on j: -a_j n x f_t
"""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.program.arms import LeverArms
from reference.kernel.program.program import Program
from reference.kernel.program.space.contacts import SpaceContacts
from reference.kernel.program.space.nodes import SpaceNodes

CYCLIC = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def overlaps_and_normals(p: Program, model: Model, nodes: SpaceNodes, c: SpaceContacts) -> None:
    """overlap (0 where nothing touches), touches, normal."""
    p.effect("normal contact")
    _differences(p, nodes.x, c, c.normal)
    _nearest_images(p, model, nodes, c)
    for k, pairs in c.wall_slices.items():
        _along_wall_normal(p, model.walls[k].normal, c.normal[:, pairs], c.a[pairs], c.b[pairs])
    dot(p, c.normal, c.normal, c.z, out=c.distance)
    p(np.sqrt, c.distance, out=c.distance)
    p(np.subtract, c.radius_sum, c.distance, out=c.overlap)
    p(np.greater, c.overlap, 0.0, out=c.touches)
    p(np.maximum, c.overlap, 0.0, out=c.overlap)
    p(np.reciprocal, c.distance, out=c.distance)
    p(np.multiply, c.normal, c.distance, out=c.normal)


def relative_velocities(p: Program, nodes: SpaceNodes, c: SpaceContacts) -> None:
    """v_t = v_i - v_j of the centres and v_n, its part along n."""
    _differences(p, nodes.c, c, c.v_t)
    dot(p, c.v_t, c.normal, c.z, out=c.v_n)


def slip_velocities(p: Program, nodes: SpaceNodes, c: SpaceContacts, arms: LeverArms | None) -> None:
    """v_t -= v_n n + (a_i omega_i + a_j omega_j) x n; with arms None the nodes carry R omega."""
    p(np.multiply, c.normal, c.v_n, out=c.z)
    p(np.subtract, c.v_t, c.z, out=c.v_t)
    turning = np.empty_like(c.z)
    for axis in range(3):
        p.take(nodes.s[axis], c.i, turning[axis])
        p.take(nodes.s[axis], c.j, c.z[axis])
    if arms is not None:
        p(np.multiply, turning, arms.i, out=turning)
        p(np.multiply, c.z, arms.j, out=c.z)
    p(np.add, turning, c.z, out=turning)
    cross(p, turning, c.normal, c.a, out=c.z)
    p(np.subtract, c.v_t, c.z, out=c.v_t)
    if c.smooth_pairs.start < c.smooth_pairs.stop:
        p.fill(c.v_t[:, c.smooth_pairs], 0.0)


def still_where_apart(p: Program, c: SpaceContacts) -> None:
    """No velocities where nothing touches."""
    p(np.multiply, c.v_n, c.touches, out=c.v_n)
    p(np.multiply, c.v_t, c.touches, out=c.v_t)


def sum_forces(p: Program, nodes: SpaceNodes, c: SpaceContacts) -> None:
    """Add to the nodes i and take from the nodes j: g is f_t and becomes f_n n + f_t."""
    p.effect("sum")
    p(np.multiply, c.normal, c.f_n, out=c.z)
    p(np.add, c.g, c.z, out=c.g)
    _to_nodes(p, nodes.f, c, c.g)


def sum_normal_forces(p: Program, nodes: SpaceNodes, c: SpaceContacts) -> None:
    """The same without tangential forces."""
    p.effect("sum")
    p(np.multiply, c.normal, c.f_n, out=c.g)
    _to_nodes(p, nodes.f, c, c.g)


def sum_torques(p: Program, nodes: SpaceNodes, c: SpaceContacts, arms: LeverArms) -> None:
    """m -= a n x f at both ends; f_n n does not count in the product."""
    moment = np.empty_like(c.z)
    cross(p, c.g, c.normal, c.a, out=moment)
    for index, arm in ((c.i, arms.i), (c.j, arms.j)):
        p(np.multiply, moment, arm, out=c.z)
        for axis in range(3):
            p.scatter(np.add, nodes.m[axis], index, c.z[axis])


def dot(p: Program, u: np.ndarray, v: np.ndarray, work: np.ndarray, out: np.ndarray) -> None:
    """out = u.v, column by column; work: (3, P)."""
    p(np.multiply, u, v, out=work)
    p(np.add, work[0], work[1], out=out)
    p(np.add, out, work[2], out=out)


def cross(p: Program, u: np.ndarray, v: np.ndarray, work: np.ndarray, out: np.ndarray) -> None:
    """out = u x v, column by column; work: (P,)."""
    for x, y, z in CYCLIC:
        p(np.multiply, u[y], v[z], out=out[x])
        p(np.multiply, u[z], v[y], out=work)
        p(np.subtract, out[x], work, out=out[x])


def _differences(p: Program, of_nodes: np.ndarray, c: SpaceContacts, out: np.ndarray) -> None:
    for axis in range(3):
        p.take(of_nodes[axis], c.i, out[axis])
        p.take(of_nodes[axis], c.j, c.z[axis])
    p(np.subtract, out, c.z, out=out)


def _to_nodes(p: Program, nodes: np.ndarray, c: SpaceContacts, values: np.ndarray) -> None:
    for axis in range(3):
        p.scatter(np.add, nodes[axis], c.i, values[axis])
        p.scatter(np.subtract, nodes[axis], c.j, values[axis])


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
            p(np.add, c.normal[axis], shift, out=c.normal[axis])
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
