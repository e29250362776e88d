"""Which physical effects a scene calls for, which it does not, and the table that says so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from harness.scene.fault import show
from harness.scene.model import Biaxial, ConstantMotion, CosineMotion, LoadedMotion, Plane, Scene
from harness.scene.system import System


@dataclass(frozen=True, kw_only=True)
class Effect:
    """One mechanism: on because `place` of the scene says so (`reason`), off because it does not.

    brings: what it adds to the physics when on, what its absence means when off.
    """

    name: str
    on: bool
    place: str
    reason: str
    brings: str


Finding = tuple[bool, str, str]
"""Whether it is on, the place in the scene, what stands there."""


def effects(scene: Scene, system: System | None = None) -> tuple[Effect, ...]:
    """Return all effects that a scene can call for, in the order of the registry.

    `system` tells whether particles from a file spin.
    """
    found = ((name, brings, finder(scene, system)) for name, (finder, brings) in EFFECTS.items())
    return tuple(
        Effect(name=name, on=on, place=place, reason=reason, brings=brings[not on])
        for name, brings, (on, place, reason) in found
    )


def _normal_contact(scene: Scene, _) -> Finding:
    return True, "contact.normal", f"k_n = {scene.contact.normal.normal_stiffness:g} N/m"


def _normal_damping(scene: Scene, _) -> Finding:
    gamma = scene.contact.normal.normal_damping
    return gamma > 0, "contact.normal.normal_damping", f"{gamma:g} kg/s"


def _attraction(scene: Scene, _) -> Finding:
    normal = scene.contact.normal
    on = normal.attraction == "allowed" and normal.normal_damping > 0
    return on, "contact.normal.attraction", normal.attraction if normal.normal_damping else "no damping"


def _sliding(scene: Scene, _) -> Finding:
    sliding = scene.contact.sliding
    return _table("contact.sliding", sliding, lambda: f"mu = {sliding.shear_friction:g}")


def _wall_friction(scene: Scene, _) -> Finding:
    if isinstance(scene, Biaxial):
        return False, "kind", "the walls of the biaxial box are smooth"
    rough = [p.name for p in scene.planes if p.friction]
    return bool(rough), "planes.friction", ", ".join(rough) or "no plane with friction"


def _rotation(scene: Scene, system: System | None) -> Finding:
    if scene.contact.sliding is not None:
        return True, "contact.sliding", "friction turns the particles"
    if system is not None and system.particles.spin.any():
        return True, "bodies.spin", "initial spins, which nothing changes"
    return False, "contact.sliding", "no table: no torque acts"


def _background(scene: Scene, _) -> Finding:
    drag = scene.background
    return _table("background", drag, lambda: f"c = {drag.translational_drag:g} kg/s")


def _gravity(scene: Scene, _) -> Finding:
    gravity = None if isinstance(scene, Biaxial) else scene.gravity
    return _table("gravity", gravity, lambda: f"{show(gravity)} m/s^2")


def _periodic(scene: Scene, _) -> Finding:
    lengths = None if isinstance(scene, Biaxial) else scene.periodic
    return _table("periodic", lengths, lambda: f"{show(lengths)} m")


def _driven_walls(scene: Scene, _) -> Finding:
    if isinstance(scene, Biaxial):
        return True, "top", f"{scene.top.final_strain:g} strain in {scene.top.duration:g} s"
    return _planes_with(scene.planes, ConstantMotion | CosineMotion)


def _wall_inertia(scene: Scene, _) -> Finding:
    if isinstance(scene, Biaxial):
        return True, "side", f"p = {scene.side.pressure:g} N/m on a mass of {scene.side.mass:g} kg"
    return _planes_with(scene.planes, LoadedMotion)


def _planes_with(planes: tuple[Plane, ...], motion: type) -> Finding:
    names = [p.name for p in planes if isinstance(p.motion, motion)]
    return bool(names), "planes.motion", ", ".join(names) or "no plane with such a motion"


def _table(place: str, table: object, text: Callable[[], str]) -> Finding:
    return (True, place, text()) if table is not None else (False, place, "no table")


EFFECTS: dict[str, tuple[Callable[[Scene, System | None], Finding], tuple[str, str]]] = {
    "normal contact": (_normal_contact, ("repulsion that grows with the overlap", "")),
    "normal damping": (_normal_damping, ("energy loss in collisions: restitution below 1", "elastic collisions")),
    "damping attraction": (
        _attraction,
        ("the dashpot may hold bodies back just before they part", "contact forces never pull"),
    ),
    "sliding friction": (
        _sliding, ("tangential spring with history and Coulomb limit", "no tangential force, no history")
    ),
    "wall friction": (_wall_friction, ("walls carry shear and turn particles", "smooth walls: normal forces only")),
    "rotation": (_rotation, ("spins and moments of inertia", "no spin, no moment of inertia")),
    "background drag": (_background, ("calms all motion relative to the ground", "contacts alone dissipate")),
    "gravity": (_gravity, ("weight", "no weight")),
    "periodic axes": (_periodic, ("no boundary along these axes", "open axes")),
    "driven walls": (_driven_walls, ("walls that move as prescribed", "no wall moves as prescribed")),
    "loaded walls": (_wall_inertia, ("walls with mass, moved by load and particles", "no wall with mass")),
}
"""One row an effect: who finds it, what it brings when on and what its absence means."""
