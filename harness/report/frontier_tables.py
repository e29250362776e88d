"""Rows of the frontier report: every frontier, the skipped ones, what scenes are warned with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.studies.frontier.summary import scene_rows
from harness.studies.frontier.theory import felt_late

if TYPE_CHECKING:
    from harness.studies.frontier.study import Frontier, Frontiers


BEYOND = {"": "", "grew": "motions grow", "stopped": "the code breaks off", "refused": "the code does not begin"}
"""What the smallest unstable step did, in words."""


def tables(done: Frontiers) -> dict[str, list[dict]]:
    """Return rows by table name: frontiers of laws and packings, the map, what was left out, the scenes' table."""
    skipped = [dict(zip(("engine", "law", "packing", "why"), row, strict=True)) for row in done.skipped]
    return {
        "frontiers": [_row(f) for f in done.base],
        "map": [{"varied": f.axis, "value": f.value} | _row(f) for f in done.found if f.axis],
        "scenes": scene_rows(done),
        "skipped": skipped,
    }


def _row(f: Frontier) -> dict:
    """Steps in units of sqrt(m/k); how far the measured one is from theory, in per cent."""
    width = None if f.stable is None or f.unstable is None else (f.unstable - f.stable) / 2
    return {
        "law": f.law, "packing": f.packing, "engine": f.engine, "particles": f.particles, "contacts": f.contacts,
        "largest step": _over(f.measured, f.unit), "+-": _over(width, f.unit), "exact": _over(f.exact, f.unit),
        "deviation (%)": None if f.deviation is None else 100 * f.deviation, "verdict": f.verdict,
        "beyond": BEYOND[f.end], "scenes stop at": f.formula / f.unit, "sqrt(m/k) (s)": f.unit, "runs": f.looks,
        "note": _note(f),
    }


def _note(f: Frontier) -> str:
    if f.fault or not f.careful:
        return f.fault or f.note
    return "the code refuses steps that theory calls stable: more careful, nothing to compare"


def _over(step: float | None, unit: float) -> float | None:
    return None if step is None else step / unit


def summary(done: Frontiers) -> str:
    """Return one line: how many, how far from theory, and where a scene's formula would be too large."""
    compared = [f for f in done.found if f.deviation is not None]
    worst = max((abs(f.deviation) for f in compared), default=None)
    refused = sum(f.refused for f in done.found)
    never = sum(f.never for f in done.found) - refused
    words = [f"{len(done.found)} frontiers of {', '.join(done.versions)}"]
    if worst is not None:
        words.append(f"{len(compared)} against theory, largest deviation {100 * worst:.2g} %")
    if never:
        words.append(f"{never} without any stable step")
    if refused:
        right = sum(f.refused and f.exact == 0.0 for f in done.found)
        words.append(f"{refused} refused at every step" + (f", {right} of them as theory has it" if right else ""))
    careful = sum(f.careful and not f.refused for f in done.found)
    if careful:
        words.append(f"{careful} refused below the limit of theory, and not compared")
    least = [f.measured / f.formula for f in done.found if f.measured and not felt_late(f.engine, f.system)]
    if least:
        words.append(f"measured over the formula that scenes are refused by: {min(least):.3g} to {max(least):.3g}")
    return "; ".join(words)
