"""What a user asks of the effects of a scene: quantities, a tolerance, which effects, whose answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.registry import choose_engines, find_engine
from harness.errors import InputError
from harness.scene.describe import nearest
from harness.scene.effects import EFFECTS
from harness.scene.judged import MOST_PACKINGS
from harness.scene.model import Biaxial, Couette, Free, Scene
from harness.studies.effects.quantities import named_quantities
from harness.studies.prepare import draws_packings

if TYPE_CHECKING:
    from harness.engines.protocol import Engine

ENGINES = ("lammps", "liggghts", "kernel:talk")
"""Timed and checked unless the user says otherwise."""

BY = "kernel:talk"
"""Answers with every effect: it has them all."""

PACKINGS: dict[type, int] = {Biaxial: 4, Couette: 1, Free: 1}
"""Usual number: of boxes as many as tell a spread in a few minutes; a ring's time averages have errors of their own."""

TOLERANCE: dict[type, float] = {Biaxial: 0.05, Couette: 0.05, Free: 0.01}
"""Usual tolerance: of boxes and rings the margin of `grainproof compare`."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """A checked request. quantities: by which effects are judged. only: effects that are switched, all if empty.

    engines: timed and checked. by: the one whose answers are compared.
    """

    quantities: tuple[str, ...]
    tolerance: float
    only: tuple[str, ...]
    engines: tuple[Engine, ...]
    by: Engine
    packings: int


def asked(
    scene: Scene, file: Path, *, quantities: Sequence[str] | None, tolerance: float | None,
    only: Sequence[str] | None, engines: Sequence[str] | None, by: str | None, packings: int | None,
) -> Asked:
    """Return what is to be done. Raises InputError for what this scene does not have."""
    return Asked(
        quantities=asked_quantities(scene, quantities), tolerance=asked_tolerance(scene, tolerance),
        only=_effects(only), engines=choose_engines(list(engines or ENGINES)), by=find_engine(by or BY, option="--by"),
        packings=_packings(scene, packings, file),
    )


def asked_quantities(scene: Scene, names: Sequence[str] | None) -> tuple[str, ...]:
    """Return the quantities; raises InputError for one that the scene does not have."""
    known = named_quantities(scene)
    if not names:
        return known[:1]
    for name in names:
        if name not in known:
            raise InputError(
                file="--quantity", expected=f"one of {', '.join(known)}", got=name or "nothing",
                fix=nearest(name, list(known)),
            )
    return tuple(dict.fromkeys(names))


def asked_tolerance(scene: Scene, tolerance: float | None) -> float:
    """Return the tolerance, a part of a quantity; raises InputError for none."""
    value = TOLERANCE[type(scene)] if tolerance is None else tolerance
    if not 0.0 < value < 1.0:
        raise InputError(
            file="--tolerance", expected="a number > 0 and < 1, as a part of the quantity", got=f"{value:g}",
            fix="0.05 is five per cent" if value >= 1.0 else "",
        )
    return value


def _effects(names: Sequence[str] | None) -> tuple[str, ...]:
    """Return effects by their name, which may be written with _ or - for blanks."""
    found = []
    for name in names or ():
        plain = name.replace("_", " ").replace("-", " ").strip().lower()
        if plain not in EFFECTS:
            raise InputError(
                file="--effect", expected=f"one of {', '.join(EFFECTS)}", got=name, fix=nearest(plain, list(EFFECTS))
            )
        found.append(plain)
    return tuple(dict.fromkeys(found))


def _packings(scene: Scene, packings: int | None, file: Path) -> int:
    if packings is None:
        return PACKINGS[type(scene)] if draws_packings(scene) else 1
    if packings > 1 and not draws_packings(scene):
        raise InputError(
            file="--packings", expected="1, as this scene's particles are not drawn at random", got=packings,
            fix=f"{file} has one start",
        )
    if not 1 <= packings <= MOST_PACKINGS:
        raise InputError(file="--packings", expected=f"a number from 1 to {MOST_PACKINGS}", got=packings)
    return packings
