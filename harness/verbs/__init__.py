"""The verbs of the command line, one module each.

A verb is a module with `add(verbs)`, which declares its options and names the function that runs it, and a line in
VERBS. The function takes the parsed options and returns the exit status. Imports of studies and reports are local to
it, so that `grainproof --help` answers at once.
"""

from __future__ import annotations

from importlib import import_module

VERBS = (
    "engines", "scene", "decks", "run", "compare", "laws", "bench", "accuracy", "effects", "advise", "stability",
    "frontier", "reproduce", "report", "status",
)
"""Modules of this package, in the order of the help."""


def add_all(verbs) -> None:
    """Declare every verb."""
    for name in VERBS:
        import_module(f"harness.verbs.{name}").add(verbs)
