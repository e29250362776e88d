"""Switches of what acts across the normal: sliding, rolling, torsion. Each returns the scene and what was written.

Numbers that a schema refuses can be told all the same: structs check what is read, not what is made.
"""

from __future__ import annotations

from msgspec.structs import replace

from harness.scene.contact import HertzNormal, MindlinSliding, SpringRolling, SpringSliding, SpringTorsion
from harness.scene.grains import Grains
from harness.scene.model import Scene
from harness.studies.effects.turned import (
    SHEAR_STIFFNESS,
    NotSwitched,
    Turned,
    consistent,
    couple_stiffness,
    rounded,
    stiffness_of,
    with_contact,
)

FRICTION, DYNAMIC, ROLLING, TORSION, SHEAR_DAMPING = 0.5, 0.8, 0.1, 0.1, 0.25


def smooth(scene: Scene, _: Grains) -> Turned:
    """Without the table sliding."""
    return Turned(scene=consistent(with_contact(scene, sliding=None)), says="no table contact.sliding")


def rubbing(scene: Scene, grains: Grains) -> Turned:
    """Friction of the shipped scenes."""
    law = scene.contact.normal
    if isinstance(law, HertzNormal):
        made = MindlinSliding(shear_friction=FRICTION)
        return Turned(scene=with_contact(scene, sliding=made), says=f"mindlin, mu = {FRICTION:g}")
    k_t = rounded(SHEAR_STIFFNESS * stiffness_of(scene, grains))
    gamma_t = rounded(SHEAR_DAMPING * law.normal_damping)
    made = SpringSliding(shear_friction=FRICTION, shear_stiffness=k_t, shear_damping=gamma_t)
    return Turned(scene=with_contact(scene, sliding=made), says=f"mu = {FRICTION:g}, k_t = {k_t:g} N/m, "
                  f"gamma_t = {gamma_t:g} kg/s")


def frictionless(scene: Scene, _: Grains) -> Turned:
    """Friction with mu = 0, which the scene's rules refuse."""
    return Turned(
        scene=with_contact(scene, sliding=replace(scene.contact.sliding, shear_friction=0.0)), says="shear_friction = 0"
    )


def one_friction(scene: Scene, _: Grains) -> Turned:
    """One coefficient."""
    made = replace(scene.contact.sliding, dynamic_friction=None)
    return Turned(scene=with_contact(scene, sliding=made), says="no dynamic_friction")


def two_frictions(scene: Scene, _: Grains) -> Turned:
    """A lower coefficient while sliding."""
    law = scene.contact.sliding
    if not isinstance(law, SpringSliding):
        raise NotSwitched("it belongs to a tangential spring, which this scene does not have")
    mu_d = rounded(DYNAMIC * law.shear_friction)
    return Turned(
        scene=with_contact(scene, sliding=replace(law, dynamic_friction=mu_d)), says=f"dynamic_friction = {mu_d:g}"
    )


def equal_frictions(scene: Scene, _: Grains) -> Turned:
    """mu_d = mu."""
    law = scene.contact.sliding
    made = replace(law, dynamic_friction=law.shear_friction)
    return Turned(scene=with_contact(scene, sliding=made), says="dynamic_friction = mu")


def rolling_freely(scene: Scene, _: Grains) -> Turned:
    """Without the table rolling."""
    return Turned(scene=consistent(with_contact(scene, rolling=None)), says="no table contact.rolling")


def rolling_hardly(scene: Scene, grains: Grains) -> Turned:
    """A rolling spring as stiff as the tangential one."""
    k_r = couple_stiffness(scene, grains)
    made = SpringRolling(rolling_friction=ROLLING, rolling_stiffness=k_r, rolling_damping=0.0)
    return Turned(scene=with_contact(scene, rolling=made), says=f"mu_r = {ROLLING:g}, k_r = {k_r:g} N/m")


def rolling_zero(scene: Scene, _: Grains) -> Turned:
    """mu_r = 0, which the schema refuses."""
    made = replace(scene.contact.rolling, rolling_friction=0.0)
    return Turned(scene=with_contact(scene, rolling=made), says="rolling_friction = 0")


def twisting_freely(scene: Scene, _: Grains) -> Turned:
    """Without the table torsion."""
    return Turned(scene=consistent(with_contact(scene, torsion=None)), says="no table contact.torsion")


def twisting_hardly(scene: Scene, grains: Grains) -> Turned:
    """A torsion spring as stiff as the tangential one."""
    if scene.dimension == 2:
        raise NotSwitched("nothing twists in the plane")
    k_o = couple_stiffness(scene, grains)
    made = SpringTorsion(torsion_friction=TORSION, torsion_stiffness=k_o, torsion_damping=0.0)
    return Turned(scene=with_contact(scene, torsion=made), says=f"mu_o = {TORSION:g}, k_o = {k_o:g} N/m")


def twisting_zero(scene: Scene, _: Grains) -> Turned:
    """mu_o = 0, which the schema refuses."""
    made = replace(scene.contact.torsion, torsion_friction=0.0)
    return Turned(scene=with_contact(scene, torsion=made), says="torsion_friction = 0")
