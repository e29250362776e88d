"""Derived numbers against the talks' own, against integration and against brute force."""

import math

import numpy as np
import pytest

from harness.scene.derived import derive, peak_inertial_number, peak_strain_rate
from harness.scene.grains import grains_of, inertia_factor, mass_of
from harness.scene.model import DiscMass, SphereMass
from harness.scene.resolve import resolve_biaxial

TALK = {"particles.count": 1950}


def test_numbers_of_the_talks_box(scenes):
    """Total mass 0.02 kg, contact time 2.04e-5 s and restitution 0.784 of the mean pair."""
    derived = derive(scenes.load(scenes.biaxial, TALK))
    mean = derived.pairs[1]
    assert derived.grains.total_mass == pytest.approx(0.02042, rel=1e-3)
    assert mean.met.time_scale == pytest.approx(2.039e-5, rel=1e-3)
    assert mean.met.fact("restitution, attraction allowed").value == pytest.approx(0.784, abs=5e-4)
    assert [p.pair.name for p in derived.pairs] == ["smallest", "mean radius", "largest"]
    assert derived.pairs[0].met.time_scale < mean.met.time_scale < derived.pairs[2].met.time_scale


def test_declared_averages_are_those_of_drawn_radii(scenes):
    rng = np.random.default_rng(1)
    radius = rng.uniform(0.5e-3, 1.5e-3, 400_000)
    grains = grains_of(scenes.load(scenes.biaxial))
    assert grains.mean_mass == pytest.approx(mass_of(SphereMass(density=2000.0), radius).mean(), rel=3e-3)
    disc = {"particles.mass": {"kind": "disc", "density": 1000.0, "height": 6e-3}}
    drawn = mass_of(DiscMass(density=1000.0, height=6e-3), radius).mean()
    assert grains_of(scenes.load(scenes.biaxial, disc)).mean_mass == pytest.approx(drawn, rel=3e-3)


def test_masses():
    assert mass_of(SphereMass(density=3.0), np.array([1.0, 2.0])) == pytest.approx([4 * math.pi, 32 * math.pi])
    assert mass_of(DiscMass(density=3.0, height=0.5), np.array([2.0])) == pytest.approx([6 * math.pi])
    assert [inertia_factor(i) for i in ("sphere", "disc", "ring", 0.3)] == [0.4, 0.5, 1.0, 0.3]


@pytest.mark.parametrize("strain", [0.01, 0.1, 0.5, 0.95])
def test_peak_strain_rate(scenes, strain):
    """Against the largest |z'|/z on a fine grid of times."""
    scene = scenes.load(scenes.biaxial, {"top.final_strain": strain})
    phase = np.linspace(0, np.pi, 200_001)
    height = 1 - strain / 2 * (1 - np.cos(phase))
    rate = strain / 2 * np.sin(phase) * np.pi / scene.top.duration / height
    assert peak_strain_rate(scene) == pytest.approx(rate.max(), rel=1e-8)


def test_peak_inertial_number(scenes):
    scene = scenes.load(scenes.biaxial)
    expected = peak_strain_rate(scene) * math.sqrt(grains_of(scene).mean_mass / 100.0)
    assert peak_inertial_number(scene) == pytest.approx(expected, rel=1e-15)
    assert derive(scene).inertial_number == peak_inertial_number(scene)
    stiff = scenes.load(scenes.biaxial, {"side.pressure": 400.0})
    assert peak_inertial_number(stiff) == pytest.approx(expected / 2)


def lattice(count=10, spacing=2e-3, radius=1e-3):
    grid = spacing * np.stack(np.meshgrid(np.arange(count), np.arange(count)), -1).reshape(-1, 2) + radius
    return {"x": grid, "radius": np.full(count**2, radius), "box": (count * spacing, count * spacing)}


def test_packed_averages_are_the_actual_ones(scenes):
    scene = scenes.load(scenes.biaxial)
    system = resolve_biaxial(scene, **lattice())
    derived = derive(scene, system)
    assert derived.packed
    assert derived.grains.mean_mass == pytest.approx(4 / 3 * math.pi * 2000 * 1e-9)
    assert derived.grains.side == pytest.approx(20e-3)
    assert derived.walls[0].contacts == pytest.approx(10)
    assert derived.plan.dt == system.dt
    assert derived.plan.steps == system.steps
    assert peak_inertial_number(scene, system) == derived.inertial_number


def test_wall_scales(scenes):
    """The shares are those of z' and z'' at their peaks, L = z."""
    scene = scenes.load(scenes.biaxial)
    (wall,) = derive(scene).walls
    assert wall.damping_time == pytest.approx(2e-4 / 0.1)
    assert wall.period == pytest.approx(2 * math.pi * math.sqrt(2e-4 / (wall.contacts * 1e5)))
    assert wall.inertia_share == pytest.approx(2e-4 * math.pi**2 * 0.1 / (2 * 0.01**2) / 100)
    assert wall.damping_share == pytest.approx(0.1 * peak_strain_rate(scene) / 100)
    (undamped,) = derive(scenes.load(scenes.biaxial, {"side.damping": 0.0})).walls
    assert undamped.damping_time is None
    assert undamped.damping_share == 0.0


def test_free_scenes_have_no_rate(scenes):
    from harness.scene.resolve import resolve

    loaded = scenes.lid | {"motion": {"kind": "loaded", "mass": 1e-3, "load": 1.0}}
    scene = scenes.load(scenes.free, {"planes": [loaded]})
    derived = derive(scene, resolve(scene, scenes.file))
    assert derived.inertial_number is None
    (wall,) = derived.walls
    assert wall.name == "lid"
    assert wall.inertia_share is None
    assert wall.damping_time is None


def test_steps_per_contact(scenes):
    derived = derive(scenes.load(scenes.biaxial))
    assert derived.steps_per_contact == pytest.approx(derived.pairs[0].met.time_scale / derived.plan.dt)
    assert 20 <= derived.steps_per_contact < 20.1
