"""Replicates: which packings are made, which runs are kicked.

Replicate k of a scene starts from packing k, whose seed is the scene's own + k, and all engines compute it: what a
packing does to them alike cancels in their differences. From the second replicate on every engine's run has a kick of
its own (`harness.studies.statistics.kick`), drawn from the content of the system, the engine's name and k. Codes that
round differently part by chaos anyway; the kick makes the same of codes that round alike, and of a code and itself.
The first replicate is not kicked: there all engines start from the same numbers to the last bit, so that they can be
followed pointwise, and its runs are those of a comparison without replicates. A scene whose particles come from a file
has one packing; there replicates are kicks alone and engines are independent of each other.

Several packings without kicks (``--packings``) are judged in the same way: there all engines start every packing from
the same numbers, and what tells two of them apart after chaos is that they round differently.

One more run, the response, is the first packing in one of the engines with a kick: it shows how far chaos drives runs
apart (`harness.studies.compare.chaos`). Like every run it is kept in a folder named by its content, kick included.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.registry import KERNEL_PREFIX
from harness.errors import InputError
from harness.scene.judged import MOST_PACKINGS
from harness.scene.laws import turning
from harness.scene.model import Biaxial, Couette, Scene
from harness.scene.system import System
from harness.studies.compare.pairs import pairs_of
from harness.studies.prepare import Prepared, draws_packings, prepare
from harness.studies.statistics.difference import FEWEST
from harness.studies.statistics.family import SAME
from harness.studies.statistics.kick import kicked

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

CHAOTIC = (Biaxial, Couette)
"""Kinds of scenes of many particles, whose runs part by chaos."""

AS_DECLARED = 0
"""Number of replicates that a command names when it names none."""


def replicate_count(scene: Scene, replicates: int | None) -> int | None:
    """Return how many replicates a command asks for, None for none. Raises InputError for what cannot be."""
    if replicates is None:
        return None
    if not isinstance(scene, CHAOTIC):
        raise InputError(
            file="--replicates", expected="a scene of many particles, a box or a ring", got=f'kind = "{_kind(scene)}"',
            fix="free bodies are followed over their whole way: leave it out",
        )
    count = scene.compare.replicates if replicates == AS_DECLARED else replicates
    if count is None:
        raise InputError(file="--replicates", expected="a number, as compare.replicates declares none", got="nothing")
    if not FEWEST <= count <= MOST_PACKINGS:
        raise InputError(file="--replicates", expected=f"a number from {FEWEST} to {MOST_PACKINGS}", got=count)
    return count


def make_starts(
    scene: Scene, path: Path, *, packings: int | None, replicates: int | None, cache: Path,
    progress: Callable[[], Progress] | None,
) -> list[Prepared]:
    """Return the starts of packings or of replicates (a count), see `prepare`. Raises InputError."""
    if replicates is None:
        return prepare(scene, path, packings=packings, cache=cache, progress=progress)
    if draws_packings(scene):
        return prepare(scene, path, packings=replicates, cache=cache, progress=progress)
    (one,) = prepare(scene, path, packings=None, cache=cache, progress=progress)
    return [replace(one, number=number) for number in range(replicates)]


def start_system(start: Prepared, engine: Engine, *, replicated: bool) -> System:
    """Return what an engine is given to compute from a start: kicked from the second replicate on."""
    return kicked(start.system, engine.name, start.number) if replicated and start.number else start.system


def responder(scene: Scene, engines: Sequence[Engine]) -> Engine | None:
    """Return the engine that is kicked to show the response: a kernel if there is one.

    None where there is no chaos, or no two engines that compute the same thing and could be measured by it.
    """
    if not isinstance(scene, CHAOTIC):
        return None
    same = [p for p in pairs_of([e.name for e in engines], friction=bool(turning(scene.contact))) if p.kind in SAME]
    if not same:
        return None
    return next((e for e in engines if e.name.startswith(KERNEL_PREFIX)), _named(same[0].left, engines))


def _named(name: str, engines: Sequence[Engine]) -> Engine:
    return next(e for e in engines if e.name == name)


@dataclass(frozen=True, kw_only=True)
class Planned:
    """A run to be made: what tables call the engine, and progress the run. of: see `harness.studies.compare.study`."""

    name: str
    number: int
    label: str
    engine: Engine
    system: System
    of: str = ""


def planned_runs(
    scene: Scene, starts: Sequence[Prepared], engines: Sequence[Engine], *, replicated: bool
) -> list[Planned]:
    """Return every engine on every start, and last the response, the first start with a kick of its own."""
    many = len(starts) > 1
    plan = [
        Planned(
            name=e.name, number=s.number, label=f"{e.name} #{s.number + 1}" if many else e.name, engine=e,
            system=start_system(s, e, replicated=replicated),
        )
        for s in starts for e in engines
    ]
    kicks = responder(scene, engines)
    if kicks is not None:
        name, system = f"{kicks.name} kicked", kicked(starts[0].system, kicks.name, "response")
        plan.append(Planned(name=name, number=0, label=name, engine=kicks, system=system, of=kicks.name))
    return plan


def _kind(scene: Scene) -> str:
    return scene.__struct_config__.tag
