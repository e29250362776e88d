"""JUnit XML: what CI systems read of verdicts and runs, within the schemas that they share."""

import re
from xml.etree import ElementTree

import pytest

from harness.report.compare import write_report
from harness.report.junit import junit_xml

SUITE = {"name", "package", "id", "tests", "failures", "errors", "skipped", "time", "timestamp", "hostname"}
RESULTS = {"failure": {"type", "message"}, "error": {"type", "message"}, "skipped": {"message"}}


def assert_valid(text: str) -> ElementTree.Element:
    """Follow what the schemas of Ant and Jenkins both allow: elements, order, attributes, kinds of values, sums."""
    root = ElementTree.fromstring(text)
    (suite,) = root
    assert (root.tag, root.attrib, suite.tag, set(suite.attrib)) == ("testsuites", {}, "testsuite", SUITE)
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", suite.get("timestamp"))
    tags = [e.tag for e in suite]
    cases = suite.findall("testcase")
    assert tags == ["properties", *["testcase"] * len(cases), "system-out", "system-err"]
    assert all(set(p.attrib) == {"name", "value"} for p in suite.find("properties"))
    for case in cases:
        assert set(case.attrib) == {"name", "classname", "time"}
        assert re.fullmatch(r"\d+\.\d+", case.get("time"))
        assert len(case) <= 1
        assert all(set(r.attrib) == RESULTS[r.tag] and not len(r) for r in case)
    names = [v for e in (suite, *cases) for k, v in e.items() if k in ("name", "classname", "hostname")]
    assert all(n and n == " ".join(n.split()) for n in names)
    assert len({(c.get("classname"), c.get("name")) for c in cases}) == len(cases) == int(suite.get("tests"))
    for kind, sum_ in (("failure", "failures"), ("error", "errors"), ("skipped", "skipped")):
        assert int(suite.get(sum_)) == len(suite.findall(f"testcase/{kind}"))
    return suite


def case(suite, name: str) -> ElementTree.Element:
    (found,) = (c for c in suite.findall("testcase") if c.get("name") == name)
    return found


@pytest.fixture
def suite(ran):
    """suite(checks, runs) is the test suite of such a comparison, found valid."""

    def make(checks, runs=None):
        text = junit_xml(name="box", summary="so and so", checks=checks, runs=runs or [ran("a"), ran("b")])
        return assert_valid(text)

    return make


def test_every_verdict_is_a_test_case(check, suite):
    made = suite([
        check(quantity="good"), check("differs", quantity="bad"), check("inconclusive", quantity="open", why="chaos"),
        check("not_checked", quantity="none", why="no run of a", deviation=None),
        check("known_difference", quantity="known", why="as documented"),
    ])
    assert len(case(made, "good: a against b")) == 0
    (failure,) = case(made, "bad: a against b")
    assert (failure.tag, failure.get("type"), failure.get("message")) == ("failure", "differs", "largest of 3 samples")
    assert failure.text.splitlines() == [
        "largest of 3 samples", "deviation 0.001, tolerance 0.01", "rerun: grainproof compare s.toml"]
    skipped = {n: case(made, f"{n}: a against b")[0] for n in ("open", "none", "known")}
    assert {n: (e.tag, e.get("message")) for n, e in skipped.items()} == {
        "open": ("skipped", "inconclusive: chaos"), "none": ("skipped", "not_checked: no run of a"),
        "known": ("skipped", "known_difference: as documented"),
    }
    assert case(made, "bad: a against b").get("classname") == "grainproof.box.L2"


def test_runs_are_cases_with_their_time_and_failed_ones_errors(check, suite, ran):
    made = suite([check()], [
        ran("a", wall_seconds=1.25), ran("b", 1, status="crashed", reproduce="cd x && y", last_lines=("ouch",)),
        ran("c", status="unavailable", reason="pip install c", wall_seconds=None),
    ])
    assert case(made, "a, packing 1").get("time") == "1.250"
    (error,) = case(made, "b, packing 2")
    assert (error.tag, error.get("type")) == ("error", "crashed")
    assert error.text.splitlines()[-2:] == ["ouch", "rerun: cd x && y"]
    (skipped,) = case(made, "c, packing 1")
    assert (skipped.tag, skipped.get("message")) == ("skipped", "unavailable: pip install c")


@pytest.mark.parametrize("checks", [[], [("not_checked", "L2")], [("agrees", "run")]])
def test_a_report_that_compared_nothing_fails(check, suite, checks):
    made = suite([check(verdict, level=level) for verdict, level in checks])
    (failure,) = case(made, "something was compared")
    assert failure.tag == "failure"
    assert len(case(suite([check()]), "something was compared")) == 0


def test_equal_names_are_told_apart_and_characters_that_xml_lacks_are_escaped(check, suite, ran):
    bad = "a\x00b\x1b[31m \ud800 <&>\"' \n ü"
    made = suite([check(quantity=bad), check(quantity=bad), check("differs", why=bad)], [ran(bad)])
    names = [c.get("name") for c in made.findall("testcase")]
    assert names[1] == f"{names[0]} (2)"
    assert "a\\x00b\\x1b[31m \\ud800 <&>\"' ü" in names[0]


def test_the_file_lies_beside_the_report(free, tmp_path):
    comparison = free(does="abort")
    write_report(comparison, tmp_path / "report")
    made = assert_valid((tmp_path / "report" / "junit.xml").read_text())
    assert made.get("name") == "flight"
    assert int(made.get("errors")) == 1
    assert int(made.get("tests")) == len(comparison.checks) + len(comparison.runs) + 1
