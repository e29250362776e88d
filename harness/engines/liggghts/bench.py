"""LIGGGHTS in a timing session, through its C library."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from harness.engines.child import one_thread_env
from harness.engines.liggghts.deck import (
    DATA,
    INPUT,
    drag_lines,
    flat_lines,
    gravity_lines,
    neighbour_lines,
    opening_lines,
)
from harness.engines.liggghts.domain import domain_of
from harness.engines.liggghts.engine import ALONE, LIGGGHTS
from harness.engines.liggghts.law import law_lines
from harness.engines.liggghts.packing import packing_data
from harness.engines.liggghts.planes import meshes
from harness.engines.liggghts.walls import wall_lines
from harness.engines.rounds import core_word
from harness.engines.text import number
from harness.engines.timed import refused, ring_refusal

if TYPE_CHECKING:
    from harness.engines.protocol import Probe
    from harness.scene.system import System

DIMENSION = "dimension.txt"
STORING = " store_force yes"
"""Of a wall's fix: it serves output only."""


class TimedLiggghts:
    """It has no state."""

    name = "liggghts"
    slow = False
    note = "pair gran; primitive walls; friction in its own convention"

    def probe(self) -> Probe:
        """See the engine."""
        return LIGGGHTS.probe()

    def refusal(self, system: System) -> str:
        """As the engine judges."""
        missing = refused(LIGGGHTS.supports(system)) or ring_refusal(system)
        return missing or ("only fixed walls across an axis are timed" if meshes(system) else "")

    def render(self, system: System, *, skin: float) -> dict[str, str]:
        """Return a deck without output and the particles."""
        domain = domain_of(system)
        lines = [
            *opening_lines(system, domain), *neighbour_lines(system, domain), f"neighbor {number(skin)} bin",
            *law_lines(system), "", "fix integrate grains nve/sphere", *drag_lines(system), *gravity_lines(system),
            *(line.replace(STORING, "") for line in wall_lines(system)), *flat_lines(system, domain),
            "", f"timestep {number(system.dt)}", "thermo_style custom step atoms", "thermo_modify lost error",
            "thermo 1000000000",
        ]
        return {
            INPUT: "\n".join(lines) + "\n", DATA: packing_data(system, domain), DIMENSION: f"{system.dimension}\n",
        }

    def command(self, core: int | None) -> list[str]:
        """Return the child's command."""
        return [sys.executable, "-m", "harness.engines.liggghts.bench_child", core_word(core)]

    def environment(self) -> dict[str, str]:
        """One thread, one process."""
        return one_thread_env() | ALONE


TIMED = TimedLiggghts()
