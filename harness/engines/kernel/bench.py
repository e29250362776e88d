"""The kernel in a timing session: the program of in-place operations, and the textbook evaluation."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from harness.engines.child import one_thread_env
from harness.engines.kernel.deck import render_deck
from harness.engines.kernel.engine import KernelEngine
from harness.engines.rounds import core_word
from harness.engines.timed import refused

if TYPE_CHECKING:
    from harness.engines.protocol import Probe
    from harness.scene.system import System

CONVENTION = "lammps"
"""So that all that is timed differs from pair granular in rounding only."""

SKIN = "skin.json"


@dataclass(frozen=True, kw_only=True)
class TimedKernel:
    """One of the kernel's two evaluations."""

    name: str
    evaluation: Literal["program", "textbook"]
    slow: bool = False
    note: str
    convention: str = CONVENTION

    def probe(self) -> Probe:
        """Always there."""
        return self._engine.probe()

    def refusal(self, system: System) -> str:
        """The program must have operations for every effect; the textbook must have every law."""
        missing = refused(self._engine.supports(system))
        if missing or self.evaluation == "textbook":
            return missing
        return "" if _composes(system, self.convention) else "the program has no operations for one of its laws yet"

    def render(self, system: System, *, skin: float) -> dict[str, str]:
        """Return the kernel's own deck and the skin."""
        return render_deck(system, self.convention) | {SKIN: json.dumps(skin) + "\n"}

    def command(self, core: int | None) -> list[str]:
        """Return the child's command."""
        return [sys.executable, "-m", "harness.engines.kernel.bench_child", self.evaluation, core_word(core)]

    def environment(self) -> dict[str, str]:
        """One thread."""
        return one_thread_env()

    @property
    def _engine(self) -> KernelEngine:
        return KernelEngine(convention=self.convention)


PROGRAM = TimedKernel(
    name="kernel", evaluation="program", note="the program of in-place operations, in LAMMPS' conventions"
)
TEXTBOOK = TimedKernel(
    name="textbook", evaluation="textbook", slow=True, note="the plain evaluation that the program is held against"
)


def _composes(system: System, convention: str) -> bool:
    """Ask with two of the particles: what operations there are depends on laws, walls and axes alone."""
    import tempfile
    from pathlib import Path

    from reference.kernel.deck import read_deck
    from reference.kernel.program.compose import can_compose

    few = system.particles.rows(slice(2))
    with tempfile.TemporaryDirectory() as folder:
        for name, text in render_deck(system.with_(particles=few), convention).items():
            (Path(folder) / name).write_text(text)
        return can_compose(read_deck(Path(folder))[0])
