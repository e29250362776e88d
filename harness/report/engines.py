"""What is installed, how each engine stands to each effect and law, and what it is known to do wrong."""

from __future__ import annotations

from typing import get_args

from harness.engines.protocol import Level, Support
from harness.engines.registry import ENGINES
from harness.report.asked import hard_cases, ordinary_cases
from harness.report.tables import Answer
from harness.scene.effects import EFFECT_NAMES

AS_IT_SHOULD = ("exact", "equivalent")
"""Levels that need no warning."""

Judged = list[tuple[str, Support]]
"""Judgements with the engine that made them."""


def engines_answer() -> Answer:
    """Return what is installed, the support matrix with its notes, the known limits and the known defects."""
    judged = [(n, s) for n, e in ENGINES.items() for system in ordinary_cases() for s in e.supports(system)]
    rows = {
        "engines": engine_rows(), "support": support_rows(judged), "notes": note_rows(judged), "limits": limit_rows(),
        "defects": defect_rows(),
    }
    titles = ("Engines", "What each engine does with each effect", "How it does it", "Known limits", "Known defects")
    return Answer(tables=dict(zip(titles, rows.values(), strict=True)), data=rows)


def engine_rows() -> list[dict]:
    """One row an engine: is it here, which version, where or how to get it."""
    probes = {name: engine.probe() for name, engine in ENGINES.items()}
    return [
        {"engine": n, "here": "yes" if p.available else "no", "version": p.version or None, "detail": p.detail}
        for n, p in probes.items()
    ]


def support_rows(judged: Judged) -> list[dict]:
    """One row an effect or law that scenes can call for, one column an engine: its levels, None if it names none.

    Several levels: it depends on what else there is (walls, dimension, other laws), and the notes say on what.
    """
    found: dict[tuple[str, str], set[Level]] = {}
    for engine, s in judged:
        found.setdefault((s.effect, engine), set()).add(s.level)
    return [
        {"effect": effect, **{e: _levels(found.get((effect, e), set())) for e in ENGINES}} for effect in EFFECT_NAMES
    ]


def _levels(found: set[Level]) -> str | None:
    """Write levels from the best to the worst."""
    return ", ".join(level.replace("_", " ") for level in get_args(Level) if level in found) or None


def note_rows(judged: Judged) -> list[dict]:
    """One row a distinct note: the engine and the effects it is about."""
    about: dict[tuple[str, str], list[str]] = {}
    for engine, s in judged:
        about.setdefault((engine, s.note), []).append(s.effect)
    every = {engine: {s.effect for e, s in judged if e == engine} for engine, _ in judged}
    return [
        {"engine": e, "effect": "all" if set(of) == every[e] else ", ".join(dict.fromkeys(of)), "note": note}
        for (e, note), of in about.items()
    ]


def limit_rows() -> list[dict]:
    """One row a hard case and an engine that does not compute it as it should."""
    found = [
        {"case": case, "engine": name, "support": s.level.replace("_", " "), "note": s.note}
        for case, system in hard_cases().items() for name, engine in ENGINES.items()
        for s in engine.supports(system) if s.level not in AS_IT_SHOULD
    ]
    return list({tuple(row.values()): row for row in found}.values())


def defect_rows() -> list[dict]:
    """One row a defect that was reproduced on a real version, and how the decks keep clear of it."""
    return [
        {"engine": name, "defect": d.name, "affects": d.affects, "evidence": d.evidence, "avoided": d.avoided}
        for name, engine in ENGINES.items() for d in engine.known_defects()
    ]
