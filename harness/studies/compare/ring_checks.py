"""What the averages of every single run of a ring must obey, whatever the other codes say (level "run").

Steady: the torque is the same in both halves of the time, and a drift of the declared margin would have been seen; else
nothing shows that the state is steady, and averages are averages. Torque: what the inner ring gives arrives at the
outer one but for the drag of the bottom, and 2 pi r^2 sigma_rphi is that torque through every circle in between.
Momentum: what contacts, drag and the mean motion leave over in every ring averages to nothing. Each is judged by its
own error bars, all its rings and packings together at a rate of false alarms that it shares with all other tests of the
report (`harness.studies.compare.alarms`). A check whose error bars exceed `BLIND` of the torque, or of the pressure,
says nothing and is inconclusive.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from harness.scene.judged import FALSE_ALARMS, RING_MARGIN
from harness.studies.compare.alarms import judged_together, smallest_p
from harness.studies.compare.ring_balances import RingBalances
from harness.studies.compare.significance import Difference, of_mean
from harness.studies.verdict import Check, Rerun, not_checked

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


TORQUE = "of the inner ring's torque"

STEADY, LAWS = "steady: torque of second = first half", "balance of averages"
"""Quantity of the first check, and what the others hold averages against."""


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """What a run is off. difference: from 0; size: what it is measured by; needed: frames; where: a cell, in words."""

    difference: Difference
    size: float
    needed: float
    where: str = ""

    @cached_property
    def resolved(self) -> Difference:
        """The difference with errors that rounding accounts for, at least."""
        return self.difference.resolved(self.size)


@dataclass(frozen=True, kw_only=True)
class RunTest:
    """One balance of an engine's runs. by: what sizes are parts of; r: of the cells, m; absent: why there is none."""

    quantity: str
    engine: str
    against: str
    rerun: str
    deviations: tuple[Deviation, ...] = ()
    by: str = ""
    r: np.ndarray | None = None
    blind: float = BLIND
    absent: str = "no ring has discs on both sides"

    @cached_property
    def cells(self) -> int:
        """Number of cells, of all runs."""
        return sum(int(d.resolved.used.sum()) for d in self.deviations)

    @property
    def p(self) -> float | None:
        """The p-value of "balanced in every cell", of those whose errors are to be trusted; None without a cell."""
        off = (d.resolved.p_values()[d.resolved.trusted] for d in self.deviations)
        return smallest_p(off, self.cells) if self.cells else None

    def check(self, level: float) -> Check:
        """Return the verdict of a test at this level."""
        facts = {"level": "run", "quantity": self.quantity, "left": self.engine, "right": self.against}
        if not self.cells:
            return not_checked(**facts, why=self.absent)
        return _judged(self, level / self.cells, facts)


def ring_checks(
    balances: All, rerun: Rerun, margin: float = RING_MARGIN, false_alarms: float = FALSE_ALARMS
) -> list[Check]:
    """Judge balances that share their rate of false alarms with nothing else."""
    return judged_together(run_tests(balances, rerun, margin), false_alarms)


def run_tests(balances: All, rerun: Rerun, margin: float) -> list[RunTest]:
    """Return torque and momentum tests of every engine. margin: a drift that would have to be seen."""
    runs = {e: list(of.values()) for e, of in balances.items()}
    steady = [steady_test(e, of, rerun(e), margin) for e, of in runs.items()]
    return steady + [
        test(e, of, rerun(e)) for test in (torque_test, through_test, radial_test, angular_test)
        for e, of in runs.items()
    ]


def steady_test(engine: str, runs: Sequence[RingBalances], rerun: str, margin: float) -> RunTest:
    """The torque is the same in both halves of the time that averages are taken over."""
    off = tuple(Deviation(difference=of_mean(b.drift), size=_torque(b), needed=b.drift.needed) for b in runs)
    return RunTest(
        quantity=STEADY, engine=engine, against="first half", rerun=rerun, deviations=off, by=TORQUE, blind=margin
    )


def torque_test(engine: str, runs: Sequence[RingBalances], rerun: str) -> RunTest:
    """Torques on both rings and of the drag cancel."""
    drag = " + drag" if runs[0].drag is not None else ""
    off = tuple(Deviation(difference=of_mean(b.total), size=_torque(b), needed=b.total.needed) for b in runs)
    name = f"torque on inner + outer ring{drag} = 0"
    return RunTest(quantity=name, engine=engine, against=LAWS, rerun=rerun, deviations=off, by=TORQUE)


def through_test(engine: str, runs: Sequence[RingBalances], rerun: str) -> RunTest:
    """Torque through every circle is that of both walls."""
    facts = {"quantity": THROUGH, "engine": engine, "against": "torque on both rings", "rerun": rerun}
    if runs[0].absent:
        return RunTest(**facts, absent=runs[0].absent)
    off = tuple(
        Deviation(
            difference=of_mean(p), size=_torque(b), needed=p.needed,
            where=f"against the {name} ring at r = {{:.4g}} mm",
        )
        for b in runs for name, p in (("inner", b.from_inner), ("outer", b.from_outer))
    )
    return RunTest(**facts, deviations=off, by=TORQUE, r=runs[0].r)


def radial_test(engine: str, runs: Sequence[RingBalances], rerun: str) -> RunTest:
    """Nothing is left over of radial momentum."""
    return _momentum(engine, runs, 0, rerun)


def angular_test(engine: str, runs: Sequence[RingBalances], rerun: str) -> RunTest:
    """Nothing is left over of momentum along phi."""
    return _momentum(engine, runs, 1, rerun)


def _momentum(engine: str, runs: Sequence[RingBalances], axis: int, rerun: str) -> RunTest:
    facts = {
        "quantity": f"{EQUILIBRIUM}, {('r', 'phi')[axis]}", "engine": engine, "against": LAWS, "rerun": rerun,
    }
    if runs[0].absent:
        return RunTest(**facts, absent=runs[0].absent)
    off = tuple(
        Deviation(
            difference=of_mean(b.momentum[axis]), size=b.pressure, needed=b.momentum[axis].needed,
            where="at r = {:.4g} mm",
        ) for b in runs
    )
    return RunTest(**facts, deviations=off, by="of the pressure", r=runs[0].r)


def _torque(balances: RingBalances) -> float:
    return abs(float(balances.inner.mean[0]))


def _judged(test: RunTest, level: float, facts: dict) -> Check:
    """Judge every cell at this level, by the one furthest out of its error bars, in units of a size."""
    worst, cell = _furthest(test.deviations, level)
    d, limit = worst.resolved, worst.resolved.limit(level)
    deviation = abs(float(d.value[cell])) / worst.size if worst.size else np.inf
    tolerance = float((limit * d.error)[cell]) / worst.size if worst.size else np.inf
    facts |= {"deviation": deviation, "tolerance": tolerance}
    place = "" if test.r is None else f"largest of {test.cells}, {worst.where.format(1e3 * test.r[cell])}; "
    why = f"{place}parts {test.by}, tolerance from the error bars, at the report's rate of false alarms"
    short, within = bool(d.short[cell]), deviation <= tolerance
    if short and (not within or LOWER_BOUND * tolerance > test.blind):
        needed = f"needs {worst.needed:.0f} frames or samples"
        return Check(**facts, verdict="inconclusive", why=f"{why}; too short: {needed}")
    if not within:
        return Check(**facts, verdict="differs", why=f"{why}; rerun: {test.rerun}")
    if tolerance > test.blind:
        return Check(**facts, verdict="inconclusive", why=f"{why}: above {test.blind:g}, which shows nothing")
    return Check(**facts, verdict="agrees", why=why)


def _furthest(deviations: Sequence[Deviation], level: float) -> tuple[Deviation, int]:
    """Return the run and cell furthest out; of those whose errors are to be trusted, if one of them is beyond."""
    sizes = [np.where(d.resolved.used, d.resolved.sizes / d.resolved.limit(level), -np.inf) for d in deviations]
    trusted = [np.where(d.resolved.short, -np.inf, s) for d, s in zip(deviations, sizes, strict=True)]
    chosen = trusted if max(s.max() for s in trusted) > 1.0 else sizes
    k = int(np.argmax([s.max() for s in chosen]))
    return deviations[k], int(np.argmax(chosen[k]))
