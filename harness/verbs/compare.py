"""All engines from the same packings: verdicts and a report."""

from __future__ import annotations

import sys
from pathlib import Path

from harness.arguments import as_count
from harness.verbs.common import add_names, add_run_options, add_verb, add_watch, chosen_executor, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "compare", _compare, "all engines, same packings, verdicts and report")
    verb.add_argument("file", type=Path, metavar="FILE")
    add_names(
        verb, "engine", "default: lammps,liggghts,kernel; lammps@ENV/bin/python, liggghts@PATH, with :ranks=N behind"
    )
    counts = verb.add_mutually_exclusive_group()
    counts.add_argument("--packings", type=as_count, metavar="N", help="random packings; default: as the scene says")
    counts.add_argument(
        "--replicates", type=as_count, nargs="?", const=0, metavar="N",
        help="packings with a kick in every run, for verdicts with error bars; without N as the scene says",
    )
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    add_watch(verb)
    add_run_options(verb)


def _compare(options) -> int:
    from harness.engines.registry import USUAL, choose_engines
    from harness.report.compare import check_report_places, compare_answer, own_cost, summary, write_report
    from harness.runs.progress import progress_for
    from harness.studies.compare import compare

    engines = choose_engines(options.engines or list(USUAL), ranks=options.ranks)
    check_report_places(options.out)
    _announce(options, engines)
    with chosen_executor(options) as executor:
        comparison = compare(
            options.file, engines, options.out, packings=options.packings, time_limit=options.time_limit,
            workers=options.workers, progress=progress_for, executor=executor, replicates=options.replicates,
            watched=options.watch,
        )
    written = write_report(comparison, options.out)
    show(compare_answer(comparison, written.content), options)
    if options.json != "-":
        print(f"{summary(comparison)}\n{own_cost(comparison)}report: {written.page}")
    return comparison.exit_status


def _announce(options, engines) -> None:
    """Say on standard error how long a comparison is expected to take, before anything is made."""
    from harness.report.expected import expected_comparison, likely_system
    from harness.scene.explain import time_row
    from harness.scene.load import load_scene
    from harness.studies.compare.replicates import replicate_count
    from harness.studies.prepare import start_count

    scene = load_scene(options.file)
    starts = replicate_count(scene, options.replicates) or start_count(scene, options.packings)
    expected = expected_comparison(
        scene, likely_system(scene, options.file), engines, starts=starts, workers=options.workers
    )
    row = time_row("compare", expected.seconds, expected.says)
    print(f"expected: about {row.text} for {row.note}", file=sys.stderr, flush=True)
