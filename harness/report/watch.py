"""Watched runs: the largest size of every quantity by run, and a small figure of the energies of each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

from harness.report.page import Figure, Section
from harness.report.panels import panel
from harness.studies.watch.remarks import ENERGY, OVERLAP

if TYPE_CHECKING:
    from harness.studies.watch import Watch

NOTE = (
    "Of every run the largest size over its frames, read from what it recorded anyway: watching alters nothing, and "
    "what happens between two frames is not seen. dissipated = E(0) + work of walls - E(t); where it falls, energy was "
    "made (by the integration, or by the law), beyond what the work is known to."
)
REMARKS = "Remarks of the watch"
REMARKS_NOTE = (
    "With a remark the run is not to be trusted; none says only that the frames show nothing of it. Remarked are pairs "
    f"that passed through each other between two frames, overlaps beyond {OVERLAP:g} of the smaller radius (beyond 1 a "
    f"centre lies inside another body or behind a wall), and energy made beyond {100 * ENERGY:g} % of the largest "
    "energy of the run, the leapfrog's own swing (dt/dt_max)^2 and the error of the walls' work."
)
ENERGIES = {
    "kinetic energy": "#1b6ca8", "rotational energy": "#3fa34d", "elastic energy, normal": "#c8553d",
    "elastic energy, tangential": "#8e5ea2", "work of walls": "#444444", "dissipated": "#b8860b",
    "dissipated or in springs": "#b8860b",
}


class WatchedRun(Protocol):
    """What a table has to know of a run."""

    engine: str
    packing: int
    watch: Watch | None


def watch_rows(runs: Sequence[WatchedRun]) -> list[dict]:
    """Return a row a quantity of every watched run."""
    return [{"engine": r.engine, "packing": r.packing + 1, **row} for r in runs if r.watch for row in r.watch.rows()]


def watch_matrix(runs: Sequence[WatchedRun]) -> list[dict]:
    """Return a row a quantity, a column a run of the first packing: the largest sizes; None where there is none."""
    shown = {r.engine: {row["quantity"]: row for row in r.watch.rows()} for r in runs if r.watch and r.packing == 0}
    rows = {name: row for of_run in shown.values() for name, row in of_run.items()}
    missing = {
        name: next((r[name]["note"] for r in shown.values() if name in r and r[name]["largest"] is None), None)
        for name in rows
    }
    return [
        {"quantity": name, "unit": row["unit"]}
        | {engine: of_run[name]["largest"] if name in of_run else None for engine, of_run in shown.items()}
        | {"note": missing[name] or row["note"]}
        for name, row in rows.items()
    ]


def remark_rows(runs: Sequence[WatchedRun]) -> list[dict]:
    """Return a row a remark of every watched run."""
    return [
        {"engine": r.engine, "packing": r.packing + 1, **row} for r in runs if r.watch for row in r.watch.remark_rows()
    ]


def watch_sections(runs: Sequence[WatchedRun]) -> list[Section]:
    """Return the page's sections; none when nothing was watched."""
    if not any(r.watch for r in runs):
        return []
    figures = tuple(energy_panel(r.engine, r.watch) for r in runs if r.watch and r.packing == 0 and r.watch.of_frames)
    return [
        Section(heading=REMARKS, note=REMARKS_NOTE, rows=remark_rows(runs)),
        Section(heading="Watch", note=NOTE, rows=watch_matrix(runs), figures=figures),
    ]


def energy_panel(engine: str, watch: Watch) -> Figure:
    """Return the energies of a run against time."""

    def draw(axes) -> None:
        for name, colour in ENERGIES.items():
            if name in watch.curves:
                axes.plot(watch.time, watch.curves[name], color=colour, lw=1.2, label=name)
        axes.set_xlabel("time (s)")
        axes.set_ylabel(f"{engine}: energy (J)")
        axes.grid(alpha=0.3)

    return panel(draw, f"Energies of {engine}, frame by frame.")
