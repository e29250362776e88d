"""The torque history of both rings, over all packings, and how the runs of the first part."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.report import figures
from harness.report.bands import Band, band_over
from harness.report.page import Figure
from harness.report.panels import counted, draw_bands, panel
from harness.report.wall_bands import band_rows
from harness.studies.compare.ring_curves import RingCurves, ring_curves

if TYPE_CHECKING:
    from harness.studies.compare.study import Comparison

SMOOTHED = 100
"""Parts of a run that the torque history is averaged over: single samples hide the mean behind their scatter."""

INNER, OUTER = "inner_torque", "outer_torque"

RINGS = {INNER: (-1.0, "−T on the inner ring"), OUTER: (1.0, "T on the outer ring")}
"""Attribute of the curves: sign it is drawn with, what it is."""


def torque_panels(comparison: Comparison) -> tuple[Figure, ...]:
    """Torque history of both rings, with bands over packings, and how runs of the first packing part."""
    bands = torque_bands(comparison)
    history = tuple(
        panel(lambda axes, q=q: draw_torque(axes, comparison, q, bands[q]), _caption(what, bands[q]))
        for q, (_, what) in RINGS.items()
    )
    if not comparison.result.growth:
        return history
    parting = panel(
        lambda axes: figures.draw_signal_deviation(axes, comparison, left=_first_time(comparison)),
        "How far the torques on the inner ring differ, over the rms torque; grey: declared tolerances.",
    )
    growth = panel(
        lambda axes: figures.draw_growth(axes, comparison.result.growth), "How positions part, from identical numbers."
    )
    return (*history, parting, growth)


def _caption(what: str, bands: dict[str, Band]) -> str:
    return f"{what}, means over {1 / SMOOTHED:.0%} of the run; grey: what is averaged over. {counted(bands)}"


def _first_time(comparison: Comparison) -> float:
    return float(next(iter(comparison.result.curves.values())).time[1])


def torque_bands(comparison: Comparison) -> dict[str, dict[str, Band]]:
    """Return attribute of the curves -> engine -> band over time (s), N m, of means over a hundredth of the run."""
    found: dict[str, list[RingCurves]] = {e: [] for e in comparison.result.curves}
    for r in comparison.completed:
        found.setdefault(r.engine, []).append(ring_curves(r.trajectory))
    return {
        q: {e: band_over([_parts(c.time) for c in of], [_parts(getattr(c, q)) for c in of]) for e, of in found.items()}
        for q in RINGS
    }


def torque_band_rows(comparison: Comparison) -> list[dict]:
    """One row an engine and part of the run: mean torque over the engine's runs and its standard error."""
    return band_rows(torque_bands(comparison), dict.fromkeys(RINGS, "N m"), "time (s)")


def _parts(samples: np.ndarray) -> np.ndarray:
    """Return the means over SMOOTHED parts of a run, or a few more; what is left at the end is left out."""
    size = max(1, len(samples) // SMOOTHED)
    return samples[: len(samples) // size * size].reshape(-1, size).mean(axis=1)


def draw_torque(axes, comparison: Comparison, quantity: str, bands: dict[str, Band]) -> None:
    """Draw the torque on a ring against time, in mN m."""
    sign, _ = RINGS[quantity]
    draw_bands(
        axes, bands, x="time (s)", y=f"{'−' if sign < 0 else ''}torque (mN m)", scale=(1.0, 1e3 * sign)
    )
    axes.axvspan(comparison.scene.compare.steady_from, comparison.scene.duration, color="#888888", alpha=0.12, lw=0)
