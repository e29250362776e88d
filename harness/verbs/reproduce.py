"""The talks' results: a study by its name, the talk's numbers beside ours."""

from __future__ import annotations

import sys
from pathlib import Path

from harness.arguments import as_count, as_folder, as_seconds
from harness.errors import InputError
from harness.verbs.common import add_names, add_verb, chosen_executor, show

SIZES = ("quick", "paper")


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "reproduce", _reproduce, "a result of the talks, reproduced and put beside the original")
    verb.add_argument("name", nargs="?", metavar="NAME", help="which; --list names them")
    verb.add_argument("--list", action="store_true", help="show the studies, their sizes and engines, and run nothing")
    verb.add_argument(
        "--size", choices=SIZES, default="quick",
        help="quick: minutes, smaller; paper: as in the talk, hours; default: quick",
    )
    add_names(verb, "engine", "default: as the study says")
    verb.add_argument("--packings", type=as_count, metavar="N", help="random packings; default: as the size says")
    verb.add_argument("--measurements", type=Path, metavar="FILE", help="of your own, for studies that take some")
    verb.add_argument(
        "--keep", type=as_folder, metavar="DIR", help="also write numbers and pictures, small, into DIR/NAME"
    )
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    verb.add_argument(
        "--executor", choices=("local", "slurm"),
        help="what makes the runs, through executorlib; default: this process",
    )
    verb.add_argument(
        "--out", type=as_folder, default=Path("out/reproduce"), metavar="DIR", help="default: %(default)s"
    )
    verb.add_argument(
        "--time-limit", type=as_seconds, default=36000.0, metavar="S", help="per run; default: %(default)g"
    )


def _reproduce(options) -> int:
    from harness.report.reproduce import check_report_place, reproduce_answer, study_list, summary, write_reproduce
    from harness.report.reproduce_keep import check_keep_place, keep
    from harness.studies.reproduce.registry import all_studies, find_study

    if options.list:
        return show(study_list(list(all_studies().values())), options)
    study = find_study(options.name or "")
    with chosen_executor(options) as executor:
        ask = _ask(study, options, executor)
        check_report_place(study, ask)
        check_keep_place(options.keep)
        study.check(ask)
        _announce(study, ask)
        result = study.run(ask)
    page = write_reproduce(study, ask, result)
    show(reproduce_answer(study, ask, result), options)
    kept = f"\nkept: {keep(study, ask, result, options.keep)}" if options.keep else ""
    if options.json != "-":
        print("\n\n".join([*result.words, result.rate_words]))
        print(f"\n{summary(result)}\nreport: {page}{kept}")
    return result.exit_status


def _ask(study, options, executor):
    from harness.engines.registry import choose_engines
    from harness.runs.progress import progress_for
    from harness.studies.reproduce.protocol import Ask

    if options.measurements is not None:
        if not study.measurements:
            raise InputError(
                file="--measurements", expected=f"nothing, as {study.name} takes no measurements",
                got=options.measurements,
            )
        if not options.measurements.is_file():
            raise InputError(file="--measurements", expected=study.measurements, got=f"no file {options.measurements}")
    return Ask(
        size=options.size, engines=choose_engines(options.engines or list(study.engines)), out=options.out,
        packings=options.packings, measurements=options.measurements, workers=options.workers,
        time_limit=options.time_limit, progress=progress_for, executor=executor,
    )


def _announce(study, ask) -> None:
    """Say on standard error how long it is going to take."""
    from harness.report.expected import expected_cases
    from harness.scene.explain import time_row

    beyond = study.sizes[ask.size].beyond
    expected = expected_cases(study.cases(ask), ask.engines, workers=ask.workers, beyond=beyond)
    row, cpu = time_row("reproduce", expected.seconds, expected.says), time_row("cpu", expected.cpu, "")
    print(f"expected: about {row.text} ({cpu.text} of CPU time) for {row.note}", file=sys.stderr, flush=True)
