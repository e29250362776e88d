"""What the figures draw: normal force against overlap, tangential force against slip, of the plain frame."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from harness.studies.laws.drive import Driven
from harness.studies.laws.motions import DT

DRAWN = {"load": 0, "shear": 1}
"""Motions drawn and the component of the force, n or t."""


@dataclass(frozen=True, kw_only=True)
class Curve:
    """place: overlap or slip, (S,) in m; force: along n or t on body i, (S,) in N."""

    laws: str
    engine: str
    motion: str
    place: np.ndarray
    force: np.ndarray


def curves(runs: Iterable[Driven]) -> list[Curve]:
    """Return the curves of completed runs of pairs, one an engine and motion."""
    found: dict[tuple[str, str], Curve] = {}
    for run in runs:
        if run.reaction is None or run.job.arrangement.partner != "pair":
            continue
        for motion, component in DRAWN.items():
            if run.job.laws.sliding is not None or motion == "load":
                found.setdefault((run.engine, motion), _curve(run, motion, component))
    return list(found.values())


def _curve(run: Driven, motion: str, component: int) -> Curve:
    track = run.job.arrangement.tracks_of(motion)[0]
    course = track.motion.course
    place = course.overlap[1:] if motion == "load" else np.cumsum(DT * course.slip[1:])
    force, _ = track.local(run.reaction)
    return Curve(laws=run.job.laws.name, engine=run.engine, motion=motion, place=place, force=force[:, 0, component])
