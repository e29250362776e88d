"""Small figures, one a quantity, which stand side by side on a wide screen and below each other on a narrow one."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping

from harness.report import figures
from harness.report.bands import Band
from harness.report.page import Figure

WIDTH, HEIGHT, DPI = 4.4, 3.1, 140
"""Inches, and pixels an inch: sharp at three panels across a wide page."""

LABEL = 34
"""Characters of a label that stand beside an axis of this height."""

BAND = "A band is the mean over an engine's runs +- its standard error s/√n"


def panel(draw: Callable[..., None], caption: str) -> Figure:
    """Return what `draw` draws on axes it is given, with a legend if anything is named there."""
    figure, ((axes,),) = figures.new_figure(1, 1, width=WIDTH, height=HEIGHT)
    draw(axes)
    axes.set_ylabel("\n".join(textwrap.wrap(axes.get_ylabel(), LABEL)))
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=8)
    return Figure(uri=figures.png_uri(figure, dpi=DPI), caption=caption, panel=True)


def draw_bands(
    axes, bands: Mapping[str, Band], *, x: str, y: str, scale: tuple[float, float] = (1.0, 1.0), marker: str = ""
) -> None:
    """Draw every engine's mean, and its error where there is one. scale: of places and of values.

    marker: shows the places, where they are few.
    """
    for engine, b in bands.items():
        style = figures.line_style(engine)
        place, mean = scale[0] * b.place, scale[1] * b.mean
        axes.plot(place, mean, marker=marker, ms=3, **style)
        if b.error is not None:
            error = scale[1] * b.error
            axes.fill_between(place, mean - error, mean + error, color=style["color"], alpha=0.2, lw=0)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(alpha=0.3)


def counted(bands: Mapping[str, Band]) -> str:
    """Say what bands are of: one packing, several, or of some engines fewer."""
    counts = {b.count for b in bands.values()}
    if counts == {1}:
        return "One packing, hence no bands."
    few, most = min(counts), max(counts)
    return f"{BAND}, n = {most}." if few == most else f"{BAND}, n = {few} to {most}; a single curve has none."
