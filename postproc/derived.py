"""What several fields share beyond stress and fabric, worked out once a subject and only when asked for."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from postproc.averaging.cells import Cells
from postproc.macro import couple_stress, displacement, elastic_strain, motion, stiffness
from postproc.macro.contact_ends import ContactEnds, recorded_contacts
from postproc.macro.directions import orientation
from postproc.macro.springs import contact_deformation, has_tangential_springs, sides, stiffness_column
from postproc.macro.stress import kinetic_stress
from postproc.macro.tensors import Principal, principal
from postproc.snapshot import Snapshot

if TYPE_CHECKING:
    from collections.abc import Callable


class Derived:
    """Quantities of a subject in its cells; tensors at points (coarse graining) are not yet turned into the frame."""

    cells: Cells
    snapshot: Snapshot
    reference: Snapshot | None
    kn: float | None
    kt: float | None
    ends: ContactEnds
    velocity: np.ndarray
    spin: np.ndarray
    of_contacts: Callable[[str], np.ndarray]

    @cached_property
    def kinetic_stress(self) -> np.ndarray:
        """sigma^k, (K, dim, dim)."""
        return kinetic_stress(self.velocity, self.cells)

    @cached_property
    def mean_spin(self) -> np.ndarray:
        """omega, rad/s, (K,) or (K, 3)."""
        return motion.mean_spin(self.cells, self.spin)

    @cached_property
    def velocity_gradient(self) -> np.ndarray:
        """L, (K, dim, dim), 1/s."""
        return motion.velocity_gradient(self.cells, self.velocity)

    @cached_property
    def rotation_rate(self) -> np.ndarray:
        """W, rad/s, (K,) or (K, 3)."""
        return motion.rotation_rate(self.velocity_gradient)

    @cached_property
    def displacements(self) -> np.ndarray:
        """u^p since the reference, (N, dim), m."""
        return displacement.displacements(self.cells, self.reference)

    @cached_property
    def rotations(self) -> np.ndarray:
        """theta^p since the reference, (N,), rad."""
        return displacement.rotations(self.cells, self.reference)

    @cached_property
    def contact_deformation(self) -> np.ndarray:
        """Delta^pc, (E, dim), m."""
        springs = self.kt != 0 and has_tangential_springs(self.ends, self.snapshot)
        overlap = recorded_contacts(self.snapshot)["overlap"]
        return contact_deformation(self.ends, overlap, self.of_contacts("u") if springs else None)

    @cached_property
    def contact_couple(self) -> np.ndarray:
        """m^pc of the contacts themselves, N m, (E,) in 2D, (E, 3) in 3D."""
        if self.snapshot.dimension == 3:
            return self.of_contacts("m")
        return sides(self.ends) * recorded_contacts(self.snapshot)["mz"][self.ends.contact]

    @cached_property
    def branch_moments(self) -> np.ndarray:
        """(1/V) sum l (x) l, (K, dim, dim)."""
        return elastic_strain.branch_moments(self.ends, self.cells)

    @cached_property
    def elastic_strain(self) -> np.ndarray:
        """eps, (K, dim, dim), compression positive."""
        return elastic_strain.elastic_strain(self.ends, self.cells, self.contact_deformation, self.branch_moments)

    @cached_property
    def principal_strain(self) -> Principal:
        """Parts of eps."""
        return principal(self.elastic_strain)

    @cached_property
    def couple_stress(self) -> np.ndarray:
        """M of the contact forces."""
        return couple_stress.couple_stress(self.ends, self.cells)

    @cached_property
    def curvature(self) -> np.ndarray:
        """kappa, 1/m, shape of the couple stress."""
        return elastic_strain.elastic_curvature(self.ends, self.cells, self.contact_deformation, self.branch_moments)

    @cached_property
    def normal_stiffness(self) -> np.ndarray:
        """C^n, (K, dim, dim, dim, dim), in the frame."""
        kn = stiffness_column(self.snapshot, "kn", self.kn)
        return self.cells.into_frame(stiffness.normal_stiffness(self.ends, self.cells, kn), 4)

    @cached_property
    def stiffness(self) -> np.ndarray:
        """C^n + C^t, in the frame; the normal part where there are no tangential springs."""
        unknown = self.kt is None and "kt" not in recorded_contacts(self.snapshot)
        if self.kt == 0 or (unknown and not has_tangential_springs(self.ends, self.snapshot)):
            return self.normal_stiffness
        kt = stiffness_column(self.snapshot, "kt", self.kt)
        tangential = stiffness.tangential_stiffness(self.ends, self.cells, kt)
        return self.normal_stiffness + self.cells.into_frame(tangential, 4)

    def angle_of(self, parts: Principal) -> np.ndarray:
        """Angle of the major direction from the first axis of the frame, degrees, (K,)."""
        return orientation(self.cells.into_frame(parts.major, 1))

    @cached_property
    def principal_stiffness(self) -> Principal:
        """Parts of C^n_abcc/dim."""
        return principal(stiffness.directional_stiffness(self.normal_stiffness))
