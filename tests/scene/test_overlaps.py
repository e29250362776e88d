"""Touching bodies are found whatever their sizes, across periodic faces, and at walls."""

import itertools

import numpy as np
import pytest

from harness.scene.overlaps import initial_overlaps
from harness.scene.resolve import known_system
from harness.scene.system import Particles


@pytest.fixture
def system(scenes):
    """Return a system of bodies at x with these radii."""
    plain = known_system(scenes.load(scenes.free), scenes.file)

    def made(x, radius, **changes):
        ones, still = np.ones(len(x)), np.zeros_like(x)
        bodies = Particles(x=x, radius=radius, mass=ones, inertia_factor=0.5 * ones, v=still, spin=still[:, :1])
        return plain.with_(particles=bodies, **changes)

    return made


def listed(overlaps):
    return list(zip(overlaps.first.tolist(), overlaps.second.tolist(), overlaps.size.tolist(), strict=True))


@pytest.mark.parametrize("periodic", [None, (1.0, 0.0), (1.0, 1.0)])
def test_as_all_pairs_say(system, periodic):
    rng = np.random.default_rng(5)
    x, radius = rng.uniform(0, 1, (200, 2)), 10.0 ** rng.uniform(-3, -0.7, 200)
    expected = []
    for i, j in itertools.combinations(range(200), 2):
        apart = x[j] - x[i]
        apart -= np.round(apart) * (periodic or 0.0)  # lengths are 1
        size = radius[i] + radius[j] - np.hypot(*apart)
        expected += [(i, j, pytest.approx(size))] if size > 0 else []
    overlaps = initial_overlaps(system(x, radius, periodic=periodic))
    assert listed(overlaps) == expected
    assert overlaps.smaller == pytest.approx([min(radius[i], radius[j]) for i, j, _ in expected], rel=0)


def test_bodies_that_just_touch_do_not_overlap(system):
    x = np.column_stack([0.1 + 0.2 * np.arange(50), np.zeros(50)])
    assert listed(initial_overlaps(system(x, np.full(50, 0.1)))) == []


def test_walls_count_by_their_index(scenes):
    low = scenes.floor | {"point": [0.0, 1.5e-3]}
    scene = scenes.load(scenes.free, {"planes": [scenes.lid, low], "bodies.1.position": [1.9e-3, 2.1e-3]})
    overlaps = initial_overlaps(known_system(scene, scenes.file))
    assert listed(overlaps) == [
        (0, -2, pytest.approx(5e-4)), (0, 1, pytest.approx(2e-3 - np.hypot(1.9e-3, 1e-4))),
        (1, -2, pytest.approx(4e-4)),
    ]
