"""Sticking and sliding: a spring and a dashpot with a limit, in the variants of the codes and the talks.

Sliding, rolling and torsion share it. Given are the spring xi (c, M), the rate v (c, M) at which it is
stretched, stiffness k, damping gamma, static and dynamic coefficient mu and mu_d, and the base f (M,) of the limit.
The answer is f_t = -k xi - gamma v while sticking, a force of size mu_d f while sliding. The variants differ
in their order, in what the limit is tested on, and in what sliding leaves behind:

`lammps`    turn and rescale xi, xi += v dt; test |f_t| > mu f; sliding: f_t to the limit,
            xi = -(f_t + gamma v)/k          (pair granular linear_history, mindlin, rolling sds, as run)
`lammps_twisting`  the same for one component, but a sliding contact resists the direction of v,
            whatever its spring says         (pair granular twisting sds, as run)
`liggghts`  xi += v dt, then turn without rescaling; test k |xi| > mu f (no dashpot);
            sliding: xi to the limit mu_d f, f_t = -k xi without dashpot
            (tangential history and tan_luding, rolling epsd and luding, as run)
`talk`      turn and rescale xi; test force f_t = -k xi - gamma v; sticking: f_t, then xi += v dt;
            sliding: f_t to the limit, xi = -(f_t + gamma v)/k
            (S. Luding, Granular Matter 10, 235 (2008), section 2.3). The force is a step late: a swing of
            frequency W in the spring grows by exp(W^2 dt t/2) unless gamma damps it

With a dynamic coefficient mu_d < mu, `lammps` and `talk` remember whether a contact slides: it sticks again only when
its test force is below mu_d f (states static -> dynamic -> static). `liggghts` has no such state. In the `talk` the
spring that sliding leaves behind carries just mu_d f, so that the words "below mu_d f" would leave it to round-off
whether a steady slide goes on; here the test force of a sliding contact is that of the spring as the coming step
would stretch it. Without a dynamic coefficient the published words stand; there, without a dashpot and at exactly
constant f, round-off alone tells a spring at its limit from one beyond it, and a contact may slide on for as long as
f stays the same although its motion has reversed. With a dashpot the published words let a slide that slows down stick
in every other step: the spring left behind carries mu f together with gamma v, so that the next test force is mu f -
gamma |dv|, dv the change of v in the step; it sticks for that step and carries gamma |dv| less. A slide is braked too
weakly by gamma |dv|/(2 mu f), of first order in dt (measured: 2.5 % for a sphere that spins in a rough corner at
t_c/20, `inputs/hard_cases/corner_rough_3d.toml`). A contact whose limit is 0 slides whatever its test force, which is
then 0 up to round-off: nothing holds it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.kernel.vectors import dot, norm

LAMMPS_TURN_THRESHOLD = 1e-10
"""pair granular turns the spring only where k |xi.n| exceeds this times the limit."""


@dataclass(frozen=True, kw_only=True)
class Slider:
    """One law's numbers: `stiffness`, `damping`, `friction` one number or (M,); `dynamic_friction` None: as static."""

    algorithm: str
    stiffness: float | np.ndarray
    damping: float | np.ndarray
    friction: float | np.ndarray
    dynamic_friction: float | None = None

    def move(
        self, memory: np.ndarray, rate: np.ndarray, base: np.ndarray, n: np.ndarray | None, dt: float, *, advance: bool,
        mean_rate: np.ndarray | None = None,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the force (c, M) and the new memory: the spring (c, M), below it 1 where it slides (with a state).

        n: (c, M) normals at right angles to which the spring is turned, None if it does not turn. Without `advance`
        time stands still: the spring is neither turned nor stretched nor cut (the evaluation at set-up and
        for output); the force keeps to the limit all the same.
        """
        xi, components = memory[: len(rate)], len(rate)
        limit = carried = self.friction * base
        slid = None
        if self.dynamic_friction is not None:
            carried = self.dynamic_friction * base
        if len(memory) > components:
            slid = memory[-1] > 0.0
            limit = np.where(slid, carried, limit)
        state = _State(xi=xi, rate=rate, n=n, limit=limit, carried=carried, slid=slid,
                       stretch=dt * (rate if mean_rate is None else mean_rate))
        force, xi, slides = _ALGORITHMS[self.algorithm](self, state, advance)
        if slid is None:
            return force, xi
        return force, np.vstack([xi, slides if advance else memory[-1:]])


@dataclass(frozen=True, kw_only=True)
class _State:
    """Springs before a step, and what decides how they move; `slid` (M,) where they slid before, None without state."""

    xi: np.ndarray
    rate: np.ndarray
    n: np.ndarray | None
    limit: np.ndarray
    carried: np.ndarray
    slid: np.ndarray | None
    stretch: np.ndarray


def memory_rows(components: int, algorithm: str, dynamic_friction: float | None) -> int:
    """Return how many numbers a contact remembers: its spring and, where needed, whether it slides."""
    return components + (dynamic_friction is not None and algorithm != "liggghts")


def _lammps(s: Slider, c: _State, advance: bool):
    if not advance:
        return _lammps_set_up(s, c)
    xi = c.xi
    if c.n is not None:
        along = dot(xi, c.n)
        turned = np.abs(along) * s.stiffness > LAMMPS_TURN_THRESHOLD * c.limit
        xi = np.where(turned, _rescaled(xi - along * c.n, xi), xi)
    xi = xi + c.stretch
    force, slides = _limited(s, xi, c)
    return force, np.where(slides, _spring_of(s, force, c.rate), xi), slides


def _lammps_set_up(s: Slider, c: _State):
    """Force without advancing; a sliding contact whose spring has no length yet gets none.

    That is pair granular's rule at set-up (as run): the direction of sliding is not known to it.
    """
    force, slides = _limited(s, c.xi, c)
    return np.where(slides & ~c.xi.any(axis=0), 0.0, force), c.xi, slides


def _lammps_twisting(s: Slider, c: _State, advance: bool):
    """One component; the spring is cut even when time stands still, as it is in pair granular."""
    xi = c.xi + c.stretch if advance else c.xi
    test, slides = _limited(s, xi, c)
    force = np.where(slides, -c.carried * np.sign(c.rate), test)
    return force, np.where(slides, _spring_of(s, force, c.rate), xi), slides


def _liggghts(s: Slider, c: _State, advance: bool):
    """A spring that does not turn (rolling) is stretched for the force even when time stands still."""
    xi = c.xi
    if advance or c.n is None:
        xi = xi + c.stretch
    if advance and c.n is not None:
        xi = xi - dot(xi, c.n) * c.n
    stretch = s.stiffness * norm(xi)
    slides = stretch > c.limit
    cut = xi * _ratio(c.carried, stretch, slides)
    force = -s.stiffness * cut
    force -= np.where(slides, 0.0, s.damping) * c.rate
    return force, (cut if advance else c.xi), slides


def _talk(s: Slider, c: _State, advance: bool):
    if not advance:
        force, slides = _limited(s, c.xi, c)
        return force, c.xi, slides
    xi = c.xi
    if c.n is not None:
        xi = _rescaled(xi - dot(xi, c.n) * c.n, xi)
    test = _test_force(s, xi, c.rate)
    size = norm(test)
    slides = size > c.limit
    if c.slid is not None:
        coming = norm(_test_force(s, xi + c.stretch, c.rate))
        slides = np.where(c.slid, (coming > c.limit) & (size > 0.0), slides)
    slides |= c.limit == 0.0
    force = test * _ratio(c.carried, size, slides & (size > 0.0))
    return force, np.where(slides, _spring_of(s, force, c.rate), xi + c.stretch), slides


_ALGORITHMS = {"lammps": _lammps, "lammps_twisting": _lammps_twisting, "liggghts": _liggghts, "talk": _talk}


def _limited(s: Slider, xi, c: _State):
    """Return the test force, (c, M), where it is above the limit cut to what sliding carries, and where, (M,)."""
    test = _test_force(s, xi, c.rate)
    size = norm(test)
    slides = size > c.limit
    return test * _ratio(c.carried, size, slides), slides


def _test_force(s: Slider, xi, rate):
    return -s.stiffness * xi - s.damping * rate


def _spring_of(s: Slider, force, rate):
    """Return the spring that carries `force` together with the dashpot."""
    return -(force + s.damping * rate) / s.stiffness


def _rescaled(turned: np.ndarray, old: np.ndarray) -> np.ndarray:
    """Give the turned spring the length of the old one; a spring turned to zero stays zero."""
    length = norm(turned)
    return turned * _ratio(norm(old), length, length > 0.0)


def _ratio(a: np.ndarray, b: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return a/b where `where` holds, 1 elsewhere."""
    return np.divide(a, b, out=np.ones_like(b), where=where)
