"""Rows on a terminal, as plain text and as CSV."""

import csv
import io

import numpy as np
import pytest

from harness.report.tables import csv_text, plain_table, print_table, text

ROWS = [
    {"engine": "lammps", "value": 0.1 + 0.2, "note": None},
    {"engine": "a,\"b\"\nc", "value": float("nan"), "note": "[red]x"},
]


def test_csv_keeps_every_digit_and_every_character():
    back = list(csv.DictReader(io.StringIO(csv_text(ROWS))))
    assert [r["engine"] for r in back] == [r["engine"] for r in ROWS]
    assert float(back[0]["value"]) == 0.1 + 0.2
    assert np.isnan(float(back[1]["value"]))
    assert [r["note"] for r in back] == ["", "[red]x"]


def test_csv_of_numbers_reads_back_to_the_same_bits():
    numbers = np.random.default_rng(1).normal(size=50) * 10.0 ** np.arange(-25, 25)
    back = csv.DictReader(io.StringIO(csv_text({"v": v} for v in numbers)))
    assert [float(r["v"]) for r in back] == numbers.tolist()


def test_csv_of_nothing_is_empty_and_of_unequal_rows_an_error():
    assert csv_text([]) == ""
    with pytest.raises(ValueError, match="same columns"):
        csv_text([{"a": 1}, {"b": 2}])
    assert csv_text([{"a": 1, "b": 2}, {"b": 4, "a": 3}]) == "a,b\n1,2\n3,4\n"


def test_plain_text_is_one_line_a_row():
    lines = plain_table([{"a": 1, "long name": 2.0}, {"a": None, "long name": 1e-12}], "T").splitlines()
    assert lines == ["T", "  a  long name", "  1  2", "  -  1e-12"]
    assert plain_table([], "T") == "T\n  nothing"


def test_prose_is_wrapped_into_the_width_and_loses_nothing():
    rows = [{"a": "x", "note": "one two three four five six seven"}, {"a": "y", "note": "eight"}]
    lines = plain_table(rows, "T", width=20).splitlines()
    assert lines == ["T", "  a  note", "  x  one two three", "     four five six", "     seven", "  y  eight"]
    assert plain_table(rows, "T", width=80) == plain_table(rows, "T")


def test_columns_that_need_little_leave_room_to_the_others():
    rows = [{"a": "x" * 10, "b": "word " * 20, "c": "word " * 40}]
    first = plain_table(rows, "T", width=100).splitlines()[2]
    assert first == "  " + "x" * 10 + "  " + " ".join(["word"] * 8).ljust(42) + "  " + " ".join(["word"] * 8)


def test_elsewhere_than_on_a_terminal_there_is_no_colour(capsys):
    print_table([{"verdict": "differs"}], "T")
    assert capsys.readouterr().out == "T\n  verdict\n  differs\n"


def test_on_a_terminal_brackets_are_shown_not_obeyed(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("TTY_COMPATIBLE", "1")
    print_table([{"verdict": "differs", "why": "[bold]not bold[/bold]"}], "[red]title")
    out = capsys.readouterr().out
    assert "[bold]not bold[/bold]" in out
    assert "[red]title" in out
    assert "\x1b[1;31m" in out


def test_text_for_people():
    assert [text(v) for v in (None, 1234567, 1.0, 1e-17, float("nan"), "x", True)] == [
        "-", "1234567", "1", "1e-17", "nan", "x", "True",
    ]
