"""One collision of two discs, or of two spheres in a plane, solved contact phase by contact phase.

Between its events a contact with springs, dashpots and Coulomb's limit is a smooth ordinary differential equation. Here
each phase (stick, slide one way or the other) is integrated with DOP853 (Dormand, Prince; Hairer, Norsett, Wanner,
Solving ODEs I, 1993) to about 1e-12, and its end is located. So the answer has no step size and shares nothing with the
schemes of DEM codes: it is what they tend to as dt tends to 0.

Motion of i relative to j in the frame of the contact; n from j to i at the angle theta, t = (-n_y, n_x), r the distance
of the centres, m* the reduced mass, a the lever arms::

    delta' = -v_n,   theta' = v_t/r,   v_n' = f_n/m* + v_t^2/r,   v_t' = f_t/m* - v_t v_n/r
    w' = -a f_t/I of both bodies,   slip u = v_t - (s_i w_i + s_j w_j)
    f_n = k_n delta - gamma_n v_n

    stick:   f_t = -k_t xi - gamma_t u,  xi' = u,            while |f_t| <= mu b
    slide:   f_t = +- mu b,  the spring such that it carries f_t with the dashpot,
             until the spring would be unloaded faster than the limit shrinks

Source: P. A. Cundall, O. D. L. Strack, Geotechnique 29, 47 (1979), as S. Luding, Granular Matter 10, 235 (2008),
section 2.3, tells it. Where codes differ is a choice: `slip_arm`, `base`, `tested` below. Torques act at R - delta/2.
Speeds in m/s, lengths in m, spins in rad/s counter-clockwise, SI throughout.

Equal discs head-on without dashpot swap their velocities, after pi sqrt(m*/k):

>>> bodies = Bodies(x=np.array([[0.0, 0.0], [2.1e-3, 0.0]]), v=np.array([[0.1, 0.0], [0.0, 0.0]]), spin=np.zeros(2),
...                 radius=np.full(2, 1e-3), mass=np.full(2, 1e-5), inertia=np.full(2, 5e-12))
>>> parted = collide(bodies, PairLaws(normal_stiffness=1e5, normal_damping=0.0, attraction="clipped"))
>>> bool(np.allclose(parted.v, [[0.0, 0.0], [0.1, 0.0]], atol=1e-11)), f"{parted.duration:.4g}"
(True, '2.221e-05')
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

RELATIVE = 1e-12
"""Tolerance of the integration."""

STEPS_A_CONTACT = 100.0
"""Largest step, in contact times: a longer one would pass over short phases of slip."""

MOST_PHASES = 200

NOTHING = 1e-9
"""A force below this part of those at work is none: events are located as finely as that."""


@dataclass(frozen=True, kw_only=True)
class PairLaws:
    """Linear spring and dashpot along the normal, and, unless `shear_friction` is None, Coulomb's spring across it.

    attraction: "allowed", or "clipped" at f_n = 0. slip_arm: the slip is taken with arms R or with R - delta/2.
    base: what the limit is mu times of, |f_n| or max(f_n, 0). tested: whether the limit holds for spring and dashpot
    together or for the spring alone, which then slides without dashpot.
    """

    normal_stiffness: float
    normal_damping: float
    attraction: Literal["allowed", "clipped"]
    shear_friction: float | None = None
    shear_stiffness: float = 0.0
    shear_damping: float = 0.0
    slip_arm: Literal["radius", "reduced"] = "reduced"
    base: Literal["absolute", "pressing"] = "pressing"
    tested: Literal["force", "spring"] = "force"


@dataclass(frozen=True, kw_only=True)
class Bodies:
    """Two bodies, i first: x, v (2, 2) a row each, spin, radius, mass, inertia (2,)."""

    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray


@dataclass(frozen=True, kw_only=True)
class Parted:
    """v (2, 2), spin (2,) after the contact, which began at `begin` and lasted `duration`, s; its phases in order."""

    v: np.ndarray
    spin: np.ndarray
    begin: float
    duration: float
    phases: tuple[str, ...]


class _State(NamedTuple):
    """delta, v_n, theta, v_t, w_i, w_j, xi."""

    overlap: float
    v_n: float
    angle: float
    v_t: float
    w_i: float
    w_j: float
    spring: float


Phase = Literal["smooth", "stick", "slide +", "slide -"]
SIGN = {"slide +": 1.0, "slide -": -1.0}


def collide(bodies: Bodies, laws: PairLaws) -> Parted:
    """Return what the bodies leave their contact with.

    Raises ValueError for bodies that touch at the start, that never meet, or whose contact does not end.
    """
    begin = _meeting(bodies)
    start = _at_first_touch(bodies, begin)
    motion = _Motion(bodies=bodies, laws=laws)
    state, phase = motion.begin(start)
    time, phases = 0.0, []
    longest = 100.0 * motion.contact_time
    while phase != "apart":
        phases.append(phase)
        if len(phases) > MOST_PHASES or time > longest:
            raise ValueError(f"a contact that does not end: {len(phases)} phases in {time:.3g} s")
        elapsed, state, phase = motion.follow(state, phase)
        time += elapsed
    v, spin = _of_bodies(bodies, state)
    return Parted(v=v, spin=spin, begin=begin, duration=time, phases=tuple(phases))


def _meeting(b: Bodies) -> float:
    """Time at which the straight paths bring the centres to R_i + R_j."""
    x, v, reach = b.x[0] - b.x[1], b.v[0] - b.v[1], float(b.radius.sum())
    gap, along, square = float(x @ x) - reach**2, float(x @ v), float(v @ v)
    root = along**2 - square * gap
    if gap < 0.0 or along >= 0.0 or root < 0.0:
        raise ValueError("expected two bodies that are apart and meet")
    return gap / (-along + math.sqrt(root))


def _at_first_touch(b: Bodies, time: float) -> _State:
    v = b.v[0] - b.v[1]
    x = b.x[0] - b.x[1] + time * v
    n = x / np.linalg.norm(x)
    return _State(0.0, float(v @ n), math.atan2(n[1], n[0]), float(n[0] * v[1] - n[1] * v[0]), *map(float, b.spin), 0.0)


def _of_bodies(b: Bodies, s: _State) -> tuple[np.ndarray, np.ndarray]:
    n = np.array([math.cos(s.angle), math.sin(s.angle)])
    relative = s.v_n * n + s.v_t * np.array([-n[1], n[0]])
    centre, total = b.mass @ b.v / b.mass.sum(), float(b.mass.sum())
    v = np.stack([centre + b.mass[1] / total * relative, centre - b.mass[0] / total * relative])
    return v, np.array([s.w_i, s.w_j])


@dataclass(frozen=True, kw_only=True)
class _Motion:
    """The equations of motion in each phase, and where phases end."""

    bodies: Bodies
    laws: PairLaws

    @property
    def reduced_mass(self) -> float:
        return float(self.bodies.mass.prod() / self.bodies.mass.sum())

    @property
    def contact_time(self) -> float:
        """Half a period of the undamped normal spring, s."""
        return math.pi * math.sqrt(self.reduced_mass / self.laws.normal_stiffness)

    # --- forces and rates ------------------------------------------------------------------------

    def normal(self, s: _State) -> float:
        """f_n, N; below zero where a clipped dashpot would pull."""
        return self.laws.normal_stiffness * s.overlap - self.laws.normal_damping * s.v_n

    def _presses(self, s: _State) -> bool:
        """Whether f_n > 0, and not merely by rounding."""
        parts = self.laws.normal_stiffness * abs(s.overlap) + self.laws.normal_damping * abs(s.v_n)
        return self.normal(s) > NOTHING * parts

    def limit(self, s: _State) -> float:
        """Mu b, N."""
        f_n = self.normal(s)
        return self.laws.shear_friction * (abs(f_n) if self.laws.base == "absolute" else max(f_n, 0.0))

    def slip(self, s: _State) -> float:
        """u, m/s."""
        slip_i, slip_j = self._arms(s, self.laws.slip_arm)
        return s.v_t - slip_i * s.w_i - slip_j * s.w_j

    def tested(self, s: _State) -> float:
        """What is held against the limit while sticking, N."""
        dashpot = self.laws.shear_damping * self.slip(s) if self.laws.tested == "force" else 0.0
        return -self.laws.shear_stiffness * s.spring - dashpot

    def tangential(self, s: _State, phase: Phase) -> float:
        """f_t, N."""
        if phase == "smooth":
            return 0.0
        if phase == "stick":
            return -self.laws.shear_stiffness * s.spring - self.laws.shear_damping * self.slip(s)
        return SIGN[phase] * self.limit(s)

    def rates(self, s: _State, phase: Phase) -> _State:
        """Return d/dt of the state."""
        b, f_t = self.bodies, self.tangential(s, phase)
        distance = float(b.radius.sum()) - s.overlap
        arm_i, arm_j = self._arms(s, "reduced")
        return _State(
            overlap=-s.v_n,
            v_n=self.normal(s) / self.reduced_mass + s.v_t**2 / distance,
            angle=s.v_t / distance,
            v_t=f_t / self.reduced_mass - s.v_t * s.v_n / distance,
            w_i=-arm_i * f_t / float(b.inertia[0]),
            w_j=-arm_j * f_t / float(b.inertia[1]),
            spring=self.slip(s) if phase == "stick" else 0.0,
        )

    def _arms(self, s: _State, arm: str) -> tuple[float, float]:
        less = 0.5 * s.overlap if arm == "reduced" else 0.0
        return float(self.bodies.radius[0]) - less, float(self.bodies.radius[1]) - less

    def _loading(self, s: _State, phase: Phase) -> tuple[float, float]:
        """Return how fast the tested force would grow if the contact stuck, and how fast the limit grows, N/s."""
        laws, rate = self.laws, self.rates(s, phase)
        growth = -laws.shear_stiffness * self.slip(s)
        if laws.tested == "force":
            growth -= laws.shear_damping * self._slip_rate(s, rate)
        normal_rate = laws.normal_stiffness * rate.overlap - laws.normal_damping * rate.v_n
        pulls = not self._presses(s) and normal_rate < 0.0
        return growth, laws.shear_friction * (-normal_rate if pulls else normal_rate)

    def _slip_rate(self, s: _State, rate: _State) -> float:
        slip_i, slip_j = self._arms(s, self.laws.slip_arm)
        shrinking = 0.5 * s.v_n if self.laws.slip_arm == "reduced" else 0.0
        return rate.v_t - slip_i * rate.w_i - slip_j * rate.w_j - shrinking * (s.w_i + s.w_j)

    # --- phases ----------------------------------------------------------------------------------

    def begin(self, s: _State) -> tuple[_State, Phase]:
        """Return what a contact begins with: the dashpots of first touch, and no spring unless they slide.

        Sliding that ends as it begins leaves the spring behind that it set.
        """
        if self.laws.shear_friction is None:
            return s, "smooth"
        limit, tested = self.limit(s), self.tested(s)
        if abs(tested) <= limit * (1.0 + NOTHING):
            return s, "stick" if limit > 0.0 else self._from_nothing(s)
        phase: Phase = "slide +" if tested > 0.0 else "slide -"
        if self._held(s, phase) > 0.0:
            return s, phase
        return s._replace(spring=self._spring_of(s, phase)), "stick"

    def _from_nothing(self, s: _State) -> Phase:
        """Return the phase in which limit and force grow from zero together."""
        growth, limit_growth = self._loading(s, "smooth")
        if abs(growth) <= limit_growth:
            return "stick"
        return "slide +" if growth > 0.0 else "slide -"

    def follow(self, s: _State, phase: Phase) -> tuple[float, _State, str]:
        """Integrate to the end of the phase; return how long it lasted, the state then, and what comes next."""
        from scipy.integrate import solve_ivp

        ends = self._ends(s, phase)
        watched = [_watch(function) for function, _ in ends]
        done = solve_ivp(
            lambda _, y: self.rates(_State(*y), phase), (0.0, 50.0 * self.contact_time), s, method="DOP853",
            rtol=RELATIVE, atol=RELATIVE * self._sizes(s), max_step=self.contact_time / STEPS_A_CONTACT, events=watched,
        )
        if not done.success or done.status != 1:
            raise ValueError(f"a contact that does not end: in phase {phase}, {done.message}")
        which = next(k for k, times in enumerate(done.t_events) if len(times))
        state = _State(*(float(value) for value in done.y_events[which][0]))
        state, following = self._after(state, phase, ends[which][1])
        return float(done.t_events[which][0]), state, following

    def _sizes(self, s: _State) -> np.ndarray:
        b = self.bodies
        speed = math.hypot(s.v_n, s.v_t) + float(np.abs(b.spin * b.radius).max())
        overlap = speed * math.sqrt(self.reduced_mass / self.laws.normal_stiffness)
        spin = speed / float(b.radius.min())
        return np.array([overlap, speed, 1e-3, speed, spin, spin, overlap])

    def _ends(self, s: _State, phase: Phase) -> list[tuple[Callable[[_State], float], str]]:
        """Return what falls through zero where the phase ends, and what that is."""
        ends: list = [(lambda s: s.overlap, "apart")]
        if self.laws.attraction == "clipped":
            ends = [(self.normal, "apart")]
        elif phase != "smooth" and self._presses(s):
            ends.append((self.normal, "pulled"))
        if phase == "stick":
            ends += [(lambda s: self.limit(s) - self.tested(s), "slide +"),
                     (lambda s: self.limit(s) + self.tested(s), "slide -")]
        elif phase in SIGN:
            ends.append((lambda s: self._held(s, phase), "stick"))
        return ends

    def _held(self, s: _State, phase: Phase) -> float:
        """Positive while a sliding contact would be over the limit if it stuck, N/s."""
        growth, limit_growth = self._loading(s, phase)
        return SIGN[phase] * growth - limit_growth

    def _after(self, s: _State, phase: Phase, end: str) -> tuple[_State, str]:
        """Return the state and the phase that follow; a contact that has slid keeps the spring of its force."""
        if phase in SIGN:
            s = s._replace(spring=self._spring_of(s, phase))
        if end != "pulled":
            return s, end
        return s, self._from_nothing(s) if self.laws.base == "absolute" else "smooth"

    def _spring_of(self, s: _State, phase: Phase) -> float:
        dashpot = self.laws.shear_damping * self.slip(s) if self.laws.tested == "force" else 0.0
        return -(self.tangential(s, phase) + dashpot) / self.laws.shear_stiffness


def _watch(function: Callable[[_State], float]) -> Callable[[float, np.ndarray], float]:
    def event(_: float, y: np.ndarray) -> float:
        return function(_State(*y))

    event.terminal, event.direction = True, -1.0
    return event


def without_friction(laws: PairLaws) -> PairLaws:
    """Return the laws with the normal force alone."""
    return replace(laws, shear_friction=None)
