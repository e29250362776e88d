"""Sticking and sliding in force units: the operations of `reference.kernel.laws.slider`.

T = k xi is the spring's tension, v the rate (0 where nothing touches), f the base of the limit; the force on i is -F.
Where a spring turns it does so first; its length is kept, but not in LIGGGHTS::

    lammps      F = cut(T + (k dt + gamma) v);                                T = F - gamma v
    lammps_twisting   the same, but what slides has the direction of v
    liggghts    T = cut(T + k dt v);  F = T + (gamma v where nothing was cut)
    talk        F = cut(T + gamma v);  T = F - gamma v + (k dt v where nothing was cut)

cut() shortens to mu f what is longer. With a dynamic coefficient it gives mu_d f to what slides: to what is longer than
mu f or, in a contact that slid before (1 in the last row of the memory), than mu_d f. There the `talk` holds
T + gamma v + k dt v against mu_d f; everything slides there where the limit is 0. Where nothing touches f = v = 0, so
that T becomes 0: what opens forgets.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from reference.kernel.laws.slider import LAMMPS_TURN_THRESHOLD
from reference.kernel.program.components import TINY, Components
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.program import Program

Coefficient = float | np.ndarray
"""One for all contacts, or (P,), of each pair or computed in every step."""

LAGGING = 1.0
"""Coefficient of friction above which springs of `lammps` in 2D are vectors that may lag behind their contact.

LAMMPS turns a spring only when its part along the normal exceeds 1e-10 mu f. Springs that are turned in every step are
numbers in 2D; they lack that part, which is then at most 1e-10 mu f of force along the normal, for as long as the
spring is not turned. Up to this coefficient it is at most 1e-10 of f, about what f has from the rounding of positions
(eps x/delta, with x/delta from 1e5 to 1e6 in packings), and nothing of it is left once the spring is turned.
"""


def lags(algorithm: str, friction: float, *, turns: bool = True) -> bool:
    """Return whether springs that are not turned at once make a difference."""
    return turns and algorithm == "lammps" and friction > LAGGING


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A law's numbers. memory: history, the tension and with a state a last row.

    mean_rate: the rate by which the spring is stretched, in schemes that know one (`lammps` only); else v.
    growth: k dt. damping: gamma, None without dashpot. turns: whether the spring follows the contact. roughest: the
    largest coefficient of friction of the whole model, where friction is (P,).
    """

    algorithm: str
    memory: np.ndarray
    growth: Coefficient
    damping: Coefficient | None
    friction: Coefficient
    dynamic_friction: float | None = None
    turns: bool = True
    mean_rate: np.ndarray | None = None
    roughest: float | None = None

    @property
    def lags(self) -> bool:
        """Whether springs that are not turned at once make a difference."""
        return lags(self.algorithm, self.friction if self.roughest is None else self.roughest, turns=self.turns)


def slide(
    p: Program, c: Contacts, kind: Components, spring: Spring, *, rate: np.ndarray, out: np.ndarray
) -> None:
    """out = F, (P,) or (3, P) as the rate."""
    _Slider(p, c, kind, spring, rate, out).run()


def slide_across(
    p: Program, c: Contacts, spring: Spring, *, rate: np.ndarray, out: np.ndarray, pulls: bool
) -> np.ndarray | None:
    """`slide` in the tangent plane; with `pulls` return F.n where springs lag in 2D, (P,), else None."""
    vectors = c.lagging_vectors
    if vectors is None or not spring.lags:
        slide(p, c, c.tangents, spring, rate=rate, out=out)
        return None
    vectors.find_normals(p)
    rate = vectors.along_tangent(p, rate, "rate")
    mean = None if spring.mean_rate is None else vectors.along_tangent(p, spring.mean_rate, "mean rate")
    force = vectors.buffer("spring force")
    slide(p, c, vectors, replace(spring, mean_rate=mean), rate=rate, out=force)
    vectors.find_amounts(p, force, out)
    return vectors.find_part_along_normal(p, force) if pulls else None


class _Slider:
    """The operations of one spring law."""

    def __init__(self, p, c, kind, spring, rate, out):
        self.p, self.c, self.kind, self.spring, self.rate, self.out = p, c, kind, spring, rate, out
        state = spring.dynamic_friction is not None and spring.algorithm != "liggghts"
        self.slid = spring.memory[-1] if state else None
        rows = spring.memory[:-1] if state else spring.memory
        self.tension = rows[0] if len(rows) == 1 else rows
        self.limit = c.buffer("limit")

    def run(self) -> None:
        _ALGORITHMS[self.spring.algorithm](self)

    # --- the algorithms --------------------------------------------------------------------------

    def lammps(self) -> None:
        self.set_limit()
        self.turn(keep_length=True, threshold=LAMMPS_TURN_THRESHOLD)
        self.pull_on()
        self.cut(self.out, self.out)
        self.leave_behind()

    def lammps_twisting(self) -> None:
        p, out, stuck, direction = self.p, self.out, self.c.buffer("stuck"), self.c.buffer("direction")
        self.set_limit()
        self.pull_on()
        self.kind.size(p, out, self.c.a)
        p(np.less_equal, self.c.a, self.limit, out=stuck)
        p(np.sign, self.rate, out=direction)
        p(np.multiply, direction, self.limit, out=direction)
        p(np.multiply, out, stuck, out=out)
        p(np.subtract, 1.0, stuck, out=stuck)
        p(np.multiply, direction, stuck, out=direction)
        p(np.add, out, direction, out=out)
        self.leave_behind()

    def liggghts(self) -> None:
        p, out, tension, work = self.p, self.out, self.tension, self.kind.work
        damped = self.spring.damping is not None
        self.set_limit()
        self.turn(keep_length=False)
        p(np.multiply, self.rate, self.spring.growth, out=work)
        p(np.add, tension, work, out=out)
        stuck = self.c.buffer("stuck") if damped else None
        self.cut(out, tension, stuck=stuck)
        if damped:
            p(np.multiply, self.rate, self.spring.damping, out=work)
            p(np.multiply, work, stuck, out=work)
            p(np.add, tension, work, out=out)
        else:
            p.copy(tension, out)

    def talk(self) -> None:
        p, tension, work = self.p, self.tension, self.kind.work
        test, stuck = self.kind.buffer("test"), self.c.buffer("stuck")
        damped = self.spring.damping is not None
        self.set_limit()
        self.turn(keep_length=True)
        if damped:
            p(np.multiply, self.rate, self.spring.damping, out=work)
            p(np.add, tension, work, out=test)
        else:
            test = tension
        self.cut(test, self.out, stuck=stuck, talks=True)
        if damped:
            p(np.subtract, self.out, work, out=tension)
        else:
            p.copy(self.out, tension)
        p(np.multiply, self.rate, self.spring.growth, out=work)
        p(np.multiply, work, stuck, out=work)
        p(np.add, tension, work, out=tension)

    # --- their parts -----------------------------------------------------------------------------

    def set_limit(self) -> None:
        """limit = mu f, mu_d f where the contact slid before."""
        p, mu, limit = self.p, self.spring.friction, self.limit
        if self.slid is None:
            p(np.multiply, self.c.base, mu, out=limit)
            return
        p(np.multiply, self.slid, self.spring.dynamic_friction - mu, out=limit)
        p(np.add, limit, mu, out=limit)
        p(np.multiply, limit, self.c.base, out=limit)

    def turn(self, *, keep_length: bool, threshold: float | None = None) -> None:
        if self.spring.turns:
            above = None if threshold is None else (self.limit, threshold)
            self.kind.turn(self.p, self.tension, keep_length=keep_length, above=above)

    def pull_on(self) -> None:
        """out = T + (k dt + gamma) v."""
        p, out, growth, damping = self.p, self.out, self.spring.growth, self.spring.damping
        if self.spring.mean_rate is not None:
            p(np.multiply, self.spring.mean_rate, growth, out=out)
            p(np.add, out, self.tension, out=out)
            if damping is not None:
                p(np.multiply, self.rate, damping, out=self.kind.work)
                p(np.add, out, self.kind.work, out=out)
            return
        both = growth
        if damping is not None:
            both = self._sum(growth, damping)
        p(np.multiply, self.rate, both, out=out)
        p(np.add, out, self.tension, out=out)

    def _sum(self, growth: Coefficient, damping: Coefficient) -> Coefficient:
        if isinstance(growth, float) and isinstance(damping, float):
            return growth + damping
        self.p(np.add, growth, damping, out=self.c.a)
        return self.c.a

    def leave_behind(self) -> None:
        """T = F - gamma v."""
        p = self.p
        if self.spring.damping is None:
            p.copy(self.out, self.tension)
            return
        p(np.multiply, self.rate, self.spring.damping, out=self.kind.work)
        p(np.subtract, self.out, self.kind.work, out=self.tension)

    def cut(self, test: np.ndarray, out: np.ndarray, *, stuck: np.ndarray | None = None, talks: bool = False) -> None:
        """out = cut(test); stuck = 1 where nothing was cut, else 0. talks: by the rules of the `talk`."""
        if self.spring.dynamic_friction is None:
            self.kind.cut(self.p, test, self.limit, out, stuck=stuck, slides_at_zero=talks)
            return
        p, size, stuck = self.p, self.c.buffer("size"), self.c.buffer("stuck")
        slides = self.c.buffer("slides") if self.slid is None else self.slid
        self.kind.size(p, test, size)
        if talks and self.slid is not None:
            self._find_sliding_in_talk(test, size)
        else:
            p(np.greater, size, self.limit, out=slides)
        p(np.subtract, 1.0, slides, out=stuck)
        p(np.multiply, self.c.base, self.spring.dynamic_friction, out=self.limit)
        p(np.maximum, size, TINY, out=size)
        p(np.divide, self.limit, size, out=size)
        p(np.multiply, size, slides, out=size)
        p(np.add, size, stuck, out=size)
        p(np.multiply, test, size, out=out)
        if self.slid is not None:
            p(np.multiply, self.slid, self.c.touching, out=self.slid)

    def _find_sliding_in_talk(self, test: np.ndarray, size: np.ndarray) -> None:
        """Slides = |test + slid k dt v| > limit and |test| > 0, or limit = 0."""
        p, work, slid, other = self.p, self.out, self.slid, self.c.a
        p(np.multiply, self.rate, self.spring.growth, out=work)
        p(np.multiply, work, slid, out=work)
        p(np.add, work, test, out=work)
        self.kind.size(p, work, slid)
        p(np.greater, slid, self.limit, out=slid)
        p(np.greater, size, 0.0, out=other)
        p(np.multiply, slid, other, out=slid)
        p(np.equal, self.limit, 0.0, out=other)
        p(np.maximum, slid, other, out=slid)


_ALGORITHMS = {
    "lammps": _Slider.lammps, "lammps_twisting": _Slider.lammps_twisting, "liggghts": _Slider.liggghts,
    "talk": _Slider.talk,
}
