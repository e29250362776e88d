"""Points as cells: what they share with all cells for every kernel, frames, limits, and points far from everything."""

import numpy as np
import pytest
from scipy.integrate import quad

from postproc.average import average
from postproc.averaging.coarse.kernels.registry import KERNELS
from postproc.averaging.coarse.points import Points
from postproc.averaging.frame import polar_turn, turn_tensors, turn_vectors
from postproc.averaging.registry import make_cells
from postproc.fields import AT_POINTS, IN_CELLS
from postproc.geometry import positions, vector
from postproc.macro.contact_ends import contact_ends
from postproc.macro.fabric import contact_fabric, contact_number_density, fabric
from postproc.macro.motion import velocity_gradient
from postproc.macro.stress import stress
from postproc.results import Unavailable
from postproc.snapshot import MissingColumn


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kernel", KERNELS)
def test_averages_written_out(states, kernel, dim):
    """density = sum phi q, mean = sum phi q/sum phi, total = density V, largest among those in reach."""
    state = states.replace(states.random_contacts(5, dim, count=40), thickness=0.25 if dim == 2 else 1.0)
    cells = make_cells("points:" + "x".join("5432"[:dim]), state, kernel=kernel, width=0.4)
    q = np.random.default_rng(0).normal(size=(40, 2))
    distance = np.linalg.norm(cells.points[:, None] - positions(state), axis=2)
    phi = np.where(distance < cells.phi.reach, cells.phi.value(distance), 0.0)
    np.testing.assert_allclose(cells.density(q), phi @ q / state.thickness, rtol=1e-10, atol=1e-13)
    some = phi.sum(axis=1) > 0
    expected = (phi @ q)[some] / phi.sum(axis=1)[some, None]
    np.testing.assert_allclose(cells.mean(q)[some], expected, rtol=1e-10, atol=1e-13)
    np.testing.assert_allclose(cells.total(q), cells.density(q) * cells.volumes[:, None], rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(cells.volumes, state.thickness / cells.phi.value(np.zeros(1))[0], rtol=1e-15)
    largest = np.where(phi > 0, q[:, 0], -np.inf).max(axis=1)[some]
    np.testing.assert_array_equal(cells.largest(q[:, 0])[some], largest)


@pytest.mark.parametrize("kernel", KERNELS)
def test_a_contact_point_beside_the_line_of_centres(states, kernel):
    """Stress of a pair by way of its contact point, i -> c -> j: by quadrature along that path."""
    x, c, f = np.array([[0.0, 0.0], [1.0, 0.2]]), np.array([0.55, 0.4]), np.array([1.5, -0.7])
    state = states.snapshot(x=x, radius=[0.5, 0.5], i=[1], j=[2], point=[c], force=[f], thickness=2.0)
    cells = Points(snapshot=state, points=np.array([[0.3, 0.5], [0.9, 0.1], [0.4, -0.9]]), kernel=kernel, width=0.61)
    found = stress(contact_ends(state), cells)
    for k, r in enumerate(cells.points):
        expected = np.zeros((2, 2))
        for start, arm in ((x[0], c - x[0]), (c, x[1] - c)):
            def phi(s, r=r, start=start, arm=arm):
                return cells.phi.value(np.array([np.linalg.norm(r - start - s * arm)]))[0]

            a, b, d = arm @ arm, arm @ (r - start), (r - start) @ (r - start) - cells.phi.reach**2
            roots = [b / a, *((b + np.sqrt(b * b - a * d) * np.array([-1, 1])) / a if b * b > a * d else [])]
            borders = np.unique(np.clip([0.0, *roots, 1.0], 0.0, 1.0))
            pieces = zip(borders[:-1], borders[1:], strict=True)
            psi = sum(quad(phi, lo, hi, epsabs=1e-15, epsrel=1e-13)[0] for lo, hi in pieces)
            expected -= np.outer(arm, f) * psi / 2.0
        np.testing.assert_allclose(found[k], expected, rtol=0, atol=1e-12)
    assert np.abs(found).max() > 0.1


def turned_state(states, dim):
    state = states.random_contacts(4, dim)
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(dim, dim)))[0]
    turn *= np.sign(np.linalg.det(turn))
    shift = np.arange(1.0, dim + 1)
    return state, states.moved(state, turn, shift), turn, shift


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kernel", ["lucy", "gaussian"])
def test_a_turned_state_has_turned_tensors(states, kernel, dim):
    """At the points turned and shifted with it."""
    state, moved, turn, shift = turned_state(states, dim)
    at = np.random.default_rng(1).uniform(-1, 1, (20, dim))
    before = Points(snapshot=state, points=at, kernel=kernel, width=0.8)
    after = Points(snapshot=moved, points=at @ turn.T + shift, kernel=kernel, width=0.8)

    def fields(cells):
        ends, v = contact_ends(cells.snapshot), vector(cells.snapshot.particles, "v", cells.snapshot)
        return stress(ends, cells), fabric(ends, cells), contact_fabric(ends, cells), velocity_gradient(cells, v)

    turns = np.broadcast_to(turn, (20, dim, dim))
    for a, b in zip(fields(before), fields(after), strict=True):
        some = np.isfinite(a).all(axis=(1, 2))
        assert some.mean() > 0.6
        scale = np.abs(a[some]).max()
        np.testing.assert_allclose(b[some], turn_tensors(turns, a)[some], rtol=0, atol=1e-12 * scale)


@pytest.mark.parametrize("dim", [2, 3])
def test_polar_components_are_turned_by_the_angle_of_the_point(states, dim):
    state = states.random_contacts(4, dim, count=30)
    words = "points:" + "x".join("4" * dim)
    cartesian = average(state, cells=words, width=0.5)
    polar = average(state, cells=words, width=0.5, frame="polar")
    at = make_cells(words, state).points
    turn = polar_turn(at)
    np.testing.assert_array_equal(polar["r"], np.hypot(at[:, 0], at[:, 1]))
    ranks = {f.name: f.rank for f in (*IN_CELLS, *AT_POINTS)}
    compared = 0
    for name, result in cartesian.in_cells.items():
        if isinstance(result, Unavailable) or ranks[name] not in ("scalar", "principal", "vector", "tensor"):
            continue
        if name in ("fabric_orientation", "stiffness_anisotropy"):
            continue  # angles from, and stiffness along, the axes of the frame
        turns = {"vector": turn_vectors, "tensor": turn_tensors}.get(ranks[name], lambda turn, values: values)
        expected = turns(turn, cartesian[name])
        np.testing.assert_allclose(polar[name], expected, rtol=1e-12, atol=1e-12 * np.nanmax(np.abs(expected)))
        compared += 1
    assert compared > 30


def test_a_common_turn_of_state_and_points_leaves_polar_components(states):
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    state = states.random_contacts(4, 2, count=30)
    at = np.random.default_rng(1).uniform(-1, 1, (20, 2))
    found = []
    for snapshot, points in ((state, at), (states.moved(state, turn, np.zeros(2)), at @ turn.T)):
        cells = Points(snapshot=snapshot, points=points, width=0.6, frame="polar")
        found.append(cells.into_frame(stress(contact_ends(snapshot), cells), 2))
    np.testing.assert_allclose(*found, rtol=0, atol=1e-12 * np.abs(found[0]).max())


def test_a_wide_kernel_gives_the_plain_average(states):
    """w -> large: means tend to those of the whole state with (size/w)^2, and phi(0)^-1 densities to its sums."""
    state = states.random_contacts(4, 2, count=30)
    q, ends = np.random.default_rng(3).normal(size=30), contact_ends(state)
    box = make_cells("box", state)
    exact = [q.mean(), q.sum(), contact_fabric(ends, box)[0, 0, 1], contact_number_density(ends, box)[0]]
    volume = box.volumes[0]
    errors = []
    for width in (100.0, 200.0, 400.0):
        cells = Points(snapshot=state, points=np.array([[0.3, -0.2]]), kernel="gaussian", width=width)
        found = [
            cells.mean(q)[0], cells.total(q)[0], contact_fabric(ends, cells)[0, 0, 1],
            contact_number_density(ends, cells)[0] * cells.volumes[0] / volume,
        ]
        errors.append(np.abs(np.subtract(found, exact)))
    assert (errors[0] < 1e-2).all()
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    np.testing.assert_allclose(orders, 2.0, atol=0.02)


def test_affine_motion_of_a_lattice_in_a_smooth_kernel(states):
    """Gradient of an affine velocity field: exact with the Gaussian up to the lattice's sum, which it resolves."""
    state = states.lattice("triangular", repeats=8)
    L = np.array([[0.3, -1.2], [0.5, 0.1]])
    x = positions(state)
    free = states.snapshot(x=x, radius=state.particles["radius"], extra={"particles": {"mass": np.ones(len(x))}})
    cells = Points(snapshot=free, points=x.mean(axis=0, keepdims=True), kernel="gaussian", width=1.0e-3)
    np.testing.assert_allclose(velocity_gradient(cells, x @ L.T)[0], L, atol=1e-3)
    np.testing.assert_allclose(velocity_gradient(cells, np.ones_like(x) * 7.0)[0], 0, atol=1e-12)


def test_where_no_particle_is_in_reach(states):
    """Densities are 0, means NaN with the reason, nothing is a silent zero."""
    state = states.random_contacts(2, 2, count=80)
    low, high = state.box[:, 0], state.box[:, 1]
    cells = Points(snapshot=state, points=np.array([low - 10.0, (low + high) / 2]), width=0.5)
    averages = average_at(state, cells)
    assert averages["volume_fraction"][0] == averages["contact_number_density"][0] == 0.0
    assert (averages["stress"][0] == 0).all()
    assert (averages["momentum_density"][0] == 0).all()
    for name in ("velocity", "velocity_gradient", "coordination_number", "contact_fabric", "elastic_strain", "spin"):
        assert np.isnan(averages[name][0]).all(), name
        assert np.isfinite(averages[name][1]).all(), name


def average_at(state, cells):
    """Evaluate the fields of these cells, by name."""
    from postproc.fields import Subject

    subject = Subject(cells=cells)
    return {f.name: r.values for f in IN_CELLS if not isinstance(r := f.evaluate(subject), Unavailable)}


def test_the_reason_of_a_missing_mean_is_said(states, tmp_path):
    state, file = states.random_contacts(2, 2, count=80), tmp_path / "far.csv"
    file.write_text("x,y\n50,50\n0,0\n")
    averages = average(state, cells=f"points:{file}")
    assert averages.empty == 1
    assert averages.in_cells["velocity"].undefined == "in 1 of 2 cells: 1 without particles"
    assert averages.in_cells["momentum_density"].undefined == ""


def test_a_kernel_without_gradient_makes_gradients_unavailable(states):
    state = states.random_contacts(2, 2, count=80)
    averages = average(state, cells="points:3x3", kernel="heaviside", width=0.5)
    reason = "the kernel heaviside has no gradient; take lucy or gaussian"
    for name in ("velocity_gradient", "strain_rate", "rotation_rate", "eigen_rotation", "spin_gradient"):
        assert averages.in_cells[name] == Unavailable(reason=reason), name
    assert np.isfinite(averages["stress"]).all()
    with pytest.raises(MissingColumn, match="no gradient"):
        make_cells("points:3x3", state, kernel="heaviside").density_gradient(np.ones(80))


def test_the_default_width_is_one_mean_diameter(states):
    state = states.random_contacts(2, 2)
    default = make_cells("points:3x3", state)
    assert default.phi.width == 2 * state.particles["radius"].mean()
    assert default.phi == KERNELS["lucy"](width=default.phi.width, dimension=2)


@pytest.mark.parametrize(("kernel", "grid"), [("lucy", "160x160"), ("gaussian", "24x24")])
def test_a_periodic_grid_of_points_integrates_to_the_totals(states, kernel, grid):
    """Over one period, with contacts across its faces and particles counted in other periods."""
    state = states.lattice("triangular", repeats=4)
    length = np.diff(state.box, axis=1)[:, 0]
    x = positions(state) + length * np.random.default_rng(0).integers(-3, 4, (state.particles.rows, 2))
    state = states.replace(state, particles={**state.particles, **states.columns("", x)})
    ends = contact_ends(state)
    cells = make_cells(f"points:{grid}", state, kernel=kernel, width=1e-3)
    np.testing.assert_allclose(cells.density(np.ones(len(x))).mean() * np.prod(length), len(x), rtol=1e-8)
    expected = stress(ends, make_cells("box", state))[0]
    np.testing.assert_allclose(stress(ends, cells).mean(axis=0), expected, rtol=0, atol=1e-8 * np.abs(expected).max())


def test_lines_belong_to_the_ends_they_are_asked_for(states):
    """Other ends of the same cells are integrated anew."""
    state, other = states.random_contacts(2, 2), states.random_contacts(3, 2)
    cells = Points(snapshot=state, points=np.zeros((1, 2)), width=1.0)
    ends, others = contact_ends(state), contact_ends(states.replace(state, contacts=dict(other.contacts)))
    first = contact_number_density(ends, cells)
    assert contact_number_density(others, cells) != first
    assert contact_number_density(ends, cells) == first
