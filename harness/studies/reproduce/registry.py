"""The studies that there are, by the name that is typed: a module with a `STUDY`, and a line here."""

from __future__ import annotations

from importlib import import_module

from harness.errors import InputError
from harness.scene.describe import nearest
from harness.studies.reproduce.protocol import Study

STUDIES: tuple[str, ...] = ("cohesion", "friction", "anisotropy", "rotations", "ring", "cyclic", "contact", "sound")
"""Names of studies, each that of its module in this package, in the order of `--list`."""


def all_studies() -> dict[str, Study]:
    """Return every study by its name."""
    return {name: import_module(f"harness.studies.reproduce.{name}").STUDY for name in STUDIES}


def find_study(name: str) -> Study:
    """Return one study; raises InputError for a name that there is not."""
    if name not in STUDIES:
        raise InputError(
            file="NAME", expected=f"one of {', '.join(STUDIES)}", got=name or "nothing", fix=nearest(name, STUDIES),
        )
    return import_module(f"harness.studies.reproduce.{name}").STUDY
