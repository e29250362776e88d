"""The picture of the gauntlet: how each case ended on each code, and how much of its tolerance it used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report.figures import line_style
from harness.report.stability_tables import nearest_limit

if TYPE_CHECKING:
    from harness.studies.stability.study import Stability

FILLS = {
    "stable": "#bfe3c8", "refused": "#cfe0f3", "degraded": "#f6dd8f", "failed_loudly": "#f2b06b",
    "failed_silently": "#d9534f", "unsupported": "#e6e6e6", "unavailable": "#ffffff",
}
MARKS = {
    "stable": "stable", "refused": "refused", "degraded": "degraded", "failed_loudly": "stopped, said why",
    "failed_silently": "SILENT", "unsupported": "unsupported", "unavailable": "not here",
}
SMALLEST = 1e-6
"""Share of a tolerance below which points are drawn at the edge."""

CAPTION = (
    "Left: how each case ended on each code; a frame marks what is not as declared. Right: the invariant that used "
    "most of its tolerance, on a logarithmic scale; beyond 1 it is broken. Cases without a point have no tolerance "
    "above 0, or did not run to their end."
)


def stability_figure(stability: Stability):
    """Return the figure."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.5, 1.6 + 0.21 * len(stability.cases)), layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1.15, 1.0))
    _draw_endings(left, stability)
    _draw_shares(right, stability)
    return figure


def _draw_endings(axes, stability: Stability) -> None:
    from matplotlib.patches import Rectangle

    for row, case in enumerate(stability.cases):
        for column, engine in enumerate(stability.engines):
            result = stability.of(case.name, engine)
            edge = "white" if result.as_declared and not result.kernel_failed_silently else "#1c1c1c"
            place = (column + 0.03, row - 0.44)
            axes.add_patch(Rectangle(place, 0.94, 0.88, facecolor=FILLS[result.ended], edgecolor=edge, lw=1.5))
            axes.text(column + 0.5, row, MARKS[result.ended], ha="center", va="center", fontsize=7)
    axes.set_xlim(0, len(stability.engines))
    axes.set_ylim(len(stability.cases) - 0.4, -0.6)
    axes.set_yticks(range(len(stability.cases)), [c.name for c in stability.cases], fontsize=7.5)
    axes.set_xticks([k + 0.5 for k in range(len(stability.engines))], stability.engines)
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)


def _draw_shares(axes, stability: Stability) -> None:
    marks = dict(zip(stability.engines, "osD^v<>*", strict=False))
    for engine in stability.engines:
        points = [(row, _share(stability, c.name, engine)) for row, c in enumerate(stability.cases)]
        known = [(row, max(share, SMALLEST)) for row, share in points if share is not None]
        axes.plot([s for _, s in known], [r for r, _ in known], marks.get(engine, "o"), ms=5, alpha=0.75,
                  color=line_style(engine)["color"], label=engine)
    axes.set_xscale("log")
    axes.axvline(1.0, color="#b3201c", lw=1.0)
    axes.set_xlim(SMALLEST / 2, None)
    axes.grid(axis="both", color="#e4e4e4", lw=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel("largest invariant over its tolerance")
    axes.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=len(stability.engines), frameon=False)


def _share(stability: Stability, case: str, engine: str) -> float | None:
    near = nearest_limit(stability.of(case, engine).held)
    return None if near is None else near.size / near.tolerance
