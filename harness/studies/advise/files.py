"""The files of finished studies as they have to be: read, and checked once, before anything is made of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import msgspec
from msgspec import Meta, Struct, field

from harness.errors import InputError
from harness.scene.model import Scene

ACCURACY, EFFECTS = "accuracy.json", "effects.json"
BULK_SCHEMA = "grainproof accuracy of bulk quantities, 2"
FREE_SCHEMA = "grainproof accuracy of free bodies, 2"

NonNegative = Annotated[float, Meta(ge=0)]
Positive = Annotated[float, Meta(gt=0)]
FreeQuantity = Literal["exit", "velocity", "spin"]
Fraction = Positive


class BulkRow(Struct, tag_field="kind", kw_only=True):
    """What rungs and limits share; see `harness.report.accuracy_bulk.bulk_data`."""

    knob: str
    knob_value: str
    engine: str
    quantity: str
    unit: str
    scale: Positive | None
    spread: NonNegative | None


class MeasuredRow(BulkRow, tag="measured", kw_only=True):
    """A rung of a box or a ring."""

    value: float
    setting: str
    x: NonNegative
    status: str
    declared: bool
    signed_error: float | None
    error_bar: NonNegative | None
    cpu_seconds: Positive | None
    each: list[Any] | None
    beyond_limit: Positive | None


class LimitRow(BulkRow, tag="extrapolated", kw_only=True):
    """The limit of a ladder."""

    state: Literal["extrapolated", "outside", "flat"]
    order_used: float | None


class BulkFile(Struct, kw_only=True):
    """accuracy.json of a box or a ring."""

    schema: str
    scene: Scene
    knobs: list[str]
    quantity: str
    quantities: dict[str, Any]
    packings: Annotated[int, Meta(ge=2)]
    engines: list[str]
    rows: list[MeasuredRow | LimitRow]


class FreePoint(Struct, kw_only=True):
    """A rung of a free scene. rung: as asked for; dt_fraction: of the step that ran."""

    case: str
    engine: str
    rung: Fraction
    dt_fraction: Fraction
    status: str
    milliseconds: Positive | None = field(name="CPU (ms)")
    beyond: Fraction | None = field(name="beyond the scene's limit of")
    exit: NonNegative | None
    velocity: NonNegative | None = None
    spin: NonNegative | None = None


class FreeErrors(Struct, kw_only=True):
    """Errors of a rung by phase."""

    case: str
    engine: str
    dt_fraction: Fraction
    exit: list[NonNegative] | None = None
    velocity: list[NonNegative] | None = None
    spin: list[NonNegative] | None = None


class FreeSlope(Struct, kw_only=True):
    """An order, None where none is shown."""

    case: str
    engine: str
    quantity: str
    slope: float | None


class FreeOracle(Struct, kw_only=True):
    """What errors are measured against."""

    case: str
    engine: str
    error: NonNegative | None = field(name="its error")


class FreeTables(Struct, kw_only=True):
    """Of a free scene those that advice needs."""

    points: Annotated[list[FreePoint], Meta(min_length=1)]
    slopes: list[FreeSlope]
    oracles: list[FreeOracle]


class FreeFile(Struct, kw_only=True):
    """accuracy.json of a free scene."""

    schema: str
    scene: Scene
    knob: str
    quantity: FreeQuantity
    phases: Annotated[int, Meta(ge=1)]
    tables: FreeTables
    errors: list[FreeErrors]


class Trial(Struct, kw_only=True):
    """A combination of effects left out, and what it changes in one quantity."""

    trial: int
    quantity: str
    change: float | None = field(name="change (%)")
    error: NonNegative | None = field(name="standard error (%)")


class EffectsTables(Struct, kw_only=True):
    """Of an effects study that which advice needs."""

    trials: list[Trial]


class EffectsFile(Struct, kw_only=True):
    """effects.json."""

    scene: Scene
    quantities: list[str]
    tolerance: float
    left_out: list[str]
    saved: dict[str, float | None]
    tables: EffectsTables


class _Schema(Struct):
    schema: str = ""


WHAT = {ACCURACY: "a finished grainproof accuracy", EFFECTS: "a finished grainproof effects"}
Read = TypeVar("Read")


def read_accuracy(folder: Path, *, free: bool) -> BulkFile | FreeFile:
    """Return accuracy.json of `folder`. Raises InputError for anything else."""
    place = folder / ACCURACY
    text = _text(place, "--from")
    found = _decoded(text, _Schema, place).schema
    if found not in (BULK_SCHEMA, FREE_SCHEMA):
        raise InputError(
            file=place, expected=WHAT[ACCURACY], got=f'schema "{found}"' if found else "a file without a schema",
            fix="run grainproof accuracy again: it takes what it kept",
        )
    made = _decoded(text, FreeFile if found == FREE_SCHEMA else BulkFile, place)
    if isinstance(made, FreeFile) != free:
        raise InputError(
            file="--from", expected="a study of this scene", got=f"{place}, whose kind differs",
            fix="run it again for this scene",
        )
    return made


def read_effects(folder: Path) -> EffectsFile:
    """Return effects.json of `folder`. Raises InputError for anything else."""
    place = folder / EFFECTS
    return _decoded(_text(place, "--effects-from"), EffectsFile, place)


def damaged(place: Path, why: object) -> InputError:
    """Return the error for a file that says what no study writes."""
    return InputError(
        file=place, expected=WHAT[place.name], got=f"a damaged file ({why})", fix=f"run {_verb(place)} again"
    )


def _text(place: Path, option: str) -> bytes:
    folder, expected = place.parent, f"the folder of {WHAT[place.name]}"
    if folder.exists() and not folder.is_dir():
        raise InputError(file=option, expected=expected, got=f"{folder}, a file", fix=f"name {folder.parent}")
    try:
        return place.read_bytes()
    except FileNotFoundError:
        raise InputError(file=option, expected=expected, got=f"no {place}", fix=f"run {_verb(place)} first") from None
    except OSError as error:
        raise damaged(place, error.strerror or error) from None


def _decoded(text: bytes, kind: type[Read], place: Path) -> Read:
    try:
        return msgspec.json.decode(text, type=kind)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise damaged(place, error) from None


def _verb(place: Path) -> str:
    return WHAT[place.name].removeprefix("a finished ")
