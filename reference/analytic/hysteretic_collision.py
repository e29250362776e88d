"""Head-on collision with the piecewise linear, hysteretic, adhesive law, without damping.

The force on the overlap d, positive when it drives the bodies apart, after a largest overlap D::

    f = k1 d            loading, d = D
    f = k2 (d - d0)     un- and reloading,   d0 = (1 - k1/k2) D
    f = -kc d           adhesive branch, for d <= d_min = (k2 - k1)/(k2 + kc) D;  f_min = -kc d_min

Source: S. Luding, Cohesive, frictional powders: contact models for tension, Granular Matter 10,
235-246 (2008). Compression is positive here.

Work done along the branches gives the restitution, in both laws with the k2 of this collision::

    e^2 = k1/k2 - (kc/k1) (k2 - k1)^2 / (k2 (k2 + kc)),    the bodies stick if this is not positive

Two laws, not one, share these branches:

`ConstantUnloading`
    one k2 for every contact (S. Luding's talks of 2004 and 2005). D is proportional to the speed v,
    and e does not depend on v. The bodies stick if k2 > 2 k1 and kc >= k1^2/(k2 - 2 k1).
`OverlapUnloading`
    k2 grows with D from k1 to kp (the paper of 2008), so e falls with v, and rises again beyond the
    plastic limit. A small plasticity depth does not turn this law into the other.

Valid for a first touch (no history), bodies that part at once, no damping and no other force on the
pair; m* = m against an immovable wall. The tests integrate the equation of motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class ConstantUnloading:
    """One pair: k1, k2, kc (N/m), 0 < k1 <= k2, 0 <= kc; reduced mass m* (kg) > 0.

    Raises ValueError unless 0 < k1 <= k2 and kc >= 0.

    >>> pair = ConstantUnloading(loading=100.0, unloading=200.0, adhesion=100.0, reduced_mass=1e-6)
    >>> round(pair.restitution ** 2, 6), pair.duration < 1, pair.sticking_adhesion
    (0.333333, True, inf)
    """

    loading: float
    unloading: float
    adhesion: float
    reduced_mass: float

    def __post_init__(self) -> None:
        if not 0 < self.loading <= self.unloading:
            raise ValueError(f"expected 0 < loading <= unloading, got {self.loading!r} and {self.unloading!r}")
        if self.adhesion < 0:
            raise ValueError(f"adhesion must not be negative, got {self.adhesion!r}")

    def largest_overlap(self, speed: float) -> float:
        """D = v sqrt(m*/k1), m, of a first touch with approach speed `speed` (m/s)."""
        return speed * math.sqrt(self.reduced_mass / self.loading)

    def release_overlap(self, largest: float) -> float:
        """Overlap d0 where the unloading branch crosses f = 0, m, after a largest overlap (m)."""
        return (1 - self.loading / self.unloading) * largest

    def overlap_of_attraction(self, largest: float) -> float:
        """Overlap d_min where the unloading branch meets the adhesive one, m, after a largest overlap (m)."""
        return (self.unloading - self.loading) / (self.unloading + self.adhesion) * largest

    def largest_attraction(self, largest: float) -> float:
        """f_min = -kc d_min <= 0, N: the force of strongest attraction after a largest overlap (m)."""
        return -self.adhesion * self.overlap_of_attraction(largest)

    def force(self, overlap: np.ndarray, largest: float) -> np.ndarray:
        """Force (N) at `overlap` (m, any shape) on the way back from `largest`; 0 where the bodies are apart."""
        overlap = np.asarray(overlap, dtype=float)
        back = self.unloading * (overlap - self.release_overlap(largest))
        return np.where(overlap > 0, np.maximum(-self.adhesion * overlap, back), 0.0)

    @property
    def restitution_squared(self) -> float:
        """Energy kept / energy brought in; not positive if the bodies stick."""
        k1, k2, kc = self.loading, self.unloading, self.adhesion
        return k1 / k2 - kc / k1 * (k2 - k1) ** 2 / (k2 * (k2 + kc))

    @property
    def sticks(self) -> bool:
        """Whether the adhesive branch takes up all that plasticity left of the energy."""
        return self.adhesion >= self.sticking_adhesion

    @property
    def sticking_adhesion(self) -> float:
        """The least kc (N/m) with which the bodies stick: k1^2/(k2 - 2 k1); infinite if k2 <= 2 k1."""
        excess = self.unloading - 2 * self.loading
        return self.loading**2 / excess if excess > 0 else math.inf

    @property
    def restitution(self) -> float:
        """Separation speed / approach speed, between 0 (sticks) and 1; the same at every speed."""
        return 0.0 if self.sticks else math.sqrt(self.restitution_squared)

    @property
    def duration(self) -> float:
        """Time with d > 0, s, the same at every speed; infinite if the bodies stick.

        A quarter period on k1, the arc cosine on k2 from D to d_min, the hyperbolic rest on kc::

            t = (pi/2)/w1 + acos(-kc d_min/(k1 D))/w2 + atanh(wc d_min/u)/wc,     w^2 = k/m*

        with u the speed at d_min; for kc = 0 the last term is the coasting from d0 to 0, d0/u.
        """
        if self.sticks:
            return math.inf
        w1, w2, wc = (math.sqrt(k / self.reduced_mass) for k in (self.loading, self.unloading, self.adhesion))
        d_min = self.overlap_of_attraction(1.0)
        angle = math.acos(self.largest_attraction(1.0) / self.loading)
        u = w2 * self.loading / self.unloading * math.sin(angle)
        last = math.atanh(wc * d_min / u) / wc if wc else d_min / u
        return 0.5 * math.pi / w1 + angle / w2 + last


@dataclass(frozen=True, kw_only=True)
class OverlapUnloading:
    """One pair whose k2 grows with the largest overlap D, up to kp at D* = kp/(kp - k1) phi r.

    k2 = k1 + (kp - k1) D/D* below D*; beyond it the contact loads and unloads along kp (d - phi r).
    loading, limit, adhesion: k1, kp, kc (N/m), 0 < k1 < kp, 0 <= kc. plasticity_depth: phi (-) > 0.
    pair_radius: r = 2 a_i a_j/(a_i + a_j) (m); 2 a against a wall. reduced_mass: m* (kg) > 0.

    The k2 reached at D decides. A code that lowers D on the adhesive branch and evaluates k2 anew stays on
    that branch all the same: the memory makes a difference only where the bodies are pressed together again.

    Raises ValueError unless 0 < k1 < kp, kc >= 0 and phi > 0.

    >>> pair = OverlapUnloading(loading=100.0, limit=500.0, adhesion=100.0, plasticity_depth=0.05,
    ...                         pair_radius=1e-3, reduced_mass=8.3775804e-6)
    >>> round(pair.restitution(0.01), 6)
    0.911296
    """

    loading: float
    limit: float
    adhesion: float
    plasticity_depth: float
    pair_radius: float
    reduced_mass: float

    def __post_init__(self) -> None:
        if not 0 < self.loading < self.limit:
            raise ValueError(f"expected 0 < loading < limit, got {self.loading!r} and {self.limit!r}")
        if self.adhesion < 0 or not self.plasticity_depth > 0:
            raise ValueError("expected adhesion >= 0 and plasticity_depth > 0, "
                             f"got {self.adhesion!r} and {self.plasticity_depth!r}")

    @property
    def limit_overlap(self) -> float:
        """D* = kp/(kp - k1) phi r, m, where k2 reaches kp."""
        return self.limit / (self.limit - self.loading) * self.plasticity_depth * self.pair_radius

    @property
    def limit_speed(self) -> float:
        """The approach speed that just reaches D*, m/s."""
        return self.limit_overlap * math.sqrt(self.loading / self.reduced_mass)

    def unloading(self, largest: float) -> float:
        """k2 after a largest overlap (m), N/m."""
        return self.loading + (self.limit - self.loading) * min(1.0, largest / self.limit_overlap)

    def branches(self, largest: float) -> ConstantUnloading:
        """The branches of a contact whose largest overlap (m) was at most D*."""
        return ConstantUnloading(
            loading=self.loading, unloading=self.unloading(largest), adhesion=self.adhesion,
            reduced_mass=self.reduced_mass,
        )

    def largest_overlap(self, speed: float) -> float:
        """Overlap at rest, m, of a first touch with approach speed `speed` (m/s)."""
        k1, kp, end = self.loading, self.limit, self.limit_overlap
        if speed <= self.limit_speed:
            return speed * math.sqrt(self.reduced_mass / k1)
        force = math.hypot(k1 * end, math.sqrt(kp * self.reduced_mass * (speed**2 - self.limit_speed**2)))
        return self.plasticity_depth * self.pair_radius + force / kp

    def restitution_squared(self, speed: float) -> float:
        """Energy kept / energy brought in at approach speed `speed` > 0 (m/s); not positive if the bodies stick.

        Beyond the limit speed v* no more energy is lost than at v*: 1 - (v*/v)^2 (1 - e*^2).
        """
        slowest = min(speed, self.limit_speed)
        lost = 1 - self.branches(self.largest_overlap(slowest)).restitution_squared
        return 1 - (slowest / speed) ** 2 * lost

    def restitution(self, speed: float) -> float:
        """Separation speed / approach speed at `speed` > 0 (m/s), between 0 (sticks) and 1."""
        return math.sqrt(max(0.0, self.restitution_squared(speed)))

    @property
    def sticking_speeds(self) -> tuple[float, float] | None:
        """Lowest and highest approach speed (m/s) that sticks, or None if none does.

        From where k2 = 2 k1 + k1^2/kc up to v* sqrt(1 - e*^2), e*^2 being negative between.
        """
        k1 = self.loading
        first = 2 * k1 + k1**2 / self.adhesion if self.adhesion else math.inf
        if first > self.limit:
            return None
        kept = self.branches(self.limit_overlap).restitution_squared
        return (first - k1) / (self.limit - k1) * self.limit_speed, self.limit_speed * math.sqrt(1 - kept)
