"""Displacement and rotation of the particles since a reference state, averaged."""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.geometry import nearest_image, particle_volumes, positions
from postproc.snapshot import MissingColumn, Snapshot

SAME = 1e-6
"""Relative: how far the radius of a particle may be from the reference's, which may have been written in few digits."""


def displacements(cells: Cells, reference: Snapshot | None) -> np.ndarray:
    """u^p = x^p - x^p(reference), (N, dim), m, in the cells' frame, at the particle's present place.

    In a periodic box by the nearest image: right below half a period. MissingColumn without a reference
    or when it holds other particles.
    """
    snapshot = cells.snapshot
    u = positions(snapshot) - positions(_given(reference))[_rows(snapshot, reference)]
    return cells.turned(nearest_image(u, snapshot))


def rotations(cells: Cells, reference: Snapshot | None) -> np.ndarray:
    """theta^p - theta^p(reference), (N,), rad, counter-clockwise: column rotation (2D) of both states."""
    before = _given(reference).particles["rotation"][_rows(cells.snapshot, reference)]
    return cells.snapshot.particles["rotation"] - before


def mean_displacement(cells: Cells, displacements: np.ndarray) -> np.ndarray:
    """u = sum_p w V^p u^p / sum_p w V^p, (K, dim), m. NaN in an empty cell."""
    return _by_volume(cells, displacements)


def mean_rotation(cells: Cells, rotations: np.ndarray) -> np.ndarray:
    """theta = sum_p w V^p theta^p / sum_p w V^p, (K,), rad. NaN in an empty cell."""
    return _by_volume(cells, rotations[:, None])[:, 0]


def displacement_gradient(cells: Cells, displacements: np.ndarray) -> np.ndarray:
    """H_ab = d u_a/d x_b of the mean displacement (by volume), (K, dim, dim), positive in extension.

    Over the present places of the particles, so that the deformation since the reference is (1 - H)^-1.
    """
    return cells.gradient(displacements, particle_volumes(cells.snapshot))


def rotation_gradient(cells: Cells, rotations: np.ndarray) -> np.ndarray:
    """d theta/d x_b of the mean rotation (by volume), (K, dim), 1/m: the kinematic curvature."""
    return cells.gradient(rotations, particle_volumes(cells.snapshot))


def _by_volume(cells: Cells, q: np.ndarray) -> np.ndarray:
    volume = particle_volumes(cells.snapshot)
    return divide(cells.total(volume[:, None] * q), cells.total(volume))


def _given(reference: Snapshot | None) -> Snapshot:
    if reference is None:
        raise MissingColumn("no reference state was given")
    return reference


def _rows(snapshot: Snapshot, reference: Snapshot) -> np.ndarray:
    """Row in the reference of every particle."""
    ids, known = snapshot.particles["id"], reference.particles["id"]
    order = np.argsort(known)
    rows = order[np.minimum(np.searchsorted(known, ids, sorter=order), len(known) - 1)]
    strangers = int((known[rows] != ids).sum())
    if strangers:
        raise MissingColumn(f"{strangers} of {len(ids)} particles are not in the reference state")
    now, before = snapshot.particles["radius"], reference.particles["radius"][rows]
    others = int((np.abs(now - before) > SAME * now).sum())
    if others:
        raise MissingColumn(f"{others} of {len(ids)} particles have another radius there: not the same particles")
    return rows
