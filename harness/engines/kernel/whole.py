"""The kernel in a timing session on the deck that a run has, its list of pairs as long as a run's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from harness.engines.kernel.bench import SKIN, TimedKernel
from harness.engines.kernel.deck import render_deck

if TYPE_CHECKING:
    from harness.engines.protocol import Probe
    from harness.scene.system import System


@dataclass(frozen=True, kw_only=True)
class WholeKernel:
    """The program in one convention."""

    convention: str

    @property
    def name(self) -> str:
        """Name of the engine."""
        return f"kernel:{self.convention}"

    def probe(self) -> Probe:
        """Always there."""
        return self._timed.probe()

    def refusal(self, system: System) -> str:
        """As the engine judges; what has no program is not timed."""
        return self._timed.refusal(system)

    def render(self, system: System) -> dict[str, str]:
        """Return the engine's own deck; no skin of its own."""
        return render_deck(system, self.convention) | {SKIN: "null\n"}

    def command(self, core: int | None) -> list[str]:
        """Return the child's command."""
        return self._timed.command(core)

    def environment(self) -> dict[str, str]:
        """One thread."""
        return self._timed.environment()

    @property
    def _timed(self) -> TimedKernel:
        return TimedKernel(name=self.name, evaluation="program", convention=self.convention, note="")


NO_RUBBING = (("False",), "every wall says whether it rubs: none does when no law turns particles any more")

IN_PLACE = {
    **dict.fromkeys(("sliding friction", "rolling resistance", "torsion resistance"), NO_RUBBING),
    "damping attraction": (
        ("clipped", "normal damping: maximum"),
        "to clip is the word, and an operation: without it the dashpot may pull"
    ),
    "normal damping": (
        (), "the law's table names all its numbers: this one says no damping, and no operation reads it"
    ),
    "wall friction": (
        ("False", "rotation: fill"),
        "every wall says whether it rubs; in the arrays of torques rows of smooth contacts are filled with 0"
    ),
    "adhesion": ((), "the law's table names all its numbers: this one is 0, and no operation reads it"),
}
"""What stands in the deck while an effect is off, by effect: words, and why they must."""

LATE = (
    "with a dynamic coefficient a sliding contact is tested with the spring as the coming step would stretch it, "
    "without one with the spring as it is: a difference of order dt, documented in reference.kernel.laws.slider"
)
AT_ZERO = {("dynamic friction", convention): LATE for convention in ("talk", "corrected")}
"""Where a coefficient at zero is not the effect switched off, by effect and convention, and why."""
