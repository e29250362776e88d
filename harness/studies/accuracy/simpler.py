"""Simpler contact laws in place of a scene's own: what a user might take to save time, one step simpler each.

They are words, not numbers: nothing tends to a limit, so errors are told against the laws as declared.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

from harness.scene.contact import (
    Contact,
    HertzNormal,
    HystereticNormal,
    LinearNormal,
    MindlinSliding,
    SpringSliding,
    VariableHystereticNormal,
    ViscousSliding,
)
from harness.scene.grains import Pair
from harness.scene.laws import first_stiffness, head_on
from harness.studies.accuracy.turn import replaced

DECLARED = "as declared"


class Simpler(NamedTuple):
    """Laws under a name."""

    name: str
    contact: Contact


def simpler_laws(contact: Contact, pair: Pair) -> tuple[Simpler, ...]:
    """Return the laws as declared, and every step that makes them simpler. pair: for which contact times are equal."""
    return (Simpler(DECLARED, contact), *(s for step in STEPS for s in step(contact, pair)))


def _linear(contact: Contact, pair: Pair) -> Iterator[Simpler]:
    """Hertz as a linear spring: contact time of an impact at `impact_speed`, and restitution, are kept.

    t_c = pi/sqrt(k/m* - b^2), e = exp(-b t_c), so that k = m* (pi^2 + ln^2 e)/t_c^2 and gamma = -2 m* ln e/t_c.
    Mindlin's sliding becomes a spring of k_t/k_n = 2 (1 - nu)/(2 - nu), its dashpot with the root of that.
    """
    normal = contact.normal
    if not isinstance(normal, HertzNormal):
        return
    time, loss = head_on(normal, pair).time_scale, -math.log(normal.restitution)
    k = pair.reduced_mass * (math.pi**2 + loss**2) / time**2
    linear = LinearNormal(
        normal_stiffness=k, normal_damping=2.0 * pair.reduced_mass * loss / time, attraction=normal.attraction
    )
    sliding = contact.sliding
    if isinstance(sliding, MindlinSliding):
        ratio = 2.0 * (1.0 - normal.poisson_ratio) / (2.0 - normal.poisson_ratio)
        sliding = SpringSliding(
            shear_friction=sliding.shear_friction, shear_stiffness=ratio * k,
            shear_damping=math.sqrt(ratio) * linear.normal_damping,
        )
    yield Simpler("linear springs", replaced(contact, normal=linear, sliding=sliding))


def _elastic(contact: Contact, _: Pair) -> Iterator[Simpler]:
    """No hysteresis and no adhesion: the spring of first loading, in which packings are in balance."""
    normal = contact.normal
    if isinstance(normal, HystereticNormal | VariableHystereticNormal):
        linear = LinearNormal(
            normal_stiffness=first_stiffness(normal), normal_damping=normal.normal_damping, attraction="allowed"
        )
        yield Simpler("no hysteresis", replaced(contact, normal=linear))


def _viscous(contact: Contact, _: Pair) -> Iterator[Simpler]:
    """Sliding without history: the spring left out, its dashpot kept (the normal one where it has none)."""
    sliding = contact.sliding
    if isinstance(sliding, SpringSliding) and sliding.shear_friction > 0.0:
        dashpot = sliding.shear_damping or getattr(contact.normal, "normal_damping", 0.0)
        if dashpot > 0.0:
            viscous = ViscousSliding(shear_friction=sliding.shear_friction, shear_damping=dashpot)
            yield Simpler("viscous sliding", replaced(contact, sliding=viscous))


def _without(name: str) -> Callable[[Contact, Pair], Iterator[Simpler]]:
    def step(contact: Contact, _: Pair) -> Iterator[Simpler]:
        if getattr(contact, name) is not None:
            yield Simpler(f"no {name}", replaced(contact, **{name: None}))

    return step


STEPS = (_linear, _elastic, _viscous, _without("rolling"), _without("torsion"), _without("sliding"))
"""From a contact to simpler ones, none where it is that simple already."""
