"""Blocks of pairs and intervals between two looks at the list: how a step is made, which no number may depend on."""

from unittest.mock import patch

import numpy as np
import pytest

from reference.kernel.conventions import CONVENTIONS
from reference.kernel.program import simulation
from reference.kernel.program.simulation import CHECK_EVERY, CHECK_WITHIN, ProgramSimulation

LAWS = {
    "normal": ("normal", "hysteretic"), "sliding": ("sliding", "spring"), "rolling": ("rolling", "spring"),
    "torsion": ("torsion", "spring"),
}


def rough_box(dem, dim):
    return dem.box(11, dim, friction=("x0", "y1"))


def with_blocks_of(size, m) -> ProgramSimulation:
    with patch.object(simulation, "BLOCK", size):
        return ProgramSimulation(m)


@pytest.mark.parametrize("convention", [name for name, c in CONVENTIONS.items() if c.scheme == "leapfrog"])
@pytest.mark.parametrize("dim", [2, 3])
def test_bits_do_not_depend_on_the_blocks(dem, dim, convention):
    """All families of laws, walls of both kinds, and pairs that blocks part at any place."""
    tables = {family: dem.table(*law) for family, law in LAWS.items() if (family, dim) != ("torsion", 2)}
    m = dem.cluster(5, dim, across=7 - dim, squeeze=0.95, walls=rough_box(dem, dim), convention=convention, **tables)
    made = []
    for size in (8, 24, 10_000):
        with patch.object(simulation, "BLOCK", size):
            program = ProgramSimulation(m, skin=0.05)
            program.advance(150)
        made.append((dem.bytes(program), program.rebuilds))
    assert len(set(made)) == 1
    assert made[0][1] > 3


def test_blocks_are_the_whole_list(dem):
    """In its order, each a view of the list's history and forces, beginning on a cache line."""
    m = dem.cluster(5, 2, across=5, squeeze=0.95, walls=rough_box(dem, 2), mu=0.5)
    program = with_blocks_of(8, m)
    program.advance(1)
    pairs = program._pairs
    assert len(pairs.blocks) > 3
    assert sum(c.count for c in pairs.blocks) == pairs.count == len(pairs.i)
    np.testing.assert_array_equal(pairs.i, with_blocks_of(10_000, m)._pairs.i)
    for c in pairs.blocks:
        assert c.force.base is pairs.force.base
        assert c.history["sliding"].__array_interface__["data"][0] % 64 == 0
    assert len({c.overlap.__array_interface__["data"][0] for c in pairs.blocks}) == 1


def test_an_empty_list_is_one_empty_block(dem):
    m = dem.model([[0.0, 0.0], [40.0, 0.0]], v=[[1.0, 0.0], [0.0, 0.0]], mu=0.5)
    program = ProgramSimulation(m)
    program.advance(30)
    assert [c.count for c in program._pairs.blocks] == [0]
    assert program.state.x[0, 0] == pytest.approx(30 * m.dt)


# --- intervals -------------------------------------------------------------------------------------------


def test_a_quiet_list_is_looked_at_rarely(dem):
    m = dem.cluster(5, 2, squeeze=1.3, speed=1e-3)
    program = ProgramSimulation(m, skin=0.5)
    program.advance(400)
    assert program._interval == CHECK_WITHIN
    assert program.rebuilds == 1


def test_a_body_that_speeds_up_misses_no_contact(dem):
    """From rest, with looks far between, until it falls through the skin in a few steps."""
    floor = dem.wall("floor", (0.0, 0.0), (0.1, 1.0), friction=True)
    m = dem.model([[0.0, 6.0]], gravity=(0.0, -8e2), walls=[floor], gn=5.0, mu=0.5)
    textbook, program = dem.Simulation(m, skin=0.3), ProgramSimulation(m, skin=0.3)
    longest, upwards = 0, 0.0
    for _ in range(60):
        textbook.advance(10)
        program.advance(10)
        longest, upwards = max(longest, program._interval), max(upwards, textbook.state.v[1, 0])
        assert np.abs(textbook.state.x - program.state.x).max() < 1e-11
    assert longest > CHECK_EVERY
    assert upwards > 1.0
