"""Do two codes have the same profiles? Every profile of every pair, at one declared rate of false alarms (level L3).

In a whole comparison of codes that agree, the probability that any profile is said to differ is at most `FALSE_ALARM`:
each of its N tests (pairs x profiles x cells) is made at FALSE_ALARM/N (Bonferroni; O. J. Dunn, J. Am. Stat. Assoc. 56,
52 (1961)), with Student's t, see `harness.studies.compare.significance`.

A profile agrees only if a difference would have been seen: where in most cells not even one as large as the profile
itself would, and where a run is too short for its error bars to be trusted, the check is inconclusive.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.studies.compare.pairs import Pair
from harness.studies.compare.profile_quantities import QUANTITIES, Quantity
from harness.studies.compare.profiles import Profile, RingProfiles
from harness.studies.compare.significance import Difference, frames_needed, of_packings, of_times
from harness.studies.verdict import Check, Rerun, not_checked

FALSE_ALARM = 0.01
"""Of a whole comparison."""

FEWEST = 3
"""Packings below which their spread means nothing."""

GROUPS = tuple(dict.fromkeys(q.group for q in QUANTITIES))
"""What is judged together, in the order in which it is shown."""

LISTED = 6
"""Cells that a verdict names; all are in profiles.csv."""

All = Mapping[str, Mapping[int, RingProfiles]]
"""Profiles by engine and packing."""


@dataclass(frozen=True, kw_only=True)
class Tested:
    """One profile of one pair. size: of the profile, in its unit: what a difference is small or large against."""

    quantity: Quantity
    difference: Difference
    size: float
    depth: np.ndarray
    longer: str


def profile_checks(pairs: Sequence[Pair], profiles: All, rerun: Rerun) -> list[Check]:
    """One check a pair and group of profiles."""
    both = {p: p.both(profiles) for p in pairs}
    first = [of[0] for of in profiles.values() if 0 in of]
    tested = {p: list(_tested(b, first)) if b else [] for p, b in both.items()}
    number = sum(int(t.difference.used.sum()) for of in tested.values() for t in of)
    level = FALSE_ALARM / max(number, 1)
    found = []
    for pair in pairs:
        facts = {"level": "L3", "left": pair.left, "right": pair.right}
        if not both[pair]:
            why = pair.missing(profiles) or "no packing that both completed"
            found.append(not_checked(**facts, quantity="profiles", why=why))
            continue
        for group in GROUPS:
            mine = [t for t in tested[pair] if t.quantity.group == group]
            named = {**facts, "quantity": f"profile: {group}"}
            if mine:
                found.append(_judged(mine, level, named, rerun(pair.left, pair.right)))
            else:
                found.append(not_checked(**named, why=_absent(group, both[pair])))
    return found


def _absent(group: str, both: Mapping[int, tuple[RingProfiles, RingProfiles]]) -> str:
    """Say why one of the runs has no profile of a group."""
    names = [q.name for q in QUANTITIES if q.group == group]
    return next(run.absent[n] for ab in both.values() for run in ab for n in names if n in run.absent)


def _tested(
    both: Mapping[int, tuple[RingProfiles, RingProfiles]], everyone: Sequence[RingProfiles]
) -> Iterator[Tested]:
    """Yield every profile that both runs of all packings have. everyone: all runs of the first packing."""
    pairs = list(both.values())
    present = [q for q in QUANTITIES if all(q.name in run.profiles for ab in pairs for run in ab)]
    for quantity in present:
        profiles = [(a.profiles[quantity.name], b.profiles[quantity.name]) for a, b in pairs]
        runs = [run for ab in pairs for run in ab]
        pool = [r.profiles[quantity.name] for r in everyone if quantity.name in r.profiles] if len(pairs) == 1 else []
        difference = of_times(*profiles[0], pool or profiles[0]) if len(pairs) == 1 else of_packings(profiles)
        size = _size(quantity, runs)
        yield Tested(
            quantity=quantity, difference=difference.resolved(size), size=size,
            depth=runs[0].r - runs[0].edges[0], longer=_longer(runs, pool, len(pairs)),
        )


def _size(quantity: Quantity, runs: Sequence[RingProfiles]) -> float:
    """Root mean square over cells of the largest profile of the group, or of the one it is measured against."""
    names = [quantity.against] if quantity.against else [q.name for q in QUANTITIES if q.group == quantity.group]
    means = [r.profiles[n].mean for r in runs for n in names if n in r.profiles]
    return max((float(np.sqrt(np.nanmean(m**2))) for m in means if np.isfinite(m).any()), default=0.0)


def _longer(runs: Sequence[RingProfiles], pool: Sequence[Profile], packings: int) -> str:
    """Say how much more it takes, "" if there is enough."""
    if packings > 1:
        return f"{packings} packings, their spread needs {FEWEST}" if packings < FEWEST else ""
    needed = frames_needed(pool) * runs[0].spacing
    return f"{needed:.3g} s to average over would do, there are {min(r.span for r in runs):.3g} s"


def _judged(tested: Sequence[Tested], level: float, facts: dict, rerun: str) -> Check:
    """Judge the profiles of a group by the cell that lies furthest out."""
    kept = [t for t in tested if t.difference.used.any()]
    if not kept:
        return not_checked(**facts, why="no cell has a value in half of the frames")
    worst = max(kept, key=lambda t: np.nanmax(_excess(t, level)))
    cell = int(np.nanargmax(_excess(worst, level)))
    facts = {
        **facts, "deviation": _finite(worst.difference.sizes[cell]),
        "tolerance": float(worst.difference.limit(level)[cell]),
    }
    where = f"{worst.quantity.name} at r - R_i = {1e3 * worst.depth[cell]:.3g} mm, in standard errors"
    apart = [named for t in kept for named in _apart(t, level)]
    if apart:
        more = f" and {len(apart) - LISTED} more" if len(apart) > LISTED else ""
        cells = sum(int(t.difference.used.sum()) for t in kept)
        why = f"in {len(apart)} of {cells} cells: {', '.join(apart[:LISTED])}{more}; largest: {where}; rerun: {rerun}"
        return Check(**facts, verdict="differs", why=why)
    doubt = _doubt(kept, level)
    if doubt:
        return Check(**facts, verdict="inconclusive", why=f"{doubt}; largest so far: {where}")
    return Check(**facts, verdict="agrees", why=f"{where}; {_seen(kept, level)}")


def _excess(t: Tested, level: float) -> np.ndarray:
    """How many times its limit the difference is, (K,), NaN in cells that are not used; short ones count for less."""
    d = t.difference
    with np.errstate(invalid="ignore"):
        return np.where(d.used, d.sizes / d.limit(level), np.nan)


def _apart(t: Tested, level: float) -> list[str]:
    """Name the cells whose difference is beyond its limit, errors that are to be trusted."""
    beyond = t.difference.used & ~t.difference.short & ~(_excess(t, level) <= 1.0)
    return [f"{t.quantity.name} {1e3 * depth:.3g} mm" for depth in t.depth[beyond]]


def _doubt(tested: Sequence[Tested], level: float) -> str:
    """Say why agreement would mean nothing, "" if it does."""
    short = [t for t in tested if (t.difference.short & t.difference.used).any()]
    if short:
        most = max(short, key=lambda t: _seconds(t.longer))
        return f"too few autocorrelation times in {', '.join(t.quantity.name for t in short)}: {most.longer}"
    few = next((t.longer for t in tested if "packings" in t.longer), "")
    if few:
        return few
    blind = [t for t in tested if _blind(t, level) > 0.5]
    if len(blind) == len(tested):
        part = ", ".join(t.quantity.name for t in blind)
        return f"a difference as large as {part} itself would not be seen in most cells"
    return ""


def _seconds(longer: str) -> float:
    return float(longer.split(" ")[0]) if longer else 0.0


def _blind(t: Tested, level: float) -> float:
    """Part of the cells in which a difference of the profile's own size would not be seen."""
    half = (t.difference.limit(level) * t.difference.error)[t.difference.used]
    return float(np.mean(half > t.size)) if half.size else 1.0


def _seen(tested: Sequence[Tested], level: float) -> str:
    """Say how small a difference would have been seen, in the middle of all cells."""
    parts = []
    for t in tested:
        half = (t.difference.limit(level) * t.difference.error)[t.difference.used]
        if half.size and t.size:
            parts.append(f"{100 * float(np.median(half)) / t.size:.2g} % of {t.quantity.name}")
    return f"differences would be seen from {', '.join(parts)} on" if parts else "constant"


def _finite(size: float) -> float | None:
    """None of a difference without any scatter, which has no size in standard errors."""
    return float(size) if np.isfinite(size) else None
