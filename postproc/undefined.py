"""Why a quantity is NaN in a cell: no particles there, no contacts, or what its own formula says."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from postproc.averaging.cells import Cells
from postproc.results import Result, Value
from postproc.snapshot import Columns, MissingColumn

NO_PRESSURE = "whose mean stress is not compressive"
NO_SPREAD = "with too few particles for a gradient"
ISOTROPIC = "where it is isotropic and has no direction"
NO_ANGLE = "where one of the two is isotropic or not known"
NO_STRAIN = "with too few contacts for a strain"
NO_MODULUS = "with too few contacts for a strain, or without one"
NO_PAIRS = "without contacts between particles"

GRADIENTS = (
    "velocity_gradient", "strain_rate", "strain_rate_deviator", "rotation_rate", "eigen_rotation", "spin_gradient",
    "displacement_gradient", "rotation_gradient",
)
STRAINS = ("elastic_strain", "elastic_strain_isotropic", "elastic_strain_deviator", "curvature")
ANGLES = ("non_colinearity_stress_strain", "non_colinearity_stress_fabric", "non_colinearity_strain_fabric")

WHY: Mapping[str, str] = {
    **dict.fromkeys(GRADIENTS, NO_SPREAD),
    **dict.fromkeys(STRAINS, NO_STRAIN),
    **dict.fromkeys(ANGLES, NO_ANGLE),
    "bulk_stiffness": NO_MODULUS,
    "shear_stiffness": NO_MODULUS,
    "torque_stiffness": "without curvature, or with too few contacts for one",
    "fabric_orientation": ISOTROPIC,
    "contact_directions": NO_PAIRS,
    "wall_contact_directions": "without contacts with walls",
    "rolling_rotation": NO_PAIRS,
    "sliding_rotation": f"{NO_SPREAD}, or {NO_PAIRS}",
    "backbone_coordination_number": "with rattlers only",
    "stress_major": ISOTROPIC,
    "fabric_major": ISOTROPIC,
    "stress_ratio": "whose smallest principal stress is not compressive",
    "friction_angle": "whose smallest principal stress is tensile, or without stress",
    "kinetic_over_elastic_energy": "without elastic energy",
    "inertial_number": NO_PRESSURE,
    "unbalanced_force": "of a state without contact forces",
}
"""Reason of a NaN in a cell that has particles and contacts, as it goes on after "3 cells"."""

OTHERWISE = "where its formula has no value"


@dataclass(frozen=True, kw_only=True)
class Gaps:
    """Cells that lack something."""

    cells: Cells

    @cached_property
    def empty(self) -> np.ndarray:
        """Without particles, bool (K,)."""
        return self._lacks(lambda: self.cells.numbers)

    @cached_property
    def untouched(self) -> np.ndarray:
        """Without contacts at their particles, bool (K,); none when contacts were not recorded."""
        snapshot = self.cells.snapshot
        if snapshot.contacts is None:
            return np.zeros(len(self.empty), dtype=bool)
        touched = _in_contact(snapshot.particles, snapshot.contacts).astype(np.float64)
        return self._lacks(lambda: self.cells.total(touched))

    def _lacks(self, total: Callable[[], np.ndarray]) -> np.ndarray:
        """Cells whose total is 0; none when the state cannot give the cells at all."""
        try:
            return total() == 0.0
        except MissingColumn:
            return np.zeros(len(self.cells.labels), dtype=bool)

    def explain(self, name: str, result: Result) -> Result:
        """Return the result with the reason of its NaN, if it has any and has a value a cell."""
        if not isinstance(result, Value) or len(result.values) != len(self.empty):
            return result
        if not np.isnan(result.values.sum()):  # the short way out of most fields
            return result
        missing = np.isnan(result.values.reshape(len(result.values), -1)).any(axis=1)
        untouched = self.untouched & ~self.empty & (name not in GRADIENTS)
        groups = {
            "without particles": missing & self.empty,
            "without contacts": missing & untouched,
            WHY.get(name, OTHERWISE): missing & ~untouched & ~self.empty,
        }
        found = ", ".join(f"{group.sum()} {reason}" for reason, group in groups.items() if group.any())
        return replace(result, undefined=f"in {missing.sum()} of {len(missing)} cells: {found}")


def _in_contact(particles: Columns, contacts: Columns) -> np.ndarray:
    return np.isin(particles["id"], np.concatenate([contacts["i"], contacts["j"]]))
