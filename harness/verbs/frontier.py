"""The largest stable time step of every code, law and packing."""

from __future__ import annotations

import sys
from pathlib import Path

from harness.arguments import as_count, as_folder, as_seconds
from harness.verbs.common import add_names, add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "frontier", _frontier, "the largest stable time step of every code, law and packing")
    verb.add_argument("--full", action="store_true", help="all laws, packings and points of the map")
    add_names(verb, "engine", "default: lammps,liggghts,kernel:lammps,kernel:talk")
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    verb.add_argument("--table", type=Path, metavar="FILE", help="also write the table that scenes are warned with")
    verb.add_argument("--out", type=as_folder, default=Path("out/frontier"), metavar="DIR", help="default: %(default)s")
    verb.add_argument("--time-limit", type=as_seconds, default=120.0, metavar="S", help="per run; default: %(default)g")


def _frontier(options) -> int:
    from datetime import UTC, datetime

    from harness.places import check_file
    from harness.report.frontier import NAMES, frontier_answer, write_frontier, write_scene_table
    from harness.report.frontier_expected import announcement
    from harness.report.frontier_tables import summary
    from harness.runs.progress import progress_for
    from harness.studies.frontier import frontiers

    NAMES.check(options.out)
    if options.table is not None:
        check_file("--table", options.table)
    asked = {"full": options.full, "engines": options.engines, "workers": options.workers}
    print(announcement(**asked), file=sys.stderr, flush=True)
    done = frontiers(options.out, **asked, time_limit=options.time_limit, progress=progress_for)
    page = write_frontier(done, options.out)
    if options.table is not None:
        write_scene_table(done, options.table, day=f"{datetime.now(UTC):%Y-%m-%d}")
    show(frontier_answer(done), options)
    if options.json != "-":
        print(f"{summary(done)}\nreport: {page}")
    return done.exit_status
