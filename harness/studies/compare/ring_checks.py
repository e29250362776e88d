"""What the averages of every single run of a ring must obey, whatever the other codes say (level "run").

Steady: the torque is the same in both halves of the time, and a drift of the declared margin would have been seen; else
nothing shows that the state is steady, and averages are averages. Torque: what the inner ring gives arrives at the
outer one but for the drag of the bottom, and 2 pi r^2 sigma_rphi is that torque through every circle in between.
Momentum: what contacts, drag and the mean motion leave over in every ring averages to nothing. Each is judged by its
own error bars, so a check whose error bars exceed `BLIND` of the torque, or of the pressure, says nothing and is
inconclusive.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from harness.scene.judged import RING_MARGIN
from harness.studies.compare.ring_balances import RingBalances
from harness.studies.compare.significance import Difference, of_mean
from harness.studies.verdict import Check, Rerun, not_checked

RUN_ALARM = 1e-3
"""Probability of a false alarm of one of these checks, all its rings and packings together."""

BLIND = 0.1
"""Of the torque or the pressure: error bars above a tenth of what they belong to show no balance."""

THROUGH, EQUILIBRIUM = "2 pi r^2 sigma_rphi through circles", "equilibrium of every ring"
FROM_CONTACTS = (THROUGH, EQUILIBRIUM)
"""How the quantities begin that rest on recorded contact forces."""

LOWER_BOUND = 3.0
"""The error bar of a run that is too short is a lower bound. What lies within it agrees all the more, as long as three
times as much would still show something."""

All = Mapping[str, Mapping[int, RingBalances]]
"""Balances by engine and packing."""


STEADY, LAWS = "steady: torque of second = first half", "balance of averages"
"""Quantity of the first check, and what the others hold averages against."""


def ring_checks(balances: All, rerun: Rerun, margin: float = RING_MARGIN) -> list[Check]:
    """Return torque and momentum checks of every engine. margin: a drift that would have to be seen."""
    steady = [steady_check(e, list(of.values()), rerun(e), margin) for e, of in balances.items()]
    return steady + [
        check(engine, list(of.values()), rerun(engine)) for check in (
            torque_check, through_check, radial_check, angular_check
        ) for engine, of in balances.items()
    ]


def steady_check(engine: str, runs: Sequence[RingBalances], rerun: str, margin: float = RING_MARGIN) -> Check:
    """The torque is the same in both halves of the time that averages are taken over."""
    tested = [(of_mean(b.drift), _torque(b), b.drift.needed, "") for b in runs]
    facts = {"quantity": STEADY, "left": engine, "right": "first half"}
    return _judged(tested, facts, "of the inner ring's torque", rerun, blind=margin)


def torque_check(engine: str, runs: Sequence[RingBalances], rerun: str) -> Check:
    """Torques on both rings and of the drag cancel."""
    drag = " + drag" if runs[0].drag is not None else ""
    tested = [(of_mean(b.total), _torque(b), b.total.needed, "") for b in runs]
    facts = {"quantity": f"torque on inner + outer ring{drag} = 0", "left": engine, "right": LAWS}
    return _judged(tested, facts, "of the inner ring's torque", rerun)


def through_check(engine: str, runs: Sequence[RingBalances], rerun: str) -> Check:
    """Torque through every circle is that of both walls."""
    facts = {"quantity": THROUGH, "left": engine, "right": "torque on both rings"}
    if runs[0].absent:
        return _nothing(facts, runs[0].absent)
    tested = [
        (of_mean(p), _torque(b), p.needed, f"against the {name} ring at r = {{:.4g}} mm")
        for b in runs for name, p in (("inner", b.from_inner), ("outer", b.from_outer))
    ]
    return _judged(tested, facts, "of the inner ring's torque", rerun, runs[0].r)


def radial_check(engine: str, runs: Sequence[RingBalances], rerun: str) -> Check:
    """Nothing is left over of radial momentum."""
    return _momentum(engine, runs, 0, rerun)


def angular_check(engine: str, runs: Sequence[RingBalances], rerun: str) -> Check:
    """Nothing is left over of momentum along phi."""
    return _momentum(engine, runs, 1, rerun)


def _momentum(engine: str, runs: Sequence[RingBalances], axis: int, rerun: str) -> Check:
    facts = {"quantity": f"{EQUILIBRIUM}, {('r', 'phi')[axis]}", "left": engine, "right": LAWS}
    if runs[0].absent:
        return _nothing(facts, runs[0].absent)
    tested = [(of_mean(b.momentum[axis]), b.pressure, b.momentum[axis].needed, "at r = {:.4g} mm") for b in runs]
    return _judged(tested, facts, "of the pressure", rerun, runs[0].r)


def _torque(balances: RingBalances) -> float:
    return abs(float(balances.inner.mean[0]))


def _nothing(facts: dict, why: str) -> Check:
    return not_checked(level="run", **facts, why=why)


Tested = tuple[Difference, float, float, str]
"""Difference from 0, what it is measured by, frames needed, and where a cell is, in words."""


def _judged(
    tested: Sequence[Tested], facts: dict, by: str, rerun: str, r: np.ndarray | None = None, blind: float = BLIND
) -> Check:
    """Judge by the cell furthest out of its error bars, in units of a size."""
    facts = {"level": "run", **facts}
    tested = [(d.resolved(size), size, *rest) for d, size, *rest in tested]
    number = sum(int(d.used.sum()) for d, *_ in tested)
    if not number:
        return not_checked(**facts, why="no ring has discs on both sides")
    limits = [d.limit(RUN_ALARM / number) for d, *_ in tested]
    excess = [np.where(d.used, d.sizes / limit, -np.inf) for (d, *_), limit in zip(tested, limits, strict=True)]
    k = int(np.argmax([np.max(e) for e in excess]))
    (difference, size, needed, where), cell = tested[k], int(np.argmax(excess[k]))
    deviation = abs(float(difference.value[cell])) / size if size else np.inf
    tolerance = float((limits[k] * difference.error)[cell]) / size if size else np.inf
    facts |= {"deviation": deviation, "tolerance": tolerance}
    place = f"largest of {number}, {where.format(1e3 * r[cell])}; " if r is not None else ""
    why = f"{place}parts {by}, tolerance from the error bars ({RUN_ALARM:g} false alarms)"
    short, within = bool(difference.short[cell]), deviation <= tolerance
    if short and (not within or LOWER_BOUND * tolerance > blind):
        return Check(**facts, verdict="inconclusive", why=f"{why}; too short: needs {needed:.0f} frames or samples")
    if not within:
        return Check(**facts, verdict="differs", why=f"{why}; rerun: {rerun}")
    if tolerance > blind:
        return Check(**facts, verdict="inconclusive", why=f"{why}: above {blind:g}, which shows nothing")
    return Check(**facts, verdict="agrees", why=why)


