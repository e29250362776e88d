"""Shared by the tests of studies, report and command line: a box with exact answers, and engines that fail."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from harness.engines.child import run_child
from harness.engines.protocol import Probe, RunResult, Support
from harness.packing import Packing
from harness.scene.load import load_scene
from harness.scene.model import Biaxial
from harness.scene.resolve import resolve
from harness.scene.system import System
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory

BOX = """
kind = "biaxial"
title = "box"
particles = {count = 9, seed = 1, inertia = "disc", radius = {kind = "uniform", min = 0.9e-3, max = 1.1e-3}, mass = {kind = "sphere", density = 2000.0}}
preparation = {pressure = 100.0, residual_tolerance = 1e-8}
[contact]
normal = {law = "linear", normal_stiffness = 1e5, normal_damping = 0.3, attraction = "allowed"}
sliding = {law = "spring", shear_friction = 0.5, shear_stiffness = 2e4, shear_damping = 0.075}
[top]
final_strain = 0.1
duration = 0.08
[side]
pressure = 100.0
mass = 5e-5
damping = 0.05
[numerics]
dt_fraction = 0.05
[outputs]
samples = 40
frames = 20
contacts = true
rotations = true
[compare]
plateau = [0.05, 0.1]
windows = [{pairs = "same_conventions", strain = 0.02, tolerance = 1e-6}, {pairs = "codes", strain = 0.02, tolerance = 1e-2}]
"""  # noqa: E501
RADIUS, SIDE = 1e-3, 6e-3
"""Of the nine discs and of the box, m."""


@dataclass(frozen=True)
class Start:
    """What a study knows of one packing."""

    number: int
    system: System


@dataclass(frozen=True)
class FinishedRun:
    """What a study knows of one run."""

    engine: str
    packing: int
    trajectory: Trajectory | None


@dataclass(frozen=True)
class Box:
    """Nine discs in a lattice, compressed along y; every curve and every average has an exact answer.

    eps(t) is the cosine of the scene, x = x_0 (1 + eps/2), stress ratio R = 1 + 20 eps, F_right = p z, so
    sigma_xx = p and sigma_zz = p R; the forces are carried by three columns and three rows of contacts.
    """

    folder: Path
    changes: tuple[tuple[str, str], ...] = ()
    file: Path = field(init=False)
    scene: Biaxial = field(init=False)

    def __post_init__(self) -> None:
        text = BOX
        for old, new in self.changes:
            assert old in text
            text = text.replace(old, new)
        file = self.folder / "box.toml"
        file.write_text(text)
        object.__setattr__(self, "file", file)
        object.__setattr__(self, "scene", load_scene(file))

    def changed(self, *changes: tuple[str, str]) -> Box:
        """Return the box of a scene with some words replaced."""
        return Box(self.folder, (*self.changes, *changes))

    @property
    def system(self) -> System:
        y, x = np.meshgrid(*2 * [[RADIUS, 3 * RADIUS, 5 * RADIUS]], indexing="ij")
        packing = Packing(
            x=np.column_stack([x.ravel(), y.ravel()]), radius=np.full(9, RADIUS), box=(SIDE, SIDE), residual=0.0,
            contacts=24, path=self.file,
        )
        return resolve(self.scene, self.file, packing)

    def start(self, number: int = 0) -> Start:
        return Start(number, self.system)

    def trajectory(self, ratio: Callable = lambda eps: 1.0 + 20.0 * eps) -> Trajectory:
        s, p = self.system, self.scene.side.pressure
        step = np.arange(0, s.steps + 1, s.sample_every)
        eps = self.strain(step * s.dt)
        x, z = SIDE * (1 + eps / 2), SIDE * (1 - eps)
        top, right, zero = p * ratio(eps) * x, p * z, np.zeros(len(step))
        columns = {
            "step": step, "time": step * s.dt, "top_d": SIDE * eps, "right_d": -SIDE * eps / 2, "top_fy": top,
            "bottom_fy": -top, "right_fx": right, "left_fx": -right,
        }
        walls = [f"{w}_{c}" for w in ("left", "bottom", "right", "top") for c in ("d", "v", "fx", "fy")]
        series = Columns(dict.fromkeys(walls, zero) | columns, "series")
        every = s.frame_every // s.sample_every
        frames = tuple(self._frame(series, k, x[k], z[k]) for k in range(0, len(step), every))
        return Trajectory(frames=frames, steps=tuple(int(n) for n in step[::every]), series=series)

    def strain(self, time) -> np.ndarray:
        top = self.scene.top
        return top.final_strain / 2 * (1 - np.cos(np.pi * np.asarray(time) / top.duration))

    def _frame(self, series: Columns, k: int, x: float, z: float) -> Snapshot:
        place = np.array([1.0, 3.0, 5.0]) / 6
        row, column = np.meshgrid(place * z, place * x, indexing="ij")
        x9, y9, zero = column.ravel(), row.ravel(), np.zeros(9)
        mass = 4 / 3 * np.pi * 2000.0 * RADIUS**3
        particles = {
            "id": np.arange(1, 10), "x": x9, "y": y9, "radius": np.full(9, RADIUS), "mass": np.full(9, mass),
            "inertia": np.full(9, mass * RADIUS**2 / 2), "vx": zero, "vy": zero, "wz": zero,
            "rotation": 1e-3 * series["time"][k] * np.arange(9),
        }
        fx, fy = series["right_fx"][k], series["top_fy"][k]
        walls = {
            "id": [1, 2, 3, 4], "px": [0.0, 0.0, x, 0.0], "py": [0.0, 0.0, 0.0, z], "nx": [1.0, 0.0, -1.0, 0.0],
            "ny": [0.0, 1.0, 0.0, -1.0], "fx": [-fx, 0.0, fx, 0.0], "fy": [0.0, -fy, 0.0, fy],
        }
        return Snapshot(
            time=float(series["time"][k]), dimension=2, particles=Columns(particles, "particles"),
            contacts=_lattice_contacts(x9, y9, x, z, fx, fy), walls=Columns(walls, "walls"),
            box=np.array([[0.0, x], [0.0, z]]),
        )


def _lattice_contacts(x9, y9, x: float, z: float, fx: float, fy: float) -> Columns:
    """Rows carry fx/3 each, columns fy/3; disc n is in row n // 3, column n % 3; force on i, which is pushed away."""
    rows = []
    for n in range(9):
        if n % 3 < 2:
            rows.append((n + 1, n + 2, (x9[n] + x9[n + 1]) / 2, y9[n], -fx / 3, 0.0))
        if n // 3 < 2:
            rows.append((n + 1, n + 4, x9[n], (y9[n] + y9[n + 3]) / 2, 0.0, -fy / 3))
    rows += [(n + 1, -1, 0.0, y9[n], fx / 3, 0.0) for n in (0, 3, 6)]
    rows += [(n + 1, -3, x, y9[n], -fx / 3, 0.0) for n in (2, 5, 8)]
    rows += [(n + 1, -2, x9[n], 0.0, 0.0, fy / 3) for n in (0, 1, 2)]
    rows += [(n + 1, -4, x9[n], z, 0.0, -fy / 3) for n in (6, 7, 8)]
    table = dict(zip(("i", "j", "px", "py", "fx", "fy"), np.array(rows).T, strict=True))
    table |= {"overlap": np.hypot(table["fx"], table["fy"]) / 1e5, "ux": np.zeros(24), "uy": np.zeros(24)}
    return Columns(table, "contacts")


def with_series(trajectory: Trajectory, **columns) -> Trajectory:
    """Return the trajectory with columns of its series replaced; a function gets the old values."""
    old = trajectory.series
    new = {name: value(old[name]) if callable(value) else value for name, value in columns.items()}
    return replace(trajectory, series=Columns(dict(old) | new, "series"))


def with_column(trajectory: Trajectory, group: str, name: str, change: Callable) -> Trajectory:
    """Return the trajectory with a column of all its frames changed."""

    def changed(frame: Snapshot) -> Snapshot:
        table = getattr(frame, group)
        return replace(frame, **{group: Columns(dict(table) | {name: change(table[name])}, group)})

    return replace(trajectory, frames=tuple(changed(f) for f in trajectory))


def shifted(trajectory: Trajectory, *groups: str) -> Trajectory:
    """Return the trajectory in which frame k shows the tables (and the box) of frame k - 1."""
    frames = trajectory.frames
    before = (frames[0], *frames[:-1])
    return replace(trajectory, frames=tuple(
        replace(f, **{g: getattr(b, g) for g in groups}) for f, b in zip(frames, before, strict=True)
    ))


@pytest.fixture
def box(tmp_path) -> Box:
    return Box(tmp_path)


@pytest.fixture
def mutate():
    """mutate.series, mutate.column and mutate.shift return a wrong copy of a trajectory."""

    class Mutate:
        series, column, shift = staticmethod(with_series), staticmethod(with_column), staticmethod(shifted)

    return Mutate


@pytest.fixture
def finished():
    return FinishedRun


# --- engines that do as they are told ------------------------------------------------------------

FLIGHT = """
kind = "free"
title = "flight"
dimension = 2
duration = 1e-3
gravity = [0.0, -10.0]
[contact]
normal = {law = "linear", normal_stiffness = 1e5, normal_damping = 0.1, attraction = "allowed"}
sliding = {law = "spring", shear_friction = 0.5, shear_stiffness = 2e4, shear_damping = 0.025}
[numerics]
dt_fraction = 0.05
[outputs]
samples = 10
frames = 10
contacts = false
[[bodies]]
position = [0.0, 0.0]
radius = 1e-3
mass = 1e-5
velocity = [0.3, 0.1]
spin = [5.0]
[[bodies]]
position = [0.0, 5e-3]
radius = 1e-3
mass = 1e-5
velocity = [-0.2, 0.0]
[compare]
agreements = [{pairs = "codes", tolerance = 1e-9}, {pairs = "same_conventions", tolerance = 1e-12}]
"""

SCRIPTS = {
    "fly": "print('finished')",
    "abort": "import os; print('ERROR: <b>neighbour</b> list overflow', flush=True); os.abort()",
    "hang": "import time; print('step 17', flush=True); time.sleep(600)",
}


@dataclass(frozen=True)
class Obedient:
    """An engine whose child does one thing (SCRIPTS) and whose trajectory is exact flight, x = x_0 + v t + g t^2/2.

    With friction and gravity spins grow by half in a thousandth of a second, so that they can be compared. off:
    what velocities, and so places, are too large by. journal gets a line a started run.
    """

    name: str
    journal: Path
    does: str = "fly"
    off: float = 0.0
    available: bool = True
    level: str = "exact"

    def probe(self) -> Probe:
        return Probe(available=self.available, version="1.0" if self.available else "", detail="get it from nowhere")

    def supports(self, system: System) -> tuple[Support, ...]:
        return (Support(effect="flight", level=self.level, note="see the manual"),)

    def render(self, system: System) -> dict[str, str]:
        return {"deck.py": SCRIPTS[self.does] + "\n"}

    def command(self, folder: Path) -> list[str]:
        return [sys.executable, "-I", "-S", "deck.py"]

    def run(self, folder: Path, *, time_limit: float) -> RunResult:
        with open(self.journal, "a") as f:
            f.write(f"{self.name}\n")
        child = run_child(self.command(folder), folder=folder, log="log", time_limit=time_limit)
        status = "timed_out" if child.timed_out else "completed" if child.returncode == 0 else "crashed"
        reason = "" if status == "completed" else child.signal or "ended by the time limit"
        return RunResult(
            status=status, reason=reason, last_lines=child.last_lines, cpu_seconds=child.cpu_seconds,
            wall_seconds=child.wall_seconds, timings={"run": child.wall_seconds},
        )

    def steps_done(self, folder: Path) -> int:
        return 0

    def records(self, system: System) -> str:
        return ""

    def resumes(self, folder: Path) -> bool:
        return False

    def read(self, folder: Path, system: System) -> Trajectory:
        steps = tuple(range(0, system.steps + 1, system.frame_every))
        return Trajectory(frames=tuple(self._frame(system, n * system.dt) for n in steps), steps=steps, series=None)

    def _frame(self, system: System, time: float) -> Snapshot:
        p, g = system.particles, np.array(system.gravity or (0.0, 0.0))
        v = (p.v + g * time) * (1.0 + self.off)
        turned = 1.0 + 500.0 * time if g.any() and system.sliding else 1.0
        x = p.x + (p.v + g * time / 2) * (1.0 + self.off) * time
        columns = {
            "id": np.arange(1, len(p) + 1), "x": x[:, 0], "y": x[:, 1], "vx": v[:, 0], "vy": v[:, 1],
            "wz": p.spin[:, 0] * turned, "radius": p.radius,
        }
        return Snapshot(time=time, dimension=2, particles=Columns(columns, "particles"))

    def microseconds_per_step(self, system: System) -> float:
        return 1.0

    def changes(self, system: System) -> tuple[str, ...]:
        return ()


@pytest.fixture
def flight(tmp_path) -> Path:
    """A scene file: two discs that pass each other."""
    file = tmp_path / "flight.toml"
    file.write_text(FLIGHT)
    return file


@pytest.fixture
def obedient(tmp_path):
    """obedient("alpha", does="hang") is an engine; obedient.begun() says which were started, in order."""
    journal = tmp_path / "journal"

    def make(name: str, **settings) -> Obedient:
        return Obedient(name, journal, **settings)

    make.begun = lambda: journal.read_text().split() if journal.exists() else []
    return make


# --- a kernel in this process, for prescribed motion -----------------------------------------------


@dataclass(frozen=True)
class KernelInside:
    """The kernel in one convention, run in this process; `changed` makes a context in which it is another one."""

    name: str
    convention: str
    changed: Callable = nullcontext

    def probe(self) -> Probe:
        return Probe(available=True, version="inside", detail="this process")

    def supports(self, system: System) -> tuple[Support, ...]:
        from harness.engines.registry import ENGINES

        return ENGINES[f"kernel:{self.convention}"].supports(system)

    def render_prescribed(self, system: System) -> dict[str, str]:
        from harness.engines.registry import ENGINES

        return ENGINES[f"kernel:{self.convention}"].render_prescribed(system)

    def run_prescribed(self, folder: Path, *, time_limit: float) -> RunResult:
        from reference.kernel.prescribed import main

        with self.changed():
            main(folder)
        return RunResult(status="completed", reason="", last_lines=(), cpu_seconds=0.0, wall_seconds=0.0)


@pytest.fixture
def kernel_inside():
    """kernel_inside("lammps") is kernel:lammps; with a name and `changed` it is a code that does as that kernel."""

    def make(convention: str, *, name: str = "", changed: Callable = nullcontext) -> KernelInside:
        return KernelInside(name or f"kernel:{convention}", convention, changed)

    return make


# --- a ring with exact answers -----------------------------------------------------------------------

RING = """
kind = "couette"
title = "ring"
duration = 12.0
[particles]
seed = 1
inertia = "disc"
mass = {kind = "disc", density = 1000.0, height = 6e-3}
species = [{count = 240, radius = 2e-3}]
[rings]
inner_radius = 0.02
outer_radius = 0.0545
grain_radius = 1.25e-3
omega = 0.5
[preparation]
start_size = 0.5
grow = 2.0
settle = 0.0
[contact]
normal = {law = "linear", normal_stiffness = 300.0, normal_damping = 0.02, attraction = "allowed"}
sliding = {law = "viscous", shear_friction = 0.4, shear_damping = 0.1}
[background]
translational_drag = 1e-2
[numerics]
dt_fraction = 0.05
[outputs]
samples = 240
frames = 120
contacts = true
[compare]
steady_from = 0.1
band = 0.0345
cells = 8
windows = [{pairs = "codes", time = 1.0, tolerance = 1e-3}]
"""


@dataclass(frozen=True)
class RingStart:
    """Discs of a preparation that lie as in `RingOfChains`, at rest."""

    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    radius: np.ndarray


@dataclass(frozen=True)
class RingOfChains:
    """Thirty radial chains of eight discs between two rings; every average has an exact answer.

    Layer k sits at r_k and touches its neighbours, and the rings, at rho_k and rho_{k+1}. Contacts push with `push` N
    along r and pass on a torque; the drag of the bottom takes c v r from it layer by layer. Discs stay where they
    are, whatever their velocity: averages are over frames, and no frame knows of another.
    """

    folder: Path
    changes: tuple[tuple[str, str], ...] = ()
    file: Path = field(init=False)
    scene: object = field(init=False)
    chains = 30
    push = 1e-3

    def __post_init__(self) -> None:
        text = RING
        for old, new in self.changes:
            assert old in text
            text = text.replace(old, new)
        file = self.folder / "ring.toml"
        file.write_text(text)
        object.__setattr__(self, "file", file)
        object.__setattr__(self, "scene", load_scene(file))

    def changed(self, *changes: tuple[str, str]) -> RingOfChains:
        return RingOfChains(self.folder, (*self.changes, *changes))

    @property
    def radii(self) -> tuple[np.ndarray, np.ndarray]:
        """r_k (8,) and rho_k (9,), m."""
        first = self.scene.rings.inner_radius + self.scene.rings.grain_radius
        rho = first + 4e-3 * np.arange(9)
        return rho[:-1] + 2e-3, rho

    @property
    def angles(self) -> np.ndarray:
        return 2 * np.pi * np.arange(self.chains) / self.chains

    @property
    def system(self) -> System:
        r, a = np.repeat(self.radii[0], self.chains), np.tile(self.angles, 8)
        x = np.column_stack([r * np.cos(a), r * np.sin(a)])
        start = RingStart(x=x, v=np.zeros_like(x), spin=np.zeros(240), radius=np.full(240, 2e-3))
        return resolve(self.scene, self.file, start)

    def start(self, number: int = 0) -> Start:
        return Start(number, self.system)

    def trajectory(
        self, *, v_phi: Callable = lambda r: 0.01 * np.exp(-(r - 0.02) / 6e-3), spin: Callable = lambda r: 0 * r,
        torque: float = 1e-3, noise: float = 0.02, seed: int = 0, contacts: bool = True,
    ) -> Trajectory:
        """Velocities and torque scatter by `noise` from frame to frame, all layers on their own."""
        s, rng = self.system, np.random.default_rng(seed)
        step = np.arange(0, s.steps + 1, s.sample_every)
        torques = torque * (1 + noise * rng.standard_normal(len(step)))
        r, _ = self.radii
        v = v_phi(r) * (1 + noise * rng.standard_normal((len(step), 8)))
        loss = self._drag(s) * self.chains * r * v
        columns = {
            "step": step, "time": step * s.dt, "inner_angle": 0.5 * step * s.dt, "inner_torque": -torques,
            "outer_torque": torques - loss.sum(axis=1),
        }
        series = Columns(columns, "series")
        every = s.frame_every // s.sample_every
        frames = tuple(
            self._frame(s, step[k] * s.dt, v[k], spin(r), torques[k] - np.cumsum([0.0, *loss[k]]), contacts)
            for k in range(0, len(step), every)
        )
        return Trajectory(frames=frames, steps=tuple(int(n) for n in step[::every]), series=series)

    def _drag(self, system: System) -> float:
        return system.background.translational_drag if system.background else 0.0

    def _frame(self, system: System, time: float, v, spin, through, contacts: bool) -> Snapshot:
        p, angle = system.particles, np.tile(self.angles, 8)
        e_r, e_phi = np.array([np.cos(angle), np.sin(angle)]).T, np.array([-np.sin(angle), np.cos(angle)]).T
        velocity = np.repeat(v, self.chains)[:, None] * e_phi
        particles = {
            "id": np.arange(1, 241), "x": p.x[:, 0], "y": p.x[:, 1], "radius": p.radius, "mass": p.mass,
            "inertia": p.mass * p.radius**2 / 2, "vx": velocity[:, 0], "vy": velocity[:, 1],
            "wz": np.repeat(spin, self.chains),
        }
        rings = self.scene.rings
        walls = {
            "id": [1, 2], "px": [0.0, 0.0], "py": [0.0, 0.0], "radius": [rings.inner_radius, rings.outer_radius],
            "fx": [0.0, 0.0], "fy": [0.0, 0.0], "torque": [-through[0], through[-1]],
        }
        table = self._contacts(e_r[: self.chains], e_phi[: self.chains], through) if contacts else None
        return Snapshot(
            time=float(time), dimension=2, particles=Columns(particles, "particles"), contacts=table,
            walls=Columns(walls, "walls"),
        )

    def _contacts(self, e_r, e_phi, through) -> Columns:
        """Layer k pushes its outer neighbour with (push, T_k/(chains rho_k)): the force on i, the outer one."""
        rho, n, rows = self.radii[1], self.chains, []
        ids = np.arange(1, n + 1)
        for k in range(9):
            force = self.push * e_r + through[k] / (n * rho[k]) * e_phi
            i, j, sign = (ids + n * k, ids + n * (k - 1), 1.0) if 0 < k < 8 else (ids, -np.ones(n), 1.0)
            if k == 8:
                i, j, sign = ids + n * 7, -2 * np.ones(n), -1.0
            rows.append(np.column_stack([i, j, rho[k] * e_r, sign * force, np.full(n, self.push / 300.0)]))
        names = ("i", "j", "px", "py", "fx", "fy", "overlap")
        return Columns(dict(zip(names, np.vstack(rows).T, strict=True)), "contacts")


@pytest.fixture
def ring(tmp_path) -> RingOfChains:
    return RingOfChains(tmp_path)
