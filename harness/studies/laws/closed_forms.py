"""What closed forms say that a combination of laws answers in a motion with a fixed normal.

From the kinematics of the path to `reference.analytic.prescribed`, in the contact's axes (n, t, b). Codes measure slip
and torque at different lever arms, and cut spring and dashpot together or the spring alone: both are read from the
kernel's named conventions, and are all that is. NaN: a closed form does not determine this number.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import TYPE_CHECKING

import numpy as np

from harness.scene.contact import (
    ConstantRolling,
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    JkrNormal,
    LinearNormal,
    MindlinSliding,
    SpringRolling,
    SpringSliding,
    SpringTorsion,
    VariableHystereticNormal,
    ViscousSliding,
)
from harness.studies.laws.motions import DT, Grains, Motion, Partner
from reference.analytic import prescribed
from reference.kernel.conventions import Convention

if TYPE_CHECKING:
    from harness.studies.laws.cases import Laws


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Kinematics of a contact, rows 1..S, (S,): rates in m/s along t (slip, roll) and n (twist); arms in m."""

    convention: Convention
    reduced_radius: float
    reduced_mass: float
    overlap: np.ndarray
    separation: np.ndarray
    slip: np.ndarray
    roll: np.ndarray
    twist: np.ndarray
    torque_arms: tuple[np.ndarray, np.ndarray]

    def elastic(self, law: HertzNormal | DmtNormal | JkrNormal) -> prescribed.ElasticPair:
        """The two bodies as elastic spheres."""
        return prescribed.ElasticPair(
            youngs_modulus=law.youngs_modulus, poisson_ratio=law.poisson_ratio, effective_radius=self.reduced_radius
        )

    def slider(self, stiffness, damping, algorithm: str) -> prescribed.Slider:
        """A spring and dashpot in the way in which the convention cuts them."""
        cut = "spring" if algorithm == "liggghts" else "total"
        return prescribed.Slider(stiffness=stiffness, damping=damping, dt=DT, cut=cut)

    def pushed(self, slider: prescribed.Slider, rate: np.ndarray, limit: np.ndarray, algorithm: str) -> np.ndarray:
        """Force of the slider along its line; the talk's spring moves after it has answered."""
        if algorithm == "talk":
            return slider.lagging_force(self.overlap, rate, limit)
        return slider.force(self.overlap, rate, limit)


def expected(
    laws: Laws, motion: Motion, partner: Partner, grains: Grains, convention: Convention
) -> tuple[np.ndarray, np.ndarray]:
    """Return force and torque of rows 1..S, (S, bodies, 3), in (n, t, b); ValueError for a motion without course."""
    if motion.course is None:
        raise ValueError(f"{motion.name}: the normal turns, there is no closed form")
    c = contact_of(motion, partner, grains, convention)
    total, elastic = normal_force(laws.normal, c), normal_force(laws.normal, c, damped=False)
    base = limit_base(laws.normal, c, total)
    along = np.zeros(len(total)) if laws.sliding is None else sliding_force(laws, c, base, total)
    couple = np.zeros(len(total)) if laws.rolling is None else rolling_couple(laws.rolling, c, base, elastic)
    about = np.zeros(len(total)) if laws.torsion is None else torsion_couple(laws.torsion, c, base)
    force = np.stack([total, along, np.zeros(len(total))], axis=-1)
    bodies = motion.x.shape[1]
    torque = [_torque(sign, arm * along, couple, about) for sign, arm in zip((1.0, -1.0), c.torque_arms, strict=True)]
    return np.stack([force, -force][:bodies], axis=1), np.stack(torque[:bodies], axis=1)


def contact_of(motion: Motion, partner: Partner, grains: Grains, convention: Convention) -> Contact:
    """Return what the laws see of a motion, with the convention's lever arms."""
    v, w, overlap = motion.v[1:], motion.spin[1:], motion.course.overlap[1:]
    pair = partner == "pair"
    slip_arm = convention.slip_arm if pair else convention.wall_slip_arm
    torque_arm = convention.torque_arm if pair else convention.wall_torque_arm
    shift = {"radius": 0.0, "reduced": 0.5 * overlap}
    arms = [r - shift[slip_arm] for r in grains.radii]
    slip, relative = v[:, 0, 1] - arms[0] * w[:, 0, 2], w[:, 0]
    if pair:
        slip, relative = slip - v[:, 1, 1] - arms[1] * w[:, 1, 2], relative - w[:, 1]
    elif convention.wall_spin == "raised":
        relative = relative * ((grains.radii[0] - 0.5 * overlap) / (grains.radii[0] - overlap))[:, None]
    reduced = grains.reduced_radius(partner)
    return Contact(
        convention=convention, reduced_radius=reduced, reduced_mass=grains.reduced_mass(partner), overlap=overlap,
        separation=motion.course.separation[1:], slip=slip, roll=reduced * relative[:, 2],
        twist=reduced * relative[:, 0], torque_arms=tuple(r - shift[torque_arm] for r in grains.radii),
    )


def _torque(sign: float, sliding: np.ndarray, rolling: np.ndarray, torsion: np.ndarray) -> np.ndarray:
    """Return -a n x f_t + couple on i, and the same friction with the opposite couple on j, (S, 3)."""
    return np.stack([sign * torsion, np.zeros(len(sliding)), -sliding + sign * rolling], axis=-1)


# --- along the normal ------------------------------------------------------------------------------


@singledispatch
def normal_force(law, c: Contact, *, damped: bool = True) -> np.ndarray:  # noqa: ARG001 (what the laws' own take)
    """Return f_n (S,) in N, with or without the dashpot."""
    raise TypeError(f"no closed form for {type(law).__name__}")


@normal_force.register
def _(law: LinearNormal, c: Contact, *, damped: bool = True) -> np.ndarray:
    return prescribed.linear_force(
        c.overlap, c.separation * damped, stiffness=law.normal_stiffness, damping=law.normal_damping,
        clipped=law.attraction == "clipped",
    )


@normal_force.register
def _(law: HertzNormal, c: Contact, *, damped: bool = True) -> np.ndarray:
    return prescribed.hertz_force(
        c.overlap, c.separation * damped, pair=c.elastic(law), restitution=law.restitution,
        reduced_mass=c.reduced_mass, clipped=law.attraction == "clipped",
    )


@normal_force.register
def _(law: HystereticNormal, c: Contact, *, damped: bool = True) -> np.ndarray:
    return prescribed.hysteretic_force(
        c.overlap, c.separation * damped, loading=law.loading_stiffness, unloading=law.unloading_stiffness,
        adhesion=law.adhesion_stiffness, damping=law.normal_damping,
    )


@normal_force.register
def _(law: VariableHystereticNormal, c: Contact, *, damped: bool = True) -> np.ndarray:
    k_1, k_p = law.loading_stiffness, law.largest_unloading_stiffness
    return prescribed.variable_hysteretic_force(
        c.overlap, c.separation * damped, loading=k_1, limit=k_p, adhesion=law.adhesion_stiffness,
        damping=law.normal_damping,
        limit_overlap=k_p / (k_p - k_1) * law.plasticity_depth * 2.0 * c.reduced_radius,
    )


@normal_force.register
def _(law: DmtNormal, c: Contact, *, damped: bool = True) -> np.ndarray:
    return prescribed.dmt_force(
        c.overlap, c.separation * damped, pair=c.elastic(law), surface_energy=law.surface_energy,
        damping=law.normal_damping,
    )


@normal_force.register
def _(law: JkrNormal, c: Contact, *, damped: bool = True) -> np.ndarray:
    pair = c.elastic(law)
    return prescribed.jkr_force(
        c.overlap, c.separation * damped, pair=pair, surface_energy=law.surface_energy, damping=law.normal_damping,
        tearing_overlap=prescribed.jkr_overlap_of_largest_pull(pair, law.surface_energy),
    )


def limit_base(law, c: Contact, total: np.ndarray) -> np.ndarray:
    """What coefficients of friction are multiplied by, (S,) in N: f_n + k_c delta, its size or its positive part."""
    if isinstance(law, HystereticNormal | VariableHystereticNormal):
        total = total + law.adhesion_stiffness * np.maximum(c.overlap, 0.0)
    return np.abs(total) if c.convention.limit == "absolute" else np.maximum(total, 0.0)


# --- along and about the contact -------------------------------------------------------------------


def sliding_force(laws: Laws, c: Contact, base: np.ndarray, total: np.ndarray) -> np.ndarray:
    """Return f_t along t, (S,) in N."""
    law, algorithm = laws.sliding, c.convention.sliding
    limit = law.shear_friction * base
    if isinstance(law, ViscousSliding):
        if c.convention.viscous_limit == "total":
            limit = law.shear_friction * np.abs(total)
        return prescribed.viscous_force(c.slip, limit, damping=law.shear_damping)
    if isinstance(law, MindlinSliding):
        return _mindlin(laws.normal, c, limit, algorithm)
    slider = c.slider(law.shear_stiffness, law.shear_damping, algorithm)
    if law.dynamic_friction is None:
        return c.pushed(slider, c.slip, limit, algorithm)
    return _with_dynamic_coefficient(law, c, slider, base, algorithm)


def _mindlin(normal: HertzNormal, c: Contact, limit: np.ndarray, algorithm: str) -> np.ndarray:
    pair = c.elastic(normal)
    stiffness = pair.shear_stiffness(c.overlap)
    damping = prescribed.constant_restitution_damping(
        stiffness, restitution=normal.restitution, reduced_mass=c.reduced_mass
    )
    return c.pushed(c.slider(stiffness, damping, algorithm), c.slip, limit, algorithm)


def _with_dynamic_coefficient(law: SpringSliding, c: Contact, slider, base: np.ndarray, algorithm: str) -> np.ndarray:
    """The talk's spring moves after it has answered, which makes the row of slipping another one: not determined."""
    static, carried = law.shear_friction * base, law.dynamic_friction * base
    if algorithm == "talk" or law.shear_damping:
        return np.where(_has_slid(slider, c, static), np.nan, c.pushed(slider, c.slip, static, algorithm))
    return slider.dynamic_force(c.overlap, c.slip, static, carried, remembers=algorithm != "liggghts")


def _has_slid(slider: prescribed.Slider, c: Contact, limit: np.ndarray) -> np.ndarray:
    """From the first row at the static limit on, until the contact opens."""
    force = np.abs(slider.lagging_force(c.overlap, c.slip, limit))
    at_limit, slid = np.isnan(force) | ((force >= limit) & (c.overlap > 0.0)), np.zeros(len(limit), bool)
    for k in range(1, len(limit)):
        slid[k] = c.overlap[k] > 0.0 and (slid[k - 1] or at_limit[k])
    return slid


def rolling_couple(
    law: SpringRolling | ConstantRolling, c: Contact, base: np.ndarray, elastic: np.ndarray
) -> np.ndarray:
    """Return the couple on i about b, (S,) in N m."""
    if isinstance(law, ConstantRolling):
        return -np.sign(c.roll) * law.rolling_friction * c.reduced_radius * elastic
    algorithm = c.convention.rolling
    slider = c.slider(law.rolling_stiffness, law.rolling_damping, algorithm)
    return c.reduced_radius * c.pushed(slider, c.roll, law.rolling_friction * base, algorithm)


def torsion_couple(law: SpringTorsion, c: Contact, base: np.ndarray) -> np.ndarray:
    """Return the couple on i about n, (S,) in N m; NaN where the limit shrinks at rest (LAMMPS' own rule there)."""
    algorithm = c.convention.torsion
    slider = c.slider(law.torsion_stiffness, law.torsion_damping, algorithm)
    couple = c.reduced_radius * c.pushed(slider, c.twist, law.torsion_friction * base, algorithm)
    opening = (algorithm == "lammps_twisting") & (c.overlap > 0.0) & (c.separation > 0.0)
    return np.where(opening, np.nan, couple)
