"""A small engine of free flight, x = x0 + v t, that can also fail in every way an engine can."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from harness.engines.child import last_step, run_child
from harness.engines.protocol import Probe, RunResult, Support
from harness.scene.contact import LinearNormal
from harness.scene.system import Particles, System, Wall
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import ReadError, Trajectory

SCRIPT = r"""
import json, os, signal, sys, time
mode, journal = sys.argv[1:]

def note(word):
    with open(journal, "a") as f:
        f.write(f"{word} {os.getpid()}\n")

note("begin")
deck = json.load(open("deck.json"))
half = deck["steps"] // 2
frames, series = open("frames.jsonl", "w"), open("series.txt", "w")
for step in range(deck["steps"] + 1):
    time.sleep(0.02 if mode == "slow" else 0)
    t = step * deck["dt"]
    x = [[a + v * t for a, v in zip(xs, vs)] for xs, vs in zip(deck["x"], deck["v"])]
    if step == half and mode == "exit":
        print("ERROR: neighbour list overflow"); sys.exit(3)
    if step == half and mode in ("SIGSEGV", "SIGKILL"):
        os.kill(os.getpid(), getattr(signal, mode))
    if step == half and mode == "hang":
        time.sleep(600)
    if step == half and mode == "full":
        with open("/dev/full", "w") as disk:
            disk.write("x" * 100000)
    if step == half and mode == "cut":
        frames.write('{"step": 6, "x": [[0.1'); break
    if step >= half and mode == "nan":
        x[0][0] = float("nan")
    if step >= half and mode == "lost":
        x.pop()
    if step >= half and mode == "escape":
        x[1][1] = -0.25
    if step % deck["frame_every"] == 0:
        frames.write(json.dumps({"step": step, "time": t, "x": x}) + "\n")
    if step % deck["sample_every"] == 0 and not (mode == "short" and step > half):
        series.write(f"{step} {t!r}\n"); series.flush()
if mode == "big":
    open("dump.txt", "w").write("0.12345678901234567\n" * 100000)
print("finished")
note("end")
"""


@dataclass(frozen=True)
class FakeEngine:
    """Follows harness.engines.protocol.Engine; `journal` is told of every start and end."""

    journal: Path
    mode: str = "complete"
    name: str = "fake"
    version: str = "1.0"
    level: str = "exact"
    available: bool = True
    comment: str = ""
    cost: float = 1.0

    def probe(self) -> Probe:
        return Probe(available=self.available, version=self.version, detail="install fake from nowhere")

    def supports(self, system: System) -> tuple[Support, ...]:
        return (Support(effect="normal", level=self.level, note="see the manual"),)

    def render(self, system: System) -> dict[str, str]:
        plain = {k: getattr(system, k) for k in ("dt", "steps", "sample_every", "frame_every")}
        arrays = {k: getattr(system.particles, k).tolist() for k in ("x", "v")}
        return {"deck.json": json.dumps(plain | arrays | {"comment": self.comment}), "fake.py": SCRIPT}

    def command(self, folder: Path) -> list[str]:
        return [sys.executable, "-I", "-S", "fake.py", self.mode, str(self.journal)]

    def run(self, folder: Path, *, time_limit: float) -> RunResult:
        child = run_child(self.command(folder), folder=folder, log="fake.log", time_limit=time_limit)
        finished = child.returncode == 0 and child.last_lines[-1:] == ("finished",)
        status = "timed_out" if child.timed_out else "completed" if finished else "crashed"
        reason = {"timed_out": f"time limit {time_limit} s", "completed": ""}.get(
            status, child.signal or f"exit status {child.returncode}")
        return RunResult(status=status, reason=reason, last_lines=child.last_lines, cpu_seconds=child.cpu_seconds,
                         wall_seconds=child.wall_seconds, timings={"run": child.wall_seconds})

    def steps_done(self, folder: Path) -> int:
        return last_step(folder / "series.txt")

    def records(self, system: System) -> str:
        return ""

    def resumes(self, folder: Path) -> bool:
        return False

    def read(self, folder: Path, system: System) -> Trajectory:
        if self.mode == "bug":
            raise TypeError("a bug of the reader")
        lines = (folder / "frames.jsonl").read_text().splitlines()
        try:
            records = [json.loads(line) for line in lines]
        except json.JSONDecodeError as error:
            raise ReadError(f"{folder / 'frames.jsonl'}: line {len(lines)}: {error}") from error
        table = np.loadtxt(folder / "series.txt", ndmin=2)
        walls = {f"{w.name}_{p}": np.zeros(len(table)) for w in system.walls for p in ("d", "v", "fx", "fy")}
        return Trajectory(
            frames=tuple(self._frame(r, system) for r in records),
            steps=tuple(r["step"] for r in records),
            series=Columns({"step": table[:, 0], "time": table[:, 1]} | walls, "series"),
        )

    def _frame(self, record: dict, system: System) -> Snapshot:
        x = np.array(record["x"])
        ids = np.arange(1, len(x) + 1)
        particles = {"id": ids, "x": x[:, 0], "y": x[:, 1], "radius": system.particles.radius[: len(x)]}
        points = {"px": [0.0], "py": [0.0], "nx": [0.0], "ny": [1.0], "fx": [0.0], "fy": [0.0]}
        return Snapshot(time=record["time"], dimension=2, particles=Columns(particles, "particles"),
                        walls=Columns({"id": [1], **points}, "walls"))

    def microseconds_per_step(self, system: System) -> float:
        return self.cost


def flight(steps: int = 12, vx: float = 1.5) -> System:
    """Two particles that fly in parallel above a floor and meet nothing."""
    return System(
        dimension=2,
        particles=Particles(
            x=np.array([[0.0, 1.0], [0.0, 3.0]]), radius=np.array([0.1, 0.2]), mass=np.ones(2),
            inertia_factor=np.full(2, 0.4), v=np.array([[vx, 0.0], [-vx, 0.25]]), spin=np.zeros((2, 1)),
        ),
        walls=(Wall(index=1, name="floor", point=(0.0, 0.0), normal=(0.0, 1.0), friction=False),),
        normal=LinearNormal(normal_stiffness=1e4, normal_damping=0.0, attraction="allowed"),
        sliding=None, background=None, gravity=None, periodic=None,
        dt=1e-3, steps=steps, sample_every=2, frame_every=3, contacts=False, scene_name="flight",
    )


@pytest.fixture
def system() -> System:
    return flight()


@pytest.fixture
def make_system():
    return flight


@pytest.fixture
def journal(tmp_path) -> Path:
    return tmp_path / "journal"


@pytest.fixture
def engine(journal) -> FakeEngine:
    return FakeEngine(journal)


@pytest.fixture
def in_mode(engine):
    """in_mode("nan") is the engine that writes NaN, and so on."""
    return lambda mode, **changes: replace(engine, mode=mode, **changes)


@pytest.fixture
def begun(journal):
    """begun() is the number of times the engine's process was started."""
    return lambda: journal.read_text().count("begin") if journal.exists() else 0


@pytest.fixture
def root(tmp_path) -> Path:
    return tmp_path / "runs"


@pytest.fixture
def driver():
    """The start of a Python script that has FakeEngine and flight, for tests of whole processes."""
    return (
        "import importlib.util, sys\n"
        "from pathlib import Path\n"
        f"spec = importlib.util.spec_from_file_location('fake', {str(Path(__file__))!r})\n"
        "fake = importlib.util.module_from_spec(spec)\n"
        "sys.modules['fake'] = fake\n"
        "spec.loader.exec_module(fake)\n"
        "root, journal, mode = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]\n"
        "engine = fake.FakeEngine(journal, mode)\n"
    )
