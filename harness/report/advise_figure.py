"""The picture of advice: every ladder of the engine, the tolerance, the rung that is taken; and all knobs at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report.advise_verified import packing_rows
from harness.report.figures import new_figure

if TYPE_CHECKING:
    from harness.studies.advise.study import Advice
    from harness.studies.advise.verification import Verification

COLOUR, TAKEN, FAR = "#1b6ca8", "#c8553d", "#8e5ea2"

CAPTION = (
    "Ladders of the advised engine, a panel a knob: error against the knob's own limit, bars of one standard error, "
    "and the tolerance (grey). Round the rung that is taken a ring; dashed what was extrapolated; the scene's own "
    "setting is filled; crossed out is what `scene` refuses."
)
CAPTION_VERIFIED = (
    " Last panel: all knobs at once, advised less reference (of a free scene the error against the oracle), packing by "
    "packing where they are the same, and the mean with its one-sided 95 % bar."
)


def caption(verification: Verification | None) -> str:
    """Return what the figure shows."""
    return CAPTION + (CAPTION_VERIFIED if _verified(verification) else "")


def advise_figure(advice: Advice, verification: Verification | None = None):
    """Return the figure, None without an answer."""
    choice = advice.answer
    if choice is None:
        return None
    ladders = advice.evidence.ladders[choice.engine]
    verified = _verified(verification)
    count = len(ladders) + verified
    figure, axes = new_figure(1, count, width=1.0 + 3.0 * count, height=3.4)
    for ax, (knob, ladder) in zip(axes[0], ladders.items(), strict=False):
        _draw(ax, advice, ladder, choice.rungs.get(knob))
    if verified:
        _draw_verified(axes[0, -1], verification)
    axes[0, 0].set_ylabel(f"error of {advice.evidence.quantity} (%)")
    return figure


def _verified(verification: Verification | None) -> bool:
    """Whether there is a difference to be drawn."""
    return verification is not None and verification.difference is not None


def _draw(ax, advice: Advice, ladder, taken) -> None:
    _draw_tolerance(ax, advice.tolerance)
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
    shown = dict.fromkeys([*x, *([taken.value] if taken is not None else [])])
    ax.set_xticks([*shown], [f"{v:.3g}" for v in shown])
    ax.set_xlabel(f"{ladder.knob}: {ladder.says}", fontsize=8)
    _finish(ax)


def _draw_verified(ax, verification: Verification) -> None:
    _draw_tolerance(ax, verification.tolerance)
    rows = [r for r in packing_rows(verification) if r.get("difference (%)") is not None]
    numbers = [r["packing"] for r in rows]
    last = max(numbers, default=0) + 1
    ax.plot(numbers, [r["difference (%)"] for r in rows], "o", ms=5, color=COLOUR, mfc="white")
    ax.errorbar(
        [last], [100.0 * verification.difference.value], yerr=[100.0 * verification.bar], fmt="s", ms=6, lw=0,
        elinewidth=1.4, capsize=4, color=TAKEN,
    )
    ax.set_xlim(0.3, last + 0.7)
    ticks = numbers[:: 1 + len(numbers) // 8]
    ax.set_xticks([*ticks, last], [*map(str, ticks), "mean" if numbers else ""])
    ax.set_xlabel("all at once: " + ("phases" if verification.free else "packings"), fontsize=8)
    _finish(ax)


def _draw_tolerance(ax, tolerance: float) -> None:
    ax.axhspan(-100.0 * tolerance, 100.0 * tolerance, color="#999999", alpha=0.2, lw=0)
    ax.axhline(0.0, color="#333333", lw=0.8)


def _finish(ax) -> None:
    ax.tick_params(labelsize=8)
    ax.grid(alpha=0.25)
