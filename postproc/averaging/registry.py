"""The kinds of cells that can be asked for by name."""

from __future__ import annotations

from dataclasses import fields

from postproc.averaging.box import Box
from postproc.averaging.cells import Cells
from postproc.averaging.coarse.kernels.registry import KERNELS
from postproc.averaging.coarse.points import Points
from postproc.averaging.frame import FRAMES
from postproc.averaging.grid import Grid
from postproc.averaging.halfplane import HalfPlane
from postproc.averaging.inner import Inner
from postproc.averaging.particles import Particles
from postproc.averaging.partition import WEIGHTS
from postproc.averaging.rings import Rings
from postproc.averaging.strips import Strips
from postproc.averaging.words import WrongSetting
from postproc.snapshot import MissingColumn, Snapshot

CELLS: dict[str, type[Cells]] = {
    "box": Box,
    "inner": Inner,
    "particles": Particles,
    "rings": Rings,
    "strips": Strips,
    "grid": Grid,
    "halfplane": HalfPlane,
    "points": Points,
}
"""By the word they are asked for with; the words that may follow are in the docstring of their `settings`."""

CHOICES = {"frame": FRAMES, "weights": WEIGHTS, "kernel": tuple(KERNELS)}
"""Settings with a few words to choose from."""


def make_cells(kind: str, snapshot: Snapshot, **settings: object) -> Cells:
    """Return the cells asked for, as in "rings:60"; a setting that is None keeps its default.

    Raises WrongSetting for an unknown kind, words that mean no cells of this state, and a setting that the
    kind does not have.
    """
    name, *words = kind.split(":")
    if name not in CELLS:
        raise WrongSetting(f"cells: expected one of {', '.join(CELLS)}, got {name!r}")
    given = {setting: value for setting, value in settings.items() if value is not None}
    for setting in given.keys() - {f.name for f in fields(CELLS[name])}:
        raise WrongSetting(f"{setting}: expected none for cells of kind {name!r}, got {given[setting]}")
    for setting, choices in CHOICES.items():
        if setting in given and given[setting] not in choices:
            raise WrongSetting(f"{setting}: expected one of {', '.join(choices)}, got {given[setting]!r}")
    try:
        return CELLS[name](snapshot=snapshot, **{**CELLS[name].settings(words, snapshot), **given})
    except MissingColumn as missing:
        raise WrongSetting(f"cells {name}: {missing}") from None


__all__ = ["CELLS", "WrongSetting", "make_cells"]
