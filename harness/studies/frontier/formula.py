"""The formula beyond which scenes are refused, for a system at rest."""

from __future__ import annotations

from harness.scene.contact import Contact
from harness.scene.grains import grains_of
from harness.scene.model import Free, Numerics, Outputs
from harness.scene.numerics import particle_limit
from harness.scene.system import System


def formula_limit(system: System) -> float:
    """Return `harness.scene.numerics.particle_limit` of a system's particles and laws, s.

    Laws that stiffen are taken at the overlap of an impact at their `impact_speed`, as in scenes.
    """
    contact = Contact(normal=system.normal, sliding=system.sliding, rolling=system.rolling, torsion=system.torsion)
    scene = Free(
        title="", dimension=system.dimension, contact=contact, duration=1.0, numerics=Numerics(dt_fraction=1.0),
        outputs=Outputs(samples=1, frames=1, contacts=False),
    )
    return particle_limit(contact, grains_of(scene, system.particles), system.background).dt
