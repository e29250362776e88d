"""Whole trajectories, forces, springs and wall motions against a plain NumPy integration, to rounding."""

import numpy as np
import pytest

from harness.engines.lammps import LAMMPS
from harness.engines.protocol import takes
from harness.scene.contact import (
    DmtNormal,
    HertzNormal,
    JkrNormal,
    LinearNormal,
    MindlinSliding,
    SpringRolling,
    SpringSliding,
    SpringTorsion,
    ViscousSliding,
)
from harness.scene.model import Background
from harness.scene.system import Constant, Cosine, Loaded

TOLERANCE = 1e-12
"""Relative to the largest value of the run; most stay below 1e-13."""

ELASTIC = LinearNormal(normal_stiffness=1e4, normal_damping=0.0, attraction="allowed")
CLIPPED = LinearNormal(normal_stiffness=1e4, normal_damping=0.3, attraction="clipped")
PULLING = LinearNormal(normal_stiffness=1e4, normal_damping=0.3, attraction="allowed")
NO_SLIP_LIMIT = SpringSliding(shear_friction=50.0, shear_stiffness=3e3, shear_damping=0.2)
NO_GRIP = SpringSliding(shear_friction=0.0, shear_stiffness=3e3, shear_damping=0.2)
UNDAMPED = SpringSliding(shear_friction=0.4, shear_stiffness=3e3, shear_damping=0.0)
WEAK = SpringSliding(shear_friction=0.1, shear_stiffness=3e3, shear_damping=0.2)
DRAG = Background(translational_drag=2e-4)


def _close(found, expected, scale):
    np.testing.assert_allclose(found, expected, rtol=0, atol=TOLERANCE * max(scale, 1e-300))


def _compare(found, expected, series, system):
    axes = "xyz"[: system.dimension]
    spins = ("wz",) if system.dimension == 2 else ("wx", "wy", "wz")
    take = {
        "x": lambda k: (found.frames[k].particles.vector(*axes), expected[k]["x"][:, : len(axes)]),
        "v": lambda k: (found.frames[k].particles.vector(*("v" + a for a in axes)), expected[k]["v"][:, : len(axes)]),
        "w": lambda k: (found.frames[k].particles.vector(*spins), expected[k]["w"][:, -len(spins):]),
    }
    if system.contacts:
        take["force"] = lambda k: _pairs(found.frames[k], expected[k], [f"f{a}" for a in axes], 2)
        take["overlap"] = lambda k: _pairs(found.frames[k], expected[k], ["overlap"], 8)
    springs = isinstance(system.sliding, SpringSliding | MindlinSliding)
    assert all((f.contacts is not None and "ux" in f.contacts) == (system.contacts and springs) for f in found)
    if system.contacts and springs:
        take["spring"] = lambda k: _pairs(found.frames[k], expected[k], [f"u{a}" for a in axes], 5)
    for of_frame in take.values():
        rows = [of_frame(k) for k in range(len(expected))]
        scale = max((np.abs(e).max(initial=0.0) for _, e in rows), default=0.0)
        for f, e in rows:
            _close(f, e, scale)
    columns = [f"{w.name}_{c}" for w in system.walls for c in ("d", "v", *(f"f{a}" for a in axes))]
    for k, column in enumerate(columns, start=1):
        _close(found.series[column], series[:, k], np.abs(series[:, k]).max())


def _pairs(frame, expected, columns, first):
    contacts, pairs = frame.contacts, expected["pairs"]
    between = contacts["j"] > 0
    np.testing.assert_array_equal(contacts.vector("i", "j")[between], pairs[:, :2])
    return contacts.vector(*columns)[between], pairs[:, first : first + len(columns)]


GLASSY = HertzNormal(
    youngs_modulus=1e8, poisson_ratio=0.3, restitution=0.7, attraction="allowed", impact_speed=1.0
)
ELASTIC_GLASSY = HertzNormal(
    youngs_modulus=1e8, poisson_ratio=0.3, restitution=1.0, attraction="clipped", impact_speed=1.0
)
STICKY = DmtNormal(
    youngs_modulus=1e8, poisson_ratio=0.3, surface_energy=1.0, normal_damping=0.05, impact_speed=1.0
)
STICKIER = JkrNormal(
    youngs_modulus=1e8, poisson_ratio=0.3, surface_energy=1.0, normal_damping=0.05, impact_speed=1.0
)
MINDLIN, VISCOUS = MindlinSliding(shear_friction=0.4), ViscousSliding(shear_friction=0.4, shear_damping=0.2)
ROLLS = SpringRolling(rolling_friction=0.1, rolling_stiffness=2e3, rolling_damping=0.01)
TWISTS = SpringTorsion(torsion_friction=0.1, torsion_stiffness=2e3, torsion_damping=0.01)
COLLISIONS = {
    "oblique": {},
    "spheres": {"dim": 3},
    "spheres in 2D": {"q": [0.4, 0.4]},
    "sphere and disc": {"q": [0.4, 0.5]},
    "frictionless": {"sliding": None},
    "clipped": {"normal": CLIPPED},
    "pulling": {"normal": PULLING},
    "no normal damping": {"normal": ELASTIC},
    "no damping at all": {"normal": ELASTIC, "sliding": UNDAMPED},
    "no slip": {"dim": 3, "sliding": NO_SLIP_LIMIT},
    "no grip": {"sliding": NO_GRIP},
    "gravity and drag": {"gravity": (0.5, -9.81), "background": DRAG},
    "weight in 3D": {"dim": 3, "gravity": (0.5, 1.0, -9.81)},
    "viscous": {"sliding": VISCOUS},
    "spring, rolling, torsion": {"dim": 3, "rolling": ROLLS, "torsion": TWISTS},
    "hertz, mindlin": {"normal": GLASSY, "sliding": MINDLIN},
    "hertz, mindlin, rolling, torsion": {
        "dim": 3, "normal": GLASSY, "sliding": MINDLIN, "rolling": ROLLS, "torsion": TWISTS,
    },
    "elastic hertz, spring, rolling": {"dim": 3, "normal": ELASTIC_GLASSY, "rolling": ROLLS},
    "dmt, spring": {"dim": 3, "normal": STICKY},
    "dmt, viscous": {"normal": STICKY, "sliding": VISCOUS},
    "jkr, spring": {"dim": 3, "normal": STICKIER, "contacts": False},
}


@pytest.mark.parametrize("name", COLLISIONS)
def test_two_particles(name, tmp_path, make_system, run, reference):
    system = make_system.two(**COLLISIONS[name])
    expected, series = reference(system)
    assert any(len(f["pairs"]) for f in expected)
    assert not len(expected[-1]["pairs"])
    assert takes(LAMMPS, system)
    _compare(run.trajectory(tmp_path, system), expected, series, system)


def test_head_on_without_damping_exchanges_the_velocities(tmp_path, make_system, run):
    grains = make_system.particles([[0, 0], [2.01e-3, 0]], [1e-3] * 2, [1e-5] * 2, v=[[0.1, 0], [0, 0]])
    few = {"dt": 2e-7, "steps": 4000, "frame_every": 4000, "sample_every": 4000}
    system = make_system.any(grains, normal=ELASTIC, sliding=None, **few)
    last = run.trajectory(tmp_path, system).frames[-1].particles
    np.testing.assert_allclose(last["vx"], [0.0, 0.1], atol=2e-5)


@pytest.mark.parametrize(("dim", "periodic"), [(2, (9.9e-3, 0.0)), (2, (9.9e-3, 8e-3)), (3, (9.9e-3, 0.0, 8.9e-3))])
def test_periodic_axes(dim, periodic, tmp_path, make_system, run, reference):
    x = np.array([[0.3e-3, 1e-3, 0.1e-3], [8.05e-3, 1.2e-3, 8.8e-3]])[:, :dim]
    v = np.array([[-0.3, 0.0, 0.1], [0.3, 0.05, 0.0]])[:, :dim]
    spin = [[20.0], [-5.0]] if dim == 2 else [[20.0, 1.0, 2.0], [-5.0, 0.0, 3.0]]
    grains = make_system.particles(x, [1e-3, 1.1e-3], [1e-5, 2e-5], v=v, spin=spin)
    system = make_system.any(grains, periodic=periodic)
    expected, series = reference(system)
    assert any(len(f["pairs"]) for f in expected)
    found = run.trajectory(tmp_path, system)
    _compare(found, expected, series, system)
    assert found.frames[-1].periodic == tuple(p > 0 for p in periodic)


TILTED, SPACE = (-0.28, 0.96), (0.36, -0.48, 0.8)
PLANES = {
    "fixed": ((0.0, 1.0), None),
    "tilted": (TILTED, None),
    "in space": (SPACE, None),
    "constant": ((0.0, 1.0), Constant(velocity=(-0.2, 0.1))),
    "constant in space": (SPACE, Constant(velocity=(0.2, 0.0, 0.1))),
    "cosine": (TILTED, Cosine(travel=1e-4, duration=6e-4)),
    "retreating": ((0.0, 1.0), Cosine(travel=-1e-4, duration=6e-4)),
    "loaded": ((0.0, 1.0), Loaded(mass=2e-5, load=0.1, stress=0.0, span=None, damping=0.05)),
    "loaded, tilted": (TILTED, Loaded(mass=2e-5, load=-0.1, stress=0.0, span=None, damping=0.0)),
}


@pytest.mark.parametrize(("name", "friction"), [(n, True) for n in PLANES] + [("tilted", False), ("loaded", False)])
def test_particle_on_plane(name, friction, tmp_path, make_system, run, reference):
    normal, motion = PLANES[name]
    gravity = None if motion else (0.0, -9.81, 0.0)[: len(normal)]
    system = make_system.on_floor(make_system.floor(normal, friction=friction, motion=motion), gravity=gravity)
    expected, series = reference(system)
    assert np.abs(series[:, 3:]).max() > 0.01
    found = run.trajectory(tmp_path, system)
    _compare(found, expected, series, system)
    for frame in found:
        rows = frame.contacts["j"] == -1
        np.testing.assert_array_equal(frame.contacts["fx"][rows].sum(), -frame.walls["fx"][0])
        assert np.isnan(frame.contacts["ux"][rows]).all() == (friction or not rows.any())


@pytest.mark.parametrize("sliding", [WEAK, UNDAMPED, None])
def test_biaxial_box(sliding, tmp_path, make_system, run, reference):
    system = make_system.biaxial(9, sliding=sliding, background=DRAG)
    expected, series = reference(system)
    assert len(expected[-1]["pairs"]) > 5
    found = run.trajectory(tmp_path, system)
    _compare(found, expected, series, system)
    top, right = (found.series[f"{w}_d"][-1] for w in ("top", "right"))
    lengths = np.array([w.point for w in system.walls[2:]]).max(axis=0) - [right, top]
    np.testing.assert_allclose(found.frames[-1].box, [[0, lengths[0]], [0, lengths[1]]], rtol=1e-15)


def test_cosine_wall_rests_after_its_travel(tmp_path, make_system, run, reference):
    wall = make_system.floor((0.0, 1.0), motion=Cosine(travel=1e-4, duration=3e-4))
    system = make_system.on_floor(wall)
    found = run.trajectory(tmp_path, system)
    _compare(found, *reference(system), system)
    after = found.series["time"] >= 3e-4
    np.testing.assert_array_equal(found.series["floor_d"][after], 1e-4)
    np.testing.assert_array_equal(found.series["floor_v"][after], 0.0)


def test_loaded_wall_obeys_its_equation_in_the_series(tmp_path, make_system, run):
    """m d'' = stress*z + F.n - damping*d': the second half kick of every step, from the series alone."""
    system = make_system.biaxial(9, sample_every=1, steps=250, contacts=False)
    s, motion, dt = run.trajectory(tmp_path, system).series, system.wall("right").motion, system.dt
    half = np.diff(s["right_d"]) / dt
    extent = system.wall("top").point[1] - s["top_d"][1:]
    force = motion.stress * extent - s["right_fx"][1:] - motion.damping * half
    kick = 2 * motion.mass * (s["right_v"][1:] - half) / dt
    assert np.ptp(force) > 0.1
    np.testing.assert_allclose(kick, force, atol=1e-9)
