"""Run the reference kernel as a child process, in a named convention.

`kernel:lammps` and `kernel:liggghts` are the kernel doing what these codes do, `kernel:talk` follows
the algorithm of the talks, `kernel:corrected` their laws in a second-order scheme. They are four engines, because they
compute four different things.
"""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.engines.child import Child, last_step, run_child
from harness.engines.kernel.deck import render_deck
from harness.engines.protocol import Defect, Probe, RunResult, Support
from harness.engines.recorded import records_sliding

if TYPE_CHECKING:
    from harness.scene.system import System
    from postproc.trajectory import Trajectory

LOG = "log.kernel"
UNSTABLE = 3
"""Exit status by which the kernel says that it stopped a run that left its laws' range."""


@dataclass(frozen=True, kw_only=True)
class KernelEngine:
    """The kernel in one convention; `name` is ``kernel:<convention>``."""

    convention: str
    startup_seconds: ClassVar[float] = 0.4
    """Of an empty run: Python, NumPy, SciPy and h5py, their files cached (measured)."""

    @property
    def name(self) -> str:
        """Name of the engine in tables and run folders."""
        return f"kernel:{self.convention}"

    def probe(self) -> Probe:
        """The kernel is part of this project: always there."""
        import numpy

        version = f"{_source_digest()}+numpy{numpy.__version__}"
        return Probe(available=True, version=version, detail="reference.kernel, part of grainproof")

    def supports(self, system: System) -> tuple[Support, ...]:
        """Every effect is computed exactly, with any moment of inertia, but for laws that the kernel does not have."""
        from harness.scene.effects import effects_on

        missing = _missing_laws(system)
        exact = f"convention {self.convention}"
        return tuple(
            Support(effect=e, level="unsupported", note=missing[e]) if e in missing
            else Support(effect=e, level="exact", note=exact)
            for e in effects_on(system)
        )

    def known_defects(self) -> tuple[Defect, ...]:
        """None is known: what is found is mended."""
        return ()

    def render(self, system: System) -> dict[str, str]:
        """Return kernel.json, particles.csv and, with rings, rings.csv."""
        return render_deck(system, self.convention)

    def command(self, folder: Path) -> list[str]:
        """Return the command that runs the deck."""
        return [sys.executable, "-m", "reference.kernel", str(folder)]

    def run(self, folder: Path, *, time_limit: float) -> RunResult:
        """Run the deck in `folder` in a child process."""
        return _outcome(self.command(Path(".")), folder, time_limit)

    def render_prescribed(self, system: System) -> dict[str, str]:
        """Return the deck without what moves bodies. Raises ValueError for walls that move and for rings."""
        if system.rings or any(w.motion is not None for w in system.walls):
            raise ValueError("prescribed motion knows fixed planes only")
        return render_deck(system.with_(gravity=None, background=None), self.convention)

    def run_prescribed(self, folder: Path, *, time_limit: float) -> RunResult:
        """Drive the bodies along the path in `folder` in a child process."""
        return _outcome([sys.executable, "-m", "reference.kernel.prescribed", "."], folder, time_limit)

    def steps_done(self, folder: Path) -> int:
        """Return the last sampled step."""
        return last_step(folder / "series.csv")

    def records(self, system: System) -> str:
        """In the conventions of LIGGGHTS contacts are recorded as LIGGGHTS does."""
        return records_sliding(system) if self.convention == "liggghts" else ""

    def resumes(self, folder: Path) -> bool:
        """A run with a checkpoint does, unless the killed run's process is still there."""
        from reference.kernel.checkpoint import CHECKPOINT, owned

        return (folder / CHECKPOINT).exists() and not owned(folder)

    def read(self, folder: Path, system: System) -> Trajectory:
        """Read frames.h5 and series.csv."""
        from postproc.readers.kernel import read_kernel

        return read_kernel(folder, periodic=system.periodic)

    def microseconds_per_step(self, system: System) -> float:
        """Rough cost of the program, measured on one core: dispatch, and a share a particle by law and dimension.

        2D, N = 200 and 1950: smooth 29 and 93, sliding 39 and 160, rolling besides 44 and 205; 3D, N = 2000: 206,
        570, 880, torsion besides 920. The normal law hardly matters. The second-order scheme takes 1.3 times that;
        where it has no program the textbook runs: 220 and 410 with two laws at N = 1, 3970 in 3D with rolling.
        """
        laws = [family for family in PER_PARTICLE if getattr(system, family) is not None]
        share = sum(PER_PARTICLE[family][system.dimension] for family in laws)
        cost = 17.0 + 5.0 * len(laws) + share * len(system.particles)
        if self.convention != "corrected":
            return cost
        return 1.3 * cost if _has_corrections(system) else 100.0 * len(laws) + 4.5 * cost


PER_PARTICLE = {
    "normal": {2: 0.038, 3: 0.092}, "sliding": {2: 0.033, 3: 0.18}, "rolling": {2: 0.022, 3: 0.15},
    "torsion": {2: 0.0, 3: 0.02},
}
"""Microseconds a step and particle at 4 contacts a disc, 5 a sphere, by family of laws and dimension."""


KERNELS = tuple(KernelEngine(convention=c) for c in ("lammps", "liggghts", "talk", "corrected"))


@cache
def _source_digest() -> str:
    """Hash of the kernel's own source: a run of yesterday's kernel is not a run of today's."""
    import reference.kernel

    sources = sorted(Path(reference.kernel.__file__).parent.rglob("*.py"))
    return "src" + hashlib.sha256(b"".join(p.read_bytes() for p in sources)).hexdigest()[:10]


def _missing_laws(system: System) -> dict[str, str]:
    """Return why, by the names of effects, for the laws that are not in the kernel."""
    from harness.scene.laws import word
    from reference.kernel.laws.registry import LAWS

    law = word(system.normal)
    why = "contacts that hold on beyond overlap zero: the kernel ends a contact with its overlap"
    return {} if law in LAWS["normal"] else {f"normal contact: {law}": why}


def _has_corrections(system: System) -> bool:
    """Whether the program composes the second-order scheme of these laws."""
    from harness.scene.laws import word
    from reference.kernel.laws.registry import LAWS
    from reference.kernel.program.compose import CORRECTED

    couples = system.rolling is not None or system.torsion is not None
    return not couples and LAWS["normal"].get(word(system.normal)) in CORRECTED


def _outcome(command: list[str], folder: Path, time_limit: float) -> RunResult:
    child = run_child(command, folder=folder, log=LOG, time_limit=time_limit)
    status, reason = _judged(child, time_limit)
    report = _report(child) if status == "completed" else {}
    resumed_at, timings = report.get("resumed_at"), report.get("timings", {})
    return RunResult(
        status=status, reason=reason, last_lines=child.last_lines, wall_seconds=child.wall_seconds, timings=timings,
        cpu_seconds=child.cpu_seconds if resumed_at is None else max(child.cpu_seconds, sum(timings.values())),
        resumed_at=resumed_at, warning=report.get("warning", ""),
    )


def _judged(child: Child, time_limit: float) -> tuple[str, str]:
    if child.timed_out:
        return "timed_out", f"stopped after the time limit of {time_limit:g} s"
    if child.returncode == UNSTABLE:
        return "unstable", child.last_lines[-1] if child.last_lines else "stopped as unstable"
    if child.returncode != 0:
        return "crashed", f"ended by {child.signal or f'exit status {child.returncode}'}"
    if not _report(child).get("finished"):
        return "crashed", "ended without its finished marker"
    return "completed", ""


def _report(child: Child) -> dict:
    try:
        report = json.loads(child.last_lines[-1])
    except (IndexError, json.JSONDecodeError):
        return {}
    return report if isinstance(report, dict) else {}
