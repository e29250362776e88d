"""Normalised histograms and their error bars."""

import numpy as np
import pytest

from postproc.macro.distributions import distribution, force_distribution, spin_distribution, velocity_distribution


def test_density_of_known_counts():
    found = distribution([np.array([0.5, 1.5, 1.5]), np.array([0.5, 2.5, 9.0])], np.array([0.0, 1.0, 3.0]))
    np.testing.assert_allclose(found.density, [2 / 6, 3 / 6 / 2])
    assert found.inside == pytest.approx(5 / 6)
    assert (found.values, found.mean) == (6, pytest.approx(15.5 / 6))
    np.testing.assert_array_equal(found.middles, [0.5, 2.0])
    # per sample 1 and 1, 2 and 1 of 3: deviations from the mean 0, +-1/2
    np.testing.assert_allclose(found.error, [0.0, np.sqrt(2 * 2 * 0.25) / 6 / 2])


def test_one_sample_has_no_error_and_none_no_distribution():
    assert np.isnan(distribution([np.ones(4)], np.array([0.0, 2.0])).error).all()
    for nothing in ([], [np.empty(0)]):
        with pytest.raises(ValueError, match="expected at least one value"):
            distribution(nothing, np.array([0.0, 1.0]))


def test_error_is_the_spread_of_repetitions():
    """Samples of unequal size with a shift of their own: errors see that values of one sample hang together."""
    edges = np.array([-1.0, 0.0, 1.0, 2.0])

    def once(seed):
        rng = np.random.default_rng(seed)
        return distribution([rng.normal(rng.normal(0, 0.3), 1, rng.integers(50, 150)) for _ in range(30)], edges)

    found = [once(k) for k in range(400)]
    spread = np.std([f.density for f in found], axis=0)
    np.testing.assert_allclose(np.mean([f.error for f in found], axis=0), spread, rtol=0.1)
    p = np.mean([f.density[2] for f in found])
    assert spread[2] > 1.3 * np.sqrt(p * (1 - p) / 3000)  # what independent values would have


def test_forces_of_a_lattice_and_of_a_hand_made_pair(states):
    found = force_distribution([states.lattice("triangular")] * 2, np.array([0.5, 0.9, 1.1]))
    np.testing.assert_allclose(found.density, [0.0, 5.0])
    assert found.error.tolist() == [0.0, 0.0]
    assert (found.mean, found.scale) == pytest.approx((1.0, states.KN * 2e-3 * states.R))
    with pytest.raises(ValueError, match="the mean tangential force is 0"):
        force_distribution([states.snapshot(x=[[0.0, 0.0], [2.0, 0.0]], radius=[1.0, 1.0], i=[1], j=[2],
                                            point=[[1.0, 0.0]], force=[[-1.0, 0.0]])], np.arange(3), "tangential")
    pair = states.snapshot(x=[[0.0, 0.0], [2.0, 0.0]], radius=[1.0, 1.0], i=[1, 2], j=[2, -1],
                           point=[[1.0, 0.0], [2.0, -1.0]], force=[[-3.0, 4.0], [0.0, -1.0]])
    edges = np.array([-2.0, 0.0, 1.2, 3.0])
    assert (force_distribution([pair], edges).density * np.diff(edges)).tolist() == [0.0, 0.5, 0.5]  # 5, 1 over 3
    assert (force_distribution([pair], edges, "normal").density * np.diff(edges)).tolist() == [0.5, 0.0, 0.5]
    assert (force_distribution([pair], edges, "tangential").density * np.diff(edges)).tolist() == [0.0, 0.5, 0.5]
    with pytest.raises(ValueError, match="part: expected one of total, normal, tangential, got 'shear'"):
        force_distribution([pair], edges, "shear")


def test_velocities_and_spins(states):
    state = states.random_contacts(2, 2, count=50)
    edges = np.linspace(-4, 4, 9)
    for found, name in ((velocity_distribution([state], edges, "y"), "vy"), (spin_distribution([state], edges), "wz")):
        expected, _ = np.histogram(state.particles[name], edges, density=True)
        np.testing.assert_allclose(found.density, expected, rtol=1e-12)
    with pytest.raises(KeyError, match="particles has no column 'wz'"):
        spin_distribution([states.lattice("square")], edges)
