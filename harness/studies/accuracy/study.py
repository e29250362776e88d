"""What accuracy costs: one scene, one knob, a ladder of settings on every engine, and what each gives and takes."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.registry import ENGINES, KERNEL_PREFIX, choose_engines
from harness.errors import InputError
from harness.runs.outcome import Host, host_facts
from harness.scene.laws import turning
from harness.scene.load import load_scene
from harness.scene.model import Biaxial, Couette, Free
from harness.studies.accuracy.asked import Asked, asked_all
from harness.studies.accuracy.bulk import BulkAccuracy, bulk_accuracy
from harness.studies.accuracy.result import Track
from harness.studies.accuracy.steps import climb, ladders

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

USUAL = ("lammps", "liggghts", "kernel:talk", "kernel:corrected")
"""The codes, the leapfrog of the kernel, and its second-order scheme."""

PHASES, MOST_PHASES = 48, 1000

TIME_LIMIT = 600.0


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """Everything a report needs. contact_time, duration in s; bodies: of one copy.

    wall_seconds: of the whole study this time; own_seconds: CPU time of this process in it.
    """

    scene: Free
    scene_file: Path
    asked: Asked
    phases: int
    bodies: int
    contact_time: float
    tracks: tuple[Track, ...]
    host: Host
    wall_seconds: float
    own_seconds: float

    @property
    def declared(self) -> list[Track]:
        """The tracks of the scene as it is declared."""
        return [t for t in self.tracks if t.case == self.tracks[0].case]

    @property
    def cases(self) -> list[str]:
        """Names of the cases, the declared one first."""
        return list(dict.fromkeys(t.case for t in self.tracks))

    @property
    def exit_status(self) -> int:
        """1 when an engine that takes the scene has no rung that passed; unstable rungs are what is looked for."""
        taken = [t for t in self.tracks if any(p.status not in ("unsupported", "unavailable") for p in t.points)]
        return 0 if taken and all(t.known(self.asked.quantity) for t in taken) else 1


def accuracy(
    scene_file: Path, out: Path, *, engines: Sequence[str] | None = None, knob: str | None = None,
    ladder: Sequence[float] | None = None, quantity: str | None = None, phases: int | None = None,
    packings: int | None = None, time_limit: float = TIME_LIMIT, workers: int | None = None,
    progress: Callable[[], Progress] | None = None,
) -> Accuracy | BulkAccuracy:
    """Climb the ladders; runs, oracles, packings and times are kept below `out` and reused.

    Free scenes have phases of the step, boxes and rings have packings: of those errors are formed.
    Raises InputError for a wrong scene, knob, ladder or quantity before anything is written.
    """
    scene = load_scene(scene_file)
    wanted = checked(
        scene, scene_file, knob=knob, ladder=ladder, quantity=quantity, phases=phases, packings=packings
    )
    options = {"engines": engines, "time_limit": time_limit, "workers": workers, "progress": progress}
    if isinstance(scene, Free):
        return free_accuracy(scene, scene_file, wanted[0], out, phases=phases, **options)
    return bulk_accuracy(scene, scene_file, wanted, out, packings=packings, **options)


def free_accuracy(
    scene: Free, scene_file: Path, wanted: Asked, out: Path, *, engines: Sequence[str] | None, phases: int | None,
    time_limit: float, workers: int | None, progress: Callable[[], Progress] | None,
) -> Accuracy:
    """Climb the ladder of steps of a free scene."""
    begun, own = time.monotonic(), time.process_time()
    chosen = chosen_engines(engines, wanted)
    count = phase_count(phases)
    rungs = ladders(scene, scene_file, wanted.values, count)
    tracks = climb(
        rungs, chosen, scene_file, out, time_limit=time_limit, workers=workers, progress=progress
    )
    return Accuracy(
        scene=scene, scene_file=scene_file, asked=wanted, phases=count, bodies=rungs.cases[0].phased[0].bodies,
        contact_time=rungs.contact_time, tracks=tuple(tracks), host=host_facts(), wall_seconds=time.monotonic() - begun,
        own_seconds=time.process_time() - own,
    )


def checked(
    scene: Free | Biaxial | Couette, file: Path, *, knob: str | None, ladder: Sequence[float] | None,
    quantity: str | None, phases: int | None, packings: int | None,
) -> tuple[Asked, ...]:
    """Return what is to be done; raises InputError for what this scene does not have."""
    wanted = asked_all(scene, file, knob=knob, ladder=ladder, quantity=quantity)
    _require_one_of(scene, phases=phases, packings=packings)
    if isinstance(scene, Free):
        _require_quantity(scene, wanted[0])
    return wanted


def _require_one_of(scene: Free | Biaxial | Couette, *, phases: int | None, packings: int | None) -> None:
    """Phases belong to free scenes, packings to those that are packed."""
    free = isinstance(scene, Free)
    wrong, other, got = ("packings", "phases", packings) if free else ("phases", "packings", phases)
    if got is not None:
        raise InputError(
            file=f"--{wrong}", expected="nothing for this kind of scene", got=got, fix=f"it has --{other}"
        )


def chosen_engines(words: Sequence[str] | None, wanted: Asked) -> tuple[Engine, ...]:
    """Return the engines: the usual ones unless named; of the knob `scheme` the kernel in all its conventions."""
    if words:
        return choose_engines(list(words))
    if wanted.knob.name == "scheme":
        return tuple(e for name, e in ENGINES.items() if name.startswith(KERNEL_PREFIX))
    return choose_engines(list(USUAL))


def phase_count(phases: int | None) -> int:
    """Return the number of phases of the step; PHASES unless asked otherwise. Raises InputError."""
    count = PHASES if phases is None else phases
    if not 2 <= count <= MOST_PHASES:
        raise InputError(file="--phases", expected=f"a number from 2 to {MOST_PHASES}", got=count)
    return count


def _require_quantity(scene: Free, wanted: Asked) -> None:
    if wanted.quantity == "spin" and not turning(scene.contact):
        raise InputError(
            file="--quantity", expected="a quantity that the scene changes", got="spin",
            fix="no law of this scene turns bodies",
        )


