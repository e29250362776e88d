"""Rings through the kernel's deck, child process and reader."""

import dataclasses
import math

import numpy as np
import pytest

from harness.engines.kernel import KERNELS
from harness.engines.kernel.deck import render_deck
from harness.scene.contact import LinearNormal, ViscousSliding
from harness.scene.system import Constant, Particles, Ring, System, Wall
from reference.kernel.deck import read_deck

CENTRE = (0.01 / 3, -0.002)


def ring(index, name, circle, omega):
    angle = 2 * np.pi * np.arange(round(math.pi * circle / 1e-3)) / round(math.pi * circle / 1e-3)
    x = np.round(np.array(CENTRE) + circle * np.column_stack([np.cos(angle), np.sin(angle)]), 12)
    return Ring(index=index, name=name, centre=CENTRE, circle=circle, x=x, radius=np.full(len(x), 1e-3), omega=omega)


def between_rings(walls=(), **changes):
    """A layer of unequal discs between a ring that turns and one that rests, all with contacts, for 200 steps."""
    rng, count, first = np.random.default_rng(3), 30, len(walls) + 1
    angle, radius = 2 * np.pi * np.arange(count) / count, rng.uniform(1.02e-3, 1.06e-3, count)
    given = {
        "dimension": 2, "walls": tuple(walls), "background": None, "gravity": None, "periodic": None, "dt": 1e-5,
        "steps": 200, "sample_every": 50, "frame_every": 100, "contacts": True, "title": "rings",
        "normal": LinearNormal(normal_stiffness=300.0, normal_damping=0.01, attraction="allowed"),
        "sliding": ViscousSliding(shear_friction=0.44, shear_damping=0.02),
        "particles": Particles(
            x=np.array(CENTRE) + 0.01 * np.column_stack([np.cos(angle), np.sin(angle)]), radius=radius,
            mass=1e3 * radius**2, inertia_factor=np.full(count, 0.5), v=rng.normal(size=(count, 2)) / 30,
            spin=rng.normal(size=(count, 1))),
        "rings": (ring(first, "inner", 0.008, 2 / 3), ring(first + 1, "outer", 0.012, None)),
    }
    return System(**(given | changes))


def written(folder, system, convention="lammps"):
    files = render_deck(system, convention)
    for name, text in files.items():
        (folder / name).write_text(text)
    return files


def test_the_deck_hands_rings_over_bit_by_bit(tmp_path):
    system = between_rings()
    assert set(written(tmp_path, system)) == {"kernel.json", "particles.csv", "rings.csv"}
    model, _ = read_deck(tmp_path)
    for given, got in zip(system.rings, model.rings, strict=True):
        assert (got.name, got.centre, got.circle, got.omega) == (given.name, given.centre, given.circle, given.omega)
        assert np.array_equal(got.x, given.x.T)
        assert np.array_equal(got.radius, given.radius)


def test_without_rings_the_deck_says_nothing_of_them(tmp_path):
    files = written(tmp_path, between_rings(rings=()))
    assert set(files) == {"kernel.json", "particles.csv"}
    assert "ring" not in files["kernel.json"].replace('"title": "rings"', "")
    assert read_deck(tmp_path)[0].rings == ()


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda k: k.convention)
def test_every_convention_computes_rings_exactly(kernel):
    support = {s.effect: s for s in kernel.supports(between_rings())}
    assert support["glued rings"].level == "exact"


@pytest.mark.parametrize("walled", [False, True])
def test_a_run_is_read_back(tmp_path, walled):
    floor = Wall(index=1, name="floor", point=(0.0, -0.02), normal=(0.0, 1.0), friction=True,
                 motion=Constant(velocity=(0.1, 0.0)))
    system = between_rings([floor] if walled else [])
    kernel, first = KERNELS[0], 1 + walled
    written(tmp_path, system, kernel.convention)
    assert kernel.run(tmp_path, time_limit=60.0).status == "completed"
    trajectory = kernel.read(tmp_path, system)
    series, last = trajectory.series, trajectory.frames[-1]
    assert list(trajectory.steps) == [0, 100, 200]
    np.testing.assert_allclose(series["inner_angle"], 2 / 3 * series["time"], rtol=1e-15)
    assert not series["outer_angle"].any()
    assert last.box is None
    assert last.particles.rows == 30
    assert ("nx" in last.walls) == walled
    for row, (number, name, circle) in enumerate(((first, "inner", 0.008), (first + 1, "outer", 0.012)), walled):
        w = last.walls
        assert (w["id"][row], w["px"][row], w["py"][row], w["radius"][row]) == (number, *CENTRE, circle)
        for quantity in ("torque", "fx", "fy"):
            assert w[quantity][row] == series[f"{name}_{quantity}"][-1] != 0
        assert (last.contacts["j"] == -number).sum() > 5
    assert set(last.contacts["j"][last.contacts["j"] < 0]) == {-first, -first - 1.0}


def test_prescribed_motion_is_refused():
    with pytest.raises(ValueError, match="fixed planes only"):
        KERNELS[0].render_prescribed(between_rings())


def test_identity_follows_the_ring():
    system = between_rings()
    inner, outer = system.rings
    faster = system.with_(rings=(dataclasses.replace(inner, omega=1.0), outer))
    assert len({system.digest(), faster.digest(), between_rings(rings=()).digest()}) == 3
