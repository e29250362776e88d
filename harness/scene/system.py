"""The resolved scene: plain numbers that every engine receives alike.

A `Scene` is what a person wrote; a `System` is what it means: particle arrays in float64, walls
with their motion, the effects that are on, step and output counts. Engines see only this, so a
new kind of scene needs no change in any engine as long as it resolves to these parts.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass, field, replace
from itertools import combinations_with_replacement

import numpy as np

from harness.scene.contact import LinearNormal, NormalLaw, RollingLaw, SlidingLaw, SpringSliding, SpringTorsion
from harness.scene.model import Background

INERTIA_FACTOR = {"sphere": 0.4, "disc": 0.5, "ring": 1.0}
"""q in I = q m a^2."""


@dataclass(frozen=True, kw_only=True)
class Particles:
    """Initial particles; id is the row number + 1.

    x, v: (N, dim) in m, m/s. radius, mass: (N,) in m, kg. inertia_factor: (N,), q in I = q m a^2.
    spin: (N, 1) in 2D (about z, counter-clockwise positive) or (N, 3), in rad/s. material: (N,), the word of each
    one's material, "" for none; None in systems without materials.
    """

    x: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    inertia_factor: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    material: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.radius)

    def rows(self, chosen: np.ndarray | slice) -> Particles:
        """Return some of the particles, or all of them several times."""
        arrays = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return replace(self, **{name: a[chosen] for name, a in arrays.items() if a is not None})


@dataclass(frozen=True, kw_only=True)
class Constant:
    """Constant velocity vector (dim,), m/s."""

    velocity: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Cosine:
    """d(t) = travel/2 (1 - cos(pi t/duration)) along the normal until `duration`, then rest."""

    travel: float
    duration: float

    @property
    def end(self) -> float:
        """When the wall comes to rest, s."""
        return self.duration

    @property
    def rest(self) -> float:
        """Where it rests: its displacement from then on, m."""
        return self.travel


@dataclass(frozen=True, kw_only=True)
class Cycles(Cosine):
    """The same d(t) so many times forth and back, until 2 `duration` cycles, then rest at d = 0."""

    cycles: int

    @property
    def end(self) -> float:
        """When the wall comes to rest, s."""
        return 2.0 * self.cycles * self.duration

    @property
    def rest(self) -> float:
        """Where it began."""
        return 0.0


@dataclass(frozen=True, kw_only=True)
class Loaded:
    """A wall with mass: m d'' = load + stress * extent(t) + F.n - damping d'.

    d is the displacement along the normal, F the force of the particles on the wall (so F.n < 0
    when they push it back). extent(t) is the distance of the two walls named in `span` (the talk's
    z(t)); without a span the load is constant.
    """

    mass: float
    load: float
    stress: float
    span: tuple[str, str] | None
    damping: float


@dataclass(frozen=True, kw_only=True)
class Wall:
    """A plane; `index` counts from 1 and contacts name the wall as j = -index. material: a word as of `Particles`."""

    index: int
    name: str
    point: tuple[float, ...]
    normal: tuple[float, ...]
    friction: bool
    motion: Constant | Cosine | Loaded | None = None
    material: str | None = None

    def identity(self) -> dict:
        """The wall as JSON-able data; without materials it has none."""
        plain = asdict(self) | {"motion_kind": type(self.motion).__name__}
        return {k: v for k, v in plain.items() if k != "material" or v is not None}


@dataclass(frozen=True, kw_only=True)
class Materials:
    """The laws between materials, which differ in the laws' numbers only.

    names: (K,) words in alphabetical order, "" of bodies and walls without one. normal, sliding: (K, K), the law
    between two, whichever comes first; sliding is None without friction.
    """

    names: tuple[str, ...]
    normal: tuple[tuple[LinearNormal, ...], ...]
    sliding: tuple[tuple[SpringSliding, ...], ...] | None

    def number(self, word: str) -> int:
        """Return the place of a word among the names."""
        return self.names.index(word)

    def numbers(self, words: np.ndarray) -> np.ndarray:
        """Return the places of words (N,) among the names, (N,)."""
        return np.searchsorted(np.array(self.names), words)

    def table(self, family: str, number: str) -> np.ndarray:
        """Return one number of the laws of a family ("normal", "sliding"), (K, K)."""
        return np.array([[getattr(law, number) for law in row] for row in getattr(self, family)])

    def identity(self) -> dict:
        """The materials as JSON-able data."""
        laws = {"normal": self.normal, "sliding": self.sliding or ()}
        tables = {family: [[_struct(law) for law in row] for row in rows] for family, rows in laws.items()}
        return {"names": self.names, **tables}


@dataclass(frozen=True, kw_only=True)
class Ring:
    """Discs glued on a circle (2D): they touch the particles like discs of infinite mass, and never each other.

    `index` continues the count of the walls; contacts name the whole ring as j = -index. x: (M, 2) centres of the
    glued discs at the start, radius: (M,), in m. The circle has its middle at `centre` (2,) and the radius `circle`, m.
    It turns rigidly with `omega` (rad/s, counter-clockwise) from the start on; None: it stands still. A glued disc
    turns with its ring, so its spin is omega.
    """

    index: int
    name: str
    centre: tuple[float, float]
    circle: float
    x: np.ndarray
    radius: np.ndarray
    omega: float | None = None

    def identity(self) -> dict:
        """The ring as JSON-able data, arrays replaced by their hash."""
        plain = {"index": self.index, "centre": self.centre, "circle": self.circle, "omega": self.omega}
        return plain | {"grains": _digest(self.x, self.radius)}


@dataclass(frozen=True, kw_only=True)
class System:
    """Everything an engine must compute, and nothing that is off.

    `periodic` holds one box length an axis, 0 for open axes; None when no axis is periodic; the box
    starts at the origin. `sample_every`, `frame_every` are in steps and divide `steps`. With `rotations` (2D
    with a law that turns them only) frames carry the angle that every particle has turned since the start. With
    `materials` the numbers of `normal` and `sliding` are those of pairs without an entry: ask `between` for a pair's.
    """

    dimension: int
    particles: Particles
    walls: tuple[Wall, ...]
    normal: NormalLaw
    sliding: SlidingLaw | None
    background: Background | None
    gravity: tuple[float, ...] | None
    periodic: tuple[float, ...] | None
    dt: float
    steps: int
    sample_every: int
    frame_every: int
    contacts: bool
    rolling: RollingLaw | None = None
    torsion: SpringTorsion | None = None
    rotations: bool = False
    rings: tuple[Ring, ...] = ()
    materials: Materials | None = None
    scene_name: str = field(default="scene")
    title: str = field(default="")

    def wall(self, name: str) -> Wall:
        """Return the wall of this name."""
        return next(w for w in self.walls if w.name == name)

    def between(self, one: str | None, other: str | None) -> System:
        """Return the system with the laws between two materials everywhere; itself in systems without materials."""
        if self.materials is None:
            return self
        sliding, (a, b) = self.materials.sliding, (self.materials.number(word) for word in (one, other))
        return self.with_(
            normal=self.materials.normal[a][b], sliding=None if sliding is None else sliding[a][b],
            materials=None, particles=replace(self.particles, material=None),
            walls=tuple(replace(w, material=None) for w in self.walls),
        )

    @property
    def of_pairs(self) -> tuple[System, ...]:
        """The system with the laws of every two materials; itself alone in systems without materials."""
        if self.materials is None:
            return (self,)
        return tuple(self.between(*pair) for pair in combinations_with_replacement(self.materials.names, 2))

    def digest(self) -> str:
        """SHA-256 of everything that decides the result; names and titles are not part of it."""
        return hashlib.sha256(json.dumps(self.identity(), sort_keys=True).encode()).hexdigest()

    def identity(self) -> dict:
        """The system as JSON-able data, particle arrays replaced by their hash."""
        walls = [w.identity() for w in self.walls]
        effects = {k: _struct(getattr(self, k)) for k in _LAWS}
        plain = {k: getattr(self, k) for k in _PLAIN}
        rings = {"rings": [ring.identity() for ring in self.rings]} if self.rings else {}
        materials = {"materials": self.materials.identity()} if self.materials else {}
        return {"walls": walls, "particles": self.particles_digest(), **effects, **plain, **rings, **materials}

    def particles_digest(self) -> str:
        """SHA-256 of the particle arrays as little-endian float64."""
        p = self.particles
        materials = () if p.material is None else (self.materials.numbers(p.material),)
        return _digest(p.x, p.radius, p.mass, p.inertia_factor, p.v, p.spin, *materials)

    def with_(self, **changes) -> System:
        """Return a copy with some fields changed."""
        return replace(self, **changes)


def _digest(*arrays: np.ndarray) -> str:
    h = hashlib.sha256()
    for array in arrays:
        h.update(np.ascontiguousarray(array, "<f8").tobytes())
    return h.hexdigest()


_LAWS = ("normal", "sliding", "rolling", "torsion", "background")
_PLAIN = (
    "dimension", "gravity", "periodic", "dt", "steps", "sample_every", "frame_every", "contacts", "rotations",
)


def _struct(table) -> dict | None:
    import msgspec

    return None if table is None else msgspec.to_builtins(table) | {"_": type(table).__name__}
