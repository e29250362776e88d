"""What is installed, and what each code does with each effect."""

from __future__ import annotations

from harness.verbs.common import add_names, add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "engines", _engines, "what is installed, versions, support table, known limits and defects")
    add_names(verb, "engine", "also these, where they live: lammps@ENV/bin/python, liggghts@PATH")


def _engines(options) -> int:
    from harness.engines.registry import choose_engines
    from harness.report.engines import engines_answer

    return show(engines_answer(choose_engines(options.engines) if options.engines else ()), options)
