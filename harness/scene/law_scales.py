"""What a normal law does to one pair that meets head-on, as far as closed forms go: one function a law.

The formulas stand in `reference.analytic`; here the scene's parameters meet them. What no closed form
gives is a fact without a value and with the reason. `harness.scene.laws` lists the functions.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from harness.scene.contact import (
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    JkrNormal,
    LinearNormal,
    VariableHystereticNormal,
)
from harness.scene.grains import Pair
from reference.analytic.adhesive_collision import DmtCollision, JkrCollision
from reference.analytic.hertz_collision import (
    HertzCollision,
    damping_factor_for_restitution,
    effective_modulus,
    hertz_stiffness,
)
from reference.analytic.hysteretic_collision import ConstantUnloading, OverlapUnloading
from reference.analytic.linear_collision import LinearCollision

DAMPED = "no closed form with normal_damping"

STUCK = 1e-12
"""Of the energy brought in: less is round-off, and the bodies stick."""


@dataclass(frozen=True, kw_only=True)
class Fact:
    """One derived number with its unit and formula; value None: not available, and `note` says why."""

    name: str
    value: float | None
    unit: str = ""
    note: str = ""


@dataclass(frozen=True, kw_only=True)
class HeadOn:
    """A pair that meets head-on.

    time_scale: s, what the time step is a fraction of, with its name and formula. stiffness, damping: the
    largest slope of the force (N/m) and dashpot (kg/s) that the contact shows. largest_overlap: m, that
    these are taken at; None where they do not depend on it. facts: what else closed forms say.
    """

    time_scale: float
    time_name: str
    time_note: str
    stiffness: float
    damping: float
    largest_overlap: float | None = None
    facts: tuple[Fact, ...] = ()

    def fact(self, name: str) -> Fact:
        """Return a fact by its name."""
        return next(f for f in self.facts if f.name == name)


def linear(law: LinearNormal, pair: Pair) -> HeadOn:
    """Spring and dashpot: `reference.analytic.linear_collision`."""
    oscillator = LinearCollision(
        stiffness=law.normal_stiffness, damping=law.normal_damping, reduced_mass=pair.reduced_mass
    )
    time, note = _half_period(oscillator, "k")
    return HeadOn(
        time_scale=time, time_name="contact time", time_note=note, stiffness=law.normal_stiffness,
        damping=law.normal_damping, facts=(_damping_ratio(oscillator), *_restitutions(law, oscillator)),
    )


def hertz(law: HertzNormal, pair: Pair) -> HeadOn:
    """Elastic spheres with the dashpot of constant restitution: `reference.analytic.hertz_collision`."""
    collision = HertzCollision(
        stiffness=_hertz_stiffness(law, pair), reduced_mass=pair.reduced_mass,
        damping_factor=damping_factor_for_restitution(law.restitution),
    )
    overlap = collision.largest_overlap(law.impact_speed)
    rate = collision.damping_factor * math.sqrt(collision.stiffness * pair.reduced_mass)
    clipped = ", with attraction allowed" if law.attraction == "clipped" else ""
    return HeadOn(
        time_scale=collision.duration(law.impact_speed), time_name="contact time",
        time_note=f"at impact_speed{clipped}; it falls with the speed to the power 1/5",
        stiffness=1.5 * collision.stiffness * math.sqrt(overlap), damping=rate * overlap**0.25,
        largest_overlap=overlap,
        facts=(*_impact(overlap, collision.stiffness * overlap**1.5), *_restitutions(law, collision.oscillator)),
    )


def hysteretic(law: HystereticNormal, pair: Pair) -> HeadOn:
    """Constant k_2: `reference.analytic.hysteretic_collision.ConstantUnloading`."""
    branches = ConstantUnloading(
        loading=law.loading_stiffness, unloading=law.unloading_stiffness, adhesion=law.adhesion_stiffness,
        reduced_mass=pair.reduced_mass,
    )
    time, note = _half_period(_oscillator(law.unloading_stiffness, law.normal_damping, pair), "k_2")
    return HeadOn(
        time_scale=time, time_name="time scale", time_note=note, stiffness=law.unloading_stiffness,
        damping=law.normal_damping, facts=tuple(_hysteretic_facts(law, branches)),
    )


def hysteretic_variable(law: VariableHystereticNormal, pair: Pair) -> HeadOn:
    """k_2 grows with the overlap: `reference.analytic.hysteretic_collision.OverlapUnloading`."""
    collision = OverlapUnloading(
        loading=law.loading_stiffness, limit=law.largest_unloading_stiffness, adhesion=law.adhesion_stiffness,
        plasticity_depth=law.plasticity_depth, pair_radius=2 * pair.reduced_radius, reduced_mass=pair.reduced_mass,
    )
    time, note = _half_period(_oscillator(law.largest_unloading_stiffness, law.normal_damping, pair), "k_p")
    return HeadOn(
        time_scale=time, time_name="time scale", time_note=note, stiffness=law.largest_unloading_stiffness,
        damping=law.normal_damping, facts=tuple(_variable_facts(law, collision)),
    )


def dmt(law: DmtNormal, pair: Pair) -> HeadOn:
    """Hertz with a constant attraction: `reference.analytic.adhesive_collision.DmtCollision`."""
    collision = DmtCollision(**_adhesive(law, pair))
    overlap = collision.largest_overlap(law.impact_speed)
    elastic = Fact(name="restitution", value=1.0, note="elastic: the attraction gives back what it took")
    return _adhesive_head_on(
        law, pair, overlap=overlap, stiffness=collision.stiffness(overlap),
        facts=(
            _pull_off(collision.pull_off_force, "4 pi w R*"),
            elastic if not law.normal_damping else Fact(name="restitution", value=None, note=DAMPED),
        ),
    )


def jkr(law: JkrNormal, pair: Pair) -> HeadOn:
    """Hertz with attraction inside the contact: `reference.analytic.adhesive_collision.JkrCollision`."""
    collision = JkrCollision(**_adhesive(law, pair))
    radius = collision.largest_radius(law.impact_speed)
    return _adhesive_head_on(
        law, pair, overlap=collision.overlap(radius), stiffness=collision.stiffness(radius),
        facts=(
            _pull_off(collision.pull_off_force, "3 pi w R*"),
            Fact(name="tearing overlap", value=collision.tearing_overlap, unit="m",
                 note="-3 a_c^2/R*, a_c^3 = pi w R*^2/(4 E*): there the surfaces part"),
            *_jkr_losses(law, collision),
        ),
    )


# --- shared by laws --------------------------------------------------------------------------


def _oscillator(stiffness: float, damping: float, pair: Pair) -> LinearCollision:
    return LinearCollision(stiffness=stiffness, damping=damping, reduced_mass=pair.reduced_mass)


def _half_period(oscillator: LinearCollision, k: str) -> tuple[float, str]:
    """Return pi/sqrt(k/m* - b^2) and its formula; of an overdamped pair, which has no such time, pi/sqrt(k/m*)."""
    if not oscillator.overdamped:
        return math.pi / oscillator.frequency, f"pi/sqrt({k}/m* - b^2)"
    ratio = f"b/omega_0 = {oscillator.damping_ratio:.3g}"
    return math.pi / oscillator.natural_frequency, (
        f"pi/sqrt({k}/m*), as the pair is overdamped ({ratio}): no contact time"
    )


def _damping_ratio(oscillator: LinearCollision) -> Fact:
    return Fact(name="damping ratio", value=oscillator.damping_ratio, note="b/omega_0; 1 is critical")


def _restitutions(law: LinearNormal | HertzNormal, oscillator: LinearCollision) -> Iterator[Fact]:
    for cutoff in ("allowed", "clipped"):
        note = "as in the scene" if cutoff == law.attraction else "for comparison"
        yield Fact(name=f"restitution, attraction {cutoff}", value=oscillator.restitution(cutoff), note=note)


def _impact(overlap: float, force: float) -> tuple[Fact, ...]:
    return (
        Fact(name="largest overlap", value=overlap, unit="m", note="at impact_speed"),
        Fact(name="elastic force there", value=force, unit="N", note="4/3 E* sqrt(R*) delta^(3/2)"),
    )


def _hysteretic_facts(law: HystereticNormal, branches: ConstantUnloading) -> Iterator[Fact]:
    sticking = branches.sticking_adhesion
    if law.normal_damping:
        yield Fact(name="contact time", value=None, note=DAMPED)
        yield Fact(name="restitution", value=None, note=DAMPED)
    elif branches.restitution_squared < STUCK:
        yield Fact(name="contact time", value=None, note="the bodies stick")
        yield Fact(name="restitution", value=0.0, note="the bodies stick")
    else:
        yield Fact(name="contact time", value=branches.duration, unit="s", note="at any speed")
        note = "e^2 = k_1/k_2 - (k_c/k_1) (k_2 - k_1)^2/(k_2 (k_2 + k_c)), at any speed"
        yield Fact(name="restitution", value=branches.restitution, note=note)
    if math.isfinite(sticking):
        note = "k_1^2/(k_2 - 2 k_1), without damping"
        yield Fact(name="least k_c that sticks", value=sticking, unit="N/m", note=note)
    else:
        yield Fact(name="least k_c that sticks", value=None, note="no k_c does, as k_2 <= 2 k_1")


def _variable_facts(law: VariableHystereticNormal, collision: OverlapUnloading) -> Iterator[Fact]:
    yield Fact(name="plastic limit delta_max*", value=collision.limit_overlap, unit="m",
               note="k_p/(k_p - k_1) phi_f 2 a_i a_j/(a_i + a_j)")
    if law.normal_damping:
        yield Fact(name="restitution", value=None, note=DAMPED)
        return
    speed = collision.limit_speed
    yield Fact(name="speed that reaches it", value=speed, unit="m/s", note="delta_max* sqrt(k_1/m*)")
    yield Fact(name="restitution", value=collision.restitution(speed), note="at that speed; it depends on the speed")
    for name, stuck in zip(("lowest", "highest"), collision.sticking_speeds or (), strict=False):
        yield Fact(name=f"{name} speed that sticks", value=stuck, unit="m/s")


def _effective_modulus(law: HertzNormal | DmtNormal | JkrNormal) -> float:
    return effective_modulus(young=(law.youngs_modulus,) * 2, poisson=(law.poisson_ratio,) * 2)


def _hertz_stiffness(law: HertzNormal | DmtNormal | JkrNormal, pair: Pair) -> float:
    return hertz_stiffness(effective_modulus=_effective_modulus(law), effective_radius=pair.reduced_radius)


def _adhesive(law: DmtNormal | JkrNormal, pair: Pair) -> dict[str, float]:
    return {
        "effective_modulus": _effective_modulus(law), "effective_radius": pair.reduced_radius,
        "reduced_mass": pair.reduced_mass, "surface_energy": law.surface_energy,
    }


def _adhesive_head_on(
    law: DmtNormal | JkrNormal, pair: Pair, *, overlap: float, stiffness: float, facts: tuple[Fact, ...]
) -> HeadOn:
    """Take the contact time of the Hertz impact that is as deep: an adhesive one has no closed form."""
    k = _hertz_stiffness(law, pair)
    bare = HertzCollision(stiffness=k, reduced_mass=pair.reduced_mass)
    speed = math.sqrt(0.8 * k * overlap**2.5 / pair.reduced_mass)
    return HeadOn(
        time_scale=bare.duration(speed), time_name="time scale",
        time_note="contact time of a Hertz impact as deep as the adhesive one at impact_speed",
        stiffness=stiffness, damping=law.normal_damping, largest_overlap=overlap,
        facts=(Fact(name="largest overlap", value=overlap, unit="m", note="at impact_speed, without damping"), *facts),
    )


def _pull_off(force: float, formula: str) -> Fact:
    return Fact(name="pull-off force", value=force, unit="N", note=formula)


def _jkr_losses(law: JkrNormal, collision: JkrCollision) -> Iterator[Fact]:
    if law.normal_damping:
        yield Fact(name="restitution", value=None, note=DAMPED)
        return
    yield Fact(name="restitution", value=collision.restitution(law.impact_speed),
               note="at impact_speed; e^2 = 1 - (v_s/v)^2 (Thornton & Ning 1998)")
    yield Fact(name="sticking speed", value=collision.sticking_speed, unit="m/s", note="v_s: slower bodies stick")
