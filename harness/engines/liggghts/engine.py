"""LIGGGHTS-PUBLIC, the binary of the Debian package, one child process a run."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.child import last_step, run_child
from harness.engines.facts import is_rough
from harness.engines.liggghts.deck import INPUT, render
from harness.engines.liggghts.defects import DEFECTS
from harness.engines.liggghts.lab import render_prescribed
from harness.engines.liggghts.law import told_history
from harness.engines.liggghts.outcome import judge
from harness.engines.liggghts.output import SERIES
from harness.engines.liggghts.planes import is_primitive, is_still, meshes
from harness.engines.liggghts.support import supports
from harness.engines.protocol import Defect, Probe, RunResult, Support
from harness.scene.contact import HertzNormal, HystereticNormal, VariableHystereticNormal
from harness.scene.system import Constant

if TYPE_CHECKING:
    from harness.scene.system import System
    from postproc.trajectory import Trajectory

BINARY, LOG = "liggghts", "log.liggghts"
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


class Liggghts:
    """The engine; it has no state."""

    name = "liggghts"
    startup_seconds = 0.08
    """Of an empty run, its files cached (measured)."""

    def probe(self) -> Probe:
        """Look for the binary on the path; its version is that of the Debian package, else its banner's."""
        path = shutil.which(BINARY)
        if path is None:
            return Probe(available=False, version="", detail=HOW_TO_GET)
        return Probe(available=True, version=_version(path), detail=path)

    def supports(self, system: System) -> tuple[Support, ...]:
        """Judge every effect the system calls for."""
        return supports(system)

    def render(self, system: System) -> dict[str, str]:
        """Return in.liggghts, packing.data and one STL file for every wall that moves or is oblique."""
        return render(system)

    def command(self, folder: Path) -> list[str]:  # noqa: ARG002
        """Return the command, to be typed in `folder`.

        Without line buffering the last message of an MPI_Abort would be lost in the pipe.
        """
        return ["stdbuf", "-oL", BINARY, "-log", "none", "-in", INPUT]

    def run(self, folder: Path, *, time_limit: float) -> RunResult:
        """Run the deck in `folder`."""
        child = run_child(
            self.command(folder), folder=folder, log=LOG, time_limit=time_limit, env=os.environ | ALONE
        )
        return judge(child, folder, LOG, time_limit)

    def known_defects(self) -> tuple[Defect, ...]:
        """Return what this version does wrong, each shown by a test."""
        return DEFECTS

    def render_prescribed(self, system: System) -> dict[str, str]:
        """Return in.liggghts, packing.data and the STL files; raises ValueError for what moves by itself."""
        return render_prescribed(system)

    def run_prescribed(self, folder: Path, *, time_limit: float) -> RunResult:
        """Drive the bodies along PATH_FILE in a child process."""
        command = ["stdbuf", "-oL", sys.executable, "-m", "harness.engines.liggghts.prescribed", "."]
        child = run_child(command, folder=folder, log=LOG, time_limit=time_limit, env=os.environ | ALONE)
        return replace(judge(child, folder, LOG, time_limit), timings={"run": child.wall_seconds})

    def steps_done(self, folder: Path) -> int:
        """Return the last step in the series."""
        return last_step(folder / SERIES)

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
            rotations=system.rotations,
            history=told_history(system), periodic=system.periodic,
        )

    def microseconds_per_step(self, system: System) -> float:
        """Rough cost, measured on one core with 1950 discs, 4 contacts a disc: 207 smooth, 241 with friction.

        Step overhead, each moving wall, forces and integration by particle; other laws by their measured ratios.
        """
        moving = sum(not is_still(w) for w in system.walls)
        laws = 0.17 * (system.sliding is not None) + 0.2 * (system.rolling is not None)
        law = COST.get(type(system.normal), 1.0) + laws
        return 6.0 + 5.5 * moving + 0.098 * law * len(system.particles)


LIGGGHTS = Liggghts()


@cache
def _version(path: str) -> str:
    return _package_version(path) or _banner_version(path) or "unknown"


def _package_version(path: str) -> str:
    """Return the version of the Debian package that owns the binary, "" elsewhere."""
    owner = _output(["dpkg-query", "--search", str(Path(path).resolve())]).split(":")[0]
    return _output(["dpkg-query", "--show", "--showformat=${Version}", owner]).strip() if owner else ""


def _banner_version(path: str) -> str:
    found = re.search(r"Version (\S+ \S+)", _output([path, "-h"]))
    return found[1] if found else ""


def _output(command: list[str]) -> str:
    """Return what a command prints, "" if it cannot be run, fails or hangs."""
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=20, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.decode("utf-8", errors="replace") if done.returncode == 0 else ""
