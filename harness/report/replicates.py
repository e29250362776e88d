"""What is judged over replicates, as a table: both sides with error bars, what is seen, what could have been."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from harness.report.page import Section
from harness.studies.statistics.family import replicates_in_words

if TYPE_CHECKING:
    from harness.studies.statistics.family import Judged, Replicates, Terms


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
        "design": t.design, "scale": t.scale, "difference": j.relative,
        "standard error": j.error, "degrees of freedom": d.dof, "p": t.p, "p, adjusted": j.adjusted,
        "by chance": j.chance, "margin": j.terms.margin, "resolvable": j.resolvable,
        "p of equivalence, adjusted": j.equivalence,
        **{f"replicates to settle{which}": n for which, n in _needed(j.settle).items()},
    }


def _needed(settle: Replicates | None) -> dict[str, int | None]:
    return {"": settle and settle.count, ", from": settle and settle.low, ", to": settle and settle.high}


PAGE = (
    "verdict", "quantity", "unit", "left", "right", "left, mean", "left, standard error", "right, mean",
    "right, standard error", "replicates", "difference", "standard error", "by chance", "margin", "p, adjusted",
    "p of equivalence, adjusted", "resolvable",
)
"""Columns on the page, which adds the replicates that would settle it in words; all are in the CSV table."""


def replicate_sections(judged: Sequence[Judged], looks: Sequence[int] = ()) -> list[Section]:
    """Return the section of the page; none without replicates."""
    if not judged:
        return []
    return [Section(
        heading="Over replicates: differences with error bars", note=_note(judged, looks),
        rows=replicate_page_rows(judged),
    )]


def replicate_page_rows(judged: Sequence[Judged]) -> list[dict]:
    """The same for people."""
    return [
        {**{name: row[name] for name in PAGE}, "would settle it": _settling(j)}
        for row, j in zip(replicate_rows(judged), judged, strict=True)
    ]


def _settling(j: Judged) -> str | None:
    return replicates_in_words(j).rstrip(",") if j.settle else None


def _note(judged: Sequence[Judged], looks: Sequence[int]) -> str:
    terms, paired = judged[0].terms, judged[0].tested.difference.paired
    design = (
        "Both sides start from the same packings, so differences are taken packing by packing: what a packing does to "
        "both alike cancels, and their errors are smaller than those of the sides. "
        if paired else "All start from one packing, kicked, so the two sides are independent. "
    )
    return (
        f"Difference, its standard error and what is resolvable are parts of the quantity (of a volume strain: of the "
        f"axial strain). {design}{error_rates(terms, len(judged))} Resolvable: the true difference that this number of "
        f"replicates sees with a probability of 0.8. Published values are judged each by its own prediction "
        f"interval.\n{looking_again(terms, looks)}"
    )


def error_rates(terms: Terms, checks: int, *, rate: str = "") -> str:
    """Say how often differences and agreements are false, among how many checks.

    rate: what is said of differences, if others share the rate with these checks.
    """
    alone = checks * terms.false_alarms
    alarms = rate or (
        f"If all codes were equal, one false alarm or more among these {checks} checks would come with a probability "
        f"of {terms.false_alarms:g} at most (Holm's adjusted p)"
    )
    return (
        f"{alarms}; by chance: the difference that equal codes show at that rate. Equivalence: the difference is shown "
        f"to be smaller than the margin of {100 * terms.margin:g} % "
        f"where its p, adjusted in the same way, is {terms.false_alarms:g} or less, so that with a probability of "
        f"{1 - terms.false_alarms:g} or more none of the checks that agree is wrong. (Each at {terms.false_alarms:g} "
        f"for itself, up to {alone:.2g} of {checks} could falsely agree.) That no difference was seen shows nothing by "
        f"itself."
    )


def looking_again(terms: Terms, looks: Sequence[int]) -> str:
    """Say which look this is, and what a further one costs. looks: numbers of replicates, this one last."""
    before = ", ".join(map(str, looks[:-1]))
    this = (
        f"This is look {len(looks)} at this comparison, at {looks[-1]} replicates after {before}: the declared rate is "
        f"halved for each further one, to {terms.false_alarms:g} now. "
        if before else "This is the first look at this comparison. "
    )
    return (
        f"{this}Who adds replicates until something passes looks several times; halving keeps all looks together below "
        f"twice the declared rate, and looks.json beside the runs counts them. The number that would settle a check is "
        f"that of a further look, at {terms.false_alarms / 2:g}, with a probability of 0.8 if the difference is as it "
        f"was found; in brackets the same for the scatter at the ends of its 90 % interval, as few replicates know it "
        f"badly."
    )
