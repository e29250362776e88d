"""Contact laws that make energy where nothing takes it: what a scene's author should know before anything runs."""

from __future__ import annotations

from collections.abc import Iterator

from harness.scene.contact import HertzNormal, MindlinSliding
from harness.scene.model import Scene


def energy_warnings(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield (what, why and what to do) for laws that have no potential and no dashpot.

    Mindlin's stiffness follows the overlap, S_t(delta), and no normal force answers for that: what the spring holds
    changes by dS_t/dt xi^2/2 for free (Elata & Berryman, Mech. Mater. 24, 229 (1996)).
    """
    normal = scene.contact.normal
    undamped = isinstance(normal, HertzNormal) and normal.restitution == 1.0 and scene.background is None
    if undamped and isinstance(scene.contact.sliding, MindlinSliding):
        yield "Mindlin springs without a dashpot", (
            "their stiffness follows the overlap without a normal force that answers: where contacts last and vibrate, "
            "energy grows in every code and at any time step (doubled in 76000 steps in the hard case mindlin_elastic; "
            "the kernel stops, or says so at its end); a restitution of 0.99 takes more than they make"
        )
