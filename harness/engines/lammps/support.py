"""How LAMMPS stands to the effects of a system: what was matched, what is mapped, what it cannot do."""

from __future__ import annotations

import numpy as np

from harness.engines.facts import crossing_walls, narrow_axes, rotates
from harness.engines.lammps.defects import JKR_AT_REGION
from harness.engines.lammps.law import (
    NORMAL,
    ROLLING,
    SLIDING,
    TORSION,
    Row,
    constant_damping,
    constant_ratio,
    one_reduced_radius,
)
from harness.engines.lammps.packing import INTEGRATORS
from harness.engines.protocol import Level, Support
from harness.scene.contact import DmtNormal, JkrNormal
from harness.scene.effects import effects_on
from harness.scene.system import INERTIA_FACTOR, Constant, System

NOTES: dict[str, tuple[Level, str]] = {
    "materials": (
        "exact", "a type for each material and a pair_coeff for every two types, so that nothing is mixed; at a wall a"
        " fix for each law"
    ),
    "normal damping": ("exact", "forces see half-step velocities v(t+dt/2)"),
    "damping attraction": ("exact", "no limit_damping: the dashpot may pull"),
    "wall friction": ("equivalent", "the law between grains with R_eff = R, m_eff = m and lever arm R"),
    "rotation": ("exact", "fix nve/sphere, with disc for q = 1/2"),
    "background drag": ("exact", "fix viscous on half-step velocities"),
    "gravity": ("exact", "fix gravity"),
    "periodic axes": ("exact", "boundary p"),
    "driven walls": ("exact", "region move: the wall velocity is the half-step one, by difference of positions"),
    "loaded walls": ("exact", "a carrier atom integrates the wall by velocity Verlet"),
    "glued rings": (
        "exact", "atoms of 2^100 kg, so that reduced masses are those of the grains, led by fix move rotate: forces see"
        " the velocities of glued discs at the end of the step"
    ),
    "dynamic friction": (
        "unsupported", "tangential linear_history takes one coefficient: a second one is an illegal pair_coeff command"
    ),
}
FAMILIES: dict[str, tuple[str, dict[type, Row]]] = {
    "normal contact": ("normal", NORMAL),
    "adhesion": ("normal", NORMAL),
    "plastic memory": ("normal", NORMAL),
    "sliding friction": ("sliding", SLIDING),
    "rolling resistance": ("rolling", ROLLING),
    "torsion resistance": ("torsion", TORSION),
}
"""Effects that laws bring: the system's field that holds the law, and the table that knows it."""


def judge(system: System, ranks: int = 1) -> tuple[Support, ...]:
    """Return one judgement an effect, and one for each thing LAMMPS cannot do (on so many processes)."""
    found = [_known(system, effect) for effect in effects_on(system)]
    return (*found, *(s for check in _CHECKS for s in check(system)), *(_apart(system) if ranks > 1 else ()))


def _known(system: System, effect: str) -> Support:
    """Judge an effect; laws stand behind a colon in its name."""
    family = effect.partition(":")[0]
    if family in FAMILIES:
        field, rows = FAMILIES[family]
        row = rows[type(getattr(system, field))]
        return Support(effect=effect, level=row.level, note=row.note)
    if effect not in NOTES:
        return Support(effect=effect, level="unsupported", note="the LAMMPS engine does not know this effect")
    level, note = NOTES[effect]
    return Support(effect=effect, level=level, note=note)


def _shear_damping(system: System) -> list[Support]:
    """LAMMPS has tangential damping as a multiple of the normal one only."""
    damped = [pair for pair in system.of_pairs if constant_damping(pair.sliding) > 0.0]
    if not damped:
        return []
    if not all(constant_ratio(pair.normal, constant_damping(pair.sliding)) for pair in damped):
        note = "it is a multiple of the normal damping, which varies with the overlap in this normal law"
        return [Support(effect="tangential damping", level="unsupported", note=note)]
    note = "x_t = gamma_t/gamma_n"
    if any(getattr(pair.normal, "normal_damping", 0.0) == 0.0 for pair in damped):
        note = "gamma_n = 0: a normal damping of 2^-100 gamma_t, lost in rounding, carries x_t = 2^100"
    return [Support(effect="tangential damping", level="equivalent", note=note)]


def _adhesive_limit(system: System) -> list[Support]:
    """Under adhesion friction is limited by a multiple of more than the force."""
    if not isinstance(system.normal, DmtNormal | JkrNormal) or not rotates(system):
        return []
    note = "mu |f_el + 2 f_pulloff|, without damping (Thornton, J. Phys. D 24, 1942 (1991)), in place of mu |f_n|"
    return [Support(effect="limit of friction", level="equivalent", note=note)]


def _adhesive_walls(system: System) -> list[Support]:
    if not isinstance(system.normal, JkrNormal) or not system.walls:
        return []
    return [Support(effect="walls", level="known_wrong", note=JKR_AT_REGION.evidence)]


def _torsion(system: System) -> list[Support]:
    """LAMMPS takes constants in N m, which are the scene's for one reduced radius only."""
    if system.torsion is None or one_reduced_radius(system):
        return []
    note = (
        "twisting sds takes constants in N m (k_o a*^2, gamma_o a*^2, mu_o a*), one set for all contacts,"
        " and the reduced radius a* is not the same for all that can be"
    )
    return [Support(effect="reduced radius", level="unsupported", note=note)]


def _contact_output(system: System) -> list[Support]:
    if not system.contacts or not isinstance(system.normal, JkrNormal):
        return []
    note = "compute pair/local lists overlapping pairs; those that jkr holds beyond overlap zero are left out"
    return [Support(effect="contact output", level="unsupported", note=note)]


def _inertia(system: System) -> list[Support]:
    """Return what is wrong with the moments of inertia; nothing is when nothing turns the grains."""
    if not rotates(system):
        return []
    known = [INERTIA_FACTOR[k] for k in INTEGRATORS if system.dimension == 2 or k != "disc"]
    other = np.setdiff1d(system.particles.inertia_factor, known)
    if not other.size:
        return []
    note = (
        f"I = {other[0]:g} m R^2 in {system.dimension}D: LAMMPS integrates spheres (0.4)"
        " and, in 2D, discs (0.5)"
    )
    return [Support(effect="moment of inertia", level="unsupported", note=note)]


def _pushed_at_start(system: System) -> list[Support]:
    """Return the walls with constant velocity that touch a grain at step 0."""
    p = system.particles
    names = [
        w.name
        for w in system.walls
        if isinstance(w.motion, Constant) and np.any((p.x - w.point) @ np.array(w.normal) < p.radius)
    ]
    note = f"{', '.join(names)}: in the forces of step 0 LAMMPS takes the wall to be at rest"
    return [Support(effect="driven walls", level="partial", note=note)] if names else []


def _crossing(system: System) -> list[Support]:
    names = [w.name for w in crossing_walls(system)]
    note = f"{', '.join(names)}: a plane across a periodic axis, seen by one image of a grain only"
    return [Support(effect="walls", level="unsupported", note=note)] if names else []


def _narrow(system: System) -> list[Support]:
    """LAMMPS keeps a spring by the id of the partner, so a pair may touch through one image only."""
    axes = narrow_axes(system)
    note = f"period along {', '.join(axes)} up to two diameters: a pair could touch through two images"
    return [Support(effect="periodic axes", level="unsupported", note=note)] if axes else []


def _periodic_rings(system: System) -> list[Support]:
    if not system.rings or system.periodic is None:
        return []
    note = "with periodic axes: torques are taken about the centre, not about its nearest image"
    return [Support(effect="glued rings", level="unsupported", note=note)]


def _apart(system: System) -> list[Support]:
    """Several processes swap the order of pairs across a cut; it matters to rolling and twisting springs."""
    families = {"rolling resistance": system.rolling, "torsion resistance": system.torsion}
    note = (
        "on several processes the order of a pair is swapped where a cut comes between them, and the spring changes"
        " its sign: spins 14 % off after a crossing"
    )
    return [Support(effect=e, level="known_wrong", note=note) for e, law in families.items() if law is not None]


_CHECKS = (
    _shear_damping, _adhesive_limit, _adhesive_walls, _torsion, _contact_output, _inertia, _pushed_at_start, _crossing,
    _narrow, _periodic_rings,
)
