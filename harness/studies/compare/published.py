"""Published values beside ours: the spread over packings decides, and only values seen in their source.

One published number is one realisation of a random packing. With n of ours, mean m and standard
deviation s, the next packing falls with 95 % probability into the prediction interval
m +- t(0.975, n - 1) s sqrt(1 + 1/n) (Student's t); a published value outside of it differs.
(G. J. Hahn, W. Q. Meeker, Statistical Intervals, Wiley 1991, section 4.7.)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from harness.scene.model import Biaxial
from harness.studies.verdict import Check, Rerun, Verdict, not_checked
from reference.values import Published, published_values

FEWEST = 3
"""Packings below which a spread means nothing."""

Macro = Mapping[tuple[str, int], Mapping[str, float]]
"""Quantities by (engine, packing)."""


def published_checks(scene: Biaxial, engines: Sequence[str], macro: Macro, rerun: Rerun) -> list[Check]:
    """Compare each engine's values over all packings with what the scene names as published (L3)."""
    values = [published_values()[name] for name in scene.compare.published]
    return [
        published_check(v, e, [m.get(v.quantity, np.nan) for (of, _), m in macro.items() if of == e], rerun(e))
        for v in values for e in engines
    ]


def published_check(published: Published, engine: str, ours: Sequence[float], rerun: str) -> Check:
    """Judge one engine's values, one a packing."""
    facts = {
        "level": "L3", "quantity": f"{published.quantity} against {published.value:g} {published.unit}",
        "left": engine, "right": published.origin,
    }
    values = np.asarray(ours, dtype=float)
    if not values.size or not np.isfinite(values).all():
        return not_checked(**facts, why=_nothing(values, engine))
    facts["deviation"] = float(abs(values.mean() - published.value) / abs(published.value))
    if len(values) < FEWEST:
        why = f"ours {values.mean():.4g} {published.unit} of {len(values)} packing(s); a spread needs {FEWEST}"
        return Check(**facts, tolerance=None, verdict="inconclusive", why=f"{why}: --packings {FEWEST}")
    half = prediction_half_width(values)
    verdict, note = _verdict(published, outside=bool(abs(values.mean() - published.value) > half), rerun=rerun)
    text = (
        f"ours {values.mean():.4g} {published.unit}, standard deviation {values.std(ddof=1):.2g} over {len(values)} "
        "packings"
    )
    return Check(**facts, tolerance=half / abs(published.value), verdict=verdict, why=text + note)


def prediction_half_width(values: np.ndarray, confidence: float = 0.95) -> float:
    """Return t(1/2 + confidence/2, n - 1) s sqrt(1 + 1/n) for n >= 2 values."""
    from scipy.stats import t

    n = len(values)
    return float(t.ppf(0.5 + confidence / 2.0, n - 1) * values.std(ddof=1) * np.sqrt(1.0 + 1.0 / n))


def _nothing(values: np.ndarray, engine: str) -> str:
    if not values.size:
        return f"no completed run of {engine}"
    return f"not a number in {np.count_nonzero(~np.isfinite(values))} of {len(values)} packings"


def _verdict(published: Published, *, outside: bool, rerun: str) -> tuple[Verdict, str]:
    """Return the verdict, and what is to be said besides our numbers."""
    if not published.decides:
        return "inconclusive", "; the published value is recalled, not seen: no verdict"
    if not outside:
        return "agrees", ""
    if published.known_difference:
        return "known_difference", f"; {published.known_difference}"
    return "differs", f"; rerun: {rerun}"
