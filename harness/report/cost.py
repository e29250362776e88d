"""What runs cost, and what made them: time by phase, versions, machines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from statistics import fmean
from typing import TYPE_CHECKING

from harness.report.failures import ReportedRun
from harness.runs.phases import cpu_parts

if TYPE_CHECKING:
    from harness.runs.outcome import Outcome

OURS = ("render", "read", "write")
"""Phases of the harness; the others are the engine's."""

LEAST_SHARE = 0.05
"""Of a run's CPU time: where steps take less, they are too short beside the start to tell what one costs."""

COST_NOTE = (
    "Means over the completed runs of each engine. CPU: processor time of the engine's own processes. It is split into "
    "what comes before the first step (the process starts, reads its deck and builds the system), the steps, and the "
    "output: the kernel tells its phases in processor time, LAMMPS and LIGGGHTS by the clock, in which proportions "
    "their processor time is shared out here (what LAMMPS writes on the way counts as steps). CPU per step: of the "
    f"steps alone; none where they take less than {100.0 * LEAST_SHARE:g} % of the whole. Clock: elapsed time; the "
    "harness renders decks and reads, checks and keeps results. Runs shared this machine (load: the most processes "
    "that wanted a core when one of these runs began), so compare times only roughly."
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
    parts = [_parts(o) for o in outcomes]
    return {
        "engine": engine, "runs": len(outcomes), "CPU (s)": _mean(o.cpu_seconds for o in outcomes),
        "CPU over the least": None,
        **{f"{name}, CPU (s)": _mean(p.get(name) for p in parts) for name in ("before the steps", "steps", "output")},
        "CPU per step (us)": _mean(_per_step(o, p) for o, p in zip(outcomes, parts, strict=True)),
        "clock (s)": _mean(o.wall_seconds for o in outcomes),
        "harness, clock (s)": _mean(_harness_seconds(o) for o in outcomes),
        "load": max(o.load_average for o in outcomes),
    }


def _parts(outcome: Outcome) -> dict[str, float]:
    """Return CPU seconds before the steps, in them and of the output; the first and last where they can be told."""
    if outcome.cpu_seconds is None or "run" not in outcome.timings:
        return {}
    told = cpu_parts(outcome)
    parts = {"steps": told["run"]} | ({"output": told["output"]} if "output" in told else {})
    before = {"before the steps": max(0.0, outcome.cpu_seconds - sum(parts.values()))}
    return parts | (before if "setup" in told else {})


def _per_step(outcome: Outcome, parts: Mapping[str, float]) -> float | None:
    """Return CPU time of a step in us; None where steps are a small part of the run, or nobody told them apart."""
    if "before the steps" not in parts or not outcome.steps or parts["steps"] < LEAST_SHARE * outcome.cpu_seconds:
        return None
    return 1e6 * parts["steps"] / outcome.steps


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
