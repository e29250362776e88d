"""Verdicts at a glance: quantities down, pairs of codes (or codes) across, the worst verdict in each cell."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from harness.report.tables import text
from harness.studies.verdict import Check, Verdict

SEVERITY: Mapping[Verdict, int] = {
    "agrees": 0, "known_difference": 1, "inconclusive": 2, "not_checked": 3, "differs": 4,
}
"""The larger, the worse: what is not known is worse than what agrees, and better than what is known to differ."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """The worst verdict of a quantity's checks, and beside it how many have it, the deviation and the tolerance."""

    verdict: Verdict
    note: str


@dataclass(frozen=True, kw_only=True)
class Line:
    """One quantity: a cell for every column, None where there is no check."""

    level: str
    quantity: str
    cells: tuple[Cell | None, ...]


@dataclass(frozen=True, kw_only=True)
class Matrix:
    """Lines under columns, each of which is headed by one or two names."""

    title: str
    columns: tuple[tuple[str, ...], ...]
    rows: tuple[Line, ...]


def matrices(checks: Sequence[Check], engines: Iterable[str]) -> tuple[Matrix, ...]:
    """Return the matrix of pairs of codes, and that of each code against the scene or published values.

    engines: the names of all that ran, in the order of columns. A matrix without checks is left out.
    """
    names = list(dict.fromkeys(engines))
    alone = [c for c in checks if c.left in names and c.right not in names]
    between = [c for c in checks if c not in alone]
    made = (
        _matrix("Code against code", between, lambda c: (c.left, c.right), lambda c: c.quantity, names),
        _matrix("Each code alone", alone, lambda c: (c.left,), lambda c: f"{c.quantity}, against {c.right}", names),
    )
    return tuple(m for m in made if m.rows)


def _matrix(title: str, checks: Sequence[Check], column, quantity, names: list[str]) -> Matrix:
    """Gather checks by line (level, quantity) and column, both in the order in which they first occur."""
    columns = sorted(dict.fromkeys(map(column, checks)), key=lambda c: _place(c, names))
    lines: dict[tuple[str, str], dict[tuple[str, ...], list[Check]]] = {}
    for c in checks:
        lines.setdefault((c.level, quantity(c)), {}).setdefault(column(c), []).append(c)
    rows = (
        Line(level=level, quantity=name, cells=tuple(_cell(of[k]) if k in of else None for k in columns))
        for (level, name), of in lines.items()
    )
    return Matrix(title=title, columns=tuple(columns), rows=tuple(rows))


def _place(column: tuple[str, ...], names: list[str]) -> int:
    """Single codes stand in the order in which they ran; pairs stay as they come, those that do not exist last."""
    if len(column) > 1:
        return 0 if column[0] in names else 1
    return names.index(column[0])


def _cell(checks: Sequence[Check]) -> Cell:
    worst = max(checks, key=lambda c: SEVERITY[c.verdict])
    same = sum(c.verdict == worst.verdict for c in checks)
    many = f"{same} of {len(checks)}" if len(checks) > 1 else ""
    return Cell(verdict=worst.verdict, note=", ".join(w for w in (many, _size(worst)) if w))


def _size(check: Check) -> str:
    """Write the deviation beside its tolerance: "2e-10 ≤ 1e-06, of 10 samples"; "" if it was not computed.

    Of statistics beside the margin and what chance alone gives, as neither is a limit of what was measured.
    """
    if check.deviation is None:
        return ""
    if check.chance is not None:
        margin = "" if check.tolerance is None else f", margin {text(check.tolerance)}"
        return f"{text(check.deviation)}; chance {text(check.chance)}{margin}"
    if check.tolerance is None:
        return text(check.deviation)
    sign = "≤" if check.deviation <= check.tolerance else ">"
    samples = "" if check.samples is None else f", of {check.samples} sample{'s' if check.samples != 1 else ''}"
    return f"{text(check.deviation)} {sign} {text(check.tolerance)}{samples}"
