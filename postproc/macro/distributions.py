"""Distributions of contact forces, velocities and spins, with error bars.

Each takes several snapshots; a snapshot is one sample of the distribution, since particles of one
state are not independent of each other. The error bar of a bin is the standard error of its density over
snapshots, honest as long as these are further apart than the correlation time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from postproc.macro.contact_ends import ContactEnds, contact_ends
from postproc.macro.springs import at_i
from postproc.snapshot import Snapshot


@dataclass(frozen=True, kw_only=True)
class Distribution:
    """A histogram of S samples (sets of values), normalised.

    edges: (B+1,). density: (B,) so that its integral over the bins is `inside`. error: (B,) standard error of
    the density over the samples, NaN for one sample. inside: fraction of all values that lie in the bins.
    values: their number, mean: their mean. scale: what values were divided by before (1: nothing), in their unit.
    """

    edges: np.ndarray
    density: np.ndarray
    error: np.ndarray
    inside: float
    values: int
    mean: float
    scale: float = 1.0

    @property
    def middles(self) -> np.ndarray:
        """Middles of the bins, (B,)."""
        return (self.edges[1:] + self.edges[:-1]) / 2.0


def distribution(samples: Sequence[np.ndarray], edges: np.ndarray) -> Distribution:
    """Normalised histogram over all samples: density_b = n_b/(n width_b), n all values, inside the bins or not.

    error_b^2 = S/(S-1) sum_s (n_sb - n_s p_b)^2/(n width_b)^2 with p_b = n_b/n: the standard error of a ratio of
    means, so that samples of unequal size count by their size. edges: (B+1,) rising, in the unit of the values.
    Raises ValueError without any value: nothing has no distribution.
    """
    edges = np.asarray(edges, dtype=np.float64)
    counts = np.array([np.histogram(s, edges)[0] for s in samples], dtype=np.float64)
    sizes = np.array([len(s) for s in samples], dtype=np.float64)
    n, S = sizes.sum(), len(samples)
    if not n:
        raise ValueError("distribution: expected at least one value, got none")
    part = counts.sum(axis=0) / n
    scatter = ((counts - sizes[:, None] * part) ** 2).sum(axis=0)
    error = np.sqrt(S / (S - 1) * scatter) / n if S > 1 else np.full(len(part), np.nan)
    width = np.diff(edges)
    return Distribution(
        edges=edges, density=part / width, error=error / width, inside=float(part.sum()), values=int(n),
        mean=float(np.concatenate([np.asarray(s, dtype=np.float64) for s in samples]).mean()),
    )


def force_distribution(snapshots: Sequence[Snapshot], edges: np.ndarray, part: str = "total") -> Distribution:
    """Distribution of contact forces over their mean, f/<f>; each contact counts once, walls' too.

    part: "total" |f|, "normal" (positive when pushing), "tangential" |f_t|. The mean is that of all
    contacts of all snapshots, N: `scale` of the result.
    MissingColumn when a snapshot has no contacts recorded. Raises ValueError for another part, without contacts, and
    when the mean is 0.
    """
    if part not in FORCES:
        raise ValueError(f"part: expected one of {', '.join(FORCES)}, got {part!r}")
    sizes = []
    for snapshot in snapshots:
        ends = contact_ends(snapshot)
        sizes.append(FORCES[part](ends)[at_i(ends)])
    mean = float(np.concatenate(sizes).sum()) / max(sum(map(len, sizes)), 1)
    if mean == 0.0 and any(map(len, sizes)):
        raise ValueError(f"force_distribution: the mean {part} force is 0, so there is nothing to scale by")
    return replace(distribution([f / mean for f in sizes], edges), scale=mean)


def _normal(ends: ContactEnds) -> np.ndarray:
    """f_n = -f.n with n out of the particle: positive when the contact pushes."""
    return -(ends.f * ends.n).sum(axis=1)


FORCES = {
    "total": lambda ends: np.linalg.norm(ends.f, axis=1),
    "normal": _normal,
    "tangential": lambda ends: np.linalg.norm(ends.f + _normal(ends)[:, None] * ends.n, axis=1),
}


def velocity_distribution(snapshots: Sequence[Snapshot], edges: np.ndarray, axis: str = "x") -> Distribution:
    """Distribution of one component of the particles' velocities, m/s; axis x, y or z.

    All particles count. For a polar component, or those of one ring, use `distribution`
    on the values themselves.
    """
    return distribution([s.particles["v" + axis] for s in snapshots], edges)


def spin_distribution(snapshots: Sequence[Snapshot], edges: np.ndarray, axis: str = "z") -> Distribution:
    """Distribution of one component of the particles' spins, rad/s, counter-clockwise positive."""
    return distribution([s.particles["w" + axis] for s in snapshots], edges)
