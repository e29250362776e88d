"""A row of a family's table: one law of the scene, as LAMMPS has it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from harness.engines.protocol import Level


@dataclass(frozen=True, kw_only=True)
class Row:
    """Support level, the mapping (or the evidence that there is none), and what writes the words.

    words is None where LAMMPS does not have the law.
    """

    level: Level
    note: str
    words: Callable[..., str] | None = None


def missing(note: str) -> Row:
    """Return the row of a law that LAMMPS does not have; `note` is the evidence."""
    return Row(level="unsupported", note=note)
