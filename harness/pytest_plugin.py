"""A pytest plugin: the verdicts of a comparison as something that a test of somebody else can assert.

::

    def test_codes_agree_in_a_collision(grainproof_compare):
        verdicts = grainproof_compare("oblique.toml", engines="lammps,kernel")
        verdicts.require()

A suite that uses none of the fixtures pays for the import of this module and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from harness.report.difference import Difference
    from harness.studies.verdict import Check


@dataclass(frozen=True, kw_only=True)
class Verdicts:
    """What a comparison found.

    summary: one line. faults: a paragraph for each check that differs and each run that did not complete, with the
    command that repeats it. exit_status: what `grainproof compare` would exit with. page: the report, in `out`.
    """

    checks: tuple[Check, ...]
    summary: str
    faults: tuple[str, ...]
    exit_status: int
    page: Path
    out: Path

    def of(self, *, quantity: str = "", left: str = "", right: str = "", level: str = "") -> tuple[Check, ...]:
        """Return the checks whose quantity begins with `quantity`, of these engines, at this level.

        What is not given is not asked for. Raises LookupError if there is none: a loop over nothing would pass.
        """
        wanted = {"left": left, "right": right, "level": level}
        found = tuple(
            c for c in self.checks
            if c.quantity.startswith(quantity) and all(getattr(c, k) == v for k, v in wanted.items() if v)
        )
        if not found:
            asked = ", ".join(f"{k} {v!r}" for k, v in {"quantity": quantity, **wanted}.items() if v)
            raise LookupError(f"no check of {asked or 'anything'}; checks: {[_name(c) for c in self.checks]}")
        return found

    def require(self) -> None:
        """Fail the test if a check differs, a run did not complete (its code is missing, say), or nothing was compared.

        What is inconclusive passes: ask for it by `of`.
        """
        __tracebackhide__ = True
        if self.exit_status or self.faults:
            nothing = () if self.faults else ("nothing was compared with anything but its own scene",)
            lines = (*self.faults, *nothing, self.summary, f"report: {self.page}")
            pytest.fail("\n".join(lines), pytrace=False)

    def against(self, old: str | Path) -> Difference:
        """Return what changed since an older report (its folder); `worse` holds what got worse.

        It is also written as difference.html beside the report. Fails the test if there is no such report, or it has
        no check in common with this one.
        """
        from harness.report.against import compare_reports

        __tracebackhide__ = True
        return _or_fail(lambda: compare_reports(self.out, Path(old)))


@pytest.fixture(scope="session")
def grainproof_compare(tmp_path_factory) -> Callable[..., Verdicts]:
    """grainproof_compare(scene file, engines=..., out=...) runs a comparison and returns its `Verdicts`.

    engines: names as on the command line, "lammps,kernel" or a list; default: lammps, liggghts, kernel. packings,
    replicates, workers, time_limit (s a run): as on the command line. out: where runs and report go and finished runs
    are found again; default: a temporary folder. Input that is wrong fails the test with the line that says so.
    """

    def run(scene: str | Path, *, out: str | Path | None = None, **settings) -> Verdicts:
        __tracebackhide__ = True
        place = tmp_path_factory.mktemp("grainproof") if out is None else Path(out)
        return _or_fail(lambda: _compared(Path(scene), place, **settings))

    return run


@pytest.fixture(scope="session")
def grainproof_needs() -> Callable[..., None]:
    """grainproof_needs("lammps", "liggghts") skips the test where one of these is not installed, and says how to."""

    def need(*engines: str) -> None:
        from harness.engines.registry import find_engine

        __tracebackhide__ = True
        for name in engines:
            probe = _or_fail(lambda name=name: find_engine(name)).probe()
            if not probe.available:
                pytest.skip(f"{name}: {probe.detail}")

    return need


def _compared(
    scene: Path, out: Path, *, engines: str | Sequence[str] = (), packings: int | None = None,
    replicates: int | None = None, workers: int | None = None, time_limit: float = 3600.0,
) -> Verdicts:
    from harness.engines.registry import USUAL, choose_engines
    from harness.report.compare import check_report_places, summary, write_report
    from harness.report.failures import entries
    from harness.studies.compare import compare

    words = [w for w in engines.split(",") if w] if isinstance(engines, str) else list(engines)
    check_report_places(out)
    done = compare(
        scene, choose_engines(words or list(USUAL)), out, packings=packings, replicates=replicates, workers=workers,
        time_limit=time_limit,
    )
    faults = tuple(
        f"{e.word}: {e.title}: {e.why}" + (f"\n  rerun: {e.command}" if e.command else "")
        for e in entries(done.checks, done.runs)
    )
    return Verdicts(
        checks=done.checks, summary=summary(done), faults=faults, exit_status=done.exit_status,
        page=write_report(done, out).page, out=out,
    )


def _or_fail(action: Callable):
    """Return what `action` returns; wrong input fails the test in one line."""
    from harness.errors import InputError

    __tracebackhide__ = True
    try:
        return action()
    except InputError as error:
        line = str(error)
    return pytest.fail(line, pytrace=False)


def _name(check: Check) -> str:
    return f"{check.level}, {check.quantity}: {check.left} against {check.right}"
