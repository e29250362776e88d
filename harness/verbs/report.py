"""A finished report again, or what changed since an older one."""

from __future__ import annotations

from harness.arguments import as_folder
from harness.verbs.common import add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "report", _report, "a finished report again, or what changed since an older one")
    verb.add_argument("folder", type=as_folder, metavar="DIR", help="what --out was")
    verb.add_argument(
        "--against", type=as_folder, metavar="OLD",
        help="the older report's folder: what changed, also as difference.html in DIR; exit 1 if a verdict got worse",
    )


def _report(options) -> int:
    from harness.report.against import report

    reported = report(options.folder, options.against)
    show(reported.answer, options)
    if options.json != "-":
        print(reported.closing)
    return reported.exit_status
