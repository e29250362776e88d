"""The stiffness matrix of a packing: lattices with closed forms, forces differentiated, whole eigenvalue problems."""

import math

import numpy as np
import pytest

from reference.analytic.lattices import FaceCentredCubic, Square, Triangular
from reference.analytic.packing_modes import FIXED, Contacts, Elements, Packing


def contacts_of(x, radius, box=None):
    """All touching pairs, nearest images in a periodic box; arms up to the middle of the overlap."""
    i, j = np.triu_indices(len(x), 1)
    apart = x[i] - x[j]
    if box is not None:
        apart -= np.round(apart / box) * box
    distance = np.linalg.norm(apart, axis=1)
    touching = distance < radius[i] + radius[j]
    i, j, apart, distance = i[touching], j[touching], apart[touching], distance[touching]
    half = 0.5 * (radius[i] + radius[j] - distance)
    return Contacts(
        i=i, j=j, normal=apart / distance[:, None], arm_i=radius[i] - half, arm_j=radius[j] - half,
        reduced=radius[i] * radius[j] / (radius[i] + radius[j]), distance=distance,
    )


CELLS = {
    "square": (Square, [[0, 0]], [1, 1]),
    "triangular": (Triangular, [[0, 0], [0.5, math.sqrt(0.75)]], [1, math.sqrt(3)]),
    "fcc": (
        FaceCentredCubic, np.array([[0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]]) / math.sqrt(2), [math.sqrt(2)] * 3,
    ),
}


def lattice(name, cells=6):
    """Periodic lattice of spacing 1 with contacts to nearest neighbours; an even number of cells holds the edge."""
    _, basis, cell = CELLS[name]
    box = cells * np.array(cell, float)
    at = np.stack(np.meshgrid(*[np.arange(cells)] * len(cell), indexing="ij"), axis=-1).reshape(-1, len(cell))
    x = (at[:, None, :] * np.array(cell) + np.array(basis, float)).reshape(-1, len(cell))
    return contacts_of(x, np.full(len(x), 0.5 + 1e-9), box), len(x)


def lattice_packing(name, k_t=None, q=0.5, cells=6, **more):
    contacts, count = lattice(name, cells)
    return Packing(
        mass=np.ones(count), inertia=np.full(count, q / 4), contacts=contacts,
        springs=Elements(normal=1.0, tangential=k_t), **more,
    )


def test_isolated_pair_is_stable_up_to_root_two(pair):
    assert pair().largest_step() == pytest.approx(math.sqrt(2), rel=1e-12)


@pytest.mark.parametrize(("name", "limit"), [("square", 1.0), ("triangular", 0.816), ("fcc", 0.707)])
def test_lattices_without_friction(name, limit):
    cells = 4 if name == "fcc" else 6
    assert lattice_packing(name, cells=cells).largest_step() == pytest.approx(limit, abs=5e-4)


@pytest.mark.parametrize("name", list(CELLS))
@pytest.mark.parametrize("k_t", [0.01, 0.3, 1.0])
@pytest.mark.parametrize("q", [0.4, 0.5])
def test_lattices_with_friction_springs(name, k_t, q):
    exact = CELLS[name][0](
        normal_stiffness=1.0, mass=1.0, spacing=1.0, tangential_stiffness=k_t, inertia_factor=q
    ).stability_limit
    found = lattice_packing(name, k_t, q, cells=4).largest_step()
    assert found == pytest.approx(exact, rel=1e-6)


@pytest.fixture
def pair():
    def make(normal=(1.0, 0.0), masses=(1.0, 1.0), **elements):
        row = Contacts(
            i=np.array([0]), j=np.array([1]), normal=np.array([normal]), arm_i=np.ones(1), arm_j=np.ones(1),
            reduced=np.full(1, 0.5), distance=np.full(1, 2.0),
        )
        m = np.array(masses)
        elements = {"springs": Elements(normal=1.0)} | elements
        return Packing(mass=m, inertia=0.5 * m, contacts=row, **elements)

    return make


def test_mass_ratio_of_a_pair(pair):
    reduced = 1.0 * 1e-3 / (1.0 + 1e-3)
    assert pair(masses=(1.0, 1e-3)).largest_step() == pytest.approx(2 * math.sqrt(reduced), rel=1e-12)


def test_damped_pair_has_the_closed_form(pair):
    """One motion alone: (2/w)(sqrt(1 + zeta^2) - zeta), w^2 = 2 k/m, 2 zeta w = 2 gamma/m."""
    for gamma in (1e-3, 0.3, 2.0, 50.0):
        w, zeta = math.sqrt(2.0), gamma / math.sqrt(2.0)
        exact = 2 / w * (math.sqrt(1 + zeta**2) - zeta)
        assert pair(dashpots=Elements(normal=gamma)).largest_step() == pytest.approx(exact, rel=1e-8)


def test_nothing_limits_a_packing_without_forces(pair):
    assert pair(springs=Elements()).largest_step() == math.inf


def test_rolling_and_torsion_of_a_pair_in_space(pair):
    """a* (w_1 - w_2) = 0.5 * 2 w of the motion against each other: I w'' = -k_r a*^2 2 w."""
    along = pair((0.0, 0.0, 1.0), springs=Elements(rolling=3.0, torsion=7.0))
    spins = np.sort(np.linalg.eigvalsh(along.stiffness_matrix().toarray()))
    assert spins[-3:] == pytest.approx([2 * 3.0 * 0.25, 2 * 3.0 * 0.25, 2 * 7.0 * 0.25], rel=1e-12)
    assert along.highest_frequency() == pytest.approx(math.sqrt(2 * 7.0 * 0.25 / 0.5), rel=1e-12)


def test_a_fixed_partner_and_a_plane(pair):
    row = Contacts(
        i=np.array([0]), j=np.array([FIXED]), normal=np.array([[0.0, 1.0]]), arm_i=np.ones(1), arm_j=np.ones(1),
        reduced=np.ones(1), distance=np.array([math.inf]),
    )
    at_plane = Packing(
        mass=np.ones(1), inertia=np.full(1, 0.5), contacts=row,
        springs=Elements(normal=2.0, tangential=1.0, pressing=np.ones(1)),
    )
    u_x, u_y, spin = 0, 1, 2
    k = at_plane.stiffness_matrix().toarray()
    assert k[u_y, u_y] == 2.0
    assert k[u_x, u_x] == k[spin, spin] == 1.0
    assert abs(k[u_x, spin]) == 1.0


def random_packing(rng, dimension, count=14):
    radius = rng.uniform(0.8, 1.6, count)
    x = rng.uniform(0, 2.6 * count ** (1 / dimension) * 0.62, (count, dimension))
    return x, radius, contacts_of(x, radius)


@pytest.mark.parametrize("dimension", [2, 3])
def test_matrix_is_the_derivative_of_the_forces(dimension):
    """Pressed springs of any strength: central forces k (R_i + R_j - r), differentiated numerically."""
    rng = np.random.default_rng(dimension)
    x, radius, c = random_packing(rng, dimension)
    k = rng.uniform(1, 2, len(c.i))
    gap = radius[c.i] + radius[c.j] - c.distance
    packing = Packing(
        mass=np.ones(len(x)), inertia=np.ones(len(x)), contacts=c, springs=Elements(normal=k, pressing=k * gap)
    )

    def force(place):
        apart = place[c.i] - place[c.j]
        distance = np.linalg.norm(apart, axis=1)
        pushing = (k * (radius[c.i] + radius[c.j] - distance) / distance)[:, None] * apart
        total = np.zeros_like(place)
        np.add.at(total, c.i, pushing)
        np.add.at(total, c.j, -pushing)
        return total

    direction, step = rng.normal(size=x.shape), 1e-6
    slope = (force(x + step * direction) - force(x - step * direction)) / (2 * step)
    found = packing.stiffness_matrix() @ direction.ravel()
    assert found == pytest.approx(-slope.ravel(), abs=1e-7 * np.abs(slope).max())


@pytest.mark.parametrize("dimension", [2, 3])
def test_rigid_motions_cost_nothing(dimension):
    rng = np.random.default_rng(dimension)
    x, _, c = random_packing(rng, dimension)
    count, spins = len(x), {2: 1, 3: 3}[dimension]
    packing = Packing(
        mass=np.ones(count), inertia=np.ones(count), contacts=c,
        springs=Elements(normal=1.0, tangential=0.7, rolling=0.3, torsion=0.2 if dimension == 3 else None),
    )
    k = packing.stiffness_matrix()
    moved = np.tile(np.concatenate([rng.normal(size=dimension), np.zeros(spins)]), count)
    axis = np.array([0.0, 0.0, 0.6]) if dimension == 2 else rng.normal(size=3)
    in_space = np.pad(x, ((0, 0), (0, 3 - dimension)))
    turned = np.concatenate([np.cross(axis, in_space)[:, :dimension], np.tile(axis[-spins:], (count, 1))], axis=1)
    assert np.abs(k @ moved).max() < 1e-12
    assert np.abs(k @ turned.ravel()).max() < 1e-12


@pytest.mark.parametrize("dimension", [2, 3])
def test_largest_step_is_where_something_begins_to_grow(dimension):
    """All dashpots and springs at once, of all strengths, against all eigenvalues of the map of one step."""
    rng = np.random.default_rng(dimension)
    x, _, c = random_packing(rng, dimension)
    count, more = len(x), {"torsion": 0.2} if dimension == 3 else {}
    packing = Packing(
        mass=rng.uniform(1, 3, count), inertia=rng.uniform(0.5, 1, count), contacts=c, drag=0.05,
        springs=Elements(normal=1.0, tangential=0.4, rolling=0.3, **more),
        dashpots=Elements(normal=rng.uniform(0, 1, len(c.i)), tangential=0.2),
    )
    limit = packing.largest_step()
    assert packing.growth(limit * (1 - 1e-5)) < 1 + 1e-6
    assert packing.growth(limit * (1 + 1e-3)) > 1 + 1e-4


def test_late_springs_need_a_dashpot(pair):
    """One contact: stable up to gamma_t/k_t (c >= 0), at no step without gamma_t."""
    springs, late = Elements(normal=1.0, tangential=0.5), Elements(tangential=0.5)
    assert pair(springs=springs, late=late).largest_step() == 0.0
    damped = pair(springs=springs, late=late, dashpots=Elements(tangential=0.1))
    assert damped.largest_step() == pytest.approx(0.1 / 0.5, rel=2e-3)


@pytest.mark.parametrize("damping", [0.02, 0.1, 0.15, 0.2, 0.25, 0.3, 1.0])
def test_late_springs_of_a_packing_against_all_eigenvalues(damping):
    rng = np.random.default_rng(8)
    x, _, c = random_packing(rng, 2)
    packing = Packing(
        mass=np.ones(len(x)), inertia=np.full(len(x), 0.5), contacts=c, springs=Elements(normal=1.0, tangential=0.5),
        late=Elements(tangential=0.5), dashpots=Elements(normal=damping, tangential=damping),
    )
    limit = packing.largest_step()
    assert packing.growth(0.99 * limit) < 1 + 1e-6
    assert packing.growth(1.01 * limit) > 1 + 1e-6


@pytest.mark.parametrize("damping", [0.0, 0.02, 0.3])
def test_nothing_grows_faster_than_late_springs_feed_it(damping):
    """And without dashpots some mode nearly does, while steps are small."""
    rng = np.random.default_rng(8)
    x, _, c = random_packing(rng, 2)
    packing = Packing(
        mass=np.ones(len(x)), inertia=np.full(len(x), 0.5), contacts=c, springs=Elements(normal=1.0, tangential=0.5),
        late=Elements(tangential=0.5), dashpots=Elements(normal=damping, tangential=damping) if damping else Elements(),
    )
    for step in (0.01, 0.03, 0.1, 0.3):
        grown, fed = packing.growth(step) - 1, packing.late_growth(step) - 1
        assert grown <= fed + 1e-6
        if step <= damping / 0.5:
            assert fed == pytest.approx(0.0, abs=1e-12)
        elif not damping:
            assert fed == pytest.approx(grown, rel=0.1)


def test_one_late_spring_grows_as_it_is_fed(pair):
    """|z|^2 = 1 + dt W^2 (dt - gamma/k), W^2 = k (1/m + R^2/I) of both."""
    late = Elements(tangential=0.5)
    packing = pair(springs=Elements(normal=1.0, tangential=0.5), late=late, dashpots=Elements(tangential=0.01))
    square = 0.5 * float((1 / packing.mass + packing.contacts.arm_i**2 / packing.inertia).sum())
    for step in (0.03, 0.1, 0.3):
        assert packing.late_growth(step) ** 2 == pytest.approx(1 + step * square * (step - 0.02), rel=1e-9)
        assert packing.growth(step) == pytest.approx(packing.late_growth(step), rel=1e-9)
    assert pair(springs=Elements(normal=1.0), dashpots=Elements(normal=0.1)).late_growth(0.1) == 1.0


def test_late_springs_are_springs(pair):
    with pytest.raises(ValueError, match="late springs"):
        pair(springs=Elements(normal=1.0), late=Elements(tangential=0.5))


def test_iteration_agrees_with_all_eigenvalues(monkeypatch):
    from reference.analytic import packing_modes

    packing = lattice_packing("triangular", 0.3, dashpots=Elements(normal=0.2))
    dense = packing.largest_step()
    monkeypatch.setattr(packing_modes, "DENSE", 10)
    assert packing.largest_step() == pytest.approx(dense, rel=1e-7)
