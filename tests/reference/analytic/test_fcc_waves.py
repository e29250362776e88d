"""Sound along a column of layers: against the dynamic matrix of layers whose spheres push each other one by one."""

import itertools
import math

import numpy as np
import pytest

from reference.analytic.fcc_waves import FccColumn, in_steps
from reference.analytic.lattices import FaceCentredCubic

K, MASS, RADIUS = 1.3e5, 8.4e-6, 1e-3
LAYERS = 10
CASES = [(0.0, 0.0, "reduced"), (2e-3, 0.0, "reduced"), (0.0, 2.6e4, "reduced"), (2e-2, 2.6e4, "reduced"),
         (2e-2, 1e5, "radius")]


def column(overlap, k_t, arm):
    plain = FccColumn(normal_stiffness=K, mass=MASS, radius=RADIUS, overlap=overlap * RADIUS, tangential_stiffness=k_t)
    slip, torque = (RADIUS if arm == "radius" else plain.spacing / 2), plain.spacing / 2
    return FccColumn(normal_stiffness=K, mass=MASS, radius=RADIUS, overlap=overlap * RADIUS, tangential_stiffness=k_t,
                     arms=slip * torque), slip, torque


def bonds(waves):
    """(layers up, vector) of the twelve neighbours; every second layer is shifted, by symmetry to either side."""
    d, flat = waves.spacing, [(0, (x, y, 0.0)) for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    steep = [(up, (x / 2, y / 2, up / math.sqrt(2)))
             for up, x, y in itertools.product((1, -1), (1, -1), (1, -1))]
    return [(up, d * np.array(v)) for up, v in (*flat, *steep)]


def answers(waves, slip_arm, torque_arm, moved):
    """Force and torque on one sphere of every layer (N, 6); moved (N, 6): displacements and turns, complex step."""
    u, w = moved[:, :3], moved[:, 3:]
    found = np.zeros((len(moved), 6), dtype=complex)
    for i, (up, base) in itertools.product(range(len(moved)), bonds(waves)):
        j = (i + up) % len(moved)
        apart = base + u[j] - u[i]
        distance = np.sqrt((apart * apart).sum())
        push = -K * (2 * RADIUS - distance) * apart / distance
        n = -base / waves.spacing  # from the neighbour to the sphere
        slip = u[i] - u[j]
        slip = slip - n * (n @ slip) - slip_arm * np.cross(w[i] + w[j], n)
        rub = -waves.tangential_stiffness * slip
        found[i, :3] += push + rub
        found[i, 3:] += np.cross(-torque_arm * n, rub)
    return found


def eigenfrequencies(waves, slip_arm, torque_arm):
    inertia = 0.4 * MASS * RADIUS**2
    scale = np.tile([MASS] * 3 + [inertia] * 3, LAYERS)
    matrix = np.empty((6 * LAYERS, 6 * LAYERS))
    for c in range(6 * LAYERS):
        moved = np.zeros(6 * LAYERS, dtype=complex)
        moved[c] = 1e-20j
        matrix[:, c] = -answers(waves, slip_arm, torque_arm, moved.reshape(-1, 6)).imag.ravel() / 1e-20 / scale
    squares = np.linalg.eigvals(matrix)
    assert np.abs(squares.imag).max() < 1e-6 * np.abs(squares).max()
    return np.sort(squares.real)


@pytest.mark.parametrize(("overlap", "k_t", "arm"), CASES)
def test_all_frequencies_are_those_of_the_layers(overlap, k_t, arm):
    waves, slip, torque = column(overlap, k_t, arm)
    k = 2 * np.pi * np.arange(LAYERS) / (LAYERS * waves.layer)
    shear = waves.shear(k)
    found = [waves.compression(k), waves.torsion(k), *[shear[:, b] for b in range(shear.shape[1])] * 2]
    if not k_t:
        found += [np.zeros(LAYERS)] * 2
    expected = np.sort(np.concatenate(found) ** 2)
    assert eigenfrequencies(waves, slip, torque) == pytest.approx(expected, rel=1e-10, abs=1e-10 * expected[-1])


@pytest.mark.parametrize("k_t", [0.0, 2e4, 9e4])
def test_without_pressure_it_is_the_bloch_wave_of_the_lattice(k_t):
    waves = FccColumn(normal_stiffness=K, mass=MASS, radius=RADIUS, overlap=0.0, tangential_stiffness=k_t)
    lattice = FaceCentredCubic(normal_stiffness=K, mass=MASS, spacing=2 * RADIUS, tangential_stiffness=k_t,
                               inertia_factor=0.4)
    k = np.linspace(0.1, np.pi, 7) / waves.layer
    shear = waves.shear(k)
    mine = [waves.compression(k), *[shear[:, b] for b in range(shear.shape[1])] * 2]
    mine += [waves.torsion(k)] if k_t else []
    bloch = lattice.frequencies(np.stack([0 * k, 0 * k, k], axis=1))
    assert bloch == pytest.approx(np.sort(np.stack(mine, axis=1), axis=1), rel=1e-11)
    assert lattice.wave_speeds([0, 0, 1]) == pytest.approx(
        [waves.shear_speed, waves.shear_speed, waves.compression_speed], rel=1e-12)


@pytest.mark.parametrize(("overlap", "k_t", "arm"), CASES)
def test_speeds_are_those_of_long_waves(overlap, k_t, arm):
    waves, *_ = column(overlap, k_t, arm)
    k = 1e-3 / waves.layer
    assert waves.compression(k) / k == pytest.approx(waves.compression_speed, rel=1e-6)
    assert waves.shear(k)[0] / k == pytest.approx(waves.shear_speed, rel=1e-5)


def test_pressure_slows_shear_three_times_as_much():
    """To first order in F/(k D): the geometric term stands in every bond across, of which shear has three parts."""
    free, *_ = column(0.0, 0.0, "reduced")
    pressed, *_ = column(1e-4, 0.0, "reduced")
    shrunk = pressed.spacing / free.spacing
    slow = [1 - getattr(pressed, s) / getattr(free, s) / shrunk for s in ("compression_speed", "shear_speed")]
    assert slow[1] / slow[0] == pytest.approx(3.0, rel=1e-3)
    assert slow[0] == pytest.approx(1e-4 / 4, rel=1e-3)


def test_the_pulse_is_the_sum_of_the_waves():
    """J_2n against the modes of a long periodic column, before the pulse has come round."""
    waves, *_ = column(1e-3, 0.0, "reduced")
    count, time = 400, np.linspace(0.0, 60.0, 50) / waves.cut_off
    k = 2 * np.pi * np.arange(count) / (count * waves.layer)
    for shear, w in ((False, waves.compression(k)), (True, waves.shear(k)[:, 0])):
        for n in (0, 1, 7, 20):
            modes = (np.cos(np.outer(time, w)) * np.cos(k * n * waves.layer)).mean(axis=1)
            assert waves.pulse(n, time, shear=shear) == pytest.approx(modes, abs=1e-12)


def test_steps_of_a_leapfrog():
    w, dt = 1.3, 0.4
    x, v, a = 0.0, 1.0, 0.0
    places = [x]
    for _ in range(500):
        v += 0.5 * dt * a
        x += dt * v
        a = -w * w * x
        v += 0.5 * dt * a
        places.append(x)
    shape = np.sin(float(in_steps(w, dt)) * dt * np.arange(501))
    assert np.array(places) == pytest.approx(shape * (places[1] / shape[1]), abs=1e-10)


def test_wrong_input():
    with pytest.raises(ValueError, match="overlap"):
        FccColumn(normal_stiffness=K, mass=MASS, radius=RADIUS, overlap=-1e-9)
    with pytest.raises(ValueError, match="no closed form of the pulse"):
        column(0.0, 1e4, "reduced")[0].pulse(3, 0.0, shear=True)
