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

import math
from collections.abc import Callable
from dataclasses import dataclass

from msgspec.structs import replace

from harness.scene.contact import (
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    LinearNormal,
    MindlinSliding,
    SpringRolling,
    SpringSliding,
    SpringTorsion,
    VariableHystereticNormal,
)
from harness.scene.grains import Grains
from harness.scene.laws import head_on, turning, word
from harness.scene.model import Background, Free, Scene

RESTITUTION, FRICTION, DYNAMIC, ROLLING, TORSION = 0.8, 0.5, 0.8, 0.1, 0.1
SHEAR_STIFFNESS, SHEAR_DAMPING = 0.2, 0.25
UNLOADING, ADHESION = 2.0, 0.2
DRAG, WEIGHT = 1e-3, 9.81

NEXT_TO_NOTHING = 1e-30
"""Of a coefficient: so small that it is lost in the rounding of whatever it is added to."""


class NotSwitched(Exception):
    """This effect cannot be switched this way in this scene; the message says why."""


@dataclass(frozen=True, kw_only=True)
class Turned:
    """A scene with one switch turned. says: what was written, with its numbers."""

    scene: Scene
    says: str


Turn = Callable[[Scene, Grains], Turned]


def fixed(why: str) -> Turn:
    """Return the turn that is never possible."""

    def refuse(_scene: Scene, _grains: Grains) -> Turned:
        raise NotSwitched(why)

    return refuse


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


# --- the normal law ----------------------------------------------------------------------------------


def damping_for(scene: Scene, grains: Grains) -> float:
    """Return gamma_n (kg/s) of restitution 0.8 of the mean pair under the law's largest stiffness."""
    pair = grains.pairs[min(1, len(grains.pairs) - 1)]
    log = math.log(RESTITUTION)
    beta = -log / math.hypot(math.pi, log)
    return 2.0 * beta * math.sqrt(head_on(scene.contact.normal, pair).stiffness * pair.reduced_mass)


def undamped(scene: Scene, _: Grains) -> Turned:
    """No dashpot."""
    if isinstance(scene.contact.normal, HertzNormal):
        return Turned(scene=_normal(scene, restitution=1.0), says="restitution = 1")
    return Turned(scene=_normal(scene, normal_damping=0.0), says="normal_damping = 0")


def damped(scene: Scene, grains: Grains) -> Turned:
    """A dashpot as declared in `damping_for`."""
    if isinstance(scene.contact.normal, HertzNormal):
        return Turned(scene=_normal(scene, restitution=RESTITUTION), says=f"restitution = {RESTITUTION:g}")
    gamma = _rounded(damping_for(scene, grains))
    return Turned(scene=_normal(scene, normal_damping=gamma), says=f"normal_damping = {gamma:g} kg/s")


def hardly_damped(scene: Scene, _: Grains) -> Turned:
    """A dashpot next to nothing."""
    law = scene.contact.normal
    if isinstance(law, HertzNormal):
        raise NotSwitched("the dashpot is told by the restitution, whose next number to 1 is 1e-16 off")
    gamma = NEXT_TO_NOTHING * law.normal_damping
    return Turned(scene=_normal(scene, normal_damping=gamma), says=f"normal_damping = {gamma:.3g} kg/s")


def clipped(scene: Scene, _: Grains) -> Turned:
    """The dashpot never pulls."""
    return Turned(scene=_attraction(scene, "clipped"), says='attraction = "clipped"')


def pulling(scene: Scene, grains: Grains) -> Turned:
    """The dashpot may pull."""
    if undamped(scene, grains).scene == scene:
        raise NotSwitched("without a dashpot nothing can pull")
    return Turned(scene=_attraction(scene, "allowed"), says='attraction = "allowed"')


def _attraction(scene: Scene, word_: str) -> Scene:
    if not isinstance(scene.contact.normal, LinearNormal | HertzNormal):
        raise NotSwitched(f'the law "{word(scene.contact.normal)}" does not clip')
    return _normal(scene, attraction=word_)


def loose(scene: Scene, _: Grains) -> Turned:
    """Without adhesion."""
    law = scene.contact.normal
    if isinstance(law, HystereticNormal | VariableHystereticNormal):
        return Turned(scene=_normal(scene, adhesion_stiffness=0.0), says="adhesion_stiffness = 0")
    if law.normal_damping:
        raise NotSwitched("without it the law is hertz, whose dashpot is another: nothing would be switched alone")
    same = {n: getattr(law, n) for n in ("youngs_modulus", "poisson_ratio", "impact_speed")}
    return Turned(
        scene=_law(scene, HertzNormal(**same, restitution=1.0, attraction="allowed")), says='law = "hertz"'
    )


def sticky(scene: Scene, grains: Grains) -> Turned:
    """With adhesion, as far as a law has it."""
    law = scene.contact.normal
    if isinstance(law, HertzNormal):
        return _dmt(scene, grains)
    base = plastic(scene, grains).scene if isinstance(law, LinearNormal) else scene
    k_c = ADHESION * base.contact.normal.loading_stiffness
    also = f"; {plastic(scene, grains).says}, as no law is adhesive on linear springs" if base is not scene else ""
    return Turned(scene=_normal(base, adhesion_stiffness=k_c), says=f"adhesion_stiffness = {k_c:g} N/m{also}")


def _dmt(scene: Scene, grains: Grains) -> Turned:
    """A pull-off force of a tenth of the force at the impact's largest overlap: 4 pi w R* = k delta/10."""
    law = scene.contact.normal
    if law.restitution < 1.0:
        raise NotSwitched("adhesive spheres are dmt, whose dashpot is another: nothing would be switched alone")
    pair = grains.pairs[0]
    met = head_on(law, pair)
    energy = _rounded(0.1 * (2.0 / 3.0) * met.stiffness * met.largest_overlap / (4 * math.pi * pair.reduced_radius))
    same = {n: getattr(law, n) for n in ("youngs_modulus", "poisson_ratio", "impact_speed")}
    return Turned(
        scene=_law(scene, DmtNormal(**same, normal_damping=0.0, surface_energy=energy)),
        says=f'law = "dmt", surface_energy = {energy:g} J/m^2',
    )


def hardly_sticky(scene: Scene, _: Grains) -> Turned:
    """Adhesion next to nothing."""
    name = "adhesion_stiffness" if hasattr(scene.contact.normal, "adhesion_stiffness") else "surface_energy"
    value = NEXT_TO_NOTHING * getattr(scene.contact.normal, name)
    return Turned(scene=_normal(scene, **{name: value}), says=f"{name} = {value:.3g}")


def forgetting(scene: Scene, _: Grains) -> Turned:
    """Linear springs of the stiffness with which the contact begins; adhesion goes too."""
    law = scene.contact.normal
    linear = LinearNormal(
        normal_stiffness=law.loading_stiffness, normal_damping=law.normal_damping, attraction="allowed"
    )
    return Turned(scene=_law(scene, linear), says=f'law = "linear", normal_stiffness = {law.loading_stiffness:g} N/m')


def plastic(scene: Scene, _: Grains) -> Turned:
    """Unloading stiffer than loading."""
    law = scene.contact.normal
    if not isinstance(law, LinearNormal):
        raise NotSwitched(f'no law is "{word(law)}" with a memory')
    k_2 = UNLOADING * law.normal_stiffness
    made = HystereticNormal(
        loading_stiffness=law.normal_stiffness, unloading_stiffness=k_2, adhesion_stiffness=0.0,
        normal_damping=law.normal_damping,
    )
    return Turned(scene=_law(scene, made), says=f'law = "hysteretic", unloading_stiffness = {k_2:g} N/m')


def elastic_memory(scene: Scene, _: Grains) -> Turned:
    """A memory of nothing: k_2 = k_1."""
    law = scene.contact.normal
    if not isinstance(law, HystereticNormal) or law.adhesion_stiffness:
        raise NotSwitched("only the law with one k_2 and without adhesion can have k_2 = k_1")
    k_1 = law.loading_stiffness
    return Turned(scene=_normal(scene, unloading_stiffness=k_1), says=f"unloading_stiffness = {k_1:g} N/m = k_1")


# --- what acts across the normal ---------------------------------------------------------------------


def smooth(scene: Scene, _: Grains) -> Turned:
    """Without the table sliding."""
    return Turned(scene=_consistent(_contact(scene, sliding=None)), says="no table contact.sliding")


def rubbing(scene: Scene, grains: Grains) -> Turned:
    """Friction of the shipped scenes."""
    law = scene.contact.normal
    if isinstance(law, HertzNormal):
        return Turned(
            scene=_contact(scene, sliding=MindlinSliding(shear_friction=FRICTION)), says=f"mindlin, mu = {FRICTION:g}"
        )
    k_t = _rounded(SHEAR_STIFFNESS * _stiffness(scene, grains))
    gamma_t = _rounded(SHEAR_DAMPING * law.normal_damping)
    made = SpringSliding(shear_friction=FRICTION, shear_stiffness=k_t, shear_damping=gamma_t)
    return Turned(scene=_contact(scene, sliding=made), says=f"mu = {FRICTION:g}, k_t = {k_t:g} N/m, "
                  f"gamma_t = {gamma_t:g} kg/s")


def frictionless(scene: Scene, _: Grains) -> Turned:
    """Friction with mu = 0, which the scene's rules refuse."""
    return Turned(
        scene=_contact(scene, sliding=_bare(scene.contact.sliding, shear_friction=0.0)), says="shear_friction = 0"
    )


def one_friction(scene: Scene, _: Grains) -> Turned:
    """One coefficient."""
    return Turned(
        scene=_contact(scene, sliding=replace(scene.contact.sliding, dynamic_friction=None)), says="no dynamic_friction"
    )


def two_frictions(scene: Scene, _: Grains) -> Turned:
    """A lower coefficient while sliding."""
    law = scene.contact.sliding
    if not isinstance(law, SpringSliding):
        raise NotSwitched("it belongs to a tangential spring, which this scene does not have")
    mu_d = _rounded(DYNAMIC * law.shear_friction)
    return Turned(
        scene=_contact(scene, sliding=replace(law, dynamic_friction=mu_d)), says=f"dynamic_friction = {mu_d:g}"
    )


def equal_frictions(scene: Scene, _: Grains) -> Turned:
    """mu_d = mu."""
    law = scene.contact.sliding
    return Turned(
        scene=_contact(scene, sliding=replace(law, dynamic_friction=law.shear_friction)), says="dynamic_friction = mu"
    )


def rolling_freely(scene: Scene, _: Grains) -> Turned:
    """Without the table rolling."""
    return Turned(scene=_consistent(_contact(scene, rolling=None)), says="no table contact.rolling")


def rolling_hardly(scene: Scene, grains: Grains) -> Turned:
    """A rolling spring as stiff as the tangential one."""
    k_r = _couple_stiffness(scene, grains)
    made = SpringRolling(rolling_friction=ROLLING, rolling_stiffness=k_r, rolling_damping=0.0)
    return Turned(scene=_contact(scene, rolling=made), says=f"mu_r = {ROLLING:g}, k_r = {k_r:g} N/m")


def rolling_zero(scene: Scene, _: Grains) -> Turned:
    """mu_r = 0, which the schema refuses."""
    return Turned(
        scene=_contact(scene, rolling=_bare(scene.contact.rolling, rolling_friction=0.0)), says="rolling_friction = 0"
    )


def twisting_freely(scene: Scene, _: Grains) -> Turned:
    """Without the table torsion."""
    return Turned(scene=_consistent(_contact(scene, torsion=None)), says="no table contact.torsion")


def twisting_hardly(scene: Scene, grains: Grains) -> Turned:
    """A torsion spring as stiff as the tangential one."""
    if scene.dimension == 2:
        raise NotSwitched("nothing twists in the plane")
    k_o = _couple_stiffness(scene, grains)
    made = SpringTorsion(torsion_friction=TORSION, torsion_stiffness=k_o, torsion_damping=0.0)
    return Turned(scene=_contact(scene, torsion=made), says=f"mu_o = {TORSION:g}, k_o = {k_o:g} N/m")


def twisting_zero(scene: Scene, _: Grains) -> Turned:
    """mu_o = 0, which the schema refuses."""
    return Turned(
        scene=_contact(scene, torsion=_bare(scene.contact.torsion, torsion_friction=0.0)), says="torsion_friction = 0"
    )


# --- walls and fields --------------------------------------------------------------------------------


def smooth_walls(scene: Scene, _: Grains) -> Turned:
    """No plane with friction."""
    return Turned(scene=_planes(scene, friction=False), says="friction = false at every plane")


def rough_walls(scene: Scene, _: Grains) -> Turned:
    """Every plane with the friction of the particles."""
    if not isinstance(scene, Free):
        raise NotSwitched("the walls of a box are smooth, those of a ring are glued discs: no number says otherwise")
    if not scene.planes:
        raise NotSwitched("there is no plane")
    if not turning(scene.contact):
        raise NotSwitched("at a rough plane the particles' own tangential laws act, and there are none")
    return Turned(scene=_planes(scene, friction=True), says="friction = true at every plane")


def no_drag(scene: Scene, _: Grains) -> Turned:
    """Without the table background."""
    return Turned(scene=replace(scene, background=None), says="no table background")


def dragged(scene: Scene, grains: Grains) -> Turned:
    """A drag that calms without ruling."""
    c = _rounded(DRAG * math.sqrt(_stiffness(scene, grains) * grains.mean_mass))
    return Turned(
        scene=replace(scene, background=Background(translational_drag=c)), says=f"translational_drag = {c:g} kg/s"
    )


def zero_drag(scene: Scene, _: Grains) -> Turned:
    """c = 0, which the schema refuses."""
    return Turned(scene=replace(scene, background=Background(translational_drag=0.0)), says="translational_drag = 0")


def weightless(scene: Scene, _: Grains) -> Turned:
    """Without gravity."""
    return Turned(scene=replace(scene, gravity=None), says="no gravity")


def heavy(scene: Scene, _: Grains) -> Turned:
    """Gravity along the last axis."""
    if not isinstance(scene, Free):
        raise NotSwitched("boxes and rings lie flat: no number says otherwise")
    down = (*[0.0] * (scene.dimension - 1), -WEIGHT)
    return Turned(scene=replace(scene, gravity=down), says=f"gravity = {WEIGHT:g} m/s^2 downwards")


def zero_gravity(scene: Scene, _: Grains) -> Turned:
    """g = 0, which the scene's rules refuse."""
    return Turned(scene=replace(scene, gravity=(0.0,) * scene.dimension), says="gravity = 0")


# --- helpers -----------------------------------------------------------------------------------------


def _normal(scene: Scene, **changes) -> Scene:
    return _law(scene, replace(scene.contact.normal, **changes))


def _law(scene: Scene, law) -> Scene:
    return _contact(scene, normal=law)


def _contact(scene: Scene, **changes) -> Scene:
    return replace(scene, contact=replace(scene.contact, **changes))


def _bare(law, **changes):
    """Return a law with numbers that its schema refuses: structs check what is read, not what is made."""
    return replace(law, **changes)


def _consistent(scene: Scene) -> Scene:
    """Take away what means nothing when no law turns particles any more: angles, and friction at planes."""
    if turning(scene.contact):
        return scene
    scene = replace(scene, outputs=replace(scene.outputs, rotations=False))
    return _planes(scene, friction=False) if isinstance(scene, Free) else scene


def _planes(scene: Free, **changes) -> Free:
    return replace(scene, planes=tuple(replace(p, **changes) for p in scene.planes))


def _stiffness(scene: Scene, grains: Grains) -> float:
    """Return the slope with which a contact begins where it is one, else the largest one, N/m."""
    law = scene.contact.normal
    return getattr(law, "loading_stiffness", None) or head_on(law, grains.pairs[0]).stiffness


def _couple_stiffness(scene: Scene, grains: Grains) -> float:
    sliding = scene.contact.sliding
    if isinstance(sliding, SpringSliding):
        return sliding.shear_stiffness
    return _rounded(SHEAR_STIFFNESS * _stiffness(scene, grains))


def _rounded(value: float) -> float:
    """Return the number with three digits: what is stated is what is run."""
    return float(f"{value:.3g}")


SETTING = "part of the experiment: without it another test is made"

_NO_ZERO = fixed("it is a yes or no, without a coefficient")
_OF_THE_TEST = Switch(off=fixed(SETTING), on=fixed(SETTING), zero=fixed(SETTING))

SWITCHES: dict[str, Switch] = {
    "normal contact": Switch(
        off=fixed("bodies would pass through each other"), on=fixed("always on"),
        zero=fixed("bodies would pass through each other"),
    ),
    "normal damping": Switch(off=undamped, on=damped, zero=hardly_damped, exact=False),
    "damping attraction": Switch(off=clipped, on=pulling, zero=_NO_ZERO),
    "adhesion": Switch(off=loose, on=sticky, zero=hardly_sticky, exact=False),
    "plastic memory": Switch(off=forgetting, on=plastic, zero=elastic_memory),
    "sliding friction": Switch(off=smooth, on=rubbing, zero=frictionless),
    "dynamic friction": Switch(off=one_friction, on=two_frictions, zero=equal_frictions),
    "rolling resistance": Switch(off=rolling_freely, on=rolling_hardly, zero=rolling_zero),
    "torsion resistance": Switch(off=twisting_freely, on=twisting_hardly, zero=twisting_zero),
    "wall friction": Switch(
        off=smooth_walls, on=rough_walls, zero=fixed("it has no coefficient of its own: that of the particles acts"),
    ),
    "rotation": Switch(
        off=fixed("it comes and goes with the laws that turn particles"),
        on=fixed("it comes and goes with the laws that turn particles"),
        zero=fixed("it has no coefficient: it comes and goes with the laws that turn particles"),
    ),
    "background drag": Switch(off=no_drag, on=dragged, zero=zero_drag),
    "gravity": Switch(off=weightless, on=heavy, zero=zero_gravity),
    "periodic axes": _OF_THE_TEST,
    "driven walls": _OF_THE_TEST,
    "loaded walls": _OF_THE_TEST,
    "glued rings": _OF_THE_TEST,
}
"""One row an effect of `harness.scene.effects.EFFECTS`."""
