"""Moduli, waves and stability against periodic samples whose particles push each other one by one."""

import functools
import itertools
import math

import numpy as np
import pytest

from reference.analytic.lattices import Chain, FaceCentredCubic, Square, Triangular, hertz_chain

BASIS = {
    Square: np.eye(2),
    Triangular: np.array([[1, 0], [0.5, math.sqrt(0.75)]]),
    FaceCentredCubic: math.sqrt(0.5) * np.array([[1, 1, 0], [1, 0, 1], [0, 1, 1]]),
}
LATTICES = list(BASIS)
SPRINGS = [(1.0, 0.0, None), (1.0, 0.2, 0.5), (1.0, 0.8, 0.4)]
MASS, SPACING = 1.7, 0.6
PER_SIDE = 4


def lattice(kind, springs):
    k_n, k_t, q = springs
    return kind(normal_stiffness=k_n, tangential_stiffness=k_t, inertia_factor=q, mass=MASS, spacing=SPACING)


def neighbours(kind):
    """Sites (N, D) of a periodic sample in steps of the basis, and its pairs (i, j, normal from i to j)."""
    basis = BASIS[kind]
    sites = np.array(list(itertools.product(range(PER_SIDE), repeat=len(basis))))
    steps = [s for s in itertools.product((-1, 0, 1), repeat=len(basis)) if abs(np.linalg.norm(s @ basis) - 1) < 1e-9]
    steps = [s for s in steps if s > tuple(-x for x in s)]
    number = {tuple(s): i for i, s in enumerate(sites)}
    pairs = [(number[tuple(s)], number[tuple((s + step) % PER_SIDE)], step @ basis) for s in sites for step in steps]
    return sites, pairs


def pushes(kind, springs, u, w):
    """Forces (N, 3, ...) and torques of small displacements u (N, 3, ...) and rotations w; contact by contact."""
    k_n, k_t, _ = springs
    force, torque = np.zeros_like(u), np.zeros_like(w)
    for i, j, direction in neighbours(kind)[1]:
        n = np.zeros(3)
        n[: len(direction)] = direction
        arm = 0.5 * SPACING * n[:, None]
        at_i = u[i] + np.cross(w[i], arm, axis=0)
        at_j = u[j] + np.cross(w[j], -arm, axis=0)
        opened = at_j - at_i
        along = n[:, None] * (n @ opened)
        pull = k_n * along + k_t * (opened - along)
        force[i] += pull
        force[j] -= pull
        torque[i] += np.cross(arm, pull, axis=0)
        torque[j] += np.cross(-arm, -pull, axis=0)
    return force, torque


@functools.cache
def stiffness_matrix(kind, springs):
    """The sample's stiffness over masses and inertias, (N modes, N modes), symmetric."""
    count = PER_SIDE ** BASIS[kind].shape[1]
    spins = [] if springs[1] == 0 else ([2] if kind is not FaceCentredCubic else [0, 1, 2])
    kept = [(i, "u", a) for i in range(count) for a in range(BASIS[kind].shape[1])]
    kept += [(i, "w", a) for i in range(count) for a in spins]
    u, w = np.zeros((2, count, 3, len(kept)))
    for column, (i, sort, a) in enumerate(kept):
        (u if sort == "u" else w)[i, a, column] = 1
    force, torque = pushes(kind, springs, u, w)
    rows = -np.array([(force if sort == "u" else torque)[i, a] for i, sort, a in kept])
    inertia = (springs[2] or 0) * MASS * (SPACING / 2) ** 2
    root = np.sqrt([MASS if sort == "u" else inertia for _, sort, _ in kept])
    return rows / np.outer(root, root)


@pytest.mark.parametrize("springs", SPRINGS)
@pytest.mark.parametrize("kind", LATTICES)
def test_dispersion(kind, springs):
    """All frequencies of a periodic sample are those of the waves that fit into it."""
    case = lattice(kind, springs)
    matrix = stiffness_matrix(kind, springs)
    assert matrix == pytest.approx(matrix.T, abs=1e-12)
    reciprocal = 2 * np.pi * np.linalg.inv(BASIS[kind]).T / SPACING
    waves = neighbours(kind)[0] @ reciprocal / PER_SIDE
    found = np.sort(case.frequencies(waves).ravel() ** 2)
    assert found == pytest.approx(np.linalg.eigvalsh(matrix), abs=1e-11)
    assert case.highest_frequency**2 == pytest.approx(found[-1], rel=1e-12)


@pytest.mark.parametrize("kind", LATTICES)
@pytest.mark.parametrize("q", [0.4, 0.5, 2 / 3])
def test_no_wave_is_faster(kind, q):
    """A search over the zone, also where the wave at its edge and the uniform rotation cross."""
    rng = np.random.default_rng(3)
    waves = 2 * np.pi / SPACING * rng.uniform(-1, 1, (4000, BASIS[kind].shape[1]))
    crossing = {Square: 4 / (8 / q - 4), Triangular: 6 / (12 / q - 2), FaceCentredCubic: 8 / (16 / q - 8)}[kind]
    for k_t in (0.05, crossing, 1.05 * crossing, 1.0, 2.0):
        case = lattice(kind, (1.0, k_t, q))
        highest = case.frequencies(waves).max()
        assert 0.98 * case.highest_frequency < highest < case.highest_frequency * (1 + 1e-12)


def test_discs_as_heavy_as_rings():
    """For q > 2/3 a wave inside the zone is faster than both candidates, so there is no closed form."""
    case = lattice(Triangular, (1.0, 0.6, 1.0))
    waves = 2 * np.pi / SPACING * np.random.default_rng(3).uniform(-1, 1, (4000, 2))
    assert case.frequencies(waves).max() ** 2 > 1.02 * 7.2 / MASS
    with pytest.raises(ValueError, match="inertia factors above 2/3"):
        _ = case.stability_limit


@pytest.mark.parametrize(("kind", "highest"), [(Square, 4.0), (Triangular, 6.0), (FaceCentredCubic, 8.0)])
def test_frictionless_stability_limits(kind, highest):
    case = lattice(kind, SPRINGS[0])
    assert case.stability_limit == pytest.approx(2 * math.sqrt(MASS / highest), rel=1e-14)


@pytest.mark.parametrize("springs", SPRINGS)
@pytest.mark.parametrize("kind", LATTICES)
def test_verlet_at_the_limit(kind, springs):
    """A per mille of time step to either side of the limit decides between bounded and exploding."""
    matrix = stiffness_matrix(kind, springs)
    limit = lattice(kind, springs).stability_limit
    start = matrix @ np.random.default_rng(0).normal(size=len(matrix))
    for part, stable in [(0.999, True), (1.001, False)]:
        x, v, a = start.copy(), np.zeros_like(start), -matrix @ start
        dt = part * limit
        for _ in range(600):
            v += 0.5 * dt * a
            x += dt * v
            a = -matrix @ x
            v += 0.5 * dt * a
        assert (np.abs(x).max() < 1e3 * np.abs(start).max()) == stable


def energy(kind, springs, strain):
    """Energy per volume of a homogeneous strain (D, D), least over the common rotation of the particles."""
    k_n, k_t, _ = springs
    dimension = BASIS[kind].shape[1]
    rotations = [np.array([[0, -1], [1, 0]])] if dimension == 2 else [np.cross(np.eye(3), e) for e in np.eye(3)]
    normals = [n for i, _, n in neighbours(kind)[1] if i == 0]
    scaled, turned = [], []
    for n in normals:
        root = math.sqrt(k_n) * np.outer(n, n) + math.sqrt(k_t) * (np.eye(dimension) - np.outer(n, n))
        scaled.append(root @ strain @ n * SPACING)
        turned.append(np.stack([root @ r @ n * SPACING for r in rotations], axis=1))
    scaled, turned = np.concatenate(scaled), np.concatenate(turned)
    least = scaled if k_t == 0 else scaled - turned @ np.linalg.lstsq(turned, scaled, rcond=None)[0]
    volume = SPACING**dimension * abs(np.linalg.det(BASIS[kind]))
    return least @ least / (2 * volume)


@pytest.mark.parametrize("springs", SPRINGS)
@pytest.mark.parametrize("kind", LATTICES)
def test_moduli(kind, springs):
    """From the energy of any strain, with a rotation mixed in that must not count."""
    moduli, rng = lattice(kind, springs).moduli, np.random.default_rng(2)
    dimension = BASIS[kind].shape[1]
    for _ in range(5):
        gradient = rng.normal(size=(dimension, dimension))
        if springs[1] == 0:
            gradient = gradient + gradient.T
        strain = (gradient + gradient.T) / 2
        diagonal = np.diag(strain)
        expected = 0.5 * (
            moduli.axial * diagonal @ diagonal + moduli.lateral * (diagonal.sum() ** 2 - diagonal @ diagonal)
            + 2 * moduli.shear * (np.sum(strain**2) - diagonal @ diagonal)
        )
        assert energy(kind, springs, gradient) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("springs", SPRINGS)
@pytest.mark.parametrize("kind", LATTICES)
def test_wave_speeds_are_the_long_waves(kind, springs):
    """w/q of the acoustic waves, extrapolated to q = 0."""
    case, rng = lattice(kind, springs), np.random.default_rng(4)
    dimension = BASIS[kind].shape[1]
    for _ in range(3):
        direction = rng.normal(size=dimension)
        direction /= np.linalg.norm(direction)
        size = np.array([0.04, 0.02, 0.01])[:, None] / SPACING
        coarse, middle, fine = (case.frequencies(size * direction) / size)[:, :dimension]
        better = (4 * fine - middle) / 3
        best = (16 * better - (4 * middle - coarse) / 3) / 15
        assert case.wave_speeds(direction) == pytest.approx(best, rel=1e-9, abs=1e-7)


def test_triangular_lattice_as_known():
    """Bulk modulus, Young's modulus, Poisson's ratio and speeds as they are usually printed."""
    k_n, k_t = 1.3, 0.4
    case = lattice(Triangular, (k_n, k_t, 0.5))
    assert case.moduli.bulk == pytest.approx(math.sqrt(3) / 2 * k_n, rel=1e-14)
    assert case.moduli.poisson == pytest.approx((k_n - k_t) / (3 * k_n + k_t), rel=1e-14)
    assert case.moduli.young == pytest.approx(
        2 * math.sqrt(3) * k_n * (k_n + k_t) / (3 * k_n + k_t), rel=1e-14
    )
    for angle in (0.0, 0.3, 1.2):
        shear, pressure = case.wave_speeds([math.cos(angle), math.sin(angle)])
        assert shear == pytest.approx(SPACING * math.sqrt(3 / 8 * (k_n + k_t) / MASS), rel=1e-12)
        assert pressure == pytest.approx(SPACING * math.sqrt(3 / 8 * (3 * k_n + k_t) / MASS), rel=1e-12)
    wave = np.linspace(0, 2 * np.pi / SPACING, 20)
    along = np.sqrt(4 / MASS * (np.sin(wave * SPACING / 2) ** 2 + 0.5 * np.sin(wave * SPACING / 4) ** 2))
    across = np.sqrt(4 / MASS * 1.5 * np.sin(wave * SPACING / 4) ** 2)
    found = lattice(Triangular, SPRINGS[0]).frequencies(np.stack([wave, 0 * wave], axis=1))
    assert found == pytest.approx(np.sort(np.stack([across, along], axis=1), axis=1), abs=1e-7)


def test_young_and_poisson_invert_the_moduli():
    """Uniaxial stress along an axis: solve C e = s."""
    for kind in (Triangular, FaceCentredCubic):
        moduli = lattice(kind, SPRINGS[1]).moduli
        dimension = moduli.dimension
        matrix = np.full((dimension, dimension), moduli.lateral) + (moduli.axial - moduli.lateral) * np.eye(dimension)
        strain = np.linalg.solve(matrix, np.eye(dimension)[0])
        assert moduli.young == pytest.approx(1 / strain[0], rel=1e-12)
        assert moduli.poisson == pytest.approx(-strain[1] / strain[0], rel=1e-12)
        assert moduli.bulk == pytest.approx(matrix.sum() / dimension**2, rel=1e-12)


def test_rotations_need_an_inertia():
    with pytest.raises(ValueError, match="inertia_factor is missing"):
        Square(normal_stiffness=1.0, mass=1.0, spacing=1.0, tangential_stiffness=0.1)


def chain_frequencies(stiffness, mass, ends):
    """Of the tridiagonal matrix of a row of seven."""
    matrix = 2 * np.eye(7) - np.eye(7, k=1) - np.eye(7, k=-1)
    if ends == "free":
        matrix[0, 0] = matrix[-1, -1] = 1
    return np.sqrt(np.maximum(np.linalg.eigvalsh(stiffness / mass * matrix), 0))


def test_chain():
    row = Chain(stiffness=2.0, mass=MASS, spacing=SPACING)
    assert row.free_frequencies(7) == pytest.approx(chain_frequencies(2.0, MASS, "free"), rel=1e-9, abs=1e-7)
    assert row.clamped_frequencies(7) == pytest.approx(chain_frequencies(2.0, MASS, "clamped"), rel=1e-12)
    assert row.stability_limit == pytest.approx(math.sqrt(MASS / 2.0), rel=1e-15)
    assert row.free_frequencies(2)[-1] ** 2 == pytest.approx(2 * 2.0 / MASS, rel=1e-14)
    assert row.frequencies(1e-6) / 1e-6 == pytest.approx(row.wave_speed, rel=1e-12)


def test_hertz_chain():
    """Small waves on Hertz contacts under load, the forces differentiated along the imaginary axis."""
    k, diameter, force, count, step = 4e9, 0.01, 30.0, 6, 1e-20
    row = hertz_chain(hertz_stiffness=k, force=force, mass=MASS, diameter=diameter)
    rest = row.spacing * np.arange(count + 2)
    matrix = np.empty((count, count))
    for i in range(count):
        x = rest.astype(complex)
        x[i + 1] += 1j * step
        overlap = diameter - np.diff(x)
        matrix[:, i] = -(k * (overlap[:-1] ** 1.5 - overlap[1:] ** 1.5)).imag / step
    assert k * (diameter - row.spacing) ** 1.5 == pytest.approx(force, rel=1e-10)
    assert row.clamped_frequencies(count) == pytest.approx(np.sqrt(np.linalg.eigvalsh(matrix) / MASS), rel=1e-9)
    stronger = hertz_chain(hertz_stiffness=k, force=64 * force, mass=MASS, diameter=diameter)
    assert stronger.stability_limit == pytest.approx(row.stability_limit / 2, rel=1e-12)
    with pytest.raises(ValueError, match="force must be positive"):
        hertz_chain(hertz_stiffness=k, force=0.0, mass=MASS, diameter=diameter)
