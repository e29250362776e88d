"""The picture of the bulk accuracy report: a column a knob, above error against time, below the quantity itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.report.accuracy_bulk_tables import time_exponent, value_of
from harness.report.accuracy_figure import COLOURS, MARKERS
from harness.report.figures import new_figure
from harness.studies.accuracy.bulk_quantities import BULK
from harness.studies.accuracy.bulk_result import front
from harness.studies.accuracy.result import TARGETS

if TYPE_CHECKING:
    from harness.studies.accuracy.bulk import BulkAccuracy
    from harness.studies.accuracy.bulk_result import Error, Ladder, Rung

BULK_CAPTION = (
    "Above: error of the quantity against CPU time of a whole test, set-up and output left out, a column a knob; bars "
    "are one standard error over packings and of the limit. Filled: stands out of its own error; open: does not, the "
    "bar ends where the error may be. Lines: power laws with the order that the ladder shows. Dark band: scatter of "
    "the mean over packings, below which no knob buys anything; light band: scatter of one packing. Below: the "
    "quantity itself with one standard error, and at the right its limit (cross). Crosses at the top: rungs without an "
    "answer. Pale: steps beyond the scene's stability limit, which `scene` refuses. Last column: all knobs together, "
    "each setting against the limit of all knobs; the front in grey."
)
LEAST = 1e-4
"""Error below which nothing is drawn: floors are far above."""

PALE = 0.35
"""Of what no scene can have."""


def bulk_figure(done: BulkAccuracy):
    """Return the figure."""
    knobs = done.knobs
    figure, axes = new_figure(2, len(knobs) + 1, width=3.4 * (len(knobs) + 1), height=7.0)
    for column, knob in enumerate(knobs):
        ladders = [la for la in done.ladders if la.knob.name == knob]
        _draw_errors(axes[0, column], done, ladders)
        _draw_values(axes[1, column], done, ladders)
        axes[0, column].set_title(knob, fontsize=10)
    _draw_front(axes[0, -1], done)
    _draw_key(axes[1, -1], done)
    axes[0, 0].set_ylabel(f"error of the {_short(done)}")
    unit = _unit(done)
    axes[1, 0].set_ylabel(_short(done) if unit == "1" else f"{_short(done)} ({unit})")
    _share_range([axes[0, k] for k in range(len(knobs) + 1)])
    return figure


def _short(done: BulkAccuracy) -> str:
    return done.quantity.replace("_", " ")


def _unit(done: BulkAccuracy) -> str:
    return next(b.unit for b in BULK[type(done.scene)] if b.name == done.quantity)


def _look(done: BulkAccuracy, engine: str) -> dict:
    number = done.engines.index(engine)
    return {"color": COLOURS[number % len(COLOURS)], "marker": MARKERS[number % len(MARKERS)]}


# --- errors --------------------------------------------------------------------------------------------


def _draw_errors(axes, done: BulkAccuracy, ladders: list[Ladder]) -> None:
    runs_change = ladders[0].knob.words or any(time_exponent(la) is not None for la in ladders)
    for ladder in ladders:
        known = [(r, e) for r, e in ladder.known(done.quantity) if r.seconds is not None and e.most > 0.0]
        for rung, error in known:
            _draw_point(axes, done, ladder.engine, rung, rung.seconds if runs_change else rung.x, error)
        _draw_order(axes, done, ladder, known)
    _bands(axes, done)
    _scales(axes)
    axes.set_xlabel("CPU time of a test (s)" if runs_change else f"{ladders[0].knob.value} (no run changes)")
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=7, loc="lower left")


def _draw_point(axes, done: BulkAccuracy, engine: str, rung: Rung, x: float, error: Error) -> None:
    look, y = _look(done, engine), max(error.size, LEAST)
    bars = np.array([[min(error.bar, 0.9 * y)], [error.most - y if error.most > y else 0.0]])
    axes.errorbar(
        [x], [y], yerr=bars, ms=5, lw=0, elinewidth=0.9, capsize=2, **look,
        markerfacecolor=look["color"] if error.seen else "white", alpha=None if rung.beyond is None else PALE,
    )


def _draw_order(axes, done: BulkAccuracy, ladder: Ladder, known: list[tuple[Rung, Error]]) -> None:
    """Draw the power law through the coarsest rung and name its slope against time."""
    order, price = ladder.orders.get(done.quantity), time_exponent(ladder)
    if order is None or order.error > 0.5 * order.value or price is None or len(known) < 2:
        return
    first, error = known[0]
    x = np.array([r.x for r, _ in known])
    axes.plot(
        first.seconds * (x / first.x) ** -price, error.size * (x / first.x) ** order.value, lw=0.9, ls="--",
        color=_look(done, ladder.engine)["color"],
        label=f"{ladder.engine}: slope {-order.value / price:.2f} ± {order.error / price:.2f}",
    )


def _bands(axes, done: BulkAccuracy) -> None:
    floors = [f for (_, name), f in done.floors.items() if name == done.quantity]
    if floors:
        axes.axhspan(0.1 * LEAST, max(f.mean for f in floors), color="#888888", alpha=0.35, lw=0, zorder=0)
        axes.axhspan(0.1 * LEAST, max(f.spread for f in floors), color="#888888", alpha=0.15, lw=0, zorder=0)


def _scales(axes) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    for target in TARGETS:
        axes.axhline(target, color="#777777", lw=0.7, ls=":")
    axes.grid(alpha=0.25)
    axes.tick_params(labelsize=8, which="both")


def _share_range(panels: list) -> None:
    """Give panels one range of errors, from the smallest target down a little to the largest point."""
    drawn = [float(y) for a in panels for line in a.lines for y in line.get_ydata()]
    low, high = min([*drawn, TARGETS[-1]]), max([*drawn, TARGETS[0]])
    for panel in panels:
        panel.set_ylim(max(0.5 * low, LEAST), 3.0 * high)


# --- the quantity itself -------------------------------------------------------------------------------


def _draw_values(axes, done: BulkAccuracy, ladders: list[Ladder]) -> None:
    """Against the knob's values, coarse on the left; limits beyond the finest rung."""
    words = ladders[0].knob.words
    for number, ladder in enumerate(ladders):
        places, means, bars = [], [], []
        for rung in ladder.rungs:
            mean, bar, _ = value_of(rung.values.get(done.quantity))
            if mean is not None:
                places.append(_place(ladder, rung.x) * (1.0 + 0.03 * number) if not words else rung.x + 0.06 * number)
                means.append(mean)
                bars.append(bar)
        look = _look(done, ladder.engine)
        axes.errorbar(places, means, yerr=bars, ms=4, lw=0.8, elinewidth=0.8, capsize=1.5, **look)
        _draw_limit(axes, done, ladder, number)
        _draw_failed(axes, done, ladder, number, look["color"])
    _dress_values(axes, ladders[0], words=words)
    _shade_beyond(axes, ladders[0])


def _place(ladder: Ladder, x: float) -> float:
    """Where a rung stands: 1/x over that of the coarsest one, so that finer is further right."""
    return max(r.x for r in ladder.rungs) / x


def _draw_limit(axes, done: BulkAccuracy, ladder: Ladder, number: int) -> None:
    limit = ladder.limits.get(done.quantity)
    if limit is not None:
        end = 2.0 * _place(ladder, min(r.x for r in ladder.rungs)) * (1.0 + 0.12 * number)
        mean = float(np.sqrt((limit.value**2).mean())) if len(limit.value) > 1 else float(limit.value[0])
        bar = float(np.sqrt((limit.bar**2).mean()))
        axes.errorbar([end], [mean], yerr=[bar], marker="x", ms=7, mew=1.8, elinewidth=1.4, capsize=3,
                      color=_look(done, ladder.engine)["color"])


def _shade_beyond(axes, ladder: Ladder) -> None:
    """Shade where steps lie that no scene can have, up to half-way (on this axis) to those that one can."""
    places = {_place(ladder, r.x): r.beyond is not None for r in ladder.rungs} if not ladder.knob.words else {}
    out = [p for p, beyond in places.items() if beyond]
    if out and len(out) < len(places):
        edge = np.sqrt(max(out) * min(p for p in places if p > max(out)))
        axes.axvspan(min(out) / 1.5, edge, color="#c8553d", alpha=0.08, lw=0, zorder=0)


def _draw_failed(axes, done: BulkAccuracy, ladder: Ladder, number: int, colour: str) -> None:
    """Put a cross at the top for every rung that has not the quantity, those of each engine a little lower."""
    lost = [r for r in ladder.rungs if value_of(r.values.get(done.quantity))[0] is None]
    failed = [r.x if ladder.knob.words else _place(ladder, r.x) for r in lost]
    axes.plot(failed, [0.97 - 0.04 * number] * len(failed), "x", ms=7, mew=1.8, color=colour,
              transform=axes.get_xaxis_transform())


def _dress_values(axes, ladder: Ladder, *, words: bool) -> None:
    if words:
        axes.set_xticks([r.x for r in ladder.rungs], [r.label for r in ladder.rungs], rotation=20, fontsize=7)
        axes.margins(x=0.2)
    else:
        axes.set_xscale("log")
        places = [_place(ladder, r.x) for r in ladder.rungs]
        labels = [*(r.label for r in ladder.rungs), "limit"]
        axes.set_xticks([*places, 2.0 * places[-1]], labels, rotation=40, fontsize=7)
        axes.minorticks_off()
    axes.set_xlabel(ladder.knob.value)
    axes.grid(alpha=0.25)
    axes.tick_params(axis="y", labelsize=8)


# --- all knobs together --------------------------------------------------------------------------------


def _draw_front(axes, done: BulkAccuracy) -> None:
    for ladder in done.ladders:
        others = [o for o in done.ladders if o.engine == ladder.engine and o is not ladder and not o.knob.words]
        for rung in ladder.rungs:
            error = ladder.whole_error(rung, done.quantity, others)
            if error is not None and rung.seconds is not None:
                _draw_point(axes, done, ladder.engine, rung, rung.seconds, error)
    best = [(r.seconds, e.most) for _, r, e in front(done.ladders, done.quantity)]
    if len(best) > 1:
        axes.step(*np.array(best).T, where="post", color="#999999", lw=5, alpha=0.5, zorder=1)
    _bands(axes, done)
    _scales(axes)
    axes.set_title("all knobs together", fontsize=10)
    axes.set_xlabel("CPU time of a test (s)")


def _draw_key(axes, done: BulkAccuracy) -> None:
    """Name engines and bands once, in a panel of their own."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    grey = "#555555"
    handles = [Line2D([], [], ls="", label=e, **_look(done, e)) for e in done.engines]
    handles += [
        Line2D([], [], ls="", marker="o", color=grey, markerfacecolor="white", label="not above its own error"),
        Line2D([], [], ls="", marker="x", ms=7, mew=1.8, color=grey, label="limit; at the top: no answer"),
        Patch(color="#888888", alpha=0.5, label=f"scatter of the mean of {done.packings} packings"),
        Patch(color="#888888", alpha=0.15, label="scatter of one packing"),
        Patch(color="#c8553d", alpha=0.08, label="beyond the scene's stability limit (points: pale)"),
        Line2D([], [], color="#999999", lw=5, alpha=0.5, label="front"),
    ]
    axes.axis("off")
    axes.legend(handles=handles, loc="upper left", fontsize=8, frameon=False)
