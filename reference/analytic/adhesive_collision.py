"""Head-on collision of two elastic spheres that stick to each other: DMT and JKR, without damping.

With w the surface energy of each of the two surfaces (J/m^2; the work of adhesion is 2 w), E* and R* as in
`reference.analytic.hertz_collision`, a the contact radius, d the overlap:

`DmtCollision`
    F = (4/3) E* sqrt(R*) d^(3/2) - 4 pi w R*  for d > 0. B. V. Derjaguin, V. M. Muller, Yu. P. Toporov,
    J. Colloid Interface Sci. 53, 314 (1975). It does the same work on the way in and out: e = 1.
`JkrCollision`
    d = a^2/R* - 2 sqrt(pi w a/E*),  F = 4 E* a^3/(3 R*) - 4 sqrt(pi w E* a^3).
    K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. Lond. A 324, 301 (1971). The surfaces jump into
    contact at d = 0 and tear at the least overlap that has an equilibrium, where dd/da = 0 (d is prescribed by
    the motion). The energy between the two is lost: C. Thornton, Z. Ning, Powder Technol. 99, 154 (1998).

Energy stored at contact radius a, the integral of F dd from a = 0::

    U(a) = 8 E* a^5/(15 R*^2) - (8/3) sqrt(pi w E*) a^(7/2)/R* + 2 pi w a^2

Speeds in m/s, compression positive. Valid for small overlaps and no other force on the pair; R* = R and
m* = m against an immovable plane of the same material. The tests integrate the equations of motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from reference.analytic.hertz_collision import hertz_stiffness


@dataclass(frozen=True, kw_only=True)
class AdhesivePair:
    """E* (Pa), R* (m), m* (kg) and w (J/m^2), all > 0."""

    effective_modulus: float
    effective_radius: float
    reduced_mass: float
    surface_energy: float

    def energy_in(self, speed: float) -> float:
        """m* v^2/2, J."""
        return 0.5 * self.reduced_mass * speed**2


@dataclass(frozen=True, kw_only=True)
class DmtCollision(AdhesivePair):
    """Hertz with a constant attraction.

    >>> pair = DmtCollision(effective_modulus=1e8, effective_radius=1e-3, reduced_mass=1e-6, surface_energy=0.05)
    >>> f"{pair.pull_off_force:.4e} {pair.largest_overlap(0.1):.4e}"
    '6.2832e-04 1.6666e-06'
    """

    @property
    def pull_off_force(self) -> float:
        """4 pi w R*, N."""
        return 4 * math.pi * self.surface_energy * self.effective_radius

    def largest_overlap(self, speed: float) -> float:
        """Overlap at rest, m: the root of (2/5) k d^(5/2) - F_0 d = m* v^2/2, k = (4/3) E* sqrt(R*)."""
        k, attraction, energy = self._hertz, self.pull_off_force, self.energy_in(speed)
        above = max((5 * attraction / k) ** (2 / 3), (5 * energy / k) ** 0.4)
        return _root_below(
            above, lambda d: 0.4 * k * d**2.5 - attraction * d - energy, lambda d: k * d**1.5 - attraction
        )

    def stiffness(self, overlap: float) -> float:
        """dF/dd = 2 E* sqrt(R* d), N/m."""
        return 1.5 * self._hertz * math.sqrt(overlap)

    @property
    def _hertz(self) -> float:
        return hertz_stiffness(effective_modulus=self.effective_modulus, effective_radius=self.effective_radius)


@dataclass(frozen=True, kw_only=True)
class JkrCollision(AdhesivePair):
    """Hertz with attraction inside the contact, which holds on beyond overlap zero.

    >>> pair = JkrCollision(effective_modulus=1e8, effective_radius=1e-3, reduced_mass=1e-6, surface_energy=0.05)
    >>> f"{pair.pull_off_force:.4e} {pair.sticking_speed:.4e} {pair.restitution(0.1):.5f}"
    '4.7124e-04 1.1910e-02 0.99288'
    """

    @property
    def pull_off_force(self) -> float:
        """3 pi w R*, N: the largest attraction."""
        return 3 * math.pi * self.surface_energy * self.effective_radius

    @property
    def touching_radius(self) -> float:
        """Contact radius at d = 0, m: a_0^3 = 4 pi w R*^2/E*."""
        return (4 * math.pi * self.surface_energy * self.effective_radius**2 / self.effective_modulus) ** (1 / 3)

    @property
    def tearing_radius(self) -> float:
        """Contact radius where dd/da = 0, m: a_c^3 = pi w R*^2/(4 E*)."""
        return self.touching_radius / 16 ** (1 / 3)

    @property
    def tearing_overlap(self) -> float:
        """The overlap at which the surfaces part, m, < 0: -3 a_c^2/R*."""
        return -3 * self.tearing_radius**2 / self.effective_radius

    @property
    def energy_lost(self) -> float:
        """Work done between jumping in and tearing, J: U(a_c) - U(a_0) = E* (3.2 a_c^5 + 0.3 a_0^5)/R*^2.

        7.09 ((2 w)^5 R*^4/E*^2)^(1/3) in the notation of Thornton and Ning.
        """
        lengths = 3.2 * self.tearing_radius**5 + 0.3 * self.touching_radius**5
        return self.effective_modulus / self.effective_radius**2 * lengths

    @property
    def sticking_speed(self) -> float:
        """Up to this approach speed the bodies stick, m/s."""
        return math.sqrt(2 * self.energy_lost / self.reduced_mass)

    def restitution(self, speed: float) -> float:
        """Separation speed / approach speed, between 0 (sticks) and 1, at approach speed > 0."""
        return math.sqrt(max(0.0, 1 - (self.sticking_speed / speed) ** 2))

    def overlap(self, radius: float) -> float:
        """d (m) at contact radius a (m)."""
        return radius**2 / self.effective_radius - 2 * math.sqrt(
            math.pi * self.surface_energy * radius / self.effective_modulus
        )

    def force(self, radius: float) -> float:
        """F (N) at contact radius a (m), positive in compression."""
        hertz = 4 * self.effective_modulus * radius**3 / (3 * self.effective_radius)
        return hertz - 4 * self._root * radius**1.5

    def energy(self, radius: float) -> float:
        """U (J) at contact radius a (m)."""
        e, r = self.effective_modulus, self.effective_radius
        bulk = 8 * e * radius**5 / (15 * r**2) - 8 / 3 * self._root * radius**3.5 / r
        return bulk + 2 * math.pi * self.surface_energy * radius**2

    def largest_radius(self, speed: float) -> float:
        """Contact radius at rest, m: the root of U(a) = U(a_0) + m* v^2/2 where F > 0."""
        energy, e, r = self.energy_in(speed), self.effective_modulus, self.effective_radius
        above = max(3 ** (2 / 3) * self.touching_radius, (5 * energy * r**2 / e) ** 0.2)
        start = self.energy(self.touching_radius)
        while self.energy(above) < start + energy:
            above *= 2
        return _root_below(
            above, lambda a: self.energy(a) - start - energy, lambda a: self.force(a) * self._overlap_rate(a)
        )

    def largest_overlap(self, speed: float) -> float:
        """Overlap at rest, m, reached with approach speed `speed`."""
        return self.overlap(self.largest_radius(speed))

    def stiffness(self, radius: float) -> float:
        """dF/dd at contact radius a (m) above `tearing_radius`, N/m."""
        rate = 4 * self.effective_modulus * radius**2 / self.effective_radius - 6 * self._root * math.sqrt(radius)
        return rate / self._overlap_rate(radius)

    def _overlap_rate(self, radius: float) -> float:
        """dd/da, a pure number."""
        return 2 * radius / self.effective_radius - self._root / (self.effective_modulus * math.sqrt(radius))

    @property
    def _root(self) -> float:
        """sqrt(pi w E*)."""
        return math.sqrt(math.pi * self.surface_energy * self.effective_modulus)


def _root_below(start: float, function: Callable[[float], float], slope: Callable[[float], float]) -> float:
    """Return the root that Newton's steps fall to from above, where the function is convex and rises."""
    x = start
    for _ in range(200):
        after = x - function(x) / slope(x)
        if not 0 < after < x:
            break
        x = after
    return x
