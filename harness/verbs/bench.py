"""What a step of the kernel costs beside the codes."""

from __future__ import annotations

import sys
from pathlib import Path

from harness.arguments import as_folder, as_seconds
from harness.verbs.common import add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "bench", _bench, "speed of the kernel against the codes, on the same packings")
    verb.add_argument("--quick", action="store_true", help="fewer cases and rounds, up to 20000 particles")
    verb.add_argument("--time-limit", type=as_seconds, metavar="S", help="begin no cell later; default: 3600, 600")
    verb.add_argument("--out", type=as_folder, default=Path("out/bench"), metavar="DIR", help="default: out/bench")


def _bench(options) -> int:
    from harness.report.bench import bench_answer, summary, write_bench
    from harness.runs.progress import progress_for
    from harness.studies.bench import announced, bench

    print(announced(quick=options.quick, time_limit=options.time_limit), file=sys.stderr)
    done = bench(quick=options.quick, out=options.out, progress=progress_for, time_limit=options.time_limit)
    page = write_bench(done, options.out)
    show(bench_answer(done), options)
    if options.json != "-":
        print(f"{summary(done)}\nreport: {page}")
    return done.exit_status
