"""What is judged over replicates, as a table: both sides with error bars, what is seen, what could have been."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from harness.report.page import Section

if TYPE_CHECKING:
    from harness.studies.statistics.family import Judged


def replicate_rows(judged: Sequence[Judged]) -> list[dict]:
    """One row a quantity and pair; differences are parts of the scale."""
    return [_row(j) for j in judged]


def _row(j: Judged) -> dict:
    t, d = j.tested, j.tested.difference
    m, pair = t.measured, t.pair
    return {
        "verdict": j.verdict, "quantity": m.quantity, "unit": m.unit, "left": pair.left, "right": pair.right,
        "left, mean": t.left[0], "left, standard error": t.left[1], "right, mean": t.right[0],
        "right, standard error": t.right[1], "left, error of one run": m.run_error(pair.left),
        "right, error of one run": m.run_error(pair.right), "replicates": d.count,
        "design": "paired" if d.paired else "independent", "scale": t.scale, "difference": j.relative,
        "standard error": j.error, "degrees of freedom": d.dof, "p": t.p, "p, adjusted": j.adjusted,
        "by chance": j.chance, "resolvable": j.resolvable, "p of equivalence": j.equivalence,
        "margin": j.terms.margin, "replicates to settle": j.settle,
    }


PAGE = (
    "verdict", "quantity", "unit", "left", "right", "left, mean", "left, standard error", "right, mean",
    "right, standard error", "replicates", "difference", "standard error", "p, adjusted", "resolvable",
    "p of equivalence", "replicates to settle",
)
"""Columns on the page; all are in the CSV table."""


def replicate_sections(judged: Sequence[Judged]) -> list[Section]:
    """Return the section of the page; none without replicates."""
    if not judged:
        return []
    rows = [{name: row[name] for name in PAGE} for row in replicate_rows(judged)]
    return [Section(heading="Over replicates: differences with error bars", note=_note(judged), rows=rows)]


def _note(judged: Sequence[Judged]) -> str:
    terms, paired = judged[0].terms, judged[0].tested.difference.paired
    design = (
        "Both sides start from the same packings, so differences are taken packing by packing: what a packing does to "
        "both alike cancels, and their errors are smaller than those of the sides. "
        if paired else "All start from one packing, kicked, so the two sides are independent. "
    )
    return (
        f"Difference, its standard error and what is resolvable are parts of the quantity (of a volume strain: of the "
        f"axial strain). {design}"
        f"If all codes were equal, one false alarm or more among these {len(judged)} checks would come with a "
        f"probability of {terms.false_alarms:g} at most (Holm's adjusted p). Resolvable: the true difference that this "
        f"number of replicates sees with a probability of 0.8. Equivalence: the difference is shown to be smaller than "
        f"the margin of {100 * terms.margin:g} % where its p is below {terms.false_alarms:g}; that none was seen shows "
        f"nothing by itself. Published values are judged each by its own prediction interval."
    )
