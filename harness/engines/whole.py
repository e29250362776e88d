"""Engines in timing sessions on the decks that runs have: walls that move and rings included, output left out.

`harness.engines.timed` is what `grainproof bench` compares codes with: the least that each can do for fixed walls.
Here a step costs what a step of a run costs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from harness.engines.kernel import whole as kernel
from harness.engines.lammps import whole as lammps
from harness.engines.liggghts import whole as liggghts
from harness.engines.word import code_of
from reference.kernel.conventions import NAMED as CONVENTIONS

if TYPE_CHECKING:
    from harness.engines.protocol import Probe
    from harness.scene.system import System

LATER = 10**9
"""Steps after which the decks of a session would first write something: never."""

WHOLE = {"lammps": lammps.WHOLE, "liggghts": liggghts.WHOLE}
IN_PLACE = {"lammps": lammps.IN_PLACE, "liggghts": liggghts.IN_PLACE, "kernel": kernel.IN_PLACE}


class Whole(Protocol):
    """One engine; command and environment as `harness.engines.session.Session` wants them."""

    name: str

    def probe(self) -> Probe:
        """Say whether the engine can run here, and its version."""

    def refusal(self, system: System) -> str:
        """Return why the engine does not compute this system, "" if it does."""

    def render(self, system: System) -> dict[str, str]:
        """Return deck files by name, of a system made by `quiet`."""

    def command(self, core: int | None) -> list[str]:
        """Return the child's command, to be started in the deck's folder."""

    def environment(self) -> dict[str, str]:
        """Return the child's environment: one thread."""


def whole(engine: str) -> Whole | None:
    """Return what is timed as the engine of this name; None for one elsewhere or on several processes."""
    if engine in WHOLE:
        return WHOLE[engine]
    family, _, convention = engine.partition(":")
    return kernel.WholeKernel(convention=convention) if family == "kernel" and convention in CONVENTIONS else None


def quiet(system: System) -> System:
    """Return the system without any output."""
    return system.with_(steps=LATER, sample_every=LATER, frame_every=LATER, contacts=False, rotations=False)


def in_place(engine: str) -> Mapping[str, tuple[tuple[str, ...], str]]:
    """Return what an engine's deck keeps while an effect is off, by effect: words, and why they must."""
    return IN_PLACE.get(code_of(engine).partition(":")[0], {})


def at_zero(engine: str, effect: str) -> str:
    """Return why an effect with its coefficient at zero is not the effect switched off on an engine, "" if it is."""
    family, _, convention = code_of(engine).partition(":")
    return kernel.AT_ZERO.get((effect, convention), "") if family == "kernel" else ""
