"""An advice that was put to the test: rows, numbers, words and a section of the page."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.report.page import Section
from harness.studies.advise.verification import percent

if TYPE_CHECKING:
    from harness.studies.advise.verification import Side, Verification
    from harness.studies.statistics.difference import Difference

TABLES = ("verification", "verification_runs", "verification_packings")
NOTHING = "Nothing was verified: there is no setting that is known to keep the tolerance."
JOINT = "All knobs were run together"
RUNGS = (
    "Neither setting that was run turns two knobs away from the scene as declared, so that both are rungs of the "
    "ladders: what knobs do to each other was not put to the test"
)
HEADINGS = {
    "verification": "All at once, as run", "verification_runs": "What was run for it",
    "verification_packings": "Packing by packing",
}
NOTE_BULK = (
    "The advised setting was run with all knobs turned at once, and beside it the reference: every knob that advice "
    "turns at its finest good rung, all at once, with all effects that are declared. Agrees: the difference and its "
    "bar (one-sided 95 %) lie within the tolerance; differs: the difference less its bar lies beyond. The finest "
    "setting is not the limit: what it is expected to be off itself, by the same ladders, is told and decides nothing. "
    "The expected error has the scatter of the user's own packings in it, which cancels in a difference on the same "
    "packings. Decide on their number beforehand: further looks with more of them are not made at a stricter level."
)
NOTE_FREE = (
    "The advised step was run at as many phases as the ladder has, and other ones, and held against the oracle: the "
    "limit of the engine's own laws, all effects on. Agrees: the rms error and its bar (one-sided 95 %) lie within the "
    "tolerance; differs: the error less its bar lies beyond."
)
NOTES = {
    "verification_runs": "CPU time of one test is that of the engine's run, median over packings, as in the ladders; "
    "of a free scene that of all phases together.",
    "verification_packings": "Packings of one number have one seed; where the number of particles differs they have "
    "nothing else in common.",
}


def verification_tables(found: Verification) -> dict[str, list[dict]]:
    """Return rows by table name."""
    return dict(zip(TABLES, (result_rows(found), side_rows(found), packing_rows(found)), strict=True))


def verification_data(found: Verification) -> dict:
    """Return everything with all digits; errors are parts of `scale`, and null where there are none.

    verdict, why. tolerance. difference: advised less reference (of a free scene the rms error against the oracle);
    standard_error; degrees_of_freedom; multiple: of the standard error, one-sided 95 %; bar: both multiplied; paired:
    whether packings were; packings (phases): how many were run; needed: how many would tell, of an inconclusive one.
    scale: in the unit, over: what that is. expected_error: E(P) of the advice for so many packings. remaining_error:
    what the reference is expected to be off itself, by the limits of the ladders (the oracle's own error);
    from_limit: |difference|, bar and remaining_error together. untested: knobs that are the same in both. joint:
    whether a setting turns two knobs at once; else both are rungs of the ladders, and what knobs do to each other
    cannot be told. of_knobs_alone: the knobs' own differences in the ladders added up; of_knobs_together: the
    difference less that on the packings of both; each as value, standard_error, packings. time_ratio,
    foretold_time_ratio: CPU time of a test as advised over that of the reference (of a free scene over what its ladder
    says). sides: what was run: name, settings by knob, without (effects), particles, steps, status, reason, mean and
    standard_error in the unit, values by packing (lists of curves, errors by phase), cpu_seconds and
    foretold_cpu_seconds of one test.
    """
    d = found.difference
    return {
        "verdict": found.verdict, "why": found.why, "quantity": found.quantity, "unit": found.unit,
        "engine": found.engine, "tolerance": found.tolerance, "difference": d.value if d else None,
        "standard_error": d.error if d else None, "degrees_of_freedom": d.dof if d else None,
        "multiple": found.multiple, "bar": found.bar, "paired": d.paired if d else None,
        "phases" if found.free else "packings": found.count, "needed": found.needed, "scale": found.scale,
        "over": found.over, "expected_error": found.expected, "remaining_error": found.remaining,
        "from_limit": found.from_limit, "untested": list(found.untested), "joint": found.joint,
        "of_knobs_alone": _of(found.singly), "of_knobs_together": _of(found.together), "time_ratio": found.time_ratio,
        "foretold_time_ratio": found.foretold_ratio, "sides": [_side_data(s) for s in found.sides],
        "words": verification_line(found), "exit_status": found.exit_status,
    }


def _of(difference: Difference | None) -> dict | None:
    if difference is None:
        return None
    return {"value": difference.value, "standard_error": difference.error, "packings": difference.count}


def _side_data(side: Side) -> dict:
    each = [v.tolist() if np.isfinite(v).all() else None for v in side.values]
    return {
        "name": side.name, "settings": dict(side.settings), "without": list(side.without), "status": side.status,
        "reason": side.reason, "particles": side.particles, "steps": side.steps, "mean": side.mean,
        "standard_error": side.error, "cpu_seconds": side.seconds, "foretold_cpu_seconds": side.foretold_seconds,
        "values": [v[0] if v is not None and len(v) == 1 else v for v in each],
    }


# --- rows --------------------------------------------------------------------------------------------


def result_rows(found: Verification) -> list[dict]:
    """What it comes to, a number a row."""
    rows = [_row("verdict", found.verdict, found.why)]
    rows += [
        _row(f"{found.quantity}, {s.name}", s.mean, _from(found, s), unit=found.unit, error=s.error)
        for s in found.sides if s.mean is not None
    ]
    if found.difference is not None:
        rows += _difference_rows(found, found.difference)
    rows.append(_share("expected error", found.expected, _expected(found)))
    if found.remaining is not None:
        rows.append(_share(*_remaining(found)))
    if found.from_limit is not None:
        rows.append(_share("so expected from the limit at most", found.from_limit, "difference, bar and that together"))
    rows += _knob_rows(found)
    if found.time_ratio is not None:
        rows.append(_row(_of_time(found), found.time_ratio, f"foretold: {found.foretold_ratio:.3g}"))
    if found.untested:
        rows.append(_row("not put to the test", ", ".join(found.untested), "the same in both settings"))
    return rows


def _remaining(found: Verification) -> tuple[str, float, str]:
    if found.free:
        return "what the oracle is off itself", found.remaining, "counted in the standard error"
    return (
        "what the reference is expected to be off itself", found.remaining,
        "by the limits of the same ladders: the finest setting is not the limit",
    )


def _difference_rows(found: Verification, d: Difference) -> list[dict]:
    how = f"{d.count} phases of the step" if found.free else f"the same {d.count} packings" if d.paired else (
        "the packings differ, so the standard errors are those of two samples"
    )
    name = "rms error" if found.free else "difference"
    says = f"{'against the oracle' if found.free else 'advised less reference'}, over {found.over}; {how}"
    return [
        _row(name, 100.0 * d.value, says, unit="%", error=100.0 * d.error),
        _share(f"{name} and its bar", abs(d.value) + found.bar, f"{found.multiple:.3g} standard errors, one-sided "
               f"95 % at {d.dof:.3g} degrees of freedom; tolerance {percent(found.tolerance)}"),
    ]


def _knob_rows(found: Verification) -> list[dict]:
    told = (
        ("difference by the ladders", found.singly, "the knobs' own differences added up"),
        ("what the knobs do to each other", found.together, "difference less that, packing by packing of both"),
    )
    return [
        _row(name, 100.0 * d.value, f"{says}; {d.count} packings", unit="%", error=100.0 * d.error)
        for name, d, says in told if d is not None
    ]


def _row(what: str, value: object, says: str, *, unit: str = "", error: float | None = None) -> dict:
    return {"what": what, "value": value, "standard error": error, "unit": unit, "says": says}


def _share(what: str, value: float, says: str) -> dict:
    return _row(what, 100.0 * value, says, unit="%")


def _from(found: Verification, side: Side) -> str:
    have = int(np.isfinite(side.values).all(axis=1).sum())
    gone = "" if have == found.count else f"; {found.count - have} have none"
    return f"{'rms' if found.free else 'mean'} over {have} {'phases' if found.free else 'packings'}{gone}"


def _expected(found: Verification) -> str:
    return "as the advice foretells it" if found.free else (
        f"as the advice foretells it, for {found.count} packings with their scatter, against the limits"
    )


def _of_time(found: Verification) -> str:
    return f"CPU of one test over {'what the ladder says' if found.free else 'that of the reference'}"


def side_rows(found: Verification) -> list[dict]:
    """One row a setting that was run."""
    knobs = list(found.advised.settings)
    return [
        {"setting": s.name, "engine": found.engine, **{k: s.settings.get(k) for k in knobs},
         "effects": f"without {', '.join(s.without)}" if s.without else "as declared", "particles": s.particles or None,
         "steps": s.steps or None, "phases" if found.free else "packings": found.count, "status": s.status,
         "CPU of one (s)": s.seconds, "foretold (s)": s.foretold_seconds, "reason": s.reason}
        for s in found.sides
    ]


def packing_rows(found: Verification) -> list[dict]:
    """One row a packing: values of a number and their difference; none of a curve, nor of a free scene."""
    of = {s.name: s.values for s in found.sides if s.values.shape[1:] == (1,) and len(s.values)}
    if found.free or len(of) < len(found.sides):
        return []
    rows, unit = [], "" if found.unit == "1" else f" ({found.unit})"
    for number in range(max((len(v) for v in of.values()), default=0)):
        row = {"packing": number + 1} | {f"{n}{unit}": _number(v[number, 0]) for n, v in of.items()}
        if found.difference is not None and found.difference.paired:
            apart = (of["advised"][number, 0] - of["reference"][number, 0]) / found.scale
            row["difference (%)"] = _number(100.0 * apart)
        rows.append(row)
    return rows


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


# --- words -------------------------------------------------------------------------------------------


def verification_line(found: Verification) -> str:
    """Return the finding in one line."""
    verdict = found.verdict.replace("_", " ")
    many = f"at {found.count} other phases" if found.free else f"on {found.count} packings"
    parts = [f"Verified {many}: {verdict}, {found.why}"]
    parts += [_values(found)] if any(s.mean is not None for s in found.sides) else []
    parts.append(f"expected error {percent(found.expected)}")
    if found.reference is not None and found.remaining is not None:
        parts.append(f"the reference itself is expected to be off by {percent(found.remaining)}")
    if found.time_ratio is not None:
        below = "what its ladder says" if found.free else "the reference's"
        foretold = "" if found.free else f", foretold {found.foretold_ratio:.2g}"
        parts.append(f"CPU time {found.time_ratio:.2g} of {below}{foretold}")
    return "; ".join(parts) + "."


def _values(found: Verification) -> str:
    if found.free:
        return f"rms error {percent(found.advised.mean)} +- {percent(found.advised.error)}"
    unit = "" if found.unit == "1" else f" {found.unit}"
    told = [f"{s.mean:.4g} +- {s.error:.2g}{unit} ({s.name})" for s in found.sides if s.mean is not None]
    d = found.difference
    apart = "" if d is None else f", {percent(d.value, '+')} +- {percent(d.error)} apart"
    return f"{found.quantity} {', '.join(told)}{apart}"


def verification_limits(found: Verification) -> list[str]:
    """Return what a verification does not know, a sentence each."""
    if found.difference is None:
        return [f"The verification came to nothing ({found.why}): what was advised has not been put to the test."]
    if found.free:
        return ["The advised scene was run at other phases of the step, see the verification."]
    told = [
        f"{JOINT if found.joint else RUNGS}; see the verification, whose reference is the finest setting that was "
        "measured, and not the limit."
    ]
    if found.untested:
        told.append(f"The same in both, so not put to the test: {', '.join(found.untested)}.")
    if found.knobs_act:
        told.append(f"The knobs act on each other: all at once the quantity is {percent(found.together.value, '+')} +- "
                    f"{percent(found.together.error)} off what their ladders add up to.")
    return told


def verification_sections(found: Verification) -> list[Section]:
    """Return the sections of the page."""
    rows = verification_tables(found)
    first = Section(
        heading=HEADINGS["verification"], note=NOTE_FREE if found.free else NOTE_BULK, rows=rows["verification"],
    )
    return [first, *(
        Section(heading=HEADINGS[n], note=NOTES[n], rows=rows[n])
        for n in ("verification_runs", "verification_packings") if rows[n]
    )]
