"""Coulomb friction with a tangential spring, as `reference.kernel.laws.sliding`, in force units.

In 2D the tangent t = i n turns with the contact, so a spring that is turned and rescaled is one number: its tension
T = k_t xi (history "sliding", N). The force on i is -F t; D = gamma_t v_t is the dashpot, cut() the Coulomb limit::

    lammps     T += k_t v_t dt;  F = cut(T + D, mu f);  T = F - D
    liggghts   T = T cos(turn) + k_t v_t dt;  T' = cut(T, mu f);  F = T' + (D if T' = T else 0);  T = T'
    talk       F = cut(T + D, mu f);  T = F - D + (k_t v_t dt if nothing was cut else 0)

f is |f_n| in the codes' conventions and max(f_n, 0) in the talks'.

Where nothing touches f_n = v_t = 0, so that T becomes 0: a contact that opens forgets its spring.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.sliding import SpringSliding
from reference.kernel.model import Model
from reference.kernel.program.plane.contacts import PlaneContacts
from reference.kernel.program.program import Program


def spring_sliding(p: Program, law: SpringSliding, c: PlaneContacts, model: Model) -> None:
    """g = f_n + i f_t; c.a carries F, c.b D or the limit."""
    p.effect("sliding friction")
    _ALGORITHMS[law.algorithm](p, law, c, model)
    p.copy(c.f_n, c.g.real)
    p(np.negative, c.a, out=c.g.imag)


def _lammps(p: Program, law: SpringSliding, c: PlaneContacts, model: Model) -> None:
    tension = c.history["sliding"][0]
    _stretch(p, law, c, model, tension)
    dashpot = _dashpot(p, law, c)
    if dashpot is None:
        p.copy(tension, c.a)
    else:
        p(np.add, tension, dashpot, out=c.a)
    _cut(p, law, c, model)
    if dashpot is None:
        p.copy(c.a, tension)
    else:
        p(np.subtract, c.a, dashpot, out=tension)


def _liggghts(p: Program, law: SpringSliding, c: PlaneContacts, model: Model) -> None:
    tension, sticks = c.history["sliding"][0], np.empty(c.count, bool)
    _turn(p, c, tension)
    _stretch(p, law, c, model, tension)
    p.copy(tension, c.a)
    _cut(p, law, c, model)
    dashpot = _dashpot(p, law, c)
    if dashpot is not None:
        p(np.equal, c.a, tension, out=sticks)
        p(np.multiply, dashpot, sticks, out=dashpot)
    p.copy(c.a, tension)
    if dashpot is not None:
        p(np.add, c.a, dashpot, out=c.a)


def _talk(p: Program, law: SpringSliding, c: PlaneContacts, model: Model) -> None:
    tension, test, sticks = c.history["sliding"][0], np.empty(c.count), np.empty(c.count, bool)
    dashpot = _dashpot(p, law, c)
    p.copy(tension, test) if dashpot is None else p(np.add, tension, dashpot, out=test)
    p.copy(test, c.a)
    _cut(p, law, c, model)
    p(np.equal, c.a, test, out=sticks)
    p.copy(c.a, tension) if dashpot is None else p(np.subtract, c.a, dashpot, out=tension)
    p(np.multiply, c.v_t, law.shear_stiffness * model.dt, out=test)
    p(np.multiply, test, sticks, out=test)
    p(np.add, tension, test, out=tension)


_ALGORITHMS = {"lammps": _lammps, "liggghts": _liggghts, "talk": _talk}


def _stretch(p: Program, law: SpringSliding, c: PlaneContacts, model: Model, tension: np.ndarray) -> None:
    p(np.multiply, c.v_t, law.shear_stiffness * model.dt, out=c.a)
    p(np.add, tension, c.a, out=tension)


def _dashpot(p: Program, law: SpringSliding, c: PlaneContacts) -> np.ndarray | None:
    """D in a buffer of its own; None without dashpot."""
    if not law.shear_damping:
        return None
    dashpot = np.empty(c.count)
    p(np.multiply, c.v_t, law.shear_damping, out=dashpot)
    return dashpot


def _cut(p: Program, law: SpringSliding, c: PlaneContacts, model: Model) -> None:
    """c.a cut to [-mu f, mu f]."""
    if model.convention.limit == "absolute":
        p(np.abs, c.f_n, out=c.b)
    else:
        p(np.maximum, c.f_n, 0.0, out=c.b)
    p(np.multiply, c.b, law.shear_friction, out=c.b)
    p(np.minimum, c.a, c.b, out=c.a)
    p(np.negative, c.b, out=c.b)
    p(np.maximum, c.a, c.b, out=c.a)


def _turn(p: Program, c: PlaneContacts, tension: np.ndarray) -> None:
    """T cos(turn), cos = Re(n conj(n_before)); then `before` becomes the normal of now."""
    before = c.normal_before
    p(np.conjugate, before, out=before)
    p(np.multiply, before, c.normal, out=before)
    p(np.multiply, tension, before.real, out=tension)
    p.copy(c.normal, before)
