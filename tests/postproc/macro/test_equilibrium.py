"""Balances of the ring on exact solutions, and the torque from wall to wall."""

import dataclasses

import numpy as np
import pytest

from postproc.macro.equilibrium import RingProfile, angular_residual, radial_residual, torque_balance

R_I, R_O = 1.0, 2.5


def steady(count, *, spinning=0.0, drag=0.0, odd=0.0):
    """Return an exact solution: constant pressure plus the term that carries rho v^2, and torque T(r) = 2 pi r^2 s.

    rho = 3, v = spinning r: sigma_rr = p + rho spinning^2 r^2/2 = sigma_phiphi. b_phi = -drag r:
    r^2 sigma_rphi = 1 - drag r^4/4 - odd r^2/2, with sigma_phir = sigma_rphi + odd.
    """
    r = R_I + (np.arange(count) + 0.5) / count * (R_O - R_I)
    pressure = 5.0 + 1.5 * spinning**2 * r**2
    # d(r^2 s)/dr = -drag r^3 - r odd
    shear = (1.0 - drag * r**4 / 4 - odd * r**2 / 2) / r**2
    stress = np.stack([np.stack([pressure, shear], -1), np.stack([shear + odd, pressure], -1)], -2)
    return RingProfile(
        r=r, stress=stress, density=np.full(count, 3.0), v_phi=spinning * r,
        drag=np.column_stack([np.zeros(count), -drag * r]) if drag else None,
    )


@pytest.mark.parametrize("options", [{}, {"spinning": 0.8}, {"drag": 0.3}, {"odd": 0.2}])
def test_residuals_vanish_with_the_square_of_the_width(options):
    counts = (60, 120, 240, 480)
    for residual in (radial_residual, angular_residual):
        errors = [np.abs(residual(steady(n, **options)).value).max() for n in counts]
        if errors[0] > 1e-10:  # else exact: a constant, a parabola
            assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.15)


def test_centripetal_force_needs_a_pressure_that_rises_outwards():
    """The talk's equation is for tension: with our stresses the inertia has the other sign."""
    profile = steady(60, spinning=0.8)
    without = dataclasses.replace(profile, v_phi=np.zeros(60))
    np.testing.assert_allclose(radial_residual(without).value, -3.0 * (0.8 * profile.r) ** 2, rtol=1e-3)


def test_a_wrong_exponent_shows():
    """sigma_rphi ~ 1/r in place of r^-2: residual -r d/dr - 2 = -1/r."""
    profile = steady(60)
    s = profile.stress.copy()
    s[:, 0, 1] = s[:, 1, 0] = 1.0 / profile.r
    residual = angular_residual(dataclasses.replace(profile, stress=s)).value
    np.testing.assert_allclose(residual, -1.0 / profile.r, rtol=2e-3)


def test_errors_are_those_of_noise():
    """Standard deviation of the residual over many noisy profiles against the propagated error, cell by cell."""
    profile = steady(12)
    error = np.full((12, 2, 2), 1e-3) * np.array([[1.0, 2.0], [3.0, 0.5]])
    rng = np.random.default_rng(3)
    for residual in (radial_residual, angular_residual):
        noisy = [
            residual(dataclasses.replace(profile, stress=profile.stress + error * rng.normal(size=error.shape))).value
            for _ in range(4000)
        ]
        expected = residual(dataclasses.replace(profile, error=error)).error
        np.testing.assert_allclose(np.std(noisy, axis=0), expected, rtol=0.06)
    assert np.isnan(radial_residual(profile).error).all()


def test_torque_is_constant_from_wall_to_wall():
    profile = dataclasses.replace(steady(30), error=np.full((30, 2, 2), 0.01))
    T = 2 * np.pi * 1.0 * 0.006  # r^2 sigma_rphi = 1, thickness 6 mm
    balance = torque_balance(profile, inner_torque=-T, outer_torque=T, inner_radius=R_I, outer_radius=R_O,
                             thickness=0.006)
    np.testing.assert_allclose(balance.measured, T, rtol=1e-13)
    np.testing.assert_allclose(balance.expected, T, rtol=1e-13)
    np.testing.assert_allclose(balance.error, 2 * np.pi * 0.006 * profile.r**2 * 0.01, rtol=1e-13)
    assert (balance.inner, balance.outer, balance.outer_expected) == pytest.approx((T, T, T), rel=1e-13)


@pytest.mark.parametrize("options", [{"drag": 0.3}, {"odd": 0.2}])
def test_bottom_and_spins_take_their_part_of_the_torque(options):
    """To second order in the rings' width, up to the outer wall."""
    counts, errors = (15, 30, 60, 120), []
    drag, odd = options.get("drag", 0.0), options.get("odd", 0.0)
    at = {r: 2 * np.pi * (1.0 - drag * r**4 / 4 - odd * r**2 / 2) for r in (R_I, R_O)}
    for n in counts:
        balance = torque_balance(steady(n, **options), inner_torque=-at[R_I], outer_torque=at[R_O],
                                 inner_radius=R_I, outer_radius=R_O)
        deviation = np.append(balance.measured - balance.expected, balance.outer - balance.outer_expected)
        errors.append(np.abs(deviation).max())
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.25)
    assert errors[-1] < 1e-2 * 2 * np.pi
