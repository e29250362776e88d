"""The settings of a bulk study: every rung of every knob as systems, one a packing."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

from harness.errors import InputError
from harness.runs.outcome import usable_cores
from harness.scene.derived import derive
from harness.scene.grains import grains_of
from harness.scene.model import Biaxial, Scene
from harness.scene.system import System
from harness.studies.accuracy.asked import Asked
from harness.studies.accuracy.simpler import DECLARED, simpler_laws
from harness.studies.accuracy.turn import largest_fraction, replaced, stepped_system, turned
from harness.studies.prepare import prepare

if TYPE_CHECKING:
    from harness.runs.progress import Progress

OWN = "as declared"

STEPS = ("dt", "scheme")
"""Knobs whose values are steps."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """One rung of one knob. value: of the knob, of laws their number. label: the value in words.

    scene: with the knob turned. own: whether it is the scene as declared. width: of the averages, None for the scene's
    own. systems: one a packing, empty with a reason why there are none. beyond: see `Rung`.
    """

    knob: str
    value: float
    x: float
    label: str
    scene: Scene
    own: bool
    width: float | None = None
    systems: tuple[System, ...] = field(default=(), repr=False)
    reason: str = ""
    beyond: float | None = None

    @property
    def name(self) -> str:
        """How its runs are called; the scene as declared is on several ladders."""
        return OWN if self.own or self.width is not None else f"{self.knob} {self.label}"


@dataclass(frozen=True, kw_only=True)
class Packed:
    """All settings, and the CPU time that their packings took, s."""

    settings: tuple[Setting, ...]
    seconds: float


def plan(
    scene: Scene, file: Path, wanted: Sequence[Asked], packings: int, cache: Path, *, workers: int | None = None,
    progress: Callable[[], Progress] | None = None,
) -> Packed:
    """Return the settings of all knobs, packings made or taken from `cache`, as many for each.

    A rung that cannot be packed has a reason in place of systems. Raises InputError if the scene itself cannot.
    """
    declared, bare = lean(scene), bare_settings(scene, wanted)
    seconds = _pack([declared, *(s.scene for s in bare)], file, packings, cache, workers, progress)
    own = _systems(declared, file, packings, cache)
    return Packed(settings=tuple(_filled(s, own, file, packings, cache) for s in bare), seconds=seconds)


def bare_settings(scene: Scene, wanted: Sequence[Asked]) -> tuple[Setting, ...]:
    """Return the settings of all knobs, without systems."""
    declared = lean(scene)
    return tuple(s for one in wanted for s in _settings(declared, one))


def pack_settings(
    settings: Sequence[Setting], file: Path, packings: int, cache: Path, *, workers: int | None = None,
    progress: Callable[[], Progress] | None = None,
) -> Packed:
    """Return settings that are scenes of their own, with their packings; see `plan` for one that cannot be packed."""
    seconds = _pack([s.scene for s in settings], file, packings, cache, workers, progress)
    return Packed(settings=tuple(_with_packings(s, file, packings, cache) for s in settings), seconds=seconds)


def lean(scene: Scene) -> Scene:
    """A box is measured at its walls: states of its particles would only take time. Rings are averaged over states."""
    if isinstance(scene, Biaxial):
        return replaced(scene, outputs=replaced(scene.outputs, frames=1, contacts=False, rotations=False))
    return scene


def _settings(scene: Scene, one: Asked) -> Iterator[Setting]:
    knob = one.knob
    if knob.words:
        yield from _laws(scene, knob.name)
        return
    own, steps = knob.own(scene), knob.name in STEPS
    largest = largest_fraction(scene, grains_of(scene)) if steps else inf
    for value in one.values:
        yield Setting(
            knob=knob.name, value=value, x=knob.x(value), label=f"{value:.4g}", own=value == own,
            scene=scene if value == own else turned(scene, knob.name, value),
            width=value if knob.name == "width" else None, beyond=largest if value > largest else None,
        )


def _laws(scene: Scene, knob: str) -> Iterator[Setting]:
    pair = derive(scene).pairs[0].pair
    for number, law in enumerate(simpler_laws(scene.contact, pair)):
        yield Setting(
            knob=knob, value=float(number), x=float(number), label=law.name, own=law.name == DECLARED,
            scene=replaced(scene, contact=law.contact),
        )


def _filled(setting: Setting, own: tuple[System, ...], file: Path, packings: int, cache: Path) -> Setting:
    if setting.own or setting.knob == "width":
        return replace_systems(setting, own)
    if setting.knob in STEPS:
        return replace_systems(setting, tuple(stepped_system(setting.scene, s, setting.value) for s in own))
    return _with_packings(setting, file, packings, cache)


def _with_packings(setting: Setting, file: Path, packings: int, cache: Path) -> Setting:
    try:
        return replace_systems(setting, _systems(setting.scene, file, packings, cache))
    except InputError as error:
        return replace_systems(setting, (), reason=str(error))


def replace_systems(setting: Setting, systems: tuple[System, ...], reason: str = "") -> Setting:
    """Return the setting with its systems."""
    return replace(setting, systems=systems, reason=reason)


# --- packings ----------------------------------------------------------------------------------------


def _systems(scene: Scene, file: Path, packings: int, cache: Path) -> tuple[System, ...]:
    return tuple(p.system for p in prepare(scene, file, packings=packings, cache=cache))


def _pack(
    scenes: Sequence[Scene], file: Path, packings: int, cache: Path, workers: int | None,
    progress: Callable[[], Progress] | None,
) -> float:
    """Make all packings that are not there, several at a time; return the CPU seconds it took."""
    from harness.runs.progress import Silent

    distinct = list({_starts_from(s): s for s in scenes}.values())
    shown, labels = progress() if progress else Silent(), [f"packings {k + 1}" for k in range(len(distinct))]
    shown.begin(labels, [float(packings)] * len(distinct))
    total = 0.0
    try:
        with ProcessPoolExecutor(min(workers or usable_cores(), len(distinct) * packings)) as pool:
            tasks = [[pool.submit(_pack_one, s, file, k, cache) for k in range(packings)] for s in distinct]
            for number, of in enumerate(tasks):
                shown.running(number, 0.0)
                total += sum(t.result() for t in of)
                shown.done(number, f"{labels[number]} of {len(distinct)}: {packings} made or found")
    finally:
        shown.end()
    return total


def _starts_from(scene: Scene) -> str:
    """What a packing depends on, as text; a little too much is no harm."""
    import msgspec

    told = {name: getattr(scene, name, None) for name in ("particles", "preparation", "contact", "rings", "background")}
    return msgspec.json.encode(told).decode()


def _pack_one(scene: Scene, file: Path, number: int, cache: Path) -> float:
    """Make the packing of one seed; what is wrong with it is said when it is asked for. Returns CPU seconds."""
    begun = time.process_time()
    seeded = replaced(scene, particles=replaced(scene.particles, seed=(scene.particles.seed or 0) + number))
    with suppress(InputError):
        prepare(seeded, file, packings=1, cache=cache)
    return time.process_time() - begun
