"""The two systems between which an effect is the only difference, with one time step for both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError
from harness.scene.grains import grains_of
from harness.scene.laws import word
from harness.scene.model import Scene
from harness.scene.resolve import resolve
from harness.scene.system import System
from harness.studies.effects.switches import SWITCHES
from harness.studies.effects.turned import NotSwitched
from harness.studies.effects.variants import Variant
from harness.studies.prepare import Prepared

PLAN = ("dt", "steps", "sample_every", "frame_every")


@dataclass(frozen=True, kw_only=True)
class OnOff:
    """One effect. on: as declared, or as it was switched on. off: without it. zero: with it, its coefficient at zero.

    zero_says: what was written for zero; why_no_zero: "" or why there is none. exact: see `switches.Switch`.
    replaced: "" or which law stands in the place of another. also: see `Variant`.
    """

    effect: str
    on: System
    off: System
    zero: System | None
    zero_says: str
    why_no_zero: str
    exact: bool
    replaced: str
    also: tuple[str, ...]


def on_and_off(scene: Scene, file: Path, start: Prepared, variants: Sequence[Variant]) -> list[OnOff]:
    """Return a pair for every variant that has a scene."""
    return [_pair(scene, file, start, v) for v in variants if v.scene is not None]


def _pair(scene: Scene, file: Path, start: Prepared, variant: Variant) -> OnOff:
    name, grains = variant.effect.name, grains_of(scene, start.system.particles)
    switch = SWITCHES[name]
    on = scene if variant.effect.on else variant.scene
    off = switch.off(on, grains).scene
    system = resolve(on, file, start.packing)
    plan = {key: getattr(system, key) for key in PLAN}
    zero, says, why = None, "", ""
    try:
        turned = switch.zero(on, grains)
        zero, says = resolve(turned.scene, file, start.packing).with_(**plan), turned.says
    except NotSwitched as no:
        why = str(no)
    except (InputError, ArithmeticError) as no:
        why = f"the scene refuses it: {no}"
    off_system = resolve(off, file, start.packing).with_(**plan)
    return OnOff(
        effect=name, on=system, off=off_system, zero=zero, zero_says=says, why_no_zero=why, exact=switch.exact,
        replaced=_replaced(system, off_system), also=variant.also if not variant.effect.on else (),
    )


def _replaced(on: System, off: System) -> str:
    if type(on.normal) is type(off.normal):
        return ""
    return f'another law, "{word(off.normal)}", stands in the place of "{word(on.normal)}"'
