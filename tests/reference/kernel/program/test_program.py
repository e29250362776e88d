"""The program kernel against the textbook evaluation: the same numbers to round-off, and no operation too many."""

import numpy as np
import pytest

from reference.kernel.conventions import CONVENTIONS
from reference.kernel.model import Constant, Cosine, Loaded
from reference.kernel.output import contact_table, particle_table, wall_table
from reference.kernel.program.simulation import ProgramSimulation
from reference.kernel.simulation import KernelUnstable

FRICTION = {"mu": 0.4, "gn": 5.0, "gt": 2.0}


def difference(dem, m, steps) -> float:
    """Largest difference of positions and velocities after `steps`, in radii and in units of their scale."""
    textbook, program = dem.Simulation(m), ProgramSimulation(m)
    textbook.advance(steps)
    program.advance(steps)
    s, t = textbook.state, program.state
    pairs = [(s.x, t.x), (s.v, t.v), (s.spin, t.spin), (s.wall_d, t.wall_d), (s.wall_rate, t.wall_rate)]
    return max(float(np.abs(a - b).max(initial=0.0) / max(np.abs(a).max(initial=0.0), 1.0)) for a, b in pairs)


def moving_box(dem, dim, *, rough) -> list:
    """Left fixed, right with mass under a load that depends on a distance, bottom pushed, top a tilted cosine."""

    def wall(name, point, normal, motion=None):
        rest = (0.0,) * (dim - 2)
        return dem.wall(name, point + rest, normal + rest, friction=rough and name != "bottom", motion=motion)

    load = Loaded(mass=3.0, load=5.0, stress=20.0, span=(1, 3), damping=2.0)
    return [
        wall("left", (-0.3, 0.0), (1.0, 0.0)),
        wall("bottom", (0.0, -0.3), (0.0, 1.0), Constant(velocity=(0.1, 0.2, 0.3)[:dim])),
        wall("right", (8.2, 0.0), (-1.0, 0.0), load),
        wall("top", (0.0, 8.2), (0.2, -1.0), Cosine(travel=0.4, duration=0.1)),
    ]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("convention", list(CONVENTIONS))
def test_what_is_written_is_the_textbooks(dem, convention, dim):
    walls, angles = moving_box(dem, dim, rough=True), dim == 2
    m = dem.cluster(1, dim, squeeze=0.95, walls=walls, convention=convention, rotations=angles, **FRICTION)
    textbook, program = dem.Simulation(m), ProgramSimulation(m)
    textbook.advance(57)
    program.advance(57)
    for table in (particle_table, wall_table, contact_table):
        expected, got = table(textbook), table(program)
        assert expected.keys() == got.keys()
        for name, values in expected.items():
            scale = max(np.abs(values).max(), 1.0)
            np.testing.assert_allclose(got[name] / scale, values / scale, atol=1e-10, err_msg=name)


@pytest.mark.parametrize("dim", [2, 3])
def test_looking_does_not_alter_the_run(dem, dim):
    m = dem.cluster(4, dim, squeeze=0.95, walls=moving_box(dem, dim, rough=True), **FRICTION)
    quiet, watched = ProgramSimulation(m), ProgramSimulation(m)
    quiet.advance(60)
    for _ in range(20):
        watched.advance(3)
        contact_table(watched)
    assert dem.bytes(quiet) == dem.bytes(watched)


@pytest.mark.parametrize("dim", [2, 3])
def test_bits_do_not_depend_on_the_skin(dem, dim):
    m = dem.cluster(5, dim, across=7 - dim, squeeze=0.98, walls=dem.box(11, dim), **FRICTION)
    made = []
    for skin in (0.03, 0.1, 0.6):
        simulation = ProgramSimulation(m, skin=skin)
        simulation.advance(400)
        made.append((dem.bytes(simulation), simulation.rebuilds))
    assert len({state for state, _ in made}) == 1
    assert made[0][1] > made[2][1]


def test_an_interval_that_could_miss_a_contact_is_made_again(dem):
    """A body so fast that it crosses many skins between two looks still meets the one in its way."""
    m = dem.model([[0.0, 0.0], [4.0, 0.0]], v=[[100.0, 0.0], [0.0, 0.0]], convention="lammps")
    assert difference(dem, m, 120) < 1e-11
    simulation = ProgramSimulation(m)
    simulation.advance(120)
    assert simulation.state.v[0, 1] == pytest.approx(100.0, rel=0.01)


def test_a_centre_beyond_a_wall_stops_the_run(dem):
    m = dem.model([[0.0, 2.0]], v=[[0.0, -900.0]], walls=[dem.wall("floor", (0, 0), (0, 1))])
    with pytest.raises(KernelUnstable, match="centre of particle 1 has passed wall 'floor'"):
        ProgramSimulation(m).advance(200)


def test_a_number_that_is_none_stops_the_run(dem):
    m = dem.model([[0.0, 0.0], [1.5, 0.0]], dt=1e300)
    with pytest.raises(KernelUnstable, match="no longer a finite number"), np.errstate(all="ignore"):
        ProgramSimulation(m).advance(50)


def operations(dem, **options) -> list[str]:
    return ProgramSimulation(dem.cluster(2, 2, squeeze=0.95, **options)).operations


def test_an_effect_that_is_off_adds_no_operation(dem):
    """Each effect's operations bear its name, and leave those of all other effects as they were."""
    elastic = operations(dem)
    effects = {
        "normal damping": {"gn": 3.0}, "background drag": {"drag": 0.1}, "gravity": {"gravity": (0.0, -1.0)},
        "periodic axes": {"periodic": (40.0, 0.0)},
    }
    for name, options in effects.items():
        assert not [o for o in elastic if o.startswith(name)]
        assert [o for o in operations(dem, **options) if o.startswith(name)]
    smooth, rough = operations(dem, gn=3.0), operations(dem, gn=3.0, mu=0.5)
    assert not [o for o in smooth if o.startswith(("sliding friction", "rotation"))]
    assert len(elastic) < len(smooth) < len(rough)


def test_without_friction_there_is_no_spin_and_no_history(dem):
    simulation = ProgramSimulation(dem.cluster(2, 2, gn=3.0))
    assert simulation.nodes.s is None
    assert simulation.nodes.m is None
    assert simulation.history == {}


def test_no_step_changes_nothing_that_is_written(dem):
    m = dem.cluster(1, 2, squeeze=0.95, walls=moving_box(dem, 2, rough=True), **FRICTION)
    still, program = dem.Simulation(m), ProgramSimulation(m)
    program.advance(0)
    for name, values in contact_table(still).items():
        assert np.array_equal(contact_table(program)[name], values), name
