"""What the sound study computes: regular columns without and with friction springs, and columns of weak disorder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from msgspec.structs import replace

from harness.scene.load import load_scene
from harness.scene.model import Numerics
from harness.studies.reproduce.protocol import Ask, Case, Size
from harness.studies.reproduce.sound.column import Column, Kick, Look, Material, write_scene
from harness.studies.reproduce.sound.disorder import Sample, relaxed_sample

SMOOTH, ROUGH = Material(), Material(tangential=2e4)
"""Without friction; with springs k_t = k_n/5 and mu = 0.5, which no contact reaches."""

GENTLE, FAINT = 1e-3, 1e-4
"""Largest displacement by the kick over the overlap: of regular columns, and where contacts only just touch."""


FINE, COARSE = 0.02, (0.08, 0.04)
"""dt_fraction: of the study, and of the regular column again to show what the step does."""


@dataclass(frozen=True, kw_only=True)
class Extent:
    """One size of the study. crossings: how often shear waves cross the column. widths: of the disorder."""

    layers: int
    across: int
    widths: tuple[float, ...]
    samples: int
    crossings: float
    frames: int


EXTENTS: dict[Size, Extent] = {
    "quick": Extent(layers=200, across=4, widths=(0.5, 1.0), samples=3, crossings=1.0, frames=240),
    "paper": Extent(layers=400, across=4, widths=(0.25, 0.5, 0.75, 1.0), samples=8, crossings=1.0, frames=480),
}


@dataclass(frozen=True, kw_only=True)
class Setting:
    """What a case is: its column, with friction springs or without; width of its disorder, its sample; its step."""

    column: Column
    width: float = 0.0
    sample: int = 0
    dt_fraction: float = FINE

    @property
    def rough(self) -> bool:
        """Whether there are friction springs."""
        return self.column.material.tangential > 0

    @property
    def name(self) -> str:
        """The case's name."""
        if self.width:
            return f"disorder {self.width:g}, sample {self.sample + 1}"
        name = "regular, friction springs" if self.rough else "regular, no friction"
        return name if self.dt_fraction == FINE else f"{name}, step {self.dt_fraction:g}"

    @property
    def word(self) -> str:
        """The name as a file's."""
        return self.name.replace(", ", "_").replace(" ", "_").replace(".", "p")

    def packing(self) -> Sample:
        """Return the packing at rest."""
        return _sample(self.column, self.width, self.sample)

    def kick(self) -> Kick:
        """Return what the first layer gets: along the column and across it; with friction springs turns, too."""
        material = self.column.material
        speed = (FAINT if self.width else GENTLE) * material.overlap * material.radius * material.waves().cut_off
        return Kick(velocity=(speed, 0.0, speed), surface=(0.0, speed, speed) if self.rough else (0.0, 0.0, 0.0))


def settings_of(ask: Ask) -> list[Setting]:
    """Return the settings of a size, regular ones first."""
    extent = EXTENTS[ask.size]
    smooth, rough = (Column(material=m, layers=extent.layers, across=extent.across) for m in (SMOOTH, ROUGH))
    disordered = [Setting(column=smooth, width=w, sample=k)
                  for w in extent.widths for k in range(ask.packings or extent.samples)]
    coarse = [Setting(column=smooth, dt_fraction=f) for f in COARSE]
    return [Setting(column=smooth), Setting(column=rough), *disordered, *coarse]


def cases_of(ask: Ask) -> Sequence[Case]:
    """Return the cases as far as they are known before any packing is at rest: each with the regular column's places.

    They take as long to run as those that `made_cases` returns.
    """
    first = {s.rough: s for s in reversed(settings_of(ask)) if not s.width}
    files = {rough: _written(ask, s) for rough, s in first.items()}
    scenes = {rough: load_scene(file) for rough, file in files.items()}
    return [
        Case(
            name=s.name, file=files[s.rough], packings=1,
            scene=replace(scenes[s.rough], title=_title(s), numerics=Numerics(dt_fraction=s.dt_fraction)),
        )
        for s in settings_of(ask)
    ]


def made_cases(ask: Ask) -> Sequence[Case]:
    """Bring all packings to rest, write the scenes below ``ask.out/scenes`` for any command, and return the cases."""
    files = {s.name: _written(ask, s) for s in settings_of(ask)}
    return [Case(name=name, scene=load_scene(file), file=file, packings=1) for name, file in files.items()]


def _written(ask: Ask, setting: Setting) -> Path:
    extent, column, sample = EXTENTS[ask.size], setting.column, setting.packing()
    look = Look(
        duration=extent.crossings * column.box[2] / column.material.waves().shear_speed, frames=extent.frames,
        dt_fraction=setting.dt_fraction,
    )
    return write_scene(
        ask.out / "scenes", f"sound_{ask.size}_{setting.word}", _title(setting), column, setting.kick(), look,
        places=sample.places, radius=sample.radius,
    )


def _title(setting: Setting) -> str:
    return f"Sound in a column of spheres: {setting.name}"


@cache
def _sample(column: Column, width: float, number: int) -> Sample:
    """Return a sample; the regular packing is known to be at rest."""
    if not width:
        radius = np.full(column.count, column.material.radius)
        return Sample.regular(column, radius)
    return relaxed_sample(column, width, seed=number + 1)
