"""One picture of a biaxial comparison: what somebody sees who looks at the page for ten seconds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.report import figures

if TYPE_CHECKING:
    from harness.studies.compare.study import Comparison

SHOWN_STRAIN = 0.042
"""Axial strain of the force chains: the third picture of the talk."""


def overview(comparison: Comparison):
    """Return a figure: three curves above, force chains of up to three codes below."""
    runs = _first_runs(comparison)
    figure, axes = figures.new_figure(2, 3, width=13, height=8)
    figures.draw_curves(axes[0, 0], comparison.result.curves, "stress_zz", "σ_zz (N/m)")
    axes[0, 0].legend(fontsize=7)
    figures.draw_curves(axes[0, 1], comparison.result.curves, "volume_strain", "ε_V (compression > 0)")
    if comparison.result.growth:
        figures.draw_signal_deviation(axes[0, 2], comparison)
    else:
        axes[0, 2].axis("off")
    for a, run in zip(axes[1], runs, strict=False):
        _draw_chains(a, run, comparison, runs)
    for a in axes[1, len(runs):]:
        a.axis("off")
    return figure


def _first_runs(comparison: Comparison) -> list:
    """The first packing's runs with contacts, one a code: of the kernel's conventions only the first."""
    recorded = [r for r in comparison.completed if r.packing == 0 and r.trajectory.frames[0].contacts is not None]
    by_code = {r.engine.split(":")[0]: r for r in reversed(recorded)}
    return list(reversed(by_code.values()))[:3]


def _draw_chains(axes, run, comparison: Comparison, runs: list) -> None:
    strain = comparison.result.states[run.engine].strain
    k = int(np.argmin(np.abs(strain - SHOWN_STRAIN)))
    width = figures.typical_force(runs[0].trajectory.frames[k])
    figures.draw_force_chains(axes, run.trajectory.frames[k], full_width=width, view=figures.common_view(runs))
    axes.set_title(f"{run.engine}, ε = {100 * strain[k]:.1f} %", fontsize=9)
