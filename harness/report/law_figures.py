"""Figures of the laws study: the matrices as colours, and the laws as curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.registry import KERNEL_PREFIX
from harness.report import figures

if TYPE_CHECKING:
    from harness.studies.laws import LawsResult
    from harness.studies.laws.curves import Curve
    from harness.studies.laws.matrix import Cell

WORST, BEST = 1e-9, 1e-17
"""Ends of the colour scale; exact equality is drawn as the best."""

COLUMNS = 4
"""Panels beside each other."""

LOOKS = {
    "lammps": ("#1b6ca8", "-"), "liggghts": ("#c8553d", "--"), "kernel:lammps": ("#1b6ca8", ":"),
    "kernel:liggghts": ("#c8553d", ":"), "kernel:talk": ("#222222", "-."),
}
"""Colour by convention, solid or dashed for codes, dotted for kernels."""


def draw_matrix(result: LawsResult):
    """Return a figure with the matrix of prescribed motion and, beside it, that of collisions."""
    codes = [e for e in result.engines if not e.startswith(KERNEL_PREFIX)]
    names = [each.name for each in result.laws]
    widths = [len(result.engines), max(len(codes), 1)]
    figure, axes = figures.new_figure(1, 2, width=3.2 + 1.15 * sum(widths), height=1.7 + 0.27 * len(names))
    axes[0, 0].get_gridspec().set_width_ratios(widths)
    _draw_cells(axes[0, 0], result.prescribed, names, result.engines)
    axes[0, 0].set_title("prescribed motion", fontsize=9)
    axes[0, 0].set_yticks(range(len(names)), names, fontsize=7)
    if codes:
        _draw_cells(axes[0, 1], result.collisions, names, codes)
        axes[0, 1].set_title("collisions", fontsize=9)
        axes[0, 1].set_yticks([])
    else:
        axes[0, 1].axis("off")
    return figure


def _draw_cells(axes, cells: Sequence[Cell], names: Sequence[str], engines: Sequence[str]) -> None:
    shown = [c for c in cells if c.engine in engines]
    size = np.full((len(names), len(engines)), np.nan)
    for c in shown:
        row, column = names.index(c.laws), list(engines).index(c.engine)
        if c.deviation is not None and np.isfinite(c.deviation):
            size[row, column] = np.log10(np.clip(c.deviation, BEST, WORST))
        axes.text(column, row, c.text, ha="center", va="center", fontsize=6.5,
                  color="#c62828" if c.differs else "#1c1c1c" if c.deviation is not None else "#8250df")
    picture = np.ma.masked_invalid(size)
    axes.imshow(picture, aspect="auto", cmap="YlOrRd", vmin=np.log10(BEST), vmax=np.log10(WORST), alpha=0.75)
    axes.set_xticks(range(len(engines)), [e.replace(":", ":\n") for e in engines], fontsize=7)
    axes.set_xticks(np.arange(len(engines)) - 0.5, minor=True)
    axes.set_yticks(np.arange(len(names)) - 0.5, minor=True)
    axes.grid(which="minor", color="white", lw=1.2)
    axes.tick_params(which="both", length=0)


def draw_curves_page(result: LawsResult):
    """Return a figure with one panel a law: the normal ones, then the sliding ones; None without runs."""
    panels = _panels(result)
    if not panels:
        return None
    rows = -(-len(panels) // COLUMNS)
    figure, axes = figures.new_figure(rows, COLUMNS, width=13.0, height=2.5 * rows)
    for a, (laws, motion, curves) in zip(axes.flat, panels, strict=False):
        _draw_panel(a, laws, motion, curves)
    for a in axes.flat[len(panels):]:
        a.axis("off")
    lines = {line.get_label(): line for a in axes.flat for line in a.lines if not line.get_label().startswith("_")}
    axes.flat[0].legend(lines.values(), lines.keys(), fontsize=6)
    return figure


def _panels(result: LawsResult) -> list[tuple[str, str, list[Curve]]]:
    """Frictionless combinations under load, and those with sliding alone in shear: the others repeat them."""
    load = [each.name for each in result.laws if each.sliding is each.rolling is each.torsion is None]
    shear = [each.name for each in result.laws if each.sliding is not None and each.rolling is each.torsion is None]
    wanted = [(name, "load") for name in load] + [(name, "shear") for name in shear]
    found = [(n, m, [c for c in result.curves if c.laws == n and c.motion == m]) for n, m in wanted]
    return [(n, m, curves) for n, m, curves in found if curves]


def _draw_panel(axes, laws: str, motion: str, curves: Sequence[Curve]) -> None:
    drawn = {c.engine for c in curves}
    for curve in curves:
        if not (curve.engine.startswith(KERNEL_PREFIX) and curve.engine.removeprefix(KERNEL_PREFIX) in drawn):
            colour, line = LOOKS.get(curve.engine, ("#555555", "-"))
            axes.plot(1e6 * curve.place, curve.force, color=colour, ls=line, lw=1.0, label=curve.engine)
    axes.axhline(0.0, color="#bbbbbb", lw=0.6)
    axes.set_title(laws, fontsize=8)
    axes.set_xlabel("overlap (μm)" if motion == "load" else "slip (μm)", fontsize=7)
    axes.set_ylabel("f_n (N)" if motion == "load" else "f_t (N)", fontsize=7)
    axes.tick_params(labelsize=6)
