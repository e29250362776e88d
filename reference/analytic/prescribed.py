"""What a contact answers when its bodies are driven along a path, in closed form.

Rows k = 1..S of equal time steps dt; a law sees overlap, rate of separation, slip rate of each row. Everything that
remembers is one operator, the play (backlash) of plasticity theory: a value p that is carried along by two bounds,

    lower_k <= p_k <= upper_k,   p moves only when a bound pushes it.

Along a leg (between two turning points of the bounds) p is clip(p at the leg's start, lower, upper): the path between
turning points does not matter, so the answer follows from turning points alone. Source: M. A. Krasnosel'skii,
A. V. Pokrovskii, Systems with Hysteresis (1989), section 1; for friction the model of W. D. Iwan (1966).

Normal: the largest overlap D of the hysteretic laws (Luding 2008; see `hysteretic_collision`) has the bounds
D >= d (f <= k1 d) and f >= -kc d. Friction: of the total slip s, p is what has slid, the spring is s - p with
|k (s - p) + gamma v| <= limit (spring and dashpot within Coulomb's limit), or k |s - p| <= limit.

Compression is positive; a tangential force has the sign against the slip. SI units. A contact that opens (d <= 0)
forgets. NaN marks rows that are not determined by the law alone but by a code's order of operations.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

Cut = Literal["total", "spring"]
"""Coulomb's limit holds for spring and dashpot together, or for the spring, which then slides without dashpot."""


def held(lower: np.ndarray, upper: np.ndarray, start: float = 0.0) -> np.ndarray:
    """Return p, (S,), carried by `lower` <= `upper`, (S,), from `start`.

    >>> held(np.array([-1.0, 1.0, 2.0, 0.0, -3.0]), np.array([1.0, 3.0, 4.0, 2.0, -1.0])).tolist()
    [0.0, 1.0, 2.0, 2.0, -1.0]
    """
    value, last = np.empty(len(lower)), start
    for leg in _legs(lower, upper):
        value[leg] = np.clip(last, lower[leg], upper[leg])
        last = value[leg][-1]
    return value


# --- normal laws -----------------------------------------------------------------------------------


def linear_force(
    overlap: np.ndarray, separation: np.ndarray, *, stiffness: float, damping: float, clipped: bool
) -> np.ndarray:
    """F = k d - gamma d', (S,) in N, d' the rate of separation; not below zero if clipped."""
    force = stiffness * overlap - damping * separation
    return _touching(overlap, np.maximum(force, 0.0) if clipped else force)


@dataclass(frozen=True, kw_only=True)
class ElasticPair:
    """Two elastic spheres of one material, or a sphere and a plane of it: E (Pa), nu, R* (m)."""

    youngs_modulus: float
    poisson_ratio: float
    effective_radius: float

    @property
    def effective_modulus(self) -> float:
        """E* = E/(2 (1 - nu^2)), Pa."""
        return self.youngs_modulus / (2.0 * (1.0 - self.poisson_ratio**2))

    @property
    def effective_shear_modulus(self) -> float:
        """G* = E/(4 (2 - nu)(1 + nu)), Pa."""
        return self.youngs_modulus / (4.0 * (2.0 - self.poisson_ratio) * (1.0 + self.poisson_ratio))

    def contact_radius(self, overlap: np.ndarray) -> np.ndarray:
        """A = sqrt(R* d), m (Hertz 1882); zero where the bodies are apart."""
        return np.sqrt(self.effective_radius * np.maximum(overlap, 0.0))

    def normal_force(self, overlap: np.ndarray) -> np.ndarray:
        """(4/3) E* a d, N."""
        return 4.0 / 3.0 * self.effective_modulus * self.contact_radius(overlap) * overlap

    def shear_stiffness(self, overlap: np.ndarray) -> np.ndarray:
        """8 G* a, N/m (Mindlin 1949, no slip)."""
        return 8.0 * self.effective_shear_modulus * self.contact_radius(overlap)


def constant_restitution_damping(stiffness: np.ndarray, *, restitution: float, reduced_mass: float) -> np.ndarray:
    """Gamma = sqrt(10/3) beta sqrt(S m*), beta = -ln e/sqrt(ln^2 e + pi^2) (Antypov & Elliott 2011), kg/s.

    S (N/m): 2 E* a along the normal, the shear stiffness along the contact.
    """
    log = -math.log(restitution)
    return math.sqrt(10.0 / 3.0) * log / math.hypot(log, math.pi) * np.sqrt(stiffness * reduced_mass)


def hertz_force(
    overlap: np.ndarray, separation: np.ndarray, *, pair: ElasticPair, restitution: float, reduced_mass: float,
    clipped: bool,
) -> np.ndarray:
    """(4/3) E* a d - gamma d', (S,) in N."""
    stiffness = 2.0 * pair.effective_modulus * pair.contact_radius(overlap)
    gamma = constant_restitution_damping(stiffness, restitution=restitution, reduced_mass=reduced_mass)
    force = pair.normal_force(overlap) - gamma * separation
    return _touching(overlap, np.maximum(force, 0.0) if clipped else force)


def hysteretic_force(
    overlap: np.ndarray, separation: np.ndarray, *, loading: float, unloading: float, adhesion: float, damping: float
) -> np.ndarray:
    """k2 (d - D) + k1 D - gamma d', (S,) in N; the largest overlap D is held by d and (k2 + kc)/(k2 - k1) d."""
    ratio = (unloading + adhesion) / (unloading - loading)
    force = np.zeros(len(overlap))
    for rows in _contacts(overlap):
        d = overlap[rows]
        largest = held(d, ratio * d)
        force[rows] = unloading * (d - largest) + loading * largest - damping * separation[rows]
    return force


def variable_hysteretic_force(
    overlap: np.ndarray, separation: np.ndarray, *, loading: float, limit: float, adhesion: float, damping: float,
    limit_overlap: float,
) -> np.ndarray:
    """As `hysteretic_force` with k2 = k1 + (kp - k1) D/D*, D <= D* (`limit_overlap`), (S,) in N.

    NaN from the first adhesive row (f = -kc d) to the end of a contact: how far D is drawn back there, with the k2
    of before or of after, is the code's choice.
    """
    slope, force = (limit - loading) / limit_overlap, np.zeros(len(overlap))
    for rows in _contacts(overlap):
        d = overlap[rows]
        largest = held(np.minimum(d, limit_overlap), np.full(len(d), limit_overlap))
        elastic = (loading + slope * largest) * (d - largest) + loading * largest
        elastic[np.logical_or.accumulate(elastic <= -adhesion * d)] = np.nan
        force[rows] = elastic - damping * separation[rows]
    return force


def dmt_force(
    overlap: np.ndarray, separation: np.ndarray, *, pair: ElasticPair, surface_energy: float, damping: float
) -> np.ndarray:
    """(4/3) E* a d - 4 pi w R* - gamma d', (S,) in N (Derjaguin, Muller & Toporov 1975)."""
    attraction = 4.0 * math.pi * surface_energy * pair.effective_radius
    return _touching(overlap, pair.normal_force(overlap) - attraction - damping * separation)


def jkr_force(
    overlap: np.ndarray, separation: np.ndarray, *, pair: ElasticPair, surface_energy: float, damping: float,
    tearing_overlap: float,
) -> np.ndarray:
    """`jkr_elastic_force` - gamma d', (S,) in N, d' the rate of separation.

    Bodies that have touched (d > 0) hold on until d falls below `tearing_overlap` < 0.
    """
    force = np.zeros(len(overlap))
    held_on = _latched(overlap, tearing_overlap)
    force[held_on] = jkr_elastic_force(overlap[held_on], pair, surface_energy) - damping * separation[held_on]
    return force


def jkr_elastic_force(overlap: np.ndarray, pair: ElasticPair, surface_energy: float) -> np.ndarray:
    """4 E* a^3/(3 R*) - 4 sqrt(pi w E* a^3), (S,) in N, with d = a^2/R* - 2 sqrt(pi w a/E*), of a contact that holds.

    The contact radius is the stable root, found by halving an interval (Johnson, Kendall & Roberts 1971).
    """
    modulus, radius = pair.effective_modulus, pair.effective_radius
    a = _jkr_radius(overlap, modulus, radius, surface_energy)
    return 4.0 * modulus * a**3 / (3.0 * radius) - 4.0 * np.sqrt(math.pi * surface_energy * modulus) * a**1.5


def jkr_overlap_of_largest_pull(pair: ElasticPair, surface_energy: float) -> float:
    """Return -a^2/(3 R*) with a^3 = 9 pi w R*^2/(4 E*), m: where the pull is largest, 3 pi w R*.

    A weight hung on the contact tears it there; bodies whose distance is given would hold on a little further.
    """
    radius = pair.effective_radius
    cube = 9.0 * math.pi * surface_energy * radius**2 / (4.0 * pair.effective_modulus)
    return -(cube ** (2.0 / 3.0)) / (3.0 * radius)


def _jkr_radius(overlap: np.ndarray, modulus: float, radius: float, energy: float) -> np.ndarray:
    """Return the larger a of d(a) = a^2/R* - 2 sqrt(pi w a/E*): above the least d, d grows with a."""
    low = np.full(len(overlap), (math.pi * energy * radius**2 / (4.0 * modulus)) ** (1.0 / 3.0))
    high = 4.0 * low + np.sqrt(4.0 * radius * np.maximum(overlap, 0.0))
    for _ in range(80):
        middle = 0.5 * (low + high)
        below = middle**2 / radius - 2.0 * np.sqrt(math.pi * energy * middle / modulus) < overlap
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)


def _latched(overlap: np.ndarray, release: float) -> np.ndarray:
    """Where bodies hold each other: from d > 0 until d < `release`."""
    event = np.where(overlap > 0.0, 1, np.where(overlap < release, -1, 0))
    last = np.maximum.accumulate(np.where(event != 0, np.arange(len(event)), 0))
    return event[last] > 0


# --- friction, rolling, torsion --------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Slider:
    """A spring k and a dashpot gamma (numbers or (S,)) with a limit, driven along one line with steps dt."""

    stiffness: float | np.ndarray
    damping: float | np.ndarray
    dt: float
    cut: Cut

    def force(self, overlap: np.ndarray, rate: np.ndarray, limit: np.ndarray) -> np.ndarray:
        """Force against the slip, (S,); rate (S,) in m/s, limit (S,) >= 0 in N. The spring moves before it answers."""
        found = np.zeros(len(rate))
        for rows in _contacts(overlap):
            k, gamma = _at(self.stiffness, rows), _at(self.damping, rows)
            slip = np.cumsum(self.dt * rate[rows])
            dashpot = gamma * rate[rows]
            reach = limit[rows] / k
            shift = dashpot / k if self.cut == "total" else np.zeros(len(slip))
            slid = held(slip - (reach - shift), slip + (reach + shift))
            if self.cut == "spring":
                before = np.concatenate([[0.0], slid[:-1]])
                dashpot = np.where(np.abs(slip - before) > reach, 0.0, dashpot)
            found[rows] = -(k * (slip - slid) + dashpot)
        return found

    def lagging_force(self, overlap: np.ndarray, rate: np.ndarray, limit: np.ndarray) -> np.ndarray:
        """As `force` if the spring moves after it has answered, (S,): spring and dashpot are cut together.

        NaN from where the rate changes, or the spring's room grows, after a slide to the end of the contact: sliding
        leaves the spring at the limit, or one step beyond, as rounding decides.
        """
        found = np.zeros(len(rate))
        for rows in _contacts(overlap):
            found[rows] = self._lagging(_at(self.stiffness, rows), _at(self.damping, rows), rate[rows], limit[rows])
        return found

    def _lagging(self, k, gamma, v: np.ndarray, limit: np.ndarray) -> np.ndarray:
        slip = np.cumsum(self.dt * v) - self.dt * v
        test = -(k * slip + gamma * v)
        cut = np.abs(test) > limit
        slides, first = np.logical_or.accumulate(cut), int(np.argmax(cut))
        answer = np.where(slides, np.sign(test[first]) * limit, test)
        grows = np.diff((limit - gamma * np.abs(v)) / k, prepend=np.inf) > 0.0
        later = slides & (np.arange(len(v)) > first)
        answer[np.logical_or.accumulate(later & (grows | (v != v[first])))] = np.nan
        return answer

    def dynamic_force(
        self, overlap: np.ndarray, rate: np.ndarray, limit: np.ndarray, carried: np.ndarray, *, remembers: bool
    ) -> np.ndarray:
        """As `force` with a static limit and the lower one that a sliding contact carries, (S,) each.

        remembers: a contact that slides goes on sliding until its rate changes. Otherwise it sticks again at once,
        and on a leg of constant rate the force is a saw: from `carried` up to `limit` in n rows,
        n = floor((limit - carried)/(k |v| dt)) + 1. Without damping; NaN from the first row on which a limit
        changes after a slide.
        """
        found = np.zeros(len(rate))
        for rows in _contacts(overlap):
            found[rows] = self._dynamic(rate[rows], limit[rows], carried[rows], remembers)
        return found

    def _dynamic(self, rate: np.ndarray, limit: np.ndarray, carried: np.ndarray, remembers: bool) -> np.ndarray:
        spring, slid, found = 0.0, False, np.full(len(rate), np.nan)
        for leg in _constant(rate, limit):
            if slid and limit[leg.start] != limit[leg.start - 1]:
                break
            test = spring + self.stiffness * np.cumsum(self.dt * rate[leg])
            over = np.flatnonzero(np.abs(test) > limit[leg])
            if over.size:
                slid, first = True, leg.start + over[0]
                saw = self._saw(rate[first], limit[first], carried[first], leg.stop - first, remembers)
                test[over[0] :] = np.sign(test[over[0]]) * saw
            found[leg], spring = -test, test[-1]
        return found

    def _saw(self, rate: float, limit: float, carried: float, rows: int, remembers: bool) -> np.ndarray:
        """Size of the force from the first sliding row of a leg on."""
        rise = self.stiffness * abs(rate) * self.dt
        if remembers or rise == 0.0:
            return np.full(rows, carried)
        return carried + rise * (np.arange(rows) % (math.floor((limit - carried) / rise) + 1))


def viscous_force(rate: np.ndarray, limit: np.ndarray, *, damping: float) -> np.ndarray:
    """-min(gamma |v|, limit) v/|v|, (S,) in N (Laetzel, Luding & Herrmann 2000)."""
    return -np.sign(rate) * np.minimum(damping * np.abs(rate), limit)


# --- rows ------------------------------------------------------------------------------------------


def _legs(*paths: np.ndarray) -> Iterator[slice]:
    """Yield runs of rows along which every path moves one way or rests; a turning row ends its leg."""
    if not len(paths[0]):
        return
    signs = np.sign(np.stack([np.diff(p, prepend=p[:1]) for p in paths]))
    yield from _constant(*signs)


def _constant(*values: np.ndarray) -> Iterator[slice]:
    """Yield runs of rows on which none of the values changes."""
    breaks = 1 + np.flatnonzero(np.any([np.diff(v) != 0.0 for v in values], axis=0))
    edges = [0, *breaks.tolist(), len(values[0])]
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        yield slice(begin, end)


def _contacts(overlap: np.ndarray) -> Iterator[slice]:
    """Yield the runs of rows with overlap > 0."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], overlap > 0.0, [False]]).astype(int)))
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        yield slice(int(begin), int(end))


def _touching(overlap: np.ndarray, force: np.ndarray) -> np.ndarray:
    return np.where(overlap > 0.0, force, 0.0)


def _at(value: float | np.ndarray, rows: slice) -> float | np.ndarray:
    return value[rows] if isinstance(value, np.ndarray) else value
