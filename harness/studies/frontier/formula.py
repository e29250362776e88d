"""The formula beyond which scenes are refused, for a system at rest."""

from __future__ import annotations

from harness.scene.grains import grains_of
from harness.scene.materials import contact_of
from harness.scene.model import Free, Numerics, Outputs, Plane
from harness.scene.numerics import particle_limit
from harness.scene.system import System


def formula_limit(system: System) -> float:
    """Return `harness.scene.numerics.particle_limit` of a system's particles and laws, s.

    Laws that stiffen are taken at the overlap of an impact at their `impact_speed`, as in scenes. With materials walls
    count, as their contacts may be the stiffest.
    """
    contact = contact_of(system)
    scene = Free(
        title="", dimension=system.dimension, contact=contact, duration=1.0, numerics=Numerics(dt_fraction=1.0),
        outputs=Outputs(samples=1, frames=1, contacts=False), planes=_planes(system),
    )
    return particle_limit(contact, grains_of(scene, system.particles), system.background).dt


def _planes(system: System) -> tuple[Plane, ...]:
    """Return the walls of a system with materials, for what they are of; none of others, where all have one law."""
    walls = () if system.materials is None else system.walls
    return tuple(
        Plane(name=w.name, point=w.point, normal=w.normal, friction=w.friction, material=w.material) for w in walls
    )
