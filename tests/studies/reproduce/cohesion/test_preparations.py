"""Another preparation of the cohesion study: what changes, and what is said of stresses that are put in."""

import pytest

from harness.studies.reproduce.boxes import LARGEST, SIDE
from harness.studies.reproduce.cohesion import declared, preparations


@pytest.fixture
def tests(ask):
    return declared.main_tests(ask("paper"))


@pytest.fixture
def talk(tests):
    return {key: declared.talk_plateau(*key) for key in tests}


def as_the_talk(tests, talk, made, box_run, *, part):
    """Runs whose top of the curve is the talk's stress times `part`, and whose plateau is lower."""
    return [
        made(preparations._name(*key), "e", 0,
             box_run({declared.PLATEAU: 0.5 * talk[key], LARGEST: part * talk[key], SIDE: key[0]}))
        for key in tests
    ]


def test_only_the_preparation_changes(tests, ask):
    planned = [c for c in declared.cases(ask("paper")) if c.name.startswith("prepared at")]
    assert len(planned) == len(tests) == 10
    assert len({c.scene.title for c in planned} | {s.title for s in tests.values()}) == 20
    for c, (key, own) in zip(planned, tests.items(), strict=True):
        assert c.packings == 1
        assert c.scene.preparation.pressure == preparations.PREPARED_AT > c.scene.side.pressure == key[0]
        for same in ("contact", "particles", "side", "top", "numerics"):
            assert getattr(c.scene, same) == getattr(own, same)


def test_rows_stand_beside_the_talk(tests, talk, made, box_run):
    found = as_the_talk(tests, talk, made, box_run, part=0.9)
    rows = preparations.preparation_rows(found, tests, talk, declared.talk_cohesions())
    assert len(rows) == 10
    top = [r for r in rows if r["read"] == "top"]
    assert [r["stresses off the talk"] for r in top] == pytest.approx([-0.1] * 5)
    # the line of stresses that are all a tenth smaller: K smaller by a tenth, c by the root of 0.9
    assert [r["c (N/m)"] for r in top] == pytest.approx(
        [0.9**0.5 * r[preparations.TALK] for r in top], abs=1.0  # the talk prints whole numbers
    )


def test_words_say_how_far_off_and_what_was_tried(tests, talk, made, box_run):
    rows = preparations.preparation_rows(
        as_the_talk(tests, talk, made, box_run, part=1.0), tests, talk, declared.talk_cohesions()
    )
    words = preparations.preparation_words(rows)
    assert "after trying 500, 1000 and 2000" in words
    assert "(the talk: 11, 32, 40, 60, 71)" in words
    assert "read at the top of the curve, stresses are +0 % off" in words
    assert "read at the plateau of the curve, stresses are -50 % off" in words


def test_a_run_that_failed_leaves_its_rows_out(tests, talk, made, box_run):
    found = as_the_talk(tests, talk, made, box_run, part=1.0)[1:]
    assert len(preparations.preparation_rows(found, tests, talk, declared.talk_cohesions())) == 8
