"""Wall stress, strain, inertial number, balance of forces."""

import numpy as np
import pytest

from postproc.average import average


def _pressed_box(states, nx=3, ny=4, shift=(0.0, 0.0)):
    """Square array of discs between four smooth walls, forces 2 N along x and 5 N along y."""
    R, fx, fy = 0.5, 2.0, 5.0
    s, gap = 0.98, 0.49
    low = np.asarray(shift, dtype=float)
    size = np.array([(nx - 1) * s + 2 * gap, (ny - 1) * s + 2 * gap])
    grid = {(a, b): low + gap + s * np.array([a, b]) for a in range(nx) for b in range(ny)}
    ids = {key: k + 1 for k, key in enumerate(grid)}
    rows = []
    for (a, b), x in grid.items():
        right, up = (a + 1, b), (a, b + 1)
        rows.append((ids[a, b], ids.get(right, -3), x + [gap, 0.0], [-fx, 0.0]))
        rows.append((ids[a, b], ids.get(up, -4), x + [0.0, gap], [0.0, -fy]))
        if a == 0:
            rows.append((ids[a, b], -1, x - [gap, 0.0], [fx, 0.0]))
        if b == 0:
            rows.append((ids[a, b], -2, x - [0.0, gap], [0.0, fy]))
    i, j, point, force = zip(*rows, strict=True)
    walls = {
        "id": [1, 2, 3, 4],
        **states.columns("p", [[low[0], 7.0], [3.0, low[1]], [low[0] + size[0], -2.0], [0.0, low[1] + size[1]]]),
        **states.columns("n", [[1, 0], [0, 1], [-1, 0], [0, -1]]),
        **states.columns("f", [[-ny * fx, 0], [0, -nx * fy], [ny * fx, 0], [0, nx * fy]]),
    }
    state = states.snapshot(
        x=list(grid.values()), radius=np.full(nx * ny, R), i=i, j=j, point=point, force=force, walls=walls,
        box=np.column_stack([low, low + size]),
    )
    return state, np.diag([ny * fx / size[1], nx * fy / size[0]])


@pytest.mark.parametrize("shift", [(0.0, 0.0), (100.0, -30.0)])
def test_three_ways_to_the_stress_of_a_pressed_box(states, shift):
    state, expected = _pressed_box(states, shift=shift)
    averages = average(state)
    for name in ("stress", "stress_from_walls", "stress_from_wall_contacts"):
        np.testing.assert_allclose(averages[name][0], expected, rtol=1e-12, atol=1e-12, err_msg=name)
    assert averages["unbalanced_force"].tolist() == [0.0]


def test_walls_alone_are_enough_for_their_stress(states):
    state, expected = _pressed_box(states)
    averages = average(states.replace(state, contacts=None))
    np.testing.assert_allclose(averages["stress_from_walls"][0], expected, rtol=1e-12, atol=1e-12)
    assert averages.of_state["stress_from_wall_contacts"].reason == "contacts were not recorded"
    assert averages.in_cells["stress"].reason == "contacts were not recorded"


def test_stress_from_walls_averages_both_faces(states):
    """Out of balance (8 N left, 12 N right) it is the mean traction, wherever the origin."""
    state, _ = _pressed_box(states, shift=(50.0, 0.0))
    walls = {**state.walls, "fx": np.array([-8.0, 0.0, 12.0, 0.0])}
    height = np.diff(state.box[1])[0]
    found = average(states.replace(state, walls=walls))["stress_from_walls"][0, 0, 0]
    assert found == pytest.approx(10.0 / height, rel=1e-12)


def test_a_shear_force_on_the_top_wall_is_sigma_yx(states):
    state, _ = _pressed_box(states)
    walls = {**state.walls, "fx": np.array([-8.0, -3.0, 8.0, 3.0])}
    found = average(states.replace(state, walls=walls))["stress_from_walls"][0]
    assert found[1, 0] == pytest.approx(3.0 / np.diff(state.box[0])[0], rel=1e-12)
    assert found[0, 1] == 0.0


@pytest.mark.parametrize(("change", "reason"), [
    ({"walls": None}, "walls were not recorded"),
    ({"box": None}, "the state has no box: give the attribute box, or walls on every side"),
    ({"periodic": (True, False)}, "a periodic box has no wall on every side"),
])
def test_wall_stress_says_why_not(states, change, reason):
    state, _ = _pressed_box(states)
    assert average(states.replace(state, **change)).of_state["stress_from_walls"].reason == reason


def test_strain_is_positive_in_compression(states):
    state, _ = _pressed_box(states)
    now = states.replace(state, box=state.box * np.array([[1.01], [0.9]]))
    averages = average(now, reference=state)
    np.testing.assert_allclose(averages["axial_strain"], [[-0.01, 0.1]], rtol=1e-12)
    assert averages["volumetric_strain"] == pytest.approx([1.0 - 1.01 * 0.9], rel=1e-12)


def test_inertial_number_2d(states):
    """I = rate sqrt(m/p) with p per unit thickness, whatever the thickness."""
    state, stress = _pressed_box(states)
    p = np.trace(stress) / 2
    for thickness in (1.0, 0.25):
        heavy = states.replace(state, thickness=thickness, particles={**state.particles, "mass": np.full(12, 3.0)})
        assert average(heavy, rate=-0.7)["inertial_number"] == pytest.approx([0.7 * np.sqrt(3.0 / p)], rel=1e-12)


def test_inertial_number_3d(states):
    """I = rate d sqrt(rho/p) on a lattice of spheres."""
    lattice = states.lattice("cubic")
    mass = 2500.0 * 4 / 3 * np.pi * states.R**3
    state = states.replace(lattice, particles={**lattice.particles, "mass": np.full(64, mass)})
    averages = average(state, rate=2.0)
    p = averages["stress_isotropic"]
    assert averages["inertial_number"] == pytest.approx(2.0 * 2 * states.R * np.sqrt(2500.0 / p), rel=1e-12)


def test_residual_force_with_and_without_gravity(states):
    """A disc of 2 kg on a wall that pushes with 20 N: at rest with gravity only."""
    state = states.snapshot(
        x=[[0.0, 1.0]], radius=[1.0], i=[1], j=[-1], point=[[0.0, 0.0]], force=[[0.0, 20.0]],
        extra={"particles": {"mass": [2.0]}},
    )
    assert average(state)["unbalanced_force"].tolist() == [1.0]
    assert average(state, gravity=(0.0, -10.0))["unbalanced_force"].tolist() == [0.0]


def test_unbalanced_force_compares_the_worst_particle_with_the_mean_contact(states):
    """Forces 1 (between 1 and 2) and 3 (2 at a wall): mean 2; residuals 1 and |3 - 1|."""
    state = states.snapshot(
        x=[[0.0, 0.0], [2.0, 0.0]], radius=[1.0, 1.0], i=[1, 2], j=[2, -1],
        point=[[1.0, 0.0], [3.0, 0.0]], force=[[-1.0, 0.0], [-3.0, 0.0]], box=np.array([[-1.0, 3.0], [-1.0, 1.0]]),
    )
    assert average(state)["unbalanced_force"].tolist() == [1.0]
    assert average(state, cells="particles")["unbalanced_force"].tolist() == [0.5, 1.0]
