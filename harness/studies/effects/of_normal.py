"""Switches of the normal law: dashpot, attraction, adhesion, memory. Each returns the scene and what was written."""

from __future__ import annotations

import math

from harness.scene.contact import (
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    LinearNormal,
    VariableHystereticNormal,
)
from harness.scene.grains import Grains
from harness.scene.laws import head_on, word
from harness.scene.model import Scene
from harness.studies.effects.turned import NotSwitched, Turned, rounded, with_law, with_normal

RESTITUTION, UNLOADING, ADHESION = 0.8, 2.0, 0.2

NEXT_TO_NOTHING = 1e-30
"""Of a coefficient: so small that it is lost in the rounding of whatever it is added to."""


def damping_for(scene: Scene, grains: Grains) -> float:
    """Return gamma_n (kg/s) of restitution 0.8 of the mean pair under the law's largest stiffness."""
    pair = grains.pairs[min(1, len(grains.pairs) - 1)]
    log = math.log(RESTITUTION)
    beta = -log / math.hypot(math.pi, log)
    return 2.0 * beta * math.sqrt(head_on(scene.contact.normal, pair).stiffness * pair.reduced_mass)


def undamped(scene: Scene, _: Grains) -> Turned:
    """No dashpot."""
    if isinstance(scene.contact.normal, HertzNormal):
        return Turned(scene=with_normal(scene, restitution=1.0), says="restitution = 1")
    return Turned(scene=with_normal(scene, normal_damping=0.0), says="normal_damping = 0")


def damped(scene: Scene, grains: Grains) -> Turned:
    """A dashpot as declared in `damping_for`."""
    if isinstance(scene.contact.normal, HertzNormal):
        return Turned(scene=with_normal(scene, restitution=RESTITUTION), says=f"restitution = {RESTITUTION:g}")
    gamma = rounded(damping_for(scene, grains))
    return Turned(scene=with_normal(scene, normal_damping=gamma), says=f"normal_damping = {gamma:g} kg/s")


def hardly_damped(scene: Scene, _: Grains) -> Turned:
    """A dashpot next to nothing."""
    law = scene.contact.normal
    if isinstance(law, HertzNormal):
        raise NotSwitched("the dashpot is told by the restitution, whose next number to 1 is 1e-16 off")
    gamma = NEXT_TO_NOTHING * law.normal_damping
    return Turned(scene=with_normal(scene, normal_damping=gamma), says=f"normal_damping = {gamma:.3g} kg/s")


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
    return with_normal(scene, attraction=word_)


def loose(scene: Scene, _: Grains) -> Turned:
    """Without adhesion."""
    law = scene.contact.normal
    if isinstance(law, HystereticNormal | VariableHystereticNormal):
        return Turned(scene=with_normal(scene, adhesion_stiffness=0.0), says="adhesion_stiffness = 0")
    if law.normal_damping:
        raise NotSwitched("without it the law is hertz, whose dashpot is another: nothing would be switched alone")
    same = {n: getattr(law, n) for n in ("youngs_modulus", "poisson_ratio", "impact_speed")}
    return Turned(
        scene=with_law(scene, HertzNormal(**same, restitution=1.0, attraction="allowed")), says='law = "hertz"'
    )


def sticky(scene: Scene, grains: Grains) -> Turned:
    """With adhesion, as far as a law has it."""
    law = scene.contact.normal
    if isinstance(law, HertzNormal):
        return _dmt(scene, grains)
    base = plastic(scene, grains).scene if isinstance(law, LinearNormal) else scene
    k_c = ADHESION * base.contact.normal.loading_stiffness
    also = f"; {plastic(scene, grains).says}, as no law is adhesive on linear springs" if base is not scene else ""
    return Turned(scene=with_normal(base, adhesion_stiffness=k_c), says=f"adhesion_stiffness = {k_c:g} N/m{also}")


def _dmt(scene: Scene, grains: Grains) -> Turned:
    """A pull-off force of a tenth of the force at the impact's largest overlap: 4 pi w R* = k delta/10."""
    law = scene.contact.normal
    if law.restitution < 1.0:
        raise NotSwitched("adhesive spheres are dmt, whose dashpot is another: nothing would be switched alone")
    pair = grains.pairs[0]
    met = head_on(law, pair)
    energy = rounded(0.1 * (2.0 / 3.0) * met.stiffness * met.largest_overlap / (4 * math.pi * pair.reduced_radius))
    same = {n: getattr(law, n) for n in ("youngs_modulus", "poisson_ratio", "impact_speed")}
    return Turned(
        scene=with_law(scene, DmtNormal(**same, normal_damping=0.0, surface_energy=energy)),
        says=f'law = "dmt", surface_energy = {energy:g} J/m^2',
    )


def hardly_sticky(scene: Scene, _: Grains) -> Turned:
    """Adhesion next to nothing."""
    name = "adhesion_stiffness" if hasattr(scene.contact.normal, "adhesion_stiffness") else "surface_energy"
    value = NEXT_TO_NOTHING * getattr(scene.contact.normal, name)
    return Turned(scene=with_normal(scene, **{name: value}), says=f"{name} = {value:.3g}")


def forgetting(scene: Scene, _: Grains) -> Turned:
    """Linear springs of the stiffness with which the contact begins; adhesion goes too."""
    law = scene.contact.normal
    linear = LinearNormal(
        normal_stiffness=law.loading_stiffness, normal_damping=law.normal_damping, attraction="allowed"
    )
    says = f'law = "linear", normal_stiffness = {law.loading_stiffness:g} N/m'
    return Turned(scene=with_law(scene, linear), says=says)


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
    return Turned(scene=with_law(scene, made), says=f'law = "hysteretic", unloading_stiffness = {k_2:g} N/m')


def elastic_memory(scene: Scene, _: Grains) -> Turned:
    """A memory of nothing: k_2 = k_1."""
    law = scene.contact.normal
    if not isinstance(law, HystereticNormal) or law.adhesion_stiffness:
        raise NotSwitched("only the law with one k_2 and without adhesion can have k_2 = k_1")
    k_1 = law.loading_stiffness
    return Turned(scene=with_normal(scene, unloading_stiffness=k_1), says=f"unloading_stiffness = {k_1:g} N/m = k_1")
