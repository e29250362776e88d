"""Geometry and kinematics of contacts in 2D, and the sums to the nodes, in complex numbers.

Per pair, with d = x_i - x_j (at a wall: its part along the wall's normal)::

    delta = R_i + R_j - |d|,    n = d/|d|,    u = (v_i - v_j) conj(n) = v_n + i v_t
    force on i: (f_n + i f_t) n = (f_n - i shear) n
"""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.program.buffers import lined_up
from reference.kernel.program.plane.contacts import PlaneContacts
from reference.kernel.program.plane.nodes import PlaneNodes
from reference.kernel.program.program import Program


def overlaps_and_normals(p: Program, model: Model, nodes: PlaneNodes, c: PlaneContacts, *, masked: bool) -> None:
    """overlap, 0 where nothing touches, and normal = conj(n). masked: touching as well, and there the normal is 0."""
    distance = c.a
    p.effect("normal contact")
    _difference(p, nodes.q, c, out=c.normal)
    _nearest_images(p, model, nodes, c)
    for normal, pairs in c.wall_parts(model):
        _along_wall_normal(p, complex(*normal), c.normal[pairs], c.u[pairs])
    p(np.abs, c.normal, out=distance)
    p(np.subtract, c.radius_sum, distance, out=c.overlap)
    if masked:
        c.touching, touches = c.buffer("touching"), c.buffer("touches", dtype=bool)
        p(np.greater, c.overlap, 0.0, out=touches)
        p.copy(touches, c.touching)
        p(np.divide, c.touching, distance, out=c.inverse.real)
        p(np.multiply, c.overlap, c.touching, out=c.overlap)
    else:
        p(np.reciprocal, distance, out=c.inverse.real)
        p(np.maximum, c.overlap, 0.0, out=c.overlap)
    p(np.multiply, c.normal, c.inverse, out=c.normal)


def relative_velocities(p: Program, nodes: PlaneNodes, c: PlaneContacts) -> None:
    """u = v_n + i v_t of the centres, 0 where nothing touches because the normal is."""
    _difference(p, nodes.c, c, out=c.u)
    p(np.multiply, c.u, c.normal, out=c.u)


def sum_forces(p: Program, nodes: PlaneNodes, c: PlaneContacts) -> None:
    """Add conj(force) = (f_n + i shear) conj(n) to the nodes i and take it from the nodes j."""
    p.effect("sum")
    if c.pull is None:
        p.copy(c.f_n, c.u.real)
    else:
        p(np.subtract, c.f_n, c.pull, out=c.u.real)
    p.copy(c.shear, c.u.imag)
    p(np.multiply, c.u, c.normal, out=c.force)
    _to_nodes(p, nodes, c)


def sum_normal_forces(p: Program, nodes: PlaneNodes, c: PlaneContacts) -> None:
    """The same without tangential forces: f_n is real."""
    p.effect("sum")
    p(np.multiply, c.normal, c.f_n, out=c.force)
    _to_nodes(p, nodes, c)


def _difference(p: Program, of_nodes: np.ndarray, c: PlaneContacts, out: np.ndarray) -> None:
    """out = value of i - value of j."""
    ends = c.ends_buffer("complex ends", complex)
    p.take(of_nodes, c.ends, ends)
    p(np.subtract, ends[1], ends[0], out=out)


def _to_nodes(p: Program, nodes: PlaneNodes, c: PlaneContacts) -> None:
    """First to the nodes j, then to the nodes i: so the order at a node is that of the list, block by block."""
    p.scatter(np.subtract, nodes.f, c.j, c.force)
    p.scatter(np.add, nodes.f, c.i, c.force)


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
    p(np.add, c.normal, lined_up(shift), out=c.normal)
    p.effect("normal contact")


def _along_wall_normal(p: Program, n: complex, d: np.ndarray, work: np.ndarray) -> None:
    """Keep the part of d (conjugate) along n; across an axis that is a matter of one component."""
    if n.real == 0.0 or n.imag == 0.0:
        p.fill(d.imag if n.imag == 0.0 else d.real, 0.0)
        return
    p(np.multiply, d, n, out=work)
    p(np.multiply, work.real, n.conjugate(), out=d)
