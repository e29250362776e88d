"""What was measured: ladders of knobs, their limits, the scatter over packings, and which effects may go.

Read from the JSON of a finished `grainproof accuracy` (and `grainproof effects`), so that advice can be asked for as
often as one likes. What the files do not say is not there; nothing is filled in.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

from harness.errors import InputError
from harness.scene.describe import nearest
from harness.scene.model import Free, Scene
from harness.studies.accuracy.asked import KNOBS, WITHOUT
from harness.studies.advise.files import (
    ACCURACY,
    EFFECTS,
    BulkFile,
    FreeFile,
    FreePoint,
    LimitRow,
    MeasuredRow,
    damaged,
    read_accuracy,
    read_effects,
)

DECIDED = ("dt", "stiffness", "rate", "size")
"""Knobs that advice turns, in order; of those a scene has."""

TOLD = ("width",)
"""Knobs of the evaluation: their error is told, but the width belongs to what the quantity is."""

Origin = Literal["measured", "extrapolated"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rung:
    """One setting of one knob. error: signed where it has a sign, against the knob's limit; bar: its standard error;
    both over the quantity's scale. seconds: CPU time of one whole test. spread: scatter of one packing, over the scale.

    origin: whether this setting was run, or follows from others; how: then from which.
    """

    knob: str
    value: float
    x: float
    declared: bool
    error: float
    bar: float
    seconds: float
    spread: float | None = None
    origin: Origin = "measured"
    how: str = ""

    @property
    def seen(self) -> bool:
        """Whether the error stands out of its own."""
        return abs(self.error) > 2.0 * self.bar


@dataclasses.dataclass(frozen=True, kw_only=True)
class KnobLadder:
    """All good rungs of one knob on one engine, coarsest first. failed: why other rungs have no error.

    order: used for the limit. state: of the limit, see `harness.studies.accuracy.limit`. beyond: values, of rungs with
    and without an error, that are beyond the scene's stability limit `largest`, so that `scene` refuses them.
    """

    knob: str
    says: str
    rungs: tuple[Rung, ...]
    order: float
    state: str
    failed: tuple[str, ...] = ()
    beyond: tuple[float, ...] = ()
    largest: float | None = None

    @property
    def own(self) -> Rung | None:
        """The scene's own setting, None if the ladder does not have it."""
        return next((r for r in self.rungs if r.declared), None)

    @property
    def reference(self) -> Rung:
        """What times are told as multiples of: the scene's own setting, else the finest."""
        return self.own or self.rungs[-1]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Reduced:
    """The scene without effects that may go: what that changes, over the scale, and the part of time that is left."""

    names: tuple[str, ...]
    error: float
    bar: float
    share: Mapping[str, float]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Evidence:
    """Everything that advice rests on.

    ladders: by engine, then knob. spread: scatter of one packing at the scene's own setting, over the scale, by engine.
    engines: those that were asked for, None for all of the study. packings: of the study (phases, of free scenes).
    absent: knobs that were not measured, with the reason. reduced: None where effects were not measured or none may go;
    effects_say: what is known of them.
    """

    scene: Scene
    scene_file: Path
    quantity: str
    unit: str
    packings: int
    ladders: Mapping[str, Mapping[str, KnobLadder]]
    spread: Mapping[str, float | None]
    source: str
    engines: tuple[str, ...] | None = None
    absent: Mapping[str, str] = dataclasses.field(default_factory=dict)
    reduced: Reduced | None = None
    effects_say: str = "not measured: all stay as declared"

    @property
    def free(self) -> bool:
        """Whether bodies are followed, which have no scatter over packings."""
        return isinstance(self.scene, Free)


def read_evidence(
    scene: Scene, file: Path, *, quantity: str | None, folder: Path, effects: Path | None, tolerance: float,
    engines: Sequence[str] | None = None,
) -> Evidence:
    """Return what the studies in `folder` and `effects` say of a quantity, the studies' own unless named.

    engines: the only ones to be advised. Raises InputError for a folder without a finished study, one of another scene,
    or without the quantity or an engine.
    """
    place = folder / ACCURACY
    data = read_accuracy(folder, free=isinstance(scene, Free))
    _require_same_scene(scene, data.scene, place, "--from")
    wanted = _quantity(data, quantity, place)
    found = _free(scene, file, data, wanted, place) if isinstance(data, FreeFile) else _bulk(scene, file, data, wanted)
    found = _with(_of_engines(found, _engines(data), engines, place), source=str(folder))
    return found if effects is None else with_effects(found, effects, tolerance=tolerance)


def with_effects(evidence: Evidence, folder: Path, *, tolerance: float) -> Evidence:
    """Add what a finished effects study says; raises InputError if there is none, or it is of another scene."""
    place = folder / EFFECTS
    data = read_effects(folder)
    _require_same_scene(evidence.scene, data.scene, place, "--effects-from")
    if evidence.quantity not in data.quantities:
        return _with(evidence, effects_say=f"that study did not look at {evidence.quantity}: all stay as declared")
    if not data.left_out:
        return _with(evidence, effects_say=f"none may go within {100 * data.tolerance:g} % ({folder})")
    trials = [t for t in data.tables.trials if t.quantity == evidence.quantity]
    last = max(trials, key=lambda t: t.trial, default=None)
    if last is None or last.change is None:
        raise damaged(place, f"without a trial of {evidence.quantity} although effects are left out")
    names, share = tuple(data.left_out), {e: 1.0 - s for e, s in data.saved.items() if s is not None}
    error, bar = last.change / 100.0, (last.error or 0.0) / 100.0
    beyond = "" if abs(error) + bar <= tolerance else ", too much for this tolerance"
    return _with(
        evidence, reduced=Reduced(names=names, error=error, bar=bar, share=share),
        effects_say=f"{', '.join(names)} may go{beyond} ({folder})",
    )


def _engines(data: BulkFile | FreeFile) -> list[str]:
    if isinstance(data, FreeFile):
        return list(dict.fromkeys(p.engine for p in data.tables.points))
    return data.engines


def _of_engines(evidence: Evidence, known: Sequence[str], wanted: Sequence[str] | None, place: Path) -> Evidence:
    """Keep the ladders of the engines that are asked for."""
    if not wanted:
        return evidence
    lacking = next((e for e in wanted if e not in known), None)
    if lacking is not None:
        raise InputError(
            file="--engines", expected=f"some of {', '.join(known)}, which {place} has", got=lacking,
            fix=nearest(lacking, list(known)),
        )
    kept = {e: of for e, of in evidence.ladders.items() if e in wanted}
    return _with(evidence, ladders=kept, engines=tuple(wanted))


# --- boxes and rings ---------------------------------------------------------------------------------


def _bulk(scene: Scene, file: Path, data: BulkFile, quantity: str) -> Evidence:
    rows = [r for r in data.rows if r.quantity == quantity and r.scale]
    ladders: dict[str, dict[str, KnobLadder]] = {}
    for engine in data.engines:
        for knob in (k for k in (*DECIDED, *TOLD) if k in data.knobs):
            mine = [r for r in rows if (r.engine, r.knob) == (engine, knob)]
            ladder = _bulk_ladder(knob, mine)
            if ladder is not None:
                ladders.setdefault(engine, {})[knob] = ladder
    spread = {e: next((r.spread for r in rows if r.engine == e), None) for e in ladders}
    unit = next((r.unit for r in rows), "")
    return Evidence(
        scene=scene, scene_file=file, quantity=quantity, unit=unit, packings=data.packings, ladders=ladders,
        spread=spread, source="", absent=_absent(scene, data.knobs),
    )


def _bulk_ladder(knob: str, rows: Sequence[MeasuredRow | LimitRow]) -> KnobLadder | None:
    """Return the ladder, None where nothing of it has an error and a time."""
    measured = [r for r in rows if isinstance(r, MeasuredRow)]
    limit = next((r for r in rows if isinstance(r, LimitRow)), None)
    rungs = [_bulk_rung(r) for r in measured if _usable(r)]
    if not rungs or limit is None:
        return None
    beyond = [r for r in measured if r.beyond_limit is not None]
    return KnobLadder(
        knob=knob, says=rows[0].knob_value, rungs=tuple(sorted(rungs, key=lambda r: -r.x)),
        order=math.nan if limit.order_used is None else limit.order_used, state=limit.state,
        failed=tuple(f"{r.setting}: {r.status}" for r in measured if r.status != "completed"),
        beyond=tuple(sorted(r.value for r in beyond)), largest=next((r.beyond_limit for r in beyond), None),
    )


def _usable(row: MeasuredRow) -> bool:
    return row.signed_error is not None and row.error_bar is not None and row.cpu_seconds is not None


def _bulk_rung(row: MeasuredRow) -> Rung:
    return Rung(
        knob=row.knob, value=row.value, x=row.x, declared=row.declared, error=row.signed_error, bar=row.error_bar,
        seconds=row.cpu_seconds, spread=_spread(row),
    )


def _spread(row: MeasuredRow) -> float | None:
    """Return the scatter over packings at a setting, over the scale; None of what is no number."""
    each = [v for v in row.each or () if isinstance(v, int | float)]
    if len(each) < 2:
        return None
    mean = sum(each) / len(each)
    return math.sqrt(sum((v - mean) ** 2 for v in each) / (len(each) - 1)) / row.scale


# --- free scenes -------------------------------------------------------------------------------------


def _free(scene: Free, file: Path, data: FreeFile, quantity: str, place: Path) -> Evidence:
    """Errors are rms over phases of the step, against the limit of the engine's own laws; there is no scatter.

    Standard errors are that of the oracle and that of the rms, as so many phases tell it: s(e^2)/(2 rms sqrt(K)).
    """
    tables, case = data.tables, data.tables.points[0].case
    points = [p for p in tables.points if p.case == case]
    orders = {(s.engine, s.quantity): s.slope for s in tables.slopes if s.case == case}
    bars, ladders = _free_bars(data, case, quantity), {}
    for engine in dict.fromkeys(p.engine for p in points):
        ladder = _free_ladder(
            scene, [p for p in points if p.engine == engine], quantity, bars, orders.get((engine, quantity)), place
        )
        if ladder is not None:
            ladders[engine] = {"dt": ladder}
    return Evidence(
        scene=scene, scene_file=file, quantity=quantity, unit="1", packings=data.phases, ladders=ladders,
        spread=dict.fromkeys(ladders), source="", absent=_absent(scene, [data.knob]),
    )


def _free_ladder(
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
    rungs = [_free_rung(p, quantity, bars[p.engine, p.dt_fraction], own) for p in good]
    beyond = [p for p in points if p.beyond is not None]
    return KnobLadder(
        knob="dt", says="dt_fraction", rungs=tuple(sorted(rungs, key=lambda r: -r.x)), order=order or math.nan,
        state="extrapolated" if order else "flat",
        failed=tuple(f"{p.dt_fraction:.4g}: {p.status}" for p in points if p.status != "completed"),
        beyond=tuple(sorted(p.dt_fraction for p in beyond)), largest=next((p.beyond for p in beyond), None),
    )


def _free_bars(data: FreeFile, case: str, quantity: str) -> dict[tuple[str, float], float]:
    """Return standard errors by engine and dt_fraction."""
    oracle = {r.engine: r.error or 0.0 for r in data.tables.oracles if r.case == case}
    rows = [r for r in data.errors if r.case == case and getattr(r, quantity)]
    return {
        (r.engine, r.dt_fraction): math.hypot(oracle[r.engine], _of_rms(getattr(r, quantity)))
        for r in rows if r.engine in oracle
    }


def _of_rms(errors: Sequence[float]) -> float:
    """Return the standard error of sqrt(mean(e^2)), infinite of a single one."""
    squares = [e * e for e in errors]
    count, mean = len(squares), sum(squares) / len(squares)
    if count < 2:
        return math.inf
    if mean == 0.0:
        return 0.0
    variance = sum((s - mean) ** 2 for s in squares) / (count - 1)
    return math.sqrt(variance / count) / (2.0 * math.sqrt(mean))


def _free_rung(point: FreePoint, quantity: str, bar: float, own: float) -> Rung:
    value = point.dt_fraction
    return Rung(
        knob="dt", value=value, x=value, declared=abs(point.rung / own - 1.0) < 1e-9, error=getattr(point, quantity),
        bar=bar, seconds=1e-3 * point.milliseconds,
    )


# --- files -------------------------------------------------------------------------------------------


def _absent(scene: Scene, measured: Sequence[str]) -> dict[str, str]:
    kind, found = type(scene), {}
    for knob in DECIDED:
        if knob in measured:
            continue
        lacking = WITHOUT.get((kind, knob))
        found[knob] = f"the scene has none: {lacking}" if knob not in KNOBS[kind] and lacking else (
            "not measured: it stays as declared, and its error is in no sum"
        )
    return found


def _quantity(data: BulkFile | FreeFile, name: str | None, place: Path) -> str:
    known = _free_quantities(data) if isinstance(data, FreeFile) else list(data.quantities)
    wanted = name or data.quantity
    if wanted not in known:
        raise InputError(
            file="--quantity", expected=f"one of {', '.join(known)}, which {place} has", got=wanted,
            fix=nearest(wanted, known),
        )
    return wanted


def _free_quantities(data: FreeFile) -> list[str]:
    return [q for q in ("exit", "velocity", "spin") if any(getattr(p, q) is not None for p in data.tables.points)]


def _require_same_scene(scene: Scene, theirs: Scene, place: Path, option: str) -> None:
    """Titles do not matter, and not what only `compare` judges by; what the study's version did not know is absent."""
    names = {"kind", *type(scene).__struct_fields__} - {"title", "compare"}
    kind = {"kind"} if type(theirs) is not type(scene) else set()
    other = kind or {n for n in names - {"kind"} if getattr(scene, n) != getattr(theirs, n)}
    if other:
        raise InputError(
            file=option, expected="a study of this scene", got=f"{place}, {_other(other)}",
            fix="run it again for this scene",
        )


def _other(names: set[str]) -> str:
    return f"whose {', '.join(sorted(names))} differ{'s' if len(names) == 1 else ''}"


def _with(evidence: Evidence, **changes) -> Evidence:
    return dataclasses.replace(evidence, **changes)
