"""The decks of the shipped scenes, or of a user's, rewritten or verified."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from harness.arguments import as_folder
from harness.verbs.common import add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "decks", _decks, "rewrite or verify the committed decks")
    verb.add_argument("files", type=Path, nargs="*", metavar="FILE", help="scene files; default: all shipped scenes")
    verb.add_argument("--check", action="store_true", help="change nothing; exit 1 when a deck is stale")
    verb.add_argument("--out", type=as_folder, metavar="DIR", help="where decks are written; default: inputs/decks")


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
    shown = [r for r in rows if r["state"] != "current"]
    show(Answer(tables={f"Decks in {folder}": shown} if shown else {}, data={"decks": rows}), options)
    if options.json != "-":
        counts = Counter(r["state"] for r in rows)
        print(f"{folder}: {', '.join(f'{n} {state}' for state, n in counts.items())}")
    return 1 if options.check and any(r["state"] != "current" for r in rows) else 0
