"""The picture of advice: every ladder of the engine, the tolerance, and the rung that is taken."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report.figures import new_figure

if TYPE_CHECKING:
    from harness.studies.advise.study import Advice

COLOUR, TAKEN, FAR = "#1b6ca8", "#c8553d", "#8e5ea2"

CAPTION = (
    "Ladders of the advised engine, a panel a knob: error against the knob's own limit, bars of one standard error, "
    "and the tolerance (grey). Round the rung that is taken a ring; dashed what was extrapolated; the scene's own "
    "setting is filled; crossed out is what `scene` refuses."
)


def advise_figure(advice: Advice):
    """Return the figure, None without an answer."""
    choice = advice.answer
    if choice is None:
        return None
    ladders = advice.evidence.ladders[choice.engine]
    figure, axes = new_figure(1, len(ladders), width=1.0 + 3.0 * len(ladders), height=3.4)
    for ax, (knob, ladder) in zip(axes[0], ladders.items(), strict=True):
        _draw(ax, advice, ladder, choice.rungs.get(knob))
    axes[0, 0].set_ylabel(f"error of {advice.evidence.quantity} (%)")
    return figure


def _draw(ax, advice: Advice, ladder, taken) -> None:
    ax.axhspan(-100.0 * advice.tolerance, 100.0 * advice.tolerance, color="#999999", alpha=0.2, lw=0)
    ax.axhline(0.0, color="#333333", lw=0.8)
    x, y, bars = ([f(r) for r in ladder.rungs] for f in (
        lambda r: r.value, lambda r: 100.0 * r.error, lambda r: 100.0 * r.bar
    ))
    ax.errorbar(x, y, yerr=bars, fmt="o-", ms=5, lw=0.9, elinewidth=0.9, capsize=2, color=COLOUR, mfc="white")
    out = [r for r in ladder.rungs if r.value in ladder.beyond]
    ax.plot([r.value for r in out], [100.0 * r.error for r in out], "x", ms=9, mew=1.6, color="#555555", zorder=5)
    own = ladder.own
    if own is not None:
        ax.plot([own.value], [100.0 * own.error], "o", ms=5, color=COLOUR, zorder=4)
    if taken is not None:
        far = taken.origin == "extrapolated"
        if far:
            ax.plot([x[-1], taken.value], [y[-1], 100.0 * taken.error], "--", color=FAR, lw=1.0)
        ax.plot([taken.value], [100.0 * taken.error], "o", ms=12, mfc="none", mec=FAR if far else TAKEN, mew=1.8)
    ax.set_xscale("log")
    ax.minorticks_off()
    shown = [*x, *([taken.value] if taken is not None else [])]
    ax.set_xticks(shown, [f"{v:.3g}" for v in shown])
    ax.set_xlabel(f"{ladder.knob}: {ladder.says}", fontsize=8)
    ax.tick_params(labelsize=8)
    ax.grid(alpha=0.25)
