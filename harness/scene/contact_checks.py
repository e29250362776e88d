"""What the contact laws of a scene must obey together, in any kind of scene."""

from __future__ import annotations

from collections.abc import Iterator

from harness.scene.contact import (
    HertzNormal,
    HystereticNormal,
    MindlinSliding,
    SpringSliding,
    VariableHystereticNormal,
)
from harness.scene.fault import Fault
from harness.scene.laws import turning, word
from harness.scene.model import Scene


def sliding_is_on(scene: Scene) -> Iterator[Fault]:
    """Friction zero is no friction: then the table must go, and with it history and torques."""
    sliding = scene.contact.sliding
    if sliding is not None and sliding.shear_friction == 0:
        yield Fault(
            place="contact.sliding.shear_friction", expected="a number > 0", got="0",
            fix="remove the table contact.sliding: an effect that is off does not exist",
        )


def rotations_can_be_followed(scene: Scene) -> Iterator[Fault]:
    """An angle turned since the start exists in 2D, and changes only where a law turns something."""
    if not scene.outputs.rotations:
        return
    if scene.dimension == 3:
        yield Fault(place="outputs.rotations", expected="false in 3D, where no single angle exists", got="true")
    if not turning(scene.contact):
        yield Fault(
            place="outputs.rotations", got="true", fix="remove it",
            expected="false without contact.sliding or contact.rolling, as nothing turns the particles",
        )


def hysteresis_dissipates(scene: Scene) -> Iterator[Fault]:
    """Unloading may not be softer than loading: the contact would give back more than it took."""
    law = scene.contact.normal
    k1 = "contact.normal.loading_stiffness"
    if isinstance(law, HystereticNormal) and law.unloading_stiffness < law.loading_stiffness:
        yield Fault(
            place="contact.normal.unloading_stiffness", got=f"{law.unloading_stiffness:g}",
            expected=f"a number >= {k1} = {law.loading_stiffness:g}",
            fix="k_2 < k_1 would make energy",
        )
    if isinstance(law, VariableHystereticNormal) and law.largest_unloading_stiffness <= law.loading_stiffness:
        yield Fault(
            place="contact.normal.largest_unloading_stiffness", got=f"{law.largest_unloading_stiffness:g}",
            expected=f"a number > {k1} = {law.loading_stiffness:g}",
            fix='k_2 grows from k_1 to k_p; for a constant k_2 take law = "hysteretic"',
        )


def sliding_is_not_rougher_than_sticking(scene: Scene) -> Iterator[Fault]:
    """Friction falls when a contact begins to slide, or stays."""
    law = scene.contact.sliding
    dynamic = law.dynamic_friction if isinstance(law, SpringSliding) else None
    if dynamic is not None and dynamic > law.shear_friction:
        yield Fault(
            place="contact.sliding.dynamic_friction", got=f"{dynamic:g}",
            expected=f"a number <= contact.sliding.shear_friction = {law.shear_friction:g}",
        )


def mindlin_goes_with_hertz(scene: Scene) -> Iterator[Fault]:
    """Mindlin's stiffness takes the material and the contact radius of Hertz."""
    if isinstance(scene.contact.sliding, MindlinSliding) and not isinstance(scene.contact.normal, HertzNormal):
        yield Fault(
            place="contact.sliding.law", got='"mindlin"', fix="mindlin goes with hertz only",
            expected=f'"spring" or "viscous", as contact.normal.law = "{word(scene.contact.normal)}"',
        )


def twisting_needs_space(scene: Scene) -> Iterator[Fault]:
    """In the plane every spin is at right angles to every normal."""
    if scene.contact.torsion is not None and scene.dimension == 2:
        yield Fault(
            place="contact.torsion", expected="no table in 2D, where nothing twists", got="a table", fix="remove it"
        )


OF_CONTACTS = (
    sliding_is_on, rotations_can_be_followed, hysteresis_dissipates, sliding_is_not_rougher_than_sticking,
    mindlin_goes_with_hertz, twisting_needs_space,
)
"""The checks, in the order in which faults are reported."""
