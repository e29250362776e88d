"""Do two codes have the same profiles? The profiles of a group and pair are one test (level L3).

It shares its rate of false alarms with all others of a report (`harness.studies.compare.alarms`); of its N cells each
is tested at 1/N of its level, with Student's t (`harness.studies.compare.significance`).

    differs       in a cell or more, whose errors are to be trusted, a difference is seen
    agrees        in none; of every profile of the group a difference of the declared margin (a part of the profile's
                  size) would have been seen in at least MOST of the cells, in each with probability POWER; and in
                  the others none as large was found
    inconclusive  neither: it is said which margin could have been resolved, and how much more it would take

What all cells have in common, and single cells do not show, is tested by itself (`ring_family`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.scene.judged import FALSE_ALARMS, RING_MARGIN
from harness.studies.compare.alarms import judged_together, smallest_p
from harness.studies.compare.pairs import Pair
from harness.studies.compare.profile_quantities import QUANTITIES
from harness.studies.compare.profile_tests import All, Both, Tested, compared_profiles
from harness.studies.compare.significance import POWER, Difference
from harness.studies.verdict import Check, Rerun, not_checked

FEWEST = 3
"""Packings below which their spread means nothing."""

MOST = 0.75
"""Part of the cells in which a difference of the margin must be seen. Not all: in the layers at the rough rings frames
scatter several times as much as elsewhere, and of some profiles never settle."""

FOREVER = 1e4
"""Times as long, or packings, beyond which "more" is no advice."""

GROUPS = tuple(dict.fromkeys(q.group for q in QUANTITIES))
"""What is judged together, in the order in which it is shown."""

LISTED = 6
"""Cells that a verdict names; all are in profiles.csv."""


@dataclass(frozen=True, kw_only=True)
class GroupTest:
    """The profiles of a group of one pair, those that have a value in half of the frames somewhere.

    absent: why there is none.
    """

    pair: Pair
    quantity: str
    tested: tuple[Tested, ...]
    margin: float
    rerun: str
    absent: str = ""

    @property
    def cells(self) -> int:
        """Number of cells, of all profiles."""
        return sum(int(t.difference.used.sum()) for t in self.tested)

    @property
    def p(self) -> float | None:
        """The p-value of "no cell differs", of those whose errors are to be trusted; None without a cell."""
        apart = (t.difference.p_values()[t.difference.trusted] for t in self.tested)
        return smallest_p(apart, self.cells) if self.tested else None

    def check(self, level: float) -> Check:
        """Return the verdict of a test at this level."""
        facts = {"level": "L3", "quantity": self.quantity, "left": self.pair.left, "right": self.pair.right}
        if not self.tested:
            return not_checked(**facts, why=self.absent)
        return _judged(self.tested, level / self.cells, self.margin, facts, self.rerun)


def profile_checks(
    pairs: Sequence[Pair], profiles: All, rerun: Rerun, margin: float = RING_MARGIN, false_alarms: float = FALSE_ALARMS,
) -> list[Check]:
    """Judge profiles that share their rate of false alarms with nothing else."""
    tests = profile_tests(pairs, profiles, rerun, margin, compared_profiles(pairs, profiles))
    return judged_together(tests, false_alarms)


def profile_tests(
    pairs: Sequence[Pair], profiles: All, rerun: Rerun, margin: float, tested: Mapping[Pair, Sequence[Tested]]
) -> list[GroupTest]:
    """Return one test a pair and group of profiles. tested: what `compared_profiles` makes."""
    return [test for pair in pairs for test in _of_pair(pair, profiles, tested[pair], margin, rerun)]


def _of_pair(
    pair: Pair, profiles: All, tested: Sequence[Tested], margin: float, rerun: Rerun
) -> list[GroupTest]:
    facts = {"pair": pair, "margin": margin, "rerun": rerun(pair.left, pair.right)}
    both = pair.both(profiles)
    if not both:
        why = pair.missing(profiles) or "no packing that both completed"
        return [GroupTest(quantity="profiles", tested=(), absent=why, **facts)]
    found = []
    for group in GROUPS:
        mine = [t for t in tested if t.quantity.group == group]
        kept = tuple(t for t in mine if t.difference.used.any())
        why = "no cell has a value in half of the frames" if mine else _absent(group, both)
        found.append(GroupTest(quantity=f"profile: {group}", tested=kept, absent="" if kept else why, **facts))
    return found


def _absent(group: str, both: Both) -> str:
    """Say why one of the runs has no profile of a group."""
    names = [q.name for q in QUANTITIES if q.group == group]
    return next(run.absent[n] for ab in both.values() for run in ab for n in names if n in run.absent)


def _judged(kept: Sequence[Tested], level: float, margin: float, facts: dict, rerun: str) -> Check:
    """Judge the profiles of a group, each cell at this level.

    Sizes are those of the cell that lies furthest out, over the profile's size.
    """
    worst = max(kept, key=lambda t: np.nanmax(_excess(t, level)))
    cell = int(np.nanargmax(_excess(worst, level)))
    d, limit = worst.difference, float(worst.difference.limit(level)[cell])
    facts = {
        **facts, "deviation": _part(abs(d.value[cell]), worst.size), "tolerance": margin,
        "chance": _part(limit * d.error[cell], worst.size),
    }
    where = (
        f"largest: {worst.quantity.name} at r - R_i = {1e3 * worst.depth[cell]:.3g} mm, {d.sizes[cell]:.3g} of "
        f"{limit:.3g} standard errors"
    )
    apart = [named for t in kept for named in _apart(t, level)]
    if apart:
        more = f" and {len(apart) - LISTED} more" if len(apart) > LISTED else ""
        cells = sum(int(t.difference.used.sum()) for t in kept)
        why = f"in {len(apart)} of {cells} cells: {', '.join(apart[:LISTED])}{more}; {where}; rerun: {rerun}"
        return Check(**facts, verdict="differs", why=why)
    doubt = _doubt(kept, level, margin)
    if doubt:
        return Check(**facts, verdict="inconclusive", why=f"{doubt}; {where}")
    return Check(**facts, verdict="agrees", why=f"no difference seen in any cell; {_seen(kept, level)}; {where}")


def _part(value: float, size: float) -> float | None:
    return float(value) / size if size > 0 and np.isfinite(value) else None


def _excess(t: Tested, level: float) -> np.ndarray:
    """How many times its limit the difference is, (K,), NaN in cells that are not used; short ones count for less."""
    d = t.difference
    with np.errstate(invalid="ignore"):
        return np.where(d.used, d.sizes / d.limit(level), np.nan)


def _apart(t: Tested, level: float) -> list[str]:
    """Name the cells whose difference is beyond its limit, errors that are to be trusted."""
    beyond = t.difference.trusted & ~(_excess(t, level) <= 1.0)
    return [f"{t.quantity.name} {1e3 * depth:.3g} mm" for depth in t.depth[beyond]]


# --- what would have been seen -------------------------------------------------------------------


def _doubt(tested: Sequence[Tested], level: float, margin: float) -> str:
    """Say why agreement would mean nothing, "" if it does."""
    short = [t for t in tested if (t.difference.short & t.difference.used).any()]
    if short:
        most = max(short, key=lambda t: t.needed)
        return (
            f"too few autocorrelation times in {', '.join(t.quantity.name for t in short)}: {most.needed:.3g} s to "
            f"average over would do, there are {most.span:.3g} s"
        )
    packings = tested[0].packings
    if 1 < packings < FEWEST:
        return f"{packings} packings, their spread needs {FEWEST}"
    blind = [t for t in tested if not resolved(t.difference, t.size, level) <= margin]
    if blind:
        return (
            f"blind to the margin of {_percent(margin)}: {_seen(blind, level)}; the margin takes "
            f"{_more(blind, level, margin)}"
        )
    large = [named for t in tested for named in _larger(t, margin)]
    return f"larger than the margin of {_percent(margin)}, where it is not seen: {', '.join(large)}" if large else ""


def _larger(t: Tested, margin: float) -> list[str]:
    """Name the cells that are further apart than the margin, by how much."""
    d = t.difference
    beyond = np.flatnonzero(d.used & (np.abs(d.value) > margin * t.size))
    return [
        f"{t.quantity.name} {1e3 * t.depth[k]:.3g} mm {_percent(abs(d.value[k]) / t.size)}" for k in beyond
    ]


def _percent(part: float) -> str:
    percent = 100.0 * part
    return f"{percent:.0f} %" if percent >= 10.0 else f"{percent:.2g} %"


def resolved(difference: Difference, size: float, level: float) -> float:
    """Return the smallest part of the size that would be seen in MOST of the cells, each with probability POWER."""
    from_ = difference.seen_from(level)[difference.used]
    if not from_.size or not size > 0:
        return 0.0 if not from_.any() else np.inf
    return float(np.quantile(from_, MOST, method="inverted_cdf")) / size


def _seen(tested: Sequence[Tested], level: float) -> str:
    """Say how small a difference would have been seen in MOST of the cells."""
    parts = ", ".join(f"{_percent(resolved(t.difference, t.size, level))} of {t.quantity.name}" for t in tested)
    return f"in {MOST:.0%} of the cells would be seen {parts} (probability {POWER:g})"


def _more(tested: Sequence[Tested], level: float, margin: float) -> str:
    """Say how long or over how many packings to average for the margin to be resolved in all of these profiles."""
    packings, span = tested[0].packings, max(t.span for t in tested)

    def most(change: Callable[[Difference, float], Difference], low: float) -> float:
        return max(_least(lambda x, t=t: resolved(change(t.difference, x), t.size, level) <= margin, low)
                   for t in tested)

    number = most(lambda d, n: d.over_packings(n, packings), max(FEWEST, packings))
    over = f"about {_about(np.ceil(number))} packings" if number < FOREVER else "more packings than anybody makes"
    if packings > 1:
        return over
    times = most(Difference.longer, 1.0)
    long = f"about {_about(times * span)} s to average over" if times < FOREVER else "longer than anybody runs"
    return f"{long}, where there are {span:.3g} s, or {over} of this length"


def _least(enough: Callable[[float], bool], low: float) -> float:
    """Return the least number from `low` on that is enough, to 1 %; FOREVER if none below it is."""
    high = FOREVER
    if not enough(high):
        return high
    while high / low > 1.01:
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if enough(middle) else (middle, high)
    return high


def _about(number: float) -> str:
    """Round up to two digits: errors of errors are known no better."""
    step = 10.0 ** max(np.floor(np.log10(max(number, 1.0))) - 1.0, 0.0)
    return f"{np.ceil(number / step) * step:.0f}"
