"""Numbers by pair of materials: every pair moves as if its numbers were those of all."""

import dataclasses
import math

import numpy as np
import pytest

from reference.kernel.batch import batch
from reference.kernel.conventions import NAMED
from reference.kernel.corrected import simulate
from reference.kernel.deck import _kinds
from reference.kernel.guards import KernelUnstable, refuse_late_springs
from reference.kernel.late_springs import late_families
from reference.kernel.laws import by_pair
from reference.kernel.laws.registry import build_law
from reference.kernel.program.compose import can_compose
from reference.kernel.program.simulation import ProgramSimulation, fastest
from reference.kernel.simulation import Simulation

STIFFNESS = np.array([[1e2, 2e2, 5e2], [2e2, 1e6, 3e4], [5e2, 3e4, 7e3]])
DASHPOT = np.array([[0.5, 0.0, 1.0], [0.0, 30.0, 9.0], [1.0, 9.0, 4.0]])
CROWDED = np.array([[1e3, 2e3, 5e3], [2e3, 1e4, 3e3], [5e3, 3e3, 7e3]])
"""Softer ones, as overlaps of a third of a radius let go of much energy."""

SHEAR = {
    "shear_friction": [[0.2, 0.3, 0.4], [0.3, 0.5, 0.6], [0.4, 0.6, 0.7]],
    "shear_stiffness": (0.3 * CROWDED).tolist(), "shear_damping": (0.4 * DASHPOT + 0.1).tolist(),
}
PAIRS = [(a, b) for a in range(3) for b in range(a, 3)]
MASS = np.array([1.0, 2.0, 0.5])


def normal_table(stiffness=STIFFNESS, damping=DASHPOT):
    return {
        "law": "linear", "attraction": "allowed", "normal_stiffness": np.array(stiffness).tolist(),
        "normal_damping": np.array(damping).tolist(),
    }


def with_materials(model, kind, *, normal=None, sliding=None):
    """Return the model with laws by pair; kind: of all nodes."""
    kind, made = np.array(kind), {}
    made["normal"] = build_law("normal", normal or normal_table(), model.convention, kind=kind)
    if sliding is not None:
        made["sliding"] = build_law("sliding", {"law": "spring"} | sliding, model.convention, kind=kind)
    return dataclasses.replace(model, **made)


def head_on(dem, a, b, *, normal, dt, gap=0.01, speed=1.0, **options):
    """Two bodies of radius 1, of the materials a and b, that approach each other with `speed` along an oblique line."""
    line = np.array([0.6, 0.8])
    x, v = np.array([0.0 * line, (2.0 + gap) * line]), 0.5 * speed * np.array([line, -line])
    model = dem.model(x, v=v, mass=[MASS[a], MASS[b]], dt=dt, **options)
    return with_materials(model, [a, b], normal=normal)


def reduced(a, b):
    return MASS[a] * MASS[b] / (MASS[a] + MASS[b])


@pytest.mark.parametrize("make", [Simulation, ProgramSimulation])
@pytest.mark.parametrize(("a", "b"), PAIRS)
def test_elastic_contacts_last_half_a_period_of_their_own_spring(dem, make, a, b):
    """t_c = pi/sqrt(k_ab/m*), to second order in the step; the stiffnesses are up to 1e4 apart."""
    exact, found = math.pi / math.sqrt(STIFFNESS[a, b] / reduced(a, b)), []
    for parts in (100, 200):
        model = head_on(dem, a, b, normal=normal_table(damping=0 * DASHPOT), dt=exact / parts, gap=0.1 * exact)
        simulation = make(model)
        simulation.advance(2 * parts)
        branch = simulation.state.x[:, 1] - simulation.state.x[:, 0]
        flight = 0.1 * exact + np.linalg.norm(branch) - 2.0
        found.append(simulation.time - flight - exact)
    assert abs(found[1]) < 1e-4 * exact
    assert abs(found[0]) < 8 * max(abs(found[1]), 1e-6 * exact)


@pytest.mark.parametrize("convention", ["talk", "corrected"])
@pytest.mark.parametrize(("a", "b"), PAIRS)
def test_damped_contacts_have_the_restitution_of_their_own_numbers(dem, convention, a, b):
    """e = exp(-pi b/sqrt(k_ab/m* - b^2)), b = gamma_ab/(2 m*)."""
    rate = DASHPOT[a, b] / (2 * reduced(a, b))
    exact = math.pi / math.sqrt(STIFFNESS[a, b] / reduced(a, b) - rate**2)
    model = head_on(
        dem, a, b, normal=normal_table(), dt=exact / 1000, gap=0.1 * exact, convention=NAMED[convention]
    )
    simulation = fastest(model)
    simulation.advance(1300)
    assert isinstance(simulation, ProgramSimulation)
    apart = simulation.state.v[:, 1] - simulation.state.v[:, 0]
    tolerance = 4e-3 if convention == "talk" else 2e-5
    assert apart @ [0.6, 0.8] == pytest.approx(math.exp(-rate * exact), abs=tolerance)


def crowd(dem, dim, *, sliding, convention):
    """A jittered lattice of three materials between a rough wall of the second and a smooth one of the third."""
    corner = [0.0] * dim
    walls = (
        dem.wall("bottom", corner, [0.0, 1.0, 0.0][:dim], friction=sliding),
        dem.wall("left", corner, [1.0, 0.0, 0.0][:dim]),
    )
    across = {2: 6, 3: 3}[dim]
    model = dem.cluster(3, dim, across=across, walls=walls, squeeze=0.95, speed=0.3, convention=convention, dt=2e-4)
    kind = np.r_[np.random.default_rng(1).integers(0, 3, model.particle_count), 1, 2]
    return with_materials(model, kind, normal=normal_table(CROWDED), sliding=SHEAR if sliding else None)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("sliding", [False, True])
@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk", "corrected"])
def test_the_program_does_what_the_textbook_does(dem, dim, sliding, convention):
    """Motion, forces of contacts and what they remember, told in the textbook's units.

    In the conventions of LIGGGHTS rounding decides whether a sliding contact is told with its dashpot, as there.
    """
    model = crowd(dem, dim, sliding=sliding, convention=NAMED[convention])
    textbook, program = simulate(model), ProgramSimulation(model)
    assert can_compose(model)
    for simulation in (textbook, program):
        simulation.advance(150)
    assert program.state.x == pytest.approx(textbook.state.x, abs=1e-12)
    assert program.state.v == pytest.approx(textbook.state.v, abs=1e-10)
    for (_, found), (_, wanted) in zip(program.contacts(), textbook.contacts(), strict=True):
        assert found.f_n == pytest.approx(wanted.f_n, abs=1e-8)
        if convention != "liggghts":
            assert found.force == pytest.approx(wanted.force, abs=1e-8)
        if sliding and "sliding" in wanted.memory:
            assert found.memory["sliding"] == pytest.approx(wanted.memory["sliding"], abs=1e-12)


@pytest.mark.parametrize("rough", [False, True])
def test_springs_that_may_lag_are_those_of_the_roughest_pair(dem, rough):
    """In LAMMPS' conventions, beyond mu = 1, springs in a plane are vectors: all of them as soon as one pair is."""
    friction = [[0.2, 0.3, 3.0], [0.3, 0.5, 0.6], [3.0, 0.6, 0.7]] if rough else [[0.5] * 3] * 3
    shear = SHEAR | {"shear_friction": friction}
    model = crowd(dem, 2, sliding=True, convention=NAMED["lammps"])
    model = with_materials(model, model.normal.kind, normal=normal_table(CROWDED), sliding=shear)
    textbook, program = simulate(model), ProgramSimulation(model)
    for simulation in (textbook, program):
        simulation.advance(150)
    assert len(program.history["sliding"]) == 1 + rough
    assert program.state.x == pytest.approx(textbook.state.x, abs=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk", "corrected"])
def test_every_contact_has_the_forces_of_its_own_numbers(dem, dim, convention):
    """Against laws with the numbers of one pair for all, contact by contact; springs start from what they were."""
    model = crowd(dem, dim, sliding=True, convention=NAMED[convention])
    simulation = simulate(model)
    simulation.advance(30)
    seen = set()
    for interaction, forces in simulation.contacts():
        c, springs = forces.contact, interaction.pairs.recall(forces.touching)
        kind = model.normal.kind
        low, high = np.sort([kind[c.i], kind[c.j]], axis=0)
        for a, b in PAIRS:
            plain = _plain(model, a, b)
            which = np.flatnonzero((low == a) & (high == b))
            part = _part(c, which)
            f_n, elastic, _ = plain["normal"].force(part, None)
            force = f_n * part.n
            if interaction.sliding is not None:
                pressing = interaction.pressing(part, f_n, elastic)
                memory = springs["sliding"][:, which]
                force = force + plain["sliding"].force(part, pressing, memory, model.dt, advance=False)[0]
                assert np.abs(memory).max(initial=1.0) > 0.0
                assert interaction.sliding.spring(part)[0] == pytest.approx(plain["sliding"].shear_stiffness, rel=1e-15)
            assert forces.force[:, which] == pytest.approx(force, rel=1e-14, abs=1e-14)
            seen |= {(a, b)} if len(which) else set()
    assert seen == set(PAIRS)


def _plain(model, a, b):
    numbers = {"normal_stiffness": float(CROWDED[a, b]), "normal_damping": float(DASHPOT[a, b])}
    shear = {name: float(np.array(table)[a, b]) for name, table in SHEAR.items()}
    return {
        "normal": build_law("normal", {"law": "linear", "attraction": "allowed"} | numbers, model.convention),
        "sliding": build_law("sliding", {"law": "spring"} | shear, model.convention),
    }


def _part(contact, which):
    arrays = {f.name: getattr(contact, f.name) for f in dataclasses.fields(contact)}
    return dataclasses.replace(contact, **{k: v[..., which] for k, v in arrays.items() if v is not None})


@pytest.mark.parametrize("name", ["i and j swapped", "tables turned round", "mean of both"])
def test_wrong_look_ups_are_caught(dem, monkeypatch, name):
    """Mutants: what a code that mixed numbers, or read the wrong row, would do to times of contact."""
    honest = by_pair.ByPair.between

    def wrong(self, i, j):
        if name == "i and j swapped":
            return honest(self, i, i)
        if name == "tables turned round":
            turned = [[2, 1, 0][k] for k in self.kind]
            return honest(dataclasses.replace(self, kind=np.array(turned)), i, j)
        one, other = honest(self, i, i), honest(self, j, j)
        return {k: np.sqrt(one[k] * other[k]) for k in one}

    monkeypatch.setattr(by_pair.ByPair, "between", wrong)
    with pytest.raises(AssertionError):
        _all_pairs_last_as_they_should(dem)


def _all_pairs_last_as_they_should(dem):
    for a, b in PAIRS:
        test_elastic_contacts_last_half_a_period_of_their_own_spring(dem, Simulation, a, b)


@pytest.mark.parametrize("table", [[[1.0]], [1.0, 2.0], [[1.0, 2.0], [3.0, 4.0]]])
def test_tables_that_are_none_are_refused(table):
    with pytest.raises(ValueError, match="normal_stiffness: expected a symmetric table over 2 materials"):
        build_law("normal", normal_table(table, np.zeros((2, 2))), NAMED["talk"], kind=np.array([0, 1]))


def test_laws_without_tables_are_refused():
    table = {"law": "viscous", "shear_friction": [[0.5]], "shear_damping": [[1.0]]}
    with pytest.raises(ValueError, match="ViscousSliding has one set of numbers"):
        build_law("sliding", table, NAMED["talk"], kind=np.array([0]))


def test_decks_with_rings_are_refused():
    with pytest.raises(ValueError, match="expected a deck without rings"):
        _kinds({"materials": ["soft"], "rings": [], "walls": []}, {"material": np.zeros(1)})


def test_replicas_are_refused(dem):
    model = head_on(dem, 0, 1, normal=None, dt=1e-4)
    with pytest.raises(ValueError, match="tables over pairs of materials"):
        batch([model, model], room=1.0)


def test_the_guard_of_late_springs_asks_for_the_pair_that_grows_fastest(dem):
    """One pair without a dashpot is enough; with dashpots of dt k none grows."""
    dt = 1e-5
    held = SHEAR | {"shear_damping": (2 * dt * np.array(SHEAR["shear_stiffness"])).tolist()}
    one = np.array(held["shear_damping"])
    one[1, 1] = 0.0
    bare = SHEAR | {"shear_damping": one.tolist()}
    model = dem.cluster(1, 2, dt=dt)
    kind = np.arange(model.particle_count) % 3
    refuse_late_springs(with_materials(model, kind, sliding=held), 10**9)
    assert not late_families(with_materials(model, kind, sliding=held))
    late = with_materials(model, kind, sliding=bare)
    assert late_families(late) == ("sliding",)
    with pytest.raises(KernelUnstable, match="sliding spring one step late"):
        refuse_late_springs(late, 10**9)
