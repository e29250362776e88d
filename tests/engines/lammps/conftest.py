"""Systems, runs of them, and a plain NumPy integration in LAMMPS' conventions to compare with."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from harness.engines.lammps import LAMMPS
from harness.scene.model import LinearNormal, SpringSliding
from harness.scene.system import Constant, Cosine, Loaded, Particles, System, Wall

SLIDING = SpringSliding(shear_friction=0.4, shear_stiffness=3e3, shear_damping=0.2)
NORMAL = LinearNormal(normal_stiffness=1e4, normal_damping=0.05, attraction="allowed")


def particles(x, radius, mass, *, v=None, spin=None, q=None) -> Particles:
    x = np.array(x, dtype=float)
    n, dim = x.shape
    columns = {"v": (v, dim), "spin": (spin, 1 if dim == 2 else 3)}
    moving = {k: np.zeros((n, d)) if given is None else np.array(given, float) for k, (given, d) in columns.items()}
    factor = np.full(n, 0.5 if dim == 2 else 0.4) if q is None else np.array(q, float)
    return Particles(x=x, radius=np.array(radius, float), mass=np.array(mass, float), inertia_factor=factor, **moving)


def system(grains: Particles, **changes) -> System:
    fields = {
        "dimension": grains.x.shape[1], "particles": grains, "walls": (), "normal": NORMAL, "sliding": SLIDING,
        "background": None, "gravity": None, "periodic": None, "dt": 2e-6, "steps": 300, "sample_every": 5,
        "frame_every": 10, "contacts": True,
    }
    return System(**(fields | changes))


def two(dim: int = 2, q=None, **changes) -> System:
    """An oblique collision of two unequal spinning particles."""
    spin = [[200.0], [-50.0]] if dim == 2 else [[200.0, 30.0, 40.0], [-50.0, 0.0, 70.0]]
    x = np.array([[0.0, 0.0, 0.0], [2.08e-3, 0.3e-3, 0.4e-3]])[:, :dim]
    v = np.array([[0.5, 0.1, 0.02], [-0.5, -0.3, 0.2]])[:, :dim]
    return system(particles(x, [1e-3, 1.1e-3], [1e-5, 2e-5], v=v, spin=spin, q=q), **changes)


def floor(normal=(0.0, 1.0), *, friction=True, motion=None) -> Wall:
    point = (0.0,) * len(normal)
    return Wall(index=1, name="floor", point=point, normal=normal, friction=friction, motion=motion)


def on_floor(wall: Wall, **changes) -> System:
    """One spinning particle that hits a plane at an angle, starting just above it."""
    normal = np.array(wall.normal)
    v = np.array([0.3, -0.3]) if len(normal) == 2 else np.array([0.3, 0.1, -0.3])
    spin = [[10.0]] if len(normal) == 2 else [[10.0, 2.0, 3.0]]
    grain = particles([1.01e-3 * normal], [1e-3], [1e-5], v=[v], spin=spin)
    return system(grain, walls=(wall,), **changes)


def biaxial(count: int = 9, **changes) -> System:
    """A small box: left and bottom fixed, right with a mass and a stress, top strain-controlled."""
    rng = np.random.default_rng(0)
    side = int(np.ceil(np.sqrt(count)))
    radius = rng.uniform(0.8e-3, 1.2e-3, count)
    cells = np.array([(i % side, i // side) for i in range(count)])
    x = cells * 2.05e-3 + 1.1e-3 + rng.uniform(-2e-4, 2e-4, (count, 2))
    length = side * 2.05e-3 + 1e-4
    right = Loaded(mass=1e-3, load=0.0, stress=100.0, span=("bottom", "top"), damping=0.1)
    top = Cosine(travel=0.15 * length, duration=0.002)
    walls = (
        Wall(index=1, name="left", point=(0.0, 0.0), normal=(1.0, 0.0), friction=False),
        Wall(index=2, name="bottom", point=(0.0, 0.0), normal=(0.0, 1.0), friction=False),
        Wall(index=3, name="right", point=(length, 0.0), normal=(-1.0, 0.0), friction=False, motion=right),
        Wall(index=4, name="top", point=(0.0, length), normal=(0.0, -1.0), friction=False, motion=top),
    )
    mass = 2000 * 4 / 3 * np.pi * radius**3
    damped = LinearNormal(normal_stiffness=1e4, normal_damping=0.4, attraction="allowed")
    defaults = {"walls": walls, "normal": damped, "steps": 700, "sample_every": 10, "frame_every": 70}
    return system(particles(x, radius, mass), **(defaults | changes))


def make(folder, of: System, *, edit=None, time_limit: float = 60.0):
    """Write the deck (`edit` may change in.lammps) and run it; return RunResult."""
    for name, text in LAMMPS.render(of).items():
        (folder / name).write_text(edit(text) if edit and name == "in.lammps" else text)
    return LAMMPS.run(folder, time_limit=time_limit)


def trajectory(folder, of: System):
    """Run a system that must come to its end; return its trajectory."""
    result = make(folder, of)
    assert result.status == "completed", result
    return LAMMPS.read(folder, of)


@dataclass
class Reference:
    """Velocity Verlet as LAMMPS has it, all pairs, everything in 3D; N of a few.

    Forces see v(t+dt/2) and w(t+dt/2), those of the set-up v(0), w(0) and no spring is moved there.
    A spring keeps its length when it is turned into the new tangential plane; slip cuts spring and
    dashpot together. Lever arm R - overlap/2 between particles, R at walls.
    """

    s: System
    springs: dict = field(default_factory=dict)

    def __post_init__(self):
        p, dim = self.s.particles, self.s.dimension
        self.x, self.v, self.w = (np.zeros((len(p), 3)) for _ in range(3))
        self.x[:, :dim], self.v[:, :dim] = p.x, p.v
        self.w[:, -p.spin.shape[1]:] = p.spin
        pad = [(0, 0), (0, 3 - dim)]
        walls = self.s.walls
        self.normal = np.pad(np.reshape([w.normal for w in walls], (-1, dim)), pad)
        self.point = np.pad(np.reshape([w.point for w in walls], (-1, dim)), pad)
        self.d, self.rate, self.shift = np.zeros(len(walls)), np.zeros(len(walls)), np.zeros((len(walls), 3))
        self.loaded = [k for k, w in enumerate(walls) if isinstance(w.motion, Loaded)]
        self.wall_mass = np.array([walls[k].motion.mass for k in self.loaded])

    def law(self, n, overlap, velocity, spring, rough, move):
        normal, sliding = self.s.normal, self.s.sliding
        fn = normal.normal_stiffness * overlap - normal.normal_damping * (velocity @ n)
        fn = max(fn, 0.0) if normal.attraction == "clipped" else fn
        if not rough:
            return fn * n, spring
        kt, slip, limit = sliding.shear_stiffness, velocity - (velocity @ n) * n, sliding.shear_friction * abs(fn)
        if move:
            if abs(spring @ n) * kt > 1e-10 * limit:
                turned = spring - (spring @ n) * n
                spring = turned * np.linalg.norm(spring) / np.linalg.norm(turned)
            spring = spring + self.s.dt * slip
        dashpot = sliding.shear_damping * slip
        ft = -kt * spring - dashpot
        if np.linalg.norm(ft) > limit:
            ft = ft * limit / np.linalg.norm(ft) if spring.any() else np.zeros(3)
            spring = -(ft + dashpot) / kt if spring.any() else spring
        return fn * n + ft, spring

    def touch(self, key, n, overlap, velocity, rough, move):
        force, spring = self.law(n, overlap, velocity, self.springs.get(key, np.zeros(3)), rough, move)
        if rough and self.keep:
            self.springs[key] = spring
        return force

    def forces(self, wall_velocity, *, move: bool, keep: bool = True):
        """Return forces, torques, forces on walls, and rows (i, j, force, spring, overlap) of pairs."""
        self.keep = keep
        p, s = self.s.particles, self.s
        f, torque, on_wall, pairs = np.zeros_like(self.x), np.zeros_like(self.x), np.zeros_like(self.shift), []
        lengths = np.pad(s.periodic or (0.0,) * s.dimension, (0, 3 - s.dimension))
        period = np.where(lengths > 0, lengths, np.inf)
        rough = s.sliding is not None
        for i in range(len(p)):
            for j in range(i + 1, len(p)):
                branch = self.x[i] - self.x[j]
                branch = branch - np.round(branch / period) * lengths
                n, overlap = branch / np.linalg.norm(branch), p.radius[i] + p.radius[j] - np.linalg.norm(branch)
                if overlap <= 0:
                    self.springs.pop((i, j), None)
                    continue
                swept = np.cross(p.radius[i] * self.w[i] + p.radius[j] * self.w[j], n)
                force = self.touch((i, j), n, overlap, self.v[i] - self.v[j] - swept, rough, move)
                f[i] += force
                f[j] -= force
                turning = np.cross(n, force) * rough
                torque[i] -= (p.radius[i] - overlap / 2) * turning
                torque[j] -= (p.radius[j] - overlap / 2) * turning
                pairs.append([i + 1, j + 1, *force, *self.springs.get((i, j), np.zeros(3)), overlap])
            for k, wall in enumerate(s.walls):
                n = self.normal[k]
                overlap = p.radius[i] - (self.x[i] - self.point[k] - self.shift[k]) @ n
                if overlap <= 0:
                    self.springs.pop((i, -1 - k), None)
                    continue
                velocity = self.v[i] - wall_velocity[k] - np.cross(p.radius[i] * self.w[i], n)
                force = self.touch((i, -1 - k), n, overlap, velocity, rough and wall.friction, move)
                f[i] += force
                torque[i] -= p.radius[i] * np.cross(n, force) * (rough and wall.friction)
                on_wall[k] -= force
        if s.gravity is not None:
            f[:, : s.dimension] += p.mass[:, None] * s.gravity
        if s.background is not None:
            f -= s.background.translational_drag * self.v
        return f, torque, on_wall, np.reshape(pairs, (-1, 9))

    def place(self, step):
        t = step * self.s.dt
        for k, wall in enumerate(self.s.walls):
            if isinstance(wall.motion, Constant):
                velocity = np.pad(wall.motion.velocity, (0, 3 - self.s.dimension))
                self.shift[k], self.rate[k] = velocity * t, velocity @ self.normal[k]
                self.d[k] = self.rate[k] * t
                continue
            if isinstance(wall.motion, Cosine):
                half, speed = wall.motion.travel / 2, np.pi / wall.motion.duration
                angle = min(speed * t, np.pi)
                self.d[k], self.rate[k] = half * (1 - np.cos(angle)), half * speed * np.sin(angle)
            self.shift[k] = self.d[k] * self.normal[k]

    def on_loaded(self, on_wall):
        found = []
        for k in self.loaded:
            m = self.s.walls[k].motion
            force = m.load + on_wall[k] @ self.normal[k] - m.damping * self.rate[k]
            if m.span:
                a, b = ([w.name for w in self.s.walls].index(name) for name in m.span)
                force += m.stress * (abs((self.point[b] - self.point[a]) @ self.normal[a]) - self.d[a] - self.d[b])
            found.append(force)
        return np.array(found)

    def run(self):
        """Return frames (dicts) and the series (rows: step, then d, v, force of every wall)."""
        s, dt, p = self.s, self.s.dt, self.s.particles
        inertia = (p.inertia_factor * p.mass * p.radius**2)[:, None]
        f, torque, on_wall, _ = self.forces(np.zeros_like(self.shift), move=False)
        push = self.on_loaded(on_wall)
        frames, series = [], []
        for step in range(s.steps + 1):
            if step:
                self.v += dt / 2 * f / p.mass[:, None]
                self.w += dt / 2 * torque / inertia
                self.x += dt * self.v
                self.rate[self.loaded] += dt / 2 * push / self.wall_mass
                self.d[self.loaded] += dt * self.rate[self.loaded]
                before = self.shift.copy()
                self.place(step)
                f, torque, on_wall, _ = self.forces((self.shift - before) / dt, move=True)
                push = self.on_loaded(on_wall)
                self.v += dt / 2 * f / p.mass[:, None]
                self.w += dt / 2 * torque / inertia
                self.rate[self.loaded] += dt / 2 * push / self.wall_mass
            else:
                self.place(0)
            if step % s.sample_every == 0:
                series.append([step, *np.column_stack([self.d, self.rate, on_wall[:, : s.dimension]]).ravel()])
            if step % s.frame_every == 0:
                pairs = self.forces(np.zeros_like(self.shift), move=False, keep=False)[3]
                frames.append({"x": self.x.copy(), "v": self.v.copy(), "w": self.w.copy(), "pairs": pairs})
        return frames, np.array(series)


@pytest.fixture(scope="session")
def make_system():
    """Builders of systems."""
    return SimpleNamespace(two=two, floor=floor, on_floor=on_floor, biaxial=biaxial, particles=particles, any=system)


@pytest.fixture(scope="session")
def run():
    """`run.make(folder, system)` gives a RunResult, `run.trajectory(folder, system)` the trajectory."""
    return SimpleNamespace(make=make, trajectory=trajectory)


@pytest.fixture(scope="session")
def reference():
    """`reference(system)` gives frames and series of the NumPy integration."""
    return lambda s: Reference(s).run()
