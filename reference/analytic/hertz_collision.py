"""Head-on collision of two elastic spheres, undamped or with the damping that keeps e constant.

Equation of motion of the overlap, from first touch at t = 0 with approach speed v::

    m* d'' = -k d^(3/2) - alpha sqrt(m* k) d^(1/4) d',      d(0) = 0,  d'(0) = v,      k = (4/3) E* sqrt(R*)

Undamped (alpha = 0; H. Hertz, 1882)::

    d_max = (5 m* v^2 / (4 k))^(2/5),   F_max = k d_max^(3/2),   t_c = 4 sqrt(pi) Gamma(2/5) / (5 Gamma(9/10)) d_max/v

Damped: with x = d^(5/4) and a clock ds = d^(1/4) dt the equation turns into the linear oscillator
x_ss + alpha sqrt(k/m*) x_s + (5/4)(k/m*) x = 0, started at x = 0 with x_s = (5/4) v. Damping ratio
z = alpha/sqrt(5). As d' = (4/5) x_s and the force is proportional to x_ss, the restitution is that of
the linear oscillator, at any speed and for both ends of the contact: exp(-pi z/sqrt(1 - z^2)) if the
contact ends at d = 0, the expression of Schwager and Poeschel if it ends at f = 0.
Source: D. Antypov, J. A. Elliott, On an analytical solution for the damped Hertzian spring, EPL 94,
50004 (2011), for the contact that ends at d = 0. The duration is the integral of x^(-1/5) ds over half
a period, I. S. Gradshteyn, I. M. Ryzhik, Table of Integrals, 3.892.1 with a real exponential.

Valid for small overlaps (d << R*), no adhesion and no other force on the pair.
A sphere against an immovable wall is the limit m* = m, R* = R. The tests integrate the equation of motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from reference.analytic.linear_collision import Attraction, LinearCollision, damping_for_restitution

TSUJI = (1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218)
"""Coefficients of 1, e, ..., e^6 in alpha(e) of LAMMPS' `damping tsuji`."""


@dataclass(frozen=True, kw_only=True)
class HertzCollision:
    """One pair: stiffness k (N/m^1.5) > 0, reduced mass m* (kg) > 0, damping factor alpha (-) >= 0.

    >>> glass = HertzCollision(stiffness=hertz_stiffness(effective_modulus=25e9, effective_radius=0.005),
    ...                        reduced_mass=5.864e-3)
    >>> f"{glass.largest_overlap(20.0):.4e} {glass.force_at_largest_overlap(20.0):.4e} {glass.duration(20.0):.3e}"
    '2.7411e-04 1.0697e+04 4.034e-05'
    """

    stiffness: float
    reduced_mass: float
    damping_factor: float = 0.0

    @property
    def oscillator(self) -> LinearCollision:
        """The linear oscillator in x = d^(5/4) (m^(5/4)); its rates count in s = integral of d^(1/4) dt."""
        return LinearCollision(
            stiffness=1.25 * self.stiffness, reduced_mass=self.reduced_mass,
            damping=self.damping_factor * math.sqrt(self.stiffness * self.reduced_mass),
        )

    @property
    def damping_ratio(self) -> float:
        """z = alpha/sqrt(5): from 1 on the bodies never part if attraction is allowed."""
        return self.damping_factor / math.sqrt(5)

    def restitution(self, attraction: Attraction) -> float:
        """Separation speed / approach speed, between 0 and 1; the same at every speed."""
        return self.oscillator.restitution(attraction)

    def largest_overlap(self, speed: float) -> float:
        """Overlap at rest, m, reached with approach speed `speed` (m/s)."""
        return self.oscillator.largest_overlap(1.25 * speed) ** 0.8

    def force_at_largest_overlap(self, speed: float) -> float:
        """k d_max^(3/2), N: the largest force if alpha = 0; with damping the largest force comes earlier."""
        return self.stiffness * self.largest_overlap(speed) ** 1.5

    def force(self, overlap: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Force that drives the bodies apart, N, at `overlap` >= 0 (m) and its `rate` (m/s), any shape."""
        overlap = np.asarray(overlap, dtype=float)
        damping = self.damping_factor * math.sqrt(self.reduced_mass * self.stiffness)
        return self.stiffness * overlap**1.5 + damping * overlap**0.25 * np.asarray(rate, dtype=float)

    def duration(self, speed: float) -> float:
        """Time from first touch until d = 0 again (attraction allowed), s; infinite if alpha >= sqrt(5).

        With a = b/(5 w), b and w decay rate and frequency of the oscillator, X = (5/4) v/w::

            t = pi 2^(1/5) Gamma(4/5) exp(pi a/2) / |Gamma(9/10 + i a/2)|^2 / (w X^(1/5))

        The contact that ends at f = 0 has no such form.
        """
        from scipy.special import loggamma

        linear = self.oscillator
        if linear.overdamped:
            return math.inf
        a = linear.decay_rate / (5 * linear.frequency)
        half_period = math.exp(0.5 * math.pi * a - 2 * loggamma(0.9 + 0.5j * a).real)
        amplitude = 1.25 * speed / linear.frequency
        return math.pi * 2**0.2 * math.gamma(0.8) * half_period / (linear.frequency * amplitude**0.2)


def effective_modulus(*, young: tuple[float, float], poisson: tuple[float, float]) -> float:
    """E* (Pa) of two materials: 1/E* = sum (1 - nu^2)/E. A rigid wall has E = math.inf."""
    return 1 / sum((1 - nu**2) / e for e, nu in zip(young, poisson, strict=True))


def effective_radius(radius_i: float, radius_j: float = math.inf) -> float:
    """R* (m) of two spheres: 1/R* = 1/R_i + 1/R_j. A plane has R = math.inf."""
    return 1 / (1 / radius_i + 1 / radius_j)


def hertz_stiffness(*, effective_modulus: float, effective_radius: float) -> float:
    """k = (4/3) E* sqrt(R*), N/m^1.5, from E* (Pa) and R* (m)."""
    return 4 / 3 * effective_modulus * math.sqrt(effective_radius)


def damping_factor_for_restitution(restitution: float) -> float:
    """Return the alpha that gives `restitution` in (0, 1] if attraction is allowed: sqrt(5) |ln e|/sqrt(pi^2 + ln^2 e).

    Raises ValueError for a restitution outside (0, 1].

    >>> round(damping_factor_for_restitution(0.5), 6)
    0.481769
    """
    return damping_for_restitution(restitution, stiffness=1.25, reduced_mass=1.0)


def tsuji_damping_factor(restitution: float) -> float:
    """Return the alpha that LAMMPS' `damping tsuji` uses when it is asked for `restitution` in [0, 1].

    It is about 1/sqrt(2) of the alpha that gives this restitution. Y. Tsuji, T. Tanaka, T. Ishida, Powder
    Technology 71, 239-250 (1992), gave alpha(e) as a curve; the polynomial is the fit in LAMMPS (22 Jul 2025).

    Raises ValueError for a restitution outside [0, 1].
    """
    if not 0 <= restitution <= 1:
        raise ValueError(f"restitution must lie in [0, 1], got {restitution!r}")
    return sum(c * restitution**power for power, c in enumerate(TSUJI))


def restitution_under_tsuji(asked: float) -> float:
    """Return the restitution that LAMMPS' `damping tsuji` really gives when `asked` is typed (attraction allowed).

    Raises ValueError for `asked` outside [0, 1].

    >>> round(restitution_under_tsuji(0.9), 6), round(restitution_under_tsuji(0.5), 6)
    (0.928355, 0.616076)
    """
    pair = HertzCollision(stiffness=1.0, reduced_mass=1.0, damping_factor=tsuji_damping_factor(asked))
    return pair.restitution("allowed")
