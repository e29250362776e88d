"""What the kernel is given: particles, walls, laws, numerics; frozen, validated by its maker."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from reference.kernel.conventions import Convention
from reference.kernel.laws.law import CoupleLaw, NormalLaw, SlidingLaw
from reference.kernel.vectors import norm, torque_cross


@dataclass(frozen=True, kw_only=True)
class Fixed:
    """The wall stays."""


@dataclass(frozen=True, kw_only=True)
class Cosine:
    """d(t) = travel/2 (1 - cos(pi t/duration)) along the normal, then rest (talk: z(t)).

    It rests from `duration` on, at d = travel; with `cycles`, so many times forth and back, from 2 duration cycles on
    where it began.
    """

    travel: float
    duration: float
    cycles: int | None = None

    @property
    def halves(self) -> int:
        """Return how many times it goes from one end to the other."""
        return 1 if self.cycles is None else 2 * self.cycles

    def displacement(self, time: float) -> float:
        """Return d(time), m, positive along the normal: travel sin^2(pi t/2T) does not cancel at small t."""
        if time >= self.halves * self.duration:
            return self.travel * (self.halves % 2)
        return self.travel * math.sin(0.5 * math.pi * (time / self.duration)) ** 2

    def rate(self, time: float) -> float:
        """Return d'(time) = travel pi/(2T) sin(pi t/T), m/s."""
        if time >= self.halves * self.duration:
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
class Ring:
    """M discs glued to a circle about `centre` (2D): they touch the particles like discs of infinite mass.

    x: (2, M) centres of the discs at time 0, m; radius: (M,), m. circle: its radius, m; None: the mean distance of the
    discs from `centre`, which it then is. The laws are those of particle contacts, with
    m* = m_i and a* = a_i a_g/(a_i + a_g); glued discs never touch each other. With omega (rad/s, counter-clockwise
    positive) the ring turns from time 0 on, about its centre and as a whole::

        x_g(t) = c + Q(omega t) (x_g(0) - c),    v_g(t) = omega e_z x (x_g(t) - c),    spin omega

    always from the places at time 0, so that no error adds up. The forces of the step to t(n+1) see x_g, v_g and spin
    of t(n+1) in every convention, while particles are seen with their half-step velocities: so `fix move rotate` of
    LAMMPS and LIGGGHTS do it. None: the ring stands still.

    Raises ValueError for arrays of other shapes.
    """

    name: str
    centre: tuple[float, float]
    x: np.ndarray
    radius: np.ndarray
    omega: float | None = None
    circle: float | None = None

    def __post_init__(self) -> None:
        if self.x.shape != (2, len(self.radius)):
            raise ValueError(f"ring '{self.name}': x: expected shape {(2, len(self.radius))}, got {self.x.shape}")
        if self.circle is None:
            object.__setattr__(self, "circle", float(norm(self._arms()).mean()))

    def angle(self, time: float) -> float:
        """Return how far the ring has turned at a time, rad; 0 if it stands still."""
        return 0.0 if self.omega is None else self.omega * time

    def places(self, time: float) -> np.ndarray:
        """Return the centres of the discs, (2, M), m."""
        return self._places_at(self.angle(time))

    def velocities(self, x: np.ndarray) -> np.ndarray:
        """Return the velocities of the discs at the places x, (2, M), m/s."""
        arms = x - self._middle()
        return (self.omega or 0.0) * np.stack([-arms[1], arms[0]])

    def torque(self, x: np.ndarray, force: np.ndarray, couple: np.ndarray | None) -> float:
        """Return the moment about the centre, N m, of forces (2, M) on the discs at x and of couples (1, M) on them."""
        moment = torque_cross(x - self._middle(), force).sum()
        return float(moment if couple is None else moment + couple.sum())

    def turned(self, angle: float) -> Ring:
        """Return the ring with another start: its discs stand `angle` (rad) further along the circle at time 0."""
        return replace(self, x=self._places_at(angle))

    def _places_at(self, angle: float) -> np.ndarray:
        x, y = self._arms()
        cosine, sine = np.cos(angle), np.sin(angle)
        return self._middle() + np.stack([cosine * x - sine * y, sine * x + cosine * y])

    def _arms(self) -> np.ndarray:
        return self.x - self._middle()

    def _middle(self) -> np.ndarray:
        return np.array(self.centre, self.x.dtype)[:, None]


@dataclass(frozen=True, kw_only=True)
class Model:
    """A DEM problem. x, v: (dim, N); spin: (1|3, N); radius, mass, inertia: (N,). SI units.

    With `rotations` (2D) the state carries the angle that every particle has turned. All places are told relative to
    `origin` (dim,), m: see `near_origin`; None is zero.
    Raises ValueError for torsion resistance in 2D, for rings in 3D and for rings in a box with periodic axes.
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
    rings: tuple[Ring, ...] = ()
    origin: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if self.rings and (self.dimension != 2 or self.periodic is not None):
            got = "three dimensions" if self.dimension == 3 else "periodic axes"
            raise ValueError(f"rings: expected two dimensions and open axes, got {got}")
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
    def wall_nodes(self) -> slice:
        """Where the walls are among the nodes: behind the particles."""
        return slice(self.particle_count, self.particle_count + len(self.walls))

    @property
    def ring_nodes(self) -> tuple[slice, ...]:
        """Where the discs of each ring are among the nodes: behind the walls."""
        ends = np.cumsum([self.wall_nodes.stop, *(len(ring.radius) for ring in self.rings)]).tolist()
        return tuple(slice(*pair) for pair in pairwise(ends))

    @property
    def node_count(self) -> int:
        """Particles, walls and glued discs."""
        return self.wall_nodes.stop + sum(len(ring.radius) for ring in self.rings)

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
        rings = tuple(replace(r, **_in_long_double(r, ("x", "radius"))) for r in self.rings)
        return replace(self, dt=np.longdouble(self.dt), rings=rings, **_in_long_double(self, arrays))

    @property
    def lag(self) -> float:
        """Return by how much velocities are older than the places in the forces of a step, s: dt/2 in the leapfrog."""
        return 0.5 * self.dt if self.convention.scheme == "leapfrog" else 0.0

    @property
    def turns(self) -> bool:
        """Whether any law exerts torques."""
        return not self.sliding is self.rolling is self.torsion is None


def _in_long_double(holder: Model | Ring, arrays: tuple[str, ...]) -> dict[str, np.ndarray]:
    return {name: getattr(holder, name).astype(np.longdouble) for name in arrays}
