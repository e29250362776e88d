"""Regular lattices of equal particles on linear contact springs: moduli, waves, stability of the time step.

A contact of unit normal n between centres a distance d apart carries a normal spring k_n and a tangential
spring k_t on the relative displacement of the two surfaces,

    Delta = u_j - u_i - (d/2) (w_i + w_j) x n,      energy (k_n (n.Delta)^2 + k_t (Delta^2 - (n.Delta)^2))/2

with rotations w of particles of inertia I = q m R^2, R = d/2. Zero pre-stress. A plane wave exp(i q.x) has
frequencies w^2 from the eigenvalues of M^(-1/2) [sum over bonds B^+ K B] M^(-1/2), with

    B = [ 2i sin(d q.n/2),  -d cos(d q.n/2) (. x n) ],     K = k_n n n + k_t (1 - n n),     M = (m, I)

Elastic moduli of homogeneous strain, each times the factor in front, and highest frequencies::

                    factor       C1111        C1122          C1212          m w_max^2
    square          1            k_n          0              k_t/2          max(4 (k_n + k_t), 8 k_t/q)
    triangular      sqrt(3)/4    3 k_n + k_t  k_n - k_t      k_n + k_t      max(6 k_n + 2 k_t, 12 k_t/q)
    f. c. cubic     sqrt(2)/d    k_n + k_t    (k_n - k_t)/2  (k_n + k_t)/2  max(8 (k_n + k_t), 16 k_t/q)

The second candidate is the uniform rotation (zero wave vector), the first a wave at the edge of the zone. That
no wave between is faster is found by search over the zone, not proven; it holds for inertia factors up to 1
(triangular: up to 2/3, so not for rings, whose limit is up to 1.3 % shorter). k_t = 0: no rotations.
Velocity Verlet (and leap-frog) is stable for a time step below 2/w_max, whatever the number of particles.

Sources: the sums over bonds, e.g. S. Luding, Micro-macro transition for anisotropic, frictional granular
packings, Int. J. Solids Struct. 41, 5821-5836 (2004); Bloch waves: O. Mouraille, W. A. Mulder, S. Luding,
Sound wave acceleration in granular materials, J. Stat. Mech. P07023 (2006). The tests take the force of
every particle of a periodic sample apart by differences.

Valid for amplitudes far below the overlaps (no contact opens or slides) and d = 2 R.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np


@dataclass(frozen=True, kw_only=True)
class CubicModuli:
    """C1111, C1122 and C1212 of a material with the symmetry of the square or the cube, in axes along it.

    dimension 2: N/m, of a sheet; dimension 3: Pa.
    """

    axial: float
    lateral: float
    shear: float
    dimension: int

    @property
    def bulk(self) -> float:
        """K = (C1111 + (D - 1) C1122)/D."""
        return (self.axial + (self.dimension - 1) * self.lateral) / self.dimension

    @property
    def poisson(self) -> float:
        """Lateral over axial strain in uniaxial stress along an axis: C1122/(C1111 + (D - 2) C1122)."""
        return self.lateral / (self.axial + (self.dimension - 2) * self.lateral)

    @property
    def young(self) -> float:
        """Stress over strain in uniaxial stress along an axis: C1111 - (D - 1) C1122 nu."""
        return self.axial - (self.dimension - 1) * self.lateral * self.poisson

    def christoffel(self, direction: np.ndarray) -> np.ndarray:
        """C_abcd n_b n_c (D, D) for a unit `direction` (D,): density times the squares of the wave speeds."""
        n = np.asarray(direction, dtype=float)
        mixed = (self.lateral + self.shear) * np.outer(n, n)
        np.fill_diagonal(mixed, self.axial * n**2 + self.shear * (n @ n - n**2))
        return mixed


@dataclass(frozen=True, kw_only=True)
class Lattice(ABC):
    """Particles of mass m (kg) a spacing d (m) apart; k_n > 0 and k_t >= 0 in N/m; q (-) in (0, 1].

    In 2D the moduli come out in N/m; per unit thickness, with m in kg/m and k in N/m^2, in Pa.

    Raises ValueError if there is a tangential spring but no inertia factor.
    """

    directions: ClassVar[np.ndarray]
    """Unit normals of the bonds, one of each pair, (bonds, D)."""

    normal_stiffness: float
    mass: float
    spacing: float
    tangential_stiffness: float = 0.0
    inertia_factor: float | None = None

    def __post_init__(self) -> None:
        if self.tangential_stiffness and self.inertia_factor is None:
            raise ValueError("a tangential spring turns the particles: inertia_factor is missing")

    @property
    @abstractmethod
    def moduli(self) -> CubicModuli:
        """Elastic moduli at zero pre-stress."""

    @property
    @abstractmethod
    def cell_volume(self) -> float:
        """Volume (m^3; 2D: area, m^2) per particle."""

    @property
    @abstractmethod
    def highest_frequency(self) -> float:
        """w_max, rad/s, over all waves."""

    @property
    def stability_limit(self) -> float:
        """The time step of velocity Verlet that is just unstable, s: 2/w_max."""
        return 2 / self.highest_frequency

    @property
    def density(self) -> float:
        """Mass per volume (2D: per area)."""
        return self.mass / self.cell_volume

    def _highest(self, translation: float, rotation: float) -> float:
        """w_max from w^2 m of the highest wave without rotation, and of the uniform rotation times q."""
        if self.tangential_stiffness:
            translation = max(translation, rotation / self.inertia_factor)
        return math.sqrt(translation / self.mass)

    def wave_speeds(self, direction: np.ndarray) -> np.ndarray:
        """Speeds of the long waves along a unit `direction` (D,), m/s, (D,), ascending."""
        squares = np.linalg.eigvalsh(self.moduli.christoffel(direction)) / self.density
        return np.sqrt(np.maximum(squares, 0))

    def frequencies(self, wavevector: np.ndarray) -> np.ndarray:
        """Angular frequencies (..., modes), rad/s, ascending, of the waves of `wavevector` (..., D), rad/m.

        modes: D, and the rotations (1 in 2D, 3 in 3D) if there is a tangential spring.
        """
        q = np.asarray(wavevector, dtype=float)
        matrix = sum(self._bond_matrix(n, self.spacing * (q @ n) / 2) for n in self.directions)
        return np.sqrt(np.maximum(np.linalg.eigvalsh(matrix), 0))

    def _bond_matrix(self, normal: np.ndarray, half_phase: np.ndarray) -> np.ndarray:
        """Return M^(-1/2) B^+ K B M^(-1/2) (..., modes, modes) of the bond along `normal` (D,)."""
        dimension, along = len(normal), np.outer(normal, normal)
        stiffness = self.normal_stiffness * along + self.tangential_stiffness * (np.eye(dimension) - along)
        sine, cosine = np.sin(half_phase)[..., None, None], np.cos(half_phase)[..., None, None]
        relative = 2j * sine * np.eye(dimension) / math.sqrt(self.mass)
        if self.tangential_stiffness:
            turning = math.sqrt(self.inertia_factor * self.mass) * self.spacing / 2
            turned = -self.spacing * cosine * _turn(normal) / turning
            relative = np.concatenate([relative, turned], axis=-1)
        return np.conj(np.swapaxes(relative, -1, -2)) @ stiffness @ relative


def _turn(normal: np.ndarray) -> np.ndarray:
    """Return the matrix of w -> w x n: (2, 1) for the spin of a disc, (3, 3) for that of a sphere."""
    if len(normal) == 2:
        return np.array([[-normal[1]], [normal[0]]])
    return np.cross(np.eye(3), normal).T


@dataclass(frozen=True, kw_only=True)
class Square(Lattice):
    """Discs with four neighbours, axes along the bonds.

    >>> lattice = Square(normal_stiffness=1e5, mass=1e-5, spacing=2e-3)
    >>> lattice.moduli.axial, f"{lattice.stability_limit:.3e}"
    (100000.0, '1.000e-05')
    """

    directions: ClassVar[np.ndarray] = np.eye(2)

    @property
    def moduli(self) -> CubicModuli:
        """k_n, 0, k_t/2, N/m."""
        return CubicModuli(
            axial=self.normal_stiffness, lateral=0.0, shear=self.tangential_stiffness / 2, dimension=2,
        )

    @property
    def cell_volume(self) -> float:
        """d^2, m^2."""
        return self.spacing**2

    @property
    def highest_frequency(self) -> float:
        """w_max, rad/s."""
        k_n, k_t = self.normal_stiffness, self.tangential_stiffness
        return self._highest(4 * (k_n + k_t), 8 * k_t)


@dataclass(frozen=True, kw_only=True)
class Triangular(Lattice):
    """Discs with six neighbours, one bond along x; elastically isotropic.

    c_P^2 = (3/8) d^2 (3 k_n + k_t)/m, c_S^2 = (3/8) d^2 (k_n + k_t)/m.

    >>> lattice = Triangular(normal_stiffness=1.0, mass=1.0, spacing=1.0, tangential_stiffness=1.0, inertia_factor=0.5)
    >>> round(lattice.moduli.poisson, 12), round(float(lattice.wave_speeds([1, 0])[1]) ** 2, 12)
    (0.0, 1.5)
    """

    directions: ClassVar[np.ndarray] = np.array([[1, 0], [0.5, math.sqrt(0.75)], [-0.5, math.sqrt(0.75)]])

    @property
    def moduli(self) -> CubicModuli:
        """sqrt(3)/4 times 3 k_n + k_t, k_n - k_t, k_n + k_t, N/m."""
        k_n, k_t, factor = self.normal_stiffness, self.tangential_stiffness, math.sqrt(3) / 4
        return CubicModuli(
            axial=factor * (3 * k_n + k_t), lateral=factor * (k_n - k_t), shear=factor * (k_n + k_t), dimension=2,
        )

    @property
    def cell_volume(self) -> float:
        """(sqrt(3)/2) d^2, m^2."""
        return math.sqrt(0.75) * self.spacing**2

    @property
    def highest_frequency(self) -> float:
        """w_max, rad/s.

        Raises ValueError for an inertia factor above 2/3 (with k_t > 0), where a wave inside the zone can be faster.
        """
        k_n, k_t = self.normal_stiffness, self.tangential_stiffness
        if k_t and self.inertia_factor > 2 / 3:
            raise ValueError(f"no closed form for inertia factors above 2/3, got {self.inertia_factor!r}")
        return self._highest(6 * k_n + 2 * k_t, 12 * k_t)


@dataclass(frozen=True, kw_only=True)
class FaceCentredCubic(Lattice):
    """Spheres with twelve neighbours, axes along the edges of the cube, which are sqrt(2) d long.

    >>> lattice = FaceCentredCubic(normal_stiffness=1.0, mass=1.0, spacing=1.0)
    >>> round(lattice.stability_limit, 6), round(lattice.moduli.poisson, 6)
    (0.707107, 0.333333)
    """

    directions: ClassVar[np.ndarray] = math.sqrt(0.5) * np.array(
        [[1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]]
    )

    @property
    def moduli(self) -> CubicModuli:
        """sqrt(2)/d times k_n + k_t, (k_n - k_t)/2, (k_n + k_t)/2, Pa."""
        k_n, k_t, factor = self.normal_stiffness, self.tangential_stiffness, math.sqrt(2) / self.spacing
        return CubicModuli(
            axial=factor * (k_n + k_t), lateral=factor * (k_n - k_t) / 2, shear=factor * (k_n + k_t) / 2, dimension=3,
        )

    @property
    def cell_volume(self) -> float:
        """d^3/sqrt(2), m^3."""
        return self.spacing**3 / math.sqrt(2)

    @property
    def highest_frequency(self) -> float:
        """w_max, rad/s."""
        k_n, k_t = self.normal_stiffness, self.tangential_stiffness
        return self._highest(8 * (k_n + k_t), 16 * k_t)


@dataclass(frozen=True, kw_only=True)
class Chain:
    """Particles in a row that move along it: stiffness k (N/m), mass m (kg), spacing d (m).

    w = 2 sqrt(k/m) |sin(q d/2)|, so that the limit of the infinite row is sqrt(m/k). For a row of Hertz contacts
    under a static force see `hertz_chain`.

    >>> row = Chain(stiffness=1.0, mass=1.0, spacing=1.0)
    >>> row.stability_limit, round(2 / float(row.free_frequencies(2)[-1]), 6)
    (1.0, 1.414214)
    """

    stiffness: float
    mass: float
    spacing: float

    @property
    def highest_frequency(self) -> float:
        """2 sqrt(k/m), rad/s, at q d = pi."""
        return 2 * math.sqrt(self.stiffness / self.mass)

    @property
    def stability_limit(self) -> float:
        """The time step of velocity Verlet that is just unstable, s: sqrt(m/k); a finite row has a larger one."""
        return 2 / self.highest_frequency

    @property
    def wave_speed(self) -> float:
        """Of long waves, d sqrt(k/m), m/s."""
        return self.spacing * math.sqrt(self.stiffness / self.mass)

    def frequencies(self, wavevector: np.ndarray) -> np.ndarray:
        """Angular frequency, rad/s, at `wavevector`, rad/m, any shape."""
        return self.highest_frequency * np.abs(np.sin(np.asarray(wavevector, dtype=float) * self.spacing / 2))

    def free_frequencies(self, count: int) -> np.ndarray:
        """Of a row of `count` particles with free ends, rad/s (count,), ascending: q d = pi j/count, j = 0, 1, ...

        Two particles: the isolated pair, w^2 = 2 k/m.
        """
        return self.frequencies(np.pi * np.arange(count) / (count * self.spacing))

    def clamped_frequencies(self, count: int) -> np.ndarray:
        """Of a row of `count` between two fixed ones, rad/s (count,), ascending.

        q d = pi j/(count + 1), j = 1, 2, ...
        """
        return self.frequencies(np.pi * np.arange(1, count + 1) / ((count + 1) * self.spacing))


def hertz_chain(*, hertz_stiffness: float, force: float, mass: float, diameter: float) -> Chain:
    """Return the linear row of small waves on Hertz contacts k_H d^(3/2) pressed together by `force` (N) > 0.

    overlap d0 = (F/k_H)^(2/3), stiffness (3/2) k_H sqrt(d0) = (3/2) k_H^(2/3) F^(1/3), spacing D - d0; wave speed
    and limit go with F^(1/6) and F^(-1/6). hertz_stiffness k_H in N/m^1.5, diameter D in m.
    Valid for amplitudes far below d0; without pre-compression no sound wave exists.
    Source: V. F. Nesterenko, Dynamics of Heterogeneous Materials, Springer (2001), chapter 1.

    Raises ValueError if `force` is not positive.

    >>> row = hertz_chain(hertz_stiffness=1.0, force=1e-6, mass=1.0, diameter=1.0)
    >>> round(row.stiffness, 12), round(row.spacing, 12)
    (0.015, 0.9999)
    """
    if not force > 0:
        raise ValueError(f"force must be positive, got {force!r}")
    overlap = (force / hertz_stiffness) ** (2 / 3)
    return Chain(stiffness=1.5 * hertz_stiffness * math.sqrt(overlap), mass=mass, spacing=diameter - overlap)
