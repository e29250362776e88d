"""Strain of the box against a reference state, compression positive."""

from __future__ import annotations

import numpy as np

from postproc.geometry import box_bounds, box_lengths, volume_between
from postproc.snapshot import MissingColumn, Snapshot


def axial_strain(snapshot: Snapshot, reference: Snapshot | None) -> np.ndarray:
    """eps_a = 1 - L_a/L_a^0 for every axis a, shape (dim,): the talks' eps_zz = 1 - z/z_0."""
    return 1.0 - box_lengths(snapshot) / box_lengths(_given(reference))


def volumetric_strain(snapshot: Snapshot, reference: Snapshot | None) -> float:
    """eps_V = 1 - V/V_0, exact at any strain; the sum of the axial strains to first order."""
    reference = _given(reference)
    V, V_0 = (volume_between(box_bounds(s), s) for s in (snapshot, reference))
    return 1.0 - V / V_0


def _given(reference: Snapshot | None) -> Snapshot:
    if reference is None:
        raise MissingColumn("no reference state was given")
    return reference
