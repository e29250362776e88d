"""Ladders of a finished `grainproof accuracy` of a free scene: the step alone is turned, over phases of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.scene.model import Free
from harness.studies.advise.evidence import Evidence, KnobLadder, Rung, absent_knobs
from harness.studies.advise.files import FreeFile, FreePoint, damaged


def free_evidence(scene: Free, file: Path, data: FreeFile, quantity: str, place: Path) -> Evidence:
    """Errors are rms over phases of the step, against the limit of the engine's own laws; there is no scatter.

    Standard errors are that of the oracle and that of the rms, as so many phases tell it: s(e^2)/(2 rms sqrt(K)).
    """
    tables, case = data.tables, data.tables.points[0].case
    points = [p for p in tables.points if p.case == case]
    orders = {(s.engine, s.quantity): s.slope for s in tables.slopes if s.case == case}
    bars, ladders = _bars(data, case, quantity), {}
    for engine in dict.fromkeys(p.engine for p in points):
        ladder = _ladder(
            scene, [p for p in points if p.engine == engine], quantity, bars, orders.get((engine, quantity)), place
        )
        if ladder is not None:
            ladders[engine] = {"dt": ladder}
    return Evidence(
        scene=scene, scene_file=file, quantity=quantity, unit="1", packings=data.phases, ladders=ladders,
        spread=dict.fromkeys(ladders), source="", absent=absent_knobs(scene, [data.knob]),
    )


def _ladder(
    scene: Free, points: Sequence[FreePoint], quantity: str, bars: Mapping[tuple[str, float], float],
    order: float | None, place: Path,
) -> KnobLadder | None:
    good = [p for p in points if getattr(p, quantity) is not None and p.milliseconds is not None]
    if not good:
        return None
    lacking = next((p for p in good if (p.engine, p.dt_fraction) not in bars), None)
    if lacking is not None:
        raise damaged(place, f"without errors by phase of {lacking.engine} at {lacking.dt_fraction:g}")
    own = scene.numerics.dt_fraction
    rungs = [_rung(p, quantity, bars[p.engine, p.dt_fraction], own) for p in good]
    beyond = [p for p in points if p.beyond is not None]
    return KnobLadder(
        knob="dt", says="dt_fraction", rungs=tuple(sorted(rungs, key=lambda r: -r.x)), order=order or math.nan,
        state="extrapolated" if order else "flat",
        failed=tuple(f"{p.dt_fraction:.4g}: {p.status}" for p in points if p.status != "completed"),
        beyond=tuple(sorted(p.dt_fraction for p in beyond)), largest=next((p.beyond for p in beyond), None),
    )


def _bars(data: FreeFile, case: str, quantity: str) -> dict[tuple[str, float], float]:
    """Return standard errors by engine and dt_fraction."""
    oracle = {r.engine: r.error or 0.0 for r in data.tables.oracles if r.case == case}
    rows = [r for r in data.errors if r.case == case and getattr(r, quantity)]
    return {
        (r.engine, r.dt_fraction): math.hypot(oracle[r.engine], rms_error(getattr(r, quantity)))
        for r in rows if r.engine in oracle
    }


def rms_error(errors: Sequence[float]) -> float:
    """Return the standard error of sqrt(mean(e^2)), infinite of a single one."""
    squares = [e * e for e in errors]
    count, mean = len(squares), sum(squares) / len(squares)
    if count < 2:
        return math.inf
    if mean == 0.0:
        return 0.0
    variance = sum((s - mean) ** 2 for s in squares) / (count - 1)
    return math.sqrt(variance / count) / (2.0 * math.sqrt(mean))


def _rung(point: FreePoint, quantity: str, bar: float, own: float) -> Rung:
    value = point.dt_fraction
    return Rung(
        knob="dt", value=value, x=value, declared=abs(point.rung / own - 1.0) < 1e-9, error=getattr(point, quantity),
        bar=bar, seconds=1e-3 * point.milliseconds,
    )
