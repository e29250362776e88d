"""What accuracy costs: a ladder of settings, error against CPU time."""

from __future__ import annotations

from pathlib import Path

from harness.arguments import as_count, as_folder, as_numbers, as_seconds
from harness.verbs.common import add_names, add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "accuracy", _accuracy, "what accuracy costs: a ladder of settings, error against CPU time")
    verb.add_argument("file", type=Path, metavar="FILE")
    verb.add_argument("--knob", metavar="K", help="what is turned: dt, scheme; default: dt")
    verb.add_argument("--ladder", type=as_numbers, metavar="A,B,...", help="its values; default: ten from 0.64 on")
    verb.add_argument("--quantity", metavar="Q", help="exit, velocity or spin; default: exit, both together")
    verb.add_argument("--phases", type=as_count, metavar="N", help="of the step in which contacts begin; default: 48")
    add_names(verb, "engine", "default: lammps,liggghts,kernel:talk,kernel:corrected; of scheme all kernels")
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    verb.add_argument("--out", type=as_folder, default=Path("out/accuracy"), metavar="DIR", help="default: %(default)s")
    verb.add_argument("--time-limit", type=as_seconds, default=600.0, metavar="S", help="per run; default: %(default)g")


def _accuracy(options) -> int:
    from harness.report.accuracy import accuracy_answer, check_places, write_accuracy
    from harness.report.accuracy_words import paragraph
    from harness.runs.progress import progress_for
    from harness.studies.accuracy import accuracy

    check_places(options.out)
    done = accuracy(
        options.file, options.out, engines=options.engines, knob=options.knob, ladder=options.ladder,
        quantity=options.quantity, phases=options.phases, time_limit=options.time_limit, workers=options.workers,
        progress=progress_for,
    )
    page = write_accuracy(done, options.out)
    show(accuracy_answer(done), options)
    if options.json != "-":
        print(f"{paragraph(done)}\nreport: {page}")
    return done.exit_status
