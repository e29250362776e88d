"""Coulomb friction with a tangential spring in 3D, as `reference.kernel.laws.slider`, in force units.

T = k_t xi (history "sliding", 3 rows, N) is the spring's tension, D = gamma_t v_t the dashpot, f the base of the
limit (|f_n|, or max(f_n, 0) in the talks' convention). The force on i is -F::

    lammps     T turned into the tangent plane, its length kept (only where |T.n| > 1e-10 mu f);  T += k_t v_t dt;
               F = cut(T + D, mu f);  T = F - D
    liggghts   T += k_t v_t dt;  T -= (T.n) n;  T' = cut(T, mu f);  F = T' + (D if T' = T else 0);  T = T'
    talk       T turned, length kept;  F = cut(T + D, mu f);  T = F - D + (k_t v_t dt if nothing was cut else 0)

Where nothing touches f_n = v_t = 0, so that T becomes 0: a contact that opens forgets its spring.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.slider import LAMMPS_TURN_THRESHOLD
from reference.kernel.laws.sliding import SpringSliding
from reference.kernel.model import Model
from reference.kernel.program.program import Program
from reference.kernel.program.space.contacts import SpaceContacts
from reference.kernel.program.space.geometry import dot

TINY = 1e-200
"""Keeps quotients of zeros finite; no force of interest is as small."""


def spring_sliding(p: Program, law: SpringSliding, c: SpaceContacts, model: Model) -> None:
    """g = f_t."""
    p.effect("sliding friction")
    limit = np.empty(c.count)
    _limit(p, law, c, model, limit)
    _ALGORITHMS[law.algorithm](p, law, c, model.dt, limit)
    p(np.negative, c.g, out=c.g)


def _lammps(p: Program, law: SpringSliding, c: SpaceContacts, dt: float, limit: np.ndarray) -> None:
    tension = c.history["sliding"]
    _turn(p, c, tension, keep_length=True, limit=limit)
    _stretch(p, law, c, dt, tension)
    dashpot = _dashpot(p, law, c)
    _sum(p, tension, dashpot, c.g)
    p(np.multiply, c.g, _cut(p, c, limit), out=c.g)
    _without(p, c.g, dashpot, tension)


def _liggghts(p: Program, law: SpringSliding, c: SpaceContacts, dt: float, limit: np.ndarray) -> None:
    tension, sticks = c.history["sliding"], np.empty(c.count, bool)
    _stretch(p, law, c, dt, tension)
    _turn(p, c, tension, keep_length=False, limit=None)
    p.copy(tension, c.g)
    factor = _cut(p, c, limit)
    p(np.multiply, tension, factor, out=tension)
    dashpot = _dashpot(p, law, c)
    if dashpot is not None:
        p(np.equal, factor, 1.0, out=sticks)
        p(np.multiply, dashpot, sticks, out=dashpot)
    _sum(p, tension, dashpot, c.g)


def _talk(p: Program, law: SpringSliding, c: SpaceContacts, dt: float, limit: np.ndarray) -> None:
    tension, sticks, growth = c.history["sliding"], np.empty(c.count, bool), np.empty((3, c.count))
    _turn(p, c, tension, keep_length=True, limit=None)
    dashpot = _dashpot(p, law, c)
    _sum(p, tension, dashpot, c.g)
    factor = _cut(p, c, limit)
    p(np.multiply, c.g, factor, out=c.g)
    _without(p, c.g, dashpot, tension)
    p(np.equal, factor, 1.0, out=sticks)
    p(np.multiply, c.v_t, law.shear_stiffness * dt, out=growth)
    p(np.multiply, growth, sticks, out=growth)
    p(np.add, tension, growth, out=tension)


_ALGORITHMS = {"lammps": _lammps, "liggghts": _liggghts, "talk": _talk}


def _limit(p: Program, law: SpringSliding, c: SpaceContacts, model: Model, limit: np.ndarray) -> None:
    if model.convention.limit == "absolute":
        p(np.abs, c.f_n, out=limit)
    else:
        p(np.maximum, c.f_n, 0.0, out=limit)
    p(np.multiply, limit, law.shear_friction, out=limit)


def _turn(p: Program, c: SpaceContacts, tension: np.ndarray, *, keep_length: bool, limit: np.ndarray | None) -> None:
    """T -= (T.n) n, then T *= |T before|/|T|; with a limit only where the part along n matters, as LAMMPS does."""
    before = np.empty(c.count)
    if keep_length:
        dot(p, tension, tension, c.z, out=before)
    dot(p, tension, c.normal, c.z, out=c.a)
    if limit is not None:
        matters = np.empty(c.count, bool)
        p(np.multiply, limit, LAMMPS_TURN_THRESHOLD, out=c.b)
        p(np.abs, c.a, out=c.distance)
        p(np.greater, c.distance, c.b, out=matters)
        p(np.multiply, c.a, matters, out=c.a)
    p(np.multiply, c.normal, c.a, out=c.z)
    p(np.subtract, tension, c.z, out=tension)
    if keep_length:
        dot(p, tension, tension, c.z, out=c.a)
        p(np.maximum, c.a, TINY, out=c.a)
        p(np.divide, before, c.a, out=c.a)
        p(np.sqrt, c.a, out=c.a)
        p(np.multiply, tension, c.a, out=tension)


def _stretch(p: Program, law: SpringSliding, c: SpaceContacts, dt: float, tension: np.ndarray) -> None:
    p(np.multiply, c.v_t, law.shear_stiffness * dt, out=c.z)
    p(np.add, tension, c.z, out=tension)


def _dashpot(p: Program, law: SpringSliding, c: SpaceContacts) -> np.ndarray | None:
    """D in a buffer of its own; None without dashpot."""
    if not law.shear_damping:
        return None
    dashpot = np.empty((3, c.count))
    p(np.multiply, c.v_t, law.shear_damping, out=dashpot)
    return dashpot


def _cut(p: Program, c: SpaceContacts, limit: np.ndarray) -> np.ndarray:
    """Return min(1, limit/|g|), (P,): exactly 1 where nothing is cut."""
    factor = c.b
    dot(p, c.g, c.g, c.z, out=factor)
    p(np.sqrt, factor, out=factor)
    p(np.maximum, factor, TINY, out=factor)
    p(np.divide, limit, factor, out=factor)
    p(np.minimum, factor, 1.0, out=factor)
    return factor


def _sum(p: Program, tension: np.ndarray, dashpot: np.ndarray | None, out: np.ndarray) -> None:
    if dashpot is None:
        p.copy(tension, out)
    else:
        p(np.add, tension, dashpot, out=out)


def _without(p: Program, force: np.ndarray, dashpot: np.ndarray | None, out: np.ndarray) -> None:
    if dashpot is None:
        p.copy(force, out)
    else:
        p(np.subtract, force, dashpot, out=out)
