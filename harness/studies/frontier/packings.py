"""The packings whose largest steps are measured: lattices under pressure in periodic boxes, a random one in walls.

All contacts of the lattices are pressed alike, so that forces balance by symmetry; the random packing is brought to
balance. Small motions then neither open nor close a contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.packing import make_packing
from harness.scene.model import Preparation, RandomParticles, SphereMass, UniformRadius
from harness.scene.system import INERTIA_FACTOR, Particles, System, Wall
from harness.studies.frontier.laws import MASS, OVERLAP, RADIUS, STIFFNESS, LawCase

SHAPE = {2: "disc", 3: "sphere"}

RESIDUAL = 1e-9
"""Net force on a disc of the random packing over the mean contact force, at most."""

SEED = 11


@dataclass(frozen=True, kw_only=True)
class Packed:
    """Particles at rest. x: (N, dim), radius: (N,), in m; `box`: (dim,) periodic, or between four walls."""

    x: np.ndarray
    radius: np.ndarray
    box: tuple[float, ...]
    walls: bool


@dataclass(frozen=True, kw_only=True)
class PackingCase:
    """A packing by the name that tables use. make: from a folder in which packings are kept."""

    name: str
    dimension: int
    make: Callable[[Path], Packed]


def lattice(basis: np.ndarray, cell: np.ndarray, cells: tuple[int, ...]) -> Packed:
    """Return the lattice of nearest distance 1 in `basis` and `cell`, in a periodic box, pressed by OVERLAP."""
    spacing = 2 * RADIUS - OVERLAP * RADIUS
    at = np.stack(np.meshgrid(*(np.arange(n) for n in cells), indexing="ij"), axis=-1).reshape(-1, len(cells))
    x = (at[:, None, :] * cell + basis).reshape(-1, len(cells)) + 0.25
    box = tuple(float(b) for b in spacing * cell * np.array(cells))
    return Packed(x=spacing * x, radius=np.full(len(x), RADIUS), box=box, walls=False)


def random_discs(cache: Path, *, count: int = 100, size_ratio: float = 2.0) -> Packed:
    """Return discs of radii from U(a, size_ratio a), mean RADIUS, at rest between four walls.

    The pressure is OVERLAP STIFFNESS: mean overlaps are about OVERLAP radii.
    """
    low = 2 * RADIUS / (1 + size_ratio)
    particles = RandomParticles(
        count=count, seed=SEED, radius=UniformRadius(min=low, max=low * size_ratio), inertia="disc",
        mass=SphereMass(density=1.0),
    )
    made = make_packing(
        particles, Preparation(pressure=OVERLAP * STIFFNESS, residual_tolerance=RESIDUAL), stiffness=STIFFNESS,
        seed=SEED, cache=cache, scene_folder=cache,
    )
    return Packed(x=made.x, radius=made.radius, box=made.box, walls=True)


SQUARE = PackingCase(
    name="square lattice", dimension=2, make=lambda _: lattice(np.zeros((1, 2)), np.ones(2), (6, 6))
)
TRIANGULAR = PackingCase(
    name="triangular lattice", dimension=2,
    make=lambda _: lattice(
        np.array([[0.0, 0.0], [0.5, math.sqrt(0.75)]]), np.array([1.0, math.sqrt(3.0)]), (6, 4)
    ),
)
FCC = PackingCase(
    name="fcc lattice", dimension=3,
    make=lambda _: lattice(
        np.array([[0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]]) / math.sqrt(2), np.full(3, math.sqrt(2.0)), (2, 2, 2)
    ),
)
RANDOM = PackingCase(name="random discs", dimension=2, make=random_discs)

QUICK = (TRIANGULAR, FCC, RANDOM)
WHOLE = (SQUARE, *QUICK)


def resting_system(packing: PackingCase, packed: Packed, law: LawCase) -> System:
    """Return the packing at rest under the law, without time step (1 s) and steps (1): a search sets them.

    Masses go with the square of the radius, MASS at RADIUS; rough walls where the law has friction.
    """
    n, dim = packed.x.shape
    contact, rough = law.contact, law.contact.sliding is not None
    return System(
        dimension=dim, walls=_walls(packed.box, rough) if packed.walls else (),
        particles=Particles(
            x=packed.x, radius=packed.radius, mass=MASS * (packed.radius / RADIUS) ** 2, v=np.zeros((n, dim)),
            inertia_factor=np.full(n, INERTIA_FACTOR[SHAPE[dim]]), spin=np.zeros((n, 1 if dim == 2 else 3)),
        ),
        periodic=None if packed.walls else packed.box, gravity=None, background=None,
        normal=contact.normal, sliding=contact.sliding, rolling=contact.rolling, torsion=contact.torsion,
        dt=1.0, steps=1, sample_every=1, frame_every=1, contacts=False,
        scene_name="frontier", title=f"{packing.name}, {law.name}",
    )


def _walls(box: tuple[float, ...], friction: bool) -> tuple[Wall, ...]:
    planes = (("left", (0.0, 0.0), (1.0, 0.0)), ("bottom", (0.0, 0.0), (0.0, 1.0)),
              ("right", (box[0], 0.0), (-1.0, 0.0)), ("top", (0.0, box[1]), (0.0, -1.0)))
    return tuple(
        Wall(index=k, name=name, point=point, normal=normal, friction=friction)
        for k, (name, point, normal) in enumerate(planes, start=1)
    )
