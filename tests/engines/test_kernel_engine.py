"""The kernel behind the engine protocol: its deck, its child process, what it reports and hands back."""

import dataclasses
import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from harness.engines.kernel import KERNELS
from harness.engines.kernel.deck import render_deck
from harness.engines.protocol import PATH_FILE, REACTION_FILE, takes
from harness.scene.contact import JkrNormal, LinearNormal, SpringRolling, SpringSliding
from harness.scene.effects import effects_on
from harness.scene.model import Background
from harness.scene.system import Constant, Cosine, Loaded, Particles, System, Wall
from postproc.trajectory import ReadError
from reference.kernel import model as kernel_model
from reference.kernel.deck import read_deck
from reference.kernel.program.simulation import fastest

TALK = next(k for k in KERNELS if k.convention == "talk")
NASTY = [0.1, 1 / 3, math.pi, 1e-30, 1e30, -2.0**-1074, 5e-324, 1.7976931348623157e308, -0.0, 123456789.123456789]


def particles(dim, rng, count=4):
    spins = 1 if dim == 2 else 3
    return Particles(
        x=np.resize(NASTY, (count, dim)),
        radius=rng.uniform(1e-4, 1e-3, count), mass=rng.uniform(1e-6, 1e-5, count),
        inertia_factor=rng.choice([0.4, 0.5, 1.0, 1 / 3], count), v=rng.normal(size=(count, dim)) / 3,
        spin=rng.normal(size=(count, spins)) * 1e3 / 7)


def bare(dim=2, **changes):
    """A system with nothing on but the normal contact."""
    given = {
        "dimension": dim, "particles": particles(dim, np.random.default_rng(dim)), "walls": (), "sliding": None,
        "normal": LinearNormal(normal_stiffness=1e5 / 3, normal_damping=0.0, attraction="allowed"),
        "background": None, "gravity": None, "periodic": None, "dt": 1e-7 / 3, "steps": 60, "sample_every": 10,
        "frame_every": 20, "contacts": False, "title": "a test",
    }
    return System(**(given | changes))


def everything(dim=2):
    """Every effect and every kind of wall, with numbers that need all 17 digits."""
    def axis(k, sign=1.0):
        return tuple(sign * float(k == a) for a in range(dim))

    slanting = (0.6, -0.8, 0.0)[:dim]
    walls = (
        Wall(index=1, name="left", point=(1 / 3,) * dim, normal=axis(0), friction=True),
        Wall(index=2, name="bottom", point=(-0.1,) * dim, normal=axis(1), friction=False,
             motion=Constant(velocity=(0.1, -1 / 7, 1e-9)[:dim])),
        Wall(index=3, name="top", point=(math.e,) * dim, normal=axis(1, -1.0), friction=True,
             motion=Cosine(travel=0.1 / 3, duration=1e-2 / 7)),
        Wall(index=4, name="side", point=(math.pi,) * dim, normal=slanting, friction=False,
             motion=Loaded(mass=5e-5 / 3, load=-0.1, stress=100 / 3, span=("bottom", "top"), damping=0.05 / 7)),
        Wall(index=5, name="lid", point=(9.1,) * dim, normal=axis(0, -1.0), friction=False,
             motion=Loaded(mass=1.0, load=0.3, stress=0.0, span=None, damping=0.0)),
    )
    return bare(
        dim, walls=walls, contacts=True, background=Background(translational_drag=1e-3 / 3),
        normal=LinearNormal(normal_stiffness=1e5 / 3, normal_damping=0.1 / 3, attraction="clipped"),
        sliding=SpringSliding(shear_friction=0.5 / 3, shear_stiffness=2e4 / 3, shear_damping=0.025 / 3),
        gravity=(0.1, -9.81, 1 / 3)[:dim], periodic=(0.0, 10 / 3, 0.0)[:dim])


def read_back(folder, system, convention="talk"):
    for name, text in render_deck(system, convention).items():
        (folder / name).write_text(text)
    return read_deck(folder)


def same(a, b):
    """Equal to the last bit, the sign of zero included."""
    return np.array_equal(a, b) and np.array_equal(np.signbit(a), np.signbit(b))


# --- deck ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("make", [bare, everything])
def test_the_deck_gives_back_the_same_numbers_to_the_last_bit(tmp_path, dim, make):
    system = make(dim)
    model, plan = read_back(tmp_path, system)
    p = system.particles
    for name in ("x", "v", "spin"):
        assert same(getattr(model, name), getattr(p, name).T)
    assert same(model.radius, p.radius)
    assert same(model.mass, p.mass)
    assert same(model.inertia, p.inertia_factor * p.mass * p.radius**2)
    assert (model.dt, model.gravity, model.periodic) == (system.dt, system.gravity, system.periodic)
    assert model.drag == (system.background.translational_drag if system.background else None)
    assert dataclasses.asdict(plan) == {"steps": 60, "sample_every": 10, "frame_every": 20, "contacts": system.contacts}


@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk"])
def test_laws_and_conventions(tmp_path, convention):
    system = everything()
    model, _ = read_back(tmp_path, system, convention)
    assert dataclasses.asdict(model.normal) == {
        "normal_stiffness": 1e5 / 3, "normal_damping": 0.1 / 3, "attraction": "clipped"}
    assert dataclasses.asdict(model.sliding) == {
        "shear_friction": 0.5 / 3, "shear_stiffness": 2e4 / 3, "shear_damping": 0.025 / 3, "algorithm": convention,
        "dynamic_friction": None}
    assert model.convention.name == convention
    allowed, _ = read_back(tmp_path, bare())
    assert allowed.normal.attraction == "allowed"


@pytest.mark.parametrize("dim", [2, 3])
def test_walls(tmp_path, dim):
    system = everything(dim)
    model, _ = read_back(tmp_path, system)
    for got, given in zip(model.walls, system.walls, strict=True):
        for field in ("name", "point", "normal", "friction"):
            assert getattr(got, field) == getattr(given, field)
    left, bottom, top, side, lid = (w.motion for w in model.walls)
    assert left == kernel_model.Fixed()
    assert bottom == kernel_model.Constant(velocity=(0.1, -1 / 7, 1e-9)[:dim])
    assert top == kernel_model.Cosine(travel=0.1 / 3, duration=1e-2 / 7)
    assert side == kernel_model.Loaded(mass=5e-5 / 3, load=-0.1, stress=100 / 3, span=(1, 2), damping=0.05 / 7)
    assert lid == kernel_model.Loaded(mass=1.0, load=0.3, stress=0.0, span=None, damping=0.0)


def test_effects_that_are_off_have_no_key():
    deck = json.loads(render_deck(bare(), "talk")["kernel.json"])
    assert set(deck) == {"title", "dimension", "convention", "dt", "plan", "normal", "walls"}
    on = json.loads(render_deck(everything(), "talk")["kernel.json"])
    assert set(on) - set(deck) == {"sliding", "drag", "gravity", "periodic"}


def test_the_deck_is_the_same_text_every_time():
    for kernel in KERNELS:
        assert kernel.render(everything()) == kernel.render(everything())
    assert len({kernel.render(everything())["kernel.json"] for kernel in KERNELS}) == len(KERNELS) == 4


# --- protocol --------------------------------------------------------------------------------------


def pair(**changes):
    """Two discs that meet over a floor; 60 steps."""
    count = 2
    discs = Particles(
        x=np.array([[2e-3, 0.995e-3], [4.05e-3, 1.2e-3]]), radius=np.full(count, 1e-3), mass=np.full(count, 1e-5),
        inertia_factor=np.full(count, 0.5), v=np.array([[1.0, 0.0], [-1.0, 0.0]]), spin=np.zeros((count, 1)))
    floor = Wall(index=1, name="floor", point=(0.0, 0.0), normal=(0.0, 1.0), friction=True)
    return bare(**({
        "particles": discs, "walls": (floor,), "dt": 1e-6, "contacts": True,
        "sliding": SpringSliding(shear_friction=0.5, shear_stiffness=2e4, shear_damping=0.01)} | changes))


def started(kernel, folder, system, time_limit=60.0):
    for name, text in kernel.render(system).items():
        (folder / name).write_text(text)
    return kernel.run(folder, time_limit=time_limit)


def test_names_probe_and_support():
    assert [k.name for k in KERNELS] == ["kernel:lammps", "kernel:liggghts", "kernel:talk", "kernel:corrected"]
    for kernel in KERNELS:
        probe = kernel.probe()
        assert probe.available
        assert probe.version.startswith("src")
        assert np.__version__ in probe.version
        supports = kernel.supports(everything())
        assert [s.effect for s in supports] == list(effects_on(everything()))
        assert {s.level for s in supports} == {"exact"}
    assert TALK.command(Path("some/folder")) == [sys.executable, "-m", "reference.kernel", "some/folder"]


def test_a_law_that_the_kernel_does_not_have_is_unsupported_and_it_says_why():
    jkr = JkrNormal(
        youngs_modulus=1e8, poisson_ratio=0.3, surface_energy=0.1, normal_damping=0.1, impact_speed=0.1)
    levels = {s.effect: (s.level, s.note) for s in TALK.supports(bare(normal=jkr))}
    assert levels.pop("normal contact: jkr") == (
        "unsupported", "contacts that hold on beyond overlap zero: the kernel ends a contact with its overlap")
    assert {level for level, _ in levels.values()} == {"exact"}
    assert not takes(TALK, bare(normal=jkr))
    assert TALK.known_defects() == ()


def test_prescribed_motion(tmp_path):
    """Two discs driven into each other: in every row the law sees just these numbers."""
    law = LinearNormal(normal_stiffness=1e5, normal_damping=0.1, attraction="allowed")
    system = pair(walls=(), normal=law, gravity=(0.0, -9.81), background=Background(translational_drag=1.0))
    gap = np.linspace(1.05e-5, -2.95e-5, 41)
    x = np.zeros((41, 2, 2))
    x[:, 1, 0] = 2e-3 + gap
    v = np.zeros_like(x)
    v[:, 1, 0] = -1.0
    for name, text in TALK.render_prescribed(system).items():
        (tmp_path / name).write_text(text)
    np.savez(tmp_path / PATH_FILE, x=x, v=v, spin=np.zeros((41, 2, 1)))
    result = TALK.run_prescribed(tmp_path, time_limit=60.0)
    assert (result.status, result.reason) == ("completed", "")
    with np.load(tmp_path / REACTION_FILE) as reaction:
        force, torque = reaction["force"], reaction["torque"]
    pressed = np.maximum(-gap[1:], 0.0)
    expected = np.where(pressed > 0, 1e5 * pressed + 0.1, 0.0)
    assert force[:, 1, 0] == pytest.approx(expected, rel=1e-9)
    assert np.array_equal(force[:, 0], -force[:, 1])
    assert not torque.any()


def test_prescribed_motion_needs_fixed_walls_and_a_free_start(tmp_path):
    with pytest.raises(ValueError, match="fixed planes only"):
        TALK.render_prescribed(everything())
    for name, text in TALK.render_prescribed(pair(walls=())).items():
        (tmp_path / name).write_text(text)
    touching = np.zeros((2, 2, 2))
    touching[:, 1, 0] = 1.9e-3
    np.savez(tmp_path / PATH_FILE, x=touching, v=np.zeros_like(touching), spin=np.zeros((2, 2, 1)))
    result = TALK.run_prescribed(tmp_path, time_limit=60.0)
    assert result.status == "crashed"
    assert "bodies touch in row 0" in result.last_lines[-1]


def test_a_run_completes_and_is_read_back_to_the_last_bit(tmp_path):
    result = started(TALK, tmp_path, pair())
    assert (result.status, result.reason) == ("completed", "")
    assert {"setup", "run", "output"} == set(result.timings)
    assert result.cpu_seconds > 0
    assert TALK.steps_done(tmp_path) == 60
    trajectory = TALK.read(tmp_path, pair())
    assert trajectory.steps == (0, 20, 40, 60)
    assert trajectory.series["step"].tolist() == list(range(0, 61, 10))
    simulation = fastest(read_deck(tmp_path)[0])
    simulation.advance(60)
    last = trajectory.frames[-1]
    assert same(last.particles["x"], simulation.state.x[0, :2])
    assert same(last.particles["wz"], simulation.state.spin[0, :2])
    assert same(trajectory.series["floor_fy"][-1:], simulation.state.wall_force[1])
    assert {-1.0, 2.0} <= set(np.concatenate([f.contacts["j"] for f in trajectory]))


def test_without_contacts_and_with_periodic_axes(tmp_path):
    """The reader learns the lengths of periodic axes from the system: they bound the box like walls."""
    lid = Wall(index=2, name="lid", point=(0.0, 5e-3), normal=(0.0, -1.0), friction=False)
    system = pair(contacts=False, periodic=(8e-3, 0.0))
    system = system.with_(walls=(*system.walls, lid))
    assert started(TALK, tmp_path, system).status == "completed"
    for frame in TALK.read(tmp_path, system):
        assert frame.contacts is None
        assert frame.periodic == (True, False)
        assert frame.box.tolist() == [[0.0, 8e-3], [0.0, 5e-3]]


def test_an_unstable_run_is_an_outcome_with_its_reason(tmp_path):
    fast = pair()
    fast.particles.v[1] = [0.0, -2e3]
    result = started(TALK, tmp_path, fast)
    assert result.status == "unstable"
    assert result.reason == "unstable: by step 1: the centre of particle 2 has passed wall 'floor'"
    assert result.timings == {}
    with pytest.raises(ReadError):
        TALK.read(tmp_path, fast)


def test_a_broken_deck_is_a_crash_and_no_exception(tmp_path):
    (tmp_path / "kernel.json").write_text("{")
    result = TALK.run(tmp_path, time_limit=60.0)
    assert (result.status, result.reason) == ("crashed", "ended by exit status 1")
    assert any("JSONDecodeError" in line for line in result.last_lines)


def test_a_run_that_takes_too_long_is_stopped(tmp_path):
    kernel = type(TALK)(convention="lammps")  # whose springs are not felt late: so long a run may begin
    result = started(kernel, tmp_path, pair(steps=10**9, sample_every=10**6, frame_every=10**9), time_limit=1.5)
    assert result.status == "timed_out"
    assert result.reason == "stopped after the time limit of 1.5 s"
    assert kernel.steps_done(tmp_path) == 0


@pytest.mark.parametrize("words", ["", "not json", "60", '{"steps": 60}'])
def test_without_the_finished_marker_it_did_not_finish(tmp_path, monkeypatch, words):
    kernel = type(TALK)(convention="talk")
    monkeypatch.setattr(type(TALK), "command", lambda self, folder: [sys.executable, "-S", "-c", f"print({words!r})"])
    result = kernel.run(tmp_path, time_limit=60.0)
    assert (result.status, result.reason) == ("crashed", "ended without its finished marker")


# --- expected cost -------------------------------------------------------------------------------

SLIDING = SpringSliding(shear_friction=0.5, shear_stiffness=2e4, shear_damping=0.025)
ROLLING = SpringRolling(rolling_friction=0.1, rolling_stiffness=1e4, rolling_damping=0.01)
CORRECTED = next(k for k in KERNELS if k.convention == "corrected")


@pytest.mark.parametrize(("dim", "count", "laws", "measured"), [
    (2, 200, {}, 29.0), (2, 1950, {}, 93.0),
    (2, 200, {"sliding": SLIDING}, 39.0), (2, 1950, {"sliding": SLIDING}, 160.0),
    (2, 1950, {"sliding": SLIDING, "rolling": ROLLING}, 205.0), (3, 2000, {}, 206.0),
    (3, 2000, {"sliding": SLIDING}, 570.0), (3, 2000, {"sliding": SLIDING, "rolling": ROLLING}, 880.0),
])
def test_the_expected_cost_follows_what_was_measured(dim, count, laws, measured):
    system = bare(dim, particles=particles(dim, np.random.default_rng(1), count), **laws)
    assert TALK.microseconds_per_step(system) == pytest.approx(measured, rel=0.1)


def test_the_second_order_scheme_costs_more_and_the_textbook_most():
    smooth, rolling = bare(3), bare(3, sliding=SLIDING, rolling=ROLLING)
    assert CORRECTED.microseconds_per_step(smooth) == pytest.approx(1.3 * TALK.microseconds_per_step(smooth))
    assert CORRECTED.microseconds_per_step(rolling) > 4 * TALK.microseconds_per_step(rolling)
