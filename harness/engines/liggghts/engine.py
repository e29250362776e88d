"""LIGGGHTS-PUBLIC, the binary of the Debian package, one child process a run."""

from __future__ import annotations

import shutil
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.engines.child import last_step, one_thread_env, run_child
from harness.engines.facts import is_rough
from harness.engines.glued import glued, read_as
from harness.engines.liggghts.deck import INPUT, render
from harness.engines.liggghts.defects import DEFECTS
from harness.engines.liggghts.home import BINARY, HERE, LIBRARY, Home, home_at, launcher, version_of
from harness.engines.liggghts.lab import render_prescribed
from harness.engines.liggghts.law import told_history
from harness.engines.liggghts.outcome import judge
from harness.engines.liggghts.output import SERIES
from harness.engines.liggghts.planes import is_primitive, is_still, meshes
from harness.engines.liggghts.support import supports
from harness.engines.protocol import Defect, Probe, RunResult, Support
from harness.engines.recorded import records_sliding
from harness.engines.word import named
from harness.scene.contact import HertzNormal, HystereticNormal, VariableHystereticNormal
from harness.scene.system import Constant

if TYPE_CHECKING:
    from harness.scene.system import System
    from postproc.trajectory import Trajectory

LOG = "log.liggghts"
ALONE = {
    "OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_pml": "ob1", "OMPI_MCA_btl": "self",
    "OMPI_MCA_orte_create_session_dirs": "0",
}
"""One process has nobody to talk to: Open MPI starts in 0.1 s instead of 0.5 s. No effect on results.

Isolated processes would share one session folder below /tmp, and one that ends removes it while another starts: 1 of
600 starts side by side failed in MPI_Init (measured), none without such folders.
"""

COST = {HertzNormal: 1.2, HystereticNormal: 1.84, VariableHystereticNormal: 1.09}
"""Of normal laws, relative to the linear one."""

HOW_TO_GET = "apt-get install -y --no-install-recommends liggghts"
HOW_TO_GET_MPI = "apt-get install -y --no-install-recommends openmpi-bin"

SIDE_BY_SIDE = (
    "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1",
    "--mca", "btl", "self,vader", "--mca", "pml", "ob1",
)
"""Processes of one run, all on this machine: they stay on the cores that this process may use, and one that waits for
another leaves its core to it."""


@dataclass(frozen=True, kw_only=True)
class Liggghts:
    """The binary on the path, or one at another `home`; one child process a run, or `ranks` of them under MPI."""

    home: Home = HERE
    ranks: int = 1
    startup_seconds: ClassVar[float] = 0.08
    """Of an empty run, its files cached (measured)."""

    @property
    def name(self) -> str:
        """Name in tables and run folders: the version stands for the place."""
        return named("liggghts", self.home.shown or self.home.version, self.ranks)

    @property
    def word(self) -> str:
        """What a user types for it."""
        return named("liggghts", self.home.place, self.ranks)

    def at(self, place: str) -> Liggghts:
        """Return the LIGGGHTS of another binary; raises InputError when it is none."""
        return replace(self, home=home_at(place))

    def on(self, ranks: int) -> Liggghts:
        """Return the same LIGGGHTS on so many MPI processes."""
        return replace(self, ranks=ranks)

    def exactly(self) -> Liggghts:
        """Return the same LIGGGHTS, with its build in its name; the one here has none and stays."""
        home = self.home
        return replace(self, home=replace(home, shown=f"{home.version}+{home.build}")) if home.place else self

    def probe(self) -> Probe:
        """Look for the binary on the path; its version is that of the Debian package, else its banner's."""
        found = self._probe_home() if self.home.place else _probe_path()
        if self.ranks > 1 and found.available and launcher() is None:
            return Probe(available=False, version=found.version, detail=f"mpirun is missing: {HOW_TO_GET_MPI}")
        return found

    def _probe_home(self) -> Probe:
        """The version has the build behind it: what another build of the same version computed is another run."""
        home = self.home
        detail = ", ".join(p for p in (home.place, home.library) if p)
        return Probe(available=True, version=f"{home.version}+{home.build}", detail=detail)

    def supports(self, system: System) -> tuple[Support, ...]:
        """Judge every effect the system calls for."""
        return supports(system, self.ranks)

    def render(self, system: System) -> dict[str, str]:
        """Return in.liggghts, packing.data and one STL file for every wall that moves or is oblique."""
        return render(system, self.ranks)

    def command(self, folder: Path) -> list[str]:  # noqa: ARG002
        """Return the command, to be typed in `folder`.

        Without line buffering the last message of an MPI_Abort would be lost in the pipe.
        """
        alone = ["stdbuf", "-oL", self.home.binary(), "-log", "none", "-in", INPUT]
        return alone if self.ranks == 1 else [launcher() or "mpirun", *SIDE_BY_SIDE, "-np", str(self.ranks), *alone]

    def run(self, folder: Path, *, time_limit: float) -> RunResult:
        """Run the deck in `folder`."""
        child = run_child(
            self.command(folder), folder=folder, log=LOG, time_limit=time_limit,
            env=one_thread_env() | (ALONE if self.ranks == 1 else {}),
        )
        return judge(child, folder, LOG, time_limit)

    def changes(self, system: System) -> tuple[str, ...]:  # noqa: ARG002
        """No version but 3.8.0 was measured."""
        return ()

    def known_defects(self) -> tuple[Defect, ...]:
        """Return what this version does wrong, each shown by a test."""
        return DEFECTS

    def render_prescribed(self, system: System) -> dict[str, str]:
        """Return in.liggghts, packing.data and the STL files; raises ValueError for what moves by itself."""
        return render_prescribed(system)

    def run_prescribed(self, folder: Path, *, time_limit: float) -> RunResult:
        """Drive the bodies along PATH_FILE in a child process."""
        if self.home.place and not self.home.library:
            return _without_library(self.home.place)
        library = [self.home.library] if self.home.place else []
        command = ["stdbuf", "-oL", sys.executable, "-m", "harness.engines.liggghts.prescribed", ".", *library]
        child = run_child(command, folder=folder, log=LOG, time_limit=time_limit, env=one_thread_env() | ALONE)
        return replace(judge(child, folder, LOG, time_limit), timings={"run": child.wall_seconds})

    def steps_done(self, folder: Path) -> int:
        """Return the last step in the series."""
        return last_step(folder / SERIES)

    def records(self, system: System) -> str:
        """Where a spring slides, its output has a dashpot besides, which did not act."""
        return records_sliding(system)

    def resumes(self, folder: Path) -> bool:  # noqa: ARG002
        """A restart of LIGGGHTS changes bits, as its set-up evaluates all forces anew, like that of LAMMPS."""
        return False

    def read(self, folder: Path, system: System) -> Trajectory:
        """Turn series and dumps into a trajectory; raises ReadError."""
        from postproc.readers.liggghts import LiggghtsWall, read_liggghts

        walls = [
            LiggghtsWall(
                index=w.index, name=w.name, point=w.point, normal=w.normal, moves=not is_still(w),
                velocity=w.motion.velocity if isinstance(w.motion, Constant) else None,
                rough=is_rough(system, w), mesh=None if is_primitive(system, w) else meshes(system).index(w),
            )
            for w in system.walls
        ]
        return read_liggghts(
            folder, walls=walls, dimension=system.dimension, dt=system.dt, sample_every=system.sample_every,
            inertia_factor=system.particles.inertia_factor, contacts=system.contacts,
            rotations=system.rotations, rings=read_as(system),
            history=told_history(system), periodic=system.periodic,
        )

    def microseconds_per_step(self, system: System) -> float:
        """Rough cost, measured on one core with 1950 discs, 4 contacts a disc: 207 smooth, 241 with friction.

        Step overhead, each moving wall, forces and integration by particle; other laws by their measured ratios;
        glued discs 0.02 (893 more of them in a Couette ring: 17).
        """
        moving = sum(not is_still(w) for w in system.walls)
        laws = 0.17 * (system.sliding is not None) + 0.2 * (system.rolling is not None)
        law = COST.get(type(system.normal), 1.0) + laws
        return 6.0 + 5.5 * moving + 0.098 * law * len(system.particles) + 0.02 * len(glued(system))


LIGGGHTS = Liggghts()


def _probe_path() -> Probe:
    path = shutil.which(BINARY)
    if path is None:
        return Probe(available=False, version="", detail=HOW_TO_GET)
    return Probe(available=True, version=version_of(path), detail=path)


def _without_library(binary: str) -> RunResult:
    """Prescribed motion leads the bodies through the library's C interface."""
    reason = f"{binary} loads no {LIBRARY}: prescribed motion needs LIGGGHTS as a shared library"
    return RunResult(status="crashed", reason=reason, last_lines=(), cpu_seconds=0.0, wall_seconds=0.0)
