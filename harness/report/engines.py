"""What is installed, and how each engine stands to each effect."""

from __future__ import annotations

from harness.engines.protocol import Support
from harness.engines.registry import ENGINES
from harness.report.asked import hard_cases, ordinary_cases
from harness.report.tables import Answer
from harness.scene.effects import EFFECTS

AS_IT_SHOULD = ("exact", "equivalent")
"""Levels that need no warning."""

Judged = list[tuple[str, Support]]
"""Judgements with the engine that made them."""


def engines_answer() -> Answer:
    """Return what is installed, the support matrix with its notes, and the known limits."""
    judged = [(n, s) for n, e in ENGINES.items() for system in ordinary_cases() for s in e.supports(system)]
    rows = {
        "engines": engine_rows(), "support": support_rows(judged), "notes": note_rows(judged), "limits": limit_rows(),
    }
    titles = ("Engines", "What each engine does with each effect", "How it does it", "Known limits")
    return Answer(tables=dict(zip(titles, rows.values(), strict=True)), data=rows)


def engine_rows() -> list[dict]:
    """One row an engine: is it here, which version, where or how to get it."""
    probes = {name: engine.probe() for name, engine in ENGINES.items()}
    return [
        {"engine": n, "here": "yes" if p.available else "no", "version": p.version or None, "detail": p.detail}
        for n, p in probes.items()
    ]


def support_rows(judged: Judged) -> list[dict]:
    """One row an effect that scenes can call for, one column an engine: its level, None if it names none."""
    levels: dict[tuple[str, str], list[str]] = {}
    for engine, s in judged:
        levels.setdefault((s.effect, engine), []).append(s.level.replace("_", " "))
    return [
        {"effect": effect, **{e: ", ".join(dict.fromkeys(levels.get((effect, e), []))) or None for e in ENGINES}}
        for effect in EFFECTS
    ]


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
