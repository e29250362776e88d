"""The normal that slip is measured with in 3D, where bodies turn rigidly: the step's end winds springs up."""

import dataclasses

import numpy as np
import pytest

from reference.kernel.conventions import CORRECTED, LAMMPS, LIGGGHTS, NAMED, TALK
from reference.kernel.interactions import Interaction
from reference.kernel.prescribed import driven
from reference.kernel.program.simulation import ProgramSimulation, fastest
from reference.kernel.program.space import rotation
from reference.kernel.vectors import norm

END = dataclasses.replace(TALK, name="end", slip_normal="end")
FRICTION = {"mu": 0.4, "gn": 5.0, "gt": 2.0}
COUPLES = ("rolling", "torsion")


def turn_about_z(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def seen_in_a_turn(dem, convention, *, angle, polar, lag=True, **laws):
    """The contact of two unequal bodies in a leapfrog step of a rigid turn by `angle` about z, and |d| times the rate.

    polar: angle of the branch to the axis. Spins are sin(angle)/dt. With `lag` velocities are those of the half step.
    """
    radius, distance = [1.0, 0.7], 1.67
    branch = distance * np.array([np.sin(polar) * 0.6, np.sin(polar) * 0.8, np.cos(polar)])
    now = np.array([[0.4, 2.0, 0.1], [0.4, 2.0, 0.1] - branch])
    dt = 1e-3
    v = (now - now @ turn_about_z(-angle).T) / dt
    spin = [[0.0, 0.0, np.sin(angle) / dt]] * 2
    m = dem.model(now, v=v, spin=spin, radius=radius, convention=convention, dt=dt, **({"mu": 0.4} | laws))
    s = dem.Simulation(m)
    s.evaluate(advance=True, lag=m.lag if lag else 0.0)
    return s.interactions[0].last.contact, distance * np.sin(angle) / dt


@pytest.mark.parametrize("polar", [0.3, 0.9, 1.3])
def test_the_end_of_the_step_slips_by_half_a_step_of_turning(dem, polar):
    """dt/2 Omega^2 r sin a cos a; in the middle Omega dt/2 cos a of that: one order of dt less."""
    angles, slips = (0.04, 0.02, 0.01), {END: [], TALK: []}
    for convention, found in slips.items():
        for angle in angles:
            contact, speed = seen_in_a_turn(dem, convention, angle=angle, polar=polar)
            found.append(norm(contact.v_t)[0] / speed)
    for angle, end, middle in zip(angles, *slips.values(), strict=True):
        closed = np.sin(polar) * np.cos(polar) * angle / 2
        assert end == pytest.approx(closed, rel=angle)
        assert middle == pytest.approx(closed * angle / 2 * np.cos(polar), rel=2 * angle)
    order = [np.polyfit(np.log(angles), np.log(found), 1)[0] for found in slips.values()]
    assert order == pytest.approx([1.0, 2.0], abs=0.01)


@pytest.mark.parametrize("convention", [END, TALK])
def test_in_the_plane_of_the_turn_and_along_its_axis_both_slip_nowhere(dem, convention):
    for polar in (0.0, np.pi / 2):
        contact, speed = seen_in_a_turn(dem, convention, angle=0.02, polar=polar)
        assert norm(contact.v_t)[0] < 1e-12 * speed


def test_velocities_of_the_moment_go_with_the_normal_of_the_moment(dem):
    """Where nothing lags, as in prescribed motion, at the set-up and for output, both are one to the last bit."""
    one, other = (seen_in_a_turn(dem, c, angle=0.04, polar=0.9, lag=False)[0].v_t for c in (TALK, END))
    assert np.array_equal(one, other)
    m = dem.model([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]], dt=1e-3, **FRICTION)
    rng = np.random.default_rng(2)
    x = np.concatenate([m.x.T[None], rng.normal(size=(40, 2, 3)) * 0.02 + [[0.0, 0.0, 0.0], [1.2, 1.0, 1.0]]])
    path = {"x": x, "v": rng.normal(size=x.shape), "spin": rng.normal(size=x.shape)}
    one, other = (driven(dataclasses.replace(m, convention=c), **path) for c in (TALK, END))
    assert np.array_equal(one[0], other[0])
    assert np.array_equal(one[1], other[1])
    assert one[1].any()


def test_relative_spins_vanish_whatever_the_normal(dem):
    """Rolling and torsion have no such flaw: a rigid turn gives them nothing to measure."""
    laws = {family: dem.table(family, "spring") for family in COUPLES}
    for convention in (END, TALK):
        contact, _ = seen_in_a_turn(dem, convention, angle=0.04, polar=0.9, **laws)
        assert not contact.spin.any()


def test_who_takes_which():
    """What the codes do is not ours to mend; the second-order scheme has velocities of the end."""
    assert {c.name: c.slip_normal for c in NAMED.values()} == {
        "lammps": "end", "liggghts": "end", "talk": "middle", "corrected": "end"}


# --- a body that can hold stress --------------------------------------------------------------------


def octahedron(dem, convention, *, turns: float, couples: bool = False):
    """Six spheres held by adhesion turn about (2, 3, 6)/7; return the model and the number of steps."""
    axes = np.array([[6.0, 2.0, -3.0], [-3.0, 6.0, -2.0], [2.0, 3.0, 6.0]]) / 7.0
    x = 1.984 / np.sqrt(2.0) * np.concatenate([axes, -axes])
    rate = 2.0 * axes[2]
    tables = {family: dem.table(family, "spring") for family in COUPLES if couples}
    m = dem.model(
        x, v=np.cross(rate, x), spin=np.tile(rate, (6, 1)), normal=dem.table("normal", "dmt"), convention=convention,
        sliding=dem.table("sliding", "spring", shear_friction=0.5, shear_damping=20.0), dt=2e-3, **tables)
    return m, round(turns * np.pi / m.dt)


def energy_and_longest_spring(dem, simulation) -> tuple[float, float]:
    """Return the energy, springs of sliding included, and the longest of these."""
    sliding = simulation.model.sliding
    (contacts,) = (f for _, f in simulation.contacts())
    xi = contacts.memory["sliding"]
    return dem.energy(simulation) + sliding.energy(contacts.contact, xi).sum(), norm(xi).max()


def turned(dem, convention, **options):
    """Energy created, in units of that at the start, and the longest spring at the end."""
    m, steps = octahedron(dem, convention, **options)
    s = ProgramSimulation(m)
    energies = []
    for _ in range(20):
        energies.append(energy_and_longest_spring(dem, s)[0])
        s.advance(steps // 20)
    last, spring = energy_and_longest_spring(dem, s)
    moving = (m.mass * m.v**2).sum() / 2.0
    return (max(*energies, last) - energies[0]) / moving, spring


def check_a_turning_body_gains_nothing(dem):
    """Dashpots take what the swing of the start has; nothing else happens in two turns."""
    created, spring = turned(dem, TALK, turns=2)
    assert created <= 1e-12
    assert spring < 5e-4


def test_a_body_that_holds_stress_gains_nothing_by_turning(dem):
    check_a_turning_body_gains_nothing(dem)


def test_with_the_normal_of_the_end_it_does(dem):
    """Springs wind up until they slide: measured 13 % of the energy of motion, springs of 6.7e-3 instead of 3.3e-4."""
    created, spring = turned(dem, END, turns=2)
    assert created > 0.05
    assert spring > 5e-3


def test_springs_are_those_of_the_second_order_scheme(dem):
    """Which measures slip at one moment: of sliding, rolling and torsion, to 2 % after a turn."""
    longest = []
    for convention in (TALK, CORRECTED):
        m, steps = octahedron(dem, convention, turns=1, couples=True)
        s = fastest(m)
        s.advance(steps)
        (contacts,) = (f for _, f in s.contacts())
        longest.append([norm(contacts.memory[family]).max() for family in ("sliding", *COUPLES)])
    assert longest[0] == pytest.approx(longest[1], rel=0.04)


# --- mutants ----------------------------------------------------------------------------------------


def test_a_textbook_that_leaves_the_normal_at_the_end_is_caught(dem, monkeypatch):
    slip = Interaction._slip
    monkeypatch.setattr(Interaction, "_slip", lambda self, *arguments: slip(self, *arguments[:-1], 0.0))
    with pytest.raises(AssertionError):
        test_the_end_of_the_step_slips_by_half_a_step_of_turning(dem, 0.9)


def test_a_program_that_leaves_the_normal_at_the_end_is_caught(dem, monkeypatch):
    monkeypatch.setattr(rotation, "_turn_normals_back", lambda p, c, turning: None)
    with pytest.raises(AssertionError):
        check_a_turning_body_gains_nothing(dem)


@pytest.mark.parametrize("wrong", [-1.0, 2.0])
def test_a_normal_that_is_turned_too_far_or_the_wrong_way_is_caught(dem, monkeypatch, wrong):
    slip = Interaction._slip
    monkeypatch.setattr(
        Interaction, "_slip", lambda self, *arguments: slip(self, *arguments[:-1], wrong * arguments[-1]))
    with pytest.raises(AssertionError):
        test_the_end_of_the_step_slips_by_half_a_step_of_turning(dem, 0.9)


# --- what is off, and what is not ours, stays as it was ----------------------------------------------


def operations(dem, convention, dim, **options) -> list[str]:
    return ProgramSimulation(dem.cluster(2, dim, squeeze=0.95, convention=convention, **options)).operations


def test_only_friction_in_space_has_operations_for_it(dem):
    """Eight, of which the frictionless, rolling alone and the plane have none."""
    assert len(operations(dem, TALK, 3, **FRICTION)) == len(operations(dem, END, 3, **FRICTION)) + 8
    rolling = {"rolling": dem.table("rolling", "spring")}
    for dim, options in ((3, {"gn": 5.0}), (3, rolling), (2, FRICTION)):
        assert operations(dem, TALK, dim, **options) == operations(dem, END, dim, **options)


@pytest.mark.parametrize("kind", ["Simulation", "program"])
def test_the_plane_does_not_know_of_it(dem, kind):
    make, made = (dem.Simulation if kind == "Simulation" else ProgramSimulation), []
    for convention in (TALK, END):
        s = make(dem.cluster(3, 2, squeeze=0.95, walls=dem.box(7.0, 2, friction=("x0",)), convention=convention,
                             **FRICTION))
        s.advance(50)
        made.append(dem.bytes(s))
    assert made[0] == made[1]


@pytest.mark.parametrize("convention", [LAMMPS, LIGGGHTS])
def test_a_code_that_took_the_middle_would_go_elsewhere(dem, convention):
    """The choice acts in every convention: what the codes do is declared, not left to the algorithm."""
    other = dataclasses.replace(convention, name="other", slip_normal="middle")
    made = []
    for c in (convention, other):
        s = ProgramSimulation(dem.cluster(3, 3, squeeze=0.95, convention=c, **FRICTION))
        s.advance(50)
        made.append(s.state.x)
    assert np.abs(made[0] - made[1]).max() > 1e-9


@pytest.mark.parametrize("periodic", [None, (5.7, 5.7, 0.0)])
@pytest.mark.parametrize("walls", [False, True])
def test_textbook_and_program_agree(dem, walls, periodic):
    """The normals of walls stay, those of pairs turn back, across periodic axes too."""
    if walls and periodic:
        pytest.skip("walls stand across open axes")
    given = dem.box(6.3, 3, friction=("x0", "y1")) if walls else ()
    m = dem.cluster(6, 3, squeeze=0.95, speed=2.0, walls=given, periodic=periodic, **FRICTION)
    textbook, program = dem.Simulation(m), ProgramSimulation(m)
    textbook.advance(60)
    program.advance(60)
    for name in ("x", "v", "spin"):
        a, b = getattr(textbook.state, name), getattr(program.state, name)
        assert np.abs(a - b).max() < 1e-10 * np.abs(a).max()
    of_textbook, of_program = (s.interactions[0].last.contact.v_t for s in (textbook, program))
    assert np.abs(of_textbook - of_program).max() < 1e-9 * np.abs(of_textbook).max()
