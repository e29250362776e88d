"""Figures of the compare report: functions that draw on axes which they are given."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from postproc.results import headed

if TYPE_CHECKING:
    from harness.studies.compare.curves import BiaxialCurves
    from harness.studies.compare.growth import Growth
    from harness.studies.compare.states import StateCurves
    from harness.studies.compare.study import Comparison, Run
    from postproc.snapshot import Snapshot

COLOURS = {"lammps": "#1b6ca8", "liggghts": "#c8553d", "kernel:lammps": "#3fa34d", "kernel:liggghts": "#8e5ea2",
           "kernel:talk": "#3fa34d"}
STYLES = {"lammps": "-", "liggghts": "-", "kernel:lammps": "--", "kernel:liggghts": ":", "kernel:talk": "--"}


COMPRESSION = 3
"""Of PNG files: pictures of a box take half the time of level 6, usual elsewhere, and fewer bytes (thin lines)."""


def new_figure(rows: int, columns: int, *, width: float, height: float):
    """Return a figure and its axes (rows, columns), with the Agg canvas: no screen is needed."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, columns, squeeze=False)


def png_uri(figure, *, dpi: int = 110) -> str:
    """Return the figure as a data URI, so that the page needs no other file."""
    return data_uri(png_bytes(figure, dpi=dpi))


def data_uri(png: bytes) -> str:
    """Return a PNG file as a data URI."""
    return "data:image/png;base64," + base64.b64encode(png).decode()


def png_bytes(figure, *, dpi: int) -> bytes:
    """Return the figure as a PNG file, laid out and drawn once.

    `savefig` draws twice where there is a layout to find: first without ink, as some backends need it and Agg does not.
    """
    from PIL import Image

    figure.dpi = dpi
    _lay_out(figure)
    figure.canvas.draw()
    picture, buffer = Image.fromarray(_opaque(np.asarray(figure.canvas.buffer_rgba()))), io.BytesIO()
    picture.save(buffer, format="png", dpi=(dpi, dpi), compress_level=COMPRESSION)
    return buffer.getvalue()


def _opaque(pixels: np.ndarray) -> np.ndarray:
    """Return pixels (H, W, 4) without a transparency that they do not have: (H, W, 3)."""
    return np.ascontiguousarray(pixels[..., :3]) if (pixels[..., 3] == 255).all() else pixels


def svg_bytes(figure) -> bytes:
    """Return the figure as an SVG file, the same bytes for the same figure."""
    from matplotlib import rc_context

    buffer = io.BytesIO()
    _lay_out(figure)
    with rc_context({"svg.hashsalt": "grainproof"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def _lay_out(figure) -> None:
    """Find the places of axes and labels, if they are not found yet: PNG and SVG have the same."""
    engine = figure.get_layout_engine()
    if engine is None:
        return
    for axes in figure.axes:
        space_log_ticks(axes)
    if len(figure.axes) == 1 and figure.axes[0].get_aspect() == "auto":
        figure.set_layout_engine(None)
        _fill(figure, figure.axes[0])
        return
    engine.execute(figure)
    figure.set_layout_engine(None)


FEW_DECADES, NO_DECADE = 100.0, 3.0
"""Largest over least value of a logarithmic axis: below, it has labels at 1, 2 and 5 times powers of ten, or at a few
even places."""


def space_log_ticks(axes) -> None:
    """Label logarithmic axes so that numbers do not touch: powers of ten where there are several, else a few more.

    By itself matplotlib labels 2, 3, 4, 6 times a power of ten on an axis of little more than a decade. What a figure
    labels itself stays.
    """
    from matplotlib.ticker import FuncFormatter, LogFormatter, LogLocator, MaxNLocator, NullFormatter

    for axis in (a for a in (axes.xaxis, axes.yaxis) if a.get_scale() == "log"):
        low, high = sorted(axis.get_view_interval())
        if isinstance(axis.get_minor_formatter(), LogFormatter):
            axis.set_minor_formatter(NullFormatter())
        if not isinstance(axis.get_major_formatter(), LogFormatter) or high > FEW_DECADES * low:
            continue
        even = MaxNLocator(nbins=3, steps=[1, 2, 5, 10])
        axis.set_major_locator(even if high < NO_DECADE * low else LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


PAD = 3.0
"""Points between the edge of a figure and what stands in it, as in matplotlib's constrained layout."""

USUAL = {"left": 0.14, "bottom": 0.15, "right": 0.99, "top": 0.98}
"""About where the axes of a panel end up: ticks that are right there are right in their place."""


def _fill(figure, axes) -> None:
    """Give the only axes all room that its labels leave: the constrained layout, with one look at labels, not two."""
    figure.subplots_adjust(**USUAL)
    inner, renderer = axes.get_position(), figure.canvas.get_renderer()
    outer = axes.get_tightbbox(renderer, for_layout_only=True).transformed(figure.transFigure.inverted())
    width, height = PAD / 72.0 / figure.get_size_inches()
    figure.subplots_adjust(
        left=inner.x0 - outer.x0 + width, right=1.0 - (outer.x1 - inner.x1) - width,
        bottom=inner.y0 - outer.y0 + height, top=1.0 - (outer.y1 - inner.y1) - height,
    )


def line_style(engine: str) -> dict:
    """One look for an engine in all figures."""
    return {"color": COLOURS.get(engine, "#555555"), "linestyle": STYLES.get(engine, "-"), "lw": 1.2, "label": engine}


def draw_curves(
    axes, curves: Mapping[str, BiaxialCurves], quantity: str, label: str, *, scale: float = 1.0
) -> None:
    """Draw an attribute of every engine's curves against axial strain in per cent."""
    for engine, c in curves.items():
        axes.plot(100 * c.strain, scale * getattr(c, quantity), **line_style(engine))
    axes.set_xlabel("axial strain (%)")
    axes.set_ylabel(label)
    axes.grid(alpha=0.3)


def draw_states(axes, states: Mapping[str, StateCurves], quantity: str) -> None:
    """Draw a frame average of every engine (one at least) against axial strain in per cent."""
    for engine, s in states.items():
        axes.plot(100 * s.strain, s.values[quantity], marker=".", ms=3, **line_style(engine))
    axes.set_xlabel("axial strain (%)")
    axes.set_ylabel(headed(quantity, next(iter(states.values())).units[quantity]))
    axes.grid(alpha=0.3)


def draw_growth(axes, growth: Mapping[str, Growth]) -> None:
    """Draw rms differences between runs against time, logarithmic; exact zeros cannot be shown."""
    unit, scale = ("s", 1.0) if max(float(g.time[-1]) for g in growth.values()) > 1.0 else ("ms", 1e3)
    for name, g in growth.items():
        shown = g.difference > 0
        axes.semilogy(scale * g.time[shown], g.difference[shown], marker=".", ms=3, lw=1, label=name)
    axes.set_xlabel(f"time ({unit})")
    axes.set_ylabel("rms |Δx| / mean diameter")
    axes.grid(alpha=0.3, which="both")
    small_legend(axes)


def small_legend(axes) -> None:
    """Name what is drawn, if anything is: a pair whose run failed has no curve."""
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=7)


def draw_signal_deviation(axes, comparison: Comparison, *, left: float = 1e-4) -> None:
    """Draw every pair's relative difference of the signal that is followed, and the declared windows as bars.

    left: where the axis of the places begins, in its unit.
    """
    from harness.studies.compare.signal import signal_deviation

    signals = {e: c.signal for e, c in comparison.result.curves.items()}
    for p in comparison.result.pairs:
        if not p.missing(signals):
            a, b = signals[p.left], signals[p.right]
            deviation = np.maximum(signal_deviation(a, b)[1:], 1e-17)
            axes.loglog(a.scale * a.place[1:], deviation, lw=0.9, label=p.name)
    any_ = next(iter(signals.values()))
    for w in comparison.scene.compare.windows:
        axes.plot([left, any_.scale * w.limit], [w.tolerance] * 2, color="#444444", lw=2, alpha=0.6)
        axes.text(1.3 * left, 1.3 * w.tolerance, w.pairs.replace("_", " "), fontsize=7, color="#444444")
    axes.set_xlim(left=left)
    axes.set_xlabel(any_.axis)
    axes.set_ylabel(f"relative difference of the {any_.quantity}")
    axes.grid(alpha=0.3)
    small_legend(axes)


def draw_force_chains(axes, frame: Snapshot, *, full_width: float, view: np.ndarray) -> None:
    """Draw every contact as a line between centres (or to the wall), width by its force.

    full_width: the force (N) drawn three points wide; view: (2, 2) bounds in m, the same for all
    panels of a figure.
    """
    from matplotlib.collections import LineCollection

    start, end, force = contact_lines(frame)
    add_inside(axes, LineCollection(
        np.stack([start, end], axis=1), linewidths=np.minimum(3.0 * force / full_width, 4.0), colors="#222222",
    ))
    box_view(axes, frame, view)


def draw_rotations(axes, frame: Snapshot, rotation: np.ndarray, *, limit: float, view: np.ndarray):
    """Draw the discs coloured by rotation in degrees, red counter-clockwise; return the artist."""
    return draw_discs(axes, frame, rotation, low=-limit, high=limit, colours="RdBu_r", view=view)


def draw_discs(axes, frame: Snapshot, values: np.ndarray, *, low: float, high: float, colours: str, view: np.ndarray):
    """Draw the discs coloured by `values` (N,) between two ends of a colour map; return the artist."""
    from matplotlib.collections import EllipseCollection

    p = frame.particles
    diameter = 2e3 * p["radius"]
    discs = EllipseCollection(
        diameter, diameter, np.zeros_like(diameter), units="x", offsets=1e3 * p.vector("x", "y"),
        transOffset=axes.transData, array=values, cmap=colours, edgecolors="none",
    )
    discs.set_clim(low, high)
    add_inside(axes, discs)
    box_view(axes, frame, view)
    return discs


def add_inside(axes, collection) -> None:
    """Draw a collection of many parts in axes whose view is set: nobody needs to ask every part for its place."""
    collection.set_in_layout(False)
    axes.add_collection(collection, autolim=False)


def contact_lines(frame: Snapshot) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return start and end (C, 2) in mm and |f| (C,) of all contacts of a 2D frame."""
    c, centre = frame.contacts, frame.particles.vector("x", "y")
    i, j = c["i"].astype(int) - 1, c["j"].astype(int)
    end = np.where((j > 0)[:, None], centre[np.maximum(j, 1) - 1], c.vector("px", "py"))
    return 1e3 * centre[i], 1e3 * end, np.hypot(c["fx"], c["fy"])


def common_view(runs: Sequence[Run]) -> np.ndarray:
    """Bounds (2, 2) in m that hold the box of every frame shown, with a margin."""
    boxes = np.array([f.box for r in runs for f in (r.trajectory.frames[0], r.trajectory.frames[-1])])
    margin = 0.01 * float(np.ptp(boxes))
    return np.stack([boxes[..., 0].min(axis=0) - margin, boxes[..., 1].max(axis=0) + margin], axis=1)


def typical_force(frame: Snapshot) -> float:
    """Four times the mean contact force, N; 1 N in a frame without contacts, which has no line to draw."""
    c = frame.contacts
    return 4.0 * float(np.hypot(c["fx"], c["fy"]).mean()) if c.rows else 1.0


def box_view(axes, frame: Snapshot, view: np.ndarray) -> None:
    """Draw the walls of a box if there are any, show `view` (2, 2) in m, hide the axes."""
    if frame.box is not None:
        (left, right), (bottom, top) = 1e3 * np.asarray(frame.box)
        axes.plot([left, right, right, left, left], [bottom, bottom, top, top, bottom], color="#888888", lw=0.8)
    axes.set_xlim(*(1e3 * view[0]))
    axes.set_ylim(*(1e3 * view[1]))
    bare(axes)


def bare(axes) -> None:
    """Show nothing but what is drawn, as wide as high: no frame, and no ticks to find labels for."""
    axes.set(aspect="equal", xticks=(), yticks=())
    axes.axis("off")
