"""What the kernel is given: particles, walls, laws, numerics; frozen, validated by its maker."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from reference.kernel.conventions import Convention
from reference.kernel.laws.law import CoupleLaw, NormalLaw, SlidingLaw


@dataclass(frozen=True, kw_only=True)
class Fixed:
    """The wall stays."""


@dataclass(frozen=True, kw_only=True)
class Cosine:
    """d(t) = travel/2 (1 - cos(pi t/duration)) along the normal, then rest (talk: z(t))."""

    travel: float
    duration: float

    def displacement(self, time: float) -> float:
        """Return d(time), m, positive along the normal: travel sin^2(pi t/2T) does not cancel at small t."""
        phase = math.pi * min(time / self.duration, 1.0)
        return self.travel * math.sin(0.5 * phase) ** 2

    def rate(self, time: float) -> float:
        """Return d'(time) = travel pi/(2T) sin(pi t/T), m/s."""
        if time >= self.duration:
            return 0.0
        return 0.5 * math.pi * self.travel / self.duration * math.sin(math.pi * time / self.duration)


@dataclass(frozen=True, kw_only=True)
class Constant:
    """Constant velocity vector, (dim,), m/s."""

    velocity: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Loaded:
    """m d'' = load + stress * extent + F.n - damping d'; extent = distance of the walls in `span`.

    d: displacement along the normal; F: force of the particles on the wall. `span` holds two wall
    numbers (0-based) or is None when the load is constant.
    """

    mass: float
    load: float
    stress: float
    span: tuple[int, int] | None
    damping: float


@dataclass(frozen=True, kw_only=True)
class Wall:
    """A plane through `point` with unit `normal` to the particles' side."""

    name: str
    point: tuple[float, ...]
    normal: tuple[float, ...]
    friction: bool
    motion: Fixed | Cosine | Constant | Loaded = Fixed()


@dataclass(frozen=True, kw_only=True)
class Model:
    """A DEM problem. x, v: (dim, N); spin: (1|3, N); radius, mass, inertia: (N,). SI units.

    With `rotations` (2D) the state carries the angle that every particle has turned.
    Raises ValueError for torsion resistance in 2D.
    """

    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    walls: tuple[Wall, ...]
    normal: NormalLaw
    sliding: SlidingLaw | None
    convention: Convention
    dt: float
    rolling: CoupleLaw | None = None
    torsion: CoupleLaw | None = None
    gravity: tuple[float, ...] | None = None
    drag: float | None = None
    periodic: tuple[float, ...] | None = None
    rotations: bool = False

    def __post_init__(self) -> None:
        if self.torsion is not None and self.dimension == 2:
            raise ValueError("torsion resistance: expected three dimensions, for spins about the normal; got two")

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.x)

    @property
    def particle_count(self) -> int:
        """N."""
        return len(self.radius)

    @property
    def precision(self) -> np.dtype:
        """Type of all numbers of a simulation."""
        return self.x.dtype

    def in_long_double(self) -> Model:
        """Return the same numbers in extended precision: an oracle for round-off, several times slower.

        For the textbook simulation; walls that follow a cosine are placed with doubles. Where the machine's `long
        double` is a double (see `numpy.finfo`), this changes nothing.
        """
        arrays = ("x", "v", "spin", "radius", "mass", "inertia")
        return replace(self, dt=np.longdouble(self.dt), **{a: getattr(self, a).astype(np.longdouble) for a in arrays})

    @property
    def turns(self) -> bool:
        """Whether any law exerts torques."""
        return not self.sliding is self.rolling is self.torsion is None
