"""Dense disordered packings of any size, made fast: a jittered grid of random radii that slides to rest.

They are for timing: density and number of contacts are those of a jammed packing, and forces balance well enough
for it to stay as it is over the steps that are timed. Beyond TILE discs a box is made of mirror images of one of TILE
(with periodic axes: of repetitions), whose seams then settle. Particles are numbered along the grid, tile by tile, so
that neighbours in space are near in memory for every code.
"""

from __future__ import annotations

import hashlib
import io
import itertools
import logging
import math
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

log = logging.getLogger(__name__)

METHOD = 3
"""Version of the preparation; raising it makes every packing anew."""

FRACTION = {2: 0.85, 3: 0.66}
"""Area and volume fraction by dimension: just above jamming of radii U(0.5, 1.5)."""

JITTER = 0.1
"""Of the start, in grid spacings."""

TILE = 2000
"""Discs of which a larger packing is put together. Spheres are not: mirror images pressed head-on slip past each
other in space, and the packing is no longer at rest."""

GROWTH, GROWING_STEPS = (0.7, 0.8, 0.9), 200
"""Parts of the radii that rest first, and for how long: at full size from the grid, small ones are pressed into the
large ones beside them, which the kernel refuses, and rightly so."""

STEPS, SEAM_STEPS = 8000, 12_000
"""Of the way to rest, at most: from a grid, and of a box that has been put together."""

SKIN, SEAM_SKIN = 0.7, 0.3
"""Of the pair list meanwhile, in mean radii: from a grid particles move far at first."""

REST, SEAM_REST = 1e-8, 1e-6
"""Root mean square of the net force's components, in stiffness times mean radius, at which a packing rests."""

SEAM_DASHPOT, SEAM_DRAG, SEAM_TIME_STEP, SEAM_JITTER = 0.5, 0.01, 0.2, 1e-3
"""In sqrt(k m), sqrt(k m), sqrt(m/k) and mean radii. Along seams images are pressed together head-on and slip past each
other, which sets off others: without a way to lose that energy the whole packing shakes itself loose."""

LOOK = 200
"""Steps between two looks at how far from rest a packing is that settles."""


@dataclass(frozen=True, kw_only=True)
class BenchPacking:
    """x: (N, dim), radius: (N,), box: (dim,) in mean radii. contacts: a particle, those with walls counted once.

    unbalanced: root mean square of the net force on a particle over the mean contact force.
    """

    x: np.ndarray
    radius: np.ndarray
    box: np.ndarray
    contacts: float
    unbalanced: float

    @property
    def fraction(self) -> float:
        """Area or volume fraction."""
        return float(_volumes(self.radius, self.x.shape[1]).sum() / self.box.prod())


def bench_packing(dimension: int, count: int, *, walls: bool, cache: Path) -> BenchPacking:
    """Return the packing of `count` particles with walls or periodic axes, from the cache if it is there."""
    key = [METHOD, dimension, count, walls, FRACTION[dimension], JITTER, TILE, GROWTH, STEPS, SEAM_STEPS, REST]
    name = hashlib.sha256(repr(key).encode()).hexdigest()[:16]
    path = cache / f"bench-{dimension}d-{count}-{name}.npz"
    known = _read(path)
    if known is None:
        known = _made(dimension, count, walls=walls, cache=cache)
        _write(path, known)
    return known


def grid(count: int, dimension: int) -> tuple[int, ...]:
    """Return the factors of `count`, as equal as there are, ascending.

    >>> grid(2000, 2), grid(2000, 3), grid(7, 2)
    ((40, 50), (10, 10, 20), (1, 7))
    """
    if dimension == 1:
        return (count,)
    divisors = [d for d in range(1, count + 1) if count % d == 0 and d**dimension <= count]
    return min(((d, *grid(count // d, dimension - 1)) for d in divisors), key=max)


def _made(dimension: int, count: int, *, walls: bool, cache: Path) -> BenchPacking:
    if dimension == 3 or count <= TILE or count % TILE:
        return _at_rest(*_on_grid(dimension, count), walls=walls, steps=STEPS, skin=SKIN)
    tile = bench_packing(dimension, TILE, walls=walls, cache=cache)
    return _settled(*_put_together(tile, count // TILE, mirrored=walls), walls=walls)


def _on_grid(dimension: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return x (N, dim), radius (N,) and box (dim,): a jittered grid of random radii."""
    rng = np.random.default_rng([count, dimension])
    radius = rng.uniform(0.5, 1.5, count)
    cells = np.array(grid(count, dimension))
    spacing = (_volumes(radius, dimension).sum() / FRACTION[dimension] / cells.prod()) ** (1.0 / dimension)
    axes = np.meshgrid(*(np.arange(n) + 0.5 for n in cells), indexing="ij")
    x = np.stack([m.ravel() for m in axes], axis=1) + rng.uniform(-JITTER, JITTER, (count, dimension))
    return spacing * x, radius, spacing * cells


def _put_together(tile: BenchPacking, tiles: int, *, mirrored: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return x, radius, box of tiles in the least elongated arrangement; every other one mirrored.

    A disc that overlaps a wall by d would overlap its mirror image by 2 d; mirrored tiles are therefore set apart by
    the mean d, which leaves the mean force at the seams as it was.
    """
    shapes = set(itertools.permutations(grid(tiles, len(tile.box))))
    shape = np.array(min(sorted(shapes), key=lambda s: float((np.array(s) * tile.box).max())))
    pitch = tile.box + (_mean_wall_overlap(tile) if mirrored else 0.0)
    placed = []
    for place in itertools.product(*(range(n) for n in shape)):
        turned = mirrored & (np.array(place) % 2 == 1)
        placed.append(place * pitch + np.where(turned, tile.box - tile.x, tile.x))
    return np.concatenate(placed), np.tile(tile.radius, tiles), tile.box + (shape - 1) * pitch


def _mean_wall_overlap(packing: BenchPacking) -> float:
    overlaps = packing.radius[:, None] - np.minimum(packing.x, packing.box - packing.x)
    return float(overlaps[overlaps > 0.0].mean())


def _at_rest(
    x: np.ndarray, radius: np.ndarray, box: np.ndarray, *, walls: bool, steps: int, skin: float
) -> BenchPacking:
    """Let frictionless elastic particles of unit mass and stiffness slide to rest, smaller ones first."""
    from reference.kernel.program.simulation import ProgramSimulation

    for part, within in (*((part, GROWING_STEPS) for part in GROWTH), (1.0, steps)):
        simulation = ProgramSimulation(_elastic(x, part * radius, box, walls=walls), skin=skin)
        slide_to_rest(simulation, within)
        x = _places(simulation, box, walls=walls)
    return _found(simulation, radius, box, walls=walls)


def _places(simulation, box: np.ndarray, *, walls: bool) -> np.ndarray:
    found = simulation.state.x[:, :simulation.model.particle_count].T.copy()
    return found if walls else np.mod(found, box)


def _settled(x: np.ndarray, radius: np.ndarray, box: np.ndarray, *, walls: bool) -> BenchPacking:
    """Let the same particles come to rest by dashpots and drag; mirror images are first moved off their line."""
    from reference.kernel.program.simulation import ProgramSimulation

    rng = np.random.default_rng(len(x))
    start = x + SEAM_JITTER * rng.standard_normal(x.shape) if walls else x
    model = _elastic(start, radius, box, walls=walls)
    damped = replace(model.normal, normal_damping=SEAM_DASHPOT)
    simulation = ProgramSimulation(
        replace(model, normal=damped, drag=SEAM_DRAG, dt=SEAM_TIME_STEP), skin=SEAM_SKIN)
    for _ in range(SEAM_STEPS // LOOK):
        if _net_force(simulation, len(radius)) < SEAM_REST:
            break
        simulation.advance(LOOK)
    return _found(simulation, radius, box, walls=walls)


def _net_force(simulation, count: int) -> float:
    """Root mean square of a component."""
    return math.sqrt(float((simulation.state.force[:, :count] ** 2).mean()))


def _found(simulation, radius: np.ndarray, box: np.ndarray, *, walls: bool) -> BenchPacking:
    """Return the packing as it is now."""
    state, forces = simulation.state, [f for _, f in simulation.contacts()]
    normal, count = np.concatenate([f.f_n for f in forces]), len(radius)
    net = math.sqrt(float((state.force[:, :count] ** 2).sum(axis=0).mean()))
    return BenchPacking(
        x=_places(simulation, box, walls=walls), radius=radius, box=box, contacts=len(normal) / count,
        unbalanced=net / float(normal.mean()),
    )


def slide_to_rest(simulation, steps: int) -> None:
    """FIRE on a running simulation of free particles (Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006)).

    Velocities turn towards the forces, v -> (1 - a) v + a |v| f/|f|, and stop when they would go uphill, v.f < 0.
    The time step stays as it is; it is looked at every second step.
    """
    turn, nodes = TURN, simulation.nodes
    for _ in range(steps // 2):
        simulation.advance(2)
        v, f = nodes.velocity_vector.view(float), (nodes.force_vector * nodes.kick_factor).view(float)
        if math.sqrt(f @ f / len(f)) < REST * TIME_STEP:
            return
        if v @ f > 0.0:
            v += turn * (math.sqrt((v @ v) / (f @ f)) * f - v)
            turn *= TURN_DECAY
        else:
            v[:] = 0.0
            turn = TURN


TURN, TURN_DECAY, TIME_STEP = 0.15, 0.98, 0.35
"""a at the start and its factor every second step; dt in sqrt(m/k)."""


def _elastic(x: np.ndarray, radius: np.ndarray, box: np.ndarray, *, walls: bool):
    from reference.kernel.conventions import TALK
    from reference.kernel.laws.linear import LinearNormal
    from reference.kernel.model import Model

    count, dimension = x.shape
    return Model(
        x=x.T.copy(), v=np.zeros((dimension, count)), spin=np.zeros((1 if dimension == 2 else 3, count)),
        radius=radius, mass=np.ones(count), inertia=np.ones(count), walls=_planes(box) if walls else (),
        normal=LinearNormal(normal_stiffness=1.0, normal_damping=0.0, attraction="allowed"), sliding=None,
        convention=TALK, dt=TIME_STEP, periodic=None if walls else tuple(box.tolist()),
    )


def _volumes(radius: np.ndarray, dimension: int) -> np.ndarray:
    return np.pi * radius**2 if dimension == 2 else 4.0 / 3.0 * np.pi * radius**3


def _planes(sides: np.ndarray) -> tuple:
    from reference.kernel.model import Wall

    names = ("left", "right", "bottom", "top", "front", "back")
    planes = itertools.product(np.eye(len(sides)), (0.0, 1.0))
    return tuple(
        Wall(name=name, point=tuple(end * axis * sides), normal=tuple((1.0 - 2.0 * end) * axis), friction=False)
        for name, (axis, end) in zip(names, planes, strict=False)
    )


def _read(path: Path) -> BenchPacking | None:
    """Return the cached packing, None when it is missing or damaged (then it is made anew)."""
    try:
        with np.load(path) as saved:
            arrays = {name: saved[name] for name in ("x", "radius", "box", "contacts", "unbalanced")}
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        log.warning("%s: it is not what was written; the packing is made again", path.name)
        return None
    return BenchPacking(**{k: v if v.ndim else float(v) for k, v in arrays.items()})


def _write(path: Path, packing: BenchPacking) -> None:
    from harness.runs.atomic import write_bytes_atomic

    buffer = io.BytesIO()
    np.savez(buffer, **{name: getattr(packing, name) for name in packing.__dataclass_fields__})
    path.parent.mkdir(parents=True, exist_ok=True)
    write_bytes_atomic(path, buffer.getvalue())
