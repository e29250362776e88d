"""Head-on collision of two bodies with a linear spring and dashpot, in closed form.

Equation of motion of the overlap, from first touch at t = 0 with approach speed v::

    m* d'' = -k d - gamma d',      d(0) = 0,  d'(0) = v,      m* = m_i m_j / (m_i + m_j)

with b = gamma/(2 m*), w0 = sqrt(k/m*), w = sqrt(w0^2 - b^2). The force that drives the bodies apart
is f = k d + gamma d'. Where the contact ends is part of the law:

``attraction="allowed"``
    the contact ends at d = 0; just before, f < 0 holds the bodies back. Duration pi/w, restitution
    e = exp(-pi b/w). For b >= w0 they never part: duration infinite, e = 0.
``attraction="clipped"``
    the contact ends at f = 0. Duration (2/w) atan(w/b), restitution e = exp(-b t), for any damping.

Source: T. Schwager, T. Poeschel, Coefficient of restitution and linear-dashpot model revisited,
Granular Matter 9, 465-469 (2007). Their branches for b below and above w0/sqrt(2) are one function,
atan(w/b) being half of atan2(2 b w, b^2 - w^2); for b > w0 it continues as asinh(W/w0)/W with
W = sqrt(b^2 - w0^2), which stays accurate through b = w0, where the duration is 2/w0 and e = exp(-2).

Valid for constant k and gamma and no other force on the pair: with gravity e depends on the speed.
A body against an immovable wall is the limit m* = m. The tests integrate the equation of motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

Attraction = Literal["allowed", "clipped"]


@dataclass(frozen=True, kw_only=True)
class LinearCollision:
    """One pair: stiffness k (N/m) > 0, damping gamma (kg/s) >= 0, reduced mass m* (kg) > 0.

    In 2D per unit thickness with k in N/m^2, gamma in kg/(m s), m* in kg/m: the formulas are the same.

    >>> pair = LinearCollision(stiffness=1.0, damping=0.6, reduced_mass=1.0)
    >>> round(pair.restitution("allowed"), 6), round(pair.restitution("clipped"), 6)
    (0.372326, 0.450975)
    """

    stiffness: float
    damping: float
    reduced_mass: float

    @property
    def natural_frequency(self) -> float:
        """w0 = sqrt(k/m*), rad/s."""
        return math.sqrt(self.stiffness / self.reduced_mass)

    @property
    def decay_rate(self) -> float:
        """B = gamma/(2 m*), 1/s."""
        return self.damping / (2 * self.reduced_mass)

    @property
    def damping_ratio(self) -> float:
        """b/w0: below 1 the pair oscillates, from 1 on it is overdamped."""
        return self.decay_rate / self.natural_frequency

    @property
    def critical_damping(self) -> float:
        """The gamma of damping ratio 1: 2 sqrt(k m*), kg/s."""
        return 2 * math.sqrt(self.stiffness * self.reduced_mass)

    @property
    def overdamped(self) -> bool:
        """Whether b >= w0."""
        return self.damping_ratio >= 1

    @property
    def frequency(self) -> float:
        """w = sqrt(|w0^2 - b^2|), rad/s: of the oscillation, or the rate of the overdamped approach."""
        w0, b = self.natural_frequency, self.decay_rate
        return math.sqrt(abs(w0 - b) * (w0 + b))

    def duration(self, attraction: Attraction) -> float:
        """Time from first touch to the end of the contact, s; infinite if it never ends."""
        if attraction == "clipped":
            return 2 * self.time_of_maximum
        return math.inf if self.overdamped else math.pi / self.frequency

    def restitution(self, attraction: Attraction) -> float:
        """E = separation speed / approach speed, between 0 and 1."""
        if attraction == "allowed" and self.overdamped:
            return 0.0
        return math.exp(-self.decay_rate * self.duration(attraction))

    @property
    def time_of_maximum(self) -> float:
        """Time of the largest overlap, s: atan(w/b)/w, the half of the clipped duration."""
        w0, b, w = self.natural_frequency, self.decay_rate, self.frequency
        if w == 0:
            return 1 / w0
        return math.asinh(w / w0) / w if b > w0 else math.atan2(w, b) / w

    def largest_overlap(self, speed: float) -> float:
        """Overlap at `time_of_maximum`, m: (v/w0) exp(-b t)."""
        return speed / self.natural_frequency * math.exp(-self.decay_rate * self.time_of_maximum)

    def motion(self, time: np.ndarray, speed: float) -> tuple[np.ndarray, np.ndarray]:
        """Overlap (m) and its rate (m/s) at `time` (s, any shape) while the contact lasts.

        d = v exp(-b t) S(t), S = sin(w t)/w, t or sinh(W t)/W; d' = v exp(-b t) (S' - b S).
        """
        time = np.asarray(time, dtype=float)
        if self.overdamped:
            return self._overdamped_motion(time, speed)
        b, w = self.decay_rate, self.frequency
        decay = speed * np.exp(-b * time)
        shape = np.sin(w * time) / w
        return decay * shape, decay * (np.cos(w * time) - b * shape)

    def _overdamped_motion(self, time: np.ndarray, speed: float) -> tuple[np.ndarray, np.ndarray]:
        """Write sinh and cosh as decaying exponentials, which cannot overflow; exp((W-b)t) is the slow one."""
        w0, b, w = self.natural_frequency, self.decay_rate, self.frequency
        slow = speed * np.exp(-(w0**2) / (b + w) * time)
        fast = np.expm1(-2 * w * time)
        shape = time if w == 0 else -fast / (2 * w)
        return slow * shape, slow * ((2 + fast) / 2 - b * shape)

    def force(self, time: np.ndarray, speed: float) -> np.ndarray:
        """F = k d + gamma d' (N), positive when it drives the bodies apart."""
        overlap, rate = self.motion(time, speed)
        return self.stiffness * overlap + self.damping * rate


def damping_for_restitution(restitution: float, *, stiffness: float, reduced_mass: float) -> float:
    """Return the gamma (kg/s) that gives `restitution` in (0, 1] when attraction is allowed.

    Inverse of e = exp(-pi b/w): b/w0 = |ln e|/sqrt(pi^2 + ln^2 e).

    Raises ValueError for a restitution outside (0, 1].
    """
    if not 0 < restitution <= 1:
        raise ValueError(f"restitution must lie in (0, 1], got {restitution!r}")
    log = abs(math.log(restitution))
    return 2 * math.sqrt(stiffness * reduced_mass) * log / math.hypot(math.pi, log)
