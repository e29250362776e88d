"""The quantities of a state, one line each: name, unit, shape, formula.

Adding a quantity is a formula in `postproc.macro` and a line here. A formula that lacks something
raises MissingColumn, and the quantity is unavailable for that reason; the others are not touched.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.macro.balance import unbalanced_force
from postproc.macro.contact_ends import ContactEnds, contact_ends
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
from postproc.macro.fabric import contact_fabric, fabric
from postproc.macro.inertial_number import inertial_number
from postproc.macro.strain import axial_strain, volumetric_strain
from postproc.macro.strength import friction_angle, stress_ratio
from postproc.macro.stress import kinetic_stress, stress
from postproc.macro.tensors import Principal, principal
from postproc.macro.volume_fraction import volume_fraction
from postproc.macro.wall_stress import stress_from_wall_contacts, stress_from_walls
from postproc.results import Result, Unavailable, Value
from postproc.snapshot import MissingColumn, Snapshot


@dataclass(frozen=True, kw_only=True)
class Subject:
    """A state in its cells, with the settings of the formulas; what several of them need, once.

    reference: state that strains are measured from. rate: strain rate, 1/s. gravity: m/s^2, (dim,).
    kn, kt: stiffnesses of linear springs, N/m, in place of the columns.
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
        """Contacts as the particles see them."""
        return contact_ends(self.snapshot)

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

    rank: "scalar", "vector" (dim), "principal" (dim, largest first), "tensor" (dim, dim).
    """

    name: str
    unit: str
    rank: str
    formula: Callable[[Subject], np.ndarray]

    def evaluate(self, subject: Subject) -> Result:
        """Return the value, or why there is none.

        A 2D state of thickness 1 is one per unit thickness: its stresses are forces per length, N/m.
        """
        try:
            values = np.asarray(self.formula(subject), dtype=np.float64) + 0.0  # turns -0 into 0
        except MissingColumn as missing:
            return Unavailable(reason=str(missing))
        snapshot = subject.snapshot
        unit = "N/m" if self.unit == "Pa" and snapshot.per_thickness else self.unit
        return Value(values=values, unit=unit, components=COMPONENTS[self.rank](snapshot.axes))


COMPONENTS: dict[str, Callable[[tuple[str, ...]], tuple[str, ...]]] = {
    "scalar": lambda axes: (),  # noqa: ARG005
    "vector": lambda axes: axes,
    "principal": lambda axes: tuple(str(k + 1) for k in range(len(axes))),
    "tensor": lambda axes: tuple(a + b for a in axes for b in axes),
}

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
    Field("kinetic_stress", "Pa", "tensor", lambda s: kinetic_stress(s.cells)),
    Field("fabric", "1", "tensor", lambda s: s.fabric),
    Field("fabric_trace", "1", "scalar", lambda s: s.principal_fabric.values.sum(axis=1)),
    Field("fabric_deviator", "1", "scalar", lambda s: s.principal_fabric.deviator),
    Field("fabric_principal", "1", "principal", lambda s: s.principal_fabric.values),
    Field("fabric_major", "1", "vector", lambda s: s.principal_fabric.major),
    Field("contact_fabric", "1", "tensor", lambda s: contact_fabric(s.ends, s.cells)),
    Field("translational_energy", "J", "scalar", lambda s: translational_energy(s.cells)),
    Field("rotational_energy", "J", "scalar", lambda s: rotational_energy(s.cells)),
    Field("normal_elastic_energy", "J", "scalar", lambda s: normal_elastic_energy(s.ends, s.cells, s.kn)),
    Field("tangential_elastic_energy", "J", "scalar",
          lambda s: tangential_elastic_energy(s.ends, s.cells, s.kt)),
    Field("kinetic_over_elastic_energy", "1", "scalar", lambda s: divide(s.kinetic_energy, s.elastic_energy)),
    Field("inertial_number", "1", "scalar",
          lambda s: inertial_number(s.rate, s.cells, s.principal_stress.isotropic)),
    Field("unbalanced_force", "1", "scalar", lambda s: unbalanced_force(s.ends, s.cells, s.gravity)),
)
"""Quantities of every cell, values (K, ...)."""

OF_STATE = (
    Field("axial_strain", "1", "vector", lambda s: axial_strain(s.snapshot, s.reference)[None]),
    Field("volumetric_strain", "1", "scalar", lambda s: [volumetric_strain(s.snapshot, s.reference)]),
    Field("stress_from_walls", "Pa", "tensor", lambda s: stress_from_walls(s.snapshot)[None]),
    Field("stress_from_wall_contacts", "Pa", "tensor", lambda s: stress_from_wall_contacts(s.snapshot)[None]),
)
"""Quantities of the whole box, values (1, ...)."""
