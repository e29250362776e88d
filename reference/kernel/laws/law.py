"""What all contact laws share: they name what they need and what they remember.

A law is frozen data with pure functions: arrays of the touching contacts in, arrays out. Its fields bear
the names of the scene's tables. What codes do differently is a further field, filled from the convention
(`choices`: field -> field of `reference.kernel.conventions.Convention`).
"""

from __future__ import annotations

from typing import ClassVar, Protocol

import numpy as np

from reference.kernel.laws.contact import Pressing, Touching

Memory = np.ndarray | None
"""What contacts remember for one law, (rows, M); None for a law without history."""


class Law:
    """A contact law."""

    choices: ClassVar[dict[str, str]] = {}

    first_order: ClassVar[str] = ""
    """Where and why the scheme of `reference.kernel.corrected` stays of first order with this law; "": nowhere."""

    @property
    def needs(self) -> frozenset[str]:
        """Names of the fields of `Touching` that the law reads, beyond i, j, n, overlap, v_n."""
        return frozenset()

    def memory_rows(self, dimension: int) -> int:
        """Return how many numbers a contact remembers in 2 or 3 dimensions; 0 without history."""
        del dimension
        return 0


class NormalLaw(Law):
    """f_n = f_el - gamma v_n, positive in compression; v_n > 0 when the partners separate.

    With `attraction` "clipped" f_n is never negative: the contact then ends in force before it ends in
    overlap, which is another law with another restitution (Schwager & Poeschel, Granular Matter 9, 465 (2007)).
    """

    attraction: str = "allowed"
    onset: ClassVar[tuple[float, float] | None] = None
    """Exponents with which elastic force and dashpot grow from the begin of a contact, for
    `reference.kernel.corrected`; None where that scheme corrects nothing and stays of first order."""

    def force(self, contact: Touching, memory: Memory) -> tuple[np.ndarray, np.ndarray, Memory]:
        """Return f_n and f_el, (M,) in N, and the new memory."""
        elastic, memory = self.elastic(contact, memory)
        gamma = self.damping(contact)
        total = elastic if gamma is None else elastic - gamma * contact.v_n
        if self.attraction == "clipped":
            total = np.maximum(total, 0.0)
        return total, elastic, memory

    def elastic(self, contact: Touching, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Return f_el, (M,) in N, and the new memory."""
        raise NotImplementedError

    def damping(self, contact: Touching) -> float | np.ndarray | None:
        """Return gamma, kg/s, one number or (M,); None without dashpot."""
        raise NotImplementedError

    def adhesion(self, contact: Touching) -> np.ndarray | None:
        """Return how strongly the contact can pull at its overlap, (M,) in N; None if it cannot."""
        del contact
        return None

    def loading(self, contact: Touching) -> np.ndarray:
        """Return f_el by the stiffness of first loading, (M,) in N."""
        return self.elastic(contact, None)[0]

    def gripping(self, contact: Touching, total: np.ndarray, elastic: np.ndarray) -> np.ndarray:
        """Return the normal force counted from the strongest pull, (M,) in N: f_n + k_c delta (Luding 2008)."""
        del elastic
        adhesion = self.adhesion(contact)
        return total if adhesion is None else total + adhesion


class Nodes(Protocol):
    """What tells who touches whom: i, j (M,), the numbers of nodes."""

    i: np.ndarray
    j: np.ndarray


class SlidingLaw(Law):
    """A tangential force at the contact."""

    shear_friction: float | np.ndarray

    @property
    def needs(self) -> frozenset[str]:
        """The slip velocity and the arms of the torque."""
        return frozenset({"v_t"})

    def coefficient(self, contact: Nodes) -> float | np.ndarray:
        """Return mu, one number or (M,), of the contacts of two nodes each."""
        del contact
        return self.shear_friction

    def force(
        self, contact: Touching, pressing: Pressing, memory: Memory, dt: float, *, advance: bool
    ) -> tuple[np.ndarray, Memory]:
        """Return the force on i, (dim, M) in N, and the new memory; without `advance` time stands still."""
        raise NotImplementedError


class CoupleLaw(Law):
    """Rolling or torsion resistance: a couple on i, the opposite one on j, no force."""

    @property
    def needs(self) -> frozenset[str]:
        """The relative rotation and the reduced radius a*."""
        return frozenset({"spin", "reduced_radius"})

    def couple(
        self, contact: Touching, pressing: Pressing, memory: Memory, dt: float, *, advance: bool
    ) -> tuple[np.ndarray, Memory]:
        """Return the couple on i, (1|3, M) in N m, and the new memory; without `advance` time stands still."""
        raise NotImplementedError
