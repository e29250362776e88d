"""The support matrix: every effect, every engine, and the limits that engines themselves state."""

from typing import get_args

import pytest

from harness.engines.protocol import Level
from harness.engines.registry import ENGINES
from harness.report.asked import hard_cases, ordinary_cases
from harness.report.engines import engines_answer
from harness.report.tables import NARROWEST, plain_table, text
from harness.runs.atomic import json_text
from harness.scene.effects import EFFECT_NAMES, effects_on


def test_the_ordinary_cases_have_every_effect():
    assert {e for case in ordinary_cases() for e in effects_on(case)} == set(EFFECT_NAMES)


def test_the_matrix_has_every_effect_and_engine():
    rows = engines_answer().data["support"]
    assert [r["effect"] for r in rows] == list(EFFECT_NAMES)
    assert all(set(r) == {"effect", *ENGINES} for r in rows)
    words = {r[e].split(", but ")[0] for r in rows for e in ENGINES}
    assert words <= {level.replace("_", " ") for level in get_args(Level)}


def test_a_level_that_holds_in_part_says_where():
    """What LIGGGHTS says in its notes: couples in 3D, a memory lost across a periodic axis, laws it has not."""
    rows = {r["effect"]: r for r in engines_answer().data["support"]}
    assert rows["rolling resistance: constant"]["liggghts"] == "exact, but partial in 3D"
    assert rows["normal contact: hysteretic"]["liggghts"] == "exact, but unsupported in a periodic box"
    assert rows["normal damping"]["liggghts"] == "exact, but unsupported with dmt or with jkr"
    assert rows["adhesion"]["lammps"] == (
        "exact, but partial with jkr, unsupported with hysteretic or with hysteretic_variable"
    )
    assert rows["plastic memory"]["liggghts"] == "exact, but unsupported with hysteretic in a periodic box"


def test_on_the_page_kernels_that_say_the_same_are_one_column():
    table = engines_answer().tables["What each engine does with each effect"]
    assert list(table[0]) == ["effect", "lammps", "liggghts", "kernel:*"]


@pytest.mark.parametrize("width", [80, 100, 160])
def test_sentences_stay_within_the_page_and_ordinary_words_whole(width):
    for title, rows in engines_answer().tables.items():
        lines = plain_table(rows, title, width=width).splitlines()
        assert max(map(len, lines)) <= width
        words = {word for r in rows for v in r.values() for word in text(v).split() if len(word) <= NARROWEST}
        assert words <= set(" ".join(lines).split())


def test_every_engine_has_the_laws_of_the_talks_box():
    """And the kernel has every law but the one that needs contacts without overlap."""
    rows = {r["effect"]: r for r in engines_answer().data["support"]}
    for effect in ("normal contact: linear", "sliding friction: spring", "wall friction", "loaded walls", "rotation"):
        assert {rows[effect][e] for e in ENGINES} <= {"exact", "equivalent"}
    kernels = {effect: {r[e] for e in ENGINES if e.startswith("kernel")} for effect, r in rows.items()}
    assert {effect for effect, levels in kernels.items() if levels != {"exact"}} == {"normal contact: jkr"}


def test_defects_are_what_the_engines_state():
    rows = engines_answer().data["defects"]
    stated = {(name, d.name) for name, engine in ENGINES.items() for d in engine.known_defects()}
    assert {(r["engine"], r["defect"]) for r in rows} == stated
    assert all(all(r.values()) for r in rows)
    assert {"lammps", "liggghts"} <= {r["engine"] for r in rows}


def test_every_judgement_has_its_note_once():
    answer = engines_answer()
    notes = [(r["engine"], r["note"]) for r in answer.data["notes"]]
    assert len(notes) == len(set(notes))
    judged = {(n, s.note) for n, e in ENGINES.items() for case in ordinary_cases() for s in e.supports(case)}
    assert set(notes) == judged


def test_limits_are_what_the_engines_state():
    rows = engines_answer().data["limits"]
    assert {r["case"] for r in rows} == set(hard_cases())
    assert {r["support"] for r in rows} <= {"unsupported", "partial", "known wrong"}
    assert not {r["engine"] for r in rows} & {n for n in ENGINES if n.startswith("kernel")}
    assert all(r["note"] for r in rows)


def test_every_engine_is_listed_and_the_answer_is_data():
    answer = engines_answer()
    assert [r["engine"] for r in answer.data["engines"]] == list(ENGINES)
    assert all(r["detail"] for r in answer.data["engines"])
    assert json_text(answer.data)
    shown = dict(zip(answer.data, answer.tables.values(), strict=True))
    assert {name for name, rows in shown.items() if rows != answer.data[name]} == {"support"}
    assert [row["effect"] for row in shown["support"]] == [row["effect"] for row in answer.data["support"]]
