"""Pictures of a ring: force chains and spins with the glued discs, and the one picture of a comparison."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from harness.report import figures
from harness.report.page import Figure

if TYPE_CHECKING:
    from harness.scene.system import Ring, System
    from harness.studies.compare.study import Comparison, Run
    from postproc.snapshot import Snapshot

MARGIN = 1.02
"""Of the outer ring with its discs."""


def chain_figure(comparison: Comparison) -> Figure | None:
    """Force chains at the start of the averages and at the end, one row an engine; None without contacts."""
    runs = _first_runs(comparison)
    if not runs or not comparison.starts[0].system.contacts:
        return None
    figure, axes = figures.new_figure(2, len(runs), width=4.0 * len(runs), height=8.2)
    frames = (_steady_frame(runs[0], comparison), -1)
    width = figures.typical_force(runs[0].trajectory.frames[-1])
    for row, k in zip(axes, frames, strict=True):
        for a, run in zip(row, runs, strict=True):
            draw_chains(a, run, k, comparison, width)
    caption = (
        f"Contact forces, first packing: where averages begin, and the end; a line 3 points wide carries "
        f"{width:.2g} N. Grey: glued discs; the inner ring turns counter-clockwise if omega is positive."
    )
    return Figure(uri=figures.png_uri(figure, dpi=90), caption=caption)


def spin_figure(comparison: Comparison) -> Figure | None:
    """Spins at the end; with recorded rotations how far every disc has turned, too."""
    runs = _first_runs(comparison)
    if not runs or "wz" not in runs[0].trajectory.frames[-1].particles:
        return None
    kinds = [("wz", "spin (rad/s)", 1.0)]
    if comparison.starts[0].system.rotations:
        kinds.append(("rotation", "rotation since the start (°)", 180.0 / np.pi))
    figure, axes = figures.new_figure(len(kinds), len(runs), width=4.0 * len(runs), height=4.5 * len(kinds))
    for row, (column, label, scale) in zip(axes, kinds, strict=True):
        values = [scale * r.trajectory.frames[-1].particles[column] for r in runs]
        limit = max(float(np.percentile(np.abs(v), 95)) for v in values) or 1.0
        for a, run, v in zip(row, runs, values, strict=True):
            discs = draw_discs(a, run, v, limit, comparison)
        figure.colorbar(discs, ax=row, location="bottom", shrink=0.6, aspect=40, label=label)
    caption = "Spin of every disc at the end, counter-clockwise positive (red). First packing."
    return Figure(uri=figures.png_uri(figure, dpi=90), caption=caption)


def overview(comparison: Comparison):
    """Return a figure: torque, velocity and density above, force chains of up to three codes below; None of no run."""
    from harness.report.ring_panels import draw_density, draw_velocity
    from harness.report.ring_torque import INNER, draw_torque, torque_bands

    if not comparison.result.curves:
        return None
    figure, axes = figures.new_figure(2, 3, width=13, height=8)
    draw_torque(axes[0, 0], comparison, INNER, torque_bands(comparison)[INNER])
    axes[0, 0].legend(fontsize=7)
    draw_velocity(axes[0, 1], comparison)
    draw_density(axes[0, 2], comparison, free=True)
    runs = _codes(_first_runs(comparison)) if comparison.starts[0].system.contacts else []
    for a, run in zip(axes[1], runs, strict=False):
        draw_chains(a, run, -1, comparison, figures.typical_force(runs[0].trajectory.frames[-1]))
    for a in axes[1, len(runs):]:
        a.axis("off")
    return figure


def _codes(runs: Sequence[Run]) -> list[Run]:
    """One run a code, of the kernel's conventions the first; three at most."""
    by_code = {r.engine.split(":")[0]: r for r in reversed(runs)}
    return list(reversed(by_code.values()))[:3]


def _first_runs(comparison: Comparison) -> list[Run]:
    return [r for r in comparison.completed if r.packing == 0]


def _steady_frame(run: Run, comparison: Comparison) -> int:
    return next(k for k, f in enumerate(run.trajectory) if f.time >= comparison.scene.compare.steady_from * (1 - 1e-9))


def draw_chains(axes, run: Run, frame: int, comparison: Comparison, width: float) -> None:
    """Draw the contacts of a frame as lines, width by force, and the glued discs."""
    from matplotlib.collections import LineCollection

    snapshot = run.trajectory.frames[frame]
    start, end, force = figures.contact_lines(snapshot)
    figures.add_inside(axes, LineCollection(
        np.stack([start, end], axis=1), linewidths=np.minimum(3.0 * force / width, 4.0), colors="#222222",
    ))
    _ring_view(axes, snapshot, comparison.starts[run.packing].system)
    axes.set_title(f"{run.engine}, t = {snapshot.time:.3g} s", fontsize=9)


def draw_discs(axes, run: Run, values: np.ndarray, limit: float, comparison: Comparison):
    """Draw the discs of the last frame coloured by `values`; return the artist."""
    snapshot = run.trajectory.frames[-1]
    p = snapshot.particles
    discs = _circles(axes, p.vector("x", "y"), p["radius"], array=values, cmap="RdBu_r")
    discs.set_clim(-limit, limit)
    _ring_view(axes, snapshot, comparison.starts[run.packing].system)
    axes.set_title(f"{run.engine}, t = {snapshot.time:.3g} s", fontsize=9)
    return discs


def _ring_view(axes, snapshot: Snapshot, system: System) -> None:
    """Draw the glued discs where they are, show all, hide the axes."""
    for ring in system.rings:
        _circles(axes, _turned(ring, snapshot.time), ring.radius, facecolors="#999999")
    outer = max(system.rings, key=lambda r: r.circle)
    reach = 1e3 * MARGIN * (outer.circle + float(outer.radius.max()))
    for limits, middle in zip((axes.set_xlim, axes.set_ylim), outer.centre, strict=True):
        limits(1e3 * middle - reach, 1e3 * middle + reach)
    figures.bare(axes)


def _turned(ring: Ring, time: float) -> np.ndarray:
    """Centres of the glued discs at a time, (M, 2), m."""
    angle = 0.0 if ring.omega is None else ring.omega * time
    c, s = np.cos(angle), np.sin(angle)
    return (ring.x - ring.centre) @ np.array([[c, s], [-s, c]]) + ring.centre


def _circles(axes, centres: np.ndarray, radius: np.ndarray, **look):
    from matplotlib.collections import EllipseCollection

    diameter = 2e3 * radius
    discs = EllipseCollection(
        diameter, diameter, np.zeros_like(diameter), units="x", offsets=1e3 * centres, transOffset=axes.transData,
        edgecolors="none", **look,
    )
    figures.add_inside(axes, discs)
    return discs
