"""What bodies leave a free scene with, from the frames of one run.

Contact times, overlaps and restitution are read off the recorded frames: the begin and end of a
contact are interpolated linearly between frames, so frame spacing limits their accuracy (stated as
`resolution`). Restitution is -(v_n after)/(v_n before), each along the line of centres (or the wall's
normal) of its own frame: the last before and the first after the contact.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from harness.scene.system import System
from harness.studies.compare.growth import nearest_image
from postproc.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class Collision:
    """One contact of bodies i and j (j < 0: wall -j). Times in s, overlap in m.

    end and duration are None while the contact lasts at the end of the run; restitution also when the
    contact lasted at its start, or the bodies did not approach each other before.
    """

    i: int
    j: int
    begin: float
    end: float | None
    duration: float | None
    largest_overlap: float
    restitution: float | None


@dataclass(frozen=True, kw_only=True)
class ExitValues:
    """Final velocities (N, dim) and spins (N, 1|3), the collisions in order of time, frame spacing (s)."""

    velocity: np.ndarray
    spin: np.ndarray
    collisions: tuple[Collision, ...]
    resolution: float


MOST_BODIES = 64
"""Above this number of bodies pairs are not followed: a lattice has no exit values."""


def exit_values(trajectory: Trajectory, system: System) -> ExitValues:
    """Return what every body ends with, and the collisions on the way (for up to 64 bodies)."""
    last = trajectory.frames[-1].particles
    axes, spins = "xyz"[: system.dimension], (["wz"] if system.dimension == 2 else ["wx", "wy", "wz"])
    times = np.array([f.time for f in trajectory])
    found: list[Collision] = []
    if len(system.particles) <= MOST_BODIES and len(times) > 1:
        found = [c for pair in _gaps(trajectory, system) for c in _collisions(times, *pair)]
    return ExitValues(
        velocity=last.vector(*(f"v{a}" for a in axes)),
        spin=last.vector(*spins),
        collisions=tuple(sorted(found, key=lambda c: c.begin)),
        resolution=float(times[1] - times[0]) if len(times) > 1 else float("nan"),
    )


def _gaps(trajectory: Trajectory, system: System) -> Iterator[tuple[int, int, np.ndarray, np.ndarray]]:
    """Yield (i, j, overlap (F,), normal velocity (F,)) of every pair and every body and wall.

    The normal velocity is that of separation; of walls it is the rate of their places in the frames.
    """
    axes = "xyz"[: system.dimension]
    x = np.array([f.particles.vector(*axes) for f in trajectory])
    v = np.array([f.particles.vector(*(f"v{a}" for a in axes)) for f in trajectory])
    radius = system.particles.radius
    for i in range(len(radius)):
        for j in range(i + 1, len(radius)):
            branch = nearest_image(x[:, i] - x[:, j], system.periodic)
            distance = np.linalg.norm(branch, axis=1)
            v_n = np.einsum("fk,fk->f", v[:, i] - v[:, j], branch) / distance
            yield i + 1, j + 1, radius[i] + radius[j] - distance, v_n
        for k, wall in enumerate(system.walls):
            n = np.array(wall.normal)
            point = np.array([f.walls.vector(*(f"p{a}" for a in axes))[k] for f in trajectory])
            rate = np.gradient(point @ n, [f.time for f in trajectory])
            yield i + 1, -wall.index, radius[i] - (x[:, i] - point) @ n, v[:, i] @ n - rate


def _collisions(times: np.ndarray, i: int, j: int, overlap: np.ndarray, v_n: np.ndarray) -> Iterator[Collision]:
    """Yield the contacts of one pair; k is the last frame before a contact, end the last one in it."""
    touching = overlap > 0.0
    edges = np.flatnonzero(np.diff(touching.astype(int)))
    begins = ([None] if touching[0] else []) + [k for k in edges if touching[k + 1]]
    ends = [k for k in edges if touching[k]]
    for number, k in enumerate(begins):
        end = ends[number] if number < len(ends) else None
        begin = float(times[0]) if k is None else _crossing(times, overlap, k)
        stop = None if end is None else _crossing(times, overlap, end)
        inside = slice(0 if k is None else k + 1, len(times) if end is None else end + 1)
        yield Collision(
            i=i, j=j, begin=begin, end=stop, duration=None if stop is None else stop - begin,
            largest_overlap=float(overlap[inside].max()),
            restitution=None if k is None or end is None or v_n[k] >= 0.0 else float(-v_n[end + 1] / v_n[k]),
        )


def _crossing(times: np.ndarray, overlap: np.ndarray, k: int) -> float:
    """Time between frames k and k + 1 at which the overlap passes zero, by linear interpolation."""
    part = overlap[k] / (overlap[k] - overlap[k + 1])
    return float(times[k] + part * (times[k + 1] - times[k]))
