"""What is installed, how each engine stands to each effect and law, and what it is known to do wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from harness.engines.protocol import Engine, Support
from harness.engines.registry import ENGINES, KERNEL_PREFIX
from harness.report.asked import hard_cases, ordinary_cases
from harness.report.parts import Judged, levels_in_words
from harness.report.tables import Answer, Row
from harness.scene.effects import EFFECT_NAMES
from harness.scene.system import System

AS_IT_SHOULD = ("exact", "equivalent")
"""Levels that need no warning."""


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """What one engine says of one effect of one system."""

    engine: str
    system: System
    support: Support


def engines_answer(more: Sequence[Engine] = ()) -> Answer:
    """Return what is installed, the support matrix with its notes, the known limits and the known defects.

    more: engines besides the registry's, other versions of its codes, for which the rows of the code hold.
    """
    judged = [
        Judgement(engine=n, system=system, support=s)
        for n, e in ENGINES.items() for system in ordinary_cases() for s in e.supports(system)
    ]
    rows = {
        "engines": engine_rows(more), "support": support_rows(judged), "notes": note_rows(judged),
        "limits": limit_rows(), "defects": defect_rows(),
    }
    titles = ("Engines", "What each engine does with each effect", "How it does it", "Known limits", "Known defects")
    shown = {name: _kernels_as_one(table) if name == "support" else table for name, table in rows.items()}
    return Answer(tables=dict(zip(titles, shown.values(), strict=True)), data=rows, prose=True)


def engine_rows(more: Sequence[Engine] = ()) -> list[dict]:
    """One row an engine: is it here, which version, where or how to get it."""
    probes = {e.name: e.probe() for e in (*ENGINES.values(), *more)}
    return [
        {"engine": n, "here": "yes" if p.available else "no", "version": p.version or None, "detail": p.detail}
        for n, p in probes.items()
    ]


def support_rows(judged: Sequence[Judgement]) -> list[dict]:
    """One row an effect or law that scenes can call for, one column an engine: its level, None if it names none.

    Where the level depends on what else there is, the cell says on what: "exact, but partial in 3D".
    """
    found: dict[tuple[str, str], list[Judged]] = {}
    for j in judged:
        found.setdefault((j.support.effect, j.engine), []).append(Judged(j.system, j.support.level))
    return [
        {"effect": effect, **{e: levels_in_words(found.get((effect, e), [])) for e in ENGINES}}
        for effect in EFFECT_NAMES
    ]


def _kernels_as_one(rows: list[dict]) -> list[Row]:
    """Put the conventions of the kernel into one column where they say the same throughout."""
    kernels = [name for name in ENGINES if name.startswith(KERNEL_PREFIX)]
    if any(len({row[name] for name in kernels}) > 1 for row in rows):
        return rows
    others = [name for name in rows[0] if name not in kernels]
    return [{**{name: row[name] for name in others}, f"{KERNEL_PREFIX}*": row[kernels[0]]} for row in rows]


def note_rows(judged: Sequence[Judgement]) -> list[dict]:
    """One row a distinct note: the engine and the effects it is about."""
    about: dict[tuple[str, str], dict[str, None]] = {}
    every: dict[str, dict[str, None]] = {}
    for j in judged:
        about.setdefault((j.engine, j.support.note), {})[j.support.effect] = None
        every.setdefault(j.engine, {})[j.support.effect] = None
    return [{"engine": e, "effect": _these(list(of), list(every[e])), "note": note} for (e, note), of in about.items()]


def _these(effects: list[str], every: list[str]) -> str:
    """Name effects, or those that are left out where that is shorter."""
    rest = [effect for effect in every if effect not in effects]
    if not rest:
        return "all"
    return f"all but {', '.join(rest)}" if len(rest) < len(effects) else ", ".join(effects)


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
