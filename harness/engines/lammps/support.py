"""How LAMMPS stands to the effects of a system: what was matched, what is mapped, what it cannot do."""

from __future__ import annotations

import numpy as np

from harness.engines.facts import crossing_walls, narrow_axes, rotates
from harness.engines.lammps.packing import INTEGRATORS
from harness.engines.protocol import Support
from harness.scene.effects import effects_on
from harness.scene.system import INERTIA_FACTOR, Constant, System

EXACT = "same formula; matched to rounding against an independent velocity-Verlet integration"
NOTES = {
    "normal contact": ("exact", f"pair granular hooke: {EXACT}"),
    "normal damping": ("exact", "damping velocity; forces see half-step velocities v(t+dt/2)"),
    "damping attraction": ("exact", "no limit_damping: the dashpot may pull"),
    "sliding friction": (
        "equivalent",
        "linear_history: the spring is turned with the normal and keeps its length, cut so that spring "
        "and dashpot together obey Coulomb's limit mu |f_n|, f_n with damping; lever arm R - overlap/2",
    ),
    "wall friction": ("equivalent", "the law between grains with R_eff = R, m_eff = m and lever arm R"),
    "rotation": ("exact", "fix nve/sphere, with disc for q = 1/2"),
    "background drag": ("exact", "fix viscous on half-step velocities"),
    "gravity": ("exact", "fix gravity"),
    "periodic axes": ("exact", "boundary p"),
    "driven walls": ("exact", "region move: the wall velocity is the half-step one, by difference of positions"),
    "loaded walls": ("exact", "a carrier atom integrates the wall by velocity Verlet"),
}


def judge(system: System) -> tuple[Support, ...]:
    """Return one judgement an effect, and one for each thing LAMMPS cannot do."""
    found = [_known(effect) for effect in effects_on(system)]
    return (*found, *(s for check in _CHECKS for s in check(system)))


def _known(effect: str) -> Support:
    if effect not in NOTES:
        return Support(effect=effect, level="unsupported", note="the LAMMPS engine does not know this effect")
    level, note = NOTES[effect]
    return Support(effect=effect, level=level, note=note)


def _shear_damping(system: System) -> list[Support]:
    """LAMMPS has tangential damping as a multiple of the normal one only."""
    sliding = system.sliding
    if sliding is None or sliding.shear_damping == 0.0:
        return []
    note = "x_t = gamma_t/gamma_n"
    if system.normal.normal_damping == 0.0:
        note = "gamma_n = 0: a normal damping of 2^-100 gamma_t, lost in rounding, carries x_t = 2^100"
    return [Support(effect="tangential damping", level="equivalent", note=note)]


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


_CHECKS = (_shear_damping, _inertia, _pushed_at_start, _crossing, _narrow)
