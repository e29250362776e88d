"""One system in which every motion in every frame takes place at once, each far from the others.

All pairs are copies of one, and all bodies at planes copies of its body i, so that a system has one reduced mass and
one reduced radius: codes that are told restitutions instead of damping constants can then be told the right ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.protocol import Prescribed, Reaction
from harness.scene.system import INERTIA_FACTOR, Particles, System, Wall
from harness.studies.laws.frames import TILT, Frame, frames
from harness.studies.laws.motions import DT, ROWS, UNEQUAL, Grains, Motion, Partner, motions
from harness.studies.laws.rounding import distance, settled

if TYPE_CHECKING:
    from harness.studies.laws.cases import Laws

PAIR_SPACING, PLANE_SPACING = 6.0 * UNEQUAL.radii[0], 3.0 * UNEQUAL.radii[0]
"""Between the places of two contacts: close to each other, because coordinates far from the origin cost digits, and
binary fractions, which add no rounding of their own."""

NORMALS = {"level": (0.0, 1.0), "tilted": (-math.sin(TILT), math.cos(TILT))}
"""Of the planes, x and y."""


@dataclass(frozen=True, kw_only=True)
class Track:
    """One motion in one frame; `bodies`: row numbers of its bodies in the system, in the order i, j."""

    motion: Motion
    frame: Frame
    bodies: tuple[int, ...]

    def local(self, reaction: Reaction) -> tuple[np.ndarray, np.ndarray]:
        """Return this track's force and torque in (n, t, b), each (S, bodies, 3); what 2D leaves out is zero."""
        rows = list(self.bodies)
        force, torque = reaction.force[:, rows], reaction.torque[:, rows]
        if force.shape[2] == 2:
            force, torque = _with_z(force), np.concatenate([np.zeros_like(force), torque], axis=2)
        return self.frame.back(force, torque)


@dataclass(frozen=True, kw_only=True)
class Arrangement:
    """All tracks of contacts of one kind in one dimension."""

    partner: Partner
    dimension: int
    grains: Grains
    tracks: tuple[Track, ...]
    path: Prescribed
    particles: Particles
    walls: tuple[Wall, ...]

    def system(self, laws: Laws, name: str) -> System:
        """Return the system of these bodies with these contact laws."""
        return System(
            dimension=self.dimension, particles=self.particles, walls=self.walls, **laws.tables(), background=None,
            gravity=None, periodic=None, dt=DT, steps=ROWS, sample_every=ROWS, frame_every=ROWS, contacts=False,
            scene_name=name, title=f"{name.replace('_', ' ')} along prescribed paths",
        )

    def tracks_of(self, motion: str) -> tuple[Track, ...]:
        """Return the tracks of a motion, the plain frame first."""
        return tuple(t for t in self.tracks if t.motion.name == motion)

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the motions."""
        return tuple(dict.fromkeys(t.motion.name for t in self.tracks))


@cache
def arrangement(partner: Partner, dimension: int, grains: Grains = UNEQUAL) -> Arrangement:
    """Return the arrangement of pairs, or of bodies at a level and a tilted plane; 2 or 3 dimensions."""
    bodies = 2 if partner == "pair" else 1
    chosen = [(m, f) for m in motions(partner, dimension, grains) for f in frames(partner, dimension)]
    tracks = tuple(
        Track(motion=m, frame=f, bodies=_rows(k * bodies, bodies, f)) for k, (m, f) in enumerate(chosen)
    )
    path = _path(tracks, _places(tracks, partner, dimension), dimension)
    return Arrangement(
        partner=partner, dimension=dimension, grains=grains, tracks=tracks, path=path,
        particles=_particles(tracks, path, dimension, grains), walls=() if partner == "pair" else _walls(dimension),
    )


def _rows(first: int, bodies: int, frame: Frame) -> tuple[int, ...]:
    rows = tuple(range(first, first + bodies))
    return rows[::-1] if frame.swapped else rows


def _path(tracks: tuple[Track, ...], places: np.ndarray, dimension: int) -> Prescribed:
    count = sum(len(t.bodies) for t in tracks)
    x, v, spin = (np.zeros((ROWS + 1, count, 3)) for _ in range(3))
    for track, place in zip(tracks, places, strict=True):
        rows = list(track.bodies)
        x[:, rows], v[:, rows], spin[:, rows] = track.frame.embed(track.motion)
        x[:, rows] += place
        _settle(track, x)
    if dimension == 3:
        return Prescribed(x=x, v=v, spin=spin)
    return Prescribed(x=x[..., :2].copy(), v=v[..., :2].copy(), spin=spin[..., 2:].copy())


def _settle(track: Track, x: np.ndarray) -> None:
    """Round the places of body i so that its distance to its partner is the motion's; x: (S + 1, N, 3), changed."""
    i, own = track.bodies[0], track.motion.x
    if len(track.bodies) == 2:
        j = track.bodies[1]
        apart = distance(x[:, i], x[:, j])
        normal, excess = (x[:, i] - x[:, j]) / apart.astype(float)[:, None], apart - distance(own[:, 0], own[:, 1])
    else:
        normal = np.broadcast_to((*NORMALS[_wall_of(track.frame)], 0.0), x[:, i].shape)
        excess = (x[:, i].astype(np.longdouble) * normal).sum(axis=-1) - own[:, 0, 0]
    x[:, i] = settled(x[:, i], normal, excess)


def _particles(tracks: tuple[Track, ...], path: Prescribed, dimension: int, grains: Grains) -> Particles:
    count = path.x.shape[1]
    radius, mass = np.empty(count), np.empty(count)
    for track in tracks:
        for role, row in enumerate(track.bodies):
            radius[row], mass[row] = grains.radii[role], grains.masses[role]
    inertia = INERTIA_FACTOR["disc" if dimension == 2 else "sphere"]
    return Particles(
        x=path.x[0], v=path.v[0], spin=path.spin[0], radius=radius, mass=mass,
        inertia_factor=np.full(count, inertia),
    )


# --- places ----------------------------------------------------------------------------------------


def _places(tracks: tuple[Track, ...], partner: Partner, dimension: int) -> np.ndarray:
    """Origins of the contacts, (tracks, 3)."""
    if partner == "pair":
        return PAIR_SPACING * _lattice(len(tracks), dimension)
    tilted = np.array([_wall_of(t.frame) == "tilted" for t in tracks])
    places = np.empty((len(tracks), 3))
    places[~tilted] = _along_plane((~tilted).sum(), np.array([-1.0, 0.0]), dimension)
    places[tilted] = _along_plane(tilted.sum(), np.array([math.cos(TILT), math.sin(TILT)]), dimension)
    return places


def _lattice(count: int, dimension: int) -> np.ndarray:
    """A cubic lattice about the origin, (count, 3), filled from one corner."""
    side = math.ceil(count ** (1.0 / dimension) - 1e-9)
    axes = np.unravel_index(np.arange(count), (side,) * dimension)
    return np.stack([*(a - side // 2 for a in axes), *[np.zeros(count)] * (3 - dimension)], axis=-1)


def _along_plane(count: int, uphill: np.ndarray, dimension: int) -> np.ndarray:
    """Places on the half-plane that starts at the z axis, (count, 3)."""
    across = 1 if dimension == 2 else 3
    step, side = np.divmod(np.arange(count), across)
    flat = PLANE_SPACING * (step + 1)[:, None] * uphill
    return np.column_stack([flat, PLANE_SPACING * (side if dimension == 3 else 0.0 * side)])


def _walls(dimension: int) -> tuple[Wall, ...]:
    """The level plane y = 0 on the left and the tilted one on the right, both through the origin."""
    out_of_plane = (0.0,) * (dimension - 2)
    return tuple(
        Wall(index=k + 1, name=name, point=(0.0, 0.0, *out_of_plane), normal=(*normal, *out_of_plane), friction=True)
        for k, (name, normal) in enumerate(NORMALS.items())
    )


def _wall_of(frame: Frame) -> str:
    """Name of the plane that bodies in this frame touch."""
    return "tilted" if frame.name == "tilted" else "level"


def _with_z(vectors: np.ndarray) -> np.ndarray:
    """Append a component of zeros to (S, bodies, 2)."""
    return np.concatenate([vectors, np.zeros_like(vectors[..., :1])], axis=2)
