"""Every law that LIGGGHTS has, in all its mappings, against the kernel in LIGGGHTS' conventions."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from harness.engines.liggghts import LIGGGHTS
from harness.engines.liggghts.deck import INPUT
from harness.engines.protocol import Prescribed
from harness.scene.contact import (
    ConstantRolling,
    HertzNormal,
    HystereticNormal,
    LinearNormal,
    MindlinSliding,
    SpringRolling,
    SpringSliding,
    VariableHystereticNormal,
    ViscousSliding,
)
from harness.scene.system import Loaded

pytestmark = pytest.mark.needs_liggghts

ROWS, DT = 240, 2e-6
RADII = np.array([1.0, 1.25, 0.8, 1.1, 1.0, 1.3]) * 1e-3
MASSES = np.array([6.0, 11.0, 3.5, 7.0, 6.0, 12.0]) * 1e-5

LINEAR = LinearNormal(normal_stiffness=1e5, normal_damping=1.0, attraction="allowed")
HERTZ = HertzNormal(youngs_modulus=1e8, poisson_ratio=0.25, restitution=0.6, attraction="allowed", impact_speed=1.0)
PLASTIC = HystereticNormal(
    loading_stiffness=5e4, unloading_stiffness=1e5, adhesion_stiffness=4e4, normal_damping=0.5
)
VARIABLE = VariableHystereticNormal(
    loading_stiffness=5e4, largest_unloading_stiffness=1e5, adhesion_stiffness=4e4, plasticity_depth=0.02,
    normal_damping=0.5,
)
SPRING = SpringSliding(shear_friction=0.3, shear_stiffness=3e4, shear_damping=0.2)
TWO_COEFFICIENTS = SpringSliding(shear_friction=0.3, shear_stiffness=3e4, shear_damping=0.2, dynamic_friction=0.2)
ROLLING = SpringRolling(rolling_friction=0.1, rolling_stiffness=1e4, rolling_damping=0.05)
UNDAMPED_ROLLING = SpringRolling(rolling_friction=0.1, rolling_stiffness=3e4, rolling_damping=0.0)
CONSTANT = ConstantRolling(rolling_friction=0.1)


def changed(law, **fields):
    return type(law)(**({f: getattr(law, f) for f in law.__struct_fields__} | fields))


LAWS = {
    "linear": ({"normal": LINEAR}, "model hooke/stiffness absolute"),
    "clipped": ({"normal": changed(LINEAR, attraction="clipped"), "sliding": SPRING}, "limitForce on"),
    "linear, spring": ({"normal": LINEAR, "sliding": SPRING}, "tangential history"),
    "linear, viscous": (
        {"normal": LINEAR, "sliding": ViscousSliding(shear_friction=0.3, shear_damping=0.7)}, "no_history"),
    "k_r = k_t": ({"normal": LINEAR, "sliding": SPRING, "rolling": UNDAMPED_ROLLING}, "epsd2"),
    "k_t is free": ({"normal": LINEAR, "rolling": UNDAMPED_ROLLING}, "epsd2"),
    "linear, rolling": ({"normal": LINEAR, "sliding": SPRING, "rolling": ROLLING}, "epsd3"),
    "linear, constant": ({"normal": LINEAR, "sliding": SPRING, "rolling": CONSTANT}, "cdt"),
    "hertz": ({"normal": HERTZ}, "model hertz"),
    "hertz, clipped, mindlin": (
        {"normal": changed(HERTZ, attraction="clipped"), "sliding": MindlinSliding(shear_friction=0.3)},
        "tangential history"),
    "soft": ({"normal": changed(HERTZ, youngs_modulus=2e6, restitution=1.0)}, "soft_particles yes"),
    "hard": ({"normal": changed(HERTZ, youngs_modulus=2e9), "rolling": CONSTANT}, "hard_particles yes"),
    "plastic": ({"normal": PLASTIC}, "model edinburgh/stiffness"),
    "plastic, elastic damping": ({"normal": changed(PLASTIC, normal_damping=0.0)}, "limitForce off"),
    "plastic, spring": ({"normal": PLASTIC, "sliding": SPRING}, "tan_luding"),
    "tangential dashpot alone": ({"normal": changed(PLASTIC, normal_damping=0.0), "sliding": SPRING}, "tan_luding"),
    "two coefficients, springs": (
        {"normal": changed(PLASTIC, normal_damping=0.0), "sliding": changed(TWO_COEFFICIENTS, shear_damping=0.0)},
        "FluidViscosity"),
    "two coefficients": ({"normal": PLASTIC, "sliding": TWO_COEFFICIENTS}, "FluidViscosity"),
    "not adhesive, rolling": (
        {"normal": changed(PLASTIC, adhesion_stiffness=0.0), "sliding": SPRING, "rolling": ROLLING}, "epsd3"),
    "plastic, rolling": (
        {"normal": PLASTIC, "sliding": changed(SPRING, shear_damping=0.0), "rolling": ROLLING}, "friction luding"),
    "rolling dashpot alone": (
        {"normal": changed(VARIABLE, normal_damping=0.0), "rolling": ROLLING}, "friction luding"),
    "variable": ({"normal": VARIABLE}, "model luding"),
    "variable, everything": (
        {"normal": VARIABLE, "sliding": TWO_COEFFICIENTS, "rolling": ROLLING}, "luding tangential tan_luding"),
}
"""Laws, and a word that their deck must have."""

FLAT = (
    "linear, spring", "linear, rolling", "linear, constant", "hertz, clipped, mindlin", "plastic, rolling",
    "rolling dashpot alone", "variable, everything",
)
"""Of these a 2D run needs numbers of its own, or shows another part."""

LEVEL, OBLIQUE = (0.0, 1.0, 0.0), (-0.1, 1.0, 0.05)
BOTH_DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])


def path_of(dimension: int) -> Prescribed:
    """Two pairs, of which one is a light and one a heavy one, and two bodies on the floor, all on wild ways.

    Overlaps come, ripple and go twice; normals of the pairs turn, bodies spin and shear beyond their limits.
    """
    time = np.linspace(0.0, 1.0, ROWS + 1)
    x, v, spin = np.zeros((ROWS + 1, 6, 3)), np.zeros((ROWS + 1, 6, 3)), np.zeros((ROWS + 1, 6, 3))
    for k, (i, j) in enumerate(((0, 1), (2, 3))):
        turn, tilt = 0.8 * k + 0.5 * time, 0.4 * np.sin(3.0 * time + k) * (dimension - 2)
        n = np.stack([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)], axis=1)
        middle = np.array([6e-3 * k, 5e-3, 0.0])
        apart = (RADII[i] + RADII[j] - overlap_at(time, k))[:, None]
        x[:, i], x[:, j] = middle + 0.5 * apart * n, middle - 0.5 * apart * n
    for k, i in enumerate((4, 5)):
        x[:, i] = np.stack([5e-3 * k + 2e-4 * np.sin(7 * time), RADII[i] - overlap_at(time, k + 2), 0.0 * time], axis=1)
        x[:, i, 2] = (dimension - 2) * 1e-4 * np.cos(5 * time)
    v[1:] = np.diff(x, axis=0) / DT
    phases = np.arange(18).reshape(6, 3)
    spin[:] = 300.0 * np.sin((5.0 + phases % 4) * time[:, None, None] + phases)
    if dimension == 3:
        return Prescribed(x=x, v=v, spin=spin)
    return Prescribed(x=x[..., :2].copy(), v=v[..., :2].copy(), spin=spin[..., 2:].copy())


def overlap_at(time: np.ndarray, k: int) -> np.ndarray:
    """Overlap of contact k (m): apart at the start, two contacts with ripples, apart at the end."""
    return 1e-6 * (12.0 - 19.0 * np.cos(4.0 * np.pi * time) + (4.0 + k) * np.sin(31.0 * time))


def lab_system(make, plane, laws: dict, dimension: int):
    path = path_of(dimension)
    floor = plane(1, "floor", (0.0,) * dimension, (0.0, 1.0, 0.0)[:dimension], friction=True)
    return make(x=path.x[0], radius=RADII, mass=MASSES, walls=[floor], dt=DT, contacts=False, **laws), path


def deviation(got: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(got - expected).max() / max(np.abs(expected).max(), 1e-300))


@pytest.mark.parametrize(("name", "dimension"), [*((name, 3) for name in LAWS), *((name, 2) for name in FLAT)])
def test_prescribed_motion(make, plane, lead, answer, name, dimension):
    laws, word = LAWS[name]
    system, path = lab_system(make, plane, laws, dimension)
    assert not [s for s in LIGGGHTS.supports(system) if s.level == "unsupported"]
    assert word in LIGGGHTS.render_prescribed(system)[INPUT]
    got, expected = lead(system, path), answer(system, path)
    touched = np.abs(expected.force).max(axis=(0, 2))
    assert (touched > 0.1 * touched.max()).all(), "every body must have met its partner"
    assert deviation(got.force, expected.force) < 1e-12
    if np.any(expected.torque):
        assert deviation(got.torque, expected.torque) < 1e-12
    else:
        assert not got.torque.any()


@BOTH_DIMENSIONS
def test_prescribed_motion_at_an_oblique_plane(make, plane, lead, answer, dimension):
    """A triangle instead of a primitive plane: the distance loses digits with the size of the triangle."""
    floor = plane(1, "slope", (0.0,) * dimension, (-0.6, 0.8, 0.0)[:dimension], friction=True)
    path = path_of(dimension)
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    x, v, spin = (a[:, 4:].copy() for a in (path.x, path.v, path.spin))
    for a in (x, v):
        a[..., :2] = a[..., :2] @ turn.T
    system = make(x=x[0], radius=RADII[4:], mass=MASSES[4:], walls=[floor], dt=DT, contacts=False,
                  normal=PLASTIC, sliding=SPRING, rolling=ROLLING)
    led = Prescribed(x=x, v=v, spin=spin)
    got, expected = lead(system, led), answer(system, led)
    assert deviation(got.force, expected.force) < 1e-12
    assert deviation(got.torque, expected.torque) < 1e-12


# --- whole collisions ------------------------------------------------------------------------------


def collision(make, laws: dict, dimension: int, **rest):
    """Two bodies that meet obliquely and spin; contacts only where writing them does not alter the run."""
    unit = np.array([0.9, 0.4, 0.2][:dimension])
    unit /= np.linalg.norm(unit)
    v = np.array([[1.0, 0.3, -0.2], [-0.6, 0.1, 0.3]])[:, :dimension]
    spins = np.array([[300.0, -200.0, 500.0], [100.0, 250.0, -350.0]])
    system = make(
        x=[np.zeros(dimension), unit * RADII[:2].sum() * 1.0005], v=v, spin=spins[:, 3 - (2 * dimension - 3):],
        radius=RADII[:2], mass=MASSES[:2], dt=2.5e-7, steps=1000, **({"frame_every": 50} | laws | rest),
    )
    return without_doubtful_contacts(system)


def without_doubtful_contacts(system):
    doubtful = [s for s in LIGGGHTS.supports(system) if s.effect == "contact output"]
    return replace(system, contacts=False) if doubtful else system


def bounce(make, plane, laws: dict, dimension: int, normal):
    """One body that meets a plane obliquely, near the plane's point."""
    wall = plane(1, "floor", (0.0,) * dimension, normal[:dimension], friction=True)
    away = RADII[0] * 1.0005 * np.array(wall.normal)
    v = np.array([[0.5, -1.0, 0.3]])[:, :dimension]
    spins = np.array([[300.0, -200.0, 500.0]])
    system = make(
        x=[away], v=v, spin=spins[:, 3 - (2 * dimension - 3):], radius=RADII[0], mass=MASSES[0], dt=2.5e-7, steps=1000,
        frame_every=50, walls=[wall], **laws,
    )
    return without_doubtful_contacts(system)


def assert_same_run(trajectory, frames, system, tolerance):
    axes, spins = "xyz"[: system.dimension], (["wz"] if system.dimension == 2 else ["wx", "wy", "wz"])
    got = {"x": axes, "v": ["v" + a for a in axes], "spin": spins}
    for word, columns in got.items():
        found = np.array([f.particles.vector(*columns) for f in trajectory])
        expected = np.array([getattr(f, word) for f in frames])
        assert deviation(found, expected) < tolerance, word
    if system.contacts:
        assert_same_contacts(trajectory, frames, axes, tolerance)


def assert_same_contacts(trajectory, frames, axes, tolerance):
    largest = max((np.abs(f).max() for frame in frames for f, _ in frame.contacts.values()), default=0.0)
    assert largest > 0.0, "no frame has a contact"
    for found, expected in zip(trajectory, frames, strict=True):
        c = found.contacts
        assert {(int(i), int(j)) for i, j in zip(c["i"], c["j"], strict=True)} == set(expected.contacts)
        for row in range(c.rows):
            force, spring = expected.contacts[int(c["i"][row]), int(c["j"][row])]
            assert np.abs([c["f" + a][row] for a in axes] - force).max() < tolerance * largest
            assert ("ux" in c) == (spring is not None)
            if spring is not None:
                told = np.array([c["u" + a][row] for a in axes])
                assert np.abs(told - spring).max() < tolerance * RADII[0]


@pytest.mark.parametrize(("name", "dimension"), [(name, 2 + k % 2) for k, name in enumerate(LAWS)])
def test_collision_of_two(make, run, kernel_frames, name, dimension):
    system = collision(make, LAWS[name][0], dimension)
    assert_same_run(run(system), kernel_frames(system), system, 1e-10)


@pytest.mark.parametrize(("name", "dimension", "normal"), [
    ("linear, viscous", 2, OBLIQUE), ("linear, rolling", 3, OBLIQUE), ("linear, rolling", 2, LEVEL),
    ("hertz, clipped, mindlin", 3, LEVEL), ("hertz, clipped, mindlin", 3, OBLIQUE), ("hard", 2, LEVEL),
    ("plastic, spring", 2, OBLIQUE), ("two coefficients, springs", 2, LEVEL), ("two coefficients, springs", 3, OBLIQUE),
    ("tangential dashpot alone", 3, LEVEL), ("plastic, rolling", 3, OBLIQUE), ("variable, everything", 2, LEVEL),
])
def test_collision_with_a_wall(make, plane, run, kernel_frames, name, dimension, normal):
    system = bounce(make, plane, LAWS[name][0], dimension, normal)
    assert_same_run(run(system), kernel_frames(system), system, 1e-10)


@pytest.mark.parametrize("name", ["plastic", "two coefficients, springs", "linear, rolling", "variable"])
def test_writing_contacts_leaves_the_run_as_it_is(make, run, name):
    """To the last bit; a spring that is cut in every evaluation (tan_luding) to rounding."""
    system = collision(make, LAWS[name][0], 3, frame_every=5)
    assert system.contacts
    silent = run(replace(system, contacts=False), "silent").frames[-1].particles
    told = run(system, "told").frames[-1].particles
    tolerance = 1e-13 if "tan_luding" in LIGGGHTS.render(system)[INPUT] else 0.0
    for column in ("x", "vx", "wz"):
        assert told[column] == pytest.approx(silent[column], rel=tolerance, abs=0.0)


def test_a_stuck_pair_keeps_its_plastic_overlap(make, run, kernel_frames):
    """Adhesion holds two discs together over many swings, while neighbour lists are renewed again and again."""
    system = make(
        x=[[0, 0], [2.0005e-3, 0]], v=[[0.32, 1.0], [-0.3, 1.0]], radius=1e-3, mass=6e-5, dt=1e-6, steps=2000,
        frame_every=100, contacts=False, sliding=SPRING,
        normal=changed(PLASTIC, normal_damping=0.0, unloading_stiffness=1.5e5, adhesion_stiffness=1e5),
    )
    frames = kernel_frames(system)
    apart = [np.hypot(*(f.x[1] - f.x[0])) for f in frames]
    assert max(apart[4:]) < 2e-3
    assert any(a > b for a, b in pairwise(apart[4:]))
    assert_same_run(run(system), frames, system, 1e-10)


def test_a_stuck_pair_crosses_a_periodic_boundary(make, run, kernel_frames):
    """With k_2(largest overlap), whose history keeps its sign, springs and rolling besides; in 3D."""
    system = make(
        x=[[17.5e-3, 5e-3, 5e-3], [19.4998e-3, 5e-3, 5e-3]], v=[[2.3, 0, 0.1], [1.7, 0.2, 0]], radius=1e-3, mass=6e-5,
        dt=1e-6, steps=1500, frame_every=150, contacts=False, periodic=(20e-3, 0.0, 0.0),
        normal=changed(VARIABLE, normal_damping=0.0, largest_unloading_stiffness=3e5, adhesion_stiffness=4e5),
        sliding=SPRING, rolling=ROLLING,
    )
    frames = kernel_frames(system)
    x = frames[-1].x
    assert (x[:, 0] > 20e-3).all()
    assert np.linalg.norm(x[1] - x[0]) < 2e-3
    assert_same_run(run(system), frames, system, 1e-10)


@pytest.mark.parametrize("damping", [0.5, 0.0])
def test_plastic_discs_under_a_heavy_lid(make, plane, run, kernel_frames, damping):
    """Rough and smooth walls of every kind, discs of different sizes, a lid that goes by the forces on it."""
    lid = Loaded(mass=3e-4, load=0.4, stress=0.0, span=None, damping=0.05)
    walls = [
        plane(1, "floor", (0, 0), (0, 1), True), plane(2, "lid", (0, 3.56e-3), (0, -1), False, lid),
        plane(3, "left", (0, 0), (1, 0.1), True), plane(4, "right", (3.9e-3, 0), (-1, 0), True),
    ]
    system = make(
        x=[[1.0e-3, 0.996e-3], [2.92e-3, 0.9e-3], [1.1e-3, 2.72e-3], [2.75e-3, 2.62e-3]],
        v=[[0.2, 0.1], [-0.1, 0.1], [0.1, -0.3], [-0.2, 0.2]],
        radius=RADII[[0, 3, 2, 0]] * 0.9, mass=MASSES[[0, 3, 2, 0]], dt=5e-7, steps=2000,
        frame_every=200, sample_every=200, contacts=False, walls=walls, sliding=SPRING, rolling=ROLLING,
        normal=changed(PLASTIC, normal_damping=damping),
    )
    assert not [s for s in LIGGGHTS.supports(system) if s.level == "unsupported"]
    trajectory, frames = run(system), kernel_frames(system)
    assert_same_run(trajectory, frames, system, 1e-10)
    sunk = trajectory.series["lid_d"]
    assert sunk == pytest.approx([f.wall_d[1] for f in frames], rel=1e-9, abs=1e-12)
    assert abs(sunk[-1]) > 1e-5
