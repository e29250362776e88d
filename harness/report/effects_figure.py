"""The picture of the effects report: what every switch costs in time, and what it changes in the answer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.report.figures import new_figure
from harness.studies.effects.variants import BASE

if TYPE_CHECKING:
    from harness.studies.effects.study import EffectsStudy

COLOURS = ("#1b6ca8", "#c8553d", "#3fa34d", "#8e5ea2", "#b8860b", "#2f4f4f")
MARKERS = ("o", "s", "^", "D", "v", "P")
GONE = "gone"

CAPTION = (
    "Left: time of a whole run with one effect switched, over that of the scene as declared (vertical line), on every "
    "engine; bars: least and largest over stretches in which all took turns. Right: change of the chosen quantities "
    "over the tolerance (grey: within it)"
)
SPREAD = (
    "; bars: two standard errors of the change; the number: how many error bars of the scene as declared, the scatter "
    "of one packing, the change is"
)
SCALE = (
    ". A cross: the quantity is gone. Changes of up to two tolerances lie on a linear scale, larger ones on a "
    "logarithmic one. Above the line effects that the scene has, below it those that it does not have."
)


def caption(study: EffectsStudy) -> str:
    """Return what the figure shows."""
    return f"{CAPTION}{SPREAD if any(c.in_bars is not None for c in study.chosen) else ''}{SCALE}"


def effects_figure(study: EffectsStudy):
    """Return the figure."""
    rows = [v for v in study.variants if v.scene is not None]
    rows.sort(key=lambda v: v.effect.on)
    figure, axes = new_figure(1, 2, width=12.0, height=1.8 + 0.42 * max(len(rows), 3))
    _times(axes[0, 0], study, rows)
    _changes(axes[0, 1], study, rows)
    split = sum(not v.effect.on for v in rows) - 0.5
    for ax in axes[0]:
        ax.set_yticks(range(len(rows)), [v.name for v in rows], fontsize=9)
        ax.set_ylim(-0.6, max(len(rows), 1) - 0.4)
        ax.axhline(split, color="#777777", lw=0.8)
        ax.grid(alpha=0.25, axis="x")
        ax.tick_params(axis="x", labelsize=8)
    axes[0, 1].set_yticklabels([])
    return figure


def _times(axes, study: EffectsStudy, rows: list) -> None:
    engines = [e for e, name in study.costs if name == BASE]
    for number, engine in enumerate(engines):
        y, x, low, high = [], [], [], []
        for row, v in enumerate(rows):
            ratio, cost = study.whole_ratio(engine, v.name), study.costs.get((engine, v.name))
            if ratio is not None:
                y.append(row + 0.18 * (number - (len(engines) - 1) / 2))
                x.append(ratio)
                low.append(max(0.0, ratio - ratio * cost.range[0] / cost.ratio))
                high.append(max(0.0, ratio * cost.range[1] / cost.ratio - ratio))
        axes.errorbar(x, y, xerr=np.array([low, high]) if x else None, fmt=MARKERS[number % len(MARKERS)], ms=5,
                      elinewidth=0.8, capsize=1.5, color=COLOURS[number % len(COLOURS)], label=engine)
    axes.axvline(1.0, color="#333333", lw=0.9)
    axes.set_xlabel("time of a whole run over the scene as declared")
    axes.legend(fontsize=8, loc="best")


def _changes(axes, study: EffectsStudy, rows: list) -> None:
    tolerance = study.asked.tolerance
    axes.axvspan(-1.0, 1.0, color="#999999", alpha=0.18, lw=0)
    for number, quantity in enumerate(study.asked.quantities):
        colour, offset = COLOURS[number % len(COLOURS)], 0.2 * (number - (len(study.asked.quantities) - 1) / 2)
        found = {c.variant: c for c in study.chosen if c.quantity == quantity}
        drawn = [(row, c) for row, v in enumerate(rows) if (c := found.get(v.name)) is not None]
        told = [(row, c) for row, c in drawn if c.relative is not None]
        axes.errorbar(
            [c.relative / tolerance for _, c in told], [row + offset for row, _ in told],
            xerr=[2.0 * (c.error or 0.0) / tolerance for _, c in told] if told else None, ms=5, elinewidth=0.8,
            capsize=1.5, fmt=MARKERS[number % len(MARKERS)], color=colour, label=quantity,
        )
        for row, c in told:
            if c.in_bars is not None:
                axes.annotate(f"{c.in_bars:+.2g}", (c.relative / tolerance, row + offset), textcoords="offset points",
                              xytext=(0, 4), ha="center", fontsize=6.5, color=colour)
        gone = [row + offset for row, c in drawn if c.relative is None]
        axes.plot([0.97] * len(gone), gone, "x", ms=7, mew=1.8, color=colour, transform=axes.get_yaxis_transform())
    axes.set_xscale("symlog", linthresh=2.0)
    axes.axvline(0.0, color="#333333", lw=0.9)
    axes.set_xlabel(f"change over the tolerance of {100.0 * tolerance:g} %")
    axes.legend(fontsize=8, loc="best")
