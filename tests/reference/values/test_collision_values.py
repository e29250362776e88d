"""Tabulated impacts, derived twice: by the closed forms in code, and by integrating the equation of motion."""

import math

import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from reference.analytic.adhesive_collision import JkrCollision
from reference.analytic.hertz_collision import HertzCollision, damping_factor_for_restitution, hertz_stiffness
from reference.analytic.hysteretic_collision import ConstantUnloading, OverlapUnloading
from reference.analytic.linear_collision import LinearCollision
from reference.analytic.oblique_impact import ObliqueImpact
from reference.values import collect, published_values

R_I, R_J, M_I, M_J = 2.0**-10, 1.25 * 2.0**-10, 2.0**-14, 1.75 * 2.0**-14
RADIUS, MASS = R_I * R_J / (R_I + R_J), M_I * M_J / (M_I + M_J)
SPEED, MODULUS = 0.5, 1e8 / (2 * (1 - 0.25**2))
K_1, K_2, K_C = 5e4, 1e5, 5e4
VARIABLE = OverlapUnloading(
    loading=K_1, limit=K_2, adhesion=K_C, plasticity_depth=0.025, pair_radius=2 * RADIUS, reduced_mass=MASS
)


def hertz(mass: float, radius: float) -> HertzCollision:
    stiffness = hertz_stiffness(effective_modulus=MODULUS, effective_radius=radius)
    return HertzCollision(
        stiffness=stiffness, reduced_mass=mass, damping_factor=damping_factor_for_restitution(0.6)
    )


def branches(largest: float) -> ConstantUnloading:
    return ConstantUnloading(loading=K_1, unloading=VARIABLE.unloading(largest), adhesion=K_C, reduced_mass=MASS)


def sliding_velocity() -> float:
    pair = ObliqueImpact(inertia_factor=0.4, friction=0.31, restitution=1.0)
    (u_i, u_j), _ = pair.of_pair(
        normal=SPEED, tangential=(0.0, 0.0), spin=(-1500.0, -1500.0), radius=(R_I, R_J), mass=(M_I, M_J)
    )
    return float(u_i - u_j)


CLOSED_FORMS = {
    "restitution_linear": LinearCollision(stiffness=1e5, damping=1.0, reduced_mass=MASS).restitution("allowed"),
    "restitution_linear_floor": LinearCollision(stiffness=1e5, damping=1.0, reduced_mass=M_I).restitution("allowed"),
    "restitution_linear_clipped": LinearCollision(stiffness=1e5, damping=1.0, reduced_mass=MASS).restitution("clipped"),
    "restitution_hertz": hertz(MASS, RADIUS).restitution("allowed"),
    "restitution_hertz_floor": hertz(M_I, R_I).restitution("allowed"),
    "restitution_hertz_clipped": hertz(MASS, RADIUS).restitution("clipped"),
    "restitution_hysteretic": ConstantUnloading(
        loading=K_1, unloading=K_2, adhesion=K_C, reduced_mass=MASS).restitution,
    "restitution_hysteretic_variable": VARIABLE.restitution(SPEED),
    "velocity_gained_by_sliding": sliding_velocity(),
}


def integrated(force, mass: float, *, clipped: bool) -> float:
    """Restitution of m d'' = -F(d, d'), from first touch until d = 0 or, clipped, F = 0."""

    def over(_, y):
        return force(*y) if clipped and y[1] < 0.0 else y[0] + (1e-30 if y[1] > 0.0 else 0.0)

    over.terminal, over.direction = True, -1
    start = 1e-13
    run = solve_ivp(
        lambda _, y: [y[1], -force(*y) / mass], (0.0, 1.0), [start * SPEED, SPEED], events=over, rtol=1e-11, atol=1e-16,
        max_step=1e-6,
    )
    return -run.y[1, -1] / SPEED


def linear_force(d: float, rate: float) -> float:
    return 1e5 * d + 1.0 * rate


def hertz_force(radius: float, mass: float):
    beta = -math.log(0.6) / math.hypot(math.log(0.6), math.pi)

    def force(d: float, rate: float) -> float:
        d = max(d, 0.0)
        a = math.sqrt(radius * d)
        return 4 / 3 * MODULUS * a * d + math.sqrt(10 / 3) * beta * math.sqrt(2 * MODULUS * a * mass) * rate

    return force


def by_parts(largest: float, branch: ConstantUnloading) -> float:
    """Loading by its energy, unloading integrated: adhesive branch and all."""
    def over(_, y):
        return y[0]

    over.terminal, over.direction = True, -1
    run = solve_ivp(
        lambda _, y: [y[1], -float(branch.force(max(y[0], 1e-15), largest)) / MASS], (0.0, 1.0), [largest, 0.0],
        events=over, rtol=1e-11, atol=1e-15, max_step=2e-7,
    )
    return -run.y[1, -1] / SPEED


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_the_table_holds_the_closed_form(name):
    value = published_values()[name]
    assert value.value == pytest.approx(CLOSED_FORMS[name], rel=1e-14)
    assert value.kind == "analytical"
    assert value.decides


@pytest.mark.parametrize(("name", "force", "mass", "clipped"), [
    ("restitution_linear", linear_force, MASS, False),
    ("restitution_linear_floor", linear_force, M_I, False),
    ("restitution_linear_clipped", linear_force, MASS, True),
    ("restitution_hertz", hertz_force(RADIUS, MASS), MASS, False),
    ("restitution_hertz_floor", hertz_force(R_I, M_I), M_I, False),
    ("restitution_hertz_clipped", hertz_force(RADIUS, MASS), MASS, True),
])
def test_integration_gives_the_same(name, force, mass, clipped):
    assert integrated(force, mass, clipped=clipped) == pytest.approx(published_values()[name].value, rel=2e-6)


def test_integration_along_plastic_branches_gives_the_same():
    largest = SPEED * math.sqrt(MASS / K_1)
    constant = ConstantUnloading(loading=K_1, unloading=K_2, adhesion=K_C, reduced_mass=MASS)
    assert by_parts(largest, constant) == pytest.approx(published_values()["restitution_hysteretic"].value, rel=1e-6)
    value = published_values()["restitution_hysteretic_variable"].value
    assert by_parts(largest, branches(largest)) == pytest.approx(value, rel=1e-6)


def test_impulse_of_coulombs_limit_gives_the_same():
    """Both centres gain mu times the normal impulse, 2 m* v_n, in opposite directions."""
    impulse = 0.31 * 2 * MASS * SPEED
    assert impulse / M_I + impulse / M_J == pytest.approx(published_values()["velocity_gained_by_sliding"].value)


JKR = JkrCollision(effective_modulus=MODULUS, effective_radius=RADIUS, reduced_mass=MASS, surface_energy=5.0)
LET_GO = (9 * math.pi * 5.0 * RADIUS**2 / (4 * MODULUS)) ** (1 / 3)
"""Contact radius of the largest pull."""


def left_with(rates, start: float, end: float) -> float:
    """Restitution of a motion whose first variable begins at touch and ends where the contact lets go."""
    def over(_, y):
        return y[0] - end

    over.terminal, over.direction = True, -1
    run = solve_ivp(rates, (0.0, 1.0), [start, SPEED], events=over, rtol=1e-11, atol=1e-17, max_step=2e-6)
    return -run.y[1, -1] / SPEED


def overlap_rates(_, y):
    radius = brentq(lambda a: JKR.overlap(a) - y[0], JKR.tearing_radius, 1e3 * JKR.touching_radius, xtol=1e-20)
    return [y[1], -(JKR.force(radius) + 0.1 * y[1]) / MASS]


def radius_rates(_, y):
    slope = 2 * y[0] / RADIUS - math.sqrt(math.pi * 5.0 / (MODULUS * y[0]))
    return [y[1] / slope, -(JKR.force(y[0]) + 0.1 * y[1]) / MASS]


def test_jkr_integrated_in_the_overlap_and_in_the_contact_radius():
    """There is no closed form with a dashpot: two integrations, in different variables."""
    value = published_values()["restitution_jkr"]
    assert left_with(radius_rates, JKR.touching_radius, LET_GO) == pytest.approx(value.value, rel=1e-9)
    assert left_with(overlap_rates, 0.0, JKR.overlap(LET_GO)) == pytest.approx(value.value, rel=1e-9)
    assert JKR.force(LET_GO) == pytest.approx(-JKR.pull_off_force, rel=1e-12)
    assert value.kind == "analytical"


def test_every_analytical_value_is_derived_here():
    analytical = {name for name, v in published_values().items() if v.kind == "analytical"}
    assert analytical == {*CLOSED_FORMS, "restitution_jkr"}


ANALYTICAL = """
[e]
quantity = "linear: restitution"
value = 0.5
unit = "-"
kind = "analytical"
origin = "somewhere"
date = "2007"
seen = true
conditions = "two bodies"
tolerance = 0.01
reason = "the time step"
"""


@pytest.mark.parametrize("line", ["tolerance = 0.01\n", 'reason = "the time step"\n', 'date = "2007"\n'])
def test_an_analytical_value_says_how_close_and_why(line):
    assert collect([ANALYTICAL])["e"].tolerance == 0.01
    with pytest.raises(ValueError, match="needs a tolerance"):
        collect([ANALYTICAL.replace(line, "")])
