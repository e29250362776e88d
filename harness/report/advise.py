"""Advice: a page, a picture, the advised scene, and the same numbers as CSV and JSON."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from harness.report.advise_figure import advise_figure, caption
from harness.report.advise_tables import tables
from harness.report.advise_verified import HEADINGS as VERIFIED
from harness.report.advise_verified import TABLES as VERIFICATION
from harness.report.advise_verified import (
    verification_data,
    verification_line,
    verification_sections,
    verification_tables,
)
from harness.report.advise_words import COMBINED, limits, paragraph
from harness.report.files import Names, Written, write_files
from harness.report.page import Figure, Section
from harness.report.tables import Answer

if TYPE_CHECKING:
    from harness.studies.advise.study import Advice
    from harness.studies.advise.verification import Verification

TABLES = ("advice", "sum", "ladders")
SCENE = "advised.toml"
NAMES = Names(stem="advice", tables=TABLES, further=(SCENE, *(f"{t}.csv" for t in VERIFICATION)))
HEADINGS = {"advice": "What to take", "sum": "What it comes to", "ladders": "What was measured"}
NOTES = {
    "advice": "Errors against the limit of each knob's own ladder, over the quantity's size. Measured: that rung was "
    "run. Extrapolated: it follows from others by the stated power. Not measured: nothing is known, so "
    "nothing is turned.",
    "advice_free": "Errors against the oracle, over the largest relative speed at the start. Measured: that rung was "
    "run. Extrapolated: it follows from others by the stated power. Not measured: nothing is known, so nothing is "
    "turned.",
    "sum_free": "Expected error: what is seen, and the noise. Seen are errors of more than two standard errors, added "
    "up as if all had one sign; the other errors, and all standard errors, are noise, in quadrature.",
    "sum": f"{COMBINED} Scatter of one packing: that of all sizes together where the number of particles was turned, "
    "else that of the scene as declared; over the limit of that ladder.",
    "ladders": "All rungs of the engine of the answer.",
}


def advise_answer(advice: Advice, verification: Verification | None = None) -> Answer:
    """Return the tables for people and everything for programs."""
    found = tables(advice)
    shown = {HEADINGS[name]: found[name] for name in ("advice", "sum")}
    if verification is not None:
        shown[VERIFIED["verification"]] = verification_tables(verification)["verification"]
    return Answer(tables=shown, data=advise_data(advice, verification))


def advise_data(advice: Advice, verification: Verification | None = None) -> dict:
    """Return everything with all digits; "verification" where there was one, see `verification_data`."""
    from msgspec import to_builtins

    choice, evidence = advice.answer, advice.evidence
    verified = {} if verification is None else {"verification": verification_data(verification)}
    return {
        "scene_file": evidence.scene_file.name, "quantity": evidence.quantity, "tolerance": advice.tolerance,
        "kept": advice.choice is not None, "why": advice.why, "packings_needed_in_ladders": advice.needed,
        "below_floor": advice.below_floor, "engine": choice.engine if choice else None,
        "settings": {k: r.value for k, r in choice.rungs.items()} if choice else {},
        "origin": {k: r.origin for k, r in choice.rungs.items()} if choice else {},
        "without": list(choice.without) if choice else [], "packings": advice.packings,
        "expected_error": choice.total.error(advice.packings) if choice else None,
        "cpu_seconds": choice.seconds * advice.packings if choice else None, "source": evidence.source,
        "combined": COMBINED, "limits": limits(advice, verification), "words": paragraph(advice),
        "exit_status": exit_status(advice, verification),
        "scene": to_builtins(advice.scene) if advice.scene else None, "tables": _tables(advice, verification),
        **verified,
    }


def exit_status(advice: Advice, verification: Verification | None = None) -> int:
    """1 when no setting keeps the tolerance, or the one that should does not, or could not be run."""
    return max(advice.exit_status, 0 if verification is None else verification.exit_status)


def _tables(advice: Advice, verification: Verification | None) -> dict[str, list[dict]]:
    return tables(advice) | ({} if verification is None else verification_tables(verification))


def write_advice(advice: Advice, out: Path, verification: Verification | None = None) -> Path:
    """Write page, JSON, pictures, CSV tables and the advised scene into `out`, each whole or not at all."""
    from harness.scene.write import scene_text, write_scene

    out.mkdir(parents=True, exist_ok=True)
    text = ""
    if advice.choice is not None:
        write_scene(advice.scene, advice.evidence.scene_file, out / SCENE, about=_about(advice))
        text = scene_text(advice.scene, about=_about(advice))
    else:
        (out / SCENE).unlink(missing_ok=True)
    for name in VERIFICATION if verification is None else ():
        (out / NAMES.table(name)).unlink(missing_ok=True)
    return write_files(out, NAMES, Written(
        title=f"Advice: {advice.evidence.scene.title}", lead=_lead(advice),
        caption=caption(verification), figure=advise_figure(advice, verification),
        tables=_tables(advice, verification), data=advise_data(advice, verification),
        sections=lambda figures: _sections(advice, figures, text, verification, out),
    ))


def _sections(
    advice: Advice, figures: tuple[Figure, ...], text: str, verification: Verification | None, out: Path
) -> list[Section]:
    found, said = tables(advice), [paragraph(advice), *([verification_line(verification)] if verification else [])]
    scene = [Section(heading="The advised scene", note=f"Written as {SCENE}.", text=text)] if text else []
    return [
        Section(heading="In words", note=" ".join(said)),
        *(Section(heading=HEADINGS[n], note=_note(advice, n), rows=found[n]) for n in ("advice", "sum") if found[n]),
        *(verification_sections(verification) if verification is not None else ()),
        Section(heading="Ladders", figures=figures),
        *(Section(heading=HEADINGS[n], note=NOTES[n], rows=found[n]) for n in ("ladders",) if found[n]),
        Section(heading="What this does not know", text="\n".join(limits(advice, verification))), *scene,
        Section(heading="Reproduce", text=_command(advice, verification, out)),
    ]


def _note(advice: Advice, table: str) -> str:
    """Return what stands above a table; free scenes have no scatter over packings."""
    return NOTES.get(f"{table}_free", NOTES[table]) if advice.evidence.free else NOTES[table]


def _lead(advice: Advice) -> str:
    evidence = advice.evidence
    of = "phases of the step" if evidence.free else "packings"
    return (
        f"{evidence.quantity} within {100.0 * advice.tolerance:g} %, from ladders of {evidence.packings} {of} in "
        f"{evidence.source}; engines {', '.join(evidence.ladders)}."
    )


def _about(advice: Advice) -> str:
    evidence = advice.evidence
    return (
        f"{evidence.scene_file.name} as advised for {evidence.quantity} within {100.0 * advice.tolerance:g} %.\n"
        f"{paragraph(advice)}"
    )


def _command(advice: Advice, verification: Verification | None, out: Path) -> str:
    evidence = advice.evidence
    verify = [] if verification is None else ["--verify", *([] if evidence.free else [str(verification.count)])]
    effects = ["--effects-from", evidence.effects_source] if evidence.effects_source else []
    engines = [] if evidence.engines is None else ["--engines", ",".join(evidence.engines)]
    return shlex.join([
        "grainproof", "advise", str(evidence.scene_file), "--quantity", evidence.quantity, "--tolerance",
        f"{advice.tolerance:g}", "--from", evidence.source, *effects, *engines, *verify, "--out", str(out),
    ])
