"""Two reports beside each other: what got worse, what only changed, what nobody can compare."""

from itertools import product

import msgspec
import pytest

from harness.errors import InputError
from harness.report.difference import difference, renamed
from harness.report.matrix import SEVERITY


@pytest.fixture
def compared(finished_report):
    """compared(old checks, new checks, old={...}, new={...}) is their difference."""

    def make(before, after, *, old=None, new=None):
        return difference(finished_report(before, name="old", **(old or {})), finished_report(after, **(new or {})))

    return make


def test_nothing_changed_is_nothing_to_show(compared, check):
    found = compared([check()], [check()])
    assert not any((found.verdicts, found.deviations, found.runs, found.numbers, found.settings, found.worse))
    assert (found.same, found.exit_status) == (1, 0)


@pytest.mark.parametrize(("old", "new"), list(product(SEVERITY, SEVERITY)))
def test_a_verdict_that_got_worse_is_exit_status_1(compared, check, old, new):
    found = compared([check(old)], [check(new)])
    worse = SEVERITY[new] > SEVERITY[old]
    assert found.exit_status == int(worse)
    assert [r["change"] for r in found.verdicts] == (
        [] if old == new else ["worse"] if worse else ["no longer checked"] if new == "not_checked" else ["better"])


def test_checks_that_appear_or_vanish_are_shown_and_one_that_appears_and_differs_is_worse(compared, check):
    usual = check(quantity="usual")
    found = compared(
        [usual, check(quantity="gone")], [usual, check(quantity="come"), check("differs", quantity="bad")])
    assert {r["quantity"]: (r["change"], r["old"], r["new"]) for r in found.verdicts} == {
        "gone": ("vanished", "agrees", None), "come": ("appeared", None, "agrees"), "bad": ("worse", None, "differs")}
    assert found.exit_status == 1


@pytest.mark.parametrize(("old", "new", "moved"), [
    (1.5e-14, 2.5e-14, False), (1e-3, 1e-3 * (1 + 1e-12), False), (1e-3, 1.1e-3, True), (1e-12, 1e-11, True),
    (None, None, False), (None, 1e-3, True), (1e-3, None, True), (0.0, 1e-3, True),
])
def test_deviations_that_changed_by_more_than_rounding_are_shown(compared, check, old, new, moved):
    found = compared([check(deviation=old)], [check(deviation=new)])
    assert [(r["old"], r["new"]) for r in found.deviations] == ([(old, new)] if moved else [])
    if moved and old and new:
        assert found.deviations[0]["new over old"] == pytest.approx(new / old)


def test_equal_checks_are_compared_in_their_order(compared, check):
    found = compared([check(), check("differs")], [check("differs"), check("differs")])
    assert [r["change"] for r in found.verdicts] == ["worse"]


def test_reports_without_a_common_check_are_refused(compared, check):
    with pytest.raises(InputError, match="^--against .*old/report.json: expected .* got none; compare reports"):
        compared([check(quantity="x")], [check(quantity="y")])


@pytest.mark.parametrize(("old", "new", "names"), [
    (["lammps", "k"], ["lammps", "k"], {}),
    (["lammps@1"], ["lammps"], {"lammps@1": "lammps"}),
    (["lammps@1", "lammps"], ["lammps@2", "lammps"], {"lammps@1": "lammps@2"}),
    (["lammps@1", "lammps@2"], ["lammps"], {}),
    (["lammps"], ["lammps@1", "lammps@2"], {}),
    (["lammps", "liggghts"], ["lammps:ranks=2"], {"lammps": "lammps:ranks=2"}),
    (["kernel:lammps"], ["kernel:talk"], {}),
])
def test_a_version_under_another_name_is_the_same_code(old, new, names):
    assert renamed(old, new) == names


def test_a_new_version_is_judged_under_its_name(compared, check, ran):
    found = compared(
        [check(left="lammps@1")], [check("differs", left="lammps")],
        old={"runs": [ran("lammps@1", engine_version="1")]}, new={"runs": [ran("lammps", engine_version="2")]},
    )
    (row,) = found.verdicts
    assert (row["change"], row["left"]) == ("worse", "lammps")
    assert found.versions[0] == {"what": "lammps", "old": "1 (lammps@1)", "new": "2", "same": "no"}
    assert {r["same"] for r in found.versions[1:]} == {"yes"}
    assert found.runs == []


@pytest.mark.parametrize(("old", "new", "change"), [
    ("completed", "crashed", "worse"), ("completed", "unavailable", "worse"), ("timed_out", "completed", "better"),
    ("crashed", "timed_out", "changed"), (None, "completed", "appeared"), ("completed", None, "vanished"),
])
def test_runs_that_changed(compared, check, ran, old, new, change):
    before, after = ([ran("a"), *([ran("b", 1, status=s)] if s else [])] for s in (old, new))
    found = compared([check()], [check()], old={"runs": before}, new={"runs": after})
    ((row),) = found.runs
    assert (row["change"], row["engine"], row["packing"], row["old"], row["new"]) == (change, "b", 2, old, new)
    assert found.exit_status == int(change == "worse")


def test_cost_is_compared_by_medians_of_completed_runs(compared, check, ran):
    old = [ran("a", k, cpu_seconds=c, steps=1000) for k, c in enumerate((1.0, 2.0, 9.0))]
    new = [ran("a", cpu_seconds=3.0, steps=1000), ran("a", 1, status="crashed", cpu_seconds=9.0), ran("c")]
    (row,) = compared([check()], [check()], old={"runs": old}, new={"runs": new}).costs
    assert (row["engine"], row["new over old"], row["runs, old"], row["runs, new"]) == ("a", pytest.approx(1.5), 3, 1)


def test_other_scenes_and_other_particles_are_said(compared, check, ran):
    digest = "f" * 64
    a = ran("a")
    other = msgspec.structs.replace(a.outcome, particles_digest=digest)
    found = compared(
        [check()], [check()], old={"scene": {"title": "T", "top": {"strain": 0.1}, "compare": {"windows": [{"s": 1}]}}},
        new={"scene": {"title": "T", "top": {"strain": 0.2}, "compare": {"windows": [{"s": 1}, {"s": 2}]}},
             "runs": [type(a)(engine="a", packing=0, outcome=other)]},
    )
    assert {r["setting"]: (r["old"], r["new"]) for r in found.settings} == {
        "top.strain": ("0.1", "0.2"), "compare.windows[1].s": (None, "2"),
        "particles of packing 1": (a.outcome.particles_digest[:12], digest[:12]),
    }
