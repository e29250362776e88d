"""What was measured, as data: ladders of knobs, their limits, the scatter over packings, and which effects may go."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

from harness.scene.model import Free, Scene
from harness.studies.accuracy.asked import KNOBS, WITHOUT

DECIDED = ("dt", "stiffness", "rate", "size")
"""Knobs that advice turns, in order; of those a scene has."""

TOLD = ("width",)
"""Knobs of the evaluation: their error is told, but the width belongs to what the quantity is."""

Origin = Literal["measured", "extrapolated"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rung:
    """One setting of one knob. error: signed where it has a sign, against the knob's limit; bar: its standard error;
    both over the quantity's scale. seconds: CPU time of one whole test. spread: scatter of one packing, over the scale.

    each: values by packing, in the unit, NaN where a packing has none; empty of curves, and where it was not run.
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
    each: tuple[float, ...] = ()
    origin: Origin = "measured"
    how: str = ""

    @property
    def seen(self) -> bool:
        """Whether the error stands out of its own."""
        return abs(self.error) > 2.0 * self.bar


@dataclasses.dataclass(frozen=True, kw_only=True)
class KnobLadder:
    """All good rungs of one knob on one engine, coarsest first. failed: why other rungs have no error.

    scale: what errors are measured by, in the quantity's unit; of bodies that are followed 1, the speed at the start.
    order: used for the limit. state: of the limit, see `harness.studies.accuracy.limit`. beyond: values, of rungs with
    and without an error, that are beyond the scene's stability limit `largest`, so that `scene` refuses them.
    """

    knob: str
    says: str
    rungs: tuple[Rung, ...]
    order: float
    state: str
    scale: float = 1.0
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
    effects_say: what is known of them; effects_source: the folder of their study, "" without one.
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
    effects_source: str = ""

    @property
    def free(self) -> bool:
        """Whether bodies are followed, which have no scatter over packings."""
        return isinstance(self.scene, Free)


def absent_knobs(scene: Scene, measured: Sequence[str]) -> dict[str, str]:
    """Return the knobs that advice turns and the study did not, with the reason."""
    kind, found = type(scene), {}
    for knob in DECIDED:
        if knob in measured:
            continue
        lacking = WITHOUT.get((kind, knob))
        found[knob] = f"not turned in this kind of scene: {lacking}" if knob not in KNOBS[kind] and lacking else (
            "not measured: it stays as declared, and its error is in no sum"
        )
    return found
