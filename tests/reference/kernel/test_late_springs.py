"""Springs that are felt a step late stop a run in which they make swings grow, and no other."""

import json
import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import reference.kernel.__main__ as command
from reference.analytic.packing_modes import FIXED, Contacts, Elements, Packing
from reference.kernel import late_springs, small_motions, watches
from reference.kernel.conventions import NAMED
from reference.kernel.guards import MOST_GROWTH, KernelUnstable, refuse_late_springs
from reference.kernel.late_springs import WORTH_SAYING, LateSprings, late_families
from reference.kernel.laws.mindlin import MindlinSliding
from reference.kernel.program.simulation import ProgramSimulation
from reference.kernel.small_motions import LargestEigenvalue, Operator, contacts_of_now, step_growth

DEPTH = 1e-3
"""Overlap over radius of the disc between two plates."""


def plates(dem, depth=DEPTH, dim=2):
    """Rough ones that press a body of radius 1 between them."""
    up, at = ((0, 1), (0, 2 - 2 * depth)) if dim == 2 else ((0, 0, 1), (0, 0, 2 - 2 * depth))
    return [dem.wall("floor", (0,) * dim, up, friction=True),
            dem.wall("top", at, tuple(-c for c in up), friction=True)]


def rolled(dem, *families, stiffness=300.0, damping=0.0, friction=1e3):
    """Tables of springs against rolling and torsion that nothing overcomes."""
    return {
        family: dem.table(family, "spring", **{
            f"{family}_stiffness": stiffness, f"{family}_damping": damping, f"{family}_friction": friction})
        for family in families
    }


@pytest.fixture
def press(dem):
    """press(step, ...): a disc that spins between two rough plates, dt = step/W, W of its swing; W; gamma/k."""

    def make(step, *, law="mindlin", restitution=1.0, friction=10.0, spin=1e-6, convention="talk", depth=DEPTH):
        bare = {} if law == "mindlin" else {"shear_damping": 0.0}
        sliding = dem.table("sliding", law, shear_friction=friction, **bare)
        model = dem.model(
            [[0.0, 1 - depth]], spin=[[spin]], walls=plates(dem, depth), sliding=sliding, convention=convention, dt=1.0,
            normal=dem.table("normal", "hertz", restitution=restitution),
        )
        touching = dem.Simulation(model).interactions[1].last.contact
        stiffness, damping = model.sliding.spring(touching)
        swing = math.sqrt(float((stiffness * touching.torque_arm_i**2).sum() / model.inertia[0]))
        return replace(model, dt=step / swing), swing, float(damping[0] / stiffness[0])

    return make


@pytest.fixture(params=["textbook", "program"])
def kernel(dem, request):
    """One of the two evaluations."""
    return dem.Simulation if request.param == "textbook" else ProgramSimulation


def exponent_of_step(model, swing, held=0.0):
    """ln sqrt(1 + dt W^2 (dt - gamma/k))."""
    return 0.5 * math.log1p(model.dt * swing**2 * (model.dt - held))


def stopped(simulation, *, every, looks):
    """Return the step at which the watch stops a run, None if it does not."""
    watch = LateSprings(simulation.model, 10**6)
    watch.look(simulation)
    for _ in range(looks):
        simulation.advance(every)
        try:
            watch.look(simulation)
        except KernelUnstable:
            return simulation.state.step
    return None


# --- the rate -----------------------------------------------------------------------------------


def measured_rate(model, swing, steps):
    """Of growth a step: the largest spin of the last period over that of the first, in a run that nobody watches."""
    simulation, period = ProgramSimulation(model), math.ceil(2 * math.pi / (swing * model.dt))

    def largest():
        spins = []
        for _ in range(period):
            simulation.advance()
            spins.append(np.abs(simulation.state.spin[:, 0]).max())
        return max(spins)

    before = largest()
    simulation.advance(steps - period)
    return math.log(largest() / before) / steps


@pytest.mark.parametrize(("restitution", "steps"), [
    (1.0, (0.02, 0.04, 0.08, 0.16)),
    (0.95, (0.07, 0.085, 0.11, 0.155)),  # gamma/k is 0.06/W
])
def test_swings_grow_as_the_formula_says(press, restitution, steps):
    for step in steps:
        model, swing, held = press(step, restitution=restitution)
        rate = exponent_of_step(model, swing, held)
        assert 0 < rate < 0.02
        assert measured_rate(model, swing, math.ceil(4 / rate)) == pytest.approx(rate, rel=0.03)


def test_below_gamma_over_k_nothing_grows(press):
    model, swing, held = press(0.05, restitution=0.95)
    assert model.dt < held
    assert measured_rate(model, swing, 5000) < 0


TURNING = [("rolling", 2, [1]), ("rolling", 3, [1, 0, 0]), ("torsion", 3, [0, 0, 1])]


def turning(dem, family, dim, axis, step=0.08, held=0.0):
    """A body that turns between two plates on springs of one family, a* = R: W^2 = 2 k R^2/I; held: gamma/k over dt."""
    stiffness, place = 300.0, (0.0,) * (dim - 1) + (1 - DEPTH,)
    swing = math.sqrt(2 * stiffness / {2: 0.5, 3: 0.4}[dim])
    dt = step / swing
    laws = rolled(dem, family, stiffness=stiffness, damping=held * dt * stiffness)
    return dem.model([place], spin=[[1e-6 * a for a in axis]], walls=plates(dem, dim=dim), dt=dt, **laws), swing


@pytest.mark.parametrize(("family", "dim", "axis"), TURNING)
def test_rolling_and_torsion_swing_up_as_the_formula_says(dem, family, dim, axis):
    for held in (0.0, 0.7, 1.5):
        model, swing = turning(dem, family, dim, axis, held=held)
        rate = exponent_of_step(model, swing, held * model.dt)
        assert measured_rate(model, swing, math.ceil(4 / abs(rate))) == pytest.approx(rate, rel=0.03)


# --- what is stopped, and what is not -----------------------------------------------------------


@pytest.mark.parametrize(("family", "dim", "axis"), TURNING)
@pytest.mark.parametrize("held", [0.0, 0.7])
def test_rolling_and_torsion_are_stopped_that_the_guard_at_step_0_lets_begin(dem, kernel, family, dim, axis, held):
    """Between two plates the swing grows twice as fast as at the one wall that the guard asks for."""
    model, swing = turning(dem, family, dim, axis, held=held)
    rate = exponent_of_step(model, swing, held * model.dt)
    ends = int(1.98 * MOST_GROWTH / (model.dt * swing) ** 2 / (1 - held) * 2)
    refuse_late_springs(model, ends)
    expected = math.ceil(MOST_GROWTH / rate / 10) * 10
    assert expected < 0.6 * ends
    assert stopped(kernel(model), every=10, looks=ends // 10) == expected


@pytest.mark.parametrize(("family", "dim", "axis"), TURNING)
def test_what_rolls_or_twists_at_the_limit_does_not_swing(dem, kernel, family, dim, axis):
    model, _ = turning(dem, family, dim, axis)
    fast = replace(model, spin=1e6 * model.spin, **{family: replace(
        getattr(model, family), **{f"{family}_friction": 1e-3})})
    assert stopped(kernel(model), every=10, looks=50) is not None
    assert stopped(kernel(fast), every=10, looks=50) is None


@pytest.mark.parametrize("law", ["mindlin", "spring"])
def test_undamped_it_is_stopped_where_the_formula_says(press, kernel, law):
    model, swing, _ = press(0.08, law=law)
    expected = math.ceil(MOST_GROWTH / exponent_of_step(model, swing) / 10) * 10
    assert stopped(kernel(model), every=10, looks=expected // 10 + 3) == expected


def test_a_packing_is_stopped_that_the_guard_at_step_0_lets_begin(dem):
    """Six contacts a disc: spins of a triangular lattice swing with W^2 = 24 k_t/m, one disc at a wall with 3 k_t/m."""
    rows, columns, apart = 4, 4, 2 * (1 - DEPTH)
    x = [[apart * (c + 0.5 * (r % 2)), apart * math.sqrt(0.75) * r] for r in range(rows) for c in range(columns)]
    model = dem.model(
        x, spin=np.full((16, 1), 1e-6), mu=10.0, kt=3e3, dt=2e-4,
        periodic=(columns * apart, rows * apart * math.sqrt(0.75)))
    ends = int(1.9 * MOST_GROWTH / (3 * 3e3 * model.dt**2))
    refuse_late_springs(model, ends)
    expected = math.ceil(MOST_GROWTH / exponent_of_step(model, math.sqrt(24 * 3e3)) / 10) * 10
    assert expected < ends / 5
    assert stopped(ProgramSimulation(model), every=10, looks=ends // 10) == pytest.approx(expected, abs=10)


@pytest.mark.parametrize("mutant", ["half the rate", "stiffness at the touch", "every contact slides"])
def test_wrong_guards_would_be_noticed(press, monkeypatch, mutant):
    model, swing, _ = press(0.08)
    if mutant == "half the rate":
        largest = LargestEigenvalue.of
        monkeypatch.setattr(LargestEigenvalue, "of", lambda self, f, n: 0.5 * largest(self, f, n))
    elif mutant == "stiffness at the touch":
        monkeypatch.setattr(MindlinSliding, "spring", lambda self, c: (0 * c.overlap, 0 * c.overlap))
    else:
        monkeypatch.setattr(small_motions, "_sticks", lambda k, forces, family: np.zeros(len(forces.f_n), bool))
    expected = math.ceil(MOST_GROWTH / exponent_of_step(model, swing) / 10) * 10
    assert stopped(ProgramSimulation(model), every=10, looks=expected // 10 + 3) is None


def test_a_dashpot_that_holds_lets_it_pass(press, kernel):
    model, _, held = press(0.05, restitution=0.95)
    assert model.dt < held
    assert stopped(kernel(model), every=50, looks=40) is None


@pytest.mark.parametrize("grows", [True, False])
def test_at_its_end_a_run_warns_only_of_what_grows(dem, grows):
    limit = by_theory(dem, between(dem, 1.0)).largest_step()
    model = between(dem, (1.05 if grows else 0.97) * limit)
    rate = math.log(by_theory(dem, model).late_growth(model.dt))
    steps = int(0.5 / rate)
    simulation, watch = ProgramSimulation(model), LateSprings(model, steps)
    while watch.next_look is not None:
        simulation.advance(watch.next_look - simulation.state.step)
        watch.look(simulation)
    assert (watch.warning() is not None) == grows


def test_what_ended_is_not_forgotten(dem):
    """A sphere that is let go after it has swung: the warning names what it had grown by."""
    model, _ = turning(dem, "torsion", 3, [0, 0, 1])
    simulation, watch = dem.Simulation(model), LateSprings(model, 1000)
    for _ in range(5):
        watch.look(simulation)
        simulation.advance(10)
    grown = watch.exponent.max()
    simulation.state.x[2, 0] += 3 * DEPTH
    simulation.state.x[2, 2] += 3.0
    simulation.advance(10)
    watch.look(simulation)
    assert watch.exponent.max() == 0.0
    assert f"exp({grown:.3g})" in watch.warning()


def test_what_slides_does_not_swing(press, kernel):
    """It spins so fast that friction does not stop it in this time: a swing of 4e-3 of its spin."""
    model, swing, _ = press(0.08, friction=0.3, spin=5.0)
    grown = math.ceil(MOST_GROWTH / exponent_of_step(model, swing))
    simulation = kernel(model)
    assert stopped(simulation, every=10, looks=grown // 5) is None
    assert simulation.state.spin[0, 0] > 0


@pytest.mark.parametrize("every", [2, 7])
def test_collisions_do_not_add_up(dem, every):
    """Elastic Mindlin discs in a box, 50 steps a contact: every contact swings for less than half a period."""
    model = dem.cluster(
        3, 2, across=3, speed=0.3, squeeze=1.3, walls=dem.box(9.0, 2),
        normal=dem.table("normal", "hertz", restitution=1.0),
        sliding=dem.table("sliding", "mindlin", shear_friction=0.4), dt=4e-4,
    )
    assert stopped(ProgramSimulation(model), every=every, looks=3000 // every) is None


def between(dem, dt, side=2e-4):
    """A disc deep in a rough floor, between smooth side walls whose dashpots take from its swing."""
    walls = [dem.wall("floor", (0, 0), (0, 1), friction=True), dem.wall("top", (0, 2 - 2 * DEPTH), (0, -1)),
             dem.wall("left", (0, 0), (1, 0)), dem.wall("right", (2 - 2 * side, 0), (-1, 0))]
    return dem.model(
        [[1 - side, 1 - DEPTH]], spin=[[1e-6]], v=[[1e-6, 0.0]], walls=walls, dt=dt,
        normal=dem.table("normal", "hertz", restitution=0.8),
        sliding=dem.table("sliding", "mindlin", shear_friction=10.0),
    )


def by_theory(dem, model):
    """Its springs and dashpots, as closed forms have them; all that turn are felt late."""
    touching = [(k, k.last.contact) for k in dem.Simulation(model).interactions if len(k.last.contact.i)]
    n = np.concatenate([c.n.T for _, c in touching])
    i, j = (np.concatenate([getattr(c, name) for _, c in touching]) for name in "ij")
    arms = [np.concatenate([_or_nothing(c, f"torque_arm_{side}") for _, c in touching]) for side in "ij"]
    linear = getattr(model.normal, "normal_stiffness", None)
    slope = linear if isinstance(linear, float) else np.concatenate([linear(c) for _, c in touching])
    families = {"sliding": "tangential", "rolling": "rolling", "torsion": "torsion"}
    numbers = {word: _numbers(touching, family) for family, word in families.items() if getattr(model, family)}
    springs = {word: stiffness for word, (stiffness, _) in numbers.items()}
    return Packing(
        mass=model.mass, inertia=model.inertia, late=Elements(**springs), drag=model.drag or 0.0,
        springs=Elements(normal=slope, **springs),
        dashpots=Elements(normal=np.concatenate([0 * c.overlap + model.normal.damping(c) for _, c in touching]),
                          **{word: damping for word, (_, damping) in numbers.items()}),
        contacts=Contacts(
            i=i, j=np.where(j < model.particle_count, j, FIXED), normal=n, arm_i=arms[0], arm_j=arms[1],
            reduced=np.concatenate([_or_nothing(c, "reduced_radius") for _, c in touching]),
            distance=np.full(len(i), np.inf)),
    )


def _or_nothing(contact, name):
    return 0 * contact.overlap if getattr(contact, name) is None else getattr(contact, name)


def _numbers(touching, family):
    each = [(0 * c.overlap,) * 2 if getattr(k, family) is None else getattr(k, family).spring(c) for k, c in touching]
    return [np.concatenate([numbers[which] for numbers in each]) for which in (0, 1)]


def late_part(packing, words):
    """The packing of which only some springs are felt late."""
    return replace(packing, late=Elements(**{word: getattr(packing.springs, word) for word in words}))


@pytest.mark.parametrize("exact", [True, False])
def test_a_swing_that_other_dashpots_hold_is_let_pass(dem, monkeypatch, exact):
    """Between the step at which a motion could be fed and the one at which a mode is: by eigenvalues or energies."""
    if not exact:
        monkeypatch.setattr(late_springs, "EXACT", 0)
    limit = by_theory(dem, between(dem, 1.0)).largest_step()
    held, grows = between(dem, 0.97 * limit), between(dem, 1.1 * limit)
    assert by_theory(dem, held).late_growth(held.dt) > 1 + 1e-3
    assert stopped(ProgramSimulation(held), every=20, looks=500) is None
    assert stopped(ProgramSimulation(grows), every=20, looks=500) is not None


@pytest.mark.parametrize("side", [1e-5, 1e-4, 1e-3])
def test_the_growth_of_a_step_is_that_of_the_matrices(dem, side):
    for dt in (0.002, 0.005, 0.01):
        model = between(dem, dt, side)
        found = contacts_of_now(model, dem.Simulation(model).interactions)
        spring = found.springs["sliding"]
        weights = {
            "springs": {"normal": found.slope, "sliding": spring.stiffness},
            "fed": {"normal": -found.along, "sliding": dt * spring.stiffness - spring.damping},
        }
        matrices = {name: Operator(model, found, of).matrix() for name, of in weights.items()}
        assert step_growth(**matrices, dt=dt) == pytest.approx(by_theory(dem, model).growth(dt), abs=1e-6)


# --- its numbers --------------------------------------------------------------------------------


@pytest.mark.parametrize("drag", [None, 0.7])
@pytest.mark.parametrize(("dim", "families"), [
    (2, ()), (2, ("rolling",)), (3, ()), (3, ("rolling",)), (3, ("torsion",)), (3, ("rolling", "torsion")),
])
def test_the_eigenvalue_is_that_of_the_matrices(dem, dim, families, drag):
    """The kernel's operator, contact by contact, against the sums of `packing_modes`."""
    model = dem.cluster(
        5, dim, squeeze=0.97, walls=dem.box(6.0, dim, friction=("x0", "y0")), drag=drag, dt=0.002,
        normal=dem.table("normal", "hertz", restitution=0.9),
        sliding=dem.table("sliding", "mindlin", shear_friction=1e3), **rolled(dem, *families),
    )
    simulation = dem.Simulation(model)
    packing, watch = by_theory(dem, model), LateSprings(model, 10**6)
    watch.look(simulation)
    simulation.state.step += 1
    watch.look(simulation)
    assert packing.late_growth(model.dt) > 1.001
    assert watch.exponent.max() == pytest.approx(math.log(packing.late_growth(model.dt)), rel=1e-3)


@pytest.mark.parametrize("word", ["viscous", "spring"])
def test_dashpots_that_are_not_late_take_from_the_swing(dem, word):
    """A disc that rolls between plates on late springs: sliding on dashpots alone, or on springs that they hold."""
    numbers = {"shear_damping": 0.2, "shear_friction": 1e3} | ({"shear_stiffness": 1.0} if word == "spring" else {})
    model = dem.model(
        [[0.0, 1 - DEPTH]], spin=[[1e-6]], walls=plates(dem), dt=0.01, normal=dem.table("normal", "linear"),
        sliding=dem.table("sliding", word, **numbers), **rolled(dem, "rolling", stiffness=50.0))
    packing, watch, simulation = by_theory(dem, model), LateSprings(model, 10**6), dem.Simulation(model)
    without = late_part(packing, ("rolling",))
    assert set(watch._stuck) == {"rolling"}
    for _ in range(2):
        watch.look(simulation)
        simulation.state.step += 1
    expected = math.log(without.late_growth(model.dt))
    assert 0 < expected < 0.7 * math.log(replace(without, dashpots=Elements()).late_growth(model.dt))
    assert watch.exponent.max() == pytest.approx(expected, rel=1e-6)


def test_the_power_is_that_of_the_operator(dem):
    laws = {"normal": dem.table("normal", "hertz"), "sliding": dem.table("sliding", "mindlin")}
    turning = {family: dem.table(family, "spring") for family in ("rolling", "torsion")}
    model = dem.cluster(7, 3, squeeze=0.97, **laws, **turning)
    found = contacts_of_now(model, dem.Simulation(model).interactions)
    families = ("normal", "sliding", "rolling", "torsion")
    weights = dict(zip(families, np.random.default_rng(1).normal(size=(4, len(found.i))), strict=True))
    fed = Operator(model, found, weights, drag=0.3)
    moved = np.concatenate([model.v, model.spin])
    x = (moved * fed._root).ravel()
    assert fed.power(model.v, model.spin) == pytest.approx(x @ fed(x), rel=1e-11)
    assert fed.matrix() @ x == pytest.approx(fed(x), rel=1e-9, abs=1e-9)
    assert np.allclose(fed.matrix(), fed.matrix().T, rtol=1e-12, atol=1e-12)
    assert len(found.i) > 20


@pytest.mark.parametrize("size", [1, 2, 5, 40, 200])
def test_largest_eigenvalues(size):
    a = np.random.default_rng(size).normal(size=(size, size))
    a = a + a.T - 3 * np.eye(size)
    exact = max(float(np.linalg.eigvalsh(a)[-1]), 0.0)
    found = LargestEigenvalue().of(lambda x: a @ x, size)
    assert found <= exact * (1 + 1e-9)
    assert found == pytest.approx(exact, rel=2e-3)


def test_the_largest_eigenvalue_is_not_below_zero():
    for size in (7, 200):
        assert LargestEigenvalue().of(lambda x: -x, size) == pytest.approx(0.0, abs=1e-12)
        assert LargestEigenvalue().of(lambda x: 0 * x, size) == 0.0


@pytest.mark.parametrize("top", [1e-1, 1e-3])
def test_a_small_largest_eigenvalue_is_found_beside_large_negative_ones(top):
    """Few motions are fed, most are damped hard, many not at all."""
    values = -np.linspace(0.0, 1.0, 500)
    values[0], values[1:100] = top, 0.0
    assert LargestEigenvalue().of(lambda x: values * x, 500) == pytest.approx(top, rel=1e-3)


def blocks(*tops, size=40):
    """Blocks that know nothing of each other, each with its largest eigenvalue."""
    rng, whole = np.random.default_rng(3), np.zeros((size * len(tops),) * 2)
    for k, top in enumerate(tops):
        a = rng.normal(size=(size, size))
        a = -a @ a.T
        part = slice(k * size, (k + 1) * size)
        whole[part, part] = a + (top - np.linalg.eigvalsh(a)[-1]) * np.eye(size)
    return whole


def test_the_next_search_is_not_caught_where_the_last_one_ended():
    """The vector of the largest of the first operator is one of the second, whose largest is elsewhere."""
    largest, first, second = LargestEigenvalue(), blocks(1.0, 0.5, 0.3, 0.2), blocks(1.0, 1.7, 0.3, 0.2)
    assert largest.of(lambda x: first @ x, len(first)) == pytest.approx(1.0, rel=1e-2)
    assert largest.of(lambda x: second @ x, len(second)) == pytest.approx(1.7, rel=1e-2)


def test_a_search_that_begins_from_the_last_is_shorter():
    largest, a, used = LargestEigenvalue(), blocks(1.0, 0.9, 0.8, 0.7), []

    def counted(x):
        used.append(1)
        return a @ x

    found = []
    for _ in range(2):
        used.clear()
        found.append((largest.of(counted, len(a)), len(used)))
    assert found[1][0] == pytest.approx(1.0, rel=1e-2)
    assert found[1][1] < found[0][1] / 2


# --- runs ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("convention", ["lammps", "liggghts", "corrected"])
def test_others_are_not_watched(press, convention):
    assert not late_families(press(0.08, convention=NAMED[convention])[0])


def test_only_late_springs_that_may_not_be_held_are_watched(dem):
    turning = {family: dem.table(family, "spring") for family in ("rolling", "torsion")}
    assert late_families(dem.model([[0.0] * 3], dt=1e-2, **turning)) == ("rolling", "torsion")
    assert late_families(dem.model([[0.0] * 3], dt=1e-3, **turning)) == ()
    assert late_families(dem.model([[0.0] * 2], dt=1e-2, rolling=dem.table("rolling", "constant"))) == ()
    assert late_families(dem.model([[0.0, 0.0]], mu=0.5, kt=1e3, gt=0.99, dt=1e-3))
    assert not late_families(dem.model([[0.0, 0.0]], mu=0.5, kt=1e3, gt=1.01, dt=1e-3))
    assert not late_families(dem.model([[0.0, 0.0]], sliding=dem.table("sliding", "viscous")))
    assert not late_families(dem.model([[0.0, 0.0]]))


@pytest.mark.parametrize(("steps", "every"), [(99, 1), (250, 2), (10**4, 100), (10**5, 1000), (10**7, 1000)])
def test_looks_are_a_hundred_at_least_and_a_thousand_steps_apart_at_most(press, steps, every):
    simulation = ProgramSimulation(press(0.01, restitution=0.5)[0])
    watch = LateSprings(simulation.model, steps)
    assert watch.next_look == 0
    for _ in range(3):
        simulation.advance(watch.next_look - simulation.state.step)
        watch.look(simulation)
    assert watch.next_look == 3 * every
    watch._step = steps - 1
    assert watch.next_look == steps
    watch._step = steps
    assert watch.next_look is None


@pytest.fixture
def deck(tmp_path):
    """deck(name, steps, restitution): the folder of a disc between two plates, with one sample at each end."""

    def write(name, steps, restitution):
        wall = {"friction": True, "motion": {"kind": "fixed"}}
        content = {
            "title": "late", "dimension": 2, "convention": "talk", "dt": 1e-3, "rotations": True,
            "plan": {"steps": steps, "sample_every": steps, "frame_every": steps, "contacts": True},
            "normal": {"law": "hertz", "youngs_modulus": 3e4, "poisson_ratio": 0.3, "restitution": restitution,
                       "attraction": "allowed"},
            "sliding": {"law": "mindlin", "shear_friction": 10.0},
            "walls": [{"name": "floor", "point": [0.0, 0.0], "normal": [0.0, 1.0], **wall},
                      {"name": "top", "point": [0.0, 1.998], "normal": [0.0, -1.0], **wall}],
        }
        folder = tmp_path / name
        folder.mkdir()
        (folder / "kernel.json").write_text(json.dumps(content))
        (folder / "particles.csv").write_text(
            "id,x,y,radius,mass,inertia,vx,vy,wz\n1,0.0,0.999,1.0,1.0,0.5,0,0,1e-6\n")
        return folder

    return write


def test_without_contacts_there_is_nothing_to_watch(dem):
    laws = {"normal": dem.table("normal", "hertz", restitution=1.0), "sliding": dem.table("sliding", "mindlin")}
    simulation = dem.Simulation(dem.model([[0.0, 0.0], [9.0, 0.0]], **laws))
    watch = LateSprings(simulation.model, 10)
    watch.look(simulation)
    simulation.advance(3)
    watch.look(simulation)
    assert not watch.exponent.any()


def test_a_run_ends_with_the_reason(deck):
    folder = deck("late", 20000, 1.0)
    done = subprocess.run([sys.executable, "-m", "reference.kernel", str(folder)], capture_output=True, text=True)
    assert done.returncode == command.UNSTABLE
    (line,) = done.stdout.strip().splitlines()
    assert "the talks' algorithm feels the sliding spring one step late" in line
    assert "smaller step" in line
    assert int(line.split("step ")[1].split(":")[0]) < 2000


@pytest.mark.parametrize(("steps", "says"), [(10, False), (100, True)])
def test_a_run_that_was_not_stopped_says_what_it_made(deck, capsys, steps, says):
    """The deck without dashpots: exp(0.05) after some ten steps."""
    assert command.main(deck("late", steps, 1.0)) == 0
    report = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert ("warning" in report) == says
    if says:
        most = float(report["warning"].split("exp(")[1].split(")")[0])
        assert WORTH_SAYING < most < MOST_GROWTH


def test_what_the_watch_keeps_is_all_that_it_needs(dem):
    model, _ = turning(dem, "torsion", 3, [0, 0, 1])
    simulation, watch, other = ProgramSimulation(model), LateSprings(model, 10**6), LateSprings(model, 10**6)
    for _ in range(5):
        watch.look(simulation)
        simulation.advance(10)
    other.take(watch.kept())
    for each in (watch, other):
        each.look(simulation)
    assert watch.exponent.max() == other.exponent.max() > WORTH_SAYING
    assert all(np.array_equal(watch.kept()[name], kept) for name, kept in other.kept().items())


def test_looking_does_not_change_a_run(deck, monkeypatch):
    import h5py

    watched, alone = (deck(name, 3000, 0.8) for name in ("watched", "alone"))
    assert command.main(watched) == 0
    monkeypatch.setattr(watches, "WATCHES", ())
    assert command.main(alone) == 0
    assert (watched / "series.csv").read_text() == (alone / "series.csv").read_text()
    with h5py.File(watched / "frames.h5") as a, h5py.File(alone / "frames.h5") as b:
        names = []
        a.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        assert names
        assert all(np.array_equal(a[name], b[name]) for name in names)


def test_a_run_that_was_killed_counts_on(deck, monkeypatch):
    """A checkpoint after every write; the run is broken off, and stops at the step at which it would have."""
    monkeypatch.setattr(command, "EVERY", 0.0)
    whole, broken = deck("whole", 20000, 1.0), deck("broken", 20000, 1.0)
    stops = []

    class Watch(LateSprings):
        def look(self, simulation):
            if simulation.state.step == self.breaks_at:
                raise KeyboardInterrupt
            try:
                super().look(simulation)
            except KernelUnstable:
                stops.append((simulation.state.step, self.exponent.max()))
                raise

    monkeypatch.setattr(watches, "WATCHES", ((late_families, Watch),))
    for folder, breaks_at in ((whole, None), (broken, 400), (broken, None)):
        Watch.breaks_at = breaks_at
        if breaks_at:
            with pytest.raises(KeyboardInterrupt):
                command.main(folder)
        else:
            assert command.main(folder) == command.UNSTABLE
    assert stops[0] == stops[1]
    assert stops[0][0] > 400
