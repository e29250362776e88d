"""The picture of the frontiers: measured against exact limits, and the map, one panel an axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.report.figures import new_figure
from harness.studies.frontier.theory import TOLERANCE

if TYPE_CHECKING:
    from harness.studies.frontier.study import Frontier, Frontiers

COLOURS = {"lammps": "#1b6ca8", "liggghts": "#c8553d", "kernel:lammps": "#3fa34d", "kernel:talk": "#8e5ea2"}
MARKERS = {"lammps": "o", "liggghts": "s", "kernel:lammps": "^", "kernel:talk": "D"}
OTHER = ("#666666", "v")

WIDE, WIDER = 8, 50
"""Ratio of the ends of an axis from which it is logarithmic, and from which its ticks are powers of ten."""

CAPTION = (
    "Largest stable step in units of sqrt(m/k), m the lightest mass, k the largest slope of a normal force. First "
    "panel: how far it is from the exact limit of the packing's stiffness and damping matrices, all laws and "
    f"packings; band: {100 * TOLERANCE:g} per cent. Points are the middles of brackets of less than 1 per cent; "
    "most are found with the same steps around the exact limit, and lie at the same height. Others: the random "
    "packing, one property varied; points measured, line exact, dashed: the formula beyond which scenes are "
    "refused."
)


def frontier_figure(done: Frontiers):
    """Return the figure."""
    axes_of_map = list(dict.fromkeys(f.axis for f in done.found if f.axis))
    columns = 3
    rows = -(-(1 + len(axes_of_map)) // columns)
    figure, axes = new_figure(rows, columns, width=11.5, height=3.6 * rows)
    panels = list(np.atleast_2d(axes).ravel())
    _against(panels[0], done.found)
    for panel, name in zip(panels[1:], axes_of_map, strict=False):
        _along(panel, name, [f for f in done.found if f.axis == name])
    for panel in panels[1 + len(axes_of_map):]:
        panel.set_axis_off()
    return figure


def _against(axes, found: tuple[Frontier, ...]) -> None:
    """Deviation from theory, in per cent, against the exact limit."""
    compared = [f for f in found if f.exact and f.measured]
    ends = np.array([0.8 * min(f.exact / f.unit for f in compared), 1.25 * max(f.exact / f.unit for f in compared)])
    axes.fill_between(ends, -100 * TOLERANCE, 100 * TOLERANCE, color="#999999", alpha=0.25, lw=0)
    axes.axhline(0.0, color="#444444", lw=0.8)
    for engine in dict.fromkeys(f.engine for f in compared):
        points = np.array([
            (f.exact / f.unit, 100 * f.deviation) for f in compared if f.engine == engine and f.deviation is not None
        ])
        if len(points):
            _points(axes, engine, *points.T)
    worst = max([100 * abs(f.deviation) for f in compared if f.deviation is not None], default=0.0)
    limit = max(600 * TOLERANCE / 5, 1.1 * worst)
    axes.set(xscale="log", xlabel="exact limit", ylabel="measured - exact (%)", xlim=ends, ylim=(-limit, limit))
    _dress(axes)


def _along(axes, name: str, found: list[Frontier]) -> None:
    for engine in dict.fromkeys(f.engine for f in found):
        points = np.array([(f.value, f.measured / f.unit) for f in found if f.engine == engine and f.measured])
        if len(points):
            _points(axes, engine, *points.T)
    line = sorted({(f.value, f.exact / f.unit, f.formula / f.unit) for f in found if f.exact})
    if line:
        value, exact, formula = np.array(line).T
        axes.plot(value, exact, color="#444444", lw=0.9, label="exact")
        axes.plot(value, formula, color="#444444", lw=0.9, ls="--", label="formula of scenes")
    _scale(axes, sorted({f.value for f in found}))
    axes.set(xlabel=name, ylabel="largest step")
    if max(f.exact or 0.0 for f in found) > 10 * min(f.exact for f in found if f.exact):
        axes.set_yscale("log")
    else:
        axes.set_ylim(bottom=0.0)
    _dress(axes)


def _scale(axes, values: list[float]) -> None:
    """Logarithmic where values are wide apart; ticks at the values where they are few powers of ten."""
    ratio = values[-1] / values[0]
    if ratio <= WIDE:
        return
    axes.set_xscale("log")
    if ratio <= WIDER:
        axes.set_xticks(values, [f"{v:g}" for v in values])
        axes.minorticks_off()


def _points(axes, engine: str, x, y) -> None:
    colour, marker = COLOURS.get(engine, OTHER[0]), MARKERS.get(engine, OTHER[1])
    axes.plot(x, y, ls="", marker=marker, ms=5, mfc="none", color=colour, label=engine)


def _dress(axes) -> None:
    axes.grid(alpha=0.25)
    axes.tick_params(labelsize=8)
    axes.legend(fontsize=7)
