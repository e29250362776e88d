"""Published values beside ours: the spread over packings decides, and only values seen in their source.

One published number is one realisation of a random packing. With n of ours, mean m and standard
deviation s, the next packing falls with 95 % probability into the prediction interval
m +- t(0.975, n - 1) s sqrt(1 + 1/n) (Student's t); a published value outside of it differs.
"""

from __future__ import annotations

import numpy as np

from harness.scene.model import Biaxial
from harness.studies.verdict import Check
from reference.values import Published, published_values

FEWEST = 3
"""Packings below which a spread means nothing."""

Macro = dict[tuple[str, int], dict[str, float]]


def published_checks(scene: Biaxial, macro: Macro) -> list[Check]:
    """Compare each engine's values over all packings with what the scene names as published (L3)."""
    values = published_values()
    engines = dict.fromkeys(engine for engine, _ in macro)
    return [_check(values[name], engine, macro) for name in scene.compare.published for engine in engines]


def _check(published: Published, engine: str, macro: Macro) -> Check:
    ours = np.array([v[published.quantity] for (e, _), v in macro.items() if e == engine])
    facts = {"level": "L3", "quantity": f"{published.quantity} against {published.value:g} {published.unit}",
             "left": engine, "right": published.origin}
    if len(ours) < FEWEST:
        return Check(**facts, deviation=_relative(ours.mean(), published), tolerance=None, verdict="inconclusive",
                     why=f"{len(ours)} packing(s); a spread needs {FEWEST}: --packings {FEWEST}")
    half = prediction_half_width(ours)
    text = f"ours {ours.mean():.4g} +- {ours.std(ddof=1):.2g} {published.unit} over {len(ours)} packings"
    if not published.decides:
        return Check(**facts, deviation=_relative(ours.mean(), published), tolerance=half / published.value,
                     verdict="inconclusive", why=f"{text}; the published value is recalled, not seen: no verdict")
    outside = abs(ours.mean() - published.value) > half
    return Check(**facts, deviation=_relative(ours.mean(), published), tolerance=half / published.value,
                 verdict="known_difference" if outside and published.known_difference
                 else "differs" if outside else "agrees",
                 why=text + (f"; {published.known_difference}" if outside and published.known_difference else ""))


def prediction_half_width(values: np.ndarray, confidence: float = 0.95) -> float:
    """Return t(1/2 + confidence/2, n - 1) s sqrt(1 + 1/n) for n >= 2 values."""
    from scipy.stats import t

    n = len(values)
    return float(t.ppf(0.5 + confidence / 2.0, n - 1) * values.std(ddof=1) * np.sqrt(1.0 + 1.0 / n))


def _relative(value: float, published: Published) -> float:
    return float(abs(value - published.value) / abs(published.value))
