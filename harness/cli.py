"""The command line: thin. It parses, calls a study, prints, and turns wrong input into one line.

Exit status 0: done and as declared; 1: a check differs or a run failed; 2: the input is wrong.
Imports are local, so that `grainproof --help` answers at once.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from harness import __version__
from harness.arguments import OneLineParser, as_count, as_folder, as_names, as_numbers, as_seconds
from harness.errors import InputError, system_line
from harness.places import check_places


def main(arguments: list[str] | None = None) -> int:
    """Run one command; return the exit status."""
    words = sys.argv[1:] if arguments is None else arguments
    if words[:1] == ["average"]:
        return _average(words[1:])
    options = parser().parse_args(words)
    try:
        check_places(options)
        return options.run(options)
    except InputError as error:
        _complain(error)
        return 2
    except KeyboardInterrupt:
        print("grainproof: interrupted; finished runs are kept, the same command goes on from here", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader has seen enough; the interpreter must not write to it again
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        _complain(error)
        return 1
    except ExceptionGroup as several:  # of runs side by side; a full disk, say, is nobody's bug
        if several.subgroup(lambda e: not isinstance(e, OSError | ExceptionGroup)):
            raise
        _complain(_first(several))
        return 1


def _first(several: ExceptionGroup) -> Exception:
    """Return the first error that is not itself a group."""
    error = several.exceptions[0]
    return _first(error) if isinstance(error, ExceptionGroup) else error


def _complain(error: Exception) -> None:
    """Print one line that a terminal cannot be harmed by, whatever the user's words were."""
    from harness.scene.fault import printable

    line = system_line(error) if isinstance(error, OSError) else str(error)
    print(f"grainproof: {printable(line)}", file=sys.stderr)


def parser() -> argparse.ArgumentParser:
    """Return the command line's parser; every verb names the function that runs it."""
    top = OneLineParser(
        prog="grainproof", description="Do two DEM codes agree? One scene, every code, one page.",
        epilog="Exit status: 0 done and as declared, 1 a check differs or a run failed, 2 the input is wrong.",
    )
    top.add_argument("--version", action="version", version=f"grainproof {__version__}")
    verbs = top.add_subparsers(title="commands", required=True, metavar="COMMAND")
    verb = _add(verbs, "engines", _engines, "what is installed, versions, support table, known limits and defects")
    _add_names(verb, "engine", "also these, where they live: lammps@ENV/bin/python, liggghts@PATH")
    _scene_verb(verbs)
    _decks_verb(verbs)
    _run_verb(verbs)
    _compare_verb(verbs)
    _laws_verb(verbs)
    _bench_verb(verbs)
    _accuracy_verb(verbs)
    _report_verb(verbs)
    _status_verbs(verbs)
    verbs.add_parser("average", help="the post-processor alone, on a neutral state file")
    return top


def _add(verbs, name: str, run, text: str) -> argparse.ArgumentParser:
    verb = verbs.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
    verb.add_argument("--json", metavar="FILE", help="also write the result as JSON; - for standard output")
    verb.set_defaults(run=run, out=None)
    return verb


def _scene_verb(verbs) -> None:
    verb = _add(verbs, "scene", _scene, "the validated scene, derived numbers, effects on and why")
    verb.add_argument("file", type=Path, metavar="FILE")


def _decks_verb(verbs) -> None:
    verb = _add(verbs, "decks", _decks, "rewrite or verify the committed decks")
    verb.add_argument("files", type=Path, nargs="*", metavar="FILE", help="scene files; default: all shipped scenes")
    verb.add_argument("--check", action="store_true", help="change nothing; exit 1 when a deck is stale")
    verb.add_argument("--out", type=as_folder, metavar="DIR", help="where decks are written; default: inputs/decks")


def _run_verb(verbs) -> None:
    verb = _add(verbs, "run", _run, "one run of one scene on one engine")
    verb.add_argument("file", type=Path, metavar="FILE")
    verb.add_argument(
        "--engine", "--engines", required=True, metavar="E",
        help="lammps, liggghts, kernel, kernel:lammps, ...; another version where it lives: lammps@ENV/bin/python",
    )
    _add_run_options(verb)


def _compare_verb(verbs) -> None:
    verb = _add(verbs, "compare", _compare, "all engines, same packings, verdicts and report")
    verb.add_argument("file", type=Path, metavar="FILE")
    _add_names(
        verb, "engine", "default: lammps,liggghts,kernel; lammps@ENV/bin/python, liggghts@PATH, with :ranks=N behind"
    )
    counts = verb.add_mutually_exclusive_group()
    counts.add_argument("--packings", type=as_count, metavar="N", help="random packings; default: as the scene says")
    counts.add_argument(
        "--replicates", type=as_count, nargs="?", const=0, metavar="N",
        help="packings with a kick in every run, for verdicts with error bars; without N as the scene says",
    )
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    _add_run_options(verb)


def _laws_verb(verbs) -> None:
    verb = _add(verbs, "laws", _laws, "contact laws in prescribed motion and collisions: a matrix of laws and engines")
    _add_names(verb, "law", "combinations of laws; default: all")
    _add_names(verb, "engine", "default: all")
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    verb.add_argument("--out", type=as_folder, default=Path("out/laws"), metavar="DIR", help="default: %(default)s")
    verb.add_argument("--time-limit", type=as_seconds, default=120.0, metavar="S", help="per run; default: %(default)g")


def _accuracy_verb(verbs) -> None:
    verb = _add(verbs, "accuracy", _accuracy, "what accuracy costs: a ladder of settings, error against CPU time")
    verb.add_argument("file", type=Path, metavar="FILE")
    verb.add_argument("--knob", metavar="K", help="what is turned: dt, scheme; default: dt")
    verb.add_argument("--ladder", type=as_numbers, metavar="A,B,...", help="its values; default: ten from 0.64 on")
    verb.add_argument("--quantity", metavar="Q", help="exit, velocity or spin; default: exit, both together")
    verb.add_argument("--phases", type=as_count, metavar="N", help="of the step in which contacts begin; default: 48")
    _add_names(verb, "engine", "default: lammps,liggghts,kernel:talk,kernel:corrected; of scheme all kernels")
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    verb.add_argument("--out", type=as_folder, default=Path("out/accuracy"), metavar="DIR", help="default: %(default)s")
    verb.add_argument("--time-limit", type=as_seconds, default=600.0, metavar="S", help="per run; default: %(default)g")


def _bench_verb(verbs) -> None:
    verb = _add(verbs, "bench", _bench, "speed of the kernel against the codes, on the same packings")
    verb.add_argument("--quick", action="store_true", help="fewer cases and rounds, up to 20000 particles")
    verb.add_argument("--time-limit", type=as_seconds, metavar="S", help="begin no cell later; default: 3600, 600")
    verb.add_argument("--out", type=as_folder, default=Path("out/bench"), metavar="DIR", help="default: out/bench")


def _status_verbs(verbs) -> None:
    verb = _add(verbs, "status", _status, "the runs in a results folder: how they ended, their size")
    verb.add_argument("folder", type=as_folder, metavar="DIR", help="what --out was")
    verb = _add(verbs, "clean", _clean, "show the runs that are unfinished, damaged or in no report, or delete them")
    verb.add_argument("folder", type=as_folder, metavar="DIR", help="what --out was")
    verb.add_argument("--yes", action="store_true", help="delete them")


def _report_verb(verbs) -> None:
    verb = _add(verbs, "report", _report, "a finished report again, or what changed since an older one")
    verb.add_argument("folder", type=as_folder, metavar="DIR", help="what --out was")
    verb.add_argument(
        "--against", type=as_folder, metavar="OLD",
        help="the older report's folder: what changed, also as difference.html in DIR; exit 1 if a verdict got worse",
    )


def _add_run_options(verb: argparse.ArgumentParser) -> None:
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


def _add_names(verb: argparse.ArgumentParser, what: str, text: str) -> None:
    """An option for names, separated by commas or one at a time, in singular and in plural."""
    verb.add_argument(
        f"--{what}s", f"--{what}", type=as_names, action="extend", metavar="A,B", help=f"{text}; may be repeated"
    )


# --- the verbs -----------------------------------------------------------------------------------


def _engines(options) -> int:
    from harness.engines.registry import choose_engines
    from harness.report.engines import engines_answer

    return _show(engines_answer(choose_engines(options.engines) if options.engines else ()), options)


def _scene(options) -> int:
    from harness.report.scene import scene_answer

    return _show(scene_answer(options.file), options)


def _decks(options) -> int:
    from harness.report.tables import Answer
    from harness.studies.decks import check_decks, default_decks_folder, rendered_decks, shipped_scenes, write_decks

    ours = options.out is None
    folder = default_decks_folder() if ours else options.out
    decks, whole = rendered_decks(options.files or shipped_scenes(), flowed=not ours), ours and not options.files
    if options.check:
        rows = check_decks(decks, folder, whole=whole)
    else:
        rows = write_decks(decks, folder, whole=whole, remove=ours)
    _show(Answer(tables={f"Decks in {folder}": rows}, data={"decks": rows}), options)
    return 1 if options.check and any(r["state"] != "current" for r in rows) else 0


def _run(options) -> int:
    from harness.engines.registry import find_engine
    from harness.report.run import run_answer, write_run_files
    from harness.runs.progress import progress_for
    from harness.studies.single import single_run

    engine = find_engine(options.engine, ranks=options.ranks)
    with _executor(options) as executor:
        done = single_run(
            options.file, engine, options.out, time_limit=options.time_limit, progress=progress_for, executor=executor
        )
    write_run_files(done)
    _show(run_answer(done), options)
    return 0 if done.outcome.status == "completed" else 1


def _compare(options) -> int:
    from harness.engines.registry import USUAL, choose_engines
    from harness.report.compare import check_report_places, compare_answer, summary, write_report
    from harness.runs.progress import progress_for
    from harness.studies.compare import compare

    engines = choose_engines(options.engines or list(USUAL), ranks=options.ranks)
    check_report_places(options.out)
    _announce(options, engines)
    with _executor(options) as executor:
        comparison = compare(
            options.file, engines, options.out, packings=options.packings, time_limit=options.time_limit,
            workers=options.workers, progress=progress_for, executor=executor, replicates=options.replicates,
        )
    written = write_report(comparison, options.out)
    _show(compare_answer(comparison), options)
    if options.json != "-":
        print(f"{summary(comparison)}\nreport: {written.page}")
    return comparison.exit_status


def _executor(options):
    """Return the executor that was asked for, as a context; one of nothing when none was."""
    from harness.runs.executors import executor

    return executor(options.executor, options.out)


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


def _laws(options) -> int:
    from harness.engines.registry import ENGINES, choose_alone
    from harness.report.laws import closing_words, laws_answer, write_laws_report
    from harness.runs.progress import progress_for
    from harness.studies.laws import choose_laws, prove_laws

    laws = choose_laws(options.laws or [])
    engines = choose_alone(options.engines) if options.engines else list(ENGINES.values())
    result = prove_laws(
        laws, engines, options.out, time_limit=options.time_limit, workers=options.workers, progress=progress_for
    )
    written = write_laws_report(result, options.out)
    _show(laws_answer(result), options)
    if options.json != "-":
        print(closing_words(result, written))
    return result.exit_status


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
    _show(accuracy_answer(done), options)
    if options.json != "-":
        print(f"{paragraph(done)}\nreport: {page}")
    return done.exit_status


def _bench(options) -> int:
    from harness.report.bench import bench_answer, summary, write_bench
    from harness.runs.progress import progress_for
    from harness.studies.bench import announced, bench

    print(announced(quick=options.quick, time_limit=options.time_limit), file=sys.stderr)
    done = bench(quick=options.quick, out=options.out, progress=progress_for, time_limit=options.time_limit)
    page = write_bench(done, options.out)
    _show(bench_answer(done), options)
    if options.json != "-":
        print(f"{summary(done)}\nreport: {page}")
    return done.exit_status


def _report(options) -> int:
    from harness.report.against import report

    reported = report(options.folder, options.against)
    _show(reported.answer, options)
    if options.json != "-":
        print(reported.closing)
    return reported.exit_status


def _status(options) -> int:
    from harness.report.status import status_answer

    return _show(status_answer(options.folder), options)


def _clean(options) -> int:
    from harness.report.status import clean_answer

    return _show(clean_answer(options.folder, really=options.yes), options)


def _average(words: list[str]) -> int:
    """The post-processor has its own parser: it is a tool of its own and imports nothing of the harness."""
    from postproc.average import main as average

    return average(words, prog="grainproof average")


def _show(answer, options) -> int:
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


if __name__ == "__main__":
    sys.exit(main())
