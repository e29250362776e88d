"""Systems, runs, and an independent integration of what LIGGGHTS is supposed to compute."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from harness.engines.liggghts import LIGGGHTS
from harness.engines.protocol import PATH_FILE, REACTION_FILE, Prescribed, Reaction
from harness.engines.registry import ENGINES
from harness.scene.contact import LinearNormal, SpringSliding
from harness.scene.system import Constant, Cosine, Loaded, Particles, System, Wall
from reference.kernel.deck import read_deck
from reference.kernel.prescribed import driven
from reference.kernel.simulation import Simulation


def pytest_collection_modifyitems(items):
    if shutil.which("liggghts") is None:
        skip = pytest.mark.skip(reason="needs the liggghts binary: apt-get install liggghts")
        for item in items:
            if item.get_closest_marker("needs_liggghts"):
                item.add_marker(skip)


@pytest.fixture(name="make")
def _make():
    return make_system


@pytest.fixture(name="run")
def _run(tmp_path):
    """Render, run, insist on completion, read."""

    def run(system: System, name: str = "run"):
        folder = write_deck(system, tmp_path / name)
        result = LIGGGHTS.run(folder, time_limit=60)
        assert result.status == "completed", result
        return LIGGGHTS.read(folder, system)

    return run


@pytest.fixture(name="deck")
def _deck(tmp_path):
    return lambda system, name="run": write_deck(system, tmp_path / name)


@pytest.fixture(name="reference")
def _reference():
    return integrate


@pytest.fixture(name="plane")
def _plane():
    return make_plane


@pytest.fixture(name="agrees")
def _agrees():
    return assert_agrees


@pytest.fixture(name="matches")
def _matches(run):
    """Run a system with LIGGGHTS and by the integration below; insist that they agree to rounding."""

    def matches(system: System, tolerance: float = 1e-11):
        trajectory = run(system)
        assert_agrees(trajectory, system, integrate(system), tolerance)
        return trajectory

    return matches


@pytest.fixture(name="lead")
def _lead(tmp_path):
    """Lead bodies along a path with LIGGGHTS, its deck changed by replacing words; return the Reaction."""

    def lead(system: System, path: Prescribed, *changes: tuple[str, str], name: str = "lab") -> Reaction:
        folder = write_files(changed(LIGGGHTS.render_prescribed(system), changes), tmp_path / name)
        np.savez(folder / PATH_FILE, x=path.x, v=path.v, spin=path.spin)
        result = LIGGGHTS.run_prescribed(folder, time_limit=60)
        assert result.status == "completed", result
        with np.load(folder / REACTION_FILE) as found:
            return Reaction(force=found["force"], torque=found["torque"])

    return lead


@pytest.fixture(name="answer")
def _answer(tmp_path):
    """Return what the kernel with LIGGGHTS' conventions answers to a path."""

    def answer(system: System, path: Prescribed) -> Reaction:
        force, torque = driven(kernel_model(system, tmp_path / "kernel"), path.x, path.v, path.spin)
        return Reaction(force=force, torque=torque)

    return answer


@pytest.fixture(name="kernel_frames")
def _kernel_frames(tmp_path):
    """Return the frames that the kernel with LIGGGHTS' conventions makes of a system, by its plain step."""

    def kernel_frames(system: System) -> list[Frame]:
        simulation = Simulation(kernel_model(system, tmp_path / "kernel"))
        frames = [Frame(simulation)]
        for _ in range(system.steps // system.frame_every):
            simulation.advance(system.frame_every)
            frames.append(Frame(simulation))
        return frames

    return kernel_frames


class Frame:
    """x, v (N, dim), spin (N, 1|3); wall_d: displacements along the normals.

    contacts: force on i and spring (or None) by (id of i, id of j or -wall).
    """

    def __init__(self, simulation: Simulation):
        state, n = simulation.state, simulation.model.particle_count
        self.x, self.v, self.spin = (a[:, :n].T.copy() for a in (state.x, state.v, state.spin))
        self.wall_d = np.array(state.wall_d)
        self.contacts = {}
        for interaction, full_step in simulation.contacts():
            forces = full_step if interaction.walls is None else interaction.last
            spring = forces.memory.get("sliding")
            for k, (i, j) in enumerate(zip(forces.contact.i, forces.contact.j, strict=True)):
                key = (int(i) + 1, int(j) + 1 if interaction.walls is None else n - int(j) - 1)
                self.contacts[key] = forces.force[:, k], None if spring is None else spring[: len(state.x), k]


def kernel_model(system: System, folder):
    write_files(ENGINES["kernel:liggghts"].render(system), folder)
    return read_deck(folder)[0]


def changed(files: dict[str, str], changes) -> dict[str, str]:
    """Return deck files with words replaced; every word must be there."""
    for old, new in changes:
        assert any(old in text for text in files.values()), f"no {old!r} in the deck"
        files = {name: text.replace(old, new) for name, text in files.items()}
    return files


def write_files(files: dict[str, str], folder):
    folder.mkdir()
    for name, text in files.items():
        (folder / name).write_text(text)
    return folder


def write_deck(system: System, folder):
    return write_files(LIGGGHTS.render(system), folder)


def make_system(*, x, v=None, spin=None, radius=0.5, mass=1.0, inertia=None, walls=(), sliding=None, steps=400,
                dt=2e-3, kn=200.0, gn=0.5, attraction="allowed", normal=None, **rest) -> System:
    """Return a system of a few particles; SI numbers of order one. sliding: a law, or numbers of a spring's."""
    x = np.array(x, dtype=float)
    count, dim = x.shape
    spins = 1 if dim == 2 else 3
    filled = {
        "x": x, "radius": np.broadcast_to(np.asarray(radius, float), count).copy(),
        "mass": np.broadcast_to(np.asarray(mass, float), count).copy(),
        "inertia_factor": np.full(count, {2: 0.5, 3: 0.4}[dim] if inertia is None else inertia),
        "v": np.zeros((count, dim)) if v is None else np.array(v, dtype=float),
        "spin": np.zeros((count, spins)) if spin is None else np.array(spin, dtype=float).reshape(count, spins),
    }
    if isinstance(sliding, tuple):
        numbers = zip(("shear_friction", "shear_stiffness", "shear_damping"), sliding, strict=True)
        sliding = SpringSliding(**dict(numbers))
    linear = LinearNormal(normal_stiffness=kn, normal_damping=gn, attraction=attraction)
    given = {"gravity": None, "periodic": None, "background": None, "contacts": True, "sample_every": 10,
             "frame_every": steps // 4} | rest
    return System(
        dimension=dim, particles=Particles(**filled), walls=tuple(walls), sliding=sliding, dt=dt, steps=steps,
        normal=linear if normal is None else normal, **given,
    )


def make_plane(index, name, point, normal, friction=False, motion=None) -> Wall:
    unit = np.array(normal, float) / np.linalg.norm(normal)
    return Wall(index=index, name=name, point=tuple(map(float, point)), normal=tuple(unit.tolist()),
                friction=friction, motion=motion)


def assert_agrees(trajectory, system: System, expected: Integration, tolerance: float) -> None:
    """Compare the last frame and the whole series, each quantity relative to its largest value."""
    last, dim = trajectory.frames[-1], system.dimension
    close(last.particles.vector(*last.axes), expected.x[:, :dim], tolerance, "positions")
    close(last.particles.vector(*("v" + a for a in last.axes)), expected.v[:, :dim], tolerance, "velocities")
    spins = [c for c in ("wx", "wy", "wz") if c in last.particles]
    close(last.particles.vector(*spins), expected.w[:, -len(spins):], tolerance, "spins")
    assert trajectory.series["step"].tolist() == list(range(0, system.steps + 1, system.sample_every))
    for k, wall in enumerate(system.walls):
        rows = np.array([row[k] for row in expected.rows])
        forces = [f"{wall.name}_f{a}" for a in last.axes]
        close(trajectory.series.vector(*forces), rows[:, 2:], tolerance, f"forces on {wall.name}")
        for column, values in zip(("d", "v"), rows.T, strict=False):
            close(trajectory.series[f"{wall.name}_{column}"], values, tolerance, f"{wall.name}_{column}")


def close(got, expected, tolerance, what):
    off = np.abs(got - expected).max()
    assert off <= tolerance * max(np.abs(expected).max(), 1e-3), f"{what}: off by {off:.3g}"


class Integration:
    """Velocity Verlet by plain loops with LIGGGHTS' conventions, in 3D (a 2D system lies at z = 0).

    Forces of a step see x(n+1) and half-step velocities; at set-up full-step ones. Slip and torque
    arm R - delta/2. Spring: u += v_t dt, u -= (u.n) n; if k_t |u| > mu |f_n| it is cut and alone.
    """

    def __init__(self, system: System):
        p, self.s = system.particles, system
        deep = [(0, 0), (0, 3 - system.dimension)]
        self.x, self.v = np.pad(p.x, deep), np.pad(p.v, deep)
        self.w = np.pad(p.spin, [(0, 0), (2, 0)]) if system.dimension == 2 else p.spin.copy()
        self.m, self.r, self.inertia = p.mass, p.radius, p.inertia_factor * p.mass * p.radius**2
        self.n = [np.pad(w.normal, (0, 3 - system.dimension)) for w in system.walls]
        self.p = [np.pad(w.point, (0, 3 - system.dimension)).astype(float) for w in system.walls]
        self.d, self.rate = np.zeros(len(self.n)), np.zeros(len(self.n))
        self.wall_v = [self._vector(w.motion.velocity) if isinstance(w.motion, Constant) else np.zeros(3)
                       for w in system.walls]
        self.rate[:] = [v @ n for v, n in zip(self.wall_v, self.n, strict=True)]
        self.u, self.t, self.rows = {}, 0.0, []
        self.evaluate(0.0)
        self.record()

    def _vector(self, v):
        return np.pad(np.asarray(v, float), (0, 3 - len(v)))

    def step(self):
        dt = self.s.dt
        self.v += 0.5 * dt * self.f / self.m[:, None]
        self.w += 0.5 * dt * self.torque / self.inertia[:, None]
        self.x += dt * self.v
        self.t += dt
        self.move_walls(dt)
        self.evaluate(dt)
        self.v += 0.5 * dt * self.f / self.m[:, None]
        self.w += 0.5 * dt * self.torque / self.inertia[:, None]
        for k, a in self.wall_acceleration().items():
            self.rate[k] += 0.5 * dt * a

    def move_walls(self, dt):
        accelerations = self.acceleration
        for k, wall in enumerate(self.s.walls):
            motion = wall.motion
            if isinstance(motion, Loaded):
                self.rate[k] += 0.5 * dt * accelerations[k]
                move = dt * self.rate[k]
            elif isinstance(motion, Cosine):
                phase = np.pi * min(self.t, motion.duration) / motion.duration
                move = motion.travel / 2 * (1 - np.cos(phase)) - self.d[k]
                self.rate[k] = np.pi * motion.travel / (2 * motion.duration) * np.sin(phase)
            else:
                self.rate[k] = self.wall_v[k] @ self.n[k]
                move = self.rate[k] * dt
            self.d[k] += move
            self.p[k] = self.p[k] + move * self.n[k]
            if not isinstance(motion, Constant):
                self.wall_v[k] = move / dt * self.n[k]

    def wall_acceleration(self):
        self.acceleration = {}
        names = [w.name for w in self.s.walls]
        for k, wall in enumerate(self.s.walls):
            motion = wall.motion
            if isinstance(motion, Loaded):
                extent = 0.0
                if motion.span:
                    a, b = (names.index(n) for n in motion.span)
                    extent = (self.p[b] - self.p[a]) @ self.n[a]
                push = motion.load + motion.stress * extent + self.wall_f[k] @ self.n[k]
                self.acceleration[k] = (push - motion.damping * self.rate[k]) / motion.mass
        return self.acceleration

    def evaluate(self, dt):
        s, count = self.s, len(self.m)
        self.f, self.torque = np.zeros((count, 3)), np.zeros((count, 3))
        if s.gravity is not None:
            self.f += self.m[:, None] * self._vector(s.gravity)
        if s.background is not None:
            self.f -= s.background.translational_drag * self.v
        self.wall_f = np.zeros((len(self.n), 3))
        touching = {}
        for i in range(count):
            for j in range(i + 1, count):
                branch = self.x[i] - self.x[j]
                for a, length in enumerate(s.periodic or ()):
                    branch[a] -= round(branch[a] / length) * length if length else 0.0
                r = np.sqrt(branch @ branch)
                self.contact(i, j, branch / r, self.r[i] + self.r[j] - r, self.v[i] - self.v[j], dt, touching)
            for k, n in enumerate(self.n):
                overlap = self.r[i] - (self.x[i] - self.p[k]) @ n
                self.contact(i, -k - 1, n, overlap, self.v[i] - self.wall_v[k], dt, touching)
        self.u = touching
        if not dt:
            self.wall_acceleration()

    def contact(self, i, j, n, overlap, v, dt, touching):
        if overlap <= 0:
            return
        s, pair = self.s, j >= 0
        arm_i, arm_j = self.r[i] - overlap / 2, (self.r[j] - overlap / 2 if pair else 0.0)
        vn = v @ n
        fn = s.normal.normal_stiffness * overlap - s.normal.normal_damping * vn
        if s.normal.attraction == "clipped":
            fn = max(fn, 0.0)
        ft = np.zeros(3)
        if s.sliding is not None and (pair or s.walls[-j - 1].friction):
            law = s.sliding
            vt = v - vn * n - np.cross(arm_i * self.w[i] + (arm_j * self.w[j] if pair else 0.0), n)
            u = self.u.get((i, j), np.zeros(3)) + vt * dt
            u = u - (u @ n) * n if dt else u
            limit, stretch = law.shear_friction * abs(fn), law.shear_stiffness * np.sqrt(u @ u)
            ft = -law.shear_stiffness * u
            if stretch > limit:
                ft = ft * limit / stretch
                u = -ft / law.shear_stiffness if dt else u
            else:
                ft = ft - law.shear_damping * vt
            touching[i, j] = u
        force = fn * n + ft
        self.f[i] += force
        self.torque[i] -= arm_i * np.cross(n, ft)
        if pair:
            self.f[j] -= force
            self.torque[j] -= arm_j * np.cross(n, ft)
        else:
            self.wall_f[-j - 1] -= force

    def record(self):
        self.rows.append([np.concatenate([[self.d[k], self.rate[k]], self.wall_f[k, : self.s.dimension]])
                          for k in range(len(self.n))])


def integrate(system: System) -> Integration:
    """Return the state after all steps, and in `rows` one (walls, d v fx fy [fz]) a sample."""
    run = Integration(system)
    for step in range(1, system.steps + 1):
        run.step()
        if step % system.sample_every == 0:
            run.record()
    return run
