"""What the harness asks of an engine, and the values that travel between them.

An engine is one package below `harness.engines` with a module-level object that follows `Engine`;
`harness.engines.registry` lists it. Nothing outside that package names a command of the engine.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Protocol

if TYPE_CHECKING:
    import numpy as np

    from harness.scene.system import System
    from postproc.trajectory import Trajectory

Level = Literal["exact", "equivalent", "partial", "unsupported", "known_wrong"]

PATH_FILE, REACTION_FILE = "path.npz", "reaction.npz"
"""Arrays of `Prescribed` and of `Reaction` by their names, in the run folder."""

REFUSED: tuple[Level, ...] = ("unsupported", "known_wrong")
"""Levels at which a system is not run."""


@dataclass(frozen=True, kw_only=True)
class Probe:
    """Is the engine here? `detail` is the path or library when it is, how to get it when not."""

    available: bool
    version: str
    detail: str


@dataclass(frozen=True, kw_only=True)
class Support:
    """How an engine stands to one effect of a system; `note` names the mapping or the evidence."""

    effect: str
    level: Level
    note: str


@dataclass(frozen=True, kw_only=True)
class Defect:
    """Something an engine computes wrongly, reproduced on a real version: what it is, and what it touches.

    evidence: what was measured, and on which version. avoided: how the decks keep clear of it.
    """

    name: str
    affects: str
    evidence: str
    avoided: str


@dataclass(frozen=True, kw_only=True)
class RunResult:
    """What one child process did; the runs package makes the outcome from it.

    status: "completed" only when the engine's own finished marker was found.
    reason: one line, empty when completed. last_lines: the engine's own last words.
    warning: one line in which an engine that completed says itself that something is wrong; empty if it does not.
    cpu_seconds: user + system time of the child; timings: seconds by phase, at least "run".
    resumed_at: step from which a killed run went on, None for a run in one piece; cpu_seconds are then those of all
    its parts up to checkpoints, wall_seconds those of the last part.
    """

    status: Literal["completed", "unstable", "crashed", "timed_out"]
    reason: str
    last_lines: tuple[str, ...]
    cpu_seconds: float
    wall_seconds: float
    timings: dict[str, float] = field(default_factory=dict)
    resumed_at: int | None = None
    warning: str = ""


@dataclass(frozen=True, kw_only=True)
class Prescribed:
    """A path that bodies are driven along, whatever forces act: S + 1 states, `dt` of the system apart.

    x, v: (S + 1, N, dim) in m, m/s. spin: (S + 1, N, 1 in 2D or 3), rad/s. Row 0 is the set-up, at which nothing
    touches; in every later row the laws see exactly these numbers, histories moving on by dt.
    """

    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray


@dataclass(frozen=True, kw_only=True)
class Reaction:
    """What the laws answered: force (S, N, dim) in N, torque (S, N, 1 or 3) in N m, of rows 1..S."""

    force: np.ndarray
    torque: np.ndarray


class Engine(Protocol):
    """One DEM code. All methods are pure but `run`, which works in the given folder only."""

    name: str

    def probe(self) -> Probe:
        """Say whether the engine can run here, its version, and where it was found."""

    def supports(self, system: System) -> tuple[Support, ...]:
        """Judge every effect the system calls for."""

    def known_defects(self) -> tuple[Defect, ...]:
        """Return what this engine is known to do wrong; empty for an engine without known defects."""

    def render(self, system: System) -> dict[str, str]:
        """Return deck files by name, deterministic, commented, 17 digits."""

    def command(self, folder: Path) -> list[str]:
        """Return the command that runs the deck in `folder`; what a user types to reproduce it."""

    def run(self, folder: Path, *, time_limit: float) -> RunResult:
        """Run the deck that stands in `folder`; never raises for what the engine does."""

    def render_prescribed(self, system: System) -> dict[str, str]:
        """Return the deck files for prescribed motion: particles, walls and laws, but nothing that moves them."""

    def run_prescribed(self, folder: Path, *, time_limit: float) -> RunResult:
        """Drive the bodies of the deck in `folder` along its PATH_FILE and leave REACTION_FILE there."""

    def steps_done(self, folder: Path) -> int:
        """Return the last step the running engine has reported, 0 if none: for progress bars."""

    def records(self, system: System) -> str:
        """Return how contact forces in its output are not those that acted in the step, "" if they are.

        That they belong to full-step velocities, as half a step later, is not meant.
        """

    def resumes(self, folder: Path) -> bool:
        """Say whether `run` goes on, to the same last bit, with what a killed run left in `folder`; else it begins."""

    def read(self, folder: Path, system: System) -> Trajectory:
        """Turn the engine's own output into a trajectory; raises ReadError on damaged files."""

    startup_seconds: float
    """CPU time of a run without steps, measured; for `grainproof scene`."""

    def microseconds_per_step(self, system: System) -> float:
        """Rough expected cost, for `grainproof scene`; a measured figure with its origin in the docstring."""


class Code(Engine, Protocol):
    """An engine that may live elsewhere, as another version, and run on several MPI processes.

    Its name says version and processes, its `word` what a user types for it: place and processes.
    """

    word: str
    ranks: int

    def at(self, place: str) -> Code:
        """Return the code that lives at `place`; raises InputError when it does not."""

    def on(self, ranks: int) -> Code:
        """Return the same code on so many processes of this machine."""

    def changes(self, system: System) -> tuple[str, ...]:
        """Return what this version computes otherwise, as measured, than the one whose decks were proven."""

    def exactly(self) -> Code:
        """Return the same code, with its build in its name."""


def takes(engine: Engine, system: System) -> bool:
    """Return whether the engine computes every effect of the system at least in part."""
    return not any(s.level in REFUSED for s in engine.supports(system))
