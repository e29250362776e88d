"""The effects report: a page, a picture, the reduced scene, and the same numbers as CSV and JSON."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from harness.report.effects_figure import caption, effects_figure
from harness.report.effects_notes import NOTES
from harness.report.effects_tables import saved, tables, traces_in_short, visible_trials
from harness.report.effects_words import paragraph
from harness.report.files import Names, Written, write_files
from harness.report.page import Figure, Section
from harness.report.tables import Answer
from harness.scene.model import Free
from harness.studies.effects.asked import BY

if TYPE_CHECKING:
    from harness.studies.effects.study import EffectsStudy

TABLES = ("effects", "smallest", "trials", "chosen", "costs", "traces", "zeros", "changes")
REDUCED = "reduced.toml"
NAMES = Names(stem="effects", tables=TABLES, further=(REDUCED,))

HEADINGS = {
    "effects": "Which effects are on, and why", "smallest": "The smallest set", "trials": "Combinations that were run",
    "chosen": "What a switch changes", "costs": "What a step costs", "traces": "What an effect leaves behind",
    "zeros": "Off, and the coefficient at zero or next to it", "changes": "All quantities",
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
    from harness.scene.write import write_scene

    out.mkdir(parents=True, exist_ok=True)
    write_scene(study.reduced, study.scene_file, out / REDUCED, about=_about(study))
    return write_files(out, NAMES, Written(
        title=f"What effects are worth: {study.scene.title}", lead=f"{summary(study)}.", caption=caption(study),
        figure=effects_figure(study), tables=tables(study), data=effects_data(study),
        sections=lambda figures: _sections(study, figures, out),
    ))


def summary(study: EffectsStudy) -> str:
    """Return one line: how many effects, on whom, by what they are judged."""
    switched = sum(v.scene is not None for v in study.variants)
    many = "one start" if isinstance(study.scene, Free) else (
        f"{study.asked.packings} packing{'s' * (study.asked.packings > 1)}"
    )
    return (
        f"{sum(e.on for e in study.effects)} of {len(study.effects)} effects are on, {switched} were switched, one at "
        f"a time; answers of {many} on {study.asked.by.name}; times on "
        f"{', '.join(e.name for e in study.asked.engines)}; "
        f"{', '.join(study.asked.quantities)} to {100.0 * study.asked.tolerance:g} %"
    )


def _sections(study: EffectsStudy, figures: tuple[Figure, ...], out: Path) -> list[Section]:
    found = tables(study) | {"traces": traces_in_short(study), "trials": visible_trials(study)}
    parts = [Section(heading=HEADINGS[n], note=NOTES[n], rows=found[n]) for n in TABLES if found[n]]
    return [
        Section(heading="In words", note=paragraph(study)),
        Section(heading="Time and answer", figures=figures), *parts,
        Section(heading="Reproduce", text=_command(study, out)),
    ]


def _about(study: EffectsStudy) -> str:
    out = ", ".join(study.smallest.left_out)
    what = f"without {out}" if out else "as it is: no effect may go"
    return (
        f"{study.scene_file.name} {what}.\nWritten by grainproof effects: "
        f"{', '.join(study.asked.quantities)} within {100.0 * study.asked.tolerance:g} %."
    )


def _command(study: EffectsStudy, out: Path) -> str:
    asked = study.asked
    words = [
        "grainproof", "effects", str(study.scene_file), "--quantity", ",".join(asked.quantities), "--tolerance",
        f"{asked.tolerance:g}", "--packings", str(asked.packings), "--engines", ",".join(e.name for e in asked.engines),
    ]
    if asked.only:
        words += ["--effects", ",".join(n.replace(" ", "_") for n in asked.only)]
    words += ["--by", asked.by.name] if asked.by.name != BY else []
    return shlex.join([*words, "--out", str(out)])
