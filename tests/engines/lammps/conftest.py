"""Systems, runs of them, and a plain NumPy integration in LAMMPS' conventions to compare with."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from harness.engines.lammps import LAMMPS
from harness.engines.protocol import Prescribed
from harness.scene.contact import HertzNormal, JkrNormal, LinearNormal, SpringSliding, ViscousSliding
from harness.scene.system import Constant, Cosine, Loaded, Particles, System, Wall

SLIDING = SpringSliding(shear_friction=0.4, shear_stiffness=3e3, shear_damping=0.2)
NORMAL = LinearNormal(normal_stiffness=1e4, normal_damping=0.05, attraction="allowed")


def particles(x, radius, mass, *, v=None, spin=None, q=None) -> Particles:
    n, dim = (x := np.array(x, dtype=float)).shape
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


def _normal_force(law, overlap, v_n, reduced_radius, reduced_mass):
    """Return f_n and the force whose multiple limits friction."""
    if isinstance(law, LinearNormal):
        return _clipped(law, law.normal_stiffness * overlap - law.normal_damping * v_n)
    modulus = law.youngs_modulus / (2 * (1 - law.poisson_ratio**2))
    slope = 2 * modulus * np.sqrt(reduced_radius * max(overlap, 0.0))
    if isinstance(law, HertzNormal):
        damping = np.sqrt(10 / 3 * slope * reduced_mass) * _beta(law.restitution)
        return _clipped(law, 2 / 3 * slope * overlap - damping * v_n)
    jkr = isinstance(law, JkrNormal)
    pull = (3 if jkr else 4) * np.pi * law.surface_energy * reduced_radius
    elastic = _jkr(law, modulus, overlap, reduced_radius) if jkr else 2 / 3 * slope * overlap - pull
    return elastic - law.normal_damping * v_n, abs(elastic + 2 * pull)


def _beta(e):
    return -np.log(e) / np.hypot(np.log(e), np.pi)


def _clipped(law, force):
    return (max(force, 0.0), max(force, 0.0)) if law.attraction == "clipped" else (force, abs(force))


def _jkr(law, modulus, overlap, radius):
    """Force at an overlap, by the contact radius that belongs to it (the larger root)."""
    tension = np.pi * law.surface_energy / modulus
    smallest = np.cbrt(tension * radius**2 / 4)
    a = max(np.sqrt(radius * max(overlap, 0.0)) + 3 * smallest, smallest)
    for _ in range(100):
        off = a**2 / radius - 2 * np.sqrt(tension * a) - overlap
        a = a - off / (2 * a / radius - np.sqrt(tension / a))
    return 4 * modulus * a**3 / (3 * radius) - 4 * modulus * np.sqrt(tension * a**3)


def _holds(law, overlap, reduced_radius, touched) -> bool:
    """Does a contact act? LAMMPS lets those of JKR go where the tension is largest, not at the end of the branch."""
    if not touched or not isinstance(law, JkrNormal):
        return overlap > 0
    tension = np.pi * law.surface_energy * 2 * (1 - law.poisson_ratio**2) / law.youngs_modulus
    smallest = np.cbrt(9 * tension * reduced_radius**2 / 4)
    return overlap >= smallest**2 / reduced_radius - 2 * np.sqrt(tension * smallest)


@dataclass(frozen=True)
class Slider:
    """As pair granular has it: the turned spring keeps its length, slip cuts spring and dashpot together."""

    stiffness: float
    damping: float
    limit: float

    def force(self, spring, n, rate, dt):
        """Return force and spring; dt = 0 leaves the spring alone."""
        if dt:
            if abs(spring @ n) * self.stiffness > 1e-10 * self.limit:  # else it stays as it is
                turned = spring - (spring @ n) * n
                spring = turned * np.linalg.norm(spring) / np.linalg.norm(turned)
            spring = spring + dt * rate
        force = -self.stiffness * spring - self.damping * rate
        if np.linalg.norm(force) <= self.limit:
            return force, spring
        if not spring.any():
            return np.zeros(3), spring
        force = force * self.limit / np.linalg.norm(force)
        return force, -(force + self.damping * rate) / self.stiffness


@dataclass(frozen=True)
class Touch:
    """One contact: n from j to i, velocity of i relative to j (of centres), swept = R_i w_i + R_j w_j."""

    n: np.ndarray
    velocity: np.ndarray
    swept: np.ndarray
    turning: np.ndarray
    overlap: float
    reduced_radius: float
    reduced_mass: float
    rough: bool


@dataclass
class Reference:
    """Velocity Verlet as LAMMPS has it, all pairs, everything in 3D; N of a few.

    Forces see v(t+dt/2) and w(t+dt/2), those of the set-up v(0), w(0) and no spring is moved there.
    Lever arm R - overlap/2 between particles, R at walls.
    """

    s: System
    memory: dict = field(default_factory=dict)

    def __post_init__(self):
        p, dim = self.s.particles, self.s.dimension
        self.x, self.v, self.w = (np.zeros((len(p), 3)) for _ in range(3))
        self.x[:, :dim], self.v[:, :dim] = p.x, p.v
        self.w[:, -p.spin.shape[1]:] = p.spin
        walls, pad = self.s.walls, [(0, 0), (0, 3 - dim)]
        self.normal = np.pad(np.reshape([w.normal for w in walls], (-1, dim)), pad)
        self.point = np.pad(np.reshape([w.point for w in walls], (-1, dim)), pad)
        self.d, self.rate, self.shift = np.zeros(len(walls)), np.zeros(len(walls)), np.zeros((len(walls), 3))
        self.loaded = [k for k, w in enumerate(walls) if isinstance(w.motion, Loaded)]
        self.wall_mass = np.array([walls[k].motion.mass for k in self.loaded])
        self.turns = any((self.s.sliding, self.s.rolling, self.s.torsion))

    def touch(self, key, c: Touch, dt):
        """Return the force on i and the couple on i; dt = 0: histories stand still and are not kept."""
        s, v_n = self.s, c.velocity @ c.n
        f_n, limit = _normal_force(s.normal, c.overlap, v_n, c.reduced_radius, c.reduced_mass)
        memory = dict(self.memory.get(key, {"sliding": np.zeros(3), "rolling": np.zeros(3), "torsion": 0.0}))
        force, couple = f_n * c.n, np.zeros(3)
        if c.rough and s.sliding is not None:
            slip = c.velocity - v_n * c.n - np.cross(c.swept, c.n)
            f_t, memory["sliding"] = self.slide(memory["sliding"], c, slip, limit, dt)
            force = force + f_t
        if c.rough and s.rolling is not None:
            law, rate = s.rolling, c.reduced_radius * np.cross(c.turning, c.n)
            slider = Slider(law.rolling_stiffness, law.rolling_damping, law.rolling_friction * limit)
            f_r, memory["rolling"] = slider.force(memory["rolling"], c.n, rate, dt)
            couple += c.reduced_radius * np.cross(c.n, f_r)
        if c.rough and s.torsion is not None:
            f_o, memory["torsion"] = self.twist(memory["torsion"], c, limit, dt)
            couple += c.reduced_radius * f_o * c.n
        if dt:
            self.memory[key] = memory
        return force, couple

    def slide(self, spring, c, slip, limit, dt):
        law, limit = self.s.sliding, self.s.sliding.shear_friction * limit
        if isinstance(law, ViscousSliding):
            size = law.shear_damping * np.linalg.norm(slip)
            return -law.shear_damping * slip * min(1.0, limit / size if size else 1.0), spring
        if isinstance(law, SpringSliding):
            return Slider(law.shear_stiffness, law.shear_damping, limit).force(spring, c.n, slip, dt)
        nu, modulus = self.s.normal.poisson_ratio, self.s.normal.youngs_modulus
        stiffness = 8 * modulus / (4 * (2 - nu) * (1 + nu)) * np.sqrt(c.reduced_radius * c.overlap)
        damping = np.sqrt(10 / 3 * stiffness * c.reduced_mass) * _beta(self.s.normal.restitution)
        return Slider(stiffness, damping, limit).force(spring, c.n, slip, dt)

    def twist(self, spring, c, limit, dt):
        """The slider about the normal; LAMMPS takes the direction of slip from the rate, not from the force."""
        law, rate = self.s.torsion, c.reduced_radius * (c.turning @ c.n)
        spring = spring + dt * rate
        force = -law.torsion_stiffness * spring - law.torsion_damping * rate
        if abs(force) > law.torsion_friction * limit:
            force = -law.torsion_friction * limit * np.sign(rate)
            spring = -(force + law.torsion_damping * rate) / law.torsion_stiffness
        return force, spring

    def forces(self, wall_velocity, *, dt: float):
        """Return forces, torques, forces on walls, and rows (i, j, force, spring, overlap) of pairs."""
        p, s = self.s.particles, self.s
        f, torque, on_wall, pairs = np.zeros_like(self.x), np.zeros_like(self.x), np.zeros_like(self.shift), []
        near = self.near()
        for i in range(len(p)):
            for j in near[i]:
                contact = self.pair(i, j)
                if not self.holds((i, j), contact):
                    continue
                force, couple = self.touch((i, j), contact, dt)
                f[i] += force
                f[j] -= force
                turning = np.cross(contact.n, force) * self.turns
                torque[i] += couple - (p.radius[i] - contact.overlap / 2) * turning
                torque[j] -= couple + (p.radius[j] - contact.overlap / 2) * turning
                spring = self.memory.get((i, j), {}).get("sliding", np.zeros(3))
                pairs.append([i + 1, j + 1, *force, *spring, contact.overlap])
            for k in range(len(s.walls)):
                contact = self.at_wall(i, k, wall_velocity[k])
                if not self.holds((i, -1 - k), contact):
                    continue
                force, couple = self.touch((i, -1 - k), contact, dt)
                f[i] += force
                torque[i] += couple - p.radius[i] * np.cross(contact.n, force) * contact.rough
                on_wall[k] -= force
        if s.gravity is not None:
            f[:, : s.dimension] += p.mass[:, None] * s.gravity
        if s.background is not None:
            f -= s.background.translational_drag * self.v
        return f, torque, on_wall, np.reshape(pairs, (-1, 9))

    def near(self) -> list[np.ndarray]:
        """Return for every particle the later ones within a tenth of a radius, and those it has touched."""
        radius = self.s.particles.radius
        branch = self.branch(self.x[:, None] - self.x[None, :])
        within = (branch**2).sum(axis=2) < (radius[:, None] + radius + 0.1 * radius.min()) ** 2
        for i, j in self.memory:
            within[i, j] |= j > i
        return [np.flatnonzero(row) for row in np.triu(within, k=1)]

    def branch(self, apart):
        lengths = np.pad(self.s.periodic or (0.0,) * self.s.dimension, (0, 3 - self.s.dimension))
        period = np.where(lengths > 0, lengths, np.inf)
        return apart - np.round(apart / period) * lengths

    def holds(self, key, contact) -> bool:
        if _holds(self.s.normal, contact.overlap, contact.reduced_radius, key in self.memory):
            return True
        self.memory.pop(key, None)
        return False

    def pair(self, i, j) -> Touch:
        p = self.s.particles
        branch = self.branch(self.x[i] - self.x[j])
        distance, (a, b), (m, k) = np.linalg.norm(branch), p.radius[[i, j]], p.mass[[i, j]]
        return Touch(
            n=branch / distance, overlap=a + b - distance, velocity=self.v[i] - self.v[j], rough=self.turns,
            swept=a * self.w[i] + b * self.w[j], turning=self.w[i] - self.w[j],
            reduced_radius=a * b / (a + b), reduced_mass=m * k / (m + k),
        )

    def at_wall(self, i, k, wall_velocity) -> Touch:
        n, radius = self.normal[k], self.s.particles.radius[i]
        return Touch(
            n=n, overlap=radius - (self.x[i] - self.point[k] - self.shift[k]) @ n, swept=radius * self.w[i],
            velocity=self.v[i] - wall_velocity, rough=self.turns and self.s.walls[k].friction,
            turning=self.w[i], reduced_radius=radius, reduced_mass=self.s.particles.mass[i],
        )

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
        f, torque, on_wall, _ = self.forces(np.zeros_like(self.shift), dt=0.0)
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
                f, torque, on_wall, _ = self.forces((self.shift - before) / dt, dt=dt)
                push = self.on_loaded(on_wall)
                self.v += dt / 2 * f / p.mass[:, None]
                self.w += dt / 2 * torque / inertia
                self.rate[self.loaded] += dt / 2 * push / self.wall_mass
            else:
                self.place(0)
            if step % s.sample_every == 0:
                series.append([step, *np.column_stack([self.d, self.rate, on_wall[:, : s.dimension]]).ravel()])
            if step % s.frame_every == 0:
                pairs = self.forces(np.zeros_like(self.shift), dt=0.0)[3]
                frames.append({"x": self.x.copy(), "v": self.v.copy(), "w": self.w.copy(), "pairs": pairs})
        return frames, np.array(series)

    def react(self, path: Prescribed):
        dim, found = self.s.dimension, []
        for x, v, spin in zip(path.x[1:], path.v[1:], path.spin[1:], strict=True):
            self.x[:, :dim], self.v[:, :dim], self.w[:, -spin.shape[1]:] = x, v, spin
            found.append(self.forces(np.zeros_like(self.shift), dt=self.s.dt)[:2])
        force, torque = (np.array(values) for values in zip(*found, strict=True))
        return force, torque


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


@pytest.fixture(scope="session")
def formula():
    """`formula(system, path)` gives forces and torques (S, N, 3) along a prescribed path."""
    return lambda s, path: Reference(s).react(path)
