"""What runs cost, and what made them: time by phase, versions, machines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from statistics import fmean
from typing import TYPE_CHECKING

from harness.report.failures import ReportedRun

if TYPE_CHECKING:
    from harness.runs.outcome import Outcome

OURS = ("render", "read", "write")
"""Phases of the harness; the others are the engine's."""

COST_NOTE = (
    "Means over the completed runs of each engine. CPU time is that of the engine's own processes, set-up and output "
    "included; elapsed time is what a clock showed. Runs shared this machine (load: the most processes that wanted a "
    "core when one of these runs began), so compare times only roughly. The harness renders decks and reads, checks "
    "and keeps results."
)


def cost_rows(runs: Iterable[ReportedRun]) -> list[dict]:
    """One row an engine that completed a run; columns that no engine can fill are left out."""
    done: dict[str, list[Outcome]] = {}
    for r in runs:
        if r.outcome.status == "completed":
            done.setdefault(r.engine, []).append(r.outcome)
    rows = [_cost_row(engine, outcomes) for engine, outcomes in done.items()]
    least = min((r["CPU (s)"] for r in rows if r["CPU (s)"]), default=None)
    for r in rows:
        r["CPU over the least"] = r["CPU (s)"] / least if least and r["CPU (s)"] is not None else None
    filled = [name for name in (rows[0] if rows else ()) if any(r[name] is not None for r in rows)]
    return [{name: r[name] for name in filled} for r in rows]


def _cost_row(engine: str, outcomes: Sequence[Outcome]) -> dict:
    per_step = [1e6 * o.cpu_seconds / o.steps for o in outcomes if o.cpu_seconds is not None and o.steps]
    return {
        "engine": engine, "runs": len(outcomes), "CPU (s)": _mean(o.cpu_seconds for o in outcomes),
        "CPU over the least": None, "CPU per step (us)": _mean(per_step),
        "elapsed (s)": _mean(o.wall_seconds for o in outcomes),
        **{f"{phase} (s)": _mean(o.timings.get(phase) for o in outcomes) for phase in ("setup", "run", "output")},
        "harness (s)": _mean(_harness_seconds(o) for o in outcomes), "load": max(o.load_average for o in outcomes),
    }


def _harness_seconds(outcome: Outcome) -> float | None:
    """Return what the harness itself needed for a run, None if it was not timed."""
    found = [outcome.timings[p] for p in OURS if p in outcome.timings]
    return sum(found) if found else None


def _mean(values: Iterable[float | None]) -> float | None:
    """Return the mean of what is there, None of nothing."""
    known = [v for v in values if v is not None]
    return fmean(known) if known else None


def version_rows(runs: Iterable[ReportedRun]) -> list[dict]:
    """One row an engine and version, with the effects that it computes only in part."""
    found: dict[tuple[str, str], dict[str, None]] = {}
    for r in runs:
        found.setdefault((r.engine, r.outcome.engine_version), {}).update(dict.fromkeys(r.outcome.partial))
    return [
        {"engine": engine, "version": version or None, "computed in part": ", ".join(partial) or None}
        for (engine, version), partial in found.items()
    ]


def host_rows(runs: Iterable[ReportedRun]) -> list[dict]:
    """One row a machine with the Python that ran the harness on it, and how many of the runs were made there."""
    counts: dict[tuple, int] = {}
    for r in runs:
        key = (r.outcome.host, r.outcome.harness_version)
        counts[key] = counts.get(key, 0) + 1
    return [
        {"CPU": h.cpu_model, "cores": h.cores, "system": h.os, "Python": h.python, "NumPy": h.numpy,
         "grainproof": version, "runs": count}
        for (h, version), count in counts.items()
    ]
