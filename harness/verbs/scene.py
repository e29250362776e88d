"""The validated scene, and the numbers derived from it."""

from __future__ import annotations

from pathlib import Path

from harness.verbs.common import add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "scene", _scene, "the validated scene, derived numbers, effects on and why")
    verb.add_argument("file", type=Path, metavar="FILE")


def _scene(options) -> int:
    from harness.report.scene import scene_answer

    return show(scene_answer(options.file), options)
