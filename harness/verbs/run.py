"""One run of one scene on one engine."""

from __future__ import annotations

from pathlib import Path

from harness.verbs.common import add_run_options, add_verb, add_watch, chosen_executor, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "run", _run, "one run of one scene on one engine")
    verb.add_argument("file", type=Path, metavar="FILE")
    verb.add_argument(
        "--engine", "--engines", required=True, metavar="E",
        help="lammps, liggghts, kernel, kernel:lammps, ...; another version where it lives: lammps@ENV/bin/python",
    )
    add_watch(verb)
    add_run_options(verb)


def _run(options) -> int:
    from harness.engines.registry import find_engine
    from harness.report.run import run_answer, write_run_files
    from harness.runs.progress import progress_for
    from harness.studies.single import single_run

    engine = find_engine(options.engine, ranks=options.ranks)
    with chosen_executor(options) as executor:
        done = single_run(
            options.file, engine, options.out, time_limit=options.time_limit, progress=progress_for, executor=executor,
            watched=options.watch,
        )
    write_run_files(done)
    show(run_answer(done), options)
    if done.watch is not None and options.json != "-":
        for remark in done.watch.remarks:
            print(f"not to be trusted: {remark.what}: {remark.says}")
    return done.exit_status
