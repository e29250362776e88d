"""Which part of an effect a judgement is about: the fewest words that tell the systems of one level from the rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple, get_args

from harness.engines.protocol import Level
from harness.scene.describe import either
from harness.scene.laws import word
from harness.scene.system import System

MOST_FACTORS = 3
"""More things at a time are no explanation."""


class Judged(NamedTuple):
    """What an engine says of an effect in one system."""

    system: System
    level: Level


def _law(family: str) -> Callable[[System], str]:
    def words(system: System) -> str:
        law = getattr(system, family)
        name = "" if family == "normal" else f" {family}"
        return f"with {word(law)}{name}" if law is not None else f"without {family}"

    return words


FACTORS: Mapping[str, Callable[[System], str]] = {
    **{family: _law(family) for family in ("normal", "rolling", "torsion", "sliding")},
    "dimension": lambda system: f"in {system.dimension}D",
    "box": lambda system: "between walls" if system.walls else "in a periodic box",
}
"""What a level can depend on, in words; the first that decides is told."""


def levels_in_words(judged: Sequence[Judged]) -> str | None:
    """Return "exact", or "exact, but partial in 3D, unsupported with jkr"; None where nothing was judged.

    The best level stands first and holds wherever nothing else is said. Where no few factors decide, the levels
    alone are named, from the best to the worst.
    """
    ranked = [level for level in get_args(Level) if level in {j.level for j in judged}]
    if len(ranked) <= 1:
        return _plain(ranked[0]) if ranked else None
    names = next((names for names in _choices() if _decides(names, judged)), None)
    if names is None:
        return ", ".join(_plain(level) for level in ranked)
    exceptions = (f"{_plain(level)} {either(_conditions(names, level, judged))}" for level in ranked[1:])
    return f"{_plain(ranked[0])}, but {', '.join(exceptions)}"


def _plain(level: Level) -> str:
    return level.replace("_", " ")


def _choices() -> Iterator[tuple[str, ...]]:
    """Yield the factors one by one, then two at a time, ..."""
    for size in range(1, MOST_FACTORS + 1):
        yield from combinations(FACTORS, size)


def _decides(names: Sequence[str], judged: Sequence[Judged]) -> bool:
    """Whether systems with the same values of these factors are all at one level."""
    levels: dict[tuple[str, ...], set[Level]] = {}
    for j in judged:
        levels.setdefault(_values(names, j.system), set()).add(j.level)
    return all(len(found) == 1 for found in levels.values())


def _conditions(names: Sequence[str], level: Level, judged: Sequence[Judged]) -> list[str]:
    """Return when the level holds, by as few of the factors as tell it from the other levels."""
    others = [j for j in judged if j.level != level]
    found: dict[str, None] = {}
    for system in (j.system for j in judged if j.level == level):
        short = next(s for s in _shorter(names) if not any(_values(s, o.system) == _values(s, system) for o in others))
        found[" ".join(_values(short, system))] = None
    return list(found)


def _shorter(names: Sequence[str]) -> Iterator[tuple[str, ...]]:
    for size in range(1, len(names) + 1):
        yield from combinations(names, size)


def _values(names: Sequence[str], system: System) -> tuple[str, ...]:
    return tuple(FACTORS[name](system) for name in names)
