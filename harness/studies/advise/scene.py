"""The scene that advice means, as `grainproof scene` accepts it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from msgspec.structs import replace

from harness.errors import InputError
from harness.scene.checks import first_fault
from harness.scene.grains import grains_of
from harness.scene.load import load_scene
from harness.scene.model import Free, Scene
from harness.scene.numerics import plan_steps
from harness.scene.resolve import known_system, resolve
from harness.studies.accuracy.turn import turned
from harness.studies.effects.variants import without

FINER = 0.05
"""How much finer than advised a step may be, so that samples and frames fall on steps."""


@dataclass(frozen=True, kw_only=True)
class Settings:
    """values: of knobs by name. without: effects left out."""

    values: Mapping[str, float]
    without: tuple[str, ...] = ()


def advised_scene(scene: Scene, file: Path, settings: Settings, *, packings: int | None = None) -> Scene:
    """Return the scene with all knobs turned, effects left out, and so many packings to be compared."""
    made = scene
    for knob in ("stiffness", "rate", "size"):
        if knob in settings.values and settings.values[knob] != 1.0:
            made = turned(made, knob, settings.values[knob])
    if "dt" in settings.values:
        made = replace(made, numerics=replace(made.numerics, dt_fraction=settings.values["dt"]))
    if settings.without:
        made = without(made, settings.without, _grains(made, file))
    made = _fitting(made, file)
    if packings is not None and not isinstance(made, Free):
        made = replace(made, compare=replace(made.compare, packings=packings))
    return made


def can_run(scene: Scene, file: Path, settings: Settings) -> bool:
    """Whether the scene obeys all rules that are known before a packing is made, its time step's among them."""
    return not why_not_run(scene, file, settings)


def why_not_run(scene: Scene, file: Path, settings: Settings) -> str:
    """Say which rule the scene breaks, "" if none that is known before a packing is made."""
    try:
        made = advised_scene(scene, file, settings)
        fault = first_fault(made, file.parent)
        if fault is not None:
            return str(fault.error(file))
        known_system(made, file)
    except InputError as error:
        return str(error)
    return ""


def _fitting(scene: Scene, file: Path) -> Scene:
    """Look half as often until the step is the advised one: it is rounded to fit samples and frames."""
    grains = _grains(scene, file)
    needed = plan_steps(replace(scene, outputs=replace(scene.outputs, samples=1, frames=1)), grains).steps
    while plan_steps(scene, grains).steps > (1.0 + FINER) * needed:
        outputs = scene.outputs
        fewer = {name: max(1, getattr(outputs, name) // 2) for name in ("samples", "frames")}
        if fewer == {name: getattr(outputs, name) for name in fewer}:
            return scene
        scene = replace(scene, outputs=replace(outputs, **fewer))
    return scene


def _grains(scene: Scene, file: Path):
    """Return the particles as far as they are known: explicit ones do not depend on the step, which may be refused."""
    if isinstance(scene, Free):
        return grains_of(scene, resolve(load_scene(file), file).particles)
    system = known_system(scene, file)
    return grains_of(scene, None if system is None else system.particles)
