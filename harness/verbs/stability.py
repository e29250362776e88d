"""The gauntlet: hard cases, numerically stable or failing loudly."""

from __future__ import annotations

import sys
from pathlib import Path

from harness.arguments import as_count, as_folder, as_seconds
from harness.verbs.common import add_names, add_verb, show

OUT = Path("out/stability")


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "stability", _stability, "hard cases: whether each code is stable there, or says so")
    verb.add_argument("cases", nargs="*", metavar="CASE", help="cases or topics; default: the standard set")
    verb.add_argument("--list", action="store_true", help="name the cases and what they stand for, run nothing")
    verb.add_argument("--long", action="store_true", help="also the cases that take minutes")
    add_names(verb, "engine", "default: lammps,liggghts,kernel:talk")
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    verb.add_argument("--out", type=as_folder, default=OUT, metavar="DIR", help="default: %(default)s")
    verb.add_argument("--time-limit", type=as_seconds, default=1800.0, metavar="S", help="a run; default: %(default)g")


def _stability(options) -> int:
    from harness.report.stability import NAMES, stability_answer, summary, write_stability
    from harness.report.stability_expected import announcement
    from harness.runs.progress import progress_for
    from harness.studies.stability import stability

    if options.list:
        return _list(options)
    NAMES.check(options.out)
    asked = {"engines": options.engines, "long": options.long, "workers": options.workers}
    print(announcement(options.cases, **asked), file=sys.stderr, flush=True)
    done = stability(options.cases, options.out, **asked, time_limit=options.time_limit, progress=progress_for)
    page = write_stability(done, options.out)
    show(stability_answer(done), options)
    if options.json != "-":
        for r in (*(r for r in done.results if r.ended == "failed_silently"), *done.surprises):
            print(f"{r.case} on {r.engine}: {r.ended.replace('_', ' ')}: {r.reason}; rerun: {r.reproduce}")
        print(f"{summary(done)}\nreport: {page}")
    return done.exit_status


def _list(options) -> int:
    from harness.report.stability import case_list
    from harness.studies.stability.cases import all_cases, choose_cases

    return show(case_list(choose_cases(all_cases(), options.cases, long=True)), options)
