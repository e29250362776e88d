"""Rings in the program: the textbook's numbers to round-off, and no operation without rings that turn."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reference.kernel.corrected import simulate
from reference.kernel.laws.registry import LAWS
from reference.kernel.model import Loaded
from reference.kernel.output import contact_table, particle_table, ring_loads, wall_table
from reference.kernel.program.compose import can_compose
from reference.kernel.program.simulation import ProgramSimulation, fastest
from reference.kernel.simulation import Simulation

FRICTION = {"mu": 0.4, "gn": 5.0, "gt": 2.0}


def agree(textbook, program, atol, *, full_step_forces=True):
    """All that is written, relative to the scale of its kind.

    full_step_forces: those of contact rows as well. Not where a spring of LIGGGHTS has a dashpot: it acts below the
    limit only, and rounding decides whether a spring that has just been cut to its limit is below.
    """
    for table in (particle_table, wall_table, contact_table):
        expected, got = table(textbook), table(program)
        assert expected.keys() == got.keys()
        for name, values in expected.items():
            if table is contact_table and name in ("fx", "fy") and not full_step_forces:
                continue
            scale = max(np.nanmax(np.abs(values), initial=0.0), 1.0)
            np.testing.assert_allclose(got[name] / scale, values / scale, rtol=0, atol=atol, err_msg=name)


def walls_within(dem):
    """Two walls that cut through the outer ring, where only particles feel them; the rough one has mass."""
    loaded = Loaded(mass=30.0, load=20.0, stress=0.0, span=None, damping=5.0)
    return [dem.wall("left", (-6.9, 0.0), (1.0, 0.1), friction=True, motion=loaded),
            dem.wall("right", (7.5, 0.0), (-1.0, 0.0))]


@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk", "corrected"])
@pytest.mark.parametrize("sliding", [None, "viscous", "spring"])
@pytest.mark.parametrize("rolling", [None, "spring", "constant"])
def test_what_is_written_is_the_textbooks(dem, annulus, named, convention, sliding, rolling):
    tables = {"sliding": sliding, "rolling": rolling}
    tables = {family: dem.table(family, word) for family, word in tables.items() if word is not None}
    m = annulus.between(convention=named[convention], squeeze=1.05, walls=walls_within(dem), **tables)
    if convention == "corrected" and rolling is not None:
        assert not can_compose(m)  # the textbook runs
        return
    textbook, program = simulate(m), ProgramSimulation(m)
    textbook.advance(150)
    program.advance(150)
    agree(textbook, program, 1e-10, full_step_forces=(convention, sliding) != ("liggghts", "spring"))
    partners = contact_table(program)["j"]
    assert {-1.0, -2.0, -3.0, -4.0} <= set(partners)
    assert (partners < -2).sum() > 5


@given(data=st.data())
@settings(max_examples=40, deadline=None)
def test_any_laws_between_any_rings(dem, annulus, named, data):
    draw = data.draw
    convention = draw(st.sampled_from(["lammps", "liggghts", "talk"]))
    tables = {"normal": dem.table("normal", draw(st.sampled_from(list(LAWS["normal"]))))}
    for family in ("sliding", "rolling"):
        word = draw(st.sampled_from([None, *LAWS[family]]))
        if word is not None and (word != "mindlin" or tables["normal"]["law"] == "hertz"):
            tables[family] = dem.table(family, word)
    omegas = tuple(draw(st.sampled_from([None, 0.0, 0.8, -5.0])) for _ in range(2))
    walls = walls_within(dem)[: draw(st.integers(0, 2))]
    m = annulus.between(draw(st.integers(0, 99)), convention=named[convention], omegas=omegas, walls=walls,
                        squeeze=draw(st.floats(0.9, 1.1)), gravity=draw(st.sampled_from([None, (0.5, -2.0)])), **tables)
    textbook, program = Simulation(m), ProgramSimulation(m)
    textbook.advance(60)
    program.advance(60)
    agree(textbook, program, 1e-8, full_step_forces=convention != "liggghts")


def test_history_at_glued_discs_lives_through_a_new_list(dem, annulus):
    """Springs at the rings, stretched over many renewals of the list."""
    m = annulus.between(squeeze=1.1, **FRICTION)
    textbook, program = Simulation(m, skin=0.02), ProgramSimulation(m, skin=0.5)
    textbook.advance(200)
    program.advance(200)
    assert textbook.rebuilds > 5 * program.rebuilds
    agree(textbook, program, 1e-9)
    table = contact_table(program)
    assert np.hypot(table["ux"], table["uy"])[table["j"] < 0].max() > 1e-3


def test_bits_do_not_depend_on_the_skin_or_on_looking(dem, annulus):
    m = annulus.between(**FRICTION)
    made = []
    for skin, every in ((0.05, 300), (0.3, 7), (0.8, 300)):
        simulation = ProgramSimulation(m, skin=skin)
        while simulation.state.step < 300:
            simulation.advance(min(every, 300 - simulation.state.step))
        made.append(dem.bytes(simulation))
    assert len(set(made)) == 1


def test_an_interval_that_is_made_again_turns_the_ring_once(dem, annulus):
    """A ring so fast that it leaves its list between two looks."""
    m = dem.model([[20.0, 0.0]], rings=(annulus.ring("r", 3.0, omega=900.0),))
    simulation = ProgramSimulation(m)
    simulation.advance(40)
    np.testing.assert_allclose(simulation.state.x[:, 1:], m.rings[0].places(simulation.time), rtol=0, atol=1e-12)


def test_only_a_ring_that_turns_adds_an_operation(dem, annulus):
    options = {"rings": ()} | FRICTION
    without = ProgramSimulation(annulus.between(**options)).operations
    resting = ProgramSimulation(annulus.between(omegas=(None, None), **FRICTION)).operations
    turning = ProgramSimulation(annulus.between(omegas=(1.0, 2.0), **FRICTION)).operations
    assert resting == without
    assert [o for o in turning if o not in without] == ["turning rings: rings"]
    assert len(turning) == len(without) + 1
    assert ProgramSimulation(annulus.between(**options)).nodes.count == 34


def test_a_run_goes_on_from_places_velocities_spins_and_angles(dem, annulus):
    """Stages of a preparation: a state read back, and rings turned by what they turned, are a start."""
    sliding = dem.table("sliding", "viscous")
    m = annulus.between(sliding=sliding, convention="talk")
    whole, first = fastest(m), fastest(m)
    whole.advance(200)
    first.advance(120)
    s, n = first.state, m.particle_count
    rings = tuple(ring.turned(ring.angle(first.time)) for ring in m.rings)
    second = fastest(annulus.between(sliding=sliding, convention="talk", x=s.x[:, :n].T, v=s.v[:, :n].T,
                                     spin=s.spin[0, :n], rings=rings))
    second.advance(80)
    # the restart sees full-step velocities in its first forces; all else is one run
    np.testing.assert_allclose(second.state.x, whole.state.x, rtol=0, atol=1e-4)
    for a, b in zip(ring_loads(second), ring_loads(whole), strict=True):
        assert a.torque == pytest.approx(b.torque, rel=0.01, abs=1.0)
    for part in m.ring_nodes:
        np.testing.assert_allclose(second.state.x[:, part], whole.state.x[:, part], rtol=0, atol=1e-13)
