"""What a watch leaves in the run's folder: watch.csv with the curves, and the largest sizes in outcome.json."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from harness.runs.atomic import write_text_atomic
from harness.runs.folder import RunFolder
from harness.runs.outcome import Outcome, write_outcome
from harness.scene.system import System
from harness.studies.watch.watch import UNITS, Watch, watch_folder

if TYPE_CHECKING:
    from harness.engines.protocol import Engine

CURVES = "watch.csv"


def watched(engine: Engine, system: System, folder: Path, outcome: Outcome) -> tuple[Watch, Outcome]:
    """Watch a run that was made or kept; return what was seen, and the outcome that says so and is kept beside it.

    The run itself, its deck and its trajectory stay as they are. Of a run that was not made nothing is written.
    """
    seen = watch_folder(engine, system, folder, outcome)
    said = msgspec.structs.replace(outcome, watch={k: _finite(v) for k, v in seen.numbers().items()})
    if folder.exists():
        with RunFolder.at(folder).lock():
            write_text_atomic(folder / CURVES, curves_csv(seen))
            write_outcome(folder / "outcome.json", said)
    return seen, said


def curves_csv(seen: Watch) -> str:
    """Return the curves as CSV, a row a frame, units in the header."""
    from harness.report.tables import csv_text

    columns = {"time (s)": seen.time} | {
        name if UNITS[name] == "1" else f"{name} ({UNITS[name]})": curve for name, curve in seen.curves.items()
    }
    return csv_text({name: float(curve[k]) for name, curve in columns.items()} for k in range(seen.of_frames))


def _finite(value: float | str) -> float | str:
    """JSON knows no infinite numbers: they become words."""
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value
