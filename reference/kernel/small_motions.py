"""The contacts of now as springs and dashpots: what small motions about this moment do, contact by contact.

A contact of unit normal n, arms a_i, a_j and a* answers to these rates of the velocities v and spins w of its bodies::

    normal      n.(v_i - v_j)                                      its force along n
    sliding     (1 - n n)(v_i - v_j) - (a_i w_i + a_j w_j) x n     a force across n, and its couples on the arms
    rolling     a* (w_i - w_j) x n                                 couples across n
    torsion     a* n.(w_i - w_j)                                   couples along n

(those of `reference.analytic.packing_modes`, for displacements). With numbers s_c by family, `Operator` is the matrix
of v.B v = sum_c s_c |rate_c|^2 - drag |v|^2, over the square roots of the masses. Only families that the model has
exist. Walls and glued discs count as fixed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from reference.kernel.guards import FAMILIES, friction_of
from reference.kernel.interactions import Forces, Interaction, summed
from reference.kernel.laws.contact import Touching
from reference.kernel.model import Model
from reference.kernel.vectors import dot, norm, spin_cross, torque_cross

EXACT = 120
"""Degrees of freedom up to which all eigenvalues are computed."""

DEEPER = 1e-6
"""Of the overlap: how much deeper a contact is for the slope of its force."""

PRECISION = 1e-4
"""Of the largest eigenvalue of larger systems, over the largest magnitude of all."""

STRAY = 10.0
"""The last vector over the random numbers in what a search begins from."""

AT_LIMIT = 1e-9
"""Of the limit: a spring that carries less than the limit by this much sticks."""


@dataclass(frozen=True, kw_only=True)
class Springs:
    """Of one family at M contacts: stiffness, N/m, and damping, kg/s, 0 in smooth contacts; whether it sticks."""

    stiffness: np.ndarray
    damping: np.ndarray
    sticks: np.ndarray


@dataclass(frozen=True, kw_only=True)
class ContactsOfNow:
    """M contacts. i, j: nodes. n: (dim, M). arm_i, arm_j, reduced: m, 0 where no law asks. springs: by family.

    slope: of the normal force, N/m; along: its dashpot, kg/s.
    """

    i: np.ndarray
    j: np.ndarray
    n: np.ndarray
    arm_i: np.ndarray
    arm_j: np.ndarray
    reduced: np.ndarray
    slope: np.ndarray
    along: np.ndarray
    springs: dict[str, Springs]


def sprung_families(model: Model) -> tuple[str, ...]:
    """Return the families of the model whose law is a spring, or a dashpot, that sticks."""
    return tuple(family for family in FAMILIES if hasattr(getattr(model, family), "spring"))


def contacts_of_now(model: Model, interactions: Iterable[Interaction]) -> ContactsOfNow:
    """Return the contacts that acted in the last step, as doubles."""
    each = [_of_interaction(k, k.last, sprung_families(model)) for k in interactions]
    springs = {
        family: Springs(**_joined([vars(c["springs"][family]) for c in each])) for family in sprung_families(model)}
    return ContactsOfNow(springs=springs, **_joined([{k: v for k, v in c.items() if k != "springs"} for c in each]))


def _joined(parts: list[dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    columns = {name: np.concatenate([part[name] for part in parts], axis=-1) for name in parts[0]}
    return {name: v.astype(float) if v.dtype.kind == "f" else v for name, v in columns.items()}


def _of_interaction(interaction: Interaction, forces: Forces, families: tuple[str, ...]) -> dict:
    """Return the contacts of one kind; smooth ones have nothing but their normal forces."""
    c = forces.contact
    none, along = np.zeros_like(c.overlap), interaction.normal.damping(c)
    given = {name: getattr(c, name) for name in ("torque_arm_i", "torque_arm_j", "reduced_radius")}
    arm_i, arm_j, reduced = (none if arm is None else arm for arm in given.values())
    return {
        "i": c.i, "j": c.j, "n": c.n, "arm_i": arm_i, "arm_j": arm_j, "reduced": reduced,
        "slope": _slope(interaction, forces), "along": none + (0.0 if along is None else along),
        "springs": {family: _springs(interaction, forces, family) for family in families},
    }


def _slope(interaction: Interaction, forces: Forces) -> np.ndarray:
    """Return the slope of the elastic normal forces at the overlaps of now, (M,), N/m."""
    c, memory = forces.contact, forces.memory.get("normal")
    deeper = replace(c, overlap=c.overlap * (1.0 + DEEPER))
    here, there = (interaction.normal.elastic(k, memory)[0] for k in (c, deeper))
    return (there - here) / (DEEPER * c.overlap)


def _springs(interaction: Interaction, forces: Forces, family: str) -> Springs:
    law, c = getattr(interaction, family), forces.contact
    if law is None:
        none = np.zeros_like(c.overlap)
        return Springs(stiffness=none, damping=none, sticks=np.zeros(len(none), bool))
    stiffness, damping = law.spring(c)
    return Springs(stiffness=stiffness, damping=damping, sticks=_sticks(interaction, forces, family))


def _sticks(interaction: Interaction, forces: Forces, family: str) -> np.ndarray:
    """Return which springs of a family carry less than the limit, (M,)."""
    c, memory = forces.contact, forces.memory.get(family)
    if family == "sliding" and memory is not None and len(memory) > len(c.n):
        return memory[-1] == 0.0
    friction = friction_of(getattr(interaction, family), family, c)
    limit = friction * interaction.pressing(c, forces.f_n, forces.elastic).base
    return _CARRIED[family](c, forces) < (1 - AT_LIMIT) * limit


def _across(c: Touching, forces: Forces) -> np.ndarray:
    return norm(forces.force - dot(forces.force, c.n) * c.n)


def _rolled(c: Touching, forces: Forces) -> np.ndarray:
    couple = forces.couple
    return norm(couple if len(c.n) == 2 else couple - dot(couple, c.n) * c.n) / c.reduced_radius


def _twisted(c: Touching, forces: Forces) -> np.ndarray:
    return np.abs(dot(forces.couple, c.n)) / c.reduced_radius


_CARRIED: dict[str, Callable[[Touching, Forces], np.ndarray]] = {
    "sliding": _across, "rolling": _rolled, "torsion": _twisted}
"""The size of the force, or quasi-force, that a family carries, (M,), N."""


# --- rates, and what a force that answers to them does ------------------------------------------


def _separation(c: ContactsOfNow, apart: np.ndarray, w_i: np.ndarray, w_j: np.ndarray) -> np.ndarray:
    del w_i, w_j
    return dot(apart, c.n)[None]


def _slip(c: ContactsOfNow, apart: np.ndarray, w_i: np.ndarray, w_j: np.ndarray) -> np.ndarray:
    return apart - dot(apart, c.n) * c.n - spin_cross(c.arm_i * w_i + c.arm_j * w_j, c.n)


def _roll(c: ContactsOfNow, apart: np.ndarray, w_i: np.ndarray, w_j: np.ndarray) -> np.ndarray:
    del apart
    return c.reduced * spin_cross(w_i - w_j, c.n)


def _twist(c: ContactsOfNow, apart: np.ndarray, w_i: np.ndarray, w_j: np.ndarray) -> np.ndarray:
    del apart
    return (c.reduced * dot(c.n, w_i - w_j))[None]


_RATES = {"normal": _separation, "sliding": _slip, "rolling": _roll, "torsion": _twist}
"""Rates, (c, M), of apart = v_i - v_j and of the spins."""

_ANSWERS: dict[str, Callable[[ContactsOfNow, np.ndarray], tuple]] = {
    "normal": lambda c, q: (q[0] * c.n, None, None),
    "sliding": lambda c, q: (q, -c.arm_i * torque_cross(c.n, q), -c.arm_j * torque_cross(c.n, q)),
    "rolling": lambda c, q: (None, c.reduced * torque_cross(c.n, q), -c.reduced * torque_cross(c.n, q)),
    "torsion": lambda c, q: (None, c.reduced * q[0] * c.n, -c.reduced * q[0] * c.n),
}
"""Of a force q, (c, M), along the rate: the force on i (minus that on j), and the couples on i and j."""


class Operator:
    """x -> M^-1/2 B M^-1/2 x, v.B v = sum of weights |rate|^2 - drag |v|^2.

    x: (size,), velocities and spins of the particles times sqrt of M. weights: (M,) by family, "normal" among them.
    """

    def __init__(self, model: Model, found: ContactsOfNow, weights: Mapping[str, np.ndarray], *, drag: float = 0.0):
        self.found, self.weights, self.drag = found, weights, drag
        self.nodes, self.dimension, self.count = model.node_count, model.dimension, model.particle_count
        turning = np.broadcast_to(model.inertia, model.spin.shape)
        self._root = np.sqrt(np.concatenate([np.broadcast_to(model.mass, model.x.shape), turning])).astype(float)

    @property
    def size(self) -> int:
        """Degrees of freedom."""
        return self._root.size

    def power(self, v: np.ndarray, spin: np.ndarray) -> float:
        """Return v.B v of velocities (dim, nodes) and spins (1|3, nodes)."""
        drag = self.drag * (v[:, : self.count] ** 2).sum()
        each = ((self.weights[family] * dot(rate, rate)).sum() for family, rate in self._rates(v, spin).items())
        return float(sum(each) - drag)

    def matrix(self) -> np.ndarray:
        """Return all of it, (size, size)."""
        return np.stack([self(row) for row in np.eye(self.size)])

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Return it times x, (size,)."""
        c, dim, n = self.found, self.dimension, self.count
        moved = np.zeros((len(self._root), self.nodes))
        moved[:, :n] = x.reshape(self._root.shape) / self._root
        total = np.zeros_like(moved)
        for family, rate in self._rates(moved[:dim], moved[dim:]).items():
            force, couple_i, couple_j = _ANSWERS[family](c, self.weights[family] * rate)
            if force is not None:
                total[:dim] += [summed(c.i, f, self.nodes) - summed(c.j, f, self.nodes) for f in force]
            if couple_i is not None:
                total[dim:] += [summed(c.i, f, self.nodes) for f in couple_i]
                total[dim:] += [summed(c.j, f, self.nodes) for f in couple_j]
        total[:dim] -= self.drag * moved[:dim]
        return (total[:, :n] / self._root).ravel()

    def _rates(self, v: np.ndarray, spin: np.ndarray) -> dict[str, np.ndarray]:
        """Return the rates of the contacts, (c, M), by family."""
        c = self.found
        apart = v.take(c.i, axis=1) - v.take(c.j, axis=1)
        w_i, w_j = spin.take(c.i, axis=1), spin.take(c.j, axis=1)
        return {family: _RATES[family](c, apart, w_i, w_j) for family in self.weights}


# --- eigenvalues --------------------------------------------------------------------------------


def step_growth(springs: np.ndarray, fed: np.ndarray, dt: float) -> float:
    """Return the largest |z|, (-), of x(n) = z^n phi in the leapfrog: v += dt (A v - K x), x += dt v; all over sqrt M.

    From all eigenvalues of the map (x, dt v) -> (x, dt v) of one step. springs: K, 1/s^2; fed: A, 1/s; (D, D).
    """
    kicked, carried = -(dt**2) * springs, np.eye(len(fed)) + dt * fed
    step = np.block([[np.eye(len(fed)) + kicked, carried], [kicked, carried]])
    return float(np.abs(np.linalg.eigvals(step)).max())


class LargestEigenvalue:
    """The largest eigenvalues of like symmetric operators, one after the other, none below 0.

    Up to EXACT from all eigenvalues, above by ARPACK. Its error is a part of the number that it looks for, which is
    near 0 here, so all eigenvalues are moved beyond 0 first, by twice the largest magnitude of the first operator. A
    search begins from the last vector, which makes it much shorter, and from random numbers, always the same, at one
    part in STRAY: a vector alone that is one of the new operator, too, would be taken for that of the largest.
    """

    def __init__(self) -> None:
        self._vector: np.ndarray | None = None
        self._beyond = 0.0

    def of(self, operator: Callable[[np.ndarray], np.ndarray], size: int) -> float:
        """Return that of an operator on vectors (size,)."""
        if size <= EXACT:
            return max(float(np.linalg.eigvalsh(np.stack([operator(row) for row in np.eye(size)]))[-1]), 0.0)
        stray = np.random.default_rng(0).normal(size=size)
        if not operator(stray).any():
            return 0.0
        if self._vector is None:
            self._vector = stray
            self._beyond = 2.0 * abs(self._end_of(operator, "LM", stray)[0])
        start = self._vector / np.linalg.norm(self._vector) + stray / np.linalg.norm(stray) / STRAY
        value, self._vector = self._end_of(lambda x: operator(x) + self._beyond * x, "LA", start)
        return max(value - self._beyond, 0.0)

    @staticmethod
    def _end_of(operator: Callable, which: str, start: np.ndarray) -> tuple[float, np.ndarray]:
        from scipy.sparse.linalg import LinearOperator, eigsh

        linear = LinearOperator((len(start),) * 2, matvec=operator, dtype=float)
        values, vectors = eigsh(linear, k=1, which=which, v0=start, tol=PRECISION)
        return float(values[0]), vectors[:, 0]

    def kept(self) -> dict[str, np.ndarray]:
        """Return what the coming searches depend on, for `take`."""
        return {} if self._vector is None else {"late_vector": self._vector, "late_beyond": np.array(self._beyond)}

    def take(self, kept: Mapping[str, np.ndarray]) -> None:
        """Go on from what `kept` returned."""
        if "late_vector" in kept:
            self._vector, self._beyond = kept["late_vector"], float(kept["late_beyond"])
