"""Velocity, its gradient, spins: affine fields, rigid motions, rings."""

import numpy as np
import pytest


def moving(states, seed=1, dim=2, count=60, velocity=None, spin=0.0, half=2.0):
    """Return particles at random places of a box about the origin with velocity(x); spin about z."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(-half, half, (count, dim))
    turns = {"w" + a: np.zeros(count) for a in ("z" if dim == 2 else "xyz")} | {"wz": np.full(count, spin)}
    return states.snapshot(
        x=x, radius=rng.uniform(0.05, 0.1, count), box=np.array([[-half, half]] * dim),
        extra={"particles": {"mass": rng.uniform(1, 2, count), **states.columns("v", velocity(x)), **turns}},
    )


def rigid(omega, dim=2):
    """v = omega e_z x x."""
    def velocity(x):
        v = np.zeros_like(x)
        v[:, 0], v[:, 1] = -omega * x[:, 1], omega * x[:, 0]
        return v

    return velocity


def test_momentum_and_velocity_of_two_particles(states, measure):
    state = states.snapshot(
        x=[[0.5, 0.5], [1.5, 0.5]], radius=[0.1, 0.2], box=np.array([[0.0, 2.0], [0.0, 1.0]]),
        extra={"particles": {"mass": [1.0, 3.0], "vx": [2.0, -2.0], "vy": [0.0, 4.0], "wz": [5.0, 10.0]}},
    )
    assert measure(state, "momentum_density").tolist() == [[-2.0, 6.0]]
    assert measure(state, "velocity").tolist() == [[-1.0, 3.0]]
    area = np.pi * np.array([0.01, 0.04])
    np.testing.assert_allclose(measure(state, "velocity_density")[0], [(area @ [2, -2]) / 2, area[1] * 4 / 2])
    assert measure(state, "spin_density") == pytest.approx([area @ [5, 10] / 2])
    assert measure(state, "spin") == pytest.approx([9.0])  # (1 * 5 + 4 * 10)/5, by volume


def test_spin_density_does_not_count_contacts(states, measure):
    """The talk's extra sum over contacts: on a square lattice it would give 4 nu omega."""
    state = states.lattice("square")
    state = states.replace(state, particles={**state.particles, "wz": np.full(state.particles.rows, 2.0)})
    assert measure(state, "spin_density") == pytest.approx(2.0 * measure(state, "volume_fraction"), rel=1e-14)


@pytest.mark.parametrize("dim", [2, 3])
def test_affine_velocity(states, measure, dim):
    L = np.random.default_rng(7).normal(size=(dim, dim))
    state = moving(states, dim=dim, velocity=lambda x: 3.0 + x @ L.T)
    np.testing.assert_allclose(measure(state, "velocity_gradient")[0], L, rtol=0, atol=1e-12)
    np.testing.assert_allclose(measure(state, "strain_rate")[0], (L + L.T) / 2, rtol=0, atol=1e-12)
    if dim == 2:
        assert measure(state, "rotation_rate") == pytest.approx([(L[1, 0] - L[0, 1]) / 2], rel=1e-12)
    else:
        curl = [L[2, 1] - L[1, 2], L[0, 2] - L[2, 0], L[1, 0] - L[0, 1]]
        np.testing.assert_allclose(measure(state, "rotation_rate")[0], np.array(curl) / 2, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("cells", "dim"), [
    (cells, dim) for cells in ("box", "strips:y:3", "grid:2x2", "rings:4:0:2") for dim in (2, 3)
    if (cells, dim) != ("grid:2x2", 3)
])
def test_rigid_rotation_does_not_strain_and_grains_turn_with_it(states, measure, cells, dim):
    omega = 0.7
    state = moving(states, dim=dim, count=400, velocity=rigid(omega), spin=omega)
    np.testing.assert_allclose(measure(state, "strain_rate", cells), 0.0, atol=1e-12)
    W = measure(state, "rotation_rate", cells)
    np.testing.assert_allclose(W if dim == 2 else W[:, 2], omega, rtol=1e-12)
    np.testing.assert_allclose(measure(state, "eigen_rotation", cells), 0.0, atol=1e-12)


def test_polar_rates_of_a_ring(states, measure):
    """v_phi = c r^2: D_r,phi = c r/2 and W = 3 c r/2, with an error of second order in the rings' width."""
    c, errors, counts = 0.3, [], (4, 8, 16, 32)
    r = 1.0 + (np.arange(640) + 0.5) / 640  # evenly over r
    angle = 2.4 * np.arange(640)
    v = c * r[:, None] ** 2 * np.column_stack([-np.sin(angle), np.cos(angle)])
    state = states.snapshot(
        x=r[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), radius=np.full(640, 1e-9),
        extra={"particles": {"mass": np.ones(640), **states.columns("v", v)}},
    )
    for count in counts:
        D, W = (measure(state, name, f"rings:{count}:1:2") for name in ("strain_rate", "rotation_rate"))
        middle = 1 + (np.arange(count) + 0.5) / count
        errors.append(max(np.abs(D[:, 0, 1] - c * middle / 2).max(), np.abs(W - 1.5 * c * middle).max()))
        np.testing.assert_allclose(D[:, 0, 1], D[:, 1, 0], rtol=1e-12)
        np.testing.assert_allclose(D[:, [0, 1], [0, 1]], 0.0, atol=1e-12)
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert order == pytest.approx(2.0, abs=0.15)


def test_eigen_rotation_is_the_spin_beyond_the_mean_rotation(states, measure):
    """Simple shear v_x = g y: W = -g/2; grains without spin have omega* = g/2."""
    g = 0.4
    state = moving(states, velocity=lambda x: np.column_stack([g * x[:, 1], 0 * x[:, 0]]), spin=0.0)
    assert measure(state, "rotation_rate") == pytest.approx([-g / 2], rel=1e-12)
    assert measure(state, "eigen_rotation") == pytest.approx([g / 2], rel=1e-12)
    assert measure(state, "strain_rate_deviator") == pytest.approx([g / 2], rel=1e-12)


def test_gradients_weigh_by_mass_and_spins_by_volume(states, measure):
    """A field that is not affine: the straight line of weighted least squares over x, against numpy's."""
    rng = np.random.default_rng(2)
    x = rng.uniform(0, 1, (30, 2))
    mass, radius = rng.uniform(1, 5, 30), rng.uniform(0.01, 0.05, 30)
    state = states.snapshot(x=x, radius=radius, box=np.array([[0.0, 1.0]] * 2), extra={"particles": {
        "mass": mass, "vx": x[:, 0] ** 2, "vy": 0 * mass, "wz": np.sin(5 * x[:, 1])}})
    design = np.column_stack([x, np.ones(30)])
    for name, q, weight in (("velocity_gradient", "vx", mass), ("spin_gradient", "wz", radius**2)):
        root = np.sqrt(weight)
        expected = np.linalg.lstsq(design * root[:, None], state.particles[q] * root, rcond=None)[0][:2]
        np.testing.assert_allclose(measure(state, name).reshape(-1, 2)[0], expected, rtol=1e-10)


def test_spin_gradient(states, measure):
    state = moving(states, velocity=lambda x: 0 * x)
    spin = 1.0 + state.particles.vector("x", "y") @ [2.0, -3.0]
    turning = states.replace(state, particles={**state.particles, "wz": spin})
    np.testing.assert_allclose(measure(turning, "spin_gradient"), [[2.0, -3.0]], rtol=0, atol=1e-12)


def test_displacement_and_rotation_against_a_reference(states, measure):
    H = np.array([[-0.01, 0.03], [0.0, 0.02]])
    last = moving(states, velocity=lambda x: 0 * x)
    x = last.particles.vector("x", "y")
    theta = x @ [0.1, -0.2]
    ones = np.ones(len(x))
    last = states.replace(last, particles={**last.particles, "rotation": theta + 0.5})
    first = states.replace(last, particles={
        **last.particles, **states.columns("", x - x @ H.T - [0.1, 0.2]), "rotation": 0.2 * ones})
    order = np.random.default_rng(3).permutation(len(x))  # rows in another order
    first = states.replace(first, particles={k: v[order] for k, v in first.particles.items()})
    np.testing.assert_allclose(measure(last, "displacement_gradient", reference=first)[0], H, atol=1e-12)
    np.testing.assert_allclose(measure(last, "rotation_gradient", reference=first)[0], [0.1, -0.2], atol=1e-12)
    V = last.particles["radius"] ** 2
    np.testing.assert_allclose(
        measure(last, "displacement", reference=first)[0], V @ (x @ H.T + [0.1, 0.2]) / V.sum(), rtol=1e-12)
    assert measure(last, "rotation", reference=first) == pytest.approx([V @ (theta + 0.3) / V.sum()], rel=1e-12)


def test_displacement_over_a_periodic_border_and_strangers(states, measure):
    last = states.lattice("square")
    length = last.box[0, 1]
    first = states.replace(last, particles={**last.particles, "x": last.particles["x"] - 0.1 * states.R + length})
    np.testing.assert_allclose(measure(last, "displacement", reference=first)[0], [0.1 * states.R, 0.0], atol=1e-15)
    strangers = states.replace(last, particles={**last.particles, "id": last.particles["id"] + 2})
    with pytest.raises(KeyError, match="2 of 16 particles are not in the reference state"):
        measure(last, "displacement", reference=strangers)
    with pytest.raises(KeyError, match="no reference state was given"):
        measure(last, "displacement")
