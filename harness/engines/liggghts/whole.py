"""LIGGGHTS in a timing session on the deck that a run has, walls that move and rings included."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.engines.liggghts.bench import DIMENSION, TIMED
from harness.engines.liggghts.deck import INPUT
from harness.engines.liggghts.engine import LIGGGHTS
from harness.engines.timed import refused

if TYPE_CHECKING:
    from harness.engines.protocol import Probe
    from harness.scene.system import System


class WholeLiggghts:
    """It has no state; the child is that of `grainproof bench`."""

    name = "liggghts"

    def probe(self) -> Probe:
        """See the engine."""
        return LIGGGHTS.probe()

    def refusal(self, system: System) -> str:
        """As the engine judges."""
        return refused(LIGGGHTS.supports(system))

    def render(self, system: System) -> dict[str, str]:
        """Return the engine's own deck up to its last run; a step of length 0 before it belongs to the set-up."""
        files = LIGGGHTS.render(system)
        lines = files[INPUT].splitlines(keepends=True)
        last = max(k for k, line in enumerate(lines) if line.startswith("run "))
        return files | {INPUT: "".join(lines[:last]), DIMENSION: f"{system.dimension}\n"}

    def command(self, core: int | None) -> list[str]:
        """Return the child's command."""
        return TIMED.command(core)

    def environment(self) -> dict[str, str]:
        """One thread, one process."""
        return TIMED.environment()


WHOLE = WholeLiggghts()

IN_PLACE = {
    "normal damping": ((), "the model insists on its dashpot's constant: it says no damping"),
    "adhesion": ((), "the model insists on its constant: it is 0"),
    "damping attraction": (("limitForce", "on"), "to clip is the word: without it the dashpot may pull"),
}
"""What stands in the deck while an effect is off, by effect: words, and why they must."""
