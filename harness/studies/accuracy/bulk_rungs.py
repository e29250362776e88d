"""Rungs of a bulk ladder: what came of the runs of a setting, and whether the finest rung bears it out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from harness.runs.phases import cpu_parts
from harness.runs.pool import Done
from harness.studies.accuracy.bulk_plan import Setting
from harness.studies.accuracy.bulk_result import Rung
from harness.studies.accuracy.shaken import Shaking, why_shaken

OWN_WIDTH = 0.0
"""Key of the scene's own averaging width."""


class Key(NamedTuple):
    """A run: by engine and system."""

    engine: str
    system: str


@dataclass(frozen=True, kw_only=True)
class Measured:
    """Quantities of a run by averaging width (its key), and how it is shaken."""

    values: Mapping[float, Mapping[str, np.ndarray]]
    shaking: Shaking


def rungs_of(
    settings: Sequence[Setting], engine: str, done: Mapping[Key, Done], measured: Mapping[Key, Measured]
) -> tuple[Rung, ...]:
    """Return the rungs of one ladder, those that are shaken as unstable."""
    made = [rung_of(s, engine, done, measured) for s in settings]
    finest = min((k for k, r in enumerate(made) if r.good), key=lambda k: made[k].x, default=None)
    if finest is None:
        return tuple(made)
    shaking = [
        [measured[Key(engine, y.digest())].shaking for y in s.systems] if r.good else []
        for s, r in zip(settings, made, strict=True)
    ]
    return tuple(
        _believed(r, here, made[finest], shaking[finest]) for r, here in zip(made, shaking, strict=True)
    )


def _believed(rung: Rung, here: Sequence[Shaking], finest: Rung, there: Sequence[Shaking]) -> Rung:
    """Return the rung; without values and times if its sample is shaken."""
    if not rung.good or rung is finest:
        return rung
    return settled(rung, why_shaken({rung.knob: rung.x / finest.x if finest.x else 1.0}, here, there))


def settled(rung: Rung, why: str) -> Rung:
    """Return the rung; as an unstable one, without values and times, if its sample is shaken and `why` says so."""
    if not why:
        return rung
    return replace(
        rung, status="unstable", reason=why, values={}, seconds=None, each=(), setup=None, output=None
    )


def rung_of(setting: Setting, engine: str, done: Mapping[Key, Done], measured: Mapping[Key, Measured]) -> Rung:
    """Return what came of a setting's runs on an engine."""
    facts = {
        "knob": setting.knob, "value": setting.value, "x": setting.x, "label": setting.label, "own": setting.own,
        "beyond": setting.beyond,
    }
    if not setting.systems:
        return Rung(**facts, status="refused", reason=setting.reason, particles=0, dt=np.nan, steps=0, values={},
                    seconds=None)
    keys = [Key(engine, s.digest()) for s in setting.systems]
    first = setting.systems[0]
    facts |= {"particles": len(first.particles), "dt": first.dt, "steps": first.steps}
    outcomes = [done[k].outcome for k in keys]
    failed = [o for o in outcomes if o.status != "completed"]
    if failed:
        of = f"{len(failed)} of {len(outcomes)} packings: " if len(failed) < len(outcomes) else ""
        return Rung(**facts, status=failed[0].status, reason=of + failed[0].reason, values={}, seconds=None)
    width = OWN_WIDTH if setting.width is None else setting.width
    parts = [cpu_parts(o) for o in outcomes]
    return Rung(
        **facts, status="completed", reason="", values=_together([measured[k].values[width] for k in keys]),
        each=tuple(p["run"] for p in parts), seconds=_median(parts, "run"), setup=_median(parts, "setup"),
        output=_median(parts, "output"),
    )


def _median(parts: Sequence[Mapping[str, float]], name: str) -> float | None:
    told = [p[name] for p in parts if name in p]
    return float(np.median(told)) if told else None


def _together(found: Sequence[Mapping[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Return (K, S) by quantity; packings without one have NaN, quantities without two packings are left out."""
    names = list(dict.fromkeys(n for of in found for n in of))
    made = {}
    for name in names:
        size = next(len(of[name]) for of in found if name in of)
        made[name] = np.array([of.get(name, np.full(size, np.nan)) for of in found])
    return {n: v for n, v in made.items() if np.isfinite(v).all(axis=1).sum() >= 2}
