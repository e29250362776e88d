"""From a scene file to systems: packings made or found, one system a packing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from harness.errors import InputError
from harness.packing import Flow, Packing, grow_ring, make_packing
from harness.scene.judged import MOST_PACKINGS
from harness.scene.laws import first_stiffness
from harness.scene.model import Biaxial, Couette, Scene
from harness.scene.resolve import needs_packing, resolve
from harness.scene.system import System

if TYPE_CHECKING:
    from harness.runs.progress import Progress


@dataclass(frozen=True, kw_only=True)
class Prepared:
    """One start of a scene: the system and, for scenes that are packed, the packing it came from."""

    number: int
    system: System
    packing: Packing | Flow | None


def prepare(
    scene: Scene, path: Path, *, packings: int | None, cache: Path, progress: Callable[[], Progress] | None = None
) -> list[Prepared]:
    """Return the systems of a checked scene; packing k has the scene's seed + k.

    packings: how many; None means as many as the scene says. progress: makes what shows the packings
    being made. Raises InputError, also for several packings of a scene that has no random ones.
    """
    count = start_count(scene, packings)
    if not needs_packing(scene):
        return [Prepared(number=0, system=resolve(scene, path), packing=None)]
    return _packed(scene, path, count, cache, progress)


def start_count(scene: Scene, packings: int | None) -> int:
    """Return how many starts a scene has when a user asks for so many packings; None: as the scene says.

    Raises InputError for too many, and for several of a scene whose particles are not drawn at random.
    """
    several = draws_packings(scene)
    if not several and packings not in (None, 1):
        raise InputError(
            file="--packings", expected="1, as this scene's particles are not drawn at random", got=packings
        )
    if (packings or 1) > MOST_PACKINGS:
        raise InputError(file="--packings", expected=f"a number from 1 to {MOST_PACKINGS}", got=packings)
    return (packings or scene.compare.packings) if several else 1


def draws_packings(scene: Scene) -> bool:
    """Whether another seed gives another packing: particles are drawn at random, and not from a file."""
    return needs_packing(scene) and not (isinstance(scene, Biaxial) and scene.particles.packing is not None)


def _packed(
    scene: Biaxial | Couette, path: Path, count: int, cache: Path, progress: Callable[[], Progress] | None
) -> list[Prepared]:
    from harness.runs.progress import Silent

    shown, labels = progress() if progress else Silent(), [f"packing {k + 1}" for k in range(count)]
    starts: list[Prepared] = []
    shown.begin(labels, [1.0] * count)
    try:
        for number, label in enumerate(labels):
            starts.append(_start(scene, path, number, cache, partial(shown.running, number, 0.0)))
            shown.done(number, f"{label}: {starts[-1].packing.says}")
    finally:
        shown.end()
    return starts


def _start(scene: Biaxial | Couette, path: Path, number: int, cache: Path, begin: Begin) -> Prepared:
    packing = MAKERS[type(scene)](scene, path, (scene.particles.seed or 0) + number, cache, begin)
    return Prepared(number=number, system=resolve(scene, path, packing), packing=packing)


def _box(scene: Biaxial, path: Path, seed: int, cache: Path, begin: Begin) -> Packing:
    return make_packing(
        scene.particles, scene.preparation, stiffness=first_stiffness(scene.contact.normal), seed=seed, cache=cache,
        scene_folder=path.parent, begin=begin,
    )


def _ring(scene: Couette, _: Path, seed: int, cache: Path, begin: Begin) -> Flow:
    return grow_ring(scene, seed=seed, cache=cache, begin=begin)


Begin = Callable[[], None]
"""Called when a packing has to be made."""

MAKERS = {Biaxial: _box, Couette: _ring}
"""What makes the start of a scene, by its kind."""
