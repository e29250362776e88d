"""From a system to the whole law of a kind of contact: between particles, and with a wall."""

from __future__ import annotations

from harness.engines.facts import is_rough, rotates
from harness.engines.lammps.law.couples import ROLLING, TORSION, pair_radius, wall_radius
from harness.engines.lammps.law.normal import NORMAL, clip_words
from harness.engines.lammps.law.sliding import SLIDING, SMOOTH, constant_damping
from harness.engines.text import number
from harness.scene.contact import MindlinSliding, SpringSliding
from harness.scene.system import System, Wall

NO_LIMIT = 1e30
"""Friction coefficient of the clone that tells the springs: nothing slips in it."""
UNIT_SPRING = f"hooke 1 0 damping velocity tangential linear_history 1 0 {number(NO_LIMIT)}"
"""A law of the clone in which a spring u is a force -u, whatever law has stretched it."""


def pair_law(system: System) -> str:
    """Return the law between particles."""
    return _rough_law(system, pair_radius(system.particles.radius)) if rotates(system) else _smooth_law(system)


def wall_law(system: System, wall: Wall) -> str:
    """Return the law at a wall; at a smooth one the normal force is all."""
    return _rough_law(system, wall_radius(system.particles.radius)) if is_rough(system, wall) else _smooth_law(system)


def springs_law(system: System) -> str:
    """Return the law of a clone at rest, in which the tangential force on a particle is -k u with one k."""
    reduced_radius = pair_radius(system.particles.radius)
    if _stiffness_varies(system):
        return UNIT_SPRING + _couples(system, reduced_radius)
    return _rough_law(system, reduced_radius, NO_LIMIT)


def clone_stiffness(system: System) -> float | None:
    """Return the k of `springs_law`, N/m: k_t, or 1 where k_t varies; None for a law without spring."""
    if _stiffness_varies(system):
        return 1.0
    return system.sliding.shear_stiffness if isinstance(system.sliding, SpringSliding) else None


def _stiffness_varies(system: System) -> bool:
    """Does k_t depend on the overlap, or on who touches whom?"""
    return isinstance(system.sliding, MindlinSliding) or (system.materials is not None and system.sliding is not None)


def _smooth_law(system: System) -> str:
    normal = system.normal
    return f"{NORMAL[type(normal)].words(normal, 0.0)} tangential {SMOOTH}{clip_words(normal)}"


def _rough_law(system: System, reduced_radius: float, friction: float | None = None) -> str:
    """Return all that acts at a contact; `friction` replaces mu."""
    normal, sliding = system.normal, system.sliding
    words = NORMAL[type(normal)].words(normal, constant_damping(sliding))
    return (
        f"{words} tangential {_sliding(system, friction)}{_couples(system, reduced_radius)}{clip_words(normal)}"
    )


def _sliding(system: System, friction: float | None) -> str:
    sliding = system.sliding
    if sliding is None:
        return SMOOTH
    mu = sliding.shear_friction if friction is None else friction
    return SLIDING[type(sliding)].words(sliding, system.normal, mu)


def _couples(system: System, reduced_radius: float) -> str:
    """Return rolling and torsion resistance, those that are on."""
    families = (("rolling", ROLLING, system.rolling), ("twisting", TORSION, system.torsion))
    on = (f" {word} {rows[type(law)].words(law, reduced_radius)}" for word, rows, law in families if law is not None)
    return "".join(on)
