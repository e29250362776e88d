"""A sample far from the origin is computed from its own middle, and told where it is."""

import numpy as np
import pytest

from reference.kernel.model import Model
from reference.kernel.origin import near_origin, placed

FAR = 2.0**21


def pair(dem, shift=0.0):
    x = np.array([[0.0, 0.0], [1.90625, 0.59375]]) + shift
    walls = [dem.wall("floor", (shift, shift - 3.0), (0.0, 1.0))]
    return dem.model(x.tolist(), v=[[0.3, -0.1], [0.0, 0.0]], spin=[2.0, -0.5], mu=0.5, kn=1e3, dt=1e-3, walls=walls)


def run(dem, model: Model):
    simulation = dem.Simulation(model)
    simulation.advance(200)
    return simulation.state


def test_far_away_nothing_is_lost(dem):
    """A million radii away: the same to the last bit, where exact differences allow it."""
    moved = near_origin(pair(dem, FAR))
    assert moved.origin is not None
    near, far = run(dem, pair(dem)), run(dem, moved)
    centre = np.array(moved.origin)[:, None] - FAR
    assert np.abs(far.v - near.v).max() < 1e-12
    assert np.abs(far.x + centre - near.x)[:, :2].max() < 1e-12


def test_without_it_digits_are_lost(dem):
    near, far = run(dem, pair(dem)), run(dem, pair(dem, FAR))
    assert np.abs(far.v - near.v).max() > 1e-9


def test_the_origin_is_an_exact_part_of_every_place(dem):
    model = pair(dem, FAR)
    moved = near_origin(model)
    assert np.array_equal(placed(moved, moved.x), model.x)
    assert np.array_equal(np.array(moved.walls[0].point) + np.array(moved.origin), np.array(model.walls[0].point))


@pytest.mark.parametrize("shift", [0.0, 100.0, -500.0])
def test_what_lies_near_stays_as_it_is(dem, shift):
    model = pair(dem, shift)
    assert near_origin(model) is model
    assert placed(model, model.x) is model.x


def test_a_periodic_box_begins_at_the_origin_and_stays(dem):
    model = dem.model([[1.0, 1.0], [4.0, 1.0]], periodic=(1e7, 1e7))
    assert near_origin(model) is model
