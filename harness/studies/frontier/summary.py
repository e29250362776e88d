"""What scenes are warned with: for laws of one kind, the smallest measured step over the formula's, by engine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.scene.laws import word
from harness.studies.frontier.theory import felt_late

if TYPE_CHECKING:
    from harness.scene.system import System
    from harness.studies.frontier.study import Frontier, Frontiers

FAMILIES = ("normal", "sliding", "rolling", "torsion")


def scene_rows(done: Frontiers) -> list[dict]:
    """Return a row for each dimension, kind of laws and engine.

    of_formula: the smallest measured step over that of `harness.scene.numerics.particle_limit`, and where it was
    found; of_exact: the smallest one over the exact limit, None where none is known. count: of frontiers behind it.
    Those of a friction spring that is felt late are left out: they are no matter of the formula (`grainproof scene`
    names their own limit).
    """
    groups: dict[tuple, list[Frontier]] = {}
    for f in done.found:
        if f.measured and not felt_late(f.engine, f.system):
            groups.setdefault((f.system.dimension, *laws_of(f.system), f.engine), []).append(f)
    return [_row(key, group) for key, group in sorted(groups.items())]


def laws_of(system: System) -> tuple[str, ...]:
    """Return the words of the laws of all families, "" where there is none."""
    laws = (getattr(system, family) for family in FAMILIES)
    return tuple("" if law is None else word(law) for law in laws)


def _row(key: tuple, group: list[Frontier]) -> dict:
    least = min(group, key=lambda f: f.measured / f.formula)
    exact = [f.measured / f.exact for f in group if f.exact]
    where = f"{least.law}, {least.packing}" + (f", {least.axis} = {least.value:g}" if least.axis else "")
    return {
        "dimension": key[0], **dict(zip(FAMILIES, key[1:-1], strict=True)), "engine": key[-1], "count": len(group),
        "of_formula": least.measured / least.formula, "of_exact": min(exact, default=None), "where": where,
    }
