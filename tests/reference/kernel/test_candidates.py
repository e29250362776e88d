"""The candidate list: complete, invisible in the results, and faithful to the springs it carries."""

import itertools

import numpy as np
import pytest

from reference.kernel.interactions import Interaction
from reference.kernel.model import Constant
from reference.kernel.neighbours import branch_vectors, pairs_within, wall_pairs_within


def brute_force(m, x, skin):
    found = set()
    for i, j in itertools.combinations(range(m.particle_count), 2):
        branch = x[:, i] - x[:, j]
        for axis, side in enumerate(m.periodic or ()):
            if side:
                branch[axis] = min((branch[axis] + k * side for k in range(-40, 41)), key=abs)
        if np.linalg.norm(branch) < m.radius[i] + m.radius[j] + skin:
            found.add((i, j))
    return found


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("sides", [None, (5.0, 0.0, 6.0), (5.0, 5.5, 4.8)])
@pytest.mark.parametrize("skin", [0.0, 0.1, 1.0])
def test_all_near_pairs_and_no_others(dem, dim, sides, skin):
    rng = np.random.default_rng(4)
    x = rng.uniform(-60.0 if sides else 0.0, 60.0 if sides else 8.0, (25, dim))  # far outside the box, too
    m = dem.model(x, radius=rng.uniform(0.4, 1.2, 25), periodic=None if sides is None else sides[:dim])
    i, j = pairs_within(m, m.x, skin)
    assert set(zip(i.tolist(), j.tolist(), strict=True)) == brute_force(m, m.x, skin)
    assert len(i) == len(set(zip(i.tolist(), j.tolist(), strict=True)))


def test_one_particle_has_no_pairs(dem):
    i, j = pairs_within(dem.model([[0.0, 0.0]]), np.zeros((2, 1)), 0.1)
    assert len(i) == len(j) == 0
    dem.run(dem.Simulation(dem.model([[0.0, 0.0]], mu=0.5)), 2)


@pytest.mark.parametrize("x", [-1e-20, -0.0, 5.0, 5.0 - 1e-16, -5.0, 10.0])
def test_positions_on_the_edge_of_the_periodic_box(dem, x):
    """mod(-1e-20, 5) is 5 in floating point, outside [0, 5)."""
    m = dem.model([[x, 1.0], [1.5, 1.0]], periodic=(5.0, 0.0))
    i, j = pairs_within(m, m.x, 0.0)
    assert (i.tolist(), j.tolist()) == ([0], [1])
    assert branch_vectors(m, m.x, i, j)[0, 0] == pytest.approx(-1.5)


def test_walls_near_particles(dem):
    walls = [dem.wall("floor", (0.0, 0.0), (0.0, 1.0)), dem.wall("slope", (0.0, 3.0), (1.0, -1.0))]
    m = dem.model([[1.0, 1.05], [4.0, 3.0], [0.5, 2.0]], walls=walls)
    s = dem.Simulation(m).state
    both = wall_pairs_within(m, s.x, s.wall_normal, (0, 1), 0.1)
    assert set(zip(*(a.tolist() for a in both), strict=True)) == {(0, 3), (2, 4)}
    assert [a.tolist() for a in wall_pairs_within(m, s.x, s.wall_normal, (1,), 0.1)] == [[2], [4]]


def crowd(dem, dim=2, **options):
    sheared = dem.wall("lid", (0.0, 7.0, 0.0)[:dim], (0.0, -1.0, 0.0)[:dim], friction=True,
                       motion=Constant(velocity=(2.0, -0.5, 0.0)[:dim]))
    walls = [*(w for w in dem.box(7.0, dim, friction=("x0",)) if w.name != "y1"), sheared]
    return dem.cluster(5, dim, speed=4.0, walls=walls, mu=0.4, gn=5.0, gt=3.0, **options)


@pytest.mark.parametrize(("dim", "convention"), [(2, "lammps"), (2, "liggghts"), (2, "talk"), (3, "talk")])
def test_the_skin_does_not_show_to_the_last_bit(dem, dim, convention):
    results, rebuilds = set(), []
    for skin in (0.0, 0.01, 0.1, 1.5, 50.0):
        simulation = dem.run(dem.Simulation(crowd(dem, dim, convention=convention), skin=skin), 300)
        results.add(dem.bytes(simulation))
        rebuilds.append(simulation.rebuilds)
    assert len(results) == 1
    assert rebuilds[0] == 301
    assert rebuilds == sorted(rebuilds, reverse=True)
    assert rebuilds[-1] == 1


def test_the_same_run_twice_gives_the_same_bits(dem):
    first, second = (dem.bytes(dem.run(dem.Simulation(crowd(dem)), 300)) for _ in range(2))
    assert first == second


def test_the_skin_does_not_show_with_periodic_axes(dem):
    m = dem.cluster(5, 2, speed=4.0, mu=0.4, gt=3.0, periodic=(6.5, 6.5))
    assert len({dem.bytes(dem.run(dem.Simulation(m, skin=skin), 300)) for skin in (0.0, 0.1, 0.4)}) == 1


def bullet(dem, skin, speed=2000.0):
    """A particle that flies 0.9 radii a step along a row of others, past one and at the next."""
    x = [[0.0, 0.0], [30.0, 1.95], [60.0, -1.9], [90.0, 1.3]]
    m = dem.model(x, v=[[speed, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]], kn=1e6, mu=0.3, mass=[50.0, 1.0, 1.0, 1.0],
                  dt=0.9 / speed)
    return dem.Simulation(m, skin=skin)


def test_a_fast_particle_misses_no_contact(dem):
    """It crosses nine skins of 0.1 in a step and still meets all three others."""
    results = []
    for skin in (1e-3, 0.1, 500.0):
        simulation = bullet(dem, skin)
        partners = set()
        for _ in range(130):
            simulation.advance()
            contact = simulation.interactions[0].last.contact
            partners |= set(zip(contact.i.tolist(), contact.j.tolist(), strict=True))
        results.append(dem.bytes(simulation))
        assert {(0, 1), (0, 2), (0, 3)} <= partners
    assert len(set(results)) == 1


def test_a_fast_wall_misses_no_contact(dem):
    def struck(skin):
        ram = dem.wall("ram", (-20.0, 0.0), (1.0, 0.0), motion=Constant(velocity=(50.0, 0.0)))
        m = dem.model([[0.0, 0.0]], walls=[ram], kn=1e6, dt=0.01)
        return dem.run(dem.Simulation(m, skin=skin), 45)

    assert struck(1e-3).state.v[0, 0] > 50.0
    assert dem.bytes(struck(1e-3)) == dem.bytes(struck(100.0))


@pytest.mark.parametrize("overlap", [2.0**-10, 2.0**-40, 2.0**-50])
def test_a_contact_begins_with_the_smallest_overlap(dem, overlap):
    floor = dem.wall("floor", (0.0, -1.0), (0.0, 1.0))
    m = dem.model([[0.0, -overlap], [2.0 - overlap, 0.0]], walls=[floor])
    force = dem.Simulation(m).state.force
    assert force[0, 1] == pytest.approx(dem.KN * overlap, rel=1e-2)
    assert force[1, 0] == pytest.approx(dem.KN * overlap, rel=1e-2)
    apart = dem.model([[0.0, 0.0], [2.0, 0.0]], walls=[floor])
    assert not dem.Simulation(apart).state.force.any()


def springs_of(simulation):
    pairs = simulation.interactions[0].pairs
    rows = zip(pairs.i.tolist(), pairs.j.tolist(), pairs.memory["sliding"].T.tolist(), strict=True)
    return {(i, j): tuple(u) for i, j, u in rows if any(u)}


def test_springs_are_carried_through_a_rebuild(dem):
    simulation = dem.run(dem.Simulation(crowd(dem)), 40)
    before = springs_of(simulation)
    assert len(before) > 3
    for skin in (0.0, 3.0, 0.2):
        simulation.skin = skin
        simulation._rebuild()
        assert springs_of(simulation) == before


@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk"])
@pytest.mark.parametrize("skin", [0.0, 10.0])
def test_a_contact_that_opened_starts_again_without_spring(dem, skin, convention):
    """With a skin of 10 the pair stays listed while it is apart, and must forget all the same."""
    simulation = dem.Simulation(dem.model([[0.0, 0.0], [1.9, 0.0]], mu=0.8, convention=convention), skin=skin)

    def place(distance, slip_speed):
        simulation.state.x[0, 1], simulation.state.v[1, 1] = distance, slip_speed
        simulation.renew_candidates()
        simulation.evaluate(advance=True)
        return springs_of(simulation)

    assert abs(place(1.9, 20.0)[0, 1][1]) > 1e-3
    assert place(1.9, 0.0)
    assert not place(2.1, 0.0)
    assert not place(1.9, 0.0)
    assert simulation.state.force[1].tolist() == [0.0, 0.0]


def test_an_evaluation_for_output_changes_nothing(dem):
    watched, left_alone = dem.Simulation(crowd(dem)), dem.Simulation(crowd(dem))
    for _ in range(100):
        watched.advance()
        assert all(isinstance(k, Interaction) for k, _ in watched.contacts())
        left_alone.advance()
    assert dem.bytes(watched) == dem.bytes(left_alone)
