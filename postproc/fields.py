"""The quantities of a state, one line each: name, unit, shape, formula.

Adding a quantity is a formula in `postproc.macro` and a line here. A formula that lacks something
raises MissingColumn, and the quantity is unavailable for that reason; the others are not touched.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.derived import Derived
from postproc.geometry import vector
from postproc.macro import couple_stress, directions, displacement, eigen_rotations, elastic_strain, motion, stiffness
from postproc.macro.axial import axial
from postproc.macro.balance import unbalanced_force
from postproc.macro.contact_ends import ContactEnds, contact_ends, recorded_contacts
from postproc.macro.coordination import (
    MINIMUM_CONTACTS,
    backbone_coordination_number,
    coordination_number,
    rattler_fraction,
)
from postproc.macro.energy import (
    normal_elastic_energy,
    rotational_energy,
    tangential_elastic_energy,
    translational_energy,
)
from postproc.macro.fabric import (
    contact_fabric,
    contact_number_density,
    corrected_fabric,
    fabric,
    polydispersity,
)
from postproc.macro.inertial_number import inertial_number
from postproc.macro.strain import axial_strain, volumetric_strain
from postproc.macro.strength import friction_angle, stress_ratio
from postproc.macro.stress import stress
from postproc.macro.tensors import Principal, principal
from postproc.macro.volume_fraction import volume_fraction
from postproc.macro.wall_stress import stress_from_wall_contacts, stress_from_walls
from postproc.results import Result, Unavailable, Value
from postproc.snapshot import MissingColumn, Snapshot


@dataclass(frozen=True, kw_only=True)
class Subject(Derived):
    """A state in its cells, with the settings of the formulas; what several of them need, once.

    reference: state that strains are measured from. rate: strain rate, 1/s. gravity: m/s^2, (dim,).
    kn, kt: stiffnesses of linear springs, N/m, in place of the columns.

    Vectors of particles (`velocity`, `spin`, `acceleration`) and of contact ends (`ends`, `of_contacts`) are in the
    components of the cells' frame, so that no formula needs to know it.
    """

    cells: Cells
    minimum_contacts: int = MINIMUM_CONTACTS
    kn: float | None = None
    kt: float | None = None
    reference: Snapshot | None = None
    rate: float | None = None
    gravity: tuple[float, ...] | None = None

    @property
    def snapshot(self) -> Snapshot:
        """The state."""
        return self.cells.snapshot

    @cached_property
    def ends(self) -> ContactEnds:
        """Contacts as the particles see them, vectors in the frame."""
        ends = contact_ends(self.snapshot)
        if self.cells.turn is None:
            return ends
        turned = {letter: self.cells.turned(getattr(ends, letter), ends.particle) for letter in ("l", "f")}
        return replace(ends, **turned)

    def of_contacts(self, letter: str) -> np.ndarray:
        """Vector columns <letter>x, <letter>y[, <letter>z] of the contacts at each end, (E, dim), in the frame.

        As it stands in the file at i, reversed at j: what i does relative to j, j does the other way round.
        """
        ends, contacts = self.ends, recorded_contacts(self.snapshot)
        sign = np.where(np.arange(len(ends.contact)) < contacts.rows, 1.0, -1.0)
        return self.cells.turned(sign[:, None] * vector(contacts, letter, self.snapshot)[ends.contact], ends.particle)

    @cached_property
    def velocity(self) -> np.ndarray:
        """v^p, (N, dim), m/s, in the frame."""
        return self.cells.turned(vector(self.snapshot.particles, "v", self.snapshot))

    @cached_property
    def spin(self) -> np.ndarray:
        """omega^p, rad/s: (N,), counter-clockwise, in 2D; (N, 3) in 3D, in the frame."""
        if self.snapshot.dimension == 2:
            return self.snapshot.particles["wz"]
        return self.cells.turned(vector(self.snapshot.particles, "w", self.snapshot))

    @cached_property
    def acceleration(self) -> np.ndarray | None:
        """Gravity on each particle, (N, dim), m/s^2, in the frame; None when none was given."""
        if self.gravity is None:
            return None
        shape = self.snapshot.particles.rows, self.snapshot.dimension
        return self.cells.turned(np.broadcast_to(self.gravity, shape))

    @cached_property
    def stress(self) -> np.ndarray:
        """sigma, (K, dim, dim)."""
        return stress(self.ends, self.cells)

    @cached_property
    def principal_stress(self) -> Principal:
        """Its parts."""
        return principal(self.stress)

    @cached_property
    def fabric(self) -> np.ndarray:
        """F, (K, dim, dim)."""
        return fabric(self.ends, self.cells)

    @cached_property
    def principal_fabric(self) -> Principal:
        """Its parts."""
        return principal(self.fabric)

    @cached_property
    def elastic_energy(self) -> np.ndarray:
        """Normal and tangential, J, (K,)."""
        tangential = tangential_elastic_energy(self.ends, self.cells, self.kt)
        return normal_elastic_energy(self.ends, self.cells, self.kn) + tangential

    @cached_property
    def kinetic_energy(self) -> np.ndarray:
        """Translation and rotation, J, (K,)."""
        return translational_energy(self.cells) + rotational_energy(self.cells)


@dataclass(frozen=True)
class Field:
    """One quantity: a row of the tables below.

    rank: "scalar"; "vector" (dim); "principal" (dim), largest first; "tensor" (dim, dim); "axial", what turns: a scalar
    in 2D, counter-clockwise positive, a vector in 3D; "couple": axial times vector, (2,) or (3, 3), first the axis
    of the turn; "stiffness": pairs of indices, (3, 3) or (6, 6); "histogram" over directions in the plane (bins).
    """

    name: str
    unit: str
    rank: str
    formula: Callable[[Subject], np.ndarray]

    def evaluate(self, subject: Subject) -> Result:
        """Return the value, or why there is none.

        A 2D state of thickness 1 is one per unit thickness: its stresses are forces per length, N/m.
        Components are those of the cells' frame.
        """
        return self._evaluate(subject, subject.cells.axes, subject.cells.into_frame)

    def evaluate_state(self, subject: Subject) -> Result:
        """The same for a quantity of the whole state: Cartesian, whatever the frame of the cells."""
        return self._evaluate(subject, subject.snapshot.axes, lambda values, order: values)  # noqa: ARG005

    def _evaluate(
        self, subject: Subject, axes: tuple[str, ...], into_frame: Callable[[np.ndarray, int], np.ndarray]
    ) -> Result:
        try:
            values = np.asarray(self.formula(subject), dtype=np.float64) + 0.0  # turns -0 into 0
            values = into_frame(values, values.ndim - 1 if self.rank in TURNING else 0)
        except MissingColumn as missing:
            return Unavailable(reason=str(missing))
        unit = PER_THICKNESS.get(self.unit, self.unit) if subject.snapshot.per_thickness else self.unit
        return Value(values=values, unit=unit, components=COMPONENTS[self.rank](axes))


COMPONENTS: dict[str, Callable[[tuple[str, ...]], tuple[str, ...]]] = {
    "scalar": lambda axes: (),  # noqa: ARG005
    "vector": lambda axes: axes,
    "principal": lambda axes: tuple(str(k + 1) for k in range(len(axes))),
    "tensor": lambda axes: tuple(a + b for a in axes for b in axes),
    "axial": lambda axes: () if len(axes) == 2 else axes,
    "couple": lambda axes: axes if len(axes) == 2 else tuple(a + b for a in axes for b in axes),
    "stiffness": lambda axes: tuple(a + b for a in _pairs(axes) for b in _pairs(axes)),
    "histogram": lambda axes: tuple(f"{360 * k / directions.BINS:03.0f}" for k in range(directions.BINS)),  # noqa: ARG005
}


def _pairs(axes: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(axes[a] + axes[b] for a, b in stiffness.VOIGT[len(axes)])


TURNING = ("vector", "tensor", "axial", "couple")
"""Ranks that turn with the frame, each index of them."""

PER_THICKNESS = {
    "Pa": "N/m", "J/m^3": "J/m^2", "1/m^3": "1/m^2", "kg/(m^2 s)": "kg/(m s)", "N/m": "N", "N": "N m",
    "N/m^3": "N/m^2",
}
"""Units of fields per volume, and what they are per area, in a 2D state of thickness 1."""

IN_CELLS = (
    Field("particles", "1", "scalar", lambda s: s.cells.total(np.ones(s.snapshot.particles.rows))),
    Field("volume_fraction", "1", "scalar", lambda s: volume_fraction(s.cells)),
    Field("coordination_number", "1", "scalar", lambda s: coordination_number(s.ends, s.cells)),
    Field("backbone_coordination_number", "1", "scalar",
          lambda s: backbone_coordination_number(s.ends, s.cells, s.minimum_contacts)),
    Field("rattler_fraction", "1", "scalar", lambda s: rattler_fraction(s.ends, s.cells, s.minimum_contacts)),
    Field("stress", "Pa", "tensor", lambda s: s.stress),
    Field("stress_isotropic", "Pa", "scalar", lambda s: s.principal_stress.isotropic),
    Field("stress_deviator", "Pa", "scalar", lambda s: s.principal_stress.deviator),
    Field("stress_principal", "Pa", "principal", lambda s: s.principal_stress.values),
    Field("stress_major", "1", "vector", lambda s: s.principal_stress.major),
    Field("stress_ratio", "1", "scalar", lambda s: stress_ratio(s.principal_stress.values)),
    Field("friction_angle", "deg", "scalar", lambda s: friction_angle(s.principal_stress.values)),
    Field("stress_antisymmetric", "Pa", "axial", lambda s: axial(s.stress)),
    Field("kinetic_stress", "Pa", "tensor", lambda s: s.kinetic_stress),
    Field("total_stress", "Pa", "tensor", lambda s: s.stress + s.kinetic_stress),
    Field("momentum_density", "kg/(m^2 s)", "vector", lambda s: motion.momentum_density(s.cells, s.velocity)),
    Field("velocity", "m/s", "vector", lambda s: motion.mean_velocity(s.cells, s.velocity)),
    Field("velocity_density", "m/s", "vector", lambda s: motion.velocity_density(s.cells, s.velocity)),
    Field("velocity_gradient", "1/s", "tensor", lambda s: s.velocity_gradient),
    Field("strain_rate", "1/s", "tensor", lambda s: motion.strain_rate(s.velocity_gradient)),
    Field("strain_rate_deviator", "1/s", "scalar", lambda s: principal(s.velocity_gradient).deviator),
    Field("rotation_rate", "rad/s", "axial", lambda s: s.rotation_rate),
    Field("spin_density", "rad/s", "axial", lambda s: motion.spin_density(s.cells, s.spin)),
    Field("spin", "rad/s", "axial", lambda s: s.mean_spin),
    Field("eigen_rotation", "rad/s", "axial", lambda s: motion.eigen_rotation(s.mean_spin, s.rotation_rate)),
    Field("spin_gradient", "rad/(m s)", "couple", lambda s: motion.spin_gradient(s.cells, s.spin)),
    Field("sliding_rotation", "rad/s", "axial",
          lambda s: eigen_rotations.sliding_rotation(s.ends, s.cells, s.spin, s.rotation_rate)),
    Field("rolling_rotation", "rad/s", "vector",
          lambda s: eigen_rotations.rolling_rotation(s.ends, s.cells, s.spin)),
    Field("displacement", "m", "vector", lambda s: displacement.mean_displacement(s.cells, s.displacements)),
    Field("displacement_gradient", "1", "tensor",
          lambda s: displacement.displacement_gradient(s.cells, s.displacements)),
    Field("rotation", "rad", "scalar", lambda s: displacement.mean_rotation(s.cells, s.rotations)),
    Field("rotation_gradient", "rad/m", "vector", lambda s: displacement.rotation_gradient(s.cells, s.rotations)),
    Field("contact_number_density", "1/m^3", "scalar", lambda s: contact_number_density(s.ends, s.cells)),
    Field("fabric", "1", "tensor", lambda s: s.fabric),
    Field("fabric_trace", "1", "scalar", lambda s: s.principal_fabric.values.sum(axis=1)),
    Field("fabric_deviator", "1", "scalar", lambda s: s.principal_fabric.deviator),
    Field("fabric_principal", "1", "principal", lambda s: s.principal_fabric.values),
    Field("fabric_major", "1", "vector", lambda s: s.principal_fabric.major),
    Field("fabric_orientation", "deg", "scalar", lambda s: s.angle_of(s.principal_fabric)),
    Field("polydispersity", "1", "scalar", lambda s: polydispersity(s.cells)),
    Field("fabric_corrected", "1", "tensor", lambda s: corrected_fabric(s.fabric, polydispersity(s.cells))),
    Field("contact_fabric", "1", "tensor", lambda s: contact_fabric(s.ends, s.cells)),
    Field("contact_directions", "1/rad", "histogram", lambda s: directions.contact_directions(s.ends, s.cells)),
    Field("wall_contact_directions", "1/rad", "histogram",
          lambda s: directions.contact_directions(s.ends, s.cells, walls=True)),
    Field("elastic_strain", "1", "tensor", lambda s: s.elastic_strain),
    Field("elastic_strain_isotropic", "1", "scalar", lambda s: s.principal_strain.isotropic),
    Field("elastic_strain_deviator", "1", "scalar", lambda s: s.principal_strain.deviator),
    Field("bulk_stiffness", "Pa", "scalar",
          lambda s: elastic_strain.bulk_stiffness(s.principal_stress, s.principal_strain)),
    Field("shear_stiffness", "Pa", "scalar",
          lambda s: elastic_strain.shear_stiffness(s.principal_stress, s.principal_strain)),
    Field("non_colinearity_stress_strain", "deg", "scalar",
          lambda s: directions.non_colinearity(s.principal_stress.major, s.principal_strain.major)),
    Field("non_colinearity_stress_fabric", "deg", "scalar",
          lambda s: directions.non_colinearity(s.principal_stress.major, s.principal_fabric.major)),
    Field("non_colinearity_strain_fabric", "deg", "scalar",
          lambda s: directions.non_colinearity(s.principal_strain.major, s.principal_fabric.major)),
    Field("couple_stress", "N/m", "couple", lambda s: s.couple_stress),
    Field("contact_couple_stress", "N/m", "couple",
          lambda s: couple_stress.contact_couple_stress(s.ends, s.cells, s.contact_couple)),
    Field("curvature", "rad/m", "couple", lambda s: s.curvature),
    Field("torque_stiffness", "N", "scalar", lambda s: couple_stress.torque_stiffness(s.couple_stress, s.curvature)),
    Field("stiffness", "Pa", "stiffness", lambda s: stiffness.voigt(s.stiffness)),
    Field("normal_stiffness", "Pa", "stiffness", lambda s: stiffness.voigt(s.normal_stiffness)),
    Field("stiffness_anisotropy", "1", "scalar", lambda s: stiffness.stiffness_anisotropy(s.normal_stiffness)),
    Field("principal_stiffness_anisotropy", "1", "scalar",
          lambda s: stiffness.principal_stiffness_anisotropy(s.normal_stiffness, s.principal_stiffness)),
    Field("contact_bulk_modulus", "Pa", "scalar", lambda s: stiffness.contact_bulk_modulus(s.stiffness)),
    Field("contact_shear_modulus", "Pa", "scalar", lambda s: stiffness.contact_shear_modulus(s.stiffness)),
    Field("translational_energy", "J", "scalar", lambda s: translational_energy(s.cells)),
    Field("rotational_energy", "J", "scalar", lambda s: rotational_energy(s.cells)),
    Field("normal_elastic_energy", "J", "scalar", lambda s: normal_elastic_energy(s.ends, s.cells, s.kn)),
    Field("tangential_elastic_energy", "J", "scalar",
          lambda s: tangential_elastic_energy(s.ends, s.cells, s.kt)),
    Field("elastic_energy_density", "J/m^3", "scalar", lambda s: s.elastic_energy / s.cells.volumes),
    Field("translational_energy_density", "J/m^3", "scalar",
          lambda s: translational_energy(s.cells) / s.cells.volumes),
    Field("rotational_energy_density", "J/m^3", "scalar", lambda s: rotational_energy(s.cells) / s.cells.volumes),
    Field("kinetic_over_elastic_energy", "1", "scalar", lambda s: divide(s.kinetic_energy, s.elastic_energy)),
    Field("inertial_number", "1", "scalar",
          lambda s: inertial_number(s.rate, s.cells, s.principal_stress.isotropic)),
    Field("unbalanced_force", "1", "scalar", lambda s: unbalanced_force(s.ends, s.cells, s.acceleration)),
)
"""Quantities of every cell, values (K, ...)."""

AT_POINTS = (
    Field("interaction_force_density", "N/m^3", "vector", lambda s: s.cells.interaction_force_density(s.ends)),
)
"""Quantities that only a kernel spreads in space, values (K, ...); of other cells they are not among all fields."""

OF_STATE = (
    Field("axial_strain", "1", "vector", lambda s: axial_strain(s.snapshot, s.reference)[None]),
    Field("volumetric_strain", "1", "scalar", lambda s: [volumetric_strain(s.snapshot, s.reference)]),
    Field("stress_from_walls", "Pa", "tensor", lambda s: stress_from_walls(s.snapshot)[None]),
    Field("stress_from_wall_contacts", "Pa", "tensor", lambda s: stress_from_wall_contacts(s.snapshot)[None]),
)
"""Quantities of the whole box, values (1, ...)."""
