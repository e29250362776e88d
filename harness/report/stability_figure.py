"""The picture of the gauntlet: how each case ended on each code, and how much of its tolerance it used."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from harness.report.figures import line_style
from harness.report.stability_tables import share

if TYPE_CHECKING:
    from harness.studies.stability.study import Stability

FILLS = {
    "stable": "#bfe3c8", "refused": "#cfe0f3", "degraded": "#f6dd8f", "failed_loudly": "#f2b06b",
    "failed_silently": "#d9534f", "timed_out": "#d7c3ec", "unsupported": "#e6e6e6", "unavailable": "#ffffff",
}
MARKS = {
    "stable": "stable", "refused": "refused", "degraded": "degraded", "failed_loudly": "failed loudly",
    "failed_silently": "FAILED SILENTLY", "timed_out": "timed out", "unsupported": "unsupported",
    "unavailable": "unavailable",
}
SMALLEST = 1e-6
"""Share of a tolerance below which points are drawn at the edge."""

BROKEN_SIDE = 10.0
"""The scale goes so far beyond 1, and beyond the largest finite share, as a factor: there is room for arrows."""

EDGE, BEYOND = 0.985, " beyond every scale"
"""Where arrows stand, as a part of the panel's width, and the name of their line."""

CAPTION = (
    "Left: how each case ended on each code; a frame marks what is not as declared. Right: the invariant that used "
    "most of its tolerance, on a logarithmic scale; beyond 1 it is broken. Of a degraded or silently failed case the "
    "one that broke; an arrow at the right edge where its share is infinite (its tolerance is 0: nothing may pass "
    "through anything, say) or nothing could be measured. Cases without a point hold and have no tolerance above 0, "
    "or did not run to their end."
)


def stability_figure(stability: Stability):
    """Return the figure."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.5, 1.8 + 0.21 * len(stability.cases)), layout="constrained")
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
        points = [(row, share(stability.of(c.name, engine))) for row, c in enumerate(stability.cases)]
        known = [(row, max(s, SMALLEST)) for row, s in points if s is not None and math.isfinite(s)]
        colour = line_style(engine)["color"]
        axes.plot([s for _, s in known], [r for r, _ in known], marks.get(engine, "o"), ms=5, alpha=0.75, color=colour,
                  label=engine)
        beyond = [row for row, s in points if s == math.inf]
        turn = 0.3 * (stability.engines.index(engine) - (len(stability.engines) - 1) / 2)
        axes.plot([EDGE] * len(beyond), [r + turn for r in beyond], ">", ms=7, color=colour, mec="#b3201c", mew=1.0,
                  transform=axes.get_yaxis_transform(), label=f"_{engine}{BEYOND}")
    axes.set_xscale("log")
    axes.axvline(1.0, color="#b3201c", lw=1.0)
    shares = [share(r) or 0.0 for r in stability.results]
    axes.set_xlim(SMALLEST / 2, BROKEN_SIDE * max([1.0, *filter(math.isfinite, shares)]))
    axes.grid(axis="both", color="#e4e4e4", lw=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel("largest invariant over its tolerance")
    axes.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=len(stability.engines), frameon=False)
