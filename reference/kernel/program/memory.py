"""What contacts remember, as the program keeps it and as the textbook does.

The program keeps forces where the textbook keeps lengths, if a constant stiffness is all that is between them, and in
2D one signed number along t = i n for a vector in the tangent plane, unless springs may lag behind their contact.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from reference.kernel.laws.by_pair import SpringByPair
from reference.kernel.model import Model
from reference.kernel.program.laws.registry import NORMAL, tangential_laws


def vectors_of(n: np.ndarray, amounts: np.ndarray) -> np.ndarray:
    """Return vectors in the tangent planes of normals n, (dim, M): in 2D of signed numbers, (1, M), along t = i n."""
    return amounts * np.stack([-n[1], n[0]]) if len(n) == 2 else amounts


def amounts_of(n: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return what `vectors_of` makes the vectors, (dim, M), of."""
    return (vectors[1] * n[0] - vectors[0] * n[1])[None] if len(n) == 2 else vectors


@dataclass(frozen=True, kw_only=True)
class Memory:
    """One law's. rows, textbook_rows: how many numbers a contact has here and there; a state may follow the spring.

    spring_rows: how many of textbook_rows are the spring. unit: history is that many times the spring. flat: whether
    springs are vectors in the tangent plane in 2D, and numbers here. by_pair: the law whose stiffness, which depends on
    the pair, is in the unit's place; i, j: (M,) nodes of the pairs.
    """

    rows: int
    textbook_rows: int
    spring_rows: int
    unit: float
    flat: bool
    by_pair: SpringByPair | None = None

    def to_textbook(self, n: np.ndarray, history: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
        """Return (textbook_rows, M) from the history, (rows, M), of pairs with the normals n, (dim, M)."""
        state = self.textbook_rows - self.spring_rows
        springs = history[: self.rows - state] / self._unit(i, j)
        if self.flat:
            springs = vectors_of(n, springs)
        return np.vstack([springs, history[self.rows - state :]])

    def from_textbook(self, n: np.ndarray, remembered: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
        """Return the history, (rows, M), of pairs with the normals n, (dim, M), from what the textbook remembers."""
        springs = remembered[: self.spring_rows] * self._unit(i, j)
        if self.flat:
            springs = amounts_of(n, springs)
        return np.vstack([springs, remembered[self.spring_rows :]])

    def _unit(self, i: np.ndarray, j: np.ndarray) -> float | np.ndarray:
        return self.unit if self.by_pair is None else self.by_pair.between(i, j)["shear_stiffness"]


def memories(model: Model) -> dict[str, Memory]:
    """Return the memory of every law that has one, by family."""
    dim, normal = model.dimension, model.normal
    made = {"normal": _memory(normal.memory_rows(dim), dim, unit=NORMAL[type(normal)].unit(normal))}
    for family, (law, operations) in tangential_laws(model).items():
        rows = law.memory_rows(dim)
        memory = _memory(rows, dim, unit=operations.unit(law), whole=operations.lags(law))
        made[family] = replace(memory, by_pair=law) if isinstance(law, SpringByPair) else memory
    return {family: memory for family, memory in made.items() if memory.rows}


def _memory(rows: int, dim: int, *, unit: float, whole: bool = False) -> Memory:
    """Whole: vectors stay vectors in 2D."""
    vectors = rows >= dim
    flat = vectors and dim == 2 and not whole
    return Memory(rows=rows - flat, textbook_rows=rows, spring_rows=dim if vectors else rows, unit=unit, flat=flat)
