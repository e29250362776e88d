"""From a scene file to systems: packings made or found, one system a packing."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from harness.packing import Packing, make_packing
from harness.scene.model import Scene
from harness.scene.resolve import needs_packing, resolve
from harness.scene.system import System


@dataclass(frozen=True, kw_only=True)
class Prepared:
    """One start of a scene: the system and, for scenes that are packed, the packing it came from."""

    number: int
    system: System
    packing: Packing | None


def prepare(scene: Scene, path: Path, *, packings: int | None, cache: Path) -> list[Prepared]:
    """Return the systems of a checked scene; packing k has the scene's seed + k.

    packings: how many; None means as many as the scene says. A scene without a random packing has
    one start, whatever `packings` says. Raises InputError.
    """
    if not needs_packing(scene):
        return [Prepared(number=0, system=resolve(scene, path), packing=None)]
    count = 1 if scene.particles.packing is not None else packings or scene.compare.packings
    return [_packed(scene, path, k, cache) for k in range(count)]


def _packed(scene: Scene, path: Path, number: int, cache: Path) -> Prepared:
    packing = make_packing(
        scene.particles, scene.preparation, stiffness=scene.contact.normal.normal_stiffness,
        seed=(scene.particles.seed or 0) + number, cache=cache, scene_folder=path.parent,
    )
    return Prepared(number=number, system=resolve(scene, path, packing), packing=packing)
