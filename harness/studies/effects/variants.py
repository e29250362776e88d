"""The scene with one effect switched, every effect once: off where it is on, on where it is off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from harness.errors import InputError
from harness.scene.checks import first_fault
from harness.scene.effects import Effect, effects
from harness.scene.grains import Grains, grains_of
from harness.scene.model import Scene
from harness.scene.resolve import resolve
from harness.scene.system import System
from harness.studies.effects.switches import SWITCHES
from harness.studies.effects.turned import NotSwitched
from harness.studies.prepare import Prepared

BASE = "as declared"


@dataclass(frozen=True, kw_only=True)
class Variant:
    """An effect switched alone.

    says: what was written instead, with its numbers. also: effects that came or went with it, "-" or "+" before them.
    scene: None where it cannot be switched, and then the reason.
    """

    effect: Effect
    says: str = ""
    also: tuple[str, ...] = ()
    scene: Scene | None = None
    reason: str = ""

    @property
    def turned(self) -> Literal["off", "on"]:
        """Which way."""
        return "off" if self.effect.on else "on"

    @property
    def name(self) -> str:
        """How tables call it.

        >>> from harness.scene.effects import Effect
        >>> Variant(effect=Effect(name="gravity", on=True, place="", reason="", brings="")).name
        'without gravity'
        """
        return f"{'without' if self.effect.on else 'with'} {self.effect.name}"


def variants_of(scene: Scene, file: Path, starts: Sequence[Prepared], only: Sequence[str] = ()) -> list[Variant]:
    """Return all variants, those that cannot be with the reason. only: effects that are switched; all if empty."""
    system = starts[0].system
    grains = grains_of(scene, system.particles)
    found = [e for e in effects(scene, system) if not only or e.name in only]
    return [_variant(scene, file, starts, grains, effect) for effect in found]


def systems_of(scene: Scene, file: Path, starts: Sequence[Prepared]) -> list[System]:
    """Return the system of a scene from every start, made by whatever scene. Raises InputError for what cannot be."""
    fault = first_fault(scene, file.parent)
    if fault is not None:
        raise fault.error(file)
    return [resolve(scene, file, start.packing) for start in starts]


def _variant(scene: Scene, file: Path, starts: Sequence[Prepared], grains: Grains, effect: Effect) -> Variant:
    switch = SWITCHES[effect.name]
    try:
        turned = (switch.off if effect.on else switch.on)(scene, grains)
        systems = systems_of(turned.scene, file, starts)
    except NotSwitched as why:
        return Variant(effect=effect, reason=str(why))
    except InputError as error:
        return Variant(effect=effect, reason=f"no scene any more: {error}")
    also = tuple(
        f"{'+' if after.on else '-'}{after.name}"
        for before, after in zip(
            effects(scene, starts[0].system), effects(turned.scene, systems[0]), strict=True
        )
        if before.on != after.on and after.name != effect.name
    )
    return Variant(effect=effect, says=turned.says, also=also, scene=turned.scene)


def without(scene: Scene, names: Sequence[str], grains: Grains) -> Scene:
    """Return the scene without several effects; one that is gone with another is gone."""
    for name in names:
        if next(e for e in effects(scene) if e.name == name).on:
            scene = SWITCHES[name].off(scene, grains).scene
    return scene
