"""How LIGGGHTS stands to the effects of a system: what was matched, what is mapped, what it cannot do."""

from __future__ import annotations

import numpy as np

from harness.engines.facts import crossing_walls, narrow_axes, rotates
from harness.engines.liggghts.law import judgements, observation_moves, too_many_bodies
from harness.engines.liggghts.law.words import Judgement, equivalent, exact
from harness.engines.liggghts.planes import across_axis, is_still, meshes, slip_velocity
from harness.engines.protocol import Support
from harness.scene.contact import HystereticNormal, ViscousSliding
from harness.scene.effects import effects_on
from harness.scene.system import INERTIA_FACTOR, Loaded, System, Wall

COIN = (
    "the force of a sliding contact is told with or without its tangential dashpot: without normal damping its spring "
    "is at the limit to the last digit, so rounding decides"
)
NOTES = {
    "materials": exact("an atom type each; constants in tables over pairs of types (peratomtypepair)"),
    "wall friction": equivalent("the law between particles with m_eff = m, R_eff = R and lever arm R - overlap/2"),
    "rotation": exact("fix nve/sphere: discs in 2D mode, spheres in 3D mode"),
    "background drag": exact("fix viscous on half-step velocities"),
    "gravity": exact("fix gravity"),
    "periodic axes": exact("boundary p"),
    "driven walls": exact("move/mesh with the mean rate of the step"),
    "glued rings": exact(
        "atoms of 2^100 kg, so that reduced masses are those of the particles, led by fix move rotate: forces see the "
        "velocities of glued discs at the end of the step"
    ),
    "loaded walls": exact("leapfrog form of velocity Verlet, state kept in a carrier atom, force of each mesh"),
}
"""All effects but contact laws, which judge themselves (`law`)."""


def supports(system: System, ranks: int = 1) -> tuple[Support, ...]:
    """Return one judgement an effect, and one for each thing LIGGGHTS cannot do as it should (on so many processes)."""
    notes = NOTES | judgements(system)
    found = [_support(effect, notes.get(effect.split(":")[0])) for effect in effects_on(system)]
    return (*found, *(s for check in _CHECKS for s in check(system)), *(_apart(system) if ranks > 1 else ()))


def _support(effect: str, judgement: Judgement | None) -> Support:
    if judgement is None:
        return Support(effect=effect, level="unsupported", note="the LIGGGHTS engine does not know this effect")
    return Support(effect=effect, level=judgement.level, note=judgement.note)


def _inertia(system: System) -> list[Support]:
    """Nothing is wrong with moments of inertia when nothing turns the particles."""
    if not rotates(system):
        return []
    factors = np.unique(system.particles.inertia_factor)
    able = [INERTIA_FACTOR["sphere"]] + ([INERTIA_FACTOR["disc"]] if system.dimension == 2 else [])
    if len(factors) == 1 and factors[0] in able:
        return []
    got = ", ".join(f"{q:g}" for q in factors)
    note = f"I = q m R^2 with q = {got}: one of {', '.join(f'{q:g}' for q in able)} for all particles of a {{}}D run"
    return [Support(effect="moment of inertia", level="unsupported", note=note.format(system.dimension))]


def _narrow_period(system: System) -> list[Support]:
    """Springs are kept by the partner's id, so a pair may touch through one image only."""
    narrow = narrow_axes(system)
    note = f"period along {', '.join(narrow)} up to two diameters: a pair could touch through two images"
    return [Support(effect="periodic axes", level="unsupported", note=note)] if narrow else []


def _crossing_walls(system: System) -> list[Support]:
    crossing = [w.name for w in crossing_walls(system)]
    note = f"{', '.join(crossing)}: a plane across a periodic axis, seen by one image of a particle only"
    return [Support(effect="walls", level="unsupported", note=note)] if crossing else []


def _tiled_walls(system: System) -> list[Support]:
    """A mesh along a periodic axis has to fill the domain's cross-section and keep doing so."""
    if system.periodic is None:
        return []
    bad = [w.name for w in meshes(system) if across_axis(w) is None or _drifts(system, w)]
    note = f"{', '.join(bad)}: a mesh along a periodic axis must lie across another axis and move straight along it"
    return [Support(effect="walls", level="unsupported", note=note)] if bad else []


def _drifts(system: System, wall: Wall) -> bool:
    return not is_still(wall) and bool(np.any(slip_velocity(system, wall)))


def _span_of_loaded_walls(system: System) -> list[Support]:
    """The extent is needed while carriers are being moved, so it must not depend on one."""
    spans = {name: w for w in system.walls if isinstance(w.motion, Loaded) for name in w.motion.span or ()}
    bad = [w.name for name, w in spans.items() if isinstance(system.wall(name).motion, Loaded)]
    note = f"{', '.join(bad)}: the load depends on the place of a wall that is itself loaded"
    return [Support(effect="loaded walls", level="unsupported", note=note)] if bad else []


def _bodies(system: System) -> list[Support]:
    """Some dashpots are to be given for each two bodies."""
    reason = too_many_bodies(system)
    return [Support(effect="dashpots", level="unsupported", note=reason)] if reason else []


def _periodic_rings(system: System) -> list[Support]:
    if not system.rings or system.periodic is None:
        return []
    note = "with periodic axes: torques are taken about the centre, not about its nearest image"
    return [Support(effect="glued rings", level="unsupported", note=note)]


def _contact_output(system: System) -> list[Support]:
    """Some laws move their history whenever they are evaluated, also for output."""
    if not system.contacts:
        return []
    reason = observation_moves(system)
    if reason:
        return [Support(effect="contact output", level="unsupported", note=reason)]
    return [Support(effect="contact output", level="partial", note=COIN)] if _cut_just_so(system) else []


def _cut_just_so(system: System) -> bool:
    """Is the spring of a sliding contact still at its limit when the contact is evaluated again?"""
    return any(_coin_decides(pair) for pair in system.of_pairs)


def _coin_decides(system: System) -> bool:
    damped = getattr(system.sliding, "shear_damping", 0.0) > 0.0 and not isinstance(system.sliding, ViscousSliding)
    return damped and getattr(system.normal, "normal_damping", 0.0) == 0.0


def _apart(system: System) -> list[Support]:
    """Several processes swap the order of pairs across a cut; it matters to edinburgh's largest overlap."""
    if not isinstance(system.normal, HystereticNormal):
        return []
    note = (
        "edinburgh/stiffness forgets the plastic overlap where a cut between two processes comes between a pair:"
        " places 2 to 6 diameters off after a crossing"
    )
    return [Support(effect="plastic memory", level="known_wrong", note=note)]


_CHECKS = (
    _inertia, _bodies, _contact_output, _narrow_period, _periodic_rings, _crossing_walls, _tiled_walls,
    _span_of_loaded_walls,
)
