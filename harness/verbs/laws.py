"""Contact laws in prescribed motion and in collisions, on every engine."""

from __future__ import annotations

from pathlib import Path

from harness.arguments import as_count, as_folder, as_seconds
from harness.verbs.common import add_names, add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(
        verbs, "laws", _laws, "contact laws in prescribed motion and collisions: a matrix of laws and engines"
    )
    add_names(verb, "law", "combinations of laws; default: all")
    add_names(verb, "engine", "default: all")
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    verb.add_argument("--out", type=as_folder, default=Path("out/laws"), metavar="DIR", help="default: %(default)s")
    verb.add_argument("--time-limit", type=as_seconds, default=120.0, metavar="S", help="per run; default: %(default)g")


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
    show(laws_answer(result), options)
    if options.json != "-":
        print(closing_words(result, written))
    return result.exit_status
