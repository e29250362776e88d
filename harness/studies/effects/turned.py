"""A scene with one thing changed, and what switches share to make it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from msgspec.structs import replace

from harness.scene.contact import SpringSliding
from harness.scene.grains import Grains
from harness.scene.laws import turning
from harness.scene.model import Free, Scene
from harness.scene.numerics import met_head_on

SHEAR_STIFFNESS = 0.2
"""k_t over the stiffness with which a contact begins."""


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


def with_normal(scene: Scene, **changes) -> Scene:
    """Return the scene with numbers of its normal law changed."""
    return with_law(scene, replace(scene.contact.normal, **changes))


def with_law(scene: Scene, law) -> Scene:
    """Return the scene with another normal law."""
    return with_contact(scene, normal=law)


def with_contact(scene: Scene, **changes) -> Scene:
    """Return the scene with laws changed; not where pairs of materials have numbers of their own beside them."""
    if scene.contact.between:
        raise NotSwitched("contact.between has numbers of its own, which the switch would not turn")
    return replace(scene, contact=replace(scene.contact, **changes))


def consistent(scene: Scene) -> Scene:
    """Take away what means nothing when no law turns particles any more: angles, and friction at planes."""
    if turning(scene.contact):
        return scene
    scene = replace(scene, outputs=replace(scene.outputs, rotations=False))
    return with_planes(scene, friction=False) if isinstance(scene, Free) else scene


def with_planes(scene: Free, **changes) -> Free:
    """Return the scene with all its planes changed."""
    return replace(scene, planes=tuple(replace(p, **changes) for p in scene.planes))


def stiffness_of(scene: Scene, grains: Grains) -> float:
    """Return the slope with which a contact begins where it is one, else the largest one, N/m; of the stiffest pair."""
    met = [scales.met.stiffness for scales in met_head_on(scene.contact, grains)]
    return getattr(scene.contact.normal, "loading_stiffness", None) or (max(met) if grains.parts else met[0])


def couple_stiffness(scene: Scene, grains: Grains) -> float:
    """Return the stiffness of a rolling or torsion spring: that of the tangential one, or as for one, N/m."""
    sliding = scene.contact.sliding
    if isinstance(sliding, SpringSliding):
        return sliding.shear_stiffness
    return rounded(SHEAR_STIFFNESS * stiffness_of(scene, grains))


def rounded(value: float) -> float:
    """Return the number with three digits: what is stated is what is run."""
    return float(f"{value:.3g}")
