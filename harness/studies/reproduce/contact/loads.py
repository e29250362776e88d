"""The fitted law on the codes: cycles to several loads, fitted like measurements; pull-off and hysteresis over load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from harness.studies.laws.drive import Driven, Driver
from harness.studies.reproduce.contact.back import Indenter, drive
from harness.studies.reproduce.contact.fit import NAMES, LawFit, fit_cycle, law_force, pull_off_slope
from harness.studies.reproduce.protocol import Measured, RatePoint, Row
from harness.studies.reproduce.rows import Within, held_against
from harness.studies.verdict import Check, judged
from reference.values import Published

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.scene.contact import HystereticNormal

LOADS = (1 / 6, 1 / 3, 1 / 2, 2 / 3, 5 / 6, 1.0)
"""Largest overlaps over that of the measurement."""

FORCE_TOLERANCE = 1e-10
"""Force of a code along the cycle against the law, over its largest: overlaps of nanometres between spheres of
micrometres keep 1e-13 of themselves."""

BACK_TOLERANCE = 1e-6
"""Of a stiffness that is measured back."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Answer:
    """One cycle on one engine: `driven` says what became of it."""

    engine: str
    load: float
    indenter: Indenter
    driven: Driven

    @property
    def force(self) -> np.ndarray:
        """Force along the cycle (S,), N."""
        return self.indenter.cycle(self.driven).force

    @property
    def top(self) -> float:
        """Largest force, N."""
        return float(self.force.max())

    @property
    def hysteresis(self) -> float:
        """Displacement on the way back minus that on the way in where the force is zero, m, by lines between points."""
        cycle = self.indenter.cycle(self.driven)
        back = ~cycle.loading
        x, f = cycle.displacement[back], cycle.force[back]
        k = int(np.argmax(f <= 0))
        return float(x[k] + (x[k - 1] - x[k]) * f[k] / (f[k] - f[k - 1]))


def answers(
    law: HystereticNormal, indenter: Indenter, engines: Sequence[Engine], driver: Driver
) -> list[Answer]:
    """Drive every engine to every load; an engine that lacks the law says so once."""
    found = []
    for engine in engines:
        for load in LOADS:
            one = replace(indenter, largest=load * indenter.largest)
            driven = drive(law, one, engine, driver)
            found.append(Answer(engine=engine.name, load=load, indenter=one, driven=driven))
            if driven.reaction is None:
                break
    return found


def refused(answered: Sequence[Answer]) -> dict[str, str]:
    """Return why engines gave no answer, by name."""
    return {a.engine: a.driven.reason for a in answered if a.driven.status in ("unsupported", "unavailable")}


def completed(answered: Sequence[Answer]) -> dict[str, list[Answer]]:
    """Return the cycles that were driven, by engine, the smallest load first."""
    found: dict[str, list[Answer]] = {}
    for a in answered:
        if a.driven.reaction is not None:
            found.setdefault(a.engine, []).append(a)
    return found


def back_rows(answered: Sequence[Answer], fit: LawFit) -> list[Row]:
    """Return the stiffnesses fitted to each engine's deepest cycle, against those it was told."""
    rows = []
    for engine, of in completed(answered).items():
        values = fit_cycle(of[-1].indenter.cycle(of[-1].driven), draws=0).values
        rows += [_row(f"{name}, told and measured back", "N/m", engine, float(values[k]), float(fit.values[k]))
                 for k, name in enumerate(NAMES[:3])]
    return rows


def load_rows(answered: Sequence[Answer], fit: LawFit) -> list[Row]:
    """Return each engine's pull-off over load, by a line through its cycles, against the closed form."""
    told = pull_off_slope(*fit.values[:3])
    return [
        _row("pull-off over load", "1", engine, _slope(of), told) for engine, of in completed(answered).items()
    ]


def slope_rates(answered: Sequence[Answer]) -> list[RatePoint]:
    """Return pull-off over load at every load."""
    return [
        RatePoint(
            quantity="pull-off over load", unit="1", setting=f"load {1e9 * a.top:.3g} nN", number=a.load,
            ours=Measured(engine=engine, value=_pull(a) / a.top, error=None, packings=1),
        )
        for engine, of in completed(answered).items() for a in of
    ]


def law_checks(answered: Sequence[Answer], fit: LawFit, rerun) -> list[Check]:
    """Return that each engine's forces are those of the law, in every row of every cycle, and that each answered."""
    found = []
    for engine, of in completed(answered).items():
        worst = max(of, key=lambda a: _off(a, fit))
        found.append(judged(
            level="L0", quantity="force along the cycles", left=engine, right="closed form", deviation=_off(worst, fit),
            tolerance=FORCE_TOLERANCE, why=f"worst of {len(of)} loads: {1e9 * worst.top:.3g} nN", rerun=rerun(engine),
        ))
    broken = [a for a in answered if a.driven.status not in ("completed", "unsupported", "unavailable")]
    return found + [
        judged(level="run", quantity="cycle on the code", left=a.engine, right="its end", deviation=float("inf"),
               tolerance=0.0, why=f"{a.driven.status}: {a.driven.reason}", rerun=rerun(a.engine))
        for a in broken
    ]


def _off(answer: Answer, fit: LawFit) -> float:
    cycle = answer.indenter.cycle(answer.driven)
    law = law_force(cycle.displacement, cycle.loading, float(cycle.displacement.max()), *fit.values[:3], 0.0)
    return float(np.abs(cycle.force - law).max() / np.abs(law).max())


def _pull(answer: Answer) -> float:
    """Return the strongest attraction, N, where the lines of unloading and of adhesion meet between two rows."""
    cycle = answer.indenter.cycle(answer.driven)
    k_1, k_2, k_c, _ = fit_cycle(cycle, draws=0).values
    return float(k_c * (k_2 - k_1) / (k_2 + k_c) * cycle.displacement.max())


def _slope(of: Sequence[Answer]) -> float:
    return float(np.polyfit([a.top for a in of], [_pull(a) for a in of], 1)[0])


def _row(quantity: str, unit: str, engine: str, ours: float, told: float) -> Row:
    return held_against(
        Published(
            name="told", quantity=quantity, value=told, unit=unit, kind="analytical", origin="what the code was told",
            seen=True, conditions="prescribed motion", date="2026-11-22", tolerance=BACK_TOLERANCE,
            reason="a law without rate, in prescribed motion",
        ),
        Measured(engine=engine, value=ours, error=0.0, packings=1), Within(tolerance=BACK_TOLERANCE, relative=True),
    )
