"""One frontier measured on the kernel, verdicts, the report and the table that scenes are warned with."""

import json
import math
import re
import tomllib
from dataclasses import replace

import pytest

from harness.cli import main
from harness.engines.registry import find_engine
from harness.errors import InputError
from harness.report.frontier import frontier_answer, write_frontier, write_scene_table
from harness.report.frontier_expected import announcement, likely
from harness.report.frontier_tables import summary
from harness.runs.outcome import host_facts
from harness.runs.pool import run_many
from harness.runs.progress import Silent
from harness.studies.frontier import frontiers, laws, packings
from harness.studies.frontier import search as search_module
from harness.studies.frontier.keep import Kept
from harness.studies.frontier.packings import resting_system
from harness.studies.frontier.plan import EVERY, frontier_cases, late_packings, planned, wanted_of
from harness.studies.frontier.probe import Look, disturbed, growth, look
from harness.studies.frontier.search import Search, Wanted, search_all
from harness.studies.frontier.study import Frontiers, measured_frontier
from harness.studies.frontier.summary import scene_rows
from harness.studies.frontier.theory import theory_of
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory


@pytest.fixture(scope="session")
def measured(tmp_path_factory):
    """The triangular lattice with dashpots, on the kernel."""
    folder = tmp_path_factory.mktemp("frontier")
    rest = resting_system(packings.TRIANGULAR, packings.TRIANGULAR.make(folder), laws.DASHPOT)
    return measured_frontier(
        find_engine("kernel:talk"), rest, folder / "runs", law=laws.DASHPOT.name, packing=packings.TRIANGULAR.name
    )


def test_measured_limit_is_the_exact_one(measured):
    assert measured.verdict == "agrees"
    assert abs(measured.deviation) < 0.01
    assert measured.stable < measured.exact < measured.unstable


def test_verdicts(measured):
    assert replace(measured, exact=1.06 * measured.measured).verdict == "differs"
    assert replace(measured, exact=None).verdict == "not_checked"
    assert replace(measured, linear=False).verdict == "not_checked"
    never = replace(measured, stable=None, exact=0.0)
    assert (never.measured, never.verdict) == (0.0, "agrees")
    assert replace(never, exact=1e-5).verdict == "differs"
    assert replace(measured, exact=0.0).verdict == "differs"


def whole(*found):
    return Frontiers(
        size="quick", found=found, skipped=(("lammps", "jkr", "random", "no"),), versions={"kernel:talk": "1"},
        host=host_facts(), wall_seconds=1.0,
    )


def test_exit_status(measured):
    assert whole(measured).exit_status == 0
    assert whole(measured, replace(measured, stable=None, unstable=None)).exit_status == 1
    assert whole(replace(measured, exact=None)).exit_status == 1
    assert whole(measured, replace(measured, exact=2 * measured.exact)).exit_status == 1


def test_report(measured, tmp_path):
    along = [replace(measured, axis="k_t/k_n", value=v) for v in (0.1, 1.0)]
    done = whole(measured, *along)
    page = write_frontier(done, tmp_path)
    assert "triangular lattice" in page.read_text()
    assert json.loads((tmp_path / "frontier.json").read_text())["words"] == summary(done)
    assert len((tmp_path / "frontier_map.csv").read_text().splitlines()) == 3
    assert frontier_answer(done).tables["Map"][0]["varied"] == "k_t/k_n"


def test_table_of_scenes_takes_the_worst_of_a_kind(measured, tmp_path):
    worse = replace(measured, stable=0.9 * measured.stable, unstable=0.9 * measured.unstable, packing="worse")
    done = whole(measured, worse)
    (row,) = scene_rows(done)
    assert (row["count"], row["normal"], row["sliding"]) == (2, "linear", "")
    assert row["of_formula"] == pytest.approx(worse.measured / worse.formula)
    assert "worse" in row["where"]
    write_scene_table(done, tmp_path / "t.toml", day="2026-01-02")
    table = tomllib.loads((tmp_path / "t.toml").read_text())
    assert table["date"] == "2026-01-02"
    assert table["measured"][0]["of_formula"] == pytest.approx(row["of_formula"], rel=1e-3)
    assert "--table" in table["command"]


def test_growth_of_the_kinetic_energy():
    def frame(speed, spin):
        columns = {"vx": [speed], "vy": [0.0], "wz": [spin], "mass": [2.0], "inertia": [8.0]}
        return Snapshot(time=0.0, dimension=2, particles=Columns(columns, "particles"), walls=None, contacts=None)

    def of(*frames):
        return growth(Trajectory(frames=frames, steps=tuple(range(len(frames))), series=None))

    assert of(frame(1.0, 0.0), frame(3.0, 0.0), frame(2.0, 0.0)) == 9.0
    assert of(frame(1.0, 0.0), frame(0.0, 1.0)) == 4.0
    assert of(frame(1.0, 0.0), frame(math.nan, 0.0)) == math.inf


# --- what is kept, said and refused --------------------------------------------------------------------


@pytest.fixture(scope="module")
def wanted(tmp_path_factory):
    rest = resting_system(packings.TRIANGULAR, packings.TRIANGULAR.make(tmp_path_factory.mktemp("p")), laws.ELASTIC)
    engine = find_engine("kernel:talk")
    return Wanted(label="kernel: springs", engine=engine, rest=rest, guess=theory_of(rest, engine.name).guess)


@pytest.fixture(scope="module")
def place(wanted, tmp_path_factory):
    """A folder with one finished frontier, numbers that ran away among its looks."""
    root = tmp_path_factory.mktemp("kept")
    search = Search(guess=wanted.guess)
    while not search.done:
        dt = search.next_step()
        search.tell(Look(dt=dt, seen="stable", energy=1.5) if dt < wanted.guess else Look(
            dt=dt, seen="unstable", energy=math.inf, reason="unstable: step 7"
        ))
    Kept(folder=root / "frontiers").put(wanted, search)
    return root, search


def test_a_finished_frontier_is_taken_from_its_file(wanted, place, monkeypatch):
    root, search = place
    monkeypatch.setattr(search_module, "_look_once", lambda *_, **__: pytest.fail("it was searched again"))
    told = []
    (again,) = search_all(
        [wanted], root / "nowhere", time_limit=60, kept=Kept(folder=root / "frontiers"),
        tell=lambda number, s: told.append((number, s.done)),
    )
    assert again == search
    assert told == [(0, True)]


@pytest.mark.parametrize("damage", [
    lambda text: text[: len(text) // 2], lambda text: text.replace('"stable"', '"unstable"', 1), lambda _: "[]",
])
def test_a_damaged_file_is_not_believed_and_a_line_says_so(damage, wanted, place, caplog):
    root, search = place
    kept = Kept(folder=root / "damaged")
    kept.put(wanted, search)
    assert kept.looks(wanted, search.precision) == search.looks
    file = kept.place(wanted, search.precision)
    file.write_text(damage(file.read_text()))
    assert kept.looks(wanted, search.precision) == []
    assert "it is not what was written; kernel: springs is made again" in caplog.text


def test_names_follow_from_what_decides(wanted, place):
    kept = Kept(folder=place[0])
    names = {kept.place(w, p) for w, p in (
        (wanted, 0.01), (wanted, 0.02), (replace(wanted, guess=2 * wanted.guess), 0.01),
        (replace(wanted, steps=100), 0.01), (replace(wanted, steps_at=lambda dt: 100), 0.01),
        (replace(wanted, engine=find_engine("kernel:lammps")), 0.01),
        (replace(wanted, rest=wanted.rest.with_(gravity=(0.0, -1.0))), 0.01),
    )}
    assert len(names) == 7
    assert kept.place(replace(wanted, label="another"), 0.01) in names


def test_a_search_that_says_nothing_is_not_kept(wanted, tmp_path):
    failed = Search(guess=1.0, looks=[Look(dt=1.0, seen="failed", energy=math.inf, reason="timed out")])
    kept = Kept(folder=tmp_path / "none")
    kept.put(wanted, failed)
    assert not kept.folder.exists()


def test_an_interrupt_keeps_what_was_found(wanted, tmp_path, monkeypatch):
    """The second search meets Ctrl-C; the first one is not made again."""
    other = replace(wanted, label="other", guess=1.1 * wanted.guess)
    kept, made = Kept(folder=tmp_path), []

    def looked(wishes, searches, chosen, *_, **__):
        for k in chosen:
            made.append(wishes[k].label)
            dt = searches[k].next_step()
            limit = wanted.guess
            searches[k].tell(Look(dt=dt, seen="stable" if dt < limit else "unstable", energy=1.0))
        if len(made) > 7:
            raise KeyboardInterrupt

    monkeypatch.setattr(search_module, "_look_once", looked)
    monkeypatch.setattr(search_module, "SIDE_BY_SIDE", 1)
    with pytest.raises(KeyboardInterrupt):
        search_all([wanted, other], tmp_path, time_limit=1, workers=1, kept=kept)
    assert len(kept.looks(wanted, search_module.PRECISION)) == made.count(wanted.label)
    assert kept.looks(other, search_module.PRECISION) == []


def test_the_expected_time_is_said_before_anything_is_made(monkeypatch):
    monkeypatch.setattr("harness.packing.make.make_packing", lambda *_, **__: pytest.fail("a packing was made"))
    quick, full = (announcement(full=full, engines=["kernel:talk"], workers=1) for full in (False, True))
    assert re.match(r"expected: about [\d.]+ (s|min) for \d+ frontiers of about 5 runs each, on idle cores, \d+ s "
                    r"of it for packings and exact limits; ", quick)
    assert re.search(r"about [\d.]+ min for (\d+) frontiers", full)


def test_the_expected_number_is_that_of_the_plan(tmp_path, monkeypatch):
    """On the square lattice, which buckles without friction: what is left out is not counted."""
    buckling = (laws.ELASTIC, laws.DASHPOT, laws.VISCOUS, laws.HERTZ, laws.HYSTERETIC)
    names = {law.name for law in (*buckling, laws.FULL)}
    cases = [c for c in frontier_cases(full=True) if c.packing is packings.SQUARE and c.law.name in names]
    engine = find_engine("kernel:talk")
    plan, skipped = planned(cases, [engine], tmp_path, late_packings(full=True), Silent())
    monkeypatch.setattr("harness.report.frontier_expected.frontier_cases", lambda *, full: cases)
    assert " 1 frontiers " in announcement(full=True, engines=[engine.name], workers=1)
    assert [p.case.law for p in plan] == [laws.FULL]
    assert {(name, law) for name, law, _, _ in skipped} == {(EVERY, law.name) for law in buckling}
    assert all("buckles" in why for *_, why in skipped)


def test_codes_that_take_few_kinds_of_discs_are_told_from_the_stand_in():
    """LIGGGHTS has a table of dashpots over kinds; the real packing has a hundred."""
    case = next(
        c for c in frontier_cases(full=True)
        if (c.law.name, c.packing.name) == (laws.ROLLING_DASHPOT.name, packings.RANDOM.name)
    )
    rest = resting_system(case.packing, likely(case.packing), case.law)
    if find_engine("liggghts").probe().available:
        assert wanted_of(case, rest, [find_engine("liggghts")], [])[0] == []


def test_a_burst_that_is_over_before_the_end_is_seen(tmp_path):
    """Beyond its limit an fcc lattice blows up, its contacts slide and open, and dashpots may bring it to rest again.

    That takes some hundred steps: frames are closer, unless the code itself breaks off.
    """
    rest = resting_system(packings.FCC, packings.FCC.make(tmp_path), laws.FULL)
    engine = find_engine("kernel:talk")
    dt = 1.2 * theory_of(rest, engine.name).exact
    system = disturbed(rest, dt)
    assert system.frame_every <= 20
    (done,) = run_many([("burst", engine, system)], tmp_path / "runs", time_limit=60, workers=1)
    assert look(done, dt).seen == "unstable"


@pytest.mark.parametrize("table", ["/proc/xx/t.toml", "/proc/t.toml", "/proc"])
def test_a_table_that_cannot_be_written_is_refused_before_anything_runs(table, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["frontier", "--out", str(out), "--table", table]) == 2
    said = capsys.readouterr().err
    assert said.startswith("grainproof: --table: expected a file")
    assert said.count("\n") == 1
    assert not out.exists()


def test_a_file_where_frontiers_are_kept_is_refused(tmp_path):
    (tmp_path / "frontiers").touch()
    with pytest.raises(InputError, match="expected a folder"):
        frontiers(tmp_path, engines=["kernel:talk"])
