"""Frequencies of known oscillations, their error bars, and the speed of long waves."""

import numpy as np
import pytest

from postproc.macro.waves import layer_means, long_wave_speed, modes, oscillations
from postproc.results import Unavailable
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory

TIME = np.linspace(0.0, 30.0, 240)


def test_two_oscillations_in_two_channels():
    """They share frequencies and nothing else; exact without noise, also far from whole periods."""
    a = 1.0 * np.cos(0.37 * TIME) + 0.02 * np.cos(5.1 * TIME)
    b = 1j * (0.5 * np.cos(0.37 * TIME) - 0.5 * np.cos(5.1 * TIME))
    found = oscillations(np.array([a, b]), TIME, 2)
    assert found.frequency == pytest.approx([0.37, 5.1], rel=1e-10)
    assert found.residual < 1e-9


@pytest.mark.parametrize("w", [0.11, 0.9, 6.3])
def test_less_than_a_period_up_to_the_sampling(w):
    assert oscillations(np.cos(w * TIME), TIME, 1).frequency[0] == pytest.approx(w, rel=1e-9)


@pytest.mark.parametrize("decay", [0.03, -0.02])
def test_decay_and_growth(decay):
    found = oscillations(np.exp(-decay * TIME) * np.cos(2.2 * TIME + 0.4), TIME, 1, decaying=True)
    assert found.frequency[0] == pytest.approx(2.2, rel=1e-9)
    assert found.decay[0] == pytest.approx(decay, rel=1e-7)


def test_error_bars_cover():
    """68 % of one-sigma intervals hold the truth: within four sigmas of 300 trials."""
    rng, inside = np.random.default_rng(4), []
    for _ in range(300):
        found = oscillations(np.cos(2.2 * TIME) + 0.3 * rng.normal(size=len(TIME)), TIME, 1)
        inside.append(abs(found.frequency[0] - 2.2) <= found.frequency_error[0])
    assert np.mean(inside) == pytest.approx(0.683, abs=4 * np.sqrt(0.683 * 0.317 / 300))


def test_too_few_frames():
    with pytest.raises(ValueError, match="cannot tell"):
        oscillations(np.ones(4), TIME[:4], 2)


def test_layers_and_modes():
    """A wave over layers of unequal numbers of particles, whose rows come in any order."""
    layer = np.repeat(np.arange(8), [1, 2, 3, 2, 1, 2, 3, 2])
    wave = np.cos(2 * np.pi * 3 * layer / 8)
    order = np.random.default_rng(0).permutation(len(layer))
    frame = Snapshot(time=0.0, dimension=3, particles=Columns({"id": order + 1, "vz": wave[order]}))
    means = layer_means(Trajectory(frames=(frame,), steps=(0,), series=None), "vz", layer)
    found = modes(means)[0]
    assert found == pytest.approx(np.eye(5)[3] / 2, abs=1e-14)


def test_speed_of_long_waves():
    """Of a chain w = 2 sin(k/2): 1, and what is left is k^4/360 of it."""
    k = np.linspace(0.02, 0.3, 12)
    speed = long_wave_speed(k, 2 * np.sin(k / 2))
    assert speed.value == pytest.approx(1.0, abs=3e-6)
    assert abs(speed.value - 1.0) < 5 * speed.error
    assert isinstance(long_wave_speed(k[:2], k[:2]), Unavailable)


def test_mutants_are_seen():
    """A wrong clock, a wrong layer, a frequency a part in a million off."""
    found = oscillations(np.cos(2.2 * TIME), TIME * (1 + 1e-6), 1)
    assert abs(found.frequency[0] / 2.2 - 1) > 5e-7
    k = np.linspace(0.02, 0.3, 12)
    assert abs(long_wave_speed(k * 1.003, 2 * np.sin(k / 2)).value - 1.0) > 0.002
