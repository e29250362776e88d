"""What accuracy costs: a ladder of settings, error against CPU time."""

from __future__ import annotations

import sys
from pathlib import Path

from harness.arguments import as_count, as_folder, as_numbers, as_seconds
from harness.verbs.common import add_names, add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "accuracy", _accuracy, "what accuracy costs: a ladder of settings, error against CPU time")
    verb.add_argument("file", type=Path, metavar="FILE")
    verb.add_argument(
        "--knob", metavar="K,L",
        help="what is turned: dt, scheme; of boxes and rings also stiffness, rate, size, width, law, several between "
        "commas, or all; default: dt, of boxes dt,stiffness,rate,size,width, of rings dt,stiffness,rate",
    )
    verb.add_argument(
        "--ladder", type=as_numbers, metavar="A,B,...",
        help="values of one knob: a part of a contact time, times the scene's stiffness or rate, particles, strain or "
        "cells; the scene's own is added but for free scenes; default: some around it",
    )
    verb.add_argument(
        "--quantity", metavar="Q",
        help="exit, velocity, spin; friction_angle, plateau_angle, stress_ratio, volume_strain, stress_strain; torque, "
        "band_width, wall_velocity; default: the first of its kind",
    )
    verb.add_argument("--phases", type=as_count, metavar="N", help="of the step in which contacts begin; default: 48")
    verb.add_argument("--packings", type=as_count, metavar="N", help="of a box or ring; default: 8, 2")
    add_names(
        verb, "engine",
        "default: lammps,liggghts,kernel:talk, of free scenes also kernel:corrected; of the knob scheme all kernels",
    )
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    verb.add_argument("--out", type=as_folder, default=Path("out/accuracy"), metavar="DIR", help="default: %(default)s")
    verb.add_argument("--time-limit", type=as_seconds, default=3600.0, metavar="S", help="a run; default: %(default)g")


def _accuracy(options) -> int:
    from harness.report.accuracy import NAMES
    from harness.report.accuracy_bulk import BULK_NAMES
    from harness.report.accuracy_expected import announcement
    from harness.runs.progress import progress_for
    from harness.studies.accuracy import accuracy

    for names in (NAMES, BULK_NAMES):
        names.check(options.out)
    asked = {
        "engines": options.engines, "knob": options.knob, "ladder": options.ladder, "quantity": options.quantity,
        "packings": options.packings, "workers": options.workers,
    }
    print(announcement(options.file, **asked, phases=options.phases), file=sys.stderr, flush=True)
    done = accuracy(
        options.file, options.out, **asked, phases=options.phases, time_limit=options.time_limit, progress=progress_for
    )
    answer, page, words = _reported(done, options.out)
    show(answer, options)
    if options.json != "-":
        print(f"{words}\nreport: {page}")
    return done.exit_status


def _reported(done, out: Path):
    """Write the report; return its answer, its page and its words. Free scenes have one of their own."""
    from harness.report.accuracy import accuracy_answer, write_accuracy
    from harness.report.accuracy_bulk import bulk_answer, write_bulk
    from harness.report.accuracy_bulk_words import bulk_paragraph
    from harness.report.accuracy_words import paragraph
    from harness.studies.accuracy import BulkAccuracy

    if isinstance(done, BulkAccuracy):
        return bulk_answer(done), write_bulk(done, out), bulk_paragraph(done)
    return accuracy_answer(done), write_accuracy(done, out), paragraph(done)
