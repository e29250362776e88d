"""Small systems for the kernel, and measures of them.

Units: radius 1, mass 1, k_n = 1e4, so that a head-on contact of two lasts t_c = 0.0222 and dt = t_c/50.
"""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from reference.kernel.conventions import CONVENTIONS
from reference.kernel.laws.registry import build_law
from reference.kernel.model import Fixed, Model, Wall
from reference.kernel.simulation import Simulation

KN = 1e4
CONTACT_TIME = math.pi / math.sqrt(2 * KN)
INERTIA_FACTOR = {2: 0.5, 3: 0.4}


SPHERES = {"youngs_modulus": 3e4, "poisson_ratio": 0.3}
TABLES = {
    ("normal", "linear"): {"normal_stiffness": KN, "normal_damping": 12.0, "attraction": "allowed"},
    ("normal", "hertz"): SPHERES | {"restitution": 0.8, "attraction": "allowed"},
    ("normal", "hysteretic"): {
        "loading_stiffness": 4e3, "unloading_stiffness": 1e4, "adhesion_stiffness": 2e3, "normal_damping": 5.0},
    ("normal", "hysteretic_variable"): {
        "loading_stiffness": 4e3, "largest_unloading_stiffness": 1.2e4, "adhesion_stiffness": 2e3,
        "plasticity_depth": 0.05, "normal_damping": 5.0},
    ("normal", "dmt"): SPHERES | {"surface_energy": 5.0, "normal_damping": 5.0},
    ("sliding", "spring"): {"shear_friction": 0.4, "shear_stiffness": 3e3, "shear_damping": 5.0},
    ("sliding", "mindlin"): {"shear_friction": 0.4},
    ("sliding", "viscous"): {"shear_friction": 0.4, "shear_damping": 40.0},
    ("rolling", "spring"): {"rolling_friction": 0.2, "rolling_stiffness": 2e3, "rolling_damping": 3.0},
    ("rolling", "constant"): {"rolling_friction": 0.05},
    ("torsion", "spring"): {"torsion_friction": 0.15, "torsion_stiffness": 2e3, "torsion_damping": 3.0},
}
"""Every law with numbers that suit these units, by family and word."""


def table(family, word, **changes) -> dict:
    """The deck table of a law."""
    return {"law": word} | TABLES[family, word] | changes


def contact_with(family, word, **changes) -> dict:
    """The tables of a contact that has the law: a linear normal law unless the law is one, or leans on another."""
    normal = table("normal", "hertz" if word == "mindlin" else "linear")
    return {"normal": normal} | {family: table(family, word, **changes)}


def model(x, *, v=None, spin=None, radius=1.0, mass=1.0, walls=(), kn=KN, gn=0.0, clip=False, mu=None,
          kt=2.0 / 7.0 * KN, gt=0.0, normal=None, sliding=None, rolling=None, torsion=None, convention="talk",
          dt=CONTACT_TIME / 50, **effects) -> Model:
    """x, v: one row a particle; law tables as in a deck, or linear contact (kn, gn, clip) with a spring (mu, kt, gt).

    `mu` None leaves friction out; `effects`: gravity, drag, periodic.
    """
    x = np.array(x, float)
    count, dim = x.shape
    radius, mass = (np.array(np.broadcast_to(value, count), float) for value in (radius, mass))
    spins = 1 if dim == 2 else 3
    chosen = CONVENTIONS[convention] if isinstance(convention, str) else convention
    normal = normal or linear_table(kn, gn, clip)
    sliding = spring_table(mu, kt, gt) if sliding is None and mu is not None else sliding
    return Model(
        x=np.ascontiguousarray(x.T), v=np.zeros((dim, count)) if v is None else np.array(v, float).T.copy(),
        spin=np.zeros((spins, count)) if spin is None else np.array(spin, float).reshape(count, spins).T.copy(),
        radius=radius, mass=mass, inertia=INERTIA_FACTOR[dim] * mass * radius**2, walls=tuple(walls),
        **laws(chosen, normal=normal, sliding=sliding, rolling=rolling, torsion=torsion), convention=chosen, dt=dt,
        **effects)


def linear_table(kn, gn, clip) -> dict:
    return {"law": "linear", "normal_stiffness": kn, "normal_damping": gn,
            "attraction": "clipped" if clip else "allowed"}


def spring_table(mu, kt, gt) -> dict:
    return {"law": "spring", "shear_friction": mu, "shear_stiffness": kt, "shear_damping": gt}


def laws(convention, *, normal, **tangential) -> dict:
    """The laws of deck tables, as a model has them."""
    pressed = build_law("normal", normal, convention)
    return {"normal": pressed, **{
        family: None if table is None else build_law(family, table, convention, pressed)
        for family, table in tangential.items()}}


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
    """The whole state to the last bit, memories by pair."""
    s = simulation.state
    arrays = [s.x, s.v, s.spin, s.force, s.wall_d, s.wall_rate, s.wall_force]
    for k in simulation.interactions:
        for memory in k.pairs.memory.values():
            held = np.flatnonzero(memory.any(axis=0))
            arrays += [k.pairs.i[held], k.pairs.j[held], memory[:, held]]
    return b"".join(np.ascontiguousarray(a + 0.0 if a.dtype == float else a).tobytes() for a in arrays)


def energy(simulation) -> float:
    """Kinetic, rotational and elastic (normal springs)."""
    s, m = simulation.state, simulation.model
    v, spin = s.v[:, : m.particle_count], s.spin[:, : m.particle_count]
    moving = 0.5 * (m.mass * v**2).sum() + 0.5 * (m.inertia * spin**2).sum()
    return moving + sum(m.normal.energy(f.contact).sum() for _, f in simulation.contacts())


def angular_momentum(simulation) -> np.ndarray:
    """About the origin, spin included: three components (0, 0, L) in 2D."""
    s, m = simulation.state, simulation.model
    n = m.particle_count
    x, v, spin = (_three(a[:, :n].T) for a in (s.x, s.v, np.vstack([0 * s.x, s.spin]) if m.dimension == 2 else s.spin))
    return (m.mass[:, None] * np.cross(x, v) + m.inertia[:, None] * spin).sum(axis=0)


def _three(rows):
    return np.hstack([rows, np.zeros((len(rows), 3 - rows.shape[1]))])


@pytest.fixture(scope="session")
def build() -> SimpleNamespace:
    """Builders and measures."""
    return SimpleNamespace(
        model=model, laws=laws, tables=TABLES, table=table, contact_with=contact_with, wall=wall, cluster=cluster,
        box=box, run=run, bytes=frozen_bytes, energy=energy, angular_momentum=angular_momentum, KN=KN, tc=CONTACT_TIME,
        Simulation=Simulation)
