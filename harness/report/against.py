"""`grainproof report`: a finished report shown again, alone or against an older one; terminal, JSON and a page."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError
from harness.report.compare import check_rows, run_rows
from harness.report.cost import cost_rows, version_rows
from harness.report.difference import Difference, Rows, difference
from harness.report.failures import RERUN
from harness.report.finished import Finished, read_finished
from harness.report.page import Entry, Section, render_page
from harness.report.tables import Answer

PAGE, DATA = "difference.html", "difference.json"


@dataclass(frozen=True, kw_only=True)
class Reported:
    """What the command says. closing: the last lines for people."""

    answer: Answer
    closing: str
    exit_status: int


def report(place: Path, against: Path | None) -> Reported:
    """Show the report in `place`, or what changed since the one in `against`, see `compare_reports`."""
    if against is None:
        return _alone(read_finished(place))
    found = compare_reports(place, against)
    answer = Answer(tables={h: rows for h, rows in tables(found).items() if rows}, data=data(found))
    closing = f"{summary(found)}\nreport: {found.new.file.parent / PAGE}"
    return Reported(answer=answer, closing=closing, exit_status=found.exit_status)


def compare_reports(place: Path, against: Path) -> Difference:
    """Return what changed from the report `against` to that in `place`, and write it there as page and JSON.

    Raises InputError for places without a report, and for two reports that have nothing in common.
    """
    new, old = read_finished(place), read_finished(against, option="--against")
    if old.file.samefile(new.file):
        raise InputError(
            file=f"--against {against}", expected="another report", got="the same", fix="compare into another --out"
        )
    found = difference(old, new)
    _write(found, new.file.parent)
    return found


def _alone(new: Finished) -> Reported:
    tables_ = {
        "Runs": run_rows(new), "Time and cost": cost_rows(new.runs), "Versions": version_rows(new.runs),
        "Verdicts": check_rows(new),
    }
    facts = {"file": str(new.file), "summary": new.summary, "exit_status": new.exit_status}
    return Reported(
        answer=Answer(tables=tables_, data={**facts, **tables_}), closing=f"{new.title}: {new.summary}",
        exit_status=new.exit_status,
    )


# --- a difference ----------------------------------------------------------------------------------

HEADINGS = {
    "settings": "The two were asked for different things", "verdicts": "Verdicts that changed",
    "runs": "Runs that changed", "deviations": "Deviations that changed by more than rounding",
    "curves": "Curves of the first packing, sample by sample", "numbers": "Numbers that changed",
    "costs": "Cost", "versions": "Versions",
}
"""Tables of a difference, in the order in which they are shown."""

NOTES = {
    "settings": "What follows is then not of the versions alone. A setting that one side lacks was not given there, or "
    "its grainproof did not know it.",
    "verdicts": "worse, from agrees to differs: agrees, known difference, inconclusive, not checked, differs. A check "
    "that differs when it first appears is worse, one that appears or vanishes otherwise is neither.",
    "deviations": "Deviations are relative numbers; the smaller, the better two codes agree. Verdicts may be the same.",
    "curves": "Largest change of any column over the largest value of that column. Past the onset of chaos any change "
    "of rounding changes everything: then only numbers with their scatter over packings can tell.",
    "numbers": "Standard errors from the scatter over packings, as of independent samples.",
    "costs": "Medians over runs, of whole processes, so with their start. Ratios tell of the code only if machine and "
    "load were the same, see versions.",
}


def tables(found: Difference) -> dict[str, Rows]:
    """Return the rows under their headings."""
    return {heading: getattr(found, name) for name, heading in HEADINGS.items()}


def summary(found: Difference) -> str:
    """Return one line: what got worse, what else changed, and which codes have another version."""
    changes = Counter(r["change"] for r in found.verdicts)
    verdicts = ", ".join(f"{n} {change}" for change, n in changes.items())
    runs = Counter(r["change"] for r in found.runs)
    lost = "; runs: " + ", ".join(f"{n} {change}" for change, n in runs.items()) if runs else ""
    engines = {r.engine for r in found.new.runs}
    others = [f"{r['what']} {r['old']} -> {r['new']}" for r in found.versions
              if r["what"] in engines and r["same"] == "no" and r["old"] and r["new"]]
    return (
        f"verdicts: {found.same} the same{', ' + verdicts if verdicts else ''}{lost}; "
        f"{'; '.join(others) or 'no code has another version'}"
        f"{'; asked for different things, see settings' if found.settings else ''}"
    )


def data(found: Difference) -> dict:
    """Everything as JSON-able data."""
    return {
        "old": str(found.old.file), "new": str(found.new.file), "exit_status": found.exit_status,
        "summary": summary(found), "verdicts the same": found.same, **{n: getattr(found, n) for n in HEADINGS},
    }


def _write(found: Difference, out: Path) -> None:
    """Write page and JSON."""
    from harness.runs.atomic import write_json_atomic, write_text_atomic

    write_json_atomic(out / DATA, data(found))
    write_text_atomic(out / PAGE, page(found))


def page(found: Difference) -> str:
    """Return the HTML page: what got worse first, then each table in which something changed."""
    shown = [
        Section(heading=heading, note=NOTES.get(name, ""), rows=getattr(found, name))
        for name, heading in HEADINGS.items() if getattr(found, name)
    ]
    worse = Section(
        heading="What got worse", entries=tuple(map(_entry, found.worse)),
        note="" if found.worse else "No verdict got worse, and no run that completed before failed.",
    )
    places = f"old: {found.old.file.absolute()}\nnew: {found.new.file.absolute()}"
    title = f"{found.new.title}: what changed"
    return render_page(
        title=title, lead=f"{summary(found)}.", sections=[worse, *shown, Section(heading="Reports", text=places)]
    )


def _entry(row: dict) -> Entry:
    """Say what got worse: a run, or a check."""
    change = f"{row['old'] or 'was not there'} -> {row['new']}".replace("_", " ")
    if "engine" in row:
        title = f"{row['engine']}, packing {row['packing']}: {change}"
        return Entry(word="worse", title=title, why=row["why"] or "", command=row["rerun"] or "")
    why, _, command = row["why"].rpartition(RERUN)
    title = f"{row['level']}, {row['quantity']}: {row['left']} against {row['right']}: {change}"
    return Entry(word="worse", title=title, why=why or row["why"], command=command if why else "")
