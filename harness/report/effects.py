"""The effects report: a page, a picture, the reduced scene, and the same numbers as CSV and JSON."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from harness.errors import InputError
from harness.report.effects_figure import CAPTION, effects_figure
from harness.report.effects_notes import NOTES
from harness.report.effects_tables import saved, tables
from harness.report.effects_words import paragraph
from harness.report.page import Figure, Section, render_page
from harness.report.tables import Answer, csv_text
from harness.studies.effects.asked import BY

if TYPE_CHECKING:
    from harness.studies.effects.study import EffectsStudy

TABLES = ("effects", "smallest", "trials", "chosen", "costs", "traces", "zeros", "changes")
PAGE, DATA, PICTURES, REDUCED = "effects.html", "effects.json", ("effects.png", "effects.svg"), "reduced.toml"

HEADINGS = {
    "effects": "Which effects are on, and why", "smallest": "The smallest set", "trials": "Combinations that were run",
    "chosen": "What a switch changes", "costs": "What a step costs", "traces": "What an effect leaves behind",
    "zeros": "Off, and the coefficient at zero", "changes": "All quantities",
}


def effects_answer(study: EffectsStudy) -> Answer:
    """Return the main tables for people and everything for programs."""
    found = tables(study)
    shown = {HEADINGS[name]: found[name] for name in ("effects", "chosen", "costs", "smallest")}
    return Answer(tables=shown, data=effects_data(study))


def effects_data(study: EffectsStudy) -> dict:
    """Return all tables with all digits, all deck lines, scene and machine."""
    from msgspec import to_builtins

    return {
        "scene_file": study.scene_file.name, "scene": to_builtins(study.scene),
        "quantities": list(study.asked.quantities), "tolerance": study.asked.tolerance,
        "engines": [e.name for e in study.asked.engines], "by": study.asked.by.name,
        "packings": study.asked.packings, "left_out": list(study.smallest.left_out), "saved": saved(study),
        "verified": study.smallest.verified, "exit_status": study.exit_status, "words": paragraph(study),
        "host": to_builtins(study.host), "wall_seconds": study.wall_seconds, "own_seconds": study.own_seconds,
        "tables": tables(study),
        "deck_lines": [
            {"effect": f.effect, "engine": f.engine, "lines": list(f.added), "operations": f.operations}
            for f in study.footprints
        ],
        "refused": [{"engine": e, "scene": v, "why": why} for (e, v), why in study.refused.items()],
        "runs": [
            {"scene": name, "status": o.status, "reason": o.reason, "cpu_seconds": o.cpu_seconds}
            for name, of in study.outcomes.items() for o in of
        ],
    }


def write_effects(study: EffectsStudy, out: Path) -> Path:
    """Write page, JSON, pictures, CSV tables and the reduced scene into `out`, each whole or not at all."""
    from harness.report.figures import png_bytes, png_uri, svg_bytes
    from harness.runs.atomic import write_bytes_atomic, write_json_atomic, write_text_atomic
    from harness.scene.write import write_scene

    out.mkdir(parents=True, exist_ok=True)
    figure = effects_figure(study)
    for name, rows in tables(study).items():
        write_text_atomic(out / f"{name}.csv", csv_text(rows))
    write_bytes_atomic(out / PICTURES[0], png_bytes(figure, dpi=110))
    write_bytes_atomic(out / PICTURES[1], svg_bytes(figure))
    write_json_atomic(out / DATA, effects_data(study))
    write_scene(study.reduced, study.scene_file, out / REDUCED, about=_about(study))
    page = render_page(
        title=f"What effects are worth: {study.scene.title}", lead=f"{summary(study)}.",
        sections=_sections(study, Figure(uri=png_uri(figure), caption=CAPTION)),
    )
    write_text_atomic(out / PAGE, page)
    return out / PAGE


def check_places(out: Path) -> None:
    """Raise InputError when a folder stands where a file of the report goes: before anything is run."""
    for place in (out / name for name in (PAGE, DATA, REDUCED, *PICTURES, *(f"{name}.csv" for name in TABLES))):
        if place.is_dir():
            raise InputError(
                file=place, expected="a file or nothing, as the report goes there", got="a folder",
                fix="move it away or name another --out",
            )


def summary(study: EffectsStudy) -> str:
    """Return one line: how many effects, on whom, by what they are judged."""
    switched = sum(v.scene is not None for v in study.variants)
    many = f"{study.asked.packings} packing{'s' * (study.asked.packings > 1)}"
    return (
        f"{sum(e.on for e in study.effects)} of {len(study.effects)} effects are on, {switched} were switched alone; "
        f"{many} on {study.asked.by.name}; timed on {', '.join(e.name for e in study.asked.engines)}; "
        f"{', '.join(study.asked.quantities)} to {100.0 * study.asked.tolerance:g} %"
    )


def _sections(study: EffectsStudy, figure: Figure) -> list[Section]:
    found = tables(study)
    parts = [Section(heading=HEADINGS[n], note=NOTES[n], rows=found[n]) for n in TABLES if found[n]]
    return [
        Section(heading="In words", note=paragraph(study)),
        Section(heading="Time and answer", figures=(figure,)), *parts,
        Section(heading="Reproduce", text=_command(study)),
    ]


def _about(study: EffectsStudy) -> str:
    out = ", ".join(study.smallest.left_out)
    what = f"without {out}" if out else "as it is: no effect may go"
    return (
        f"{study.scene_file.name} {what}.\nWritten by grainproof effects: "
        f"{', '.join(study.asked.quantities)} within {100.0 * study.asked.tolerance:g} %."
    )


def _command(study: EffectsStudy) -> str:
    asked = study.asked
    words = [
        "grainproof", "effects", str(study.scene_file), "--quantity", ",".join(asked.quantities), "--tolerance",
        f"{asked.tolerance:g}", "--packings", str(asked.packings), "--engines", ",".join(e.name for e in asked.engines),
    ]
    if asked.only:
        words += ["--effects", ",".join(n.replace(" ", "_") for n in asked.only)]
    return shlex.join([*words, *(["--by", asked.by.name] if asked.by.name != BY else [])])
