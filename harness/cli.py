"""The command line: thin. It parses, calls a study, prints, and turns wrong input into one line.

Exit status 0: done and as declared; 1: a check differs or a run failed; 2: the input is wrong.
Imports are local, so that `grainproof --help` answers at once.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from harness import __version__
from harness.errors import InputError


def main(arguments: list[str] | None = None) -> int:
    """Run one command; return the exit status."""
    words = sys.argv[1:] if arguments is None else arguments
    if words[:1] == ["average"]:
        return _average(words[1:])
    options = parser().parse_args(words)
    try:
        return options.run(options)
    except InputError as error:
        print(f"grainproof: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("grainproof: interrupted; finished runs are kept, the same command goes on from here", file=sys.stderr)
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return 1


def parser() -> argparse.ArgumentParser:
    """Return the command line's parser; every verb names the function that runs it."""
    top = argparse.ArgumentParser(
        prog="grainproof", description="Do two DEM codes agree? One scene, every code, one page.",
        epilog="Exit status: 0 done and as declared, 1 a check differs or a run failed, 2 the input is wrong.",
    )
    top.add_argument("--version", action="version", version=f"grainproof {__version__}")
    verbs = top.add_subparsers(title="commands", required=True, metavar="COMMAND")
    _add(verbs, "engines", _engines, "what is installed, versions, support table")
    _scene_verb(verbs)
    _decks_verb(verbs)
    _run_verb(verbs)
    _compare_verb(verbs)
    verbs.add_parser("average", help="the post-processor alone, on a neutral state file")
    return top


def _add(verbs, name: str, run, text: str) -> argparse.ArgumentParser:
    verb = verbs.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
    verb.add_argument("--json", metavar="FILE", help="also write the result as JSON; - for standard output")
    verb.set_defaults(run=run)
    return verb


def _scene_verb(verbs) -> None:
    verb = _add(verbs, "scene", _scene, "the validated scene, derived numbers, effects on and why")
    verb.add_argument("file", type=Path, metavar="FILE")


def _decks_verb(verbs) -> None:
    verb = _add(verbs, "decks", _decks, "rewrite or verify the committed decks")
    verb.add_argument("files", type=Path, nargs="*", metavar="FILE", help="scene files; all shipped scenes unless given")
    verb.add_argument("--check", action="store_true", help="change nothing; exit 1 when a deck is stale")
    verb.add_argument("--out", type=Path, metavar="DIR", help="where decks are written; inputs/decks unless given")


def _run_verb(verbs) -> None:
    verb = _add(verbs, "run", _run, "one run of one scene on one engine")
    verb.add_argument("file", type=Path, metavar="FILE")
    verb.add_argument("--engine", required=True, metavar="E", help="lammps, liggghts, kernel, kernel:lammps, ...")
    _add_run_options(verb)


def _compare_verb(verbs) -> None:
    verb = _add(verbs, "compare", _compare, "all engines, same packings, verdicts and report")
    verb.add_argument("file", type=Path, metavar="FILE")
    verb.add_argument("--engines", default="lammps,liggghts,kernel", metavar="A,B", help="default: %(default)s")
    verb.add_argument("--packings", type=_positive, metavar="N", help="random packings; the scene's number unless given")
    verb.add_argument("--workers", type=_positive, metavar="N", help="runs at a time; the number of cores unless given")
    _add_run_options(verb)


def _add_run_options(verb: argparse.ArgumentParser) -> None:
    verb.add_argument("--out", type=Path, default=Path("out"), metavar="DIR", help="results and runs; default: out")
    verb.add_argument("--time-limit", type=_seconds, default=3600.0, metavar="S", help="per run, default: %(default)g s")


def _positive(word: str) -> int:
    value = int(word)
    if value < 1:
        raise argparse.ArgumentTypeError(f"expected a whole number > 0, got {word}")
    return value


def _seconds(word: str) -> float:
    value = float(word)
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"expected seconds > 0, got {word}")
    return value


# --- the verbs -----------------------------------------------------------------------------------


def _engines(options) -> int:
    from harness.report.engines import engine_rows, support_rows

    tables = {"engines": engine_rows(), "support": support_rows()}
    return _show(tables, {"engines": "Engines", "support": "What each engine does with each effect"}, options)


def _scene(options) -> int:
    from harness.report.scene import scene_tables

    tables, titles = scene_tables(options.file)
    return _show(tables, titles, options)


def _decks(options) -> int:
    from harness.studies.decks import check_decks, default_decks_folder, shipped_scenes, write_decks

    files = options.files or shipped_scenes()
    folder = options.out or default_decks_folder()
    rows = check_decks(files, folder) if options.check else write_decks(files, folder)
    _show({"decks": rows}, {"decks": f"Decks below {folder}"}, options)
    return 1 if options.check and any(r["state"] != "current" for r in rows) else 0


def _run(options) -> int:
    from harness.engines.registry import find_engine
    from harness.report.run import write_run_tables
    from harness.runs.progress import progress_for
    from harness.studies.single import single_run

    done = single_run(
        options.file, find_engine(options.engine), _usable(options.out), time_limit=options.time_limit,
        progress=progress_for(),
    )
    tables, titles = write_run_tables(done)
    _show(tables, titles, options)
    return 0 if done.outcome.status == "completed" else 1


def _compare(options) -> int:
    from harness.engines.registry import choose_engines
    from harness.report.compare import check_rows, run_rows, write_report
    from harness.runs.progress import progress_for
    from harness.studies.compare import compare

    engines = choose_engines([w for w in options.engines.split(",") if w])
    comparison = compare(
        options.file, engines, _usable(options.out), packings=options.packings, time_limit=options.time_limit,
        workers=options.workers, progress=progress_for(),
    )
    written = write_report(comparison, options.out)
    tables = {"runs": run_rows(comparison), "checks": check_rows(comparison)}
    _show(tables, {"runs": "Runs", "checks": "Verdicts"}, options, data=written.data)
    if options.json != "-":
        print(f"report: {written.page}")
    return comparison.exit_status


def _average(words: list[str]) -> int:
    """The post-processor has its own parser: it is a tool of its own and imports nothing of the harness."""
    from postproc.average import main as average

    return average(words, prog="grainproof average")


def _usable(out: Path) -> Path:
    """Return the output folder, made if need be; refuse a place that cannot be one."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(file="--out", expected="a folder that can be written", got=f"{out}: {error.strerror}") from error
    return out


def _show(tables: dict, titles: dict, options, data: Path | None = None) -> int:
    """Print tables for people, or JSON on standard output, or both with the JSON in a file."""
    from harness.report.tables import print_table

    if options.json:
        _write_json(tables, options.json, data)
    if options.json != "-":
        for name, rows in tables.items():
            print_table(rows, titles[name])
            print()
    return 0


def _write_json(tables: dict, target: str, data: Path | None) -> None:
    import json

    from harness.runs.atomic import write_json_atomic

    if target == "-":
        print(data.read_text() if data else json.dumps(tables, indent=1))
    elif data:
        from harness.runs.atomic import write_text_atomic

        write_text_atomic(Path(target), data.read_text())
    else:
        write_json_atomic(Path(target), tables)


if __name__ == "__main__":
    sys.exit(main())
