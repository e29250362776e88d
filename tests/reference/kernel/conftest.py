"""A plain DEM to hold the kernel against: loops over scalars and lists of three, no NumPy, none of its code.

Contact laws first, then the DEM. In two dimensions vectors have z = 0 and spins are (0, 0, w). At the end builders of
rings.
"""

import math
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from reference.kernel.conventions import NAMED
from reference.kernel.model import Constant, Cosine, Loaded, Model, Ring


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


def across(a, n):
    return add(a, n, -inner(a, n))


def reduced(q, i, j):
    return q[i] if j < 0 else 1 / (1 / q[i] + 1 / q[j])


# --- normal laws: (law, overlap, a*, m*, delta_max) -> elastic force, dashpot, adhesion, delta_max -----


def linear(law, d, a, m, top):
    return law.normal_stiffness * d, law.normal_damping, 0.0, top


def constant_restitution(e, stiffness, mass):
    beta = math.log(e) / math.sqrt(math.log(e) ** 2 + math.pi**2)
    return -2.0 * math.sqrt(5.0 / 6.0) * beta * math.sqrt(stiffness * mass)


def hertz(law, d, a, m, top):
    modulus = law.youngs_modulus / 2.0 / (1.0 - law.poisson_ratio**2)
    gamma = constant_restitution(law.restitution, 2.0 * modulus * math.sqrt(a * d), m) if law.restitution < 1 else 0.0
    return 4.0 / 3.0 * modulus * math.sqrt(a) * d**1.5, gamma, 0.0, top


def hysteretic(law, d, a, m, top):
    return branches(law, law.unloading_stiffness, d, max(top, d), None)


def hysteretic_variable(law, d, a, m, top):
    k1, kp, top = law.loading_stiffness, law.largest_unloading_stiffness, max(top, d)
    limit = kp / (kp - k1) * law.plasticity_depth * 2.0 * a
    if top >= limit:
        return branches(law, kp, d, top, (1.0 - k1 / kp) * limit)
    return branches(law, k1 + (kp - k1) * top / limit, d, top, None)


def branches(law, k2, d, top, zero):
    """Loading, un- and reloading, adhesion; `zero`: delta_0 where it is capped."""
    k1, kc = law.loading_stiffness, law.adhesion_stiffness
    capped, zero = zero is not None, (1.0 - k1 / k2) * top if zero is None else zero
    back = k2 * (d - zero)
    if back >= k1 * d and not capped:
        return k1 * d, law.normal_damping, kc * d, top
    if back > -kc * d:
        return back, law.normal_damping, kc * d, top
    return -kc * d, law.normal_damping, kc * d, (k2 + kc) / (k2 - k1) * d


def dmt(law, d, a, m, top):
    modulus, pull = law.youngs_modulus / 2.0 / (1.0 - law.poisson_ratio**2), 4.0 * math.pi * law.surface_energy * a
    return 4.0 / 3.0 * modulus * math.sqrt(a) * d**1.5 - pull, law.normal_damping, pull, top


NORMAL = {"LinearNormal": linear, "HertzNormal": hertz, "HystereticNormal": hysteretic,
          "VariableHystereticNormal": hysteretic_variable, "DmtNormal": dmt}


def normal(law, d, v_n, a, m, top):
    """Return f_n, f_el, the strongest pull at this overlap, delta_max."""
    elastic, gamma, pull, top = NORMAL[type(law).__name__](law, d, a, m, top)
    total = elastic - gamma * v_n
    return (0.0 if law.attraction == "clipped" and total < 0 else total), elastic, pull, top


def grip(law, total, elastic, pull):  # what coefficients of friction multiply, before the convention's rule of signs
    return elastic + 2.0 * pull if type(law).__name__ == "DmtNormal" else total + pull


# --- sticking and sliding, by the words of the papers and programs --------------------------------------


def slide(algorithm, spring, given, n, v, dt, advance):
    """spring: (xi, slides). given: stiffness, damping, mu, mu_d, base. Return force, spring, whether it slides now."""
    act = {"lammps": lammps, "liggghts": liggghts, "talk": talk, "lammps_twisting": twisting}[algorithm]
    return act(spring, given, n, v, dt, advance)


def turned_with_length(xi, n):
    tangent = across(xi, n)
    return scaled(tangent, length(xi) / length(tangent)) if length(tangent) > 0 else tangent


def limits(slid, given):
    dynamic = given.mu if given.mu_d is None else given.mu_d
    return (dynamic if slid else given.mu) * given.base, dynamic * given.base


def left_behind(force, v, given):
    return scaled(add(force, v, given.damping), -1 / given.stiffness)


def lammps(spring, given, n, v, dt, advance):
    xi, slid = spring
    limit, carried = limits(slid, given)
    if advance:
        if n is not None and abs(inner(xi, n)) * given.stiffness > 1e-10 * limit:
            xi = turned_with_length(xi, n)
        xi = add(xi, v, dt)
    test = add(scaled(xi, -given.stiffness), v, -given.damping)
    if length(test) <= limit:
        return test, (xi, False), False
    force = scaled(test, carried / length(test))
    if not advance:
        return (force if length(xi) > 0 else [0.0] * len(xi)), (xi, slid), True
    return force, (left_behind(force, v, given), True), True


def twisting(spring, given, n, v, dt, advance):
    xi, slid = spring
    limit, carried = limits(slid, given)
    if advance:
        xi = add(xi, v, dt)
    test = add(scaled(xi, -given.stiffness), v, -given.damping)
    if length(test) <= limit:
        return test, (xi, False), False
    force = [-carried * (1 if v[0] > 0 else -1 if v[0] < 0 else 0)]
    return force, (left_behind(force, v, given), True), True


def liggghts(spring, given, n, v, dt, advance):
    kept = xi = spring[0]
    limit, carried = limits(False, given)
    if advance or n is None:
        xi = add(xi, v, dt)
    if advance and n is not None:
        xi = across(xi, n)
    slides = given.stiffness * length(xi) > limit
    if slides:
        xi = scaled(xi, carried / given.stiffness / length(xi))
    force = scaled(xi, -given.stiffness)
    return (force if slides else add(force, v, -given.damping)), (xi if advance else kept, False), slides


def talk(spring, given, n, v, dt, advance):
    xi, slid = spring
    limit, carried = limits(slid, given)
    if advance and n is not None:
        xi = turned_with_length(xi, n)
    test = add(scaled(xi, -given.stiffness), v, -given.damping)
    slides = length(test) > limit
    if not advance:
        return cut_to(test, carried, slides), spring, slides
    if slid and given.mu_d is not None:
        coming = add(scaled(add(xi, v, dt), -given.stiffness), v, -given.damping)
        slides = length(coming) > limit and length(test) > 0
    slides = slides or limit == 0
    force = cut_to(test, carried, slides)
    return force, (left_behind(force, v, given) if slides else add(xi, v, dt), slides), slides


def cut_to(test, carried, slides):
    return scaled(test, carried / length(test)) if slides and length(test) > 0 else test


def numbers(stiffness, damping, mu, base, mu_d=None):
    return SimpleNamespace(**locals())


# --- sliding, rolling, torsion -------------------------------------------------------------------------


def sliding(law, c, spring, dt, advance):
    """Force on i, new spring, whether it slides."""
    word = type(law).__name__
    if word == "ViscousSliding":
        limit = law.shear_friction * (c.base if law.limit == "base" else abs(c.total))
        drag = law.shear_damping * length(c.v_t)
        return scaled(c.v_t, -law.shear_damping * (limit / drag if drag > limit else 1.0)), None, drag > limit
    if word == "MindlinSliding":
        e, nu = law.normal.youngs_modulus, law.normal.poisson_ratio
        stiffness = 2.0 * e / (2.0 - nu) / (1.0 + nu) * math.sqrt(c.a * c.overlap)
        damping = constant_restitution(law.normal.restitution, stiffness, c.m) if law.normal.restitution < 1 else 0.0
        given = numbers(stiffness, damping, law.shear_friction, c.base)
    else:
        given = numbers(law.shear_stiffness, law.shear_damping, law.shear_friction, c.base, law.dynamic_friction)
    return slide(law.algorithm, spring or ([0.0] * 3, False), given, c.n, c.v_t, dt, advance)


def rolling(law, c, spring, dt, advance):
    if type(law).__name__ == "ConstantRolling":
        return constant_rolling(law, c), None, None
    given = numbers(law.rolling_stiffness, law.rolling_damping, law.rolling_friction, c.base)
    spring = spring or ([0.0] * 3, False)
    if law.frame == "space":
        force, spring, slides = slide(law.algorithm, spring, given, None, scaled(across(c.spin, c.n), c.a), dt, advance)
        return scaled(force, c.a), spring, slides
    v_r = scaled(add(cross(c.n, c.spin_i), cross(c.n, c.spin_j), -1), -c.a)
    force, spring, slides = slide(law.algorithm, spring, given, c.n, v_r, dt, advance)
    return scaled(cross(c.n, force), c.a), spring, slides


def constant_rolling(law, c):
    along = across(c.spin, c.n)
    if law.algorithm == "liggghts":
        plastic = "Hysteretic" in type(law.normal).__name__
        force, size = law.normal.loading_stiffness * c.overlap if plastic else c.elastic, length(c.spin)
    else:
        force, size = grip(law.normal, c.elastic, c.elastic, c.pull), length(along)
    return scaled(along, -law.rolling_friction * c.a * force / size) if size else [0.0] * 3


def torsion(law, c, spring, dt, advance):
    given = numbers(law.torsion_stiffness, law.torsion_damping, law.torsion_friction, c.base)
    v_o = [c.a * inner(c.n, c.spin)]
    force, spring, slides = slide(law.algorithm, spring or ([0.0], False), given, None, v_o, dt, advance)
    return scaled(c.n, c.a * force[0]), spring, slides


# --- the plain DEM ----------------------------------------------------------------------------------------


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
        self.memory, self.time = {}, 0.0
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
        self.rows, memory = [], {}
        for i in range(count):
            for j in range(i + 1, count):
                self.pair(i, j, memory, advance)
            for k in range(len(m.walls)):
                self.wall_contact(i, k, memory, advance)
            if m.gravity is not None:
                self.force[i] = add(self.force[i], _to_three(m.gravity), m.mass[i])
            if m.drag is not None:
                self.force[i] = add(self.force[i], self.v[i], -m.drag)
        if advance or not self.time:
            self.memory = memory

    def pair(self, i, j, memory, advance):
        branch = add(self.x[i], self.x[j], -1)
        for axis, side in enumerate(self.m.periodic or ()):
            while side and branch[axis] > side / 2:
                branch[axis] -= side
            while side and branch[axis] < -side / 2:
                branch[axis] += side
        overlap = self.m.radius[i] + self.m.radius[j] - length(branch)
        if overlap <= 0:
            return
        n = scaled(branch, 1 / length(branch))
        force, couple = self.contact((i, j), n, overlap, add(self.v[i], self.v[j], -1), memory, advance)
        self.force[i], self.force[j] = add(self.force[i], force), add(self.force[j], force, -1)
        for p, sign in ((i, 1), (j, -1)):
            self.torque[p] = add(self.torque[p], couple, sign)
            if self.m.sliding is not None:
                arm = self.arm(p, overlap, self.m.convention.torque_arm)
                self.torque[p] = add(self.torque[p], cross(n, force), -arm)

    def wall_contact(self, i, k, memory, advance):
        n = self.wall_n[k]
        overlap = self.m.radius[i] - inner(add(self.x[i], self.wall_x[k], -1), n)
        if overlap <= 0:
            return
        force, couple = self.contact((i, -1 - k), n, overlap, add(self.v[i], self.wall_v[k], -1), memory, advance)
        self.force[i], self.wall_force[k] = add(self.force[i], force), add(self.wall_force[k], force, -1)
        self.torque[i] = add(self.torque[i], couple)
        if self.m.walls[k].friction and self.m.sliding is not None:
            arm = self.arm(i, overlap, self.m.convention.wall_torque_arm)
            self.torque[i] = add(self.torque[i], cross(n, force), -arm)

    def contact(self, key, n, overlap, v, memory, advance):
        m, j, kept, new = self.m, key[1], self.memory.get(key, {}), {}
        v_n, a, mass = inner(v, n), reduced(m.radius, *key), reduced(m.mass, *key)
        total, elastic, pull, new["normal"] = normal(m.normal, overlap, v_n, a, mass, kept.get("normal", 0.0))
        force, couple, slides = scaled(n, total), [0.0] * 3, {}
        c = SimpleNamespace(n=n, overlap=overlap, total=total, elastic=elastic, pull=pull, a=a, m=mass)
        if j >= 0 or m.walls[-1 - j].friction:
            gripping = grip(m.normal, total, elastic, pull)
            c.base = abs(gripping) if m.convention.limit == "absolute" else max(gripping, 0.0)
            self.turning(c, key, add(v, n, -v_n), advance)
            if m.sliding is not None:
                f_t, new["sliding"], slides["sliding"] = sliding(m.sliding, c, kept.get("sliding"), m.dt, advance)
                force = add(force, f_t)
            for family in ("rolling", "torsion"):
                law = getattr(m, family)
                if law is not None:
                    act = {"rolling": rolling, "torsion": torsion}[family]
                    q, new[family], slides[family] = act(law, c, kept.get(family), m.dt, advance)
                    couple = add(couple, q)
        memory[key] = new
        self.rows.append(SimpleNamespace(key=key, overlap=overlap, n=n, force=force, memory=new, slides=slides))
        return force, couple

    def turning(self, c, key, v_across, advance):
        (i, j), convention = key, self.m.convention
        c.spin_i, c.spin_j = self.w[i], self.w[j] if j >= 0 else [0.0] * 3
        slip = convention.slip_arm if j >= 0 else convention.wall_slip_arm
        turning = scaled(self.w[i], self.arm(i, c.overlap, slip))
        if j >= 0:
            turning = add(turning, self.w[j], self.arm(j, c.overlap, slip))
        elif convention.wall_spin == "raised":
            radius = self.m.radius[i]
            c.spin_i = scaled(self.w[i], (radius - c.overlap / 2) / (radius - c.overlap))
        c.v_t, c.spin = add(v_across, cross(turning, c.n), -1), add(c.spin_i, c.spin_j, -1)
        if convention.slip_normal == "middle" and j >= 0 and advance:
            distance = self.m.radius[i] + self.m.radius[j] - c.overlap
            halfway = add(c.n, v_across, -self.m.dt / 2 / distance)
            c.v_t = across(add(v_across, cross(turning, halfway), -1), c.n)

    def arm(self, i, overlap, kind):
        return self.m.radius[i] - (0.0 if kind == "radius" else overlap / 2)


def _to_three(row):
    return [*row, *[0.0] * (3 - len(row))]


@pytest.fixture(scope="session")
def dem(build) -> SimpleNamespace:
    """Builders, measures, the plain DEM and its laws."""
    plain = SimpleNamespace(normal=normal, slide=slide, numbers=numbers)
    return SimpleNamespace(**vars(build), Plain=PlainDem, plain=plain)


@pytest.fixture(scope="session")
def annulus(build) -> SimpleNamespace:
    """Builders of rings, and of models between two of them; all other arguments are those of `build.model`."""
    return SimpleNamespace(ring=glued_ring, between=partial(between_rings, build))


def glued_ring(name, circle, *, radius=0.5, omega=None, centre=(0.0, 0.0), count=None) -> Ring:
    """Discs on a circle, side by side, or `count` of them."""
    angle = 2 * np.pi * np.arange(count or round(np.pi * circle / radius)) / (count or round(np.pi * circle / radius))
    x = np.array(centre)[:, None] + circle * np.stack([np.cos(angle), np.sin(angle)])
    return Ring(name=name, centre=centre, x=x, radius=np.full(len(angle), radius), omega=omega)


def between_rings(build, seed=1, *, omegas=(0.8, -0.3), centre=(0.3, -0.2), squeeze=1.0, **options) -> Model:
    """Two layers of unequal discs, with their own velocities and spins, between circles of radii 3 and 8."""
    rng = np.random.default_rng(seed)
    layers = [(r, count) for r, count in ((4.5, 14), (6.4, 20))]
    angle = np.concatenate([2 * np.pi * np.arange(count) / count for _, count in layers])
    distance = np.concatenate([np.full(count, r) for r, count in layers]) + rng.uniform(-0.1, 0.1, len(angle))
    given = {
        "x": np.array(centre) + (distance * np.array([np.cos(angle), np.sin(angle)])).T,
        "v": rng.normal(size=(len(angle), 2)), "spin": rng.normal(size=len(angle)), "gn": 5.0,
        "radius": squeeze * rng.uniform(0.85, 1.1, len(angle)), "mass": rng.uniform(0.5, 2.0, len(angle)),
        "rings": (glued_ring("inner", 3.0, omega=omegas[0], centre=centre),
                  glued_ring("outer", 8.0, omega=omegas[1], centre=centre)),
    }
    return build.model(**(given | options))


@pytest.fixture(scope="session")
def named() -> dict:
    """All conventions that a deck can name."""
    return NAMED
