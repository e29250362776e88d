"""Laws whose numbers depend on who touches whom: tables over pairs of materials in the place of numbers.

A contact (i, j) of the materials a and b has the number T_ab of every table T, which is symmetric. The formulas are
those of `linear` and `sliding`, given one number a contact. Nothing is mixed: a table is whole.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Pressing, Touching
from reference.kernel.laws.law import Law, Memory, Nodes, NormalLaw, SlidingLaw
from reference.kernel.laws.linear import LinearNormal
from reference.kernel.laws.slider import memory_rows
from reference.kernel.laws.sliding import SpringSliding


class ByPair(Law):
    """A law with tables. kind: (nodes,), the number of each node's material, from 0 on; walls follow the particles.

    Raises ValueError for a table that is not (K, K) and symmetric, K the number of materials.
    """

    numbers: ClassVar[tuple[str, ...]]
    """Fields that are tables."""

    kind: np.ndarray

    def __post_init__(self) -> None:
        count = int(self.kind.max(initial=0)) + 1
        for name in self.numbers:
            table = getattr(self, name)
            if table.ndim != 2 or len(table) < count or not np.array_equal(table, table.T):
                raise ValueError(f"{name}: expected a symmetric table over {count} materials, got {table.tolist()}")

    def between(self, i: np.ndarray, j: np.ndarray) -> dict[str, np.ndarray]:
        """Return the numbers of pairs of nodes, (M,) each, by name."""
        a, b = self.kind.take(i), self.kind.take(j)
        return {name: getattr(self, name)[a, b] for name in self.numbers}


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearByPair(ByPair, NormalLaw):
    """f_n = k_ab delta - gamma_ab v_n; `attraction` "allowed" or "clipped" as in `NormalLaw`."""

    numbers: ClassVar[tuple[str, ...]] = ("normal_stiffness", "normal_damping")
    onset: ClassVar[tuple[float, float] | None] = LinearNormal.onset

    normal_stiffness: np.ndarray
    normal_damping: np.ndarray
    attraction: str
    kind: np.ndarray

    def elastic(self, contact: Touching, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Return k_ab delta, (M,) in N."""
        return self.between(contact.i, contact.j)["normal_stiffness"] * contact.overlap, memory

    def damping(self, contact: Touching) -> np.ndarray | None:
        """Return gamma_ab, (M,) in kg/s; None where no pair has a dashpot."""
        return self.between(contact.i, contact.j)["normal_damping"] if self.normal_damping.any() else None

    def energy(self, contact: Touching) -> np.ndarray:
        """Return the stored energy k_ab delta^2 / 2, shape (M,), in J."""
        return 0.5 * self.between(contact.i, contact.j)["normal_stiffness"] * contact.overlap**2


@dataclass(frozen=True, kw_only=True, eq=False)
class SpringByPair(ByPair, SlidingLaw):
    """f_t = -k_ab xi - gamma_ab v_t up to mu_ab f: `SpringSliding` without a dynamic coefficient."""

    choices: ClassVar[dict[str, str]] = SpringSliding.choices
    first_order: ClassVar[str] = SpringSliding.first_order
    numbers: ClassVar[tuple[str, ...]] = ("shear_friction", "shear_stiffness", "shear_damping")

    shear_friction: np.ndarray
    shear_stiffness: np.ndarray
    shear_damping: np.ndarray
    algorithm: str
    kind: np.ndarray

    def memory_rows(self, dimension: int) -> int:
        """Return the rows of the spring."""
        return memory_rows(dimension, self.algorithm, None)

    def coefficient(self, contact: Nodes) -> np.ndarray:
        """Return mu_ab, (M,)."""
        return self.between(contact.i, contact.j)["shear_friction"]

    def force(
        self, contact: Touching, pressing: Pressing, memory: Memory, dt: float, *, advance: bool
    ) -> tuple[np.ndarray, Memory]:
        """Return the force on i, (dim, M) in N, and the new memory."""
        return self._at(contact).force(contact, pressing, memory, dt, advance=advance)

    def spring(self, contact: Touching) -> tuple[np.ndarray, np.ndarray]:
        """Return k_ab, (M,) in N/m, and gamma_ab, (M,) in kg/s."""
        found = self.between(contact.i, contact.j)
        return found["shear_stiffness"], found["shear_damping"]

    def energy(self, contact: Touching, memory: np.ndarray) -> np.ndarray:
        """Return the stored energy k_ab xi^2 / 2, shape (M,), in J."""
        return self._at(contact).energy(contact, memory)

    def _at(self, contact: Touching) -> SpringSliding:
        """Return the law with one number a contact."""
        return SpringSliding(algorithm=self.algorithm, **self.between(contact.i, contact.j))


BY_PAIR: dict[type[Law], type[ByPair]] = {LinearNormal: LinearByPair, SpringSliding: SpringByPair}
"""The law with tables in the place of one without."""


def with_tables(law: type[Law], kind: np.ndarray, parameters: dict) -> Law:
    """Return a law of this class, whose numbers in `parameters` are tables. Raises ValueError for one that has none."""
    if law not in BY_PAIR:
        raise ValueError(f"{law.__name__} has one set of numbers for all contacts, got tables over pairs of materials")
    made = BY_PAIR[law]
    return made(kind=kind, **parameters | {name: np.array(parameters[name]) for name in made.numbers})
