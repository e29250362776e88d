"""Single spheres on a floor that rolling and torsion resistance slow down and stop."""

import math

import numpy as np
import pytest

CONVENTIONS = ("lammps", "liggghts", "talk")
G, INERTIA = 10.0, 0.4


def on_floor(dem, convention, *, velocity=0.0, spin=(0.0, 0.0, 0.0), **tables):
    """A sphere of radius and mass 1 that sinks in by g/k_n, moving along x."""
    floor = dem.wall("floor", (0.0,) * 3, (0.0, 0.0, 1.0), friction=True)
    return dem.Simulation(dem.model(
        [[0.0, 0.0, 1.0 - G / dem.KN]], v=[[velocity, 0.0, 0.0]], spin=[spin], walls=[floor], gravity=(0.0, 0.0, -G),
        convention=convention, dt=dem.tc / 20, normal=dem.table("normal", "linear"), **tables))


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("law", ["spring", "constant"])
def test_a_rolling_sphere_slows_down_steadily(dem, law, convention):
    """With couple C = mu_r R m g and v = b omega, v' = -C b/(I + m b^2): 5/7 mu_r g for the arm b = R."""
    arm = 1.0 if convention == "lammps" else 1.0 - 0.5 * G / dem.KN
    damping = {"rolling_damping": 0.0} if law == "spring" else {}
    rolling = dem.table("rolling", law, rolling_friction=0.05, **damping)
    sliding = dem.table("sliding", "spring", shear_friction=5.0, shear_damping=20.0)
    s = on_floor(dem, convention, velocity=2.0, spin=(0.0, 2.0 / arm, 0.0), rolling=rolling, sliding=sliding)
    dem.run(s, 300)
    before = s.state.v[0, 0]
    dem.run(s, 300)
    slowing = (before - s.state.v[0, 0]) / (300 * s.model.dt)
    assert slowing == pytest.approx(0.05 * G * arm / (INERTIA + arm**2), rel=2e-3)
    assert s.state.v[0, 0] == pytest.approx(arm * s.state.spin[1, 0], rel=1e-3)


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_a_spinning_sphere_slows_down_steadily(dem, convention):
    """omega' = -mu_o R m g/I about the normal, and not at all without torsion resistance."""
    torsion = dem.table("torsion", "spring", torsion_damping=0.0)
    s = dem.run(on_floor(dem, convention, spin=(0.0, 0.0, 9.0), torsion=torsion), 100)
    before = s.state.spin[2, 0]
    dem.run(s, 100)
    slowing = (before - s.state.spin[2, 0]) / (100 * s.model.dt)
    assert slowing == pytest.approx(0.15 * G / INERTIA, rel=1e-9)
    free = dem.run(on_floor(dem, convention, spin=(0.0, 0.0, 9.0), sliding=dem.table("sliding", "spring")), 100)
    assert free.state.spin[2, 0] == 9.0


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize(("family", "axis"), [("rolling", 0), ("torsion", 2)])
def test_a_slow_spin_swings_in_the_spring(dem, family, axis, convention):
    """Below the limit omega = omega_0 cos(W t), W = sqrt(k a*^2/I), to the error of the step.

    In the talk the spring is stretched after the force is known, which is then a step late: swings grow by
    exp(W^2 dt t/2) where no dashpot damps them.
    """
    frequency = math.sqrt(50.0 / INERTIA)
    numbers = {f"{family}_stiffness": 50.0, f"{family}_damping": 0.0, f"{family}_friction": 5.0}
    spin = [0.0, 0.0, 0.0]
    spin[axis] = 0.5
    s = on_floor(dem, convention, spin=spin, **{family: dem.table(family, "spring", **numbers)})
    spins = []
    for _ in range(600):
        s.advance()
        spins.append(s.state.spin[axis, 0])
    time = s.model.dt * np.arange(1, 601)
    growth = 0.5 * frequency**2 * s.model.dt if convention == "talk" else 0.0
    np.testing.assert_allclose(spins, 0.5 * np.exp(growth * time) * np.cos(frequency * time), atol=0.008)
    assert min(spins) < -0.45


@pytest.mark.parametrize("family", ["rolling", "torsion"])
def test_the_dashpot_stops_it(dem, family):
    axis = 0 if family == "rolling" else 2
    spin = [0.0, 0.0, 0.0]
    spin[axis] = 5.0
    s = on_floor(dem, "talk", spin=spin, **{family: dem.table(family, "spring", **{f"{family}_damping": 20.0})})
    dem.run(s, 8000)
    assert np.abs(s.state.spin).max() < 1e-6
