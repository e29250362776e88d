"""Sound along a cube axis of a face-centred cubic packing of equal spheres under pressure, with friction springs.

Square layers of spheres (radius R, mass m, inertia q m R^2) lie l = D/sqrt(2) apart, D = 2 R - delta the distance of
neighbours, which press each other with F = k_n delta: four in the layer, four above, four below. Displacements and
turns are the same within a layer and exp(i (k z - w t)) along the axis. With S = sin(k l/2), C = cos(k l/2) and
g = k_t - F/D, the stiffness of a contact against motion across it (a pressed contact pushes its spheres further
aside), the sum over the bonds leaves three problems::

    compression        m w^2 = 8 (k_n + g) S^2
    torsion            I w^2 = 4 A k_t (2 + 2 C^2)
    shear and rolling  | 4 (k_n + 3 g) S^2/m - w^2        X          |
                       |          X       4 A k_t (1 + 3 C^2)/I - w^2 | = 0,     X^2 = 128 A k_t^2 S^2 C^2/(m I)

The second torsion term and 1 in 1 + 3 C^2 are the contacts within the layer. A is the product of two lever arms: that
at which the slip of the surfaces is measured and that at which the friction acts, both D/2 in the talks' laws. Long
waves, whatever the lever arms::

    c_P = D sqrt((k_n + g)/m),     c_S = D sqrt((k_n + k_t - 3 F/D)/(2 m))

A spring that moves with half-step velocities is an exact sum, so leapfrog in steps of dt only raises frequencies to
(2/dt) asin(w dt/2). Without shear springs, and in compression always, the layers are a chain: one that is kicked with
v_0 moves the n-th from it with v_0 J_2n(w_max t) (E. Schroedinger, Ann. Phys. 349, 916 (1914)).

Sources: without pressure O. Mouraille, W. A. Mulder, S. Luding, Sound wave acceleration in granular materials,
J. Stat. Mech. P07023 (2006); the terms in F and A follow from the same sums and are proven in the tests against
dynamic matrices of a periodic sample. Valid for amplitudes far below delta: no contact opens or slides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class FccColumn:
    """normal_stiffness, tangential_stiffness in N/m; mass in kg; radius, overlap in m; inertia_factor q.

    arms: A in m^2; None for that of the talks, (D/2)^2. Raises ValueError for an overlap outside [0, R].

    >>> column = FccColumn(normal_stiffness=1e5, mass=8.377580e-6, radius=1e-3, overlap=0.0)
    >>> f"{column.compression_speed:.1f} {column.shear_speed:.1f} m/s"
    '218.5 154.5 m/s'
    """

    normal_stiffness: float
    mass: float
    radius: float
    overlap: float
    tangential_stiffness: float = 0.0
    inertia_factor: float = 0.4
    arms: float | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.overlap <= self.radius:
            raise ValueError(f"overlap must lie in [0, {self.radius!r}] m, got {self.overlap!r}")

    @property
    def spacing(self) -> float:
        """D = 2 R - delta, m."""
        return 2 * self.radius - self.overlap

    @property
    def layer(self) -> float:
        """Distance of layers l = D/sqrt(2), m."""
        return self.spacing / math.sqrt(2)

    @property
    def across(self) -> float:
        """Stiffness against motion across a contact g = k_t - F/D, N/m; negative without friction springs."""
        return self.tangential_stiffness - self.normal_stiffness * self.overlap / self.spacing

    @property
    def compression_speed(self) -> float:
        """c_P, m/s."""
        return self.spacing * math.sqrt((self.normal_stiffness + self.across) / self.mass)

    @property
    def shear_speed(self) -> float:
        """c_S, m/s."""
        return self.spacing * math.sqrt((self.normal_stiffness + self._shear_across) / (2 * self.mass))

    @property
    def cut_off(self) -> float:
        """Highest frequency of compression, rad/s: no wave is faster without friction springs."""
        return math.sqrt(8 * (self.normal_stiffness + self.across) / self.mass)

    def compression(self, wavenumber: np.ndarray) -> np.ndarray:
        """w (rad/s) of the wave along its own motion at `wavenumber` (rad/m, any shape)."""
        return self.cut_off * np.abs(np.sin(np.asarray(wavenumber, dtype=float) * self.layer / 2))

    def torsion(self, wavenumber: np.ndarray) -> np.ndarray:
        """w (rad/s) of the layers that turn about the axis; zeros without friction springs."""
        square = np.cos(np.asarray(wavenumber, dtype=float) * self.layer / 2) ** 2
        return np.sqrt(4 * self._arms * self.tangential_stiffness * (2 + 2 * square) / self._inertia)

    def shear(self, wavenumber: np.ndarray) -> np.ndarray:
        """w (..., 2), rad/s, ascending, of the two waves across the axis; (..., 1) without friction springs."""
        phase = np.asarray(wavenumber, dtype=float) * self.layer / 2
        square, other = np.sin(phase) ** 2, np.cos(phase) ** 2
        moving = 4 * (self.normal_stiffness + 3 * self.across) * square / self.mass
        if not self.tangential_stiffness:
            return np.sqrt(moving)[..., None]
        turning = 4 * self._arms * self.tangential_stiffness * (1 + 3 * other) / self._inertia
        coupling = 128 * self._arms * self.tangential_stiffness**2 * square * other / (self.mass * self._inertia)
        high = (moving + turning) / 2 + np.sqrt(((moving - turning) / 2) ** 2 + coupling)
        low = (moving * turning - coupling) / high  # the product of both: no difference of nearly equal numbers
        return np.sqrt(np.stack([np.maximum(low, 0), high], axis=-1))

    def pulse(self, layers: np.ndarray, time: np.ndarray, *, shear: bool = False) -> np.ndarray:
        """Velocity of the layers that lie `layers` from a kicked one at `time` (s), over that of the kick; broadcast.

        Of compression, or of shear without friction springs.

        Raises ValueError for shear with friction springs, which is no chain.
        """
        from scipy.special import jv

        if shear and self.tangential_stiffness:
            raise ValueError("shear with friction springs turns the spheres: no closed form of the pulse")
        highest = float(self.shear(math.pi / self.layer)[0]) if shear else self.cut_off
        return jv(2 * np.abs(np.asarray(layers)), highest * np.asarray(time, dtype=float))

    @property
    def _inertia(self) -> float:
        return self.inertia_factor * self.mass * self.radius**2

    @property
    def _arms(self) -> float:
        return (self.spacing / 2) ** 2 if self.arms is None else self.arms

    @property
    def _shear_across(self) -> float:
        """k_t - 3 F/D: turns take up the springs' share of 3 g but for k_t, and nothing of the pressure's."""
        return self.tangential_stiffness - 3 * self.normal_stiffness * self.overlap / self.spacing


def in_steps(frequency: np.ndarray, dt: float) -> np.ndarray:
    """Return the frequency (rad/s) that a leapfrog in steps of dt (s) gives a wave of `frequency` (rad/s).

    >>> round(float(in_steps(1.0, 2.0)), 6)
    1.570796
    """
    return 2 / dt * np.arcsin(np.asarray(frequency, dtype=float) * dt / 2)
