"""Rows of the neutral tables that readers of every code build alike."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import numpy as np

from postproc.snapshot import Columns
from postproc.trajectory import ReadError


class FlatWall(Protocol):
    """A wall as a run had it: start point (dim,), unit normal (dim,), velocity (dim,) if constant, else None."""

    index: int
    name: str
    point: tuple[float, ...]
    normal: tuple[float, ...]
    velocity: tuple[float, ...] | None


def spread(letter: str, vectors: np.ndarray) -> dict[str, np.ndarray]:
    """Return vectors (rows, dim) as columns: "f" gives fx, fy[, fz]."""
    return {letter + axis: vectors[:, k] for k, axis in enumerate("xyz"[: vectors.shape[1]])}


def nearest_image(vectors: np.ndarray, periodic: Sequence[float] | None) -> np.ndarray:
    """Return vectors (rows, dim) from the nearest periodic image; periodic: length an axis, 0 for open ones."""
    if periodic is None:
        return vectors
    length = np.asarray(periodic, dtype=float)
    period = np.where(length > 0, length, np.inf)
    return vectors - np.round(vectors / period) * np.where(length > 0, length, 0.0)


def pair_geometry(
    particles: Columns, i: np.ndarray, j: np.ndarray, axes: str, periodic: Sequence[float] | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return normals (rows, dim) from j to i, overlaps (rows,) and contact points (rows, dim) of pairs.

    i, j: ids, which are row numbers + 1. overlap = R_i + R_j - r; the contact point lies on the
    branch line at x_i - (R_i - overlap/2) n, beside particle i if an image of j is touched.
    """
    x, radius = particles.vector(*axes), particles["radius"]
    branch = nearest_image(x[i - 1] - x[j - 1], periodic)
    distance = np.linalg.norm(branch, axis=1)
    normal = branch / distance[:, None]
    overlap = radius[i - 1] + radius[j - 1] - distance
    return normal, overlap, x[i - 1] - (radius[i - 1] - overlap / 2)[:, None] * normal


def particle_rows(
    path: Path, atoms: Columns, dimension: int, inertia_factor: np.ndarray, positions: str = "",
    turned: np.ndarray | None = None,
) -> Columns:
    """Return the particles of one dump frame, ids 1 to N in order.

    atoms: id, x, y[, z] with the suffix `positions` ("u": unwrapped), v*, omega*, radius, mass.
    inertia_factor: (N,), q in I = q m R^2. turned: (N,), angle since the start in rad, if known.
    Raises ReadError (path) when a particle is missing.
    """
    count = len(inertia_factor)
    if not np.array_equal(atoms["id"], np.arange(1, count + 1)):
        raise ReadError(f"{path}: {atoms.rows} particles, expected ids 1 to {count}")
    axes, spins = "xyz"[:dimension], "z" if dimension == 2 else "xyz"
    columns = {"id": atoms["id"]} | {a: atoms[a + positions] for a in axes}
    columns |= {f"v{a}": atoms[f"v{a}"] for a in axes} | {f"w{a}": atoms[f"omega{a}"] for a in spins}
    columns |= {"radius": atoms["radius"], "mass": atoms["mass"]}
    columns |= {"inertia": inertia_factor * atoms["mass"] * atoms["radius"] ** 2}
    return Columns(columns if turned is None else columns | {"rotation": turned}, "particles")


def summed_rotations(mean_spins: Sequence[np.ndarray], times: Sequence[float]) -> list[np.ndarray]:
    """Return the angle turned since the first frame, rad, (N,) a frame.

    mean_spins: of every frame (N,), the mean of sampled spins since the frame before, rad/s; the
    first is not used. An angle is as good as the sampling.
    """
    turned = [np.zeros_like(mean_spins[0])]
    for spin, duration in zip(mean_spins[1:], np.diff(times), strict=True):
        turned.append(turned[-1] + spin * duration)
    return turned


def wall_rows(planes: Sequence[FlatWall], table: Columns, row: int) -> Columns:
    """Return the walls at one row of a table with the columns of a series.

    A wall stands at its start point displaced by <name>_d along its normal, or by its velocity
    times the time if it has a constant one.
    """
    axes = "xyz"[: len(planes[0].normal)]
    points = [
        p.point + (table[f"{p.name}_d"][row] * np.array(p.normal) if p.velocity is None
                   else table["time"][row] * np.array(p.velocity))
        for p in planes
    ]
    forces = [[table[f"{p.name}_f{a}"][row] for a in axes] for p in planes]
    columns = {"id": np.array([p.index for p in planes])} | spread("p", np.array(points))
    columns |= spread("n", np.array([p.normal for p in planes])) | spread("f", np.array(forces))
    return Columns(columns, "walls")
