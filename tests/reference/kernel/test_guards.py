"""Bodies that laws for small overlaps cannot describe stop the run, in both evaluations of the kernel."""

import numpy as np
import pytest

from reference.kernel.guards import KernelUnstable, refuse_centres_inside, refuse_late_springs, refuse_leaps
from reference.kernel.program.simulation import ProgramSimulation

RADIUS = np.ones(2)


@pytest.fixture(params=["textbook", "program"])
def kernel(dem, request):
    """One of the two evaluations."""
    return dem.Simulation if request.param == "textbook" else ProgramSimulation


def leap(dem, before, after):
    m = dem.model(np.array(before).tolist())
    refuse_leaps(m, np.array(before).T, np.array(after).T, RADIUS, 7)


def test_a_leap_through_a_body_names_both(dem):
    with pytest.raises(KernelUnstable, match="step 7: particle 1 moves 10 of its radii in one step, through part.* 2"):
        leap(dem, [[0.0, 0.0], [5.0, 0.5]], [[10.0, 0.0], [5.0, 0.5]])


@pytest.mark.parametrize(("before", "after"), [
    ([[0.0, 0.0], [5.0, 2.5]], [[10.0, 0.0], [5.0, 2.5]]),  # past it
    ([[0.0, 0.0], [50.0, 0.0]], [[10.0, 0.0], [50.0, 0.0]]),  # short of it
    ([[0.0, 0.0], [5.0, 0.0]], [[3.5, 0.0], [5.0, 0.0]]),  # onto it: the contact is seen at the end
    ([[0.0, 0.0], [5.0, 0.0]], [[100.0, 0.0], [105.0, 0.0]]),  # with it
    ([[0.0, 0.0], [1.9, 0.0]], [[-10.0, 0.0], [1.9, 0.0]]),  # away from it
])
def test_a_leap_past_all_others_is_nobody_s_business(dem, before, after):
    leap(dem, before, after)


def test_two_that_leap_through_each_other_are_seen(dem):
    with pytest.raises(KernelUnstable, match="through particle 2"):
        leap(dem, [[0.0, 0.0], [10.0, 0.0]], [[8.0, 0.0], [2.0, 0.0]])


def test_a_graze_between_two_looks_is_seen(dem):
    with pytest.raises(KernelUnstable):
        leap(dem, [[0.0, 0.0], [5.0, 1.999]], [[10.0, 0.0], [5.0, 1.999]])
    leap(dem, [[0.0, 0.0], [5.0, 2.001]], [[10.0, 0.0], [5.0, 2.001]])


@pytest.mark.parametrize("speed", [30.0, 3e3, 1e6])
def test_bodies_too_fast_for_their_springs_stop_the_run(dem, kernel, speed):
    """From penetrating slowly to passing in one step: never a way through."""
    m = dem.model([[0.0, 0.0], [7.0, 1e-3]], v=[[speed, 0.0], [-speed, 0.0]], kn=1.0, dt=0.01)
    with pytest.raises(KernelUnstable, match="inside the other body|through particle"):
        kernel(m).advance(100)


def test_two_centres_in_one_place_stop_the_run(dem, kernel):
    m, said = dem.model([[0.0, 0.0], [0.0, 0.0]]), "inside the other body|no longer a finite number"
    with pytest.raises(KernelUnstable, match=said), np.errstate(all="ignore"):
        kernel(m).advance(5)


def test_deep_but_not_too_deep_is_left_alone(dem, kernel):
    m = dem.model([[0.0, 0.0], [1.01, 0.0]], kn=100.0, dt=1e-3)
    simulation = kernel(m)
    simulation.advance(50)
    assert simulation.state.v[0, 1] > 0


def test_the_depth_is_the_overlap_less_the_smaller_radius(dem):
    m = dem.model([[0.0, 0.0], [1.25, 0.0], [9.0, 0.0]])
    i, j = np.array([0, 1]), np.array([1, 2])
    assert refuse_centres_inside(m, m.x, m.radius, i, j, 0) == pytest.approx(-0.25)
    assert refuse_centres_inside(m, m.x, m.radius, i[:0], j[:0], 0) == -np.inf


def test_a_fast_body_in_empty_space_flies_on(dem, kernel):
    m = dem.model([[0.0, 0.0], [0.0, 30.0]], v=[[1e4, 0.0], [0.0, 0.0]], dt=0.01)
    simulation = kernel(m)
    simulation.advance(20)
    assert simulation.state.x[0, 0] == pytest.approx(2000.0)


# --- springs that are felt late ------------------------------------------------------------------------------


def rubbing(dem, convention="talk", **law):
    return dem.model([[0.0, 1.0]], walls=[dem.wall("floor", (0.0, 0.0), (0.0, 1.0), friction=True)], mu=0.5, kn=100.0,
                     dt=0.01, convention=convention, **law)


def test_a_late_spring_without_dashpot_is_refused_where_it_could_swing_up(dem):
    """A disc of 1 kg: W^2 = k (1 + 2) in 2D, so exp(W^2 dt t/2) = e after 2/(W^2 dt^2) steps."""
    m = rubbing(dem)
    square = m.sliding.shear_stiffness * float((1 / m.mass + m.radius**2 / m.inertia).max())
    most = 2.0 / (square * m.dt**2)
    refuse_late_springs(m, int(0.99 * most))
    with pytest.raises(KernelUnstable, match="step 0: the talks' algorithm feels the sliding spring one step late"):
        refuse_late_springs(m, int(1.01 * most) + 1)


@pytest.mark.parametrize("convention", ["lammps", "liggghts", "corrected"])
def test_others_feel_their_springs_in_time(dem, convention):
    from reference.kernel.conventions import NAMED

    refuse_late_springs(rubbing(dem, convention=NAMED[convention]), 10**9)
