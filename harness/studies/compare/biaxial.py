"""The biaxial box: curves and growth of every run, and what they allow to say."""

from __future__ import annotations

from dataclasses import dataclass, field

from harness.scene.derived import peak_inertial_number
from harness.scene.model import Biaxial
from harness.studies.compare.biaxial_checks import (
    macro_values,
    parting_checks,
    quasistatic_checks,
    window_checks,
)
from harness.studies.compare.curves import BiaxialCurves, biaxial_curves
from harness.studies.compare.growth import Growth, difference_growth
from harness.studies.compare.pairs import Pair, pairs_of
from harness.studies.compare.published import published_checks
from harness.studies.compare.states import StateCurves, state_curves
from harness.studies.verdict import Check


@dataclass(frozen=True, kw_only=True)
class BiaxialResult:
    """What the report draws. Keys are engine names; curves, growth and states are of the first packing.

    macro: (engine, packing) -> quantity -> value.
    """

    pairs: tuple[Pair, ...]
    curves: dict[str, BiaxialCurves]
    growth: dict[str, Growth]
    states: dict[str, StateCurves]
    macro: dict[tuple[str, int], dict[str, float]] = field(default_factory=dict)


def judge_biaxial(scene: Biaxial, starts, runs, engines: list[str], rerun: str) -> tuple[list[Check], BiaxialResult]:
    """Return all checks of a biaxial comparison and what the report needs."""
    finished = [r for r in runs if r.trajectory is not None]
    first = {r.engine: r.trajectory for r in finished if r.packing == 0}
    curves = {e: biaxial_curves(t, starts[0].system) for e, t in first.items()}
    pairs = pairs_of(engines)
    result = BiaxialResult(
        pairs=tuple(pairs),
        curves=curves,
        growth={_name(p): difference_growth(first[p.left], first[p.right]) for p in _both(pairs, first)},
        states={e: state_curves(t, starts[0].system) for e, t in first.items()},
        macro={
            (r.engine, r.packing): macro_values(biaxial_curves(r.trajectory, starts[r.packing].system), scene)
            for r in finished
        },
    )
    checks = [
        *window_checks(pairs, scene.compare.windows, curves, rerun),
        *parting_checks(pairs, curves),
        *quasistatic_checks(curves, peak_inertial_number(scene, starts[0].system), rerun),
        *published_checks(scene, result.macro),
    ]
    return checks, result


def _both(pairs: list[Pair], done: dict) -> list[Pair]:
    return [p for p in pairs if p.left in done and p.right in done]


def _name(pair: Pair) -> str:
    return f"{pair.left} - {pair.right}"
