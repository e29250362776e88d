"""Tables, pictures and page of a reproduced result."""

import dataclasses

import numpy as np
import pytest

from harness.errors import InputError
from harness.report.reproduce import (
    check_report_place,
    command,
    page_folder,
    reproduce_answer,
    study_list,
    summary,
    write_reproduce,
)
from harness.report.reproduce_figures import draw
from harness.report.reproduce_keep import check_keep_place
from harness.report.reproduce_tables import chart_csv, compact_rates, compact_rows, rate_rows, value_rows
from harness.studies.reproduce.protocol import (
    Ask,
    Chart,
    Declared,
    DiscPicture,
    Line,
    Measured,
    Panel,
    RatePoint,
    Result,
    Study,
    StudyRun,
)
from harness.studies.reproduce.rows import Within, compared, over_packings, shown
from postproc.snapshot import Columns, Snapshot


@pytest.fixture
def study():
    return Study(
        name="angle", title="An angle", claim="13 degrees", source="a talk, page 7",
        sizes={"quick": Declared(says="few", packings=2), "paper": Declared(says="many", packings=4)},
        engines=("kernel:talk",), values=("talk_geometrical_angle",), run=lambda _: None, cases=lambda _: (),
        lacking={"lammps": "has no such law"},
    )


@pytest.fixture
def ask(tmp_path):
    return Ask(size="quick", engines=(), out=tmp_path)


@pytest.fixture
def chart():
    x = np.linspace(0.0, 1.0, 5)
    return Chart(
        name="c", caption="A chart.", x="x (m)", y="y (N)",
        lines=(Line(name="ours", engine="lammps", x=x, y=x**2, error=0.1 * x, look="points"),
               Line(name="talk", x=x, y=x, look="talk"), Line(name="fit", x=x, y=x, look="fit")),
    )


def discs() -> Snapshot:
    return Snapshot(
        time=0.0, dimension=2,
        particles=Columns({"id": [1, 2], "x": [0.5, 1.5], "y": [0.5, 0.5], "radius": [0.5, 0.5]}, "particles"),
    )


@pytest.fixture
def result(chart, ran):
    ours = [over_packings("kernel:talk", [12.9, 13.0, 13.2]), over_packings("liggghts", [20.0, 20.1, 20.2])]
    rates = tuple(
        RatePoint(quantity="angle", unit="deg", setting=f"T = {t} s", number=1 / t,
                  ours=over_packings("kernel:talk", [10.0 + t, 11.0 + t]))
        for t in (1.0, 2.0)
    )
    pictures = (chart, DiscPicture(
        name="d", caption="Discs.", label="turn (deg)", panels=(
            Panel(title="a", frame=discs(), colour=np.array([-1.0, 2.0])),
            Panel(title="b", frame=discs(), arrows=np.array([[0.1, 0.0], [0.0, 0.1]])),
        ),
    ))
    rows = [compared("talk_geometrical_angle", m, Within(tolerance=2.0)) for m in ours]
    return Result(
        rows=(*rows, shown("other", "1", ours[0], "the talk prints no number")), rates=rates,
        rate_words="It converges.", pictures=pictures, words=("First.", "Second <b>."),
        unsupported={"lammps": "has no such law"}, tables={"More": [{"a": 1.0, "b": "x"}]},
        runs=(StudyRun(engine="kernel:talk", case="c", packing=0, outcome=ran("kernel:talk").outcome),),
    )


def test_rows_say_how_the_talks_value_is_known(result):
    rows = value_rows(result.rows)
    assert [r["known"] for r in rows] == ["seen", "seen", None]
    assert [r["verdict"] for r in rows] == ["agrees", "differs", "not_checked"]
    assert rows[0]["ours - talk"] == pytest.approx(rows[0]["ours"] - 13.0)
    assert rows[0]["relative"] == pytest.approx(rows[0]["ours - talk"] / 13.0)
    assert rows[2]["talk"] is None


def test_what_differs_fails(result):
    assert result.exit_status == 1
    assert summary(result).startswith("against the talk: 1 agrees, 1 differs, 1 not checked")


def test_changes_are_taken_packing_by_packing(result):
    first, second = rate_rows(result.rates)
    assert first["change"] is None
    assert second["change"] == pytest.approx(1.0)
    assert second["error of the change"] == pytest.approx(0.0, abs=1e-12)  # all packings move alike


def test_a_change_of_different_packings_has_both_errors():
    points = tuple(
        RatePoint(
            quantity="q", unit="1", setting=s, number=None, ours=Measured(engine="e", value=v, error=e, packings=3)
        )
        for s, v, e in (("a", 1.0, 0.3), ("b", 2.0, 0.4))
    )
    assert rate_rows(points)[1]["error of the change"] == pytest.approx(0.5)


def test_a_chart_is_written_as_numbers(chart):
    head, *lines = chart_csv(chart).splitlines()
    assert head == "line,engine,x (m),y (N),error"
    assert len(lines) == 15
    assert lines[1] == "ours,lammps,0.25,0.0625,0.025"
    assert chart_csv(chart, digits=1).splitlines()[2] == "ours,lammps,0.2,0.06,0.03"


def test_pictures_can_be_drawn(result):
    for picture in result.pictures:
        assert draw(picture).axes


def test_the_page_holds_everything(study, ask, result):
    page = write_reproduce(study, ask, result).read_text()
    said = ("13 degrees", "An angle", "It converges.", "Second &lt;b&gt;.", "has no such law", "More", "A chart.")
    assert all(words in page for words in said)
    assert page.count("data:image/png") == 2
    assert f"--out {ask.out}" in page
    names = {p.name for p in page_folder(study, ask).iterdir()}
    assert names == {"report.html", "report.json", "rows.csv", "rates.csv", "c.csv", "c.png", "d.png"}


def test_places_are_looked_at_first(study, ask, tmp_path):
    check_report_place(study, ask)
    (page_folder(study, ask) / "report.html").mkdir(parents=True)
    with pytest.raises(InputError, match="expected a file or nothing"):
        check_report_place(study, ask)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="--keep"):
        check_keep_place(tmp_path / "file")


def test_answers(study, ask, result):
    assert study_list([study]).data["studies"][0]["lacking"] == "lammps"
    answer = reproduce_answer(study, ask, result)
    assert answer.data["unsupported"] == {"lammps": "has no such law"}
    assert answer.data["command"].startswith("grainproof reproduce angle --size quick")
    assert list(answer.tables) == ["An angle: a talk, page 7", "Numbers that the talk does not print", "Convergence"]


def test_the_page_shows_engines_side_by_side(result):
    (row,) = compact_rows(result.rows[:2])
    assert (row["talk"], row["known"]) == ("13", "seen")
    assert row["kernel:talk"] == "13.033 ± 0.088"
    assert (row["verdict"], row["liggghts"]) == ("differs", "20.1 ± 0.058")  # the worst of both
    (free,) = compact_rows(result.rows[2:])
    assert "talk" not in free
    assert [r["kernel:talk"] for r in compact_rates(result.rates)] == ["11.5 ± 0.5", "12.5 ± 0.5"]


@pytest.mark.parametrize(("value", "error", "said"), [
    (218.345678, 0.00019, "218.34568 ± 0.00019"), (218.345678, 1.3, "218.3 ± 1.3"), (13.0, 0.088, "13 ± 0.088"),
    (0.0, 0.1, "0 ± 0.1"), (218.345678, None, "218.3"), (218.345678, 0.0, "218.3"), (1.0, 1e-16, "1 ± 1e-16"),
])
def test_a_number_has_the_digits_that_its_error_speaks_of(value, error, said):
    from harness.report.reproduce_tables import _said
    from harness.studies.reproduce.protocol import Measured

    assert _said(Measured(engine="lammps", value=value, error=error, packings=2)) == said


def test_the_command_asks_for_nothing_that_the_study_refuses(study, ask):
    def refuse(asked):
        if asked.packings is not None:
            raise InputError(file="--packings", expected="nothing", got=asked.packings)

    assert "--packings 2" in command(study, ask)
    assert "--packings" not in command(dataclasses.replace(study, refuse=refuse), ask)
    assert "--out" not in command(study, ask), "what is kept has no place of one machine"
