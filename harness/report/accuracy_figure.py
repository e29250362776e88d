"""The picture of the accuracy report: a column a case; above error against time, below against steps a contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.report.figures import new_figure
from harness.studies.accuracy.result import TARGETS, front

if TYPE_CHECKING:
    from harness.studies.accuracy.result import Point, Track
    from harness.studies.accuracy.study import Accuracy

COLOURS = ("#1b6ca8", "#c8553d", "#3fa34d", "#8e5ea2", "#b8860b", "#2f4f4f")
WORDS = {"exit": "error of velocity and spin", "velocity": "error of the velocity", "spin": "error of the spin"}
MARKERS = ("o", "s", "^", "D", "v", "P")

CAPTION = (
    "A column a case: the scene as declared, and without friction or dashpots, on which the order of a scheme depends. "
    "Error of what bodies leave with, over the speed of the impact: rms over the phases of the step in which contacts "
    "begin, bars from the 10 to the 90 per cent quantile. Above against CPU time for the same physical time, set-up "
    "and output left out, the front of the best settings in grey; below against steps a contact"
)
FITTED = ", with fitted slopes (dashed; the legend has the order and its standard error)."
NOT_FITTED = "; no slope is fitted, for the reasons in the table Orders."
DOTTED = " Dotted: the errors of the budget."
FAILED = " Crosses at the top: rungs without an answer."
BEYOND = (
    " Hollow: steps beyond the scene's stability limit (dash-dotted), which `scene` refuses; they are not on the front."
)
PARTED = " Grey band: how far the limits of the codes' laws are apart."


def caption(accuracy: Accuracy) -> str:
    """Return what the figure shows; marks that are not drawn are not told of."""
    quantity, points = accuracy.asked.quantity, [p for t in accuracy.tracks for p in t.points]
    fitted = any(t.fits.get(quantity) for t in accuracy.tracks)
    parted = any(t.parted.get(quantity, 0.0) > 0.0 for t in accuracy.tracks)
    more = [
        FAILED if any(not p.good for p in points) else "", BEYOND if any(p.beyond is not None for p in points) else "",
        PARTED if parted else "",
    ]
    return f"{CAPTION}{FITTED if fitted else NOT_FITTED}{DOTTED}{''.join(more)}"


def accuracy_figure(accuracy: Accuracy):
    """Return the figure."""
    cases = accuracy.cases
    figure, axes = new_figure(2, len(cases), width=1.2 + 4.0 * len(cases), height=7.6)
    for column, case in enumerate(cases):
        tracks = [t for t in accuracy.tracks if t.case == case]
        for row in (0, 1):
            _draw(axes[row, column], accuracy, tracks, against_time=row == 0)
        axes[0, column].set_title(case, fontsize=10)
    for row in (0, 1):
        axes[row, 0].set_ylabel(WORDS[accuracy.asked.quantity])
    return figure


def _draw(axes, accuracy: Accuracy, tracks: list[Track], *, against_time: bool) -> None:
    quantity = accuracy.asked.quantity
    for number, track in enumerate(tracks):
        points = [p for p in track.known(quantity) if not against_time or p.seconds is not None]
        if points:
            _draw_track(axes, quantity, track, points, number, against_time=against_time)
    if against_time:
        _draw_front(axes, tracks, quantity)
    else:
        _draw_fits(axes, tracks, quantity)
        _draw_failed(axes, tracks)
        _draw_limit(axes, tracks)
    _dress(axes, tracks, quantity)
    axes.set_xlabel("CPU time (ms)" if against_time else "steps a contact")


def _draw_track(axes, quantity: str, track: Track, points: list[Point], number: int, *, against_time: bool) -> None:
    x = [1e3 * p.seconds if against_time else 1.0 / p.value for p in points]
    size = np.array([p.size(quantity) for p in points])
    low, high = np.array([p.range(quantity) for p in points]).T
    bars = np.abs(np.array([size - np.minimum(low, size), np.maximum(high, size) - size]))
    axes.errorbar(
        x, size, yerr=bars, ms=4, lw=1.0 if against_time else 0.0, elinewidth=0.8, capsize=1.5,
        color=COLOURS[number % len(COLOURS)], marker=MARKERS[number % len(MARKERS)],
        label=_label(track, quantity, against_time),
    )
    out = [k for k, p in enumerate(points) if p.beyond is not None]
    axes.plot(
        [x[k] for k in out], size[out], ls="", ms=5, mfc="white", mec=COLOURS[number % len(COLOURS)], zorder=4,
        marker=MARKERS[number % len(MARKERS)],
    )


def _label(track: Track, quantity: str, against_time: bool) -> str:
    fit = track.fits.get(quantity)
    return track.engine if against_time or fit is None else f"{track.engine}: {fit.slope:.2f} ± {fit.error:.2f}"


def _draw_fits(axes, tracks: list[Track], quantity: str) -> None:
    for number, track in enumerate(tracks):
        fit, known = track.fits.get(quantity), track.known(quantity)
        if fit is None:
            continue
        fraction = known[0].value / known[0].dt
        dt = np.array([fit.reference, max(p.dt for p in known)])
        axes.plot(1.0 / (fraction * dt), fit.at * (dt / fit.reference) ** fit.slope, lw=0.9, ls="--",
                  color=COLOURS[number % len(COLOURS)])


def _draw_front(axes, tracks: list[Track], quantity: str) -> None:
    best = [(1e3 * p.seconds, p.size(quantity)) for _, p in front(tracks, quantity)]
    if len(best) > 1:
        axes.step(*np.array(best).T, where="post", color="#bbbbbb", lw=4, alpha=0.6, zorder=0, label="front")


def _draw_failed(axes, tracks: list[Track]) -> None:
    """Put a cross at the top for every rung without an answer, those of each engine a little lower."""
    for number, track in enumerate(tracks):
        failed = [1.0 / p.value for p in track.points if not p.good]
        height = [0.98 - 0.03 * number] * len(failed)
        axes.plot(failed, height, "x", ms=6, mew=1.6, color=COLOURS[number % len(COLOURS)], zorder=3,
                  transform=axes.get_xaxis_transform())


def _draw_limit(axes, tracks: list[Track]) -> None:
    """Where the scene's stability limit lies, if rungs are beyond it."""
    limit = next((p.beyond for t in tracks for p in t.points if p.beyond is not None), None)
    if limit is not None:
        axes.axvline(1.0 / limit, color="#555555", lw=0.9, ls="-.", zorder=0)


def _dress(axes, tracks: list[Track], quantity: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    parted = max((t.parted.get(quantity, 0.0) for t in tracks), default=0.0)
    if parted > low:
        axes.axhspan(low, parted, color="#999999", alpha=0.18, lw=0)
    for target in TARGETS:
        axes.axhline(target, color="#777777", lw=0.7, ls=":")
    axes.set_ylim(low, max(high, 2.0 * TARGETS[0]))
    axes.grid(alpha=0.25)
    axes.tick_params(labelsize=8)
    axes.legend(fontsize=7, loc="lower left")
