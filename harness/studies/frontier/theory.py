"""What theory says of a packing's largest step: springs and dashpots of its contacts, linear about rest."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from harness.scene.contact import (
    HertzNormal,
    HystereticNormal,
    LinearNormal,
    MindlinSliding,
    SpringSliding,
    ViscousSliding,
)
from harness.scene.overlaps import initial_overlaps
from harness.scene.system import System
from harness.studies.frontier.formula import formula_limit
from reference.analytic.hertz_collision import (
    damping_factor_for_restitution,
    effective_modulus,
    hertz_stiffness,
)
from reference.analytic.packing_modes import FIXED, Contacts, Elements, Packing

LATE = ("kernel:talk",)
"""Engines whose friction springs are felt one step late (`reference.kernel.laws.slider`, `talk`)."""

UNKNOWN = ("kernel:corrected",)
"""Engines with another scheme than the leapfrog: their limit is measured, not derived."""


TOLERANCE = 0.02
"""Measured and exact limits may differ by so much of the exact one where motions are linear: two brackets' widths."""


class NoTheory(Exception):
    """The law has no constant springs about a state at rest; the message says why."""


@dataclass(frozen=True, kw_only=True)
class Theory:
    """The exact limit of a scheme, s; None where nothing was derived, and `note` says why. guess: where to look, s."""

    exact: float | None
    note: str
    guess: float


def scheme(engine: str) -> str:
    """Return what theory has to know of an engine: "late", "unknown" or "leapfrog"."""
    return "late" if engine in LATE else "unknown" if engine in UNKNOWN else "leapfrog"


def felt_late(engine: str, rest: System) -> bool:
    """Whether an engine feels springs of this system one step late; Mindlin's has no stiffness of its own.

    Beyond the limit the kernel stops by itself: it does not begin (`reference.kernel.guards`), or ends the run once
    swings have grown (`reference.kernel.late_springs`). What grows without these guards is measured in its tests.
    """
    springs = (
        (rest.sliding, "shear_stiffness"), (rest.rolling, "rolling_stiffness"), (rest.torsion, "torsion_stiffness"),
    )
    own = any(hasattr(law, name) for law, name in springs)
    return scheme(engine) == "late" and (own or isinstance(rest.sliding, MindlinSliding))


def theory_of(rest: System, engine: str) -> Theory:
    """Return the largest stable step of small motions of a system at rest in an engine's scheme."""
    try:
        codes = linear_packing(rest).largest_step()
    except NoTheory as reason:
        return Theory(exact=None, note=str(reason), guess=formula_limit(rest))
    if scheme(engine) == "unknown":
        return Theory(exact=None, note="another scheme than the leapfrog: nothing derived", guess=codes)
    exact = linear_packing(rest, late=True).largest_step() if scheme(engine) == "late" else codes
    return Theory(exact=exact, note="", guess=exact or codes)


def linear_packing(system: System, *, late: bool = False) -> Packing:
    """Return the springs and dashpots of the contacts that a system at rest has. Raises NoTheory.

    late: friction and rolling springs are felt one step late.
    """
    contacts, overlap = touching(system)
    masses = _reduced(system.particles.mass, contacts)
    normal, along, pressing = _normal_elements(system, overlap, contacts.reduced, masses)
    springs, dashpots = {"normal": normal}, {"normal": along}
    for family, made in _turning_elements(system, normal, along).items():
        springs[family], dashpots[family] = made
    p = system.particles
    held = {k: v for k, v in springs.items() if k != "normal" and v is not None}
    return Packing(
        mass=p.mass, inertia=p.inertia_factor * p.mass * p.radius**2, contacts=contacts,
        springs=Elements(**springs, pressing=pressing), dashpots=Elements(**dashpots),
        drag=system.background.translational_drag if system.background else 0.0,
        late=Elements(**held) if late and held else None,
    )


def touching(system: System) -> tuple[Contacts, np.ndarray]:
    """Return the contacts of a system's start and their overlaps, (M,), m."""
    found, p = initial_overlaps(system), system.particles
    wall = found.second < 0
    i, j = found.first, np.where(wall, FIXED, found.second)
    apart = p.x[i] - p.x[j]
    if system.periodic is not None:
        box = np.array(system.periodic)
        apart -= np.round(apart / np.where(box > 0, box, np.inf)) * box
    distance = np.where(wall, np.inf, np.linalg.norm(apart, axis=1))
    normal = apart / np.where(wall, 1.0, distance)[:, None]
    for plane in system.walls:
        normal[found.second == -plane.index] = plane.normal
    partner = np.where(wall, np.inf, p.radius[j])
    half = found.size / 2
    return Contacts(
        i=i, j=j, normal=normal, arm_i=p.radius[i] - half, arm_j=np.where(wall, 0.0, p.radius[j] - half),
        reduced=1 / (1 / p.radius[i] + 1 / partner), distance=distance,
    ), found.size


def _reduced(quantity: np.ndarray, c: Contacts) -> np.ndarray:
    """q_i q_j/(q_i + q_j); q_i where the partner is fixed."""
    partner = np.where(c.j == FIXED, np.inf, quantity[c.j])
    return 1 / (1 / quantity[c.i] + 1 / partner)


def _normal_elements(system: System, overlap, radius, mass):
    """Slope of the force, dashpot and force of every contact, (M,); the dashpot None where there is none."""
    law = system.normal
    if isinstance(law, LinearNormal):
        force = law.normal_stiffness * overlap
        return law.normal_stiffness, law.normal_damping or None, force
    if isinstance(law, HertzNormal):
        k = _hertz(law, radius)
        damping = damping_factor_for_restitution(law.restitution) * np.sqrt(k * mass) * overlap**0.25
        return 1.5 * k * np.sqrt(overlap), damping if law.restitution < 1 else None, k * overlap**1.5
    if isinstance(law, HystereticNormal):
        return law.unloading_stiffness, law.normal_damping or None, law.loading_stiffness * overlap
    raise NoTheory(f"no springs about rest are known of {type(law).__name__}")


def _hertz(law: HertzNormal, radius: np.ndarray) -> np.ndarray:
    modulus = effective_modulus(young=(law.youngs_modulus,) * 2, poisson=(law.poisson_ratio,) * 2)
    return np.array([hertz_stiffness(effective_modulus=modulus, effective_radius=r) for r in radius])


def _turning_elements(system: System, normal, along) -> dict[str, tuple]:
    """Return springs and dashpots of sliding, rolling and torsion, as far as there are any."""
    made = {}
    sliding = system.sliding
    if isinstance(sliding, SpringSliding):
        made["tangential"] = sliding.shear_stiffness, sliding.shear_damping or None
    elif isinstance(sliding, ViscousSliding):
        made["tangential"] = None, sliding.shear_damping
    elif isinstance(sliding, MindlinSliding):
        nu = system.normal.poisson_ratio
        ratio = 2 * (1 - nu) / (2 - nu)
        made["tangential"] = ratio * normal, None if along is None else math.sqrt(ratio) * along
    for family, law in (("rolling", system.rolling), ("torsion", system.torsion)):
        if law is not None and not hasattr(law, f"{family}_stiffness"):
            raise NoTheory(f"{family} without a spring jumps with the direction of motion")
        if law is not None:
            made[family] = getattr(law, f"{family}_stiffness"), getattr(law, f"{family}_damping") or None
    return made
