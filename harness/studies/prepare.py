"""From a scene file to systems: packings made or found, one system a packing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.errors import InputError
from harness.packing import Packing, make_packing
from harness.scene.laws import first_stiffness
from harness.scene.model import MOST_PACKINGS, Biaxial, Scene
from harness.scene.resolve import needs_packing, resolve
from harness.scene.system import System

if TYPE_CHECKING:
    from harness.runs.progress import Progress


@dataclass(frozen=True, kw_only=True)
class Prepared:
    """One start of a scene: the system and, for scenes that are packed, the packing it came from."""

    number: int
    system: System
    packing: Packing | None


def prepare(
    scene: Scene, path: Path, *, packings: int | None, cache: Path, progress: Callable[[], Progress] | None = None
) -> list[Prepared]:
    """Return the systems of a checked scene; packing k has the scene's seed + k.

    packings: how many; None means as many as the scene says. progress: makes what shows the packings
    being made. Raises InputError, also for several packings of a scene that has no random ones.
    """
    several = needs_packing(scene) and scene.particles.packing is None
    if not several and packings not in (None, 1):
        raise InputError(
            file="--packings", expected="1, as this scene's particles are not drawn at random", got=packings
        )
    if (packings or 1) > MOST_PACKINGS:
        raise InputError(file="--packings", expected=f"a number from 1 to {MOST_PACKINGS}", got=packings)
    if not needs_packing(scene):
        return [Prepared(number=0, system=resolve(scene, path), packing=None)]
    count = (packings or scene.compare.packings) if several else 1
    return _packed(scene, path, count, cache, progress)


def _packed(
    scene: Biaxial, path: Path, count: int, cache: Path, progress: Callable[[], Progress] | None
) -> list[Prepared]:
    from harness.runs.progress import Silent

    shown, labels = progress() if progress else Silent(), [f"packing {k + 1}" for k in range(count)]
    starts: list[Prepared] = []
    shown.begin(labels, [1.0] * count)
    try:
        for number, label in enumerate(labels):
            shown.running(number, 0.0)
            starts.append(_start(scene, path, number, cache))
            shown.done(number, f"{label}: {_says(starts[-1].packing)}")
    finally:
        shown.end()
    return starts


def _start(scene: Biaxial, path: Path, number: int, cache: Path) -> Prepared:
    packing = make_packing(
        scene.particles, scene.preparation, stiffness=first_stiffness(scene.contact.normal),
        seed=(scene.particles.seed or 0) + number, cache=cache, scene_folder=path.parent,
    )
    return Prepared(number=number, system=resolve(scene, path, packing), packing=packing)


def _says(packing: Packing) -> str:
    return f"{len(packing.radius)} particles, {packing.contacts} contacts, residual force {packing.residual:.2g}"
