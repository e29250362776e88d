"""Which physical effects a scene calls for, which it does not, and the table that says so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from harness.scene.fault import show
from harness.scene.model import (
    Background,
    Biaxial,
    ConstantMotion,
    CosineMotion,
    LinearNormal,
    LoadedMotion,
    Scene,
    SpringSliding,
)
from harness.scene.system import Constant, Cosine, Loaded, System


@dataclass(frozen=True, kw_only=True)
class Effect:
    """One mechanism: on because `place` of the scene says so (`reason`), off because it does not.

    brings: what it adds to the physics; of an effect that is off, what its absence means.
    """

    name: str
    on: bool
    place: str
    reason: str
    brings: str


@dataclass(frozen=True, kw_only=True)
class Parts:
    """What decides on effects, of a scene or of a system alike; walls by name."""

    normal: LinearNormal
    sliding: SpringSliding | None
    background: Background | None
    gravity: tuple[float, ...] | None
    periodic: tuple[float, ...] | None
    rough: tuple[str, ...]
    driven: tuple[str, ...]
    loaded: tuple[str, ...]
    spinning: bool


@dataclass(frozen=True, kw_only=True)
class Kind:
    """An effect that scenes can call for: where they do, whether these parts do, and what it means.

    find returns what stands there when the effect is on, "" when it is off.
    """

    place: str
    find: Callable[[Parts], str]
    absent: str
    brings: str
    without: str


def effects(scene: Scene, system: System | None = None) -> tuple[Effect, ...]:
    """Return all effects that a scene can call for; `system` knows initial spins that stand in a file."""
    parts = parts_of_scene(scene) if system is None else parts_of_system(system)
    places = BOX_PLACES if isinstance(scene, Biaxial) else {}
    return tuple(_effect(name, kind, kind.find(parts), places.get(name)) for name, kind in EFFECTS.items())


def effects_on(system: System) -> tuple[str, ...]:
    """Return the names of the effects that an engine must compute for this system."""
    parts = parts_of_system(system)
    return tuple(name for name, kind in EFFECTS.items() if kind.find(parts))


def parts_of_system(system: System) -> Parts:
    """Return the parts of resolved numbers."""
    return Parts(
        normal=system.normal, sliding=system.sliding, background=system.background,
        gravity=system.gravity, periodic=system.periodic,
        rough=tuple(w.name for w in system.walls if w.friction),
        driven=tuple(w.name for w in system.walls if isinstance(w.motion, Constant | Cosine)),
        loaded=tuple(w.name for w in system.walls if isinstance(w.motion, Loaded)),
        spinning=bool(system.particles.spin.any()),
    )


def parts_of_scene(scene: Scene) -> Parts:
    """Return the parts of a scene, before its particles are known."""
    shared = {"normal": scene.contact.normal, "sliding": scene.contact.sliding, "background": scene.background}
    if isinstance(scene, Biaxial):
        return Parts(
            **shared, gravity=None, periodic=None, rough=(), driven=("top",), loaded=("right",), spinning=False
        )
    return Parts(
        **shared, gravity=scene.gravity, periodic=scene.periodic,
        rough=tuple(p.name for p in scene.planes if p.friction),
        driven=tuple(p.name for p in scene.planes if isinstance(p.motion, ConstantMotion | CosineMotion)),
        loaded=tuple(p.name for p in scene.planes if isinstance(p.motion, LoadedMotion)),
        spinning=any(any(b.spin or ()) for b in scene.bodies),
    )


def _effect(name: str, kind: Kind, found: str, place: str | None) -> Effect:
    return Effect(
        name=name, on=bool(found), place=place or kind.place, reason=found or kind.absent,
        brings=kind.brings if found else kind.without,
    )


def _damping(parts: Parts) -> str:
    gamma = parts.normal.normal_damping
    return f"{gamma:g} kg/s" if gamma else ""


def _attraction(parts: Parts) -> str:
    return "allowed" if parts.normal.attraction == "allowed" and parts.normal.normal_damping else ""


def _sliding(parts: Parts) -> str:
    return f"mu = {parts.sliding.shear_friction:g}" if parts.sliding else ""


def _rotation(parts: Parts) -> str:
    if parts.sliding:
        return "friction turns the particles"
    return "initial spins, which nothing changes" if parts.spinning else ""


def _background(parts: Parts) -> str:
    return f"c = {parts.background.translational_drag:g} kg/s" if parts.background else ""


def _names(walls: tuple[str, ...]) -> str:
    return ("wall " if len(walls) == 1 else "walls ") + ", ".join(walls) if walls else ""


EFFECTS: dict[str, Kind] = {
    "normal contact": Kind(
        place="contact.normal", find=lambda p: f"k_n = {p.normal.normal_stiffness:g} N/m",
        absent="", brings="repulsion that grows with the overlap", without="",
    ),
    "normal damping": Kind(
        place="contact.normal.normal_damping", find=_damping, absent="0",
        brings="energy loss in collisions: restitution below 1", without="elastic collisions",
    ),
    "damping attraction": Kind(
        place="contact.normal.attraction", find=_attraction, absent="clipped, or no damping that could pull",
        brings="the dashpot may hold bodies back just before they part", without="contact forces never pull",
    ),
    "sliding friction": Kind(
        place="contact.sliding", find=_sliding, absent="no table",
        brings="tangential spring with history and Coulomb limit", without="no tangential force, no history",
    ),
    "wall friction": Kind(
        place="planes.friction", find=lambda p: _names(p.rough), absent="no wall with friction",
        brings="walls carry shear and turn particles", without="smooth walls: normal forces only",
    ),
    "rotation": Kind(
        place="contact.sliding", find=_rotation, absent="no table: no torque acts",
        brings="spins and moments of inertia", without="no spin, no moment of inertia",
    ),
    "background drag": Kind(
        place="background", find=_background, absent="no table",
        brings="all motion relative to the ground is calmed", without="contacts and walls alone dissipate",
    ),
    "gravity": Kind(
        place="gravity", find=lambda p: f"{show(p.gravity)} m/s^2" if p.gravity else "", absent="no table",
        brings="weight", without="no weight",
    ),
    "periodic axes": Kind(
        place="periodic", find=lambda p: f"{show(p.periodic)} m" if p.periodic else "", absent="no table",
        brings="no boundary along these axes", without="open axes",
    ),
    "driven walls": Kind(
        place="planes.motion", find=lambda p: _names(p.driven), absent="no such motion",
        brings="walls that move as prescribed", without="no wall moves as prescribed",
    ),
    "loaded walls": Kind(
        place="planes.motion", find=lambda p: _names(p.loaded), absent="no such motion",
        brings="walls with mass, moved by load and particles", without="no wall with mass",
    ),
}
"""All effects by name; a new one is one row here."""

BOX_PLACES = {"driven walls": "top", "loaded walls": "side", "wall friction": "kind"}
"""Where the biaxial box says what free scenes say of their planes."""
