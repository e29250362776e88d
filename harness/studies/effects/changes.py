"""What a switch changes in an answer, with its error, in units of the error bar, against a tolerance.

Variants start from the same packings, so their changes are paired (`harness.studies.statistics.difference`)::

    change = mean over packings of (variant - as declared)/scale, error of it s/sqrt(n); scale: the mean as declared
    in bars = change/bar, bar = spread over packings of the scene as declared/scale (a standard deviation)

From one packing a time average has the standard errors of both runs, in quadrature, and its own as the bar. What is a
deviation from the scene as declared (`quantities.DEVIATIONS`) has no spread there, and so no bar; of a free scene it is
exact.

    agrees        the change is shown to be smaller than the tolerance (equivalence, one-sided level 5 %)
    differs       it is shown to be larger, or the quantity is gone
    inconclusive  neither; so many packings would be expected to tell, were the change the one that was measured
    not_checked   a run of the switched scene failed
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.studies.effects.quantities import DEVIATIONS
from harness.studies.effects.variants import BASE
from harness.studies.statistics.difference import FEWEST, Difference, half_width, paired_difference
from harness.studies.statistics.family import Measured
from harness.studies.statistics.power import equivalence_p, replicates_to_equate, replicates_to_exceed
from harness.studies.verdict import Verdict

LEVEL = 0.05
MANY = 1e6
"""Degrees of freedom of an error that is as good as known."""


@dataclass(frozen=True, kw_only=True)
class Change:
    """One quantity of one variant. base, value: means in `unit`, None where there is none.

    relative, error: the change and its standard error over the scale, None where not known; over: what the scale is.
    bar: see the module, relative. packings: how many. needed: packings that would tell, None where that is not known.
    """

    variant: str
    quantity: str
    unit: str
    base: float | None
    value: float | None
    relative: float | None
    error: float | None
    bar: float | None
    verdict: Verdict
    why: str
    packings: int
    over: str = ""
    needed: int | None = None

    @property
    def in_bars(self) -> float | None:
        """The change in units of the error bar; None without a bar."""
        return None if self.relative is None or not self.bar else self.relative / self.bar


def changes_of(
    quantities: Sequence[Measured], variants: Sequence[str], tolerance: float, failed: Mapping[str, str]
) -> list[Change]:
    """Return the change of every quantity by every variant, in this order. failed: why runs did, by variant."""
    return [change_of(m, v, tolerance, failed.get(v, "")) for v in variants for m in quantities if m.of(BASE)]


def change_of(m: Measured, variant: str, tolerance: float, failed: str = "") -> Change:
    """Return the change of one quantity by one variant. failed: why a run of it did, "" if none did."""
    base, values = m.of(BASE), m.of(variant)
    both = sorted(set(base) & set(values))
    facts = {"variant": variant, "quantity": m.quantity, "unit": m.unit, "packings": len(both),
             "base": float(np.mean(list(base.values()))), "over": _over(m)}
    if failed or not both:
        return Change(**facts, value=None, relative=None, error=None, bar=None,
                      verdict="not_checked" if failed else "differs", why=failed or "the quantity is gone")
    a, b = (np.array([of[k] for k in both]) for of in (values, base))
    facts["value"] = float(a.mean())
    signed = _scale(m, base)
    scale = abs(signed)
    if not scale > 0.0:
        return Change(**facts, relative=None, error=None, bar=None, verdict="inconclusive", why="its size is 0")
    found, bar = _difference(m, a, b, variant, both), _bar(m, base)
    numbers = {"relative": float(a.mean() - b.mean()) / signed, "bar": None if bar is None else bar / scale}
    if found is None:
        return Change(**facts, **numbers, error=None, verdict="inconclusive", why="one packing has no error bar")
    gone = f"; gone in {len(base) - len(both)} of {len(base)} packings" if len(both) < len(base) else ""
    verdict, why, needed = judged(found, tolerance * scale)
    return Change(
        **facts, **numbers, error=found.error / scale, verdict="differs" if gone else verdict, why=why + gone,
        needed=needed,
    )


def judged(difference: Difference, margin: float) -> tuple[Verdict, str, int | None]:
    """Return the verdict of a difference against a margin in its unit, why, and the packings that would settle it."""
    if equivalence_p(difference, margin) <= LEVEL:
        return "agrees", "within the tolerance", None
    width = half_width(difference, 2.0 * LEVEL)
    if abs(difference.value) - width > margin or (width == 0.0 and abs(difference.value) >= margin):
        return "differs", "beyond the tolerance", None
    needed, side = _needed(difference, margin)
    more = f"; about {needed} packings would show that it is {side}" if needed else ""
    return "inconclusive", f"these packings cannot tell{more}", needed


def _needed(difference: Difference, margin: float) -> tuple[int | None, str]:
    """Return how many packings would tell, more than there are, and what; None where no scatter is known, or too many.
    """
    small = abs(difference.value) < margin
    if difference.count < FEWEST:
        return None, ""
    found = (replicates_to_equate if small else replicates_to_exceed)(difference, margin, LEVEL)
    return found and max(found, difference.count + 1), "within" if small else "beyond"


def _scale(m: Measured, base: dict[int, float]) -> float:
    """Return what a change is measured by; of a negative quantity its mean, so that a smaller size is a fall."""
    return m.scale if m.scale is not None else float(np.mean(list(base.values())))


def _over(m: Measured) -> str:
    """Say what a change is a part of."""
    if m.quantity in DEVIATIONS:
        return DEVIATIONS[m.quantity]
    if m.scale is None:
        return "its value as declared"
    return f"{'an axial strain of ' * m.quantity.startswith('volume')}{m.scale:g}"


def _difference(
    m: Measured, a: np.ndarray, b: np.ndarray, variant: str, packings: Sequence[int]
) -> Difference | None:
    """Return the mean difference with its error; None where nothing tells an error."""
    if m.quantity in DEVIATIONS and len(a) == 1:
        return Difference(value=float(a[0] - b[0]), error=0.0, dof=MANY, count=1, paired=True)
    if len(a) > 1:
        return paired_difference(a, b)
    own = [m.errors.get(of, {}).get(packings[0], math.nan) for of in (variant, BASE)]
    error = math.hypot(*own)
    if not math.isfinite(error):
        return None
    return Difference(value=float(a[0] - b[0]), error=error, dof=MANY, count=1, paired=True)


def _bar(m: Measured, base: dict[int, float]) -> float | None:
    """Return the error bar of the scene as declared, in the quantity's unit; None where there is none."""
    if m.quantity in DEVIATIONS:
        return None
    if len(base) > 1:
        return float(np.std(list(base.values()), ddof=1))
    return m.run_error(BASE)
