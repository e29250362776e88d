"""The picture of the bench report."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.report.figures import new_figure
from harness.studies.bench.statistics import ratio

if TYPE_CHECKING:
    from harness.studies.bench.study import Bench, Cell

COLOURS = ("#3fa34d", "#8e5ea2", "#1b6ca8", "#7fb2d9", "#c8553d", "#555555")
"""In the order of the codes, the kernel first."""

MOST_COLUMNS = 5


def bench_figure(bench: Bench):
    """Return the figure: one column a case with several sizes; None when there is none."""
    sizes: dict[str, list[Cell]] = {}
    for cell in bench.cells:
        sizes.setdefault(cell.case.name, []).append(cell)
    several = {name: cells for name, cells in sizes.items() if len(cells) > 1}
    chosen = sorted(several, key=lambda name: -len(several[name]))[:MOST_COLUMNS]
    if not chosen:
        return None
    figure, axes = new_figure(2, len(chosen), width=1.0 + 3.4 * len(chosen), height=6.4)
    for column, name in enumerate(n for n in several if n in chosen):
        draw_times(axes[0, column], bench, several[name])
        draw_ratios(axes[1, column], bench, several[name])
        axes[0, column].set_title(name, fontsize=10)
    axes[0, 0].set_ylabel("CPU time per step (us)")
    axes[1, 0].set_ylabel("kernel / code")
    axes[0, 0].legend(fontsize=7)
    return figure


def draw_times(axes, bench: Bench, cells: list[Cell]) -> None:
    """Draw the median time per step of every code, log-log."""
    for label, colour in _looks(bench):
        timed = [c for c in cells if label in c.tracks and len(c.tracks[label].seconds)]
        medians = [1e6 * float(np.median(c.tracks[label].seconds)) for c in timed]
        axes.plot([c.count for c in timed], medians, marker=".", lw=1.2, color=colour, label=label)
    _logarithmic(axes)


def draw_ratios(axes, bench: Bench, cells: list[Cell]) -> None:
    """Draw the kernel's time over that of every other code: median, and the range as a bar."""
    for label, colour in _looks(bench)[1:]:
        found = [(c.count, ratio(c.tracks[bench.kernel].seconds, c.tracks[label].seconds))
                 for c in cells if label in c.tracks]
        points = [(n, *s) for n, s in found if s is not None]
        if points:
            n, median, low, high = np.array(points).T
            axes.errorbar(n, median, yerr=[median - low, high - median], marker=".", lw=1.2, capsize=2, color=colour)
    axes.axhline(1.0, color="#444444", lw=0.8)
    axes.set_xlabel("N")
    _logarithmic(axes)


def _logarithmic(axes) -> None:
    """Make both axes logarithmic, with plain numbers at 1, 2 and 5 of every decade."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(NullLocator())
    axes.tick_params(labelsize=7)
    axes.tick_params(axis="x", rotation=45)
    axes.grid(alpha=0.3)


def _looks(bench: Bench) -> list[tuple[str, str]]:
    labels = (bench.kernel, *bench.others)
    return [(label, COLOURS[k % len(COLOURS)]) for k, label in enumerate(labels)]
