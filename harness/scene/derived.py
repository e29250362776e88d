"""Numbers that follow from a scene: time scales, restitution, rate, and how far from the limits they are."""

from __future__ import annotations

import math
from dataclasses import dataclass

from harness.scene.grains import Grains, grains_of
from harness.scene.model import Biaxial, LoadedMotion, Scene, SideWall
from harness.scene.numerics import (
    PairScales,
    StabilityLimit,
    StepPlan,
    loaded_walls,
    met_head_on,
    plan_steps,
    stability_limit,
    stiffest_at_wall,
)
from harness.scene.system import System


@dataclass(frozen=True, kw_only=True)
class WallScales:
    """A wall with mass: how many particles touch it (estimated), and its times in s.

    period: 2 pi sqrt(M/(n k_n)) with the law's largest stiffness, as if the particles stood still.
    damping_time: M/gamma_wall, None without damping. inertia_share, damping_share: largest M x''/(p z)
    and gamma x'/(p z) while the sample gives way sideways as fast as it is compressed; None where no
    strain is prescribed.
    """

    name: str
    contacts: float
    period: float
    damping_time: float | None
    inertia_share: float | None
    damping_share: float | None


@dataclass(frozen=True, kw_only=True)
class Derived:
    """All of it; see the functions for the formulas. `packed` tells whether the particles are the actual ones."""

    grains: Grains
    packed: bool
    pairs: tuple[PairScales, ...]
    plan: StepPlan
    stability: StabilityLimit
    walls: tuple[WallScales, ...]
    inertial_number: float | None

    @property
    def stability_margin(self) -> float:
        """Stability limit over dt: above 1 is stable."""
        return self.stability.dt / self.plan.dt

    @property
    def steps_per_contact(self) -> float:
        """Time scale of the smallest pair over dt."""
        return self.pairs[0].met.time_scale / self.plan.dt


def derive(scene: Scene, system: System | None = None) -> Derived:
    """Return what follows from the scene, and from its particles once they are known."""
    grains = _grains(scene, system)
    return Derived(
        grains=grains,
        packed=system is not None,
        pairs=met_head_on(scene.contact, grains),
        plan=plan_steps(scene, grains),
        stability=stability_limit(scene, grains),
        walls=tuple(wall_scales(scene, name, wall, grains) for name, wall in loaded_walls(scene)),
        inertial_number=peak_inertial_number(scene, system) if isinstance(scene, Biaxial) else None,
    )


def peak_strain_rate(scene: Biaxial) -> float:
    """Return the largest |z'|/z of the top wall, 1/s: pi eps_f / (2 T sqrt(1 - eps_f)).

    z = z_0 [1 - (eps_f/2)(1 - cos(pi t/T))]; the maximum lies where cos(pi t/T) = -a/(1 - a), a = eps_f/2,
    a little after half time, when the sample is already lower.
    """
    strain, time = scene.top.final_strain, scene.top.duration
    return math.pi * strain / (2 * time * math.sqrt(1 - strain))


def peak_inertial_number(scene: Biaxial, system: System | None = None) -> float:
    """Return I = eps' sqrt(m/p), with the peak strain rate, mean mass (kg) and side pressure (N/m).

    The 2D form of I (F. da Cruz et al., Phys. Rev. E 72, 021309 (2005)); quasistatic below about 1e-3.
    """
    return peak_strain_rate(scene) * math.sqrt(_grains(scene, system).mean_mass / scene.side.pressure)


def wall_scales(scene: Scene, name: str, wall: LoadedMotion | SideWall, grains: Grains) -> WallScales:
    """Return the time scales of a loaded wall; the shares take x' = L eps', x'' = L eps'' and z = L.

    eps'' is at most pi^2 eps_f/(2 T^2) of the cosine, at its ends.
    """
    contacts, stiffness = grains.per_wall, stiffest_at_wall(scene.contact, grains).stiffness
    inertia = damping = None
    if isinstance(scene, Biaxial):
        acceleration = math.pi**2 * scene.top.final_strain / (2 * scene.top.duration**2)
        inertia = wall.mass * acceleration / wall.pressure
        damping = wall.damping * peak_strain_rate(scene) / wall.pressure
    return WallScales(
        name=name, contacts=contacts,
        period=2 * math.pi * math.sqrt(wall.mass / (contacts * stiffness)),
        damping_time=wall.mass / wall.damping if wall.damping else None,
        inertia_share=inertia, damping_share=damping,
    )


def _grains(scene: Scene, system: System | None) -> Grains:
    if system is None:
        return grains_of(scene)
    side = system.wall("top").point[1] if isinstance(scene, Biaxial) else None
    return grains_of(scene, system.particles, side)
