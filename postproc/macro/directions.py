"""Directions: of principal axes, between them, and of contacts as histograms. In the plane (2D) unless said."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.macro.contact_ends import WALL, ContactEnds
from postproc.snapshot import MissingColumn

BINS = 36
"""Bins of a direction histogram over the full circle, 10 degrees each."""


def orientation(major: np.ndarray) -> np.ndarray:
    """Angle of a major direction (K, 2) from the first axis (x or r), degrees, in (-90, 90], (K,).

    Counter-clockwise positive. NaN where there is none (isotropic).
    """
    _in_plane(major.shape[1], "an orientation angle")
    return _half_turn(np.degrees(np.arctan2(major[:, 1], major[:, 0])))


def non_colinearity(major_a: np.ndarray, major_b: np.ndarray) -> np.ndarray:
    """Angle from major direction a to major direction b, degrees, (K,).

    2D: in (-90, 90], counter-clockwise positive (from x to y, from r to phi); axes have no arrow, so that
    turning either by 180 degrees changes nothing. 3D: the size, in [0, 90]. NaN where either is isotropic.
    Stress, elastic strain and fabric of an isotropic elastic body give 0: Laetzel, Luding, Herrmann, Granular
    Matter 2, 123 (2000) find that they do not.
    """
    along = (major_a * major_b).sum(axis=1)
    if major_a.shape[1] == 3:
        return np.degrees(np.arctan2(np.linalg.norm(np.cross(major_a, major_b), axis=1), np.abs(along)))
    across = major_a[:, 0] * major_b[:, 1] - major_a[:, 1] * major_b[:, 0]
    return _half_turn(np.degrees(np.arctan2(across, along)))


def _half_turn(degrees: np.ndarray) -> np.ndarray:
    """Bring angles of axes into (-90, 90]."""
    return 90.0 - np.mod(90.0 - degrees, 180.0)


def contact_directions(ends: ContactEnds, cells: Cells, *, walls: bool = False, bins: int = BINS) -> np.ndarray:
    """Probability density p(phi) of contact directions, (K, bins), 1/rad: sum over bins of p times their width is 1.

    phi: direction of n^pc out of the particle, counter-clockwise from the first axis of the frame (x or r); bin b
    spans [b, b+1) 2 pi/bins. Counted from the particles of a cell with their weights, as the talk does; contacts
    with walls are left out, and are the only ones with walls=True: all of them point to the wall.
    NaN in a cell without such contacts. Source: the talk, "Fabric tensor": contact probability, centre and wall.
    """
    _in_plane(cells.snapshot.dimension, "a direction histogram")
    if cells.frame != "cartesian" and cells.turn is None:
        raise MissingColumn("cells that average at points have direction histograms in the Cartesian frame only")
    chosen = (ends.partner == WALL) == walls
    n, particle = ends.n[chosen], ends.particle[chosen]
    turns = np.mod(np.arctan2(n[:, 1], n[:, 0]) / (2.0 * np.pi), 1.0)
    bin_ = np.minimum((turns * bins).astype(int), bins - 1)
    counts = np.bincount(particle * bins + bin_, minlength=ends.count * bins).reshape(ends.count, bins)
    per_bin = cells.total(counts)
    return divide(per_bin, per_bin.sum(axis=1)) * bins / (2.0 * np.pi)


@dataclass(frozen=True, kw_only=True)
class SecondOrder:
    """p(phi) = (1/2 pi)[1 + amplitude cos 2(phi - angle)].

    amplitude: (K,) >= 0, above 1 where the density would be negative. angle: (K,) degrees in (-90, 90].
    """

    amplitude: np.ndarray
    angle: np.ndarray


def second_order(density: np.ndarray) -> SecondOrder:
    """Fit the second order of a Fourier series to direction histograms (K, bins); exact for such densities.

    Least squares on the bins' means: a cosine averaged over a bin of width w is sin(w)/w times that in its
    middle, which is divided out. amplitude/4 is the deviator of the contact fabric <n n> (trace 1), up to the
    binning: <n n> = (1 + (amplitude/2) (cos 2a, sin 2a; sin 2a, -cos 2a))/2.
    Order 2 is the least that fabric knows: Rothenburg and Bathurst, Geotechnique 39, 601 (1989).
    """
    bins = density.shape[1]
    width = 2.0 * np.pi / bins
    middles = (np.arange(bins) + 0.5) * width
    moment = density @ np.exp(2j * middles) * width / (np.sin(width) / width)
    return SecondOrder(amplitude=2.0 * np.abs(moment), angle=_half_turn(np.degrees(np.angle(moment) / 2.0)))


def _in_plane(dimension: int, what: str) -> None:
    if dimension != 2:
        raise MissingColumn(f"{what} needs a 2D state")
