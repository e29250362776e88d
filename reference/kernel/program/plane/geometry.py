"""Geometry and kinematics of contacts in 2D, and the sums to the nodes, in complex numbers.

Per pair, with d = x_i - x_j (at a wall: its part along the wall's normal)::

    delta = R_i + R_j - |d|,    n = d/|d|,    u = (v_i - v_j) conj(n) = v_n + i v_t
    slip:   v_t -= a_i omega_i + a_j omega_j,   a = R, or R - delta/2
    force on i: (f_n + i f_t) n,   torque on i: -a_i f_t,   torque on j: -a_j f_t
"""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.program.arms import LeverArms
from reference.kernel.program.plane.contacts import PlaneContacts
from reference.kernel.program.plane.nodes import PlaneNodes
from reference.kernel.program.program import Program


def overlaps_and_normals(p: Program, model: Model, nodes: PlaneNodes, c: PlaneContacts) -> None:
    """overlap (0 where nothing touches), touches, normal = conj(n)."""
    p.effect("normal contact")
    p.take(nodes.q, c.i, c.normal)
    p.take(nodes.q, c.j, c.z)
    p(np.subtract, c.normal, c.z, out=c.normal)
    _nearest_images(p, model, nodes, c)
    for k, pairs in c.wall_slices.items():
        _along_wall_normal(p, complex(*model.walls[k].normal), c.normal[pairs], c.z[pairs])
    p(np.abs, c.normal, out=c.distance)
    p(np.subtract, c.radius_sum, c.distance, out=c.overlap)
    p(np.greater, c.overlap, 0.0, out=c.touches)
    p(np.maximum, c.overlap, 0.0, out=c.overlap)
    p(np.reciprocal, c.distance, out=c.distance)
    p(np.multiply, c.normal, c.distance, out=c.normal)


def relative_velocities(p: Program, nodes: PlaneNodes, c: PlaneContacts) -> None:
    """u = v_n + i v_t of the centres; needed as soon as any force depends on velocity."""
    p.take(nodes.c, c.i, c.u)
    p.take(nodes.c, c.j, c.z)
    p(np.subtract, c.u, c.z, out=c.u)
    p(np.multiply, c.u, c.normal, out=c.u)


def slip_velocities(p: Program, nodes: PlaneNodes, c: PlaneContacts, arms: LeverArms | None) -> None:
    """v_t -= a_i omega_i + a_j omega_j; with arms None the nodes carry R omega. Smooth walls see no slip."""
    p.take(nodes.s, c.i, c.a)
    p.take(nodes.s, c.j, c.b)
    if arms is not None:
        p(np.multiply, c.a, arms.i, out=c.a)
        p(np.multiply, c.b, arms.j, out=c.b)
    p(np.add, c.a, c.b, out=c.a)
    p(np.subtract, c.v_t, c.a, out=c.v_t)
    if c.smooth_pairs.start < c.smooth_pairs.stop:
        p.fill(c.v_t[c.smooth_pairs], 0.0)


def still_where_apart(p: Program, c: PlaneContacts) -> None:
    """No velocities where nothing touches."""
    p(np.multiply, c.u, c.touches, out=c.u)


def sum_forces(p: Program, nodes: PlaneNodes, c: PlaneContacts) -> None:
    """Add conj(g n) to the nodes i and take it from the nodes j; g = f_n + i f_t is conjugated in place."""
    p.effect("sum")
    p(np.conjugate, c.g, out=c.g)
    p(np.multiply, c.g, c.normal, out=c.z)
    p.scatter(np.add, nodes.f, c.i, c.z)
    p.scatter(np.subtract, nodes.f, c.j, c.z)


def sum_normal_forces(p: Program, nodes: PlaneNodes, c: PlaneContacts) -> None:
    """The same without tangential forces: f_n is real."""
    p.effect("sum")
    p(np.multiply, c.normal, c.f_n, out=c.z)
    p.scatter(np.add, nodes.f, c.i, c.z)
    p.scatter(np.subtract, nodes.f, c.j, c.z)


def sum_torques(p: Program, nodes: PlaneNodes, c: PlaneContacts, arms: LeverArms) -> None:
    """m -= a f_t at both ends; g has been conjugated, so its imaginary part is -f_t already."""
    for index, arm in ((c.i, arms.i), (c.j, arms.j)):
        p(np.multiply, c.g.imag, arm, out=c.a)
        p.scatter(np.add, nodes.m, index, c.a)


def _nearest_images(p: Program, model: Model, nodes: PlaneNodes, c: PlaneContacts) -> None:
    """Shift pairs across a periodic axis; which image is nearest cannot change before the list is renewed."""
    if model.periodic is None:
        return
    d = nodes.q[c.i] - nodes.q[c.j]
    shift = np.zeros(c.count, complex)
    for length, part, out in zip(model.periodic, (d.real, d.imag), (shift.real, shift.imag), strict=True):
        if length > 0:
            out[c.particle_pairs] = -length * np.round(part[c.particle_pairs] / length)
    p.effect("periodic axes")
    p(np.add, c.normal, shift, out=c.normal)
    p.effect("normal contact")


def _along_wall_normal(p: Program, n: complex, d: np.ndarray, work: np.ndarray) -> None:
    """Keep the part of d (conjugate) along n; across an axis that is a matter of one component."""
    if n.real == 0.0 or n.imag == 0.0:
        p.fill(d.imag if n.imag == 0.0 else d.real, 0.0)
        return
    p(np.multiply, d, n, out=work)
    p(np.multiply, work.real, n.conjugate(), out=d)
