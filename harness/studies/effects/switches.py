"""Every effect with its switch: the scene without it, the scene with it, and the scene with it at coefficient zero.

A switch changes one thing. What goes with it (the spring of a law that is gone, a dashpot that another law does not
clip) follows from the scene that comes out, which is asked again for its effects. Coefficients of an effect that the
scene does not have are stated; they follow from the scene's own numbers::

    normal damping      of restitution e = 0.8 for the mean pair: gamma = 2 beta sqrt(k m*),
                        beta = -ln e/sqrt(pi^2 + ln^2 e)
    sliding friction    mu = 0.5, k_t = k_n/5, gamma_t = gamma_n/4 (with hertz Mindlin's spring)
    dynamic friction    mu_d = 0.8 mu
    rolling, torsion    mu_r = 0.1, k_r = k_t, no dashpot
    plastic memory      k_2 = 2 k_1, with adhesion k_c = k_1/5
    background drag     c = sqrt(k m)/1000, k the stiffest contact, m the mean mass
    gravity             9.81 m/s^2 downwards

(restitution of spring and dashpot: e.g. S. Luding, Granular Matter 10, 235 (2008), eq. 4).
"""

from __future__ import annotations

from dataclasses import dataclass

from harness.studies.effects import of_fields as fields
from harness.studies.effects import of_normal as normal
from harness.studies.effects import of_tangent as tangent
from harness.studies.effects.turned import Turn, fixed


@dataclass(frozen=True, kw_only=True)
class Switch:
    """off, on: see `Turned`; they raise NotSwitched. zero: the scene that has the effect with its coefficient at zero.

    exact: zero says 0 where the scene's rules would have the table removed, or means it by equal numbers; else it says
    NEXT_TO_NOTHING, as 0 is how the scene writes "off".
    """

    off: Turn
    on: Turn
    zero: Turn
    exact: bool = True


_NO_ZERO = fixed("it is a yes or no, without a coefficient")
_SETTING = fixed("part of the experiment: without it another test is made")
_OF_THE_TEST = Switch(off=_SETTING, on=_SETTING, zero=_SETTING)
_FOLLOWS = fixed("it has no number of its own: it comes and goes with the laws that turn particles")

SWITCHES: dict[str, Switch] = {
    "normal contact": Switch(
        off=fixed("bodies would pass through each other"), on=fixed("always on"),
        zero=fixed("bodies would pass through each other"),
    ),
    "materials": _OF_THE_TEST,
    "normal damping": Switch(off=normal.undamped, on=normal.damped, zero=normal.hardly_damped, exact=False),
    "damping attraction": Switch(off=normal.clipped, on=normal.pulling, zero=_NO_ZERO),
    "adhesion": Switch(off=normal.loose, on=normal.sticky, zero=normal.hardly_sticky, exact=False),
    "plastic memory": Switch(off=normal.forgetting, on=normal.plastic, zero=normal.elastic_memory),
    "sliding friction": Switch(off=tangent.smooth, on=tangent.rubbing, zero=tangent.frictionless),
    "dynamic friction": Switch(off=tangent.one_friction, on=tangent.two_frictions, zero=tangent.equal_frictions),
    "rolling resistance": Switch(off=tangent.rolling_freely, on=tangent.rolling_hardly, zero=tangent.rolling_zero),
    "torsion resistance": Switch(
        off=tangent.twisting_freely, on=tangent.twisting_hardly, zero=tangent.twisting_zero
    ),
    "wall friction": Switch(
        off=fields.smooth_walls, on=fields.rough_walls,
        zero=fixed("it has no coefficient of its own: that of the particles acts"),
    ),
    "rotation": Switch(off=_FOLLOWS, on=_FOLLOWS, zero=_FOLLOWS),
    "background drag": Switch(off=fields.no_drag, on=fields.dragged, zero=fields.zero_drag),
    "gravity": Switch(off=fields.weightless, on=fields.heavy, zero=fields.zero_gravity),
    "periodic axes": _OF_THE_TEST,
    "driven walls": _OF_THE_TEST,
    "loaded walls": _OF_THE_TEST,
    "glued rings": _OF_THE_TEST,
}
"""One row an effect of `harness.scene.effects.EFFECTS`."""
