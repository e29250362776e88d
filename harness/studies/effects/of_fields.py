"""Switches of walls and fields: planes, background, gravity. Each returns the scene and what was written."""

from __future__ import annotations

import math

from msgspec.structs import replace

from harness.scene.grains import Grains
from harness.scene.laws import turning
from harness.scene.model import Background, Free, Scene
from harness.studies.effects.turned import NotSwitched, Turned, rounded, stiffness_of, with_planes

DRAG, WEIGHT = 1e-3, 9.81


def smooth_walls(scene: Scene, _: Grains) -> Turned:
    """No plane with friction."""
    return Turned(scene=with_planes(scene, friction=False), says="friction = false at every plane")


def rough_walls(scene: Scene, _: Grains) -> Turned:
    """Every plane with the friction of the particles."""
    if not isinstance(scene, Free):
        raise NotSwitched("the walls of a box are smooth, those of a ring are glued discs: no number says otherwise")
    if not scene.planes:
        raise NotSwitched("there is no plane")
    if not turning(scene.contact):
        raise NotSwitched("at a rough plane the particles' own tangential laws act, and there are none")
    return Turned(scene=with_planes(scene, friction=True), says="friction = true at every plane")


def no_drag(scene: Scene, _: Grains) -> Turned:
    """Without the table background."""
    return Turned(scene=replace(scene, background=None), says="no table background")


def dragged(scene: Scene, grains: Grains) -> Turned:
    """A drag that calms without ruling."""
    c = rounded(DRAG * math.sqrt(stiffness_of(scene, grains) * grains.mean_mass))
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
