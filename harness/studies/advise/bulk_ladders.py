"""Ladders of a finished `grainproof accuracy` of a box or a ring."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from harness.scene.model import Scene
from harness.studies.advise.evidence import DECIDED, TOLD, Evidence, KnobLadder, Rung, absent_knobs
from harness.studies.advise.files import BulkFile, LimitRow, MeasuredRow


def bulk_evidence(scene: Scene, file: Path, data: BulkFile, quantity: str) -> Evidence:
    """Return what a study of a box or a ring says of a quantity; its source is left to the caller."""
    rows = [r for r in data.rows if r.quantity == quantity and r.scale]
    ladders: dict[str, dict[str, KnobLadder]] = {}
    for engine in data.engines:
        for knob in (k for k in (*DECIDED, *TOLD) if k in data.knobs):
            mine = [r for r in rows if (r.engine, r.knob) == (engine, knob)]
            ladder = _ladder(knob, mine)
            if ladder is not None:
                ladders.setdefault(engine, {})[knob] = ladder
    spread = {e: next((r.spread for r in rows if r.engine == e), None) for e in ladders}
    unit = next((r.unit for r in rows), "")
    return Evidence(
        scene=scene, scene_file=file, quantity=quantity, unit=unit, packings=data.packings, ladders=ladders,
        spread=spread, source="", absent=absent_knobs(scene, data.knobs),
    )


def _ladder(knob: str, rows: Sequence[MeasuredRow | LimitRow]) -> KnobLadder | None:
    """Return the ladder, None where nothing of it has an error and a time."""
    measured = [r for r in rows if isinstance(r, MeasuredRow)]
    limit = next((r for r in rows if isinstance(r, LimitRow)), None)
    rungs = [_rung(r) for r in measured if _usable(r)]
    if not rungs or limit is None:
        return None
    beyond = [r for r in measured if r.beyond_limit is not None]
    return KnobLadder(
        knob=knob, says=rows[0].knob_value, rungs=tuple(sorted(rungs, key=lambda r: -r.x)),
        order=math.nan if limit.order_used is None else limit.order_used, state=limit.state, scale=limit.scale,
        failed=tuple(f"{r.setting}: {r.status}" for r in measured if r.status != "completed"),
        beyond=tuple(sorted(r.value for r in beyond)), largest=next((r.beyond_limit for r in beyond), None),
    )


def _usable(row: MeasuredRow) -> bool:
    return row.signed_error is not None and row.error_bar is not None and row.cpu_seconds is not None


def _rung(row: MeasuredRow) -> Rung:
    return Rung(
        knob=row.knob, value=row.value, x=row.x, declared=row.declared, error=row.signed_error, bar=row.error_bar,
        seconds=row.cpu_seconds, spread=_spread(row), each=_each(row),
    )


def _each(row: MeasuredRow) -> tuple[float, ...]:
    """Return values by packing, NaN where a packing has none; nothing of curves."""
    told = row.each or ()
    if any(isinstance(v, list) for v in told):
        return ()
    return tuple(float(v) if isinstance(v, int | float) else math.nan for v in told)


def _spread(row: MeasuredRow) -> float | None:
    """Return the scatter over packings at a setting, over the scale; None of what is no number."""
    each = [v for v in row.each or () if isinstance(v, int | float)]
    if len(each) < 2:
        return None
    mean = sum(each) / len(each)
    return math.sqrt(sum((v - mean) ** 2 for v in each) / (len(each) - 1)) / row.scale
