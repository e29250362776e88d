"""Every law of the textbook as operations: the same numbers to round-off in every combination, and none too many."""

import dataclasses
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reference.kernel.conventions import CONVENTIONS, LAMMPS, LIGGGHTS, NAMED, TALK
from reference.kernel.corrected import simulate
from reference.kernel.laws.registry import LAWS
from reference.kernel.laws.slider import LAMMPS_TURN_THRESHOLD
from reference.kernel.output import contact_table
from reference.kernel.program.compose import can_compose
from reference.kernel.program.simulation import ProgramSimulation, fastest
from reference.kernel.program.slider import LAGGING

MIXED = dataclasses.replace(TALK, name="mixed", torque_arm="radius", wall_slip_arm="radius", wall_torque_arm="reduced",
                            rolling="liggghts", limit="absolute", sliding="lammps", wall_spin="raised")
GRASPING = dataclasses.replace(TALK, name="grasping", limit="absolute", constant_rolling="liggghts")
LEAPFROG = [name for name, convention in CONVENTIONS.items() if convention.scheme == "leapfrog"]
DRAWN = [LAMMPS, LIGGGHTS, TALK, MIXED, GRASPING]

VARIANTS = {
    ("normal", "linear"): {"normal_damping": [0.0, 12.0], "attraction": ["allowed", "clipped"]},
    ("normal", "hertz"): {"restitution": [1.0, 0.8], "attraction": ["allowed", "clipped"]},
    ("normal", "hysteretic"): {
        "normal_damping": [0.0, 5.0], "adhesion_stiffness": [0.0, 2e3], "loading_stiffness": [4e3, 1e4]},
    ("normal", "hysteretic_variable"): {
        "normal_damping": [0.0, 5.0], "adhesion_stiffness": [0.0, 2e3], "plasticity_depth": [0.005, 0.05]},
    ("normal", "dmt"): {"normal_damping": [0.0, 5.0]},
    ("sliding", "spring"): {
        "shear_friction": [0.4, 1.5, 1e4], "shear_damping": [0.0, 5.0], "dynamic_friction": [None, 0.25]},
    ("rolling", "spring"): {"rolling_damping": [0.0, 3.0], "rolling_friction": [0.1, 50.0]},
    ("torsion", "spring"): {"torsion_damping": [0.0, 3.0]},
}
"""What is drawn of the parameters of a law; of one that is not named here, the table of `dem`."""


def drawn_table(dem, draw, family, words) -> dict | None:
    """The table of a law of the family, None for one of the `words`."""
    word = draw(st.sampled_from(words))
    if word is None:
        return None
    choices = VARIANTS.get((family, word), {})
    return dem.table(family, word, **{name: draw(st.sampled_from(values)) for name, values in choices.items()})


def drawn_model(dem, draw):
    """A moving cluster with any laws, convention, walls, gravity, drag and periodic axes."""
    dim = draw(st.sampled_from([2, 3]))
    tables = {"normal": drawn_table(dem, draw, "normal", list(LAWS["normal"]))}
    for family in ("sliding", "rolling", "torsion"):
        words = [None, *LAWS[family]] if (family, dim) != ("torsion", 2) else [None]
        if tables["normal"]["law"] != "hertz":
            words = [word for word in words if word != "mindlin"]
        tables[family] = drawn_table(dem, draw, family, words)
    options = {
        "convention": draw(st.sampled_from(DRAWN)), "drag": draw(st.sampled_from([None, 0.4])),
        "gravity": draw(st.sampled_from([None, (1.0, -9.0, 2.0)[:dim]])),
        "rotations": dim == 2 and draw(st.booleans()),
        "squeeze": draw(st.sampled_from([0.9, 0.98])),
    }
    walls = rough_corner(dem, dim) if draw(st.booleans()) else ()
    if not walls and draw(st.booleans()):
        options["periodic"] = (9.0, 0.0, 8.5)[:dim]
    return dem.cluster(draw(st.integers(0, 50)), dim, across=6 - dim, walls=walls, **tables, **options)


def rough_corner(dem, dim) -> list:
    rest = (0.0,) * (dim - 2)
    return [dem.wall("floor", (0.0, -0.3, *rest), (0.1, 1.0, *rest), friction=True),
            dem.wall("left", (-0.3, 0.0, *rest), (1.0, 0.0, *rest))]


def relative_difference(expected, got) -> float:
    """Largest difference in units of the largest of the expected numbers, or of 1 if that is more."""
    return float(np.abs(expected - got).max(initial=0.0) / max(np.abs(expected).max(initial=0.0), 1.0))


def round_off_of_textbook(dem, m, textbook, name) -> float:
    """How far the textbook is from itself in extended precision, or begun a rounding away, after as many steps.

    The larger: one number alone is as much a matter of chance as the difference that it is held against.
    """
    nudged = (dataclasses.replace(m, x=np.nextafter(m.x, side)) for side in (np.inf, -np.inf))
    others = [dem.Simulation(other) for other in (m.in_long_double(), *nudged)]
    for other in others:
        other.advance(textbook.state.step)
    return max(relative_difference(getattr(o.state, name), getattr(textbook.state, name)) for o in others)


def part_along_normals(m) -> float:
    """The most that a spring of LAMMPS pulls along the normal, over the base of its limit, if the program drops it.

    That is in 2D, up to the coefficient LAGGING; see there. Beyond, and in 3D, the program has it too.
    """
    coefficients = [getattr(m.sliding, "shear_friction", 0.0), getattr(m.rolling, "rolling_friction", 0.0)]
    dropped = [mu for mu in coefficients if m.dimension == 2 and mu <= LAGGING]
    return LAMMPS_TURN_THRESHOLD * max(dropped, default=0.0) if m.convention.sliding == "lammps" else 0.0


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_every_combination_is_the_textbooks(dem, data):
    """Positions, velocities, spins, forces and torques after 150 steps; see below for constant rolling resistance.

    Where a cluster amplifies round-off beyond 1e-11, the textbook itself tells by how much.
    """
    m = drawn_model(dem, data.draw)
    assert can_compose(m)
    textbook, program = dem.Simulation(m), ProgramSimulation(m)
    textbook.advance(150)
    program.advance(150)
    chatters = type(m.rolling).__name__ == "ConstantRolling"
    names = ["x", "v", "spin", "force", "wall_force", *(["torque"] if m.turns and not chatters else []),
             *(["turned"] if m.rotations else [])]
    for name in names:
        difference = relative_difference(getattr(textbook.state, name), getattr(program.state, name))
        if difference >= (1e-8 if chatters else 1e-11) + part_along_normals(m):
            assert difference < round_off_of_textbook(dem, m, textbook, name), name


@pytest.mark.parametrize("normal", ["linear", "hysteretic", "dmt"])
@pytest.mark.parametrize("convention", DRAWN, ids=lambda c: c.name)
@pytest.mark.parametrize("dim", [2, 3])
def test_constant_rolling_resistance_is_the_textbooks(dem, dim, convention, normal):
    """While bodies roll past each other: later it turns with a relative rotation that it keeps close to 0."""
    m = dem.cluster(7, dim, squeeze=0.93, speed=5.0, walls=rough_corner(dem, dim), convention=convention,
                    normal=dem.table("normal", normal), rolling=dem.table("rolling", "constant"))
    textbook, program = dem.Simulation(m), ProgramSimulation(m)
    textbook.advance(5)
    program.advance(5)
    assert np.abs(textbook.state.torque).max() > 1.0
    assert relative_difference(textbook.state.torque, program.state.torque) < 1e-12


@pytest.mark.parametrize("mu_d", [None, 0.2])
@pytest.mark.parametrize(("normal", "changes"), [
    ("linear", {"attraction": "clipped"}), ("linear", {}), ("hysteretic", {"normal_damping": 0.0}),
])
@pytest.mark.parametrize("dim", [2, 3])
def test_limits_that_vanish_for_a_while_decide_the_same(dem, dim, normal, changes, mu_d):
    """Springs of the talk slide at a limit of 0; were it their test force that decides, round-off would."""
    tables = {"normal": dem.table("normal", normal, **changes), "rolling": dem.table("rolling", "spring"),
              "sliding": dem.table("sliding", "spring", dynamic_friction=mu_d)}
    if dim == 3:
        tables["torsion"] = dem.table("torsion", "spring")
    for seed in range(2):
        m = dem.cluster(seed, dim, across=6 - dim, squeeze=0.95, convention="talk", **tables)
        textbook, program = advanced_by_both(dem, m, 150)
        for name in ("x", "v", "spin", "force", "torque"):
            assert relative_difference(getattr(textbook.state, name), getattr(program.state, name)) < 1e-11, name


def advanced_by_both(dem, m, steps):
    textbook, program = simulate(m), ProgramSimulation(m)
    textbook.advance(steps)
    program.advance(steps)
    return textbook, program


@pytest.mark.parametrize("convention", ["lammps", "corrected"])
@pytest.mark.parametrize("mu", [1.01 * LAGGING, 1e3, 1e4, 1e8])
@pytest.mark.parametrize("dim", [2, 3])
def test_springs_of_rough_bodies_lag_as_the_textbooks(dem, dim, mu, convention):
    """LAMMPS turns them beyond 1e-10 of a limit that is that much larger: by hundreds of steps too late at 1e8."""
    for seed in range(3):
        m = dem.cluster(seed, dim, across=6 - dim, squeeze=0.96, walls=rough_corner(dem, dim), mu=mu, gn=5.0, gt=2.0,
                        rolling=dem.table("rolling", "spring", rolling_friction=mu) if convention == "lammps" else None,
                        convention=NAMED[convention])
        textbook, program = advanced_by_both(dem, m, 150)
        assert isinstance(fastest(m), ProgramSimulation)
        for name in ("x", "v", "spin", "force", "torque"):
            assert relative_difference(getattr(textbook.state, name), getattr(program.state, name)) < 3e-11, name
        expected, got = memory_by_pair(textbook), memory_by_pair(program)
        assert expected.keys() == got.keys()
        for key, column in expected.items():
            np.testing.assert_allclose(got[key], column, atol=1e-12, err_msg=str(key))


@pytest.mark.parametrize("part", [0.5, 0.99])
def test_what_a_smooth_spring_pulls_along_the_normal_is_dropped_and_no_more(dem, part):
    """A pair with a sheared spring turns by just less than LAMMPS takes note of: the force differs by that part."""
    mu, spring, m = LAGGING, 1e-3, None
    kt = dem.table("sliding", "spring")["shear_stiffness"]
    f_n = dem.KN * 0.1
    turn = part * LAMMPS_TURN_THRESHOLD * mu * f_n / (kt * spring)
    dt = dem.tc / 50
    m = dem.model([[0.0, 0.0], [1.9, 0.0]], v=[[0.0, 0.0], [0.0, 1.9 * turn / dt]], convention="lammps", mu=mu, dt=dt)
    textbook, program = dem.Simulation(m), ProgramSimulation(m)
    for simulation in (textbook, program):
        shear_springs(simulation, spring)
        simulation.advance(1)
    difference = np.abs(textbook.state.force - program.state.force).max()
    assert difference == pytest.approx(part * LAMMPS_TURN_THRESHOLD * mu * f_n, rel=0.05)


def shear_springs(simulation, spring) -> None:
    """Stretch the spring of the one contact, whose normal is along x, by a length along y."""
    if isinstance(simulation, ProgramSimulation):
        simulation.history["sliding"][:] = -simulation.model.sliding.shear_stiffness * spring
    else:
        simulation.interactions[0].pairs.memory["sliding"][1] = spring


def test_bits_do_not_depend_on_the_skin_where_springs_lag(dem):
    m = dem.cluster(5, 2, squeeze=0.98, mu=1e3, gn=5.0, gt=2.0, convention="lammps")
    made = []
    for skin in (0.03, 0.6):
        simulation = ProgramSimulation(m, skin=skin)
        simulation.advance(200)
        made.append((dem.bytes(simulation), simulation.rebuilds))
    assert made[0][0] == made[1][0]
    assert made[0][1] > made[1][1]


def test_springs_that_cannot_lag_cost_nothing(dem):
    """A coefficient up to LAGGING has the operations of any other; so has a larger one where nothing lags."""
    def count(mu, convention):
        return len(ProgramSimulation(dem.cluster(2, 2, squeeze=0.95, mu=mu, convention=convention)).operations)

    assert count(LAGGING, "lammps") == count(0.1, "lammps") < count(1e3, "lammps")
    for convention in ("talk", "liggghts"):
        assert count(1e3, convention) == count(0.1, convention)


REGISTERED = [(family, word) for family, words in LAWS.items() for word in words]
FULL = {
    2: {"normal": ("normal", "hysteretic"), "sliding": ("sliding", "spring"), "rolling": ("rolling", "spring")},
    3: {"normal": ("normal", "hysteretic_variable"), "sliding": ("sliding", "spring"), "rolling": ("rolling", "spring"),
        "torsion": ("torsion", "spring")},
}
"""All families at once, all with history."""


def full_contact(dem, dim, **sliding) -> dict:
    tables = {family: dem.table(*law) for family, law in FULL[dim].items()}
    return tables | {"sliding": tables["sliding"] | sliding}


@pytest.mark.parametrize("convention", LEAPFROG)
@pytest.mark.parametrize(("family", "word"), REGISTERED)
def test_every_registered_law_has_operations(dem, family, word, convention):
    for dim in (2, 3):
        if (family, dim) != ("torsion", 2):
            assert can_compose(dem.cluster(1, dim, convention=convention, **dem.contact_with(family, word)))


def test_the_second_order_scheme_has_operations_where_the_elastic_force_is_the_overlaps(dem):
    second = NAMED["corrected"]
    assert can_compose(dem.cluster(1, 2, mu=0.5, convention=second))
    assert not can_compose(dem.cluster(1, 2, convention=second, **dem.contact_with("normal", "hysteretic")))
    assert not can_compose(dem.cluster(1, 2, convention=second, **dem.contact_with("rolling", "spring")))


@pytest.mark.parametrize("changes", [{"shear_stiffness": 0.0}, {"algorithm": "lammps_twisting"}, {"law": None}])
def test_what_has_no_operations_runs_by_the_textbook(dem, changes):
    """A spring without stiffness, sliding by a rule for one component, a law of another kind."""
    m = dem.cluster(1, 2, mu=0.5)
    law = object() if "law" in changes else dataclasses.replace(m.sliding, **changes)
    assert not can_compose(dataclasses.replace(m, sliding=law))
    if "shear_stiffness" in changes:
        with np.errstate(all="ignore"):
            assert isinstance(fastest(dataclasses.replace(m, sliding=law)), dem.Simulation)


# --- memories --------------------------------------------------------------------------------------------


def memory_by_pair(simulation) -> dict:
    return {(family, i, j): column for k in simulation.interactions for family, kept in k.pairs.memory.items()
            for i, j, column in zip(k.pairs.i, k.pairs.j, kept.T, strict=True) if column.any()}


@pytest.mark.parametrize("mu_d", [None, 0.2])
@pytest.mark.parametrize("convention", [LAMMPS, LIGGGHTS, GRASPING], ids=lambda c: c.name)
@pytest.mark.parametrize("dim", [2, 3])
def test_all_memories_are_handed_over(dem, dim, convention, mu_d):
    m = dem.cluster(6, dim, squeeze=0.93, walls=rough_corner(dem, dim), convention=convention,
                    **full_contact(dem, dim, dynamic_friction=mu_d))
    textbook, program = dem.Simulation(m), ProgramSimulation(m)
    textbook.advance(60)
    program.advance(60)
    expected, got = memory_by_pair(textbook), memory_by_pair(program)
    assert expected.keys() == got.keys()
    assert {family for family, *_ in expected} == set(FULL[dim])
    for key, column in expected.items():
        np.testing.assert_allclose(got[key], column, atol=1e-13, err_msg=str(key))
    for of_textbook, of_program in zip(textbook.interactions, program.interactions, strict=True):
        for name in ("force", "f_n", "couple"):
            acted = getattr(of_textbook.last, name)
            if acted is not None:
                np.testing.assert_allclose(getattr(of_program.last, name), acted, atol=1e-9, err_msg=name)
    for name, column in contact_table(textbook).items():
        np.testing.assert_allclose(contact_table(program)[name], column, atol=1e-10 * max(np.abs(column).max(), 1.0))


def test_the_first_step_knows_the_set_up(dem):
    """Partners that begin to separate at once: the largest overlap is that of the set-up."""
    m = dem.model([[0.0, 0.0], [1.9, 0.0]], v=[[-1.0, 0.0], [1.0, 0.0]], normal=dem.table("normal", "hysteretic"))
    textbook, program = dem.Simulation(m), ProgramSimulation(m)
    textbook.advance(1)
    program.advance(1)
    assert relative_difference(textbook.state.force, program.state.force) < 1e-13
    assert memory_by_pair(program)["normal", 0, 1] == pytest.approx(0.1)


@pytest.mark.parametrize("convention", LEAPFROG)
@pytest.mark.parametrize("dim", [2, 3])
def test_bits_do_not_depend_on_the_skin(dem, dim, convention):
    """History is carried through every renewal of the list."""
    m = dem.cluster(5, dim, squeeze=0.98, walls=rough_corner(dem, dim), convention=convention,
                    **full_contact(dem, dim, dynamic_friction=0.3))
    made = []
    for skin in (0.03, 0.6):
        simulation = ProgramSimulation(m, skin=skin)
        simulation.advance(200)
        made.append((dem.bytes(simulation), simulation.rebuilds))
    assert made[0][0] == made[1][0]
    assert made[0][1] > made[1][1]


def test_angles_are_followed_without_friction(dem):
    m = dem.model([[0.0, 0.0], [1.9, 0.0]], spin=[[2.0], [-1.0]], rotations=True)
    textbook, program = dem.Simulation(m), ProgramSimulation(m)
    textbook.advance(20)
    program.advance(20)
    np.testing.assert_allclose(program.state.turned, textbook.state.turned, rtol=1e-13)


# --- no operation too many -------------------------------------------------------------------------------


def operations(dem, dim=2, **options) -> Counter:
    return Counter(ProgramSimulation(dem.cluster(2, dim, squeeze=0.95, **options)).operations)


def added(more: Counter, less: Counter) -> set[str]:
    """The effects of the operations that came in addition; all others must be there still."""
    assert not less - more
    return {name.split(":")[0] for name in more - less}


@pytest.mark.parametrize("dim", [2, 3])
def test_a_law_adds_its_own_operations_only(dem, dim):
    tables = {"normal": dem.table("normal", "linear"), "sliding": dem.table("sliding", "spring")}
    friction = {"convention": "liggghts", **tables}
    plain = operations(dem, dim, **friction)
    rolling = operations(dem, dim, rolling=dem.table("rolling", "spring"), **friction)
    assert added(rolling, plain) == {"rolling resistance", "relative rotation", "couples"}
    if dim == 3:
        torsion = operations(dem, dim, torsion=dem.table("torsion", "spring"), **friction)
        assert added(torsion, plain) == {"torsion resistance", "relative rotation", "couples"}
        both = operations(dem, dim, **{k: dem.table(k, "spring") for k in ("rolling", "torsion")}, **friction)
        assert added(both, rolling) == {"torsion resistance"}


@pytest.mark.parametrize("dim", [2, 3])
def test_an_option_adds_its_own_operations_only(dem, dim):
    def of(normal="linear", changes=None, **sliding) -> Counter:
        tables = {"normal": dem.table("normal", normal, **(changes or {}))}
        return operations(dem, dim, sliding=dem.table("sliding", "spring", **sliding), **tables)

    plastic = {"normal_damping": 0.0, "adhesion_stiffness": 0.0}
    assert added(of("hysteretic", plastic | {"adhesion_stiffness": 2e3}), of("hysteretic", plastic)) == {"adhesion"}
    assert added(of("hysteretic", plastic | {"normal_damping": 5.0}), of("hysteretic", plastic)) == {"normal damping"}
    assert added(of("hysteretic", plastic), of(changes={"normal_damping": 0.0})) == {"normal contact"}
    assert added(of("hertz"), of("hertz", {"restitution": 1.0})) == {"normal damping"}
    assert added(of(dynamic_friction=0.3), of(dynamic_friction=0.4)) == set()
    assert of(shear_damping=0.0).total() < of().total()


def test_without_limits_no_base_is_made(dem):
    names = operations(dem, rolling=dem.table("rolling", "constant"))
    assert not [name for name in names if name.startswith("limit")]
    assert [name for name in names if name.startswith("rolling resistance")]
