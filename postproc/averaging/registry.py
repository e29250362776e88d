"""The kinds of cells that can be asked for by name."""

from __future__ import annotations

from dataclasses import fields

from postproc.averaging.box import Box
from postproc.averaging.cells import Cells
from postproc.averaging.inner import Inner
from postproc.averaging.particles import Particles
from postproc.snapshot import Snapshot


class WrongSetting(ValueError):
    """A setting of the averaging that makes no sense; the message names it, what was expected, what came."""


CELLS: dict[str, type[Cells]] = {"box": Box, "inner": Inner, "particles": Particles}


def make_cells(kind: str, snapshot: Snapshot, **settings: object) -> Cells:
    """Return the cells of this kind; a setting that is None keeps its default.

    Raises WrongSetting for an unknown kind and for a setting that the kind does not have.
    """
    if kind not in CELLS:
        raise WrongSetting(f"cells: expected one of {', '.join(CELLS)}, got {kind!r}")
    given = {name: value for name, value in settings.items() if value is not None}
    for name in given.keys() - {f.name for f in fields(CELLS[kind])}:
        raise WrongSetting(f"{name}: expected none for cells of kind {kind!r}, got {given[name]}")
    return CELLS[kind](snapshot=snapshot, **given)
