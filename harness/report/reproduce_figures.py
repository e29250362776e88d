"""Charts and states of discs of any study, drawn from what it declares."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.report import figures

if TYPE_CHECKING:
    from harness.studies.reproduce.protocol import Chart, DiscPicture, Line, Panel, Picture

LOOKS = {
    "line": {"lw": 1.3}, "fit": {"lw": 1.0, "ls": "--"},
    "points": {"ls": "none", "marker": "o", "ms": 5.5, "mfc": "none"},
    "talk": {"ls": "none", "marker": "*", "ms": 10, "color": "#222222"},
    "steps": {"lw": 1.2, "drawstyle": "steps-mid"},
}
MARKERS = "os^DvP<>"
"""Of one series of points after the other, open, so that points that coincide are seen."""

WIDTH, HEIGHT = 5.6, 4.0
"""Inches of a chart."""

PANEL = 3.6
"""Inches of one state of discs."""


def draw(picture: Picture):
    """Return the figure of a chart or of states of discs."""
    from harness.studies.reproduce.protocol import Chart

    return _chart(picture) if isinstance(picture, Chart) else _discs(picture)


def _chart(chart: Chart):
    figure, ((axes,),) = figures.new_figure(1, 1, width=WIDTH, height=HEIGHT)
    colours = _colours(chart)
    marks = iter(MARKERS * len(chart.lines))
    for line, colour in zip(chart.lines, colours, strict=True):
        _draw_line(axes, line, colour, marker=next(marks) if line.look == "points" else "*")
    axes.set_xlabel(chart.x)
    axes.set_ylabel(chart.y)
    if chart.log_x:
        axes.set_xscale("log")
    if chart.log_y:
        axes.set_yscale("log")
    axes.grid(alpha=0.3)
    if any(line.name for line in chart.lines):
        axes.legend(fontsize=7)
    return figure


def _colours(chart: Chart) -> list[str]:
    """One colour a line: that of its engine where each engine has one, else by its name; a fit as its line before."""
    alone = [line.engine for line in chart.lines if line.engine and line.look != "fit"]
    by_engine = len(set(alone)) == len(alone)
    found, free = [], iter(range(100))
    for line in chart.lines:
        if line.look == "fit" and found:
            found.append(found[-1])
        elif by_engine and line.engine in figures.COLOURS:
            found.append(figures.COLOURS[line.engine])
        else:
            found.append("#222222" if line.look == "talk" else f"C{next(free) % 10}")
    return found


def _draw_line(axes, line: Line, colour: str, *, marker: str) -> None:
    style = {"color": colour, **LOOKS[line.look], "label": line.name or None}
    if style.get("marker"):
        style["marker"] = marker
    if line.error is None or not np.isfinite(line.error).any():
        axes.plot(line.x, line.y, **style)
    elif line.look in ("points", "talk"):
        axes.errorbar(line.x, line.y, yerr=line.error, capsize=2, elinewidth=0.9, **style)
    else:
        axes.plot(line.x, line.y, **style)
        axes.fill_between(line.x, line.y - line.error, line.y + line.error, color=colour, alpha=0.2, lw=0)


def _discs(picture: DiscPicture):
    count = len(picture.panels)
    figure, (row,) = figures.new_figure(1, count, width=PANEL * count + 0.8 * bool(picture.label), height=PANEL + 0.4)
    view = _view(picture)
    limit = picture.limit or max((float(np.nanmax(np.abs(p.colour))) for p in picture.panels if p.colour is not None),
                                 default=1.0) or 1.0
    drawn = None
    for axes, panel in zip(row, picture.panels, strict=True):
        drawn = _draw_panel(axes, panel, picture, limit, view) or drawn
    if drawn is not None and picture.label:
        figure.colorbar(drawn, ax=list(row), shrink=0.8, pad=0.01).set_label(picture.label)
    return figure


def _draw_panel(axes, panel: Panel, picture: DiscPicture, limit: float, view: np.ndarray):
    """Draw one state; return what its colours belong to, None without any."""
    axes.set_title(panel.title, fontsize=9)
    p = panel.frame.particles
    found = None
    if panel.colour is not None:
        found = figures.draw_discs(
            axes, panel.frame, panel.colour, low=-limit if picture.diverging else 0.0, high=limit,
            colours="RdBu_r" if picture.diverging else "magma_r", view=view,
        )
    else:
        figures.box_view(axes, panel.frame, view)
    if panel.arrows is not None:
        x, u = 1e3 * p.vector("x", "y"), 1e3 * picture.arrow_scale * panel.arrows
        axes.quiver(x[:, 0], x[:, 1], u[:, 0], u[:, 1], angles="xy", scale_units="xy", scale=1.0, width=0.0025)
    return found


def _view(picture: DiscPicture) -> np.ndarray:
    """Bounds (2, 2) in m that hold every panel's box, or its discs where it has none."""
    boxes = np.array([_bounds(p.frame) for p in picture.panels])
    margin = 0.01 * float(np.ptp(boxes))
    return np.stack([boxes[..., 0].min(axis=0) - margin, boxes[..., 1].max(axis=0) + margin], axis=1)


def _bounds(frame) -> np.ndarray:
    if frame.box is not None:
        return np.asarray(frame.box)
    x, a = frame.particles.vector("x", "y"), frame.particles["radius"][:, None]
    return np.stack([(x - a).min(axis=0), (x + a).max(axis=0)], axis=1)
