"""What was measured: ladders of knobs, their limits, the scatter over packings, and which effects may go.

Read from the JSON of a finished `grainproof accuracy` (and `grainproof effects`), so that advice can be asked for as
often as one likes. What the files do not say is not there; nothing is filled in.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

import msgspec

from harness.errors import InputError
from harness.scene.describe import nearest
from harness.scene.model import Free, Scene
from harness.studies.accuracy.asked import KNOBS, WITHOUT

ACCURACY, EFFECTS = "accuracy.json", "effects.json"
BULK_SCHEMA = "grainproof accuracy of bulk quantities, 1"

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

    order: used for the limit. state: of the limit, see `harness.studies.accuracy.limit`.
    """

    knob: str
    says: str
    rungs: tuple[Rung, ...]
    order: float
    state: str
    failed: tuple[str, ...] = ()

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
    packings: of the study (phases, of free scenes). absent: knobs that were not measured, with the reason. reduced:
    None where effects were not measured or none may go; effects_say: what is known of them.
    """

    scene: Scene
    scene_file: Path
    quantity: str
    unit: str
    packings: int
    ladders: Mapping[str, Mapping[str, KnobLadder]]
    spread: Mapping[str, float | None]
    source: str
    absent: Mapping[str, str] = dataclasses.field(default_factory=dict)
    reduced: Reduced | None = None
    effects_say: str = "not measured: all stay as declared"

    @property
    def free(self) -> bool:
        """Whether bodies are followed, which have no scatter over packings."""
        return isinstance(self.scene, Free)


def read_evidence(
    scene: Scene, file: Path, *, quantity: str | None, folder: Path, effects: Path | None, tolerance: float
) -> Evidence:
    """Return what the studies in `folder` and `effects` say of a quantity, the studies' own unless named.

    Raises InputError for a folder without a finished study, one of another scene, or without the quantity.
    """
    data = _read(folder / ACCURACY, "a finished grainproof accuracy", "--from")
    _require_same_scene(scene, data, folder / ACCURACY, "--from")
    wanted = _quantity(data, quantity, folder / ACCURACY)
    found = _free(scene, file, data, wanted) if isinstance(scene, Free) else _bulk(scene, file, data, wanted)
    found = _with(found, source=str(folder))
    return found if effects is None else with_effects(found, effects, tolerance=tolerance)


def with_effects(evidence: Evidence, folder: Path, *, tolerance: float) -> Evidence:
    """Add what a finished effects study says; raises InputError if there is none, or it is of another scene."""
    place = folder / EFFECTS
    data = _read(place, "a finished grainproof effects", "--effects-from")
    _require_same_scene(evidence.scene, data, place, "--effects-from")
    if evidence.quantity not in data["quantities"]:
        return _with(evidence, effects_say=f"that study did not look at {evidence.quantity}: all stay as declared")
    if not data["left_out"]:
        return _with(evidence, effects_say=f"none may go within {100 * data['tolerance']:g} % ({folder})")
    last = max(row["trial"] for row in data["tables"]["trials"])
    row = next(r for r in data["tables"]["trials"] if r["trial"] == last and r["quantity"] == evidence.quantity)
    names, share = tuple(data["left_out"]), {engine: 1.0 - s for engine, s in data["saved"].items()}
    error, bar = row["change (%)"] / 100.0, (row["standard error (%)"] or 0.0) / 100.0
    beyond = "" if abs(error) + bar <= tolerance else ", too much for this tolerance"
    return _with(
        evidence, reduced=Reduced(names=names, error=error, bar=bar, share=share),
        effects_say=f"{', '.join(names)} may go{beyond} ({folder})",
    )


# --- boxes and rings ---------------------------------------------------------------------------------


def _bulk(scene: Scene, file: Path, data: Mapping, quantity: str) -> Evidence:
    rows = [r for r in data["rows"] if r["quantity"] == quantity and r["scale"]]
    ladders: dict[str, dict[str, KnobLadder]] = {}
    for engine in data["engines"]:
        for knob in (k for k in (*DECIDED, *TOLD) if k in data["knobs"]):
            mine = [r for r in rows if (r["engine"], r["knob"]) == (engine, knob)]
            ladder = _bulk_ladder(knob, mine)
            if ladder is not None:
                ladders.setdefault(engine, {})[knob] = ladder
    spread = {e: next((r["spread"] for r in rows if r["engine"] == e), None) for e in ladders}
    unit = next((r["unit"] for r in rows), "")
    return Evidence(
        scene=scene, scene_file=file, quantity=quantity, unit=unit, packings=data["packings"], ladders=ladders,
        spread=spread, source="", absent=_absent(scene, data["knobs"]),
    )


def _bulk_ladder(knob: str, rows: Sequence[Mapping]) -> KnobLadder | None:
    """Return the ladder, None where nothing of it has an error and a time."""
    measured = [r for r in rows if r["kind"] == "measured"]
    limit = next((r for r in rows if r["kind"] == "extrapolated"), None)
    rungs = [_bulk_rung(r) for r in measured if _usable(r)]
    if not rungs or limit is None:
        return None
    return KnobLadder(
        knob=knob, says=rows[0]["knob_value"], rungs=tuple(sorted(rungs, key=lambda r: -r.x)),
        order=limit["order_used"], state=limit["state"],
        failed=tuple(f"{r['setting']}: {r['status']}" for r in measured if r["status"] != "completed"),
    )


def _usable(row: Mapping) -> bool:
    return all(row.get(name) is not None for name in ("signed_error", "error_bar", "cpu_seconds"))


def _bulk_rung(row: Mapping) -> Rung:
    return Rung(
        knob=row["knob"], value=row["value"], x=row["x"], declared=bool(row["declared"]), error=row["signed_error"],
        bar=row["error_bar"], seconds=row["cpu_seconds"], spread=_spread(row),
    )


def _spread(row: Mapping) -> float | None:
    """Return the scatter over packings at a setting, over the scale; None of what is no number."""
    each = [v for v in row.get("each") or () if isinstance(v, int | float)]
    if len(each) < 2:
        return None
    mean = sum(each) / len(each)
    return math.sqrt(sum((v - mean) ** 2 for v in each) / (len(each) - 1)) / row["scale"]


# --- free scenes -------------------------------------------------------------------------------------


def _free(scene: Free, file: Path, data: Mapping, quantity: str) -> Evidence:
    """Errors are rms over phases of the step, against the limit of the engine's own laws; there is no scatter.

    Standard errors are that of the oracle and that of the rms, as so many phases tell it: s(e^2)/(2 rms sqrt(K)).
    """
    points = [r for r in data["tables"]["points"] if r["case"] == data["tables"]["points"][0]["case"]]
    orders = {(r["engine"], r["quantity"]): r["slope"] for r in data["tables"]["slopes"]
              if r["case"] == points[0]["case"]}
    bars = _free_bars(data, points[0]["case"], quantity)
    ladders = {}
    for engine in dict.fromkeys(r["engine"] for r in points):
        mine = [r for r in points if r["engine"] == engine]
        good = [r for r in mine if r.get(quantity) is not None and r["CPU (ms)"] is not None]
        rungs = tuple(
            _free_rung(r, quantity, bars[engine, r["dt_fraction"]], scene.numerics.dt_fraction) for r in good
        )
        order = orders.get((engine, quantity))
        if rungs:
            ladders[engine] = {"dt": KnobLadder(
                knob="dt", says="dt_fraction", rungs=tuple(sorted(rungs, key=lambda r: -r.x)), order=order or math.nan,
                state="extrapolated" if order else "flat",
                failed=tuple(f"{r['dt_fraction']:g}: {r['status']}" for r in mine if r["status"] != "completed"),
            )}
    return Evidence(
        scene=scene, scene_file=file, quantity=quantity, unit="1", packings=data["phases"], ladders=ladders,
        spread=dict.fromkeys(ladders), source="", absent=_absent(scene, [data["knob"]]),
    )


def _free_bars(data: Mapping, case: str, quantity: str) -> dict[tuple[str, float], float]:
    """Return standard errors by engine and dt_fraction."""
    oracle = {r["engine"]: r["its error"] or 0.0 for r in data["tables"]["oracles"] if r["case"] == case}
    rows = [r for r in data["errors"] if r["case"] == case and quantity in r]
    return {(r["engine"], r["dt_fraction"]): math.hypot(oracle[r["engine"]], _of_rms(r[quantity])) for r in rows}


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


def _free_rung(row: Mapping, quantity: str, bar: float, own: float) -> Rung:
    value = row["dt_fraction"]
    return Rung(
        knob="dt", value=value, x=value, declared=abs(value / own - 1.0) < 1e-9, error=row[quantity], bar=bar,
        seconds=1e-3 * row["CPU (ms)"],
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


def _quantity(data: Mapping, name: str | None, place: Path) -> str:
    known = list(data["quantities"]) if "quantities" in data else _free_quantities(data)
    wanted = name or data["quantity"]
    if wanted not in known:
        raise InputError(
            file="--quantity", expected=f"one of {', '.join(known)}, which {place} has", got=wanted,
            fix=nearest(wanted, known),
        )
    return wanted


def _free_quantities(data: Mapping) -> list[str]:
    return [q for q in ("exit", "velocity", "spin") if any(r.get(q) is not None for r in data["tables"]["points"])]


def _read(place: Path, what: str, option: str) -> Mapping:
    fix = f"run {what.removeprefix('a finished ')} first"
    try:
        data = json.loads(place.read_text())
    except FileNotFoundError:
        raise InputError(file=option, expected=f"the folder of {what}", got=f"no {place}", fix=fix) from None
    except (OSError, ValueError) as error:
        raise InputError(file=place, expected=what, got=f"a damaged file ({error})", fix=fix) from None
    schema = data.get("schema", BULK_SCHEMA) if isinstance(data, Mapping) else None
    if schema != BULK_SCHEMA or "tables" not in data or "scene" not in data:
        raise InputError(file=place, expected=what, got="another file, or of another version", fix=fix)
    return data


def _require_same_scene(scene: Scene, data: Mapping, place: Path, option: str) -> None:
    """Titles do not matter, and not what only `compare` judges by; what the study's version did not know is absent."""
    try:
        theirs = msgspec.convert(data["scene"], Scene)
    except msgspec.ValidationError as error:
        raise InputError(file=place, expected="a study of a scene", got=f"another ({error})") from None
    names = {"kind", *type(scene).__struct_fields__} - {"title", "compare"}
    kind = {"kind"} if type(theirs) is not type(scene) else set()
    other = kind or {n for n in names - {"kind"} if getattr(scene, n) != getattr(theirs, n)}
    if other:
        raise InputError(
            file=option, expected="a study of this scene", got=f"{place}, whose {', '.join(sorted(other))} differ",
            fix="run it again for this scene",
        )


def _with(evidence: Evidence, **changes) -> Evidence:
    return dataclasses.replace(evidence, **changes)
