"""A scene, and the same with effects taken away one after the other: on them the order of a scheme depends."""

from __future__ import annotations

from dataclasses import dataclass

import msgspec

from harness.scene.contact import HertzNormal, NormalLaw
from harness.scene.laws import turning
from harness.scene.model import Free


@dataclass(frozen=True, kw_only=True)
class Case:
    """A scene under a name; `declared` is the user's own."""

    name: str
    scene: Free
    declared: bool


def cases_of(scene: Free) -> tuple[Case, ...]:
    """Return the scene as declared, without what rubs, and without dashpots either; only those that differ."""
    made = [Case(name="as declared", scene=scene, declared=True)]
    smooth = msgspec.structs.replace(scene, contact=_smooth(scene))
    rubs = turning(scene.contact)
    if rubs:
        made.append(Case(name="without friction", scene=smooth, declared=False))
    normal = undamped(smooth.contact.normal)
    if normal != smooth.contact.normal:
        bare = msgspec.structs.replace(smooth, contact=msgspec.structs.replace(smooth.contact, normal=normal))
        name = "without friction and dashpot" if rubs else "without dashpot"
        made.append(Case(name=name, scene=bare, declared=False))
    return tuple(made)


def undamped(normal: NormalLaw) -> NormalLaw:
    """Return the normal law without its dashpot."""
    if isinstance(normal, HertzNormal):
        return msgspec.structs.replace(normal, restitution=1.0)
    return msgspec.structs.replace(normal, normal_damping=0.0)


def _smooth(scene: Free):
    return msgspec.structs.replace(scene.contact, sliding=None, rolling=None, torsion=None)
