"""The post-processor's front door: one state in, all its averages out; also as a command.

From Python::

    averages = average(read_state("state.h5"), cells="rings:60")
    averages["stress"]            # (60, 2, 2): rr, rphi, phir, phiphi; or MissingColumn with the reason

From a shell::

    python -m postproc STATE --cells rings:60 [--fields NAME,...] [--out DIR] [--json FILE|-] ...

`main` takes the same words as a list, so that another command can hand its arguments on.
"""

from __future__ import annotations

import argparse
import difflib
import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from postproc.averaging.registry import WrongSetting, make_cells
from postproc.fields import AT_POINTS, IN_CELLS, OF_STATE, Field, Subject
from postproc.geometry import ring_walls
from postproc.macro.coordination import MINIMUM_CONTACTS
from postproc.options import INPUT_WRONG, check_places, parser
from postproc.results import Averages, Value
from postproc.snapshot import Snapshot
from postproc.trajectory import ReadError
from postproc.undefined import Gaps

DONE, NOTHING = 0, 1

ALL = "all"
"""Every field."""

LARGEST = 1e30
"""Settings beyond this are no physical values of grains in SI units, and high powers of them overflow."""


def average(
    snapshot: Snapshot,
    *,
    cells: str = "box",
    fields: str | Sequence[str] = ALL,
    weights: str | None = None,
    frame: str | None = None,
    kernel: str | None = None,
    width: float | None = None,
    margin: float | None = None,
    minimum_contacts: int = MINIMUM_CONTACTS,
    kn: float | None = None,
    kt: float | None = None,
    reference: Snapshot | None = None,
    rate: float | None = None,
    gravity: Sequence[float] | None = None,
    centre: Sequence[float] | None = None,
) -> Averages:
    """Average a state over cells; what the state cannot give is unavailable, with the reason.

    Parameters
    ----------
    cells: kind of cells with its words, see `postproc.averaging.registry`: "box" (whole box), "inner" (without a
        border layer), "particles" (each one a cell), "rings:60", "strips:x:20", "grid:32x32", ...
    fields: names of quantities, or "all".
    weights: "area" (exact fractions of particles cut by borders) or "centre"; for cells that have the choice.
    frame: "cartesian" or "polar" components; default polar in rings, else Cartesian.
    kernel, width: of coarse graining at points.
    margin: width of the border layer of "inner", m; default two mean diameters.
    minimum_contacts: a particle with fewer is a rattler; 3 (2D) or 4 (3D) without friction.
    kn, kt: stiffnesses of linear springs, N/m, if the contacts have no columns of that name. kt = 0 says that contacts
        have no tangential springs (friction is a dashpot or slips), which forces alone do not tell.
    reference: state that strains and displacements are measured from.
    rate: strain rate for the inertial number, 1/s.
    gravity: (dim,), m/s^2, counted in the balance of forces.
    centre: (dim,), m, what rings and polar components are about in a state without ring walls; default the origin.

    Raises WrongSetting (a ValueError) for unknown cells or fields, cells that overlap or lie outside the sample,
    and settings that make no sense or that the cells do not have.
    """
    _check_settings(
        positive={"kn": kn, "kt": kt or None, "margin": margin, "width": width}, finite={"rate": rate},
        minimum_contacts=minimum_contacts,
    )
    if not snapshot.particles.rows:
        raise WrongSetting("state: expected at least one particle, got none")
    if centre is not None:
        snapshot = _centred(snapshot, centre)
    wanted = _chosen(fields)
    subject = Subject(
        cells=make_cells(
            cells, snapshot, weights=weights, frame=frame, kernel=kernel, width=width, margin=margin
        ),
        minimum_contacts=minimum_contacts,
        kn=kn,
        kt=kt,
        reference=reference,
        rate=rate,
        gravity=None if gravity is None else _components("gravity", gravity, snapshot.dimension),
    )
    if fields == ALL and "kernel" not in subject.cells.how:
        wanted = tuple(field for field in wanted if field not in AT_POINTS)
    gaps = Gaps(cells=subject.cells)
    return Averages(
        time=snapshot.time,
        dimension=snapshot.dimension,
        per_thickness=snapshot.per_thickness,
        particles=snapshot.particles.rows,
        cells=cells,
        how=subject.cells.how,
        frame=subject.cells.frame,
        labels=subject.cells.labels,
        empty=int(gaps.empty.sum()),
        coordinates={name: Value(values=v, unit="m") for name, v in subject.cells.coordinates.items()},
        in_cells={f.name: gaps.explain(f.name, f.evaluate(subject)) for f in wanted if f not in OF_STATE},
        of_state={f.name: f.evaluate_state(subject) for f in wanted if f in OF_STATE},
    )


def _centred(snapshot: Snapshot, centre: Sequence[float]) -> Snapshot:
    """Return the state with a centre of its own. Raises WrongSetting where ring walls have one already."""
    if ring_walls(snapshot).size:
        raise WrongSetting("centre: expected none for a state with ring walls, whose centre it is, got one")
    return replace(snapshot, centre=_components("centre", centre, snapshot.dimension))


def _chosen(names: str | Sequence[str]) -> tuple[Field, ...]:
    """Return the fields of these names, in the order of the tables. Raises WrongSetting, with the closest name."""
    known = {field.name: field for field in (*IN_CELLS, *AT_POINTS, *OF_STATE)}
    if names == ALL:
        return tuple(known.values())
    wanted = names.split(",") if isinstance(names, str) else names
    for name in wanted:
        if name not in known:
            like = difflib.get_close_matches(name, known, n=3) or [*known]
            raise WrongSetting(f"fields: expected all, or names such as {', '.join(like)}; got {name!r}")
    return tuple(field for name, field in known.items() if name in wanted)


def _check_settings(
    *, positive: dict[str, float | None], finite: dict[str, float | None], minimum_contacts: int
) -> None:
    """Raise WrongSetting for numbers that mean nothing."""
    for name, value in positive.items():
        if value is not None and not 0 < value < LARGEST:
            raise WrongSetting(f"{name}: expected a number > 0 and below {LARGEST:g}, got {value:g}")
    for name, value in finite.items():
        if value is not None and not abs(value) < LARGEST:
            raise WrongSetting(f"{name}: expected a finite number below {LARGEST:g}, got {value:g}")
    if minimum_contacts < 1:
        raise WrongSetting(f"minimum contacts: expected a whole number >= 1, got {minimum_contacts}")


def _components(name: str, values: Sequence[float], dimension: int) -> tuple[float, ...]:
    """Return a vector of the right length with finite components. Raises WrongSetting."""
    if len(values) != dimension:
        raise WrongSetting(f"{name}: expected {dimension} components, got {len(values)}")
    if not all(math.isfinite(v) and abs(v) < LARGEST for v in values):
        got = " ".join(f"{v:g}" for v in values)
        raise WrongSetting(f"{name}: expected finite components below {LARGEST:g}, got {got}")
    return tuple(values)


def main(arguments: Sequence[str] | None = None, *, prog: str = "python -m postproc") -> int:
    """Run the command; return 0, 1 when none of what was asked could be given (the table says why of each).

    2 when the input is wrong (one line on standard error).
    """
    words = parser(prog).parse_args(arguments)
    try:
        check_places(words)
        averages = _average_file(words)
        _deliver(averages, words)
    except (ReadError, WrongSetting) as error:
        return _complain(f"{prog}: {error}")
    except OSError as error:
        return _complain(f"{prog}: {error.filename or 'output'}: cannot be written: {error.strerror or error}")
    return DONE if averages.gives_something else NOTHING


def _complain(line: str) -> int:
    print(" ".join(line.split()), file=sys.stderr)
    return INPUT_WRONG


def _average_file(words: argparse.Namespace) -> Averages:
    from postproc.readers.state import holds_trajectory, read_state

    settings = {
        "cells": words.cells, "fields": words.fields, "weights": words.weights, "frame": words.frame_of,
        "kernel": words.kernel, "width": words.width, "margin": words.margin,
        "minimum_contacts": words.minimum_contacts, "kn": words.kn, "kt": words.kt, "rate": words.rate,
        "gravity": words.gravity, "centre": words.centre,
    }
    if words.reference is not None:
        settings["reference"] = read_state(words.reference)
    if words.frames is not None:
        return _over_time(words, settings)
    snapshot = read_state(words.state, frame=words.frame)
    if words.reference is None and holds_trajectory(words.state):
        settings["reference"] = read_state(words.state, frame=0)
    return average(snapshot, **settings)


def _over_time(words: argparse.Namespace, settings: dict[str, object]) -> Averages:
    from postproc.over_time import average_over_time
    from postproc.readers.state import holds_trajectory

    if words.frame is not None:
        raise WrongSetting("--frames: expected it without --frame, got both; one frame has no mean over time")
    if not holds_trajectory(words.state):
        raise WrongSetting(f"--frames: expected a trajectory, which has frames, got {words.state}, a single state")
    return average_over_time(words.state, words.frames, **settings)


def _deliver(averages: Averages, words: argparse.Namespace) -> None:
    from postproc.output import json_text, table_text, write_files

    if words.out is not None:
        write_files(words.out, averages)
    if words.json is not None and words.json != "-":
        Path(words.json).write_text(json_text(averages), encoding="utf-8")
    print(json_text(averages) if words.json == "-" else table_text(averages), end="")
