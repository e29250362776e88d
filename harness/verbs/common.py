"""What the verbs share: how one is declared, its common options, and how an answer is shown."""

from __future__ import annotations

import argparse
from pathlib import Path

from harness.arguments import as_count, as_folder, as_names, as_seconds


def add_verb(verbs, name: str, run, text: str) -> argparse.ArgumentParser:
    """Return the parser of a verb that `run` carries out; every verb can write its answer as JSON."""
    verb = verbs.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
    verb.add_argument("--json", metavar="FILE", help="also write the result as JSON; - for standard output")
    verb.set_defaults(run=run, out=None)
    return verb


def add_run_options(verb: argparse.ArgumentParser) -> None:
    """How and where runs are made: MPI processes, executor, folder, time limit."""
    verb.add_argument(
        "--ranks", type=as_count, default=1, metavar="N",
        help="MPI processes of each code; the kernel has one; default: 1",
    )
    verb.add_argument(
        "--executor", choices=("local", "slurm"),
        help="what makes the runs, through executorlib; default: this process",
    )
    verb.add_argument("--out", type=as_folder, default=Path("out"), metavar="DIR", help="results, runs; default: out")
    verb.add_argument("--time-limit", type=as_seconds, default=3600.0, metavar="S", help="a run; default: %(default)g")


def add_watch(verb: argparse.ArgumentParser) -> None:
    """Energies, momentum, overlaps and displacements of every run, read from what it records anyway."""
    verb.add_argument(
        "--watch", action="store_true",
        help="energies, momentum, largest overlap and displacement of every run, and remarks on what cannot be, with "
        "one of which `run` exits 1; the run is not altered",
    )


def add_names(verb: argparse.ArgumentParser, what: str, text: str) -> None:
    """An option for names, separated by commas or one at a time, in singular and in plural."""
    verb.add_argument(
        f"--{what}s", f"--{what}", type=as_names, action="extend", metavar="A,B", help=f"{text}; may be repeated"
    )


def show(answer, options) -> int:
    """Print tables for people, or JSON on standard output, or both with the JSON in a file."""
    from harness.report.tables import print_table
    from harness.runs.atomic import json_text, write_json_atomic

    if options.json == "-":
        print(json_text(answer.data), end="")
        return 0
    for title, rows in answer.tables.items():
        print_table(rows, title, prose=answer.prose)
        print()
    if options.json:
        write_json_atomic(Path(options.json), answer.data)
    return 0


def chosen_executor(options):
    """Return the executor that was asked for, as a context; one of nothing when none was."""
    from harness.runs.executors import executor

    return executor(options.executor, options.out)
