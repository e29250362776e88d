"""What every registered law must pass, in every convention, between particles and at a wall, in 2D and 3D.

Bodies are driven along one path over which contacts close, load, shear, roll, twist, open and close again.
"""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from reference.kernel.conventions import CONVENTIONS
from reference.kernel.laws.registry import LAWS, build_law
from reference.kernel.prescribed import driven

STEPS = 70
HISTORY = {("sliding", "spring"), ("sliding", "mindlin"), ("rolling", "spring"), ("torsion", "spring"),
           ("normal", "hysteretic"), ("normal", "hysteretic_variable")}
"""Laws whose contacts remember; all others must not."""

CREATE_ENERGY = {("sliding", "mindlin"): CONVENTIONS, ("rolling", "spring"): {"liggghts"}}
"""Where closed cycles may bring energy in: a stiffness that changes under a stretched spring (Thornton, Cummins &
Cleary, Powder Technol. 233, 30 (2013)), and a spring that does not follow the contact as it turns."""

REGISTERED = [(family, word) for family, words in LAWS.items() for word in words]
CASES = [(family, word, dim, convention) for family, word in REGISTERED for dim in (2, 3) for convention in CONVENTIONS
         if (family, dim) != ("torsion", 2)]


@pytest.fixture(scope="module", params=CASES, ids=lambda c: f"{c[0]}-{c[1]}-{c[2]}D-{c[3]}")
def case(request, dem):
    """A model with the law and a path, and what the law answers."""
    family, word, dim, convention = request.param
    tables = dem.contact_with(family, word)
    made = bodies(dem, dim, convention, tables)
    path = wild_path(made, seed=dim)
    force, torque = driven(made, **path)
    return SimpleNamespace(family=family, word=word, dim=dim, convention=convention, tables=tables, model=made,
                           path=path, force=force, torque=torque)


def bodies(dem, dim, convention, tables):
    """Four unequal particles in a heap, the first on a slanting rough wall through the origin."""
    heap = [[0.0, 0.95, 0.0], [1.85, 1.6, 0.3], [0.2, 2.75, -0.2], [1.95, 3.55, 0.6]]
    slope = dem.wall("slope", [0.0] * dim, (0.1, 1.0, 0.05)[:dim], friction=True)
    return dem.model([row[:dim] for row in heap], radius=[1.0, 1.1, 0.9, 1.0], mass=[1.0, 1.5, 0.8, 1.2],
                     walls=[slope], convention=convention, dt=0.01, **tables)


def wild_path(model, seed):
    """Apart at first and at last; in between everything moves at some frequencies of its own."""
    rng, n, dim = np.random.default_rng(seed), model.particle_count, model.dimension
    spins = len(model.spin)
    t = np.arange(STEPS + 1) / STEPS
    apart = 1.0 + 0.7 * np.exp(-((t / 0.05) ** 2)) + 0.7 * np.exp(-(((1.0 - t) / 0.05) ** 2)) + 0.05 * np.sin(40 * t)
    frequency, phase = rng.uniform(5, 40, (2, n, dim + spins))
    wave = np.sin(frequency * t[:, None, None] + phase)
    x = apart[:, None, None] * model.x.T + 0.04 * wave[..., :dim] * np.sin(np.pi * t)[:, None, None]
    v = np.vstack([np.zeros((1, n, dim)), np.diff(x, axis=0) / model.dt])
    return {"x": x, "v": v, "spin": wave[..., dim:]}


def test_every_law_has_its_numbers(dem):
    assert set(dem.tables) == set(REGISTERED)


def test_the_path_meets_everything(case):
    """Pairs and the wall touch, open and touch again, else the other checks say little."""
    x, m = case.path["x"], case.model
    height = x[:, 0] @ np.array(m.walls[0].normal) - m.radius[0]
    gap = np.linalg.norm(x[:, 1] - x[:, 2], axis=1) - m.radius[1:3].sum()
    for distance in (height, gap):
        assert (np.diff(np.sign(distance)) < 0).sum() >= 2
        assert -0.4 < distance.min() < -0.05


def test_it_acts(case, dem):
    """With the law the answer is another than with the bare linear contact."""
    bare = bodies(dem, case.dim, case.convention, {"normal": dem.table("normal", "linear", normal_damping=0.0)})
    force, torque = driven(bare, **case.path)
    with_law, without = (case.torque, torque) if case.family in ("rolling", "torsion") else (case.force, force)
    assert np.abs(with_law - without).max() > 1e-3 * np.abs(force).max()


# --- Newton ----------------------------------------------------------------------------------------------


def test_action_is_reaction(case, dem):
    """Without the wall, forces add up to nothing, and with lever arms up to the contact plane so do moments."""
    free = dataclasses.replace(case.model, walls=())
    force, torque = driven(free, **case.path)
    assert np.abs(force.sum(axis=1)).max() <= 1e-13 * np.abs(force).max()
    three = [np.concatenate([a, np.zeros((*a.shape[:2], 3 - a.shape[2]))], axis=2) for a in (case.path["x"][1:], force)]
    spin = np.concatenate([np.zeros((*torque.shape[:2], 3 - torque.shape[2])), torque], axis=2)
    moment = np.cross(*three) + spin
    assert np.abs(moment.sum(axis=1)).max() <= 1e-13 * np.abs(np.cross(*three)).max()


def test_nothing_without_contact(case):
    """No force and no torque as long as every gap is open, and nothing remembered."""
    path = dict(case.path)
    path["x"] = path["x"] + 2.0 * case.model.x.T
    force, torque = driven(case.model, **path)
    assert not force.any()
    assert not torque.any()


# --- frames ----------------------------------------------------------------------------------------------


def orthogonal(dim, mirror):
    turn, _ = np.linalg.qr(np.random.default_rng(dim).normal(size=(dim, dim)))
    turn[0] *= np.linalg.det(turn)
    return np.diag([-1.0] + [1.0] * (dim - 1)) @ turn if mirror else turn


@pytest.mark.parametrize("mirror", [False, True])
def test_in_a_turned_or_mirrored_frame(case, mirror):
    """Vectors turn along, spins and couples as axial vectors."""
    q = orthogonal(case.dim, mirror)
    axial = np.linalg.det(q).round() * (q if case.dim == 3 else np.eye(1))
    slope = case.model.walls[0]
    walls = (dataclasses.replace(slope, point=tuple(q @ slope.point), normal=tuple(q @ slope.normal)),)
    other = dataclasses.replace(case.model, walls=walls)
    path = {"x": case.path["x"] @ q.T, "v": case.path["v"] @ q.T, "spin": case.path["spin"] @ axial.T}
    same(case, driven(other, **path), turned=(q, axial))


def test_elsewhere(case):
    shift = np.array([0.3, -0.7, 0.4])[: case.dim]
    walls = tuple(dataclasses.replace(w, point=tuple(np.array(w.point) + shift)) for w in case.model.walls)
    path = case.path | {"x": case.path["x"] + shift}
    same(case, driven(dataclasses.replace(case.model, walls=walls), **path))


def test_under_other_names(case):
    order = np.array([2, 0, 3, 1])
    m = case.model
    other = dataclasses.replace(m, x=m.x[:, order], v=m.v[:, order], spin=m.spin[:, order], radius=m.radius[order],
                                mass=m.mass[order], inertia=m.inertia[order])
    force, torque = driven(other, **{name: rows[:, order] for name, rows in case.path.items()})
    back = np.argsort(order)
    same(case, (force[:, back], torque[:, back]))


def same(case, answer, turned=None):
    """To 1e-13 of the largest force of the path, and of that force on an arm of 1, the mean radius."""
    force, torque = answer
    q, axial = turned or (np.eye(case.dim), np.eye(case.torque.shape[-1]))
    largest = np.abs(case.force).max()
    assert np.abs(force - case.force @ q.T).max() <= 1e-13 * largest
    assert np.abs(torque - case.torque @ axial.T).max() <= 1e-13 * largest


# --- energy ----------------------------------------------------------------------------------------------


def test_a_closed_cycle_brings_no_energy_in(case):
    """From apart to apart, the work that contacts do on the bodies is never positive."""
    if case.convention in CREATE_ENERGY.get((case.family, case.word), ()):
        pytest.skip("a law that may create energy in a closed cycle")
    force, torque = (np.concatenate([np.zeros_like(a[:1]), a]) for a in (case.force, case.torque))
    turned = case.path["spin"][1:] * case.model.dt
    work = ((force[1:] + force[:-1]) / 2 * np.diff(case.path["x"], axis=0)).sum() + (torque[1:] * turned).sum()
    exchanged = np.abs(force[1:] * np.diff(case.path["x"], axis=0)).sum()
    assert work < 0.0
    assert work > -exchanged


# --- memory ----------------------------------------------------------------------------------------------


def test_only_laws_with_history_remember(case):
    convention = CONVENTIONS[case.convention]
    normal = build_law("normal", case.tables["normal"], convention)
    law = build_law(case.family, case.tables[case.family], convention, normal)
    assert (law.memory_rows(case.dim) > 0) == ((case.family, case.word) in HISTORY)


def test_what_has_no_history_answers_the_moment_alone(case):
    """The same row after another past: the same answer without history, another with it."""
    row = STEPS // 2
    jump = {name: np.stack([rows[0], rows[row]]) for name, rows in case.path.items()}
    force, torque = driven(case.model, **jump)
    same_force = np.array_equal(force[0], case.force[row - 1]) and np.array_equal(torque[0], case.torque[row - 1])
    assert same_force == ((case.family, case.word) not in HISTORY)


def test_an_opened_contact_forgets(case):
    """The path, and once more: the second time is like the first."""
    twice = {name: np.concatenate([rows, rows]) for name, rows in case.path.items()}
    force, torque = driven(case.model, **twice)
    assert np.array_equal(force[STEPS + 1:], case.force)
    assert np.array_equal(torque[STEPS + 1:], case.torque)
