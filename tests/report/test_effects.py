"""The effects report: page, tables, picture, words, and a reduced scene that loads."""

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import pytest

from harness.cli import main
from harness.errors import InputError
from harness.report.effects import NAMES, effects_answer, write_effects
from harness.report.effects_tables import BETWEEN, saved, tables, traces_in_short, visible_trials
from harness.report.effects_words import paragraph
from harness.report.tables import csv_text
from harness.scene.load import load_scene
from harness.studies.effects import effects_study, timing
from harness.studies.effects import study as module
from harness.studies.effects.cost import StepCost
from harness.studies.effects.probes import Probed, ZeroCheck
from harness.studies.effects.study import REDUCED
from harness.studies.effects.variants import BASE

FILE = Path(__file__).resolve().parents[2] / "inputs" / "scenes" / "oblique_impact.toml"
ONLY = ["normal damping", "sliding friction"]


def canned_costs(_engine, _version, systems, **_):
    """Steps without an effect take 0.9 of the time."""
    ratios = {name: 1.0 if name == BASE else 0.9 for name in systems}
    return {n: StepCost(seconds=(r * 1e-5,) * 3, ratios=(r,) * 3, setup=0.1, steps=10, bodies=2)
            for n, r in ratios.items()}


def canned_probe(pairs, engines, *_, **__):
    """Off is zero."""
    return Probed(columns={}, checks=tuple(
        ZeroCheck(effect=p.effect, engine=e.name, says="0", verdict="agrees", why="", deviation=1e-15, acts=0.1)
        for p in pairs for e in engines
    ))


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    out = tmp_path_factory.mktemp("effects")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(timing, "step_costs", canned_costs)
        patch.setattr(module, "probe", canned_probe)
        return effects_study(FILE, out, engines=["kernel:talk"], only=ONLY, tolerance=0.3)


@pytest.fixture(scope="module")
def written(study, tmp_path_factory):
    out = tmp_path_factory.mktemp("report")
    write_effects(study, out)
    return out


def test_everything_is_written(written):
    names = ("effects.html", "effects.json", "effects.png", "effects.svg", "reduced.toml")
    for name in (*names, *(f"{t}.csv" for t in NAMES.tables)):
        assert (written / name).stat().st_size > 0, name


def test_the_reduced_scene_is_one(written, study):
    reduced = load_scene(written / "reduced.toml")
    assert reduced.contact.normal.normal_damping == 0.0
    assert reduced.contact.sliding == study.scene.contact.sliding


def test_the_page_says_what_the_tables_say(written, study):
    page = (written / NAMES.page).read_text()
    assert f"--out {written}" in page
    for heading in ("The smallest set", "What a switch changes", "Off, and the coefficient at zero", "Reproduce"):
        assert heading in page
    rows = list(csv.DictReader(io.StringIO((written / "chosen.csv").read_text())))
    assert {r["scene"] for r in rows} == {"without normal damping", "without sliding friction"}
    assert all(r["error bar (%)"] == r["change in error bars"] == "" for r in rows), "a tolerance is no error bar"
    data = json.loads((written / "effects.json").read_text())
    assert data["left_out"] == ["normal damping"]
    assert data["verified"] is True


def test_words_name_what_matters_and_what_was_verified(study):
    words = paragraph(study)
    assert "Needed to keep exit within 30 % (in brackets what changes without): sliding friction" in words
    assert "leaves out normal damping; a run of the reduced scene shows it" in words
    assert "0 differ" in words
    assert "Timed again, that saves 10 % of a run on kernel:talk" in words


def test_next_to_nothing_is_not_called_zero(study):
    first, *others = study.zeros
    assert "1e-30 of itself" not in paragraph(study)
    faint = paragraph(replace(study, zeros=(replace(first, exact=False), *others)))
    assert "(1 of them at 1e-30 of itself, where 0 is how the scene says off)" in faint


def test_words_say_what_else_changes_and_shown_only_what_is(study):
    """Without the dashpot the spin changes by more than the tolerance of another choice of quantity."""
    def as_other(c, verdict):
        return replace(c, quantity="stress_strain", verdict=verdict, relative=0.142, error=0.005)

    (trial,) = study.smallest.trials
    other = as_other(trial.changes[0], "differs")
    changed = replace(
        study, changes=(*study.changes, as_other(study.chosen[0], "differs")),
        smallest=replace(study.smallest, trials=(replace(trial, others=(other,)),)),
    )
    words = paragraph(changed)
    assert "Without normal damping other quantities differ by more than 30 %: stress_strain +14.2 +- 0.5 %" in words
    assert "What else changes: other quantities differ by more than 30 %: stress_strain +14.2 +- 0.5 %" in words
    assert [r["quantity"] for r in visible_trials(changed)] == ["exit", "stress_strain"]

    unsure = replace(
        study, changes=tuple(replace(c, verdict="inconclusive", relative=-0.562, error=0.097, needed=3)
                             for c in study.changes if c.variant == "without sliding friction"),
    )
    words = paragraph(unsure)
    assert "No effect that can be switched off is shown to change a chosen quantity" in words
    assert "exit without sliding friction (-56.2 +- 9.7 %; about 3 packings would tell)" in words


def test_times_that_scatter_save_nothing(study):
    hidden = StepCost(seconds=(1e-5,) * 3, ratios=(0.93, 0.961, 1.01))
    found = replace(study, costs=study.costs | {("kernel:talk", REDUCED): hidden})
    assert saved(found) == {"kernel:talk": 0.0}
    assert "nothing that stands out of the scatter on kernel:talk" in paragraph(found)


def test_tables_hold_every_line_and_the_page_the_first_ones(study):
    lines = tuple(f"fix {k} all " + 40 * "word " for k in range(9))
    long = replace(study, footprints=tuple(replace(f, added=lines, left=lines) for f in study.footprints))
    row = tables(long)["traces"][0]
    assert row["left while off"].split(BETWEEN) == list(lines)
    assert row["these lines"].split(BETWEEN) == list(lines)
    assert "..." not in csv_text(tables(long)["traces"])
    short = traces_in_short(long)[0]
    assert short.keys() == row.keys()
    assert short["left while off"].endswith("and 7 more")
    assert max(map(len, short["left while off"].split(BETWEEN))) <= 60


def test_the_answer_has_no_number_that_is_not_one(study):
    json.dumps(effects_answer(study).data, allow_nan=False, default=str)


def test_a_folder_in_the_way_is_refused_before_anything_is_run(tmp_path):
    (tmp_path / NAMES.page).mkdir()
    with pytest.raises(InputError, match="expected a file or nothing"):
        NAMES.check(tmp_path)


@pytest.mark.parametrize("words", [
    ["--tolerance", "0"], ["--quantity", "nothing"], ["--effect", "nothing"], ["--effects", "nothing"],
    ["--effects=nothing"], ["--by", "nothing"], ["--engines", "nothing"], ["--engine", "nothing"],
])
def test_the_command_line_refuses_in_one_line(words, tmp_path, capsys):
    assert main(["effects", str(FILE), "--out", str(tmp_path / "o"), *words]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert f"{words[0].partition('=')[0]}: " in said
    assert not (tmp_path / "o").exists()
