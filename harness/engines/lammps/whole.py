"""LAMMPS in a timing session on the deck that a run has, walls that move and rings included."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.engines.lammps.bench import GRANULAR
from harness.engines.lammps.child import split_deck
from harness.engines.lammps.engine import LAMMPS
from harness.engines.lammps.files import DECK
from harness.engines.timed import refused

if TYPE_CHECKING:
    from harness.engines.protocol import Probe
    from harness.scene.system import System


class WholeLammps:
    """It has no state; the child is that of `grainproof bench`."""

    name = "lammps"

    def probe(self) -> Probe:
        """See the engine."""
        return LAMMPS.probe()

    def refusal(self, system: System) -> str:
        """As the engine judges."""
        return refused(LAMMPS.supports(system))

    def render(self, system: System) -> dict[str, str]:
        """Return the engine's own deck up to its first run."""
        files = LAMMPS.render(system)
        return files | {DECK: split_deck(files[DECK])[0]}

    def command(self, core: int | None) -> list[str]:
        """Return the child's command."""
        return GRANULAR.command(core)

    def environment(self) -> dict[str, str]:
        """One thread."""
        return GRANULAR.environment()


WHOLE = WholeLammps()

NO_SPINS = ("integrate", "grains", "nve")
NO_TANGENT = "pair granular insists on a tangential model; this one, with 0 0, has neither force nor history"
PLAIN = "where nothing turns the integrator without spins takes the other's place"

IN_PLACE = {
    "sliding friction": (("linear_nohistory", *NO_SPINS), f"{NO_TANGENT}; {PLAIN}"),
    "wall friction": (("linear_nohistory",), NO_TANGENT),
    "rolling resistance": (NO_SPINS, PLAIN),
    "torsion resistance": (NO_SPINS, PLAIN),
    "normal damping": ((), "pair granular insists on a damping model (none is refused): its number says no damping"),
    "damping attraction": (("limit_damping",), "to clip is the word: without it the dashpot may pull"),
}
"""What stands in the deck while an effect is off, by effect: words, and why they must."""
