"""JUnit XML: one test case a check and one a run, so that a CI system shows verdicts as it shows tests.

differs is a failure with the command that reruns it; a run that failed is an error; inconclusive, not_checked,
known_difference, and engines that are missing or cannot compute the scene, are skipped with the reason: no test
passes by saying nothing. The elements and attributes are those that the schemas of Apache Ant's and of Jenkins'
reports share.
"""

from __future__ import annotations

import platform
import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from harness.report.failures import BROKEN, ReportedRun, check_title, reason_and_command, run_reason, run_title
from harness.studies.verdict import Check, failed

if TYPE_CHECKING:
    from datetime import datetime

CHARACTERS = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 cannot hold, written or escaped."""


def junit_xml(*, name: str, summary: str, checks: Sequence[Check], runs: Sequence[ReportedRun]) -> str:
    """Return the report of a comparison as JUnit XML. name: of the scene; summary: one line that goes with it."""
    cases = [*_check_cases(name, checks), _anything(name, checks), *(_run_case(name, r) for r in runs)]
    spent = sum(float(c.get("time")) for c in cases)
    suite = Element("testsuite", {
        "name": _token(name), "package": "grainproof", "id": "0", "tests": str(len(cases)),
        "failures": _count(cases, "failure"), "errors": _count(cases, "error"), "skipped": _count(cases, "skipped"),
        "time": f"{spent:.3f}", "timestamp": _begin(runs), "hostname": _token(platform.node() or "localhost"),
    })
    properties = SubElement(suite, "properties")
    for engine, version in dict.fromkeys((r.engine, r.outcome.engine_version) for r in runs):
        SubElement(properties, "property", name=_token(f"version of {engine}"), value=_legal(version))
    suite.extend(_distinct(cases))
    SubElement(suite, "system-out").text = _legal(summary)
    SubElement(suite, "system-err").text = ""
    root = Element("testsuites")
    root.append(suite)
    indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode") + "\n"


def _check_cases(name: str, checks: Iterable[Check]) -> list[Element]:
    return [_check_case(name, c) for c in checks]


def _check_case(name: str, check: Check) -> Element:
    """A verdict costs nothing by itself: what costs time is the runs."""
    case = _case(f"grainproof.{name}.{check.level}", check_title(check))
    why, command = reason_and_command(check)
    if check.verdict == "differs":
        sizes = f"deviation {check.deviation}, tolerance {check.tolerance}"
        _outcome(case, "failure", "differs", why, f"{why}\n{sizes}\nrerun: {command}" if command else f"{why}\n{sizes}")
    elif check.verdict != "agrees":
        _outcome(case, "skipped", check.verdict, f"{check.verdict}: {why}")
    return case


def _anything(name: str, checks: Sequence[Check]) -> Element:
    """That something was compared at all is a case of its own: else a report without checks would pass."""
    case = _case(f"grainproof.{name}", "something was compared")
    if failed(checks) and not any(c.verdict == "differs" for c in checks):
        _outcome(case, "failure", "not_checked", "nothing was compared with anything but its own scene")
    return case


def _run_case(name: str, run: ReportedRun) -> Element:
    outcome = run.outcome
    case = _case(f"grainproof.{name}.runs", run_title(run), outcome.wall_seconds or 0.0)
    reason = run_reason(outcome)
    if outcome.status in BROKEN:
        again = f"\nrerun: {outcome.reproduce}" if outcome.reproduce else ""
        _outcome(case, "error", outcome.status, reason, "\n".join((reason, *outcome.last_lines)) + again)
    elif outcome.status != "completed":
        _outcome(case, "skipped", outcome.status, f"{outcome.status}: {reason}")
    return case


def _case(classname: str, name: str, seconds: float = 0.0) -> Element:
    return Element("testcase", {"classname": _token(classname), "name": _token(name), "time": f"{seconds:.3f}"})


def _outcome(case: Element, kind: str, word: str, message: str, body: str = "") -> None:
    """Add what became of a case. word: the type that CI systems group by; the schema knows none of what is skipped."""
    about = {} if kind == "skipped" else {"type": word}
    SubElement(case, kind, message=_legal(message), **about).text = _legal(body)


def _distinct(cases: Iterable[Element]) -> list[Element]:
    """Number cases of one name, which CI systems would take for one."""
    seen: dict[tuple[str, str], int] = {}
    found = []
    for case in cases:
        key = (case.get("classname"), case.get("name"))
        seen[key] = seen.get(key, 0) + 1
        if seen[key] > 1:
            case.set("name", f"{key[1]} ({seen[key]})")
        found.append(case)
    return found


def _count(cases: Iterable[Element], kind: str) -> str:
    return str(sum(c.find(kind) is not None for c in cases))


def _begin(runs: Sequence[ReportedRun]) -> str:
    """Return when the first run began, in UTC and without a zone, as the schema has it."""
    begun: datetime = min(r.outcome.started for r in runs)
    return begun.strftime("%Y-%m-%dT%H:%M:%S")


def _token(text: str) -> str:
    """Return a name as XML tokens are: without line ends and doubled blanks."""
    return " ".join(_legal(text).split()) or "-"


def _legal(text: str) -> str:
    """Escape characters that XML cannot hold."""
    return CHARACTERS.sub(lambda c: c[0].encode("unicode_escape").decode("ascii"), text)
