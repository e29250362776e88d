"""What the report of a free scene shows: how runs part, exit values, collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report import figures
from harness.report.page import Figure, Section

if TYPE_CHECKING:
    from harness.scene.system import System
    from harness.studies.compare.exits import ExitValues
    from harness.studies.compare.study import Comparison


TABLES = ("exits", "collisions")


def tables(comparison: Comparison) -> dict[str, list[dict]]:
    """Rows by table name."""
    return dict(zip(TABLES, (exit_rows(comparison), collision_rows(comparison)), strict=True))


def sections(comparison: Comparison) -> list[Section]:
    """The page's sections, without those for which no run completed."""
    if not comparison.completed:
        return []
    exits, collisions = exit_rows(comparison), collision_rows(comparison)
    return [
        Section(heading="Exit values", rows=exits),
        Section(heading="Collisions", note=COLLISION_NOTE, rows=collisions),
        *_growth(comparison),
    ]


def overview(comparison: Comparison) -> None:  # noqa: ARG001
    """Free scenes have no one picture."""


COLLISION_NOTE = (
    "Read off the recorded frames, begin and end interpolated linearly, so frame spacing limits their accuracy. "
    "A negative partner is a wall."
)


def exit_rows(comparison: Comparison) -> list[dict]:
    """One row an engine and body: final velocity and spin with all digits that a double has."""
    system = comparison.starts[0].system
    return [row for e, x in comparison.result.exits.items() for row in exit_table(e, x, system)]


def exit_table(engine: str, exits: ExitValues, system: System) -> list[dict]:
    """One row a body."""
    axes = "xyz"[: system.dimension]
    spins = ("wz",) if len(axes) == 2 else ("wx", "wy", "wz")
    return [
        {"engine": engine, "body": k + 1,
         **{f"v{a} (m/s)": float(v) for a, v in zip(axes, velocity, strict=True)},
         **{f"{w} (rad/s)": float(v) for w, v in zip(spins, exits.spin[k], strict=True)}}
        for k, velocity in enumerate(exits.velocity)
    ]


def collision_rows(comparison: Comparison) -> list[dict]:
    """One row an engine and collision."""
    return [row for e, x in comparison.result.exits.items() for row in collision_table(e, x)]


def collision_table(engine: str, exits: ExitValues) -> list[dict]:
    """One row a collision, in order of time."""
    return [
        {"engine": engine, "i": c.i, "j": c.j, "begin (s)": c.begin, "contact time (s)": c.duration,
         "largest overlap (m)": c.largest_overlap, "restitution": c.restitution, "frame spacing (s)": exits.resolution}
        for c in exits.collisions
    ]


def _growth(comparison: Comparison) -> list[Section]:
    """Nothing when no pair of engines completed."""
    if not comparison.result.growth:
        return []
    figure, axes = figures.new_figure(1, 1, width=7, height=4)
    figures.draw_growth(axes[0, 0], comparison.result.growth)
    caption = "How positions part, from identical numbers at time 0; differences of exactly zero are not drawn."
    return [Section(heading="Do the codes agree?", figures=(Figure(uri=figures.png_uri(figure), caption=caption),))]
