"""Turning a knob: the scene with one thing changed, and everything that has to stay the same kept.

    stiffness  all stiffnesses times f. Stiffness ratios (k_t/k_n, k_2/k_1, nu) stay; dashpots change so that the
               restitution stays: with sqrt(f) for linear springs (e depends on gamma^2/(k m) alone), with f^(2/5) for a
               constant dashpot on Hertz (there t_c ~ E^(-2/5) at a given speed, and e depends on gamma t_c/m alone);
               Hertz' own dashpot is given by e. The time step stays the same part of a contact time.
    rate       the drive is f times as fast to the same end: duration over f, the inner ring's omega times f. Forces,
               masses and packing stay, so that the inertial number grows by f.
    size       the number of particles of a box. Rate of strain, pressure, wall mass, radii stay, and with them the
               inertial number.
    width      over what the evaluation averages: smoothing of curves (strain), cells of profiles. No run changes.
    law        a simpler law, see `harness.studies.accuracy.simpler`.
    dt         the step as a part of a contact time; not by the scene, which refuses steps beyond the stability limit,
               but by `stepped_system`: where they end is to be seen.
"""

from __future__ import annotations

import msgspec

from harness.scene.contact import Contact, DmtNormal, HertzNormal, JkrNormal, NormalLaw
from harness.scene.derived import derive
from harness.scene.grains import Grains
from harness.scene.model import Biaxial, Couette, Scene
from harness.scene.numerics import plan_steps, requested_step, stability_limit
from harness.scene.system import System
from harness.scene.tables import Table

SPRINGS = (
    "normal_stiffness", "youngs_modulus", "loading_stiffness", "unloading_stiffness", "largest_unloading_stiffness",
    "adhesion_stiffness", "shear_stiffness", "rolling_stiffness", "torsion_stiffness",
)
"""Fields of contact laws that are stiffnesses."""

DASHPOTS = ("normal_damping", "shear_damping", "rolling_damping", "torsion_damping")

LINEAR, HERTZIAN = 0.5, 0.4
"""Powers of the stiffness that dashpots go with."""


def turned(scene: Scene, knob: str, value: float) -> Scene:
    """Return the scene with a knob at a value; itself for knobs that are not the scene's (dt, width)."""
    if knob == "stiffness":
        return replaced(scene, contact=stiffened(scene.contact, value))
    if knob == "rate":
        return faster(scene, value)
    if knob == "size":
        return replaced(scene, particles=replaced(scene.particles, count=round(value)))
    return scene


def replaced(struct: Table, **changes) -> Table:
    """Return a copy with some fields changed."""
    return msgspec.structs.replace(struct, **changes)


def why_not_stiffened(normal: NormalLaw) -> str:
    """Say why the stiffness of a law is no knob, "" if it is one."""
    if isinstance(normal, DmtNormal | JkrNormal):
        return "its surface energy sets another scale: restitution is not kept by any dashpot"
    return ""


def stiffened(contact: Contact, factor: float) -> Contact:
    """Return the laws with all stiffnesses times `factor`, restitution and stiffness ratios kept."""
    power = HERTZIAN if isinstance(contact.normal, HertzNormal) else LINEAR
    laws = {name: getattr(contact, name) for name in ("normal", "sliding", "rolling", "torsion")}
    return Contact(**{name: _stiffened(law, factor, factor**power) for name, law in laws.items() if law is not None})


def _stiffened(law: Table, springs: float, dashpots: float) -> Table:
    scaled = {n: getattr(law, n) * springs for n in SPRINGS if n in law.__struct_fields__}
    scaled |= {n: getattr(law, n) * dashpots for n in DASHPOTS if n in law.__struct_fields__}
    return replaced(law, **scaled)


def faster(scene: Scene, factor: float) -> Scene:
    """Return the scene driven `factor` times as fast to the same strain, or angle."""
    if isinstance(scene, Biaxial):
        return replaced(scene, top=replaced(scene.top, duration=scene.top.duration / factor))
    if isinstance(scene, Couette):
        compare = replaced(scene.compare, steady_from=scene.compare.steady_from / factor)
        rings = replaced(scene.rings, omega=scene.rings.omega * factor)
        return replaced(scene, rings=rings, duration=scene.duration / factor, compare=compare)
    raise TypeError(f"nothing drives a scene of kind {type(scene).__name__}")


def largest_fraction(scene: Scene, grains: Grains) -> float:
    """Return the largest dt_fraction that `grainproof scene` takes, see `stability_limit`; rungs beyond are marked."""
    return scene.numerics.dt_fraction * stability_limit(scene, grains).dt / requested_step(scene, grains)


def stepped_system(scene: Scene, system: System, fraction: float) -> System:
    """Return the system with a step of `fraction` contact times, stable or not, and as many samples and frames."""
    finer = replaced(scene, numerics=replaced(scene.numerics, dt_fraction=fraction))
    plan = plan_steps(finer, derive(scene, system).grains)
    return system.with_(
        dt=plan.dt, steps=plan.steps, sample_every=plan.sample_every, frame_every=plan.frame_every
    )
