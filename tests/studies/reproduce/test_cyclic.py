"""Cycles: the scene's option, the wall's motion in every engine, and the numbers of each cycle."""

import numpy as np
import pytest
from msgspec.structs import replace

from harness.engines.registry import ENGINES
from harness.packing.stand_in import stand_in
from harness.runs.execute import run_one
from harness.scene.load import load_scene
from harness.scene.resolve import resolve
from harness.scene.system import Cosine, Cycles
from harness.studies.compare.run_checks import place_error
from harness.studies.prepare import prepare
from harness.studies.reproduce import cyclic
from postproc.trajectory import read_trajectory
from reference.kernel.model import Cosine as KernelCosine

CODES = ("lammps", "liggghts", "kernel:talk")


@pytest.fixture
def scene():
    return load_scene(cyclic.FILE)


def without_cycles(scene):
    return replace(scene, title="Once", top=replace(scene.top, cycles=None))


def test_the_run_ends_where_it_began(scene):
    assert scene.duration == pytest.approx(2 * scene.top.cycles * scene.top.duration)
    assert without_cycles(scene).duration == scene.top.duration
    top = resolve(scene, cyclic.FILE, stand_in(scene)).wall("top").motion
    assert (top.end, top.rest) == (scene.duration, 0.0)


def test_an_absent_option_changes_nothing(scene):
    """Neither what a system is called by nor a byte of a deck knows of cycles without them."""
    once = resolve(without_cycles(scene), cyclic.FILE, stand_in(scene))
    motion = once.wall("top").motion
    assert type(motion) is Cosine
    assert (motion.end, motion.rest) == (motion.duration, motion.travel)
    assert "cycles" not in str(once.identity())
    for name in CODES:
        assert not any("cycles" in text for text in ENGINES[name].render(once).values())


def test_cycles_are_told_apart(scene):
    twice = replace(scene, top=replace(scene.top, cycles=2))
    system, again = (resolve(s, cyclic.FILE, stand_in(s)) for s in (scene, twice))
    assert isinstance(system.wall("top").motion, Cycles)
    assert system.digest() != again.digest()


def test_the_kernel_goes_forth_and_back():
    wall = KernelCosine(travel=0.4, duration=0.25, cycles=2)
    for k in range(4):
        t = 0.25 * k + 0.1
        assert wall.displacement(t) == pytest.approx(0.2 * (1 - np.cos(np.pi * t / 0.25)), abs=1e-15)
        assert wall.rate(t) == pytest.approx(0.2 * np.pi / 0.25 * np.sin(np.pi * t / 0.25), abs=1e-12)
    assert (wall.displacement(1.0), wall.rate(1.0)) == (0.0, 0.0)
    assert KernelCosine(travel=0.4, duration=0.25).displacement(7.0) == 0.4


@pytest.fixture
def calm(scene, tmp_path):
    """Two cycles of 0.4 % of twelve discs without friction: codes can be followed to the end."""
    small = replace(
        scene, particles=replace(scene.particles, count=12), contact=replace(scene.contact, sliding=None),
        top=replace(scene.top, final_strain=0.004, duration=0.001, cycles=2),
        outputs=replace(scene.outputs, samples=80, frames=8),
    )
    return prepare(small, cyclic.FILE, packings=1, cache=tmp_path / "packings")[0].system


def test_all_engines_follow_each_other_through_all_cycles(calm, tmp_path):
    series = {}
    for name in CODES:
        engine = ENGINES[name]
        if not engine.probe().available:
            continue
        outcome, folder = run_one(engine, calm, tmp_path / "runs", time_limit=60.0)
        assert outcome.status == "completed", outcome.reason
        trajectory = read_trajectory(folder / "trajectory.h5")
        assert place_error(trajectory, calm) < 1e-9
        series[name] = trajectory.series
    assert len(series) >= 2
    first, *others = series.values()
    assert first["top_d"][-1] == pytest.approx(0.0, abs=1e-18)
    assert first["top_d"].max() == pytest.approx(calm.wall("top").motion.travel, rel=1e-12)
    size = np.abs(first["top_fy"]).max()
    for other in others:
        assert np.abs(other["top_fy"] - first["top_fy"]).max() < 1e-8 * size
        assert np.abs(other["right_d"] - first["right_d"]).max() < 1e-8 * np.abs(first["right_d"]).max()


# --- numbers of cycles -------------------------------------------------------------------------------


def hysteretic(curves, cycles: int, loop: float):
    """Stress 100 + 1e4 eps, `loop` higher on the way down; the width grows by 1e-3 in every cycle."""
    phase = np.linspace(0.0, cycles, 100 * cycles + 1)
    strain = 0.01 * (1 - np.cos(2 * np.pi * phase))
    down = (phase % 1.0) < 0.5
    return curves(strain, stress=100.0 + 1e4 * strain + loop * down, width=1.0 + 1e-3 * phase)


def test_numbers_of_known_cycles(curves):
    found = cyclic.cycle_numbers(hysteretic(curves, 3, 20.0), 0.8, 3)
    for n in (1, 2, 3):
        assert found[cyclic.of_cycle(cyclic.NU, n)] == pytest.approx(0.8 / (1 + 1e-3 * n), rel=1e-12)
        assert found[cyclic.of_cycle(cyclic.VOLUME, n)] == pytest.approx(-1e-3 * n, rel=1e-9)
        assert found[cyclic.of_cycle(cyclic.WORK, n)] == pytest.approx(20.0 * 0.02, rel=0.03)  # the trapezoid's corners
        assert found[cyclic.of_cycle(cyclic.STRESS, n)] == pytest.approx(300.0 + 10.0, abs=6.0)
    assert found[cyclic.LAST_CHANGE] == pytest.approx(0.8 / 1.003 - 0.8 / 1.002, rel=1e-9)


def test_an_elastic_cycle_dissipates_nothing(curves):
    found = cyclic.cycle_numbers(hysteretic(curves, 2, 0.0), 0.8, 2)
    assert found[cyclic.of_cycle(cyclic.WORK, 1)] == pytest.approx(0.0, abs=1e-12)


def test_the_way_of_a_cycle_is_its_path(curves):
    c = hysteretic(curves, 2, 0.0)
    assert c.path[-1] == pytest.approx(2 * 0.04, rel=1e-12)
    assert (np.diff(c.path) >= 0).all()
    once = curves(np.linspace(0.0, 0.1, 11))
    assert once.path is once.strain or (once.path == once.strain).all()


def test_a_window_ends_where_the_strain_first_passes(curves):
    inside = hysteretic(curves, 2, 0.0).upto(0.001)
    assert inside.sum() < 20
    assert not inside[90:].any()
