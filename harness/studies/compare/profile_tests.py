"""What is tested of two codes' profiles: cell by cell, and as a whole for a common offset."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.studies.compare.pairs import Pair
from harness.studies.compare.profile_quantities import QUANTITIES, Quantity
from harness.studies.compare.profiles import Profile, RingProfiles, mean_over
from harness.studies.compare.significance import Difference, difference_of, frames_needed

All = Mapping[str, Mapping[int, RingProfiles]]
"""Profiles by engine and packing."""

Both = Mapping[int, tuple[RingProfiles, RingProfiles]]
"""Profiles of both sides of a pair, by packing."""


@dataclass(frozen=True, kw_only=True)
class Tested:
    """One profile of one pair.

    difference: in K cells. size: of the profile, in its unit: what a difference is small or large against. depth: of
    the cells from the inner ring, m. span: time that is averaged over, s; needed: that the errors ask for. packings:
    how many both completed. sides: of every packing both profiles; pool: of a single packing all runs'.
    """

    quantity: Quantity
    difference: Difference
    size: float
    depth: np.ndarray
    span: float
    needed: float
    packings: int
    sides: tuple[tuple[Profile, Profile], ...]
    pool: tuple[Profile, ...]

    def over_cells(self) -> Overall:
        """Return the means over the cells that both have, all alike, and their difference: a common offset."""
        cells = self.difference.used
        sides = tuple((mean_over(a, cells), mean_over(b, cells)) for a, b in self.sides)
        pool = tuple(mean_over(p, cells) for p in self.pool)
        return Overall(sides=sides, difference=difference_of(sides, pool), needed=_seconds(pool, self.span))


@dataclass(frozen=True, kw_only=True)
class Overall:
    """One number of both sides, by packing, and its difference; needed: seconds that its errors ask for."""

    sides: tuple[tuple[Profile, Profile], ...]
    difference: Difference
    needed: float


def compared_profiles(pairs: Sequence[Pair], profiles: All) -> dict[Pair, list[Tested]]:
    """Return every profile that both runs of all packings of a pair have."""
    first = [of[0] for of in profiles.values() if 0 in of]
    return {p: list(_tested(both, first)) if (both := p.both(profiles)) else [] for p in pairs}


def _tested(both: Both, everyone: Sequence[RingProfiles]) -> Iterator[Tested]:
    """Yield the tests of a pair. everyone: all runs of the first packing."""
    runs = [run for ab in both.values() for run in ab]
    for quantity in (q for q in QUANTITIES if all(q.name in run.profiles for run in runs)):
        name = quantity.name
        sides = tuple((a.profiles[name], b.profiles[name]) for a, b in both.values())
        pool = tuple(r.profiles[name] for r in everyone if name in r.profiles) if len(both) == 1 else ()
        size, span = _size(quantity, runs), min(r.span for r in runs)
        yield Tested(
            quantity=quantity, difference=difference_of(sides, pool).resolved(size), size=size, sides=sides, pool=pool,
            depth=runs[0].r - runs[0].edges[0], span=span, needed=_seconds(pool, span), packings=len(both),
        )


def _size(quantity: Quantity, runs: Sequence[RingProfiles]) -> float:
    """Root mean square over cells of the largest profile of the group, or of the one it is measured against."""
    names = [quantity.against] if quantity.against else [q.name for q in QUANTITIES if q.group == quantity.group]
    means = [r.profiles[n].mean for r in runs for n in names if n in r.profiles]
    if quantity.centred:
        means = [m - np.nanmean(m) for m in means if np.isfinite(m).any()]
    return max((float(np.sqrt(np.nanmean(m**2))) for m in means if np.isfinite(m).any()), default=0.0)


def _seconds(pool: Sequence[Profile], span: float) -> float:
    """Return how long averages have to be for their errors to be trusted, s; 0 where packings tell them."""
    return frames_needed(pool) * span / max(float(pool[0].frames.max(initial=1)), 1.0) if pool else 0.0
