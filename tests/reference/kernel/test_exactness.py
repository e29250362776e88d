"""What a reference owes: conservation, energy, time reversal, repetition, and its own round-off measured."""

import numpy as np
import pytest

from reference.kernel.conventions import NAMED
from reference.kernel.program.simulation import ProgramSimulation, fastest

EXTENDED = np.finfo(np.longdouble).eps < 1e-18


def momentum(simulation):
    s, m = simulation.state, simulation.model
    return (m.mass * s.v[:, : m.particle_count]).sum(axis=1)


@pytest.mark.parametrize("convention", ["liggghts", "talk", "corrected"])
def test_momentum_and_angular_momentum_over_many_steps(dem, convention):
    """2e4 steps of a periodic-free cluster in a box of springs: nothing outside acts. The arm is R - delta/2."""
    m = dem.cluster(3, 2, across=5, squeeze=0.97, speed=0.3, gn=0.0, mu=0.5, gt=0.0, convention=NAMED[convention])
    simulation = ProgramSimulation(m)
    scale = (m.mass * np.abs(simulation.state.v[:, : m.particle_count])).sum()
    before, turning = momentum(simulation), dem.angular_momentum(simulation)
    simulation.advance(20_000)
    assert np.abs(momentum(simulation) - before).max() < 1e-13 * scale
    radius = np.abs(simulation.state.x).max()
    assert np.abs(dem.angular_momentum(simulation) - turning).max() < 1e-12 * scale * radius


@pytest.mark.long
def test_momentum_over_1e5_steps(dem):
    m = dem.cluster(3, 2, across=8, squeeze=0.97, gn=5.0, mu=0.5, gt=2.0, periodic=(16.0, 16.0), convention="talk")
    simulation = ProgramSimulation(m)
    scale, before = (m.mass * np.abs(simulation.state.v[:, :64])).sum(), momentum(simulation)
    simulation.advance(100_000)
    assert np.abs(momentum(simulation) - before).max() < 1e-13 * scale


@pytest.mark.parametrize("convention", ["lammps", "corrected"])
def test_energy_of_an_elastic_gas_does_not_drift(dem, convention):
    """Frictionless, undamped, in a box, at dt = t_c/50 over 20000 steps: the leapfrog's error swings and does not grow.

    The corrections are not symplectic: theirs grows, here to 6e-4.
    """
    m = dem.cluster(5, 2, across=5, speed=1.0, walls=dem.box(11, 2), convention=NAMED[convention])
    simulation = ProgramSimulation(m)
    start, drift = dem.energy(simulation), []
    for _ in range(10):
        simulation.advance(2000)
        drift.append(abs(dem.energy(simulation) / start - 1))
    assert max(drift) < 2e-3
    if convention == "lammps":
        assert sum(drift[5:]) < 3.0 * sum(drift[:5])


def test_time_reversal(dem):
    """An elastic run retraces itself when all velocities are turned, to round-off times chaos."""
    m = dem.cluster(5, 2, across=5, speed=1.0, walls=dem.box(11, 2), convention="lammps")
    there = dem.Simulation(m)
    there.advance(300)
    from dataclasses import replace

    n = m.particle_count
    back = dem.Simulation(replace(m, x=there.state.x[:, :n].copy(), v=-there.state.v[:, :n]))
    back.advance(300)
    assert np.abs(back.state.x[:, :n] - m.x).max() < 1e-10
    assert np.abs(there.state.x[:, :n] - m.x).max() > 0.1


@pytest.mark.parametrize("dim", [2, 3])
def test_the_same_bits_on_repetition(dem, dim):
    m = dem.cluster(5, dim, squeeze=0.97, gn=5.0, mu=0.5, gt=2.0, walls=dem.box(9, dim))
    runs = [fastest(m), fastest(m)]
    for simulation in runs:
        simulation.advance(500)
    assert dem.bytes(runs[0]) == dem.bytes(runs[1])


@pytest.mark.skipif(not EXTENDED, reason="long double is a double on this machine")
@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk", "corrected"])
def test_round_off_of_the_double_runs(dem, convention):
    """Extended precision tells how much of a double run is rounding: at most 1e-12 radii after 200 steps."""
    from reference.kernel.corrected import simulate

    m = dem.cluster(5, 2, squeeze=0.97, gn=5.0, mu=0.5, gt=2.0, walls=dem.box(9, 2, friction=("x0",)),
                    convention=NAMED[convention])
    exact, textbook, program = simulate(m.in_long_double()), simulate(m), ProgramSimulation(m)
    for simulation in (exact, textbook, program):
        simulation.advance(200)
    assert exact.state.x.dtype == exact.state.force.dtype == np.longdouble
    for rounded in (textbook, program):
        off = np.abs(rounded.state.x - exact.state.x).max()
        assert 0.0 < off < 1e-12
