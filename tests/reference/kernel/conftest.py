"""Small systems for the kernel, and a plain DEM to hold it against: loops over scalars, no NumPy.

Units: radius 1, mass 1, k_n = 1e4, so that a head-on contact of two lasts t_c = 0.0222 and dt = t_c/50.
"""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from reference.kernel.conventions import CONVENTIONS
from reference.kernel.laws.linear import LinearNormal
from reference.kernel.laws.sliding import LAMMPS_TURN_THRESHOLD, SpringSliding
from reference.kernel.model import Constant, Cosine, Fixed, Loaded, Model, Wall
from reference.kernel.simulation import Simulation

KN = 1e4
CONTACT_TIME = math.pi / math.sqrt(2 * KN)
INERTIA_FACTOR = {2: 0.5, 3: 0.4}


def model(x, *, v=None, spin=None, radius=1.0, mass=1.0, walls=(), kn=KN, gn=0.0, clip=False, mu=None,
          kt=2.0 / 7.0 * KN, gt=0.0, convention="talk", dt=CONTACT_TIME / 50, **effects) -> Model:
    """x, v: one row a particle; `mu` None leaves friction out; `effects`: gravity, drag, periodic."""
    x = np.array(x, float)
    count, dim = x.shape
    radius, mass = (np.array(np.broadcast_to(value, count), float) for value in (radius, mass))
    spins = 1 if dim == 2 else 3
    chosen = CONVENTIONS[convention] if isinstance(convention, str) else convention
    sliding = None if mu is None else SpringSliding(
        shear_friction=mu, shear_stiffness=kt, shear_damping=gt, algorithm=chosen.sliding)
    return Model(
        x=np.ascontiguousarray(x.T), v=np.zeros((dim, count)) if v is None else np.array(v, float).T.copy(),
        spin=np.zeros((spins, count)) if spin is None else np.array(spin, float).reshape(count, spins).T.copy(),
        radius=radius, mass=mass, inertia=INERTIA_FACTOR[dim] * mass * radius**2, walls=tuple(walls),
        normal=LinearNormal(normal_stiffness=kn, normal_damping=gn, clip_attraction=clip),
        sliding=sliding, convention=chosen, dt=dt, **effects)


def wall(name, point, normal, *, friction=False, motion=None) -> Wall:
    size = math.sqrt(sum(c * c for c in normal))
    unit = tuple(c / size for c in normal)
    return Wall(name=name, point=tuple(point), normal=unit, friction=friction, motion=motion or Fixed())


def cluster(seed, dim, *, across=3, speed=1.0, squeeze=1.0, **options) -> Model:
    """`across`^dim particles of radii 0.8..1.2 on a jittered lattice, some overlapping, all moving."""
    rng = np.random.default_rng(seed)
    places = 2.0 * squeeze * np.stack(np.meshgrid(*[np.arange(across)] * dim), -1).reshape(-1, dim).astype(float)
    count = len(places)
    given = {
        "x": places + rng.uniform(-0.05, 0.05, places.shape) + 1.0, "radius": rng.uniform(0.8, 1.2, count),
        "mass": rng.uniform(0.5, 2.0, count), "v": speed * rng.normal(size=places.shape),
        "spin": speed * rng.normal(size=(count, 1 if dim == 2 else 3)),
    }
    return model(**(given | options))


def box(side, dim, *, friction=()):
    """Fixed walls around (0, side)^dim; `friction` names the rough ones among x0, x1, y0, .."""
    eye = np.eye(dim)
    sides = [(f"{'xyz'[a]}{s}", side * s * eye[a], (1 - 2 * s) * eye[a]) for a in range(dim) for s in (0, 1)]
    return [wall(name, point, normal, friction=name in friction) for name, point, normal in sides]


def run(simulation, steps) -> Simulation:
    for _ in range(steps):
        simulation.advance()
    return simulation


def frozen_bytes(simulation) -> bytes:
    """The whole state to the last bit, springs by pair."""
    s = simulation.state
    arrays = [s.x, s.v, s.spin, s.force, s.wall_d, s.wall_rate, s.wall_force]
    for k in simulation.interactions:
        if k.pairs.spring is not None:
            held = np.flatnonzero(k.pairs.spring.any(axis=0))
            arrays += [k.pairs.i[held], k.pairs.j[held], k.pairs.spring[:, held]]
    return b"".join(np.ascontiguousarray(a + 0.0 if a.dtype == float else a).tobytes() for a in arrays)


def energy(simulation) -> float:
    """Kinetic, rotational and elastic (normal springs)."""
    s, m = simulation.state, simulation.model
    v, spin = s.v[:, : m.particle_count], s.spin[:, : m.particle_count]
    moving = 0.5 * (m.mass * v**2).sum() + 0.5 * (m.inertia * spin**2).sum()
    return moving + sum(m.normal.energy(f.contact.overlap).sum() for _, f in simulation.contacts())


def angular_momentum(simulation) -> np.ndarray:
    """About the origin, spin included: three components (0, 0, L) in 2D."""
    s, m = simulation.state, simulation.model
    n = m.particle_count
    x, v, spin = (_three(a[:, :n].T) for a in (s.x, s.v, np.vstack([0 * s.x, s.spin]) if m.dimension == 2 else s.spin))
    return (m.mass[:, None] * np.cross(x, v) + m.inertia[:, None] * spin).sum(axis=0)


def _three(rows):
    return np.hstack([rows, np.zeros((len(rows), 3 - rows.shape[1]))])


# --- the plain DEM: 3-component lists throughout, 2D as z = 0 and spin (0, 0, w) -------------------


def add(a, b, factor=1.0):
    return [p + factor * q for p, q in zip(a, b, strict=True)]


def scaled(a, factor):
    return [factor * p for p in a]


def inner(a, b):
    return sum(p * q for p, q in zip(a, b, strict=True))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def length(a):
    return math.sqrt(inner(a, a))


def plain_normal(law, overlap, v_n):
    force = law.normal_stiffness * overlap - law.normal_damping * v_n
    return 0.0 if law.clip_attraction and force < 0 else force


def plain_sliding(law, xi, n, v_t, f_n, dt, advance):
    """One contact by the words of the three papers and programs; returns (force on i, new spring)."""
    return {"lammps": _plain_lammps, "liggghts": _plain_liggghts, "talk": _plain_talk}[law.algorithm](
        law, xi, n, v_t, f_n, dt, advance)


def _turned_with_length(xi, n):
    tangent = add(xi, n, -inner(xi, n))
    return scaled(tangent, length(xi) / length(tangent)) if length(tangent) > 0 else tangent


def _cut(test, limit):
    return scaled(test, limit / length(test)) if length(test) > limit else test


def _plain_lammps(law, xi, n, v_t, f_n, dt, advance):
    kt, gt, limit = law.shear_stiffness, law.shear_damping, law.shear_friction * abs(f_n)
    if advance:
        if abs(inner(xi, n)) * kt > LAMMPS_TURN_THRESHOLD * limit:
            xi = _turned_with_length(xi, n)
        xi = add(xi, v_t, dt)
    test = add(scaled(xi, -kt), v_t, -gt)
    if length(test) <= limit:
        return test, xi
    if not advance:
        return (_cut(test, limit) if length(xi) > 0 else [0.0, 0.0, 0.0]), xi
    force = _cut(test, limit)
    return force, scaled(add(force, v_t, gt), -1 / kt)


def _plain_liggghts(law, xi, n, v_t, f_n, dt, advance):
    kt, gt, limit = law.shear_stiffness, law.shear_damping, law.shear_friction * abs(f_n)
    if advance:
        xi = add(xi, v_t, dt)
        xi = add(xi, n, -inner(xi, n))
    if kt * length(xi) > limit:
        force = _cut(scaled(xi, -kt), limit)
        return force, scaled(force, -1 / kt) if advance else xi
    return add(scaled(xi, -kt), v_t, -gt), xi


def _plain_talk(law, xi, n, v_t, f_n, dt, advance):
    kt, gt, limit = law.shear_stiffness, law.shear_damping, law.shear_friction * max(f_n, 0.0)
    if advance:
        xi = _turned_with_length(xi, n)
    test = add(scaled(xi, -kt), v_t, -gt)
    force = _cut(test, limit)
    if not advance:
        return force, xi
    if length(test) <= limit:
        return force, add(xi, v_t, dt)
    return force, scaled(add(force, v_t, gt), -1 / kt)


class PlainDem:
    """Velocity Verlet with half-step velocities in the forces, every pair tried in every step."""

    def __init__(self, m: Model):
        self.m = m
        self.x, self.v = ([_to_three(row) for row in a.T.tolist()] for a in (m.x, m.v))
        self.w = [[0.0, 0.0, *row] if m.dimension == 2 else row for row in m.spin.T.tolist()]
        self.wall_d, self.wall_rate = [0.0] * len(m.walls), [0.0] * len(m.walls)
        self.wall_n = [_to_three(w.normal) for w in m.walls]
        self.wall_v = [_to_three(w.motion.velocity) if isinstance(w.motion, Constant) else [0.0] * 3 for w in m.walls]
        self.wall_x = [_to_three(w.point) for w in m.walls]
        self.springs, self.time = {}, 0.0
        self.evaluate(advance=False)
        self.wall_a = self.wall_accelerations()

    def advance(self):
        dt = self.m.dt
        self.kick()
        for i in range(len(self.x)):
            self.x[i] = add(self.x[i], self.v[i], dt)
        self.time += dt
        self.move_walls()
        self.evaluate(advance=True)
        self.kick()
        self.wall_a = self.wall_accelerations()
        self.wall_rate = [r + 0.5 * dt * a for r, a in zip(self.wall_rate, self.wall_a, strict=True)]

    def kick(self):
        for i, (mass, inertia) in enumerate(zip(self.m.mass, self.m.inertia, strict=True)):
            self.v[i] = add(self.v[i], self.force[i], 0.5 * self.m.dt / mass)
            self.w[i] = add(self.w[i], self.torque[i], 0.5 * self.m.dt / inertia)

    def move_walls(self):
        dt = self.m.dt
        for k, w in enumerate(self.m.walls):
            before = self.wall_d[k]
            if isinstance(w.motion, Constant):
                self.wall_x[k] = add(self.wall_x[k], self.wall_v[k], dt)
                continue
            if isinstance(w.motion, Cosine):
                phase = min(self.time / w.motion.duration, 1.0)
                self.wall_d[k] = w.motion.travel / 2 * (1 - math.cos(math.pi * phase))
            if isinstance(w.motion, Loaded):
                self.wall_rate[k] += 0.5 * dt * self.wall_a[k]
                self.wall_d[k] += dt * self.wall_rate[k]
            self.wall_x[k] = add(_to_three(w.point), self.wall_n[k], self.wall_d[k])
            self.wall_v[k] = scaled(self.wall_n[k], (self.wall_d[k] - before) / dt)

    def wall_accelerations(self):
        result = []
        for k, w in enumerate(self.m.walls):
            pull = 0.0
            if isinstance(w.motion, Loaded):
                extent = 0.0
                if w.motion.span is not None:
                    a, b = w.motion.span
                    extent = inner(add(self.wall_x[b], self.wall_x[a], -1), self.wall_n[a])
                pull = (w.motion.load + w.motion.stress * extent + inner(self.wall_force[k], self.wall_n[k])
                        - w.motion.damping * self.wall_rate[k]) / w.motion.mass
            result.append(pull)
        return result

    def evaluate(self, *, advance):
        m, count = self.m, len(self.x)
        self.force, self.torque = ([[0.0] * 3 for _ in range(count)] for _ in range(2))
        self.wall_force = [[0.0] * 3 for _ in m.walls]
        self.rows, springs = [], {}
        for i in range(count):
            for j in range(i + 1, count):
                self.pair(i, j, springs, advance)
            for k in range(len(m.walls)):
                self.wall_contact(i, k, springs, advance)
            if m.gravity is not None:
                self.force[i] = add(self.force[i], _to_three(m.gravity), m.mass[i])
            if m.drag is not None:
                self.force[i] = add(self.force[i], self.v[i], -m.drag)
        self.springs = springs

    def pair(self, i, j, springs, advance):
        branch = add(self.x[i], self.x[j], -1)
        for axis, side in enumerate(self.m.periodic or ()):
            while side and branch[axis] > side / 2:
                branch[axis] -= side
            while side and branch[axis] < -side / 2:
                branch[axis] += side
        overlap = self.m.radius[i] + self.m.radius[j] - length(branch)
        if overlap <= 0:
            return
        n, c = scaled(branch, 1 / length(branch)), self.m.convention
        force = self.contact((i, j), n, overlap, add(self.v[i], self.v[j], -1), c.slip_arm, springs, advance)
        self.force[i], self.force[j] = add(self.force[i], force), add(self.force[j], force, -1)
        for p in (i, j):
            self.torque[p] = add(self.torque[p], cross(n, force), -self.arm(p, overlap, c.torque_arm))

    def wall_contact(self, i, k, springs, advance):
        n, c = self.wall_n[k], self.m.convention
        overlap = self.m.radius[i] - inner(add(self.x[i], self.wall_x[k], -1), n)
        if overlap <= 0:
            return
        v = add(self.v[i], self.wall_v[k], -1)
        force = self.contact((i, -1 - k), n, overlap, v, c.wall_slip_arm, springs, advance)
        self.force[i], self.wall_force[k] = add(self.force[i], force), add(self.wall_force[k], force, -1)
        if self.m.walls[k].friction:
            self.torque[i] = add(self.torque[i], cross(n, force), -self.arm(i, overlap, c.wall_torque_arm))

    def contact(self, key, n, overlap, v, arm, springs, advance):
        i, j = key
        v_n = inner(v, n)
        f_n = plain_normal(self.m.normal, overlap, v_n)
        rough = self.m.sliding is not None and (j >= 0 or self.m.walls[-1 - j].friction)
        force, spring = scaled(n, f_n), None
        if rough:
            turning = scaled(self.w[i], self.arm(i, overlap, arm))
            if j >= 0:
                turning = add(turning, self.w[j], self.arm(j, overlap, arm))
            v_t = add(add(v, n, -v_n), cross(turning, n), -1)
            old = self.springs.get(key, [0.0] * 3)
            f_t, spring = plain_sliding(self.m.sliding, old, n, v_t, f_n, self.m.dt, advance)
            force, springs[key] = add(force, f_t), spring
        self.rows.append((key, overlap, n, force, spring))
        return force

    def arm(self, i, overlap, kind):
        return self.m.radius[i] - (0.0 if kind == "radius" else overlap / 2)


def _to_three(row):
    return [*row, *[0.0] * (3 - len(row))]


@pytest.fixture(scope="session")
def dem() -> SimpleNamespace:
    """Builders, measures and the plain DEM."""
    return SimpleNamespace(
        model=model, wall=wall, cluster=cluster, box=box, run=run, bytes=frozen_bytes, energy=energy,
        angular_momentum=angular_momentum, KN=KN, tc=CONTACT_TIME, Simulation=Simulation,
        plain_normal=plain_normal, plain_sliding=plain_sliding, Plain=PlainDem)
