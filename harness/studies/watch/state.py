"""One frame as arrays, with everything that overlaps in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.scene.overlaps import initial_overlaps
from harness.scene.system import Particles, Ring, System
from postproc.snapshot import Snapshot


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """x, v (N, dim), spin (N, 1 or 3), radius, mass, inertia (N,) of particles; overlap > 0, relative, reduced (C,).

    The latter of all contacts. first, second: (C,) row numbers, second = -index of a wall or ring. relative: overlap
    over the smaller radius; reduced: R* = a_i a_j/(a_i + a_j), at a wall a_i, m.
    """

    time: float
    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    first: np.ndarray
    second: np.ndarray
    overlap: np.ndarray
    relative: np.ndarray
    reduced: np.ndarray
    snapshot: Snapshot


def state_of(system: System, snapshot: Snapshot) -> State:
    """Return a frame of a run of `system`, with overlaps from places and radii: no engine is asked."""
    p, axes = snapshot.particles, snapshot.axes
    spins = ("wz",) if snapshot.dimension == 2 else ("wx", "wy", "wz")
    arrays = {
        "x": p.vector(*axes), "v": p.vector(*(f"v{a}" for a in axes)), "spin": p.vector(*spins), "radius": p["radius"],
        "mass": p["mass"], "inertia": p["inertia"],
    }
    first, second, overlap, relative, reduced = _overlaps(system, snapshot, arrays)
    return State(
        time=snapshot.time, first=first, second=second, overlap=overlap, relative=relative, reduced=reduced,
        snapshot=snapshot, **arrays,
    )


def _overlaps(system: System, snapshot: Snapshot, now: dict) -> tuple[np.ndarray, ...]:
    if not all(np.isfinite(now[k]).all() for k in ("x", "radius")):
        return (*(np.empty(0, int),) * 2, *(np.empty(0),) * 3)
    there = replace(system, particles=_moved(system, now), walls=_walls_now(system, snapshot))
    found = initial_overlaps(there)
    wall = found.second < 0
    partner = np.where(wall, np.inf, now["radius"][np.where(wall, 0, found.second)])
    reduced = 1 / (1 / now["radius"][found.first] + 1 / partner)
    made = [(found.first, found.second, found.size, found.size / found.smaller, reduced)]
    made += [_at_ring(ring, snapshot.time, now) for ring in system.rings]
    return tuple(np.concatenate(columns) for columns in zip(*made, strict=True))


def _moved(system: System, now: dict) -> Particles:
    """The particles where they are; in a periodic box by the image inside it."""
    x = now["x"]
    if system.periodic is not None:
        box = np.array(system.periodic)
        x = np.where(box > 0, x - box * np.floor(x / np.where(box > 0, box, 1.0)), x)
        x = np.where((box > 0) & (x >= box), 0.0, x)
    factor = now["inertia"] / (now["mass"] * now["radius"] ** 2)
    return Particles(
        x=x, radius=now["radius"], mass=now["mass"], inertia_factor=factor, v=now["v"], spin=now["spin"]
    )


def _walls_now(system: System, snapshot: Snapshot):
    points = [tuple(float(snapshot.walls[f"p{a}"][row]) for a in snapshot.axes) for row in range(len(system.walls))]
    return tuple(replace(wall, point=point) for wall, point in zip(system.walls, points, strict=True))


def _at_ring(ring: Ring, time: float, now: dict) -> tuple[np.ndarray, ...]:
    """Overlaps with glued discs, where the ring has turned to."""
    from scipy.spatial import cKDTree

    angle, centre = (ring.omega or 0.0) * time, np.array(ring.centre)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    glued = centre + (ring.x - centre) @ turn.T
    reach = float(now["radius"].max() + ring.radius.max())
    near = cKDTree(now["x"]).sparse_distance_matrix(cKDTree(glued), reach, output_type="coo_matrix")
    a, b = now["radius"][near.row], ring.radius[near.col]
    overlap = a + b - near.data
    on = overlap > 0
    second = np.full(int(on.sum()), -ring.index)
    return near.row[on], second, overlap[on], (overlap / np.minimum(a, b))[on], (a * b / (a + b))[on]
