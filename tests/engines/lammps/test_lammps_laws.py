"""Every law LAMMPS has, in prescribed motion against the plain formula, in collisions, and against the kernel."""

import re

import numpy as np
import pytest

import reference.kernel.prescribed
from harness.engines.lammps import LAMMPS
from harness.engines.lammps.law import NORMAL, ROLLING, SLIDING, TORSION
from harness.engines.protocol import PATH_FILE, REACTION_FILE, Prescribed
from harness.engines.registry import ENGINES
from harness.scene.contact import (
    ConstantRolling,
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    JkrNormal,
    LinearNormal,
    MindlinSliding,
    SpringRolling,
    SpringSliding,
    SpringTorsion,
    VariableHystereticNormal,
    ViscousSliding,
)
from reference.analytic.adhesive_collision import DmtCollision, JkrCollision
from reference.kernel.deck import read_deck

GLASSY = {"youngs_modulus": 1e8, "poisson_ratio": 0.3, "impact_speed": 1.0}
LINEAR = LinearNormal(normal_stiffness=1e4, normal_damping=0.05, attraction="allowed")
UNDAMPED = LinearNormal(normal_stiffness=1e4, normal_damping=0.0, attraction="allowed")
CLIPPED = LinearNormal(normal_stiffness=1e4, normal_damping=0.3, attraction="clipped")
HERTZ = HertzNormal(**GLASSY, restitution=0.7, attraction="allowed")
CLIPPED_HERTZ = HertzNormal(**GLASSY, restitution=0.3, attraction="clipped")
ELASTIC_HERTZ = HertzNormal(**GLASSY, restitution=1.0, attraction="allowed")
DMT = DmtNormal(**GLASSY, surface_energy=5.0, normal_damping=0.05)
JKR = JkrNormal(**GLASSY, surface_energy=5.0, normal_damping=0.05)
SPRING = SpringSliding(shear_friction=0.4, shear_stiffness=3e3, shear_damping=0.2)
NO_DASHPOT = SpringSliding(shear_friction=0.4, shear_stiffness=3e3, shear_damping=0.0)
MINDLIN = MindlinSliding(shear_friction=0.4)
VISCOUS = ViscousSliding(shear_friction=0.4, shear_damping=0.2)
ROLLS = SpringRolling(rolling_friction=0.1, rolling_stiffness=2e3, rolling_damping=0.1)
TWISTS = SpringTorsion(torsion_friction=0.1, torsion_stiffness=2e3, torsion_damping=0.1)

LAWS = {
    "linear": {"normal": LINEAR},
    "linear, clipped, spring": {"normal": CLIPPED, "sliding": SPRING},
    "undamped, spring": {"normal": UNDAMPED, "sliding": SPRING},
    "linear, viscous": {"normal": LINEAR, "sliding": VISCOUS},
    "linear, rolling alone": {"normal": LINEAR, "rolling": ROLLS},
    "linear, spring, rolling, torsion": {"normal": LINEAR, "sliding": SPRING, "rolling": ROLLS, "torsion": TWISTS},
    "linear, viscous, torsion": {"normal": LINEAR, "sliding": VISCOUS, "torsion": TWISTS},
    "hertz": {"normal": HERTZ},
    "hertz, mindlin": {"normal": HERTZ, "sliding": MINDLIN},
    "hertz, clipped, mindlin, rolling, torsion": {
        "normal": CLIPPED_HERTZ, "sliding": MINDLIN, "rolling": ROLLS, "torsion": TWISTS,
    },
    "hertz, spring": {"normal": HERTZ, "sliding": NO_DASHPOT},
    "elastic hertz, damped spring": {"normal": ELASTIC_HERTZ, "sliding": SPRING},
    "elastic hertz, viscous": {"normal": ELASTIC_HERTZ, "sliding": VISCOUS},
    "elastic hertz, mindlin": {"normal": ELASTIC_HERTZ, "sliding": MINDLIN},
    "dmt": {"normal": DMT},
    "dmt, spring, rolling": {"normal": DMT, "sliding": SPRING, "rolling": ROLLS},
    "jkr": {"normal": JKR},
    "jkr, viscous, rolling, torsion": {"normal": JKR, "sliding": VISCOUS, "rolling": ROLLS, "torsion": TWISTS},
}
STEPS, DT = 250, 3.2e-6
PLANES = {2: (-0.28, 0.96), 3: (0.36, -0.48, 0.8)}


def _gap(t):
    """Two loadings to different overlaps, with a separation in between."""
    return 2e-5 - 1.5e-4 * np.sin(4 * np.pi * t) ** 2 * (1 + 0.3 * np.sin(5 * np.pi * t))


def _direction(t, dim):
    """A normal that turns in the plane, in 3D out of it too."""
    n = np.stack([np.cos(1.3 * t), np.sin(1.3 * t), 0.8 * np.sin(3 * t) * (dim == 3)], axis=-1)[:, :dim]
    return n / np.linalg.norm(n, axis=1, keepdims=True)


def _spins(t, count, dim):
    """Spins that turn round several times, different ones for all bodies."""
    w = [[300 * np.sin(7 * t + k + a) + 200 * np.cos(19 * t * (a + 1)) for a in range(3)] for k in range(count)]
    return np.moveaxis(np.array(w), 2, 0)[:, :, -1 if dim == 2 else 0 :][:, :, : 3 if dim == 3 else 1]


def _path(radius, dim, plane):
    """Bodies 1 and 2 meet each other, body 3 (if it is there) meets the plane through the origin."""
    t = np.arange(STEPS + 1) / STEPS
    branch = (radius[0] + radius[1] + _gap(t))[:, None] * _direction(t, dim)
    centre = 0.1 + np.stack([2e-3 * t, 1e-3 * t**2, 5e-4 * t], axis=-1)[:, :dim]
    x = [centre + 0.4 * branch, centre - 0.6 * branch]
    if plane is not None:
        along = np.array([plane[1], -plane[0], 0.0][:dim])
        x.append((radius[2] + _gap(t))[:, None] * np.array(plane) + (1e-3 * np.sin(9 * t))[:, None] * along)
    x = np.stack(x, axis=1)
    return Prescribed(x=x, v=np.gradient(x, DT, axis=0), spin=_spins(t, len(radius), dim))


@pytest.fixture(scope="module")
def driven(make_system):
    """driven(dim, laws): a system and a path; a plane is met where LAMMPS' planes are right, torsion is in 3D."""

    def make(dim, laws):
        laws = {k: law for k, law in laws.items() if k != "torsion" or dim == 3}
        plane = None if isinstance(laws["normal"], JkrNormal) else PLANES[dim]
        radius = [1e-3, 1e-3, 1e-3] if "torsion" in laws and plane else [1e-3, 1.3e-3, 0.8e-3]
        mass, radius = [1e-5, 2e-5, 3e-5][: 2 + bool(plane)], radius[: 2 + bool(plane)]
        path = _path(radius, dim, plane)
        bodies = make_system.particles(path.x[0], radius, mass, v=path.v[0], spin=path.spin[0])
        walls = (make_system.floor(plane),) if plane else ()
        fields = {"walls": walls, "dt": DT, "steps": STEPS, "contacts": False, "sliding": None}
        return make_system.any(bodies, **(fields | laws)), path

    return make


def _react(engine, system, path, folder):
    for name, text in engine.render_prescribed(system).items():
        (folder / name).write_text(text)
    np.savez(folder / PATH_FILE, x=path.x, v=path.v, spin=path.spin)
    result = engine.run_prescribed(folder, time_limit=60.0)
    assert result.status == "completed", result
    with np.load(folder / REACTION_FILE) as found:
        return found["force"], found["torque"]


def _agree(found, expected, tolerance):
    """Relative to the largest value of the motion."""
    for values, plain in zip(found, expected, strict=True):
        plain = plain[:, :, : values.shape[2]] if values.shape[2] != 1 else plain[:, :, -1:]
        np.testing.assert_allclose(values, plain, rtol=0, atol=tolerance * max(np.abs(plain).max(), 1e-12))


KERNEL = ENGINES["kernel:lammps"]


def _kernel(system, path, folder):
    model, _ = read_deck(_write(KERNEL.render(system), folder / "kernel"))
    return reference.kernel.prescribed.driven(model, path.x, path.v, path.spin)


def _write(deck, folder):
    folder.mkdir()
    for name, text in deck.items():
        (folder / name).write_text(text)
    return folder


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("name", LAWS)
def test_prescribed_motion(name, dim, tmp_path, driven, formula):
    """Against the plain formula, and against the kernel, which has no jkr."""
    system, path = driven(dim, LAWS[name])
    assert {s.level for s in LAMMPS.supports(system)} <= {"exact", "equivalent", "partial"}
    expected = formula(system, path)
    assert np.all(np.abs(expected[0]).max(axis=(0, 2)) > 0.1)  # every body is touched
    found = _react(LAMMPS, system, path, tmp_path)
    _agree(found, expected, 1e-12)
    if not isinstance(system.normal, JkrNormal):
        _agree(found, _kernel(system, path, tmp_path), 1e-13)


def test_laws_differ_more_than_the_tolerance(driven, formula):
    """So that the comparison above can tell them apart."""
    found = {}
    for name, laws in LAWS.items():
        found[name] = np.concatenate([a[:, :2].ravel() for a in formula(*driven(3, laws))])
    names = list(found)
    for k, name in enumerate(names):
        for other in names[:k]:
            assert np.abs(found[name] - found[other]).max() > 1e-6, (name, other)


COLLIDING = (
    "linear, spring, rolling, torsion", "hertz, clipped, mindlin, rolling, torsion", "elastic hertz, viscous",
    "dmt, spring, rolling",
)


@pytest.mark.parametrize("name", COLLIDING)
def test_the_kernel_agrees_in_a_collision(name, tmp_path, make_system):
    """Two spheres collide obliquely above a plane that one of them hits, too."""
    x, v = [[0.0, 0.0, 1.03e-3], [2.02e-3, 0.3e-3, 1.4e-3]], [[0.5, 0.1, -0.3], [-0.5, -0.3, 0.2]]
    spin = [[200.0, 30.0, 40.0], [-50.0, 0.0, 70.0]]
    bodies = make_system.particles(x, [1e-3, 1e-3], [1e-5, 2e-5], v=v, spin=spin)
    fields = {"walls": (make_system.floor((0.0, 0.0, 1.0)),), "sliding": None, "contacts": False}
    system = make_system.any(bodies, **(fields | LAWS[name]))
    ends = []
    for engine in (LAMMPS, KERNEL):
        folder = _write(engine.render(system), tmp_path / engine.name.replace(":", "-"))
        result = engine.run(folder, time_limit=60.0)
        assert result.status == "completed", result
        ends.append(engine.read(folder, system))
    for columns in (("x", "y", "z"), ("vx", "vy", "vz"), ("wx", "wy", "wz")):
        found, kernel = (np.array([f.particles.vector(*columns) for f in end]) for end in ends)
        assert np.ptp(kernel, axis=0).max() > 0
        np.testing.assert_allclose(found, kernel, rtol=0, atol=1e-10 * np.abs(kernel).max())


def test_a_swarm_that_changes_its_neighbours(tmp_path, make_system):
    """Forty spheres that wander through one another's places, all laws at once, against the kernel."""
    rng, t = np.random.default_rng(5), np.arange(STEPS + 1)[:, None, None] / STEPS
    cells = np.array([(i, j, k) for i in range(5) for j in range(4) for k in range(2)]) * 2.3e-3
    x = cells + 1.5e-3 * np.sin(2 * np.pi * t) * rng.normal(0, 1, cells.shape)
    path = Prescribed(x=x, v=np.gradient(x, DT, axis=0), spin=rng.normal(0, 100, (1, 40, 3)) * np.cos(9 * t))
    bodies = make_system.particles(x[0], np.full(40, 1e-3), rng.uniform(1e-5, 2e-5, 40))
    laws = LAWS["hertz, clipped, mindlin, rolling, torsion"]
    system = make_system.any(bodies, dt=DT, steps=STEPS, contacts=False, **laws)
    kernel = _kernel(system, path, tmp_path)
    assert np.count_nonzero(np.abs(kernel[0]).max(axis=(0, 2))) > 30
    _agree(_react(LAMMPS, system, path, tmp_path), kernel, 1e-12)


def test_a_moving_plane_is_no_prescribed_motion(make_system):
    from harness.scene.system import Constant

    moving = make_system.floor(motion=Constant(velocity=(0.0, 1.0)))
    with pytest.raises(ValueError, match="fixed planes"):
        LAMMPS.render_prescribed(make_system.on_floor(moving))


def test_prescribed_deck_has_the_laws_and_nothing_that_moves(make_system):
    full = make_system.on_floor(make_system.floor(), gravity=(0.0, -9.81), contacts=True)
    deck = LAMMPS.render_prescribed(full)
    assert set(deck) == {"in.lammps", "packing.data"}
    assert "pair_coeff * * hooke" in deck["in.lammps"]
    assert "wall/gran/region granular hooke" in deck["in.lammps"]
    assert not re.search(r"nve|gravity|dump|setforce|ave/time", deck["in.lammps"])


def test_inertia_does_not_matter_where_nothing_turns(make_system):
    ring = make_system.two(q=[1.0, 0.9])
    assert LAMMPS.render_prescribed(ring) == LAMMPS.render_prescribed(make_system.two(q=[0.5, 0.4]))


def test_a_path_that_leaves_the_box_is_said(tmp_path, make_system):
    system = make_system.biaxial(4)
    x = np.stack([system.particles.x, system.particles.x + 10.0])
    path = Prescribed(x=x, v=0 * x, spin=np.zeros((2, 4, 1)))
    fixed = tuple(w for w in system.walls if w.motion is None)
    with pytest.raises(AssertionError, match=r"Lost atoms|ids"):
        _react(LAMMPS, system.with_(walls=fixed), Prescribed(x=-x, v=path.v, spin=path.spin), tmp_path)


# --- adhesion against closed forms ----------------------------------------------------------------

RADIUS, MASS = (1e-3, 1.3e-3), (1e-5, 2e-5)
SPHERES = {
    "effective_modulus": 1e8 / (2 * (1 - 0.3**2)), "effective_radius": 1 / (1 / RADIUS[0] + 1 / RADIUS[1]),
    "reduced_mass": 1 / (1 / MASS[0] + 1 / MASS[1]), "surface_energy": 5.0,
}


def _pressed(make_system, law, overlaps, folder):
    """Return the force on the upper of two spheres at rest that are led through overlaps."""
    x = np.zeros((len(overlaps), 2, 3))
    x[:, 1, 2] = sum(RADIUS) - overlaps
    path = Prescribed(x=x, v=0 * x, spin=0 * x)
    system = make_system.any(make_system.particles(x[0], RADIUS, MASS), normal=law, sliding=None, contacts=False)
    force, _ = _react(LAMMPS, system, path, folder)
    np.testing.assert_array_equal(force[:, 0], -force[:, 1])
    return force[:, 1, 2]


def test_jkr_is_the_closed_form_until_the_largest_pull(tmp_path, make_system):
    """By contact radius, in and out again; beyond overlap zero only on the way out."""
    pair = JkrCollision(**SPHERES)
    gone = pair.tearing_radius * 9 ** (1 / 3)  # where the pull is largest
    assert pair.force(gone) == pytest.approx(-pair.pull_off_force, rel=1e-14)
    inwards = np.linspace(1.001 * pair.touching_radius, 3 * pair.touching_radius, 200)
    outwards = np.linspace(3 * pair.touching_radius, 1.0001 * gone, 400)
    overlaps = np.array([pair.overlap(a) for a in (*inwards, *outwards)])
    further = pair.overlap(gone) * np.linspace(1.0001, 1.9, 10)
    law = JkrNormal(**GLASSY, surface_energy=5.0, normal_damping=0.0)
    start = [-1e-6, 0.5 * pair.overlap(gone)]
    found = _pressed(make_system, law, np.concatenate([start, overlaps, further]), tmp_path)
    expected = [0.0, *(pair.force(a) for a in (*inwards, *outwards)), *np.zeros(10)]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * pair.pull_off_force * 20)
    assert pair.tearing_overlap < further[-1]  # led apart, the surfaces would still hold there


def test_dmt_is_the_closed_form(tmp_path, make_system):
    pair = DmtCollision(**SPHERES)
    overlaps = np.concatenate([[-1e-6, -1e-9], np.linspace(1e-9, 5e-5, 100)])
    found = _pressed(make_system, DmtNormal(**GLASSY, surface_energy=5.0, normal_damping=0.0), overlaps, tmp_path)
    expected = 2 / 3 * overlaps[2:] * [pair.stiffness(d) for d in overlaps[2:]] - pair.pull_off_force
    np.testing.assert_allclose(found, [0.0, *expected], rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("speed", [0.4, 0.8])
def test_restitution_of_jkr_is_that_of_its_tearing(speed, tmp_path, make_system, run):
    """The energy lost is that between touching and the largest pull, U(a_1) - U(a_0)."""
    pair, law = JkrCollision(**SPHERES), JkrNormal(**GLASSY, surface_energy=5.0, normal_damping=0.0)
    gone = pair.tearing_radius * 9 ** (1 / 3)
    lost = pair.energy(gone) - pair.energy(pair.touching_radius)
    x = [[0.0, 0.0, 0.0], [0.0, 0.0, sum(RADIUS) + 1e-7]]
    bodies = make_system.particles(x, RADIUS, MASS, v=[[0.0] * 3, [0.0, 0.0, -speed]])
    few = {"dt": 2e-8, "steps": 30000, "sample_every": 30000, "frame_every": 30000, "contacts": False}
    system = make_system.any(bodies, normal=law, sliding=None, **few)
    last = run.trajectory(tmp_path, system).frames[-1].particles["vz"]
    assert (last[1] - last[0]) / speed == pytest.approx(np.sqrt(1 - lost / pair.energy_in(speed)), rel=1e-4)


# --- words ----------------------------------------------------------------------------------------


def test_every_law_of_the_scene_is_judged():
    from typing import get_args

    from harness.scene import contact

    assert set(NORMAL) == set(get_args(contact.NormalLaw))
    assert set(SLIDING) == set(get_args(contact.SlidingLaw))
    assert set(ROLLING) == set(get_args(contact.RollingLaw))
    assert set(TORSION) == {SpringTorsion}


WORDS = {
    "hysteretic": "hysteretic 1 1 damping velocity",
    "luding": "luding 1 1 damping velocity",
    "constant": "hooke 1 0 damping velocity tangential linear_nohistory 0 0 rolling constant 0.1",
    "0.4": "hooke 1 0 damping velocity tangential linear_history 1 0 0.5 0.4",
}


@pytest.mark.parametrize("word", WORDS)
def test_what_lammps_lacks_it_says_itself(word, tmp_path, make_system, run):
    """The evidence of the rows that are unsupported; a version that has the law fails this."""
    def edit(deck):
        return re.sub(r"pair_coeff .*", f"pair_coeff * * {WORDS[word]}", deck)

    result = run.make(tmp_path, make_system.two(contacts=False), edit=edit)
    assert result.status == "crashed"
    expected = "Illegal pair_coeff command 0.4" if word == "0.4" else f"Illegal model type {word}"
    assert expected in result.reason


PLASTIC = {"adhesion_stiffness": 1e3, "normal_damping": 0.1}
DYNAMIC = SpringSliding(shear_friction=0.4, shear_stiffness=3e3, shear_damping=0.2, dynamic_friction=0.3)
REFUSED = {
    "hysteretic": {"normal": HystereticNormal(loading_stiffness=1e4, unloading_stiffness=2e4, **PLASTIC)},
    "variable": {
        "normal": VariableHystereticNormal(
            loading_stiffness=1e4, largest_unloading_stiffness=2e4, plasticity_depth=0.1, **PLASTIC
        )
    },
    "dynamic": {"normal": LINEAR, "sliding": DYNAMIC},
    "constant": {"normal": LINEAR, "rolling": ConstantRolling(rolling_friction=0.1)},
    "damped spring under hertz": {"normal": HERTZ, "sliding": SPRING},
    "viscous under hertz": {"normal": HERTZ, "sliding": VISCOUS},
    "contacts of jkr": {"normal": JKR, "contacts": True},
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(name, make_system):
    system = make_system.two(**({"sliding": None, "contacts": False} | REFUSED[name]))
    refused = [s for s in LAMMPS.supports(system) if s.level == "unsupported"]
    assert refused
    assert all(s.note for s in refused)


def test_torsion_needs_one_reduced_radius(make_system):
    def levels(radius, walls=()):
        bodies = make_system.particles(np.eye(3)[: len(radius)], radius, np.ones(len(radius)))
        system = make_system.any(bodies, normal=LINEAR, torsion=TWISTS, walls=walls)
        return {s.effect: s.level for s in LAMMPS.supports(system)}

    rough, smooth = (make_system.floor((0.0, 0.0, 1.0), friction=f) for f in (True, False))
    allowed = [([0.1] * 3, (rough,)), ([0.1, 0.2], ()), ([0.1, 0.2], (smooth,)), ([0.1], (rough,))]
    assert not any("reduced radius" in levels(*which) for which in allowed)
    for which in (([0.1, 0.2], (rough,)), ([0.1, 0.1, 0.2], ())):
        assert levels(*which)["reduced radius"] == "unsupported"


def test_walls_of_jkr_are_known_to_be_wrong(make_system):
    system = make_system.on_floor(make_system.floor((0.0, 0.0, 1.0)), normal=JKR, contacts=False)
    assert {s.effect: s.level for s in LAMMPS.supports(system)}["walls"] == "known_wrong"


def test_torsion_at_a_wall_has_the_radius_of_the_wall(make_system):
    """k_o a*^2, gamma_o a*^2, mu_o a* with a* = R/2 between spheres and R at a plane."""
    system = make_system.on_floor(make_system.floor((0.0, 0.0, 1.0)), torsion=TWISTS)
    deck = LAMMPS.render(system)["in.lammps"]
    pair, wall = (np.array(m.split(), float) for m in re.findall(r"twisting sds (\S+ \S+ \S+)", deck))
    np.testing.assert_allclose(pair, [2e3 * 0.25e-6, 0.1 * 0.25e-6, 0.1 * 0.5e-3], rtol=1e-15)
    np.testing.assert_allclose(wall, [2e3 * 1e-6, 0.1 * 1e-6, 0.1 * 1e-3], rtol=1e-15)
