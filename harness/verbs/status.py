"""What is kept in a results folder, and what can go."""

from __future__ import annotations

from harness.arguments import as_folder
from harness.verbs.common import add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "status", _status, "the runs in a results folder: how they ended, their size")
    verb.add_argument("folder", type=as_folder, metavar="DIR", help="what --out was")
    verb = add_verb(
        verbs, "clean", _clean, "show the runs that are unfinished, damaged or in no report, or delete them"
    )
    verb.add_argument("folder", type=as_folder, metavar="DIR", help="what --out was")
    verb.add_argument("--yes", action="store_true", help="delete them")


def _status(options) -> int:
    from harness.report.status import status_answer

    return show(status_answer(options.folder), options)


def _clean(options) -> int:
    from harness.report.status import clean_answer

    return show(clean_answer(options.folder, really=options.yes), options)
