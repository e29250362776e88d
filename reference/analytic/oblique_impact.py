"""Oblique impact of a sphere or disc on a plane, or on another one, with Coulomb friction.

Two bodies meet with approach speed v_n and relative tangential velocity. The slip is that of the surfaces::

    s = u_i - u_j + R_i w_i + R_j w_j           (a plane: u_j = 0, w_j = 0)

for i on the side of the positive normal y, tangent x, spins w counterclockwise: a ball that rolls on a
plane towards +x has w = -u/R. With moments of inertia I = q m R^2 (sphere 2/5, disc 1/2), the same q in
both bodies, and a tangential restitution B the impact leaves the slip -B s, and

    du_i = -(m*/m_i) (1 + B) s q/(1 + q),     R_i dw_i = du_i/q;      the opposite du_j; R_j dw_j = -du_j/q

Gross sliding: the friction force is mu f_n against the slip all the time, so its impulse is
mu (1 + e) m* v_n, and B = -1 + mu (1 + e)(1 + 1/q) v_n/|s| <= 0: the slip must not come to an end,

    |s| >= (1 + 1/q) mu (1 + e) v_n           (3D sphere: 7/2, 2D disc: 3)

Walton and Braun: B is that value but at most B0, the sticking value, a property of the surfaces.
Sources: rigid-body impulse and momentum; O. R. Walton, R. L. Braun, Viscosity, granular-temperature and
stress calculations for shearing assemblies of inelastic, frictional disks, J. Rheol. 30, 949-980 (1986);
S. F. Foerster, M. Y. Louge, H. Chang, K. Allia, Phys. Fluids 6, 1108-1115 (1994).

Valid for motions in the plane of the normal and the slip and for contacts that are short and small
(d << R: codes with a lever arm R - d/2 differ by d/R). A dashpot that attracts at the end of the contact
breaks the gross-sliding formula, Coulomb's limit being on |f_n| or cut off there, not on the impulse;
and a tangential spring starts slack, so that damping at first touch (f_n > 0 at d = 0) makes it stick
for a moment. All arguments broadcast; speeds in m/s, spins in rad/s. The tests integrate Coulomb's law.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class ObliqueImpact:
    """Two surfaces: inertia factor q (-) in (0, 1], friction mu (-) >= 0, normal restitution e in [0, 1].

    `normal` below is the approach speed v_n > 0, `slip` the slip s before the impact, both m/s.

    >>> ball = ObliqueImpact(inertia_factor=0.4, friction=0.092, restitution=0.98)
    >>> round(math.degrees(ball.sliding_angle), 2)
    32.52
    >>> u, w = ball.on_plane(normal=1.0, tangential=1.0, spin=0.0, radius=0.0025)
    >>> round(float(u), 5), round(float(w), 3)
    (0.81784, -182.16)
    """

    inertia_factor: float
    friction: float
    restitution: float

    @property
    def mobility(self) -> float:
        """Change of the slip per change of the relative tangential velocity: 1 + 1/q."""
        return 1 + 1 / self.inertia_factor

    def sliding_limit(self, normal: np.ndarray) -> np.ndarray:
        """The least |s| that slides to the end, m/s."""
        return self.mobility * self.friction * (1 + self.restitution) * np.asarray(normal, dtype=float)

    @property
    def sliding_angle(self) -> float:
        """The least impact angle that slides to the end, rad from the normal, for bodies without spin."""
        return math.atan(self.sliding_limit(1.0))

    def slides(self, normal: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Whether the bodies slide during the whole impact."""
        return np.abs(slip) >= self.sliding_limit(normal)

    def tangential_restitution(self, normal: np.ndarray, slip: np.ndarray, sticking: float | None = None) -> np.ndarray:
        """B = -(slip after)/(slip before), from -1 (no friction) to `sticking`, B0 in [-1, 1].

        Without slip B is B0, or 0 if there is none. Without `sticking` the bodies must slide.

        Raises ValueError if `sticking` is None and the slip would end during the impact.
        """
        slip = np.abs(np.asarray(slip, dtype=float))
        limit = self.sliding_limit(normal)
        if sticking is None and np.any((slip < limit) & (slip > 0)):
            raise ValueError(f"no gross sliding: slip {slip} m/s, needed at least {limit} m/s; name a sticking value")
        highest = sticking if sticking is not None else 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(slip > 0, np.minimum(highest, limit / slip - 1), highest)

    def kick(self, normal: np.ndarray, slip: np.ndarray, sticking: float | None = None) -> np.ndarray:
        """Change of the relative tangential velocity u_i - u_j, m/s, against the slip.

        Raises ValueError as `tangential_restitution`.
        """
        b = self.tangential_restitution(normal, slip, sticking)
        return -(1 + b) * np.asarray(slip, dtype=float) / self.mobility

    def on_plane(
        self, *, normal: np.ndarray, tangential: np.ndarray, spin: np.ndarray, radius: float,
        sticking: float | None = None,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Tangential velocity of the centre (m/s) and spin (rad/s) after the impact on a fixed plane.

        Raises ValueError as `tangential_restitution`.
        """
        tangential, spin = np.asarray(tangential, dtype=float), np.asarray(spin, dtype=float)
        kick = self.kick(normal, tangential + radius * spin, sticking)
        return tangential + kick, spin + kick / (self.inertia_factor * radius)

    def of_pair(
        self, *, normal: np.ndarray, tangential: tuple[np.ndarray, np.ndarray], spin: tuple[np.ndarray, np.ndarray],
        radius: tuple[float, float], mass: tuple[float, float], sticking: float | None = None,
    ) -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]:
        """Tangential velocities (m/s) and spins (rad/s) of both bodies after the impact; masses in kg.

        `normal` is the speed of approach of the two centres. Equal bodies of opposite spin do not slip: they
        keep their spins and tangential velocities exactly, whatever the friction.

        Raises ValueError as `tangential_restitution`.
        """
        slip = tangential[0] - tangential[1] + radius[0] * spin[0] + radius[1] * spin[1]
        kick = self.kick(normal, slip, sticking)
        share = [kick * other / sum(mass) for other in reversed(mass)]
        turn = [part / (self.inertia_factor * r) for part, r in zip(share, radius, strict=True)]
        return (tangential[0] + share[0], tangential[1] - share[1]), (spin[0] + turn[0], spin[1] + turn[1])


def sticking_of_springs(*, shear_to_normal_stiffness: float, inertia_factor: float) -> float:
    """B0 of a linear tangential on a linear normal spring, both undamped, friction without limit.

    The slip swings with sqrt(k_t (1 + 1/q)/m*) while the normal motion makes half a period pi sqrt(m*/k_n)::

        B0 = -cos(pi sqrt((1 + 1/q) k_t/k_n))

    With finite friction the end of the contact slides, f_n going to zero there. Source: J. Schaefer,
    S. Dippel, D. E. Wolf, Force schemes in simulations of granular materials, J. Phys. I France 6, 5-20 (1996).

    >>> round(sticking_of_springs(shear_to_normal_stiffness=2 / 7, inertia_factor=0.4), 12)
    1.0
    """
    return -math.cos(math.pi * math.sqrt((1 + 1 / inertia_factor) * shear_to_normal_stiffness))
