"""Which physical effects a scene calls for, which it does not, and the table that says so.

An effect that several laws can bring is one row for people, with the law in its reason, and one name a law
for engines (``normal contact: hertz``), because an engine stands to each law in its own way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import get_args

from harness.scene.contact import NormalLaw, RollingLaw, SlidingLaw, SpringSliding, SpringTorsion
from harness.scene.fault import show
from harness.scene.laws import NORMAL, TANGENTIAL, normal_row, turning, word
from harness.scene.materials import materials_of
from harness.scene.model import Background, Biaxial, ConstantMotion, CosineMotion, Couette, Free, LoadedMotion, Scene
from harness.scene.system import Constant, Cosine, Loaded, Materials, System
from harness.scene.tables import Table


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
    """What decides on effects, of a scene or of a system alike; walls by name.

    of_pairs: the normal laws between `materials`, by their words, where a scene has such.
    """

    normal: NormalLaw
    sliding: SlidingLaw | None
    rolling: RollingLaw | None
    torsion: SpringTorsion | None
    background: Background | None
    gravity: tuple[float, ...] | None
    periodic: tuple[float, ...] | None
    rough: tuple[str, ...]
    driven: tuple[str, ...]
    loaded: tuple[str, ...]
    spinning: bool
    rings: tuple[str, ...] = ()
    materials: tuple[str, ...] = ()
    of_pairs: tuple[NormalLaw, ...] = ()

    @property
    def normals(self) -> tuple[NormalLaw, ...]:
        """The normal laws that act: of pairs of materials, where there are any."""
        return self.of_pairs or (self.normal,)


@dataclass(frozen=True, kw_only=True)
class Kind:
    """An effect that scenes can call for: where they do, whether these parts do, and what it means.

    find returns what stands there when the effect is on, "" when it is off. law returns the law that
    brings it, of the `laws` that can.
    """

    place: str
    find: Callable[[Parts], str]
    absent: str
    brings: str
    without: str
    laws: tuple[str, ...] = ()
    law: Callable[[Parts], Table | None] = lambda _: None


def effects(scene: Scene, system: System | None = None) -> tuple[Effect, ...]:
    """Return all effects that a scene can call for; `system` knows initial spins that stand in a file."""
    parts = parts_of_scene(scene) if system is None else parts_of_system(system)
    places = BOX_PLACES if isinstance(scene, Biaxial) else {}
    return tuple(_effect(name, kind, kind.find(parts), places.get(name)) for name, kind in EFFECTS.items())


def effects_on(system: System) -> tuple[str, ...]:
    """Return the names of the effects that an engine must compute for this system, as in `EFFECT_NAMES`."""
    parts = parts_of_system(system)
    on = ((name, kind.law(parts)) for name, kind in EFFECTS.items() if kind.find(parts))
    return tuple(name if law is None else _with_law(name, word(law)) for name, law in on)


def parts_of_system(system: System) -> Parts:
    """Return the parts of resolved numbers."""
    return Parts(
        normal=system.normal, sliding=system.sliding, rolling=system.rolling, torsion=system.torsion,
        background=system.background, gravity=system.gravity, periodic=system.periodic,
        rough=tuple(w.name for w in system.walls if w.friction),
        driven=tuple(w.name for w in system.walls if isinstance(w.motion, Constant | Cosine)),
        loaded=tuple(w.name for w in system.walls if isinstance(w.motion, Loaded)),
        spinning=bool(system.particles.spin.any()), rings=tuple(ring.name for ring in system.rings),
        **_of_materials(system.materials),
    )


def _of_materials(materials: Materials | None) -> dict[str, tuple]:
    """Return the parts that materials make: none in a system without."""
    if materials is None:
        return {}
    words = tuple(word for word in materials.names if word)
    return {"materials": words, "of_pairs": tuple(law for row in materials.normal for law in row)}


def parts_of_scene(scene: Scene) -> Parts:
    """Return the parts of a scene, before its particles are known."""
    contact = scene.contact
    shared = {
        "normal": contact.normal, "sliding": contact.sliding, "rolling": contact.rolling,
        "torsion": contact.torsion, "background": scene.background,
    }
    if isinstance(scene, Biaxial):
        return Parts(
            **shared, gravity=None, periodic=None, rough=(), driven=("top",), loaded=("right",), spinning=False
        )
    if isinstance(scene, Couette):
        return Parts(
            **shared, gravity=None, periodic=None, rough=(), driven=(), loaded=(), spinning=True,
            rings=("inner", "outer"),
        )
    return Parts(
        **shared, gravity=scene.gravity, periodic=scene.periodic,
        rough=tuple(p.name for p in scene.planes if p.friction),
        driven=tuple(p.name for p in scene.planes if isinstance(p.motion, ConstantMotion | CosineMotion)),
        loaded=tuple(p.name for p in scene.planes if isinstance(p.motion, LoadedMotion)),
        spinning=any(any(b.spin or ()) for b in scene.bodies),
        **_of_materials(materials_of(contact, [*_words_of_bodies(scene), *(p.material for p in scene.planes)])),
    )


def _words_of_bodies(scene: Free) -> tuple[str | None, ...]:
    """Return the materials of the bodies; those of a file are not known yet, but all that entries name are used."""
    if scene.bodies_file is None:
        return tuple(b.material for b in scene.bodies)
    return tuple(name for entry in scene.contact.between for name in entry.materials)


def _effect(name: str, kind: Kind, found: str, place: str | None) -> Effect:
    return Effect(
        name=name, on=bool(found), place=place or kind.place, reason=found or kind.absent,
        brings=kind.brings if found else kind.without,
    )


def _with_law(name: str, law: str) -> str:
    return f"{name}: {law}"


def _words(laws: tuple[type, ...]) -> tuple[str, ...]:
    return tuple(law.__struct_config__.tag for law in laws)


def _damping(parts: Parts) -> str:
    found = dict.fromkeys(normal_row(law).damping(law) for law in parts.normals)
    return ", ".join(word for word in found if word)


def _attraction(parts: Parts) -> str:
    pulls = any(normal_row(law).damping(law) and not normal_row(law).clips(law) for law in parts.normals)
    return "the law does not clip the dashpot" if pulls else ""


def _adhesion(parts: Parts) -> str:
    return normal_row(parts.normal).adhesion(parts.normal)


def _numbers(law: Table | None) -> str:
    """Return a law's word and numbers, "" without a law."""
    row = NORMAL.get(type(law)) or TANGENTIAL.get(type(law))
    return f"{word(law)}, {row.numbers(law)}" if row else ""


def _dynamic_friction(parts: Parts) -> str:
    sliding = parts.sliding
    on = isinstance(sliding, SpringSliding) and sliding.dynamic_friction is not None
    return f"mu_d = {sliding.dynamic_friction:g} once it slides" if on else ""


def _rotation(parts: Parts) -> str:
    found = turning(parts)
    if found:
        return f"{' and '.join(found)} turn{'s' * (len(found) == 1)} the particles"
    return "initial spins, which nothing changes" if parts.spinning else ""


def _materials(parts: Parts) -> str:
    return f"numbers by pair of {', '.join(parts.materials)}" if parts.materials else ""


def _background(parts: Parts) -> str:
    return f"c = {parts.background.translational_drag:g} kg/s" if parts.background else ""


def _names(walls: tuple[str, ...]) -> str:
    return ("wall " if len(walls) == 1 else "walls ") + ", ".join(walls) if walls else ""


EFFECTS: dict[str, Kind] = {
    "normal contact": Kind(
        place="contact.normal", find=lambda p: _numbers(p.normal), absent="",
        brings="repulsion that grows with the overlap", without="",
        laws=_words(tuple(NORMAL)), law=lambda p: p.normal,
    ),
    "materials": Kind(
        place="contact.between", find=_materials, absent="no table",
        brings="stiffnesses and dashpots depend on who touches whom", without="one set of numbers for all contacts",
    ),
    "normal damping": Kind(
        place="contact.normal", find=_damping, absent="normal_damping = 0, or restitution = 1",
        brings="a dashpot that takes energy in collisions", without="no dashpot",
    ),
    "damping attraction": Kind(
        place="contact.normal", find=_attraction, absent="clipped, or no damping that could pull",
        brings="the dashpot may hold bodies back just before they part", without="no dashpot ever pulls",
    ),
    "adhesion": Kind(
        place="contact.normal", find=_adhesion, absent="nothing attracts",
        brings="contacts that pull, and may not part", without="springs only push",
    ),
    "plastic memory": Kind(
        place="contact.normal.law", find=lambda p: normal_row(p.normal).remembers, absent="the law has no memory",
        brings="unloading differs from loading: energy stays in the contact", without="loading and unloading are one",
    ),
    "sliding friction": Kind(
        place="contact.sliding", find=lambda p: _numbers(p.sliding), absent="no table",
        brings="tangential force up to Coulomb's limit", without="no tangential force, no history",
        laws=_words(get_args(SlidingLaw)), law=lambda p: p.sliding,
    ),
    "dynamic friction": Kind(
        place="contact.sliding.dynamic_friction", find=_dynamic_friction, absent="no such number",
        brings="a lower limit while a contact slides", without="one coefficient, sliding or not",
    ),
    "rolling resistance": Kind(
        place="contact.rolling", find=lambda p: _numbers(p.rolling), absent="no table",
        brings="couples against rolling over each other", without="contacts roll freely",
        laws=_words(get_args(RollingLaw)), law=lambda p: p.rolling,
    ),
    "torsion resistance": Kind(
        place="contact.torsion", find=lambda p: _numbers(p.torsion), absent="no table",
        brings="couples against twisting about the normal", without="contacts twist freely",
        laws=_words((SpringTorsion,)), law=lambda p: p.torsion,
    ),
    "wall friction": Kind(
        place="planes.friction", find=lambda p: _names(p.rough), absent="no wall with friction",
        brings="the tangential laws act at these walls too", without="smooth walls: normal forces only",
    ),
    "rotation": Kind(
        place="contact", find=_rotation, absent="no law that turns particles: no torque acts",
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
    "glued rings": Kind(
        place="rings", find=lambda p: f"rings {', '.join(p.rings)}" if p.rings else "", absent="no table",
        brings="rough circular walls of discs, which turn rigidly or rest", without="no such wall",
    ),
}
"""All effects by name; a new one is one row here."""

EFFECT_NAMES = tuple(
    name for effect, kind in EFFECTS.items() for name in ([_with_law(effect, w) for w in kind.laws] or [effect])
)
"""What engines are asked about, in order: an effect's name, with the word of the law where it has several."""

BOX_PLACES = {"driven walls": "top", "loaded walls": "side", "wall friction": "kind"}
"""Where the biaxial box says what free scenes say of their planes."""
