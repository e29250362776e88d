"""What the report of a free scene shows: how runs part, exit values, collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report import figures
from harness.report.page import Figure, Section

if TYPE_CHECKING:
    from harness.studies.compare.study import Comparison


def tables(comparison: Comparison) -> dict[str, list[dict]]:
    """Rows by table name."""
    return {"exits": exit_rows(comparison), "collisions": collision_rows(comparison)}


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


COLLISION_NOTE = (
    "Read off the recorded frames, begin and end interpolated linearly, so frame spacing limits their accuracy. "
    "A negative partner is a wall."
)


def exit_rows(comparison: Comparison) -> list[dict]:
    """One row an engine and body: final velocity and spin with all digits that a double has."""
    axes = "xyz"[: comparison.starts[0].system.dimension]
    spins = ("wz",) if len(axes) == 2 else ("wx", "wy", "wz")
    return [
        {"engine": e, "body": k + 1,
         **{f"v{a} (m/s)": float(v) for a, v in zip(axes, x.velocity[k], strict=True)},
         **{f"{w} (rad/s)": float(v) for w, v in zip(spins, x.spin[k], strict=True)}}
        for e, x in comparison.result.exits.items() for k in range(len(x.velocity))
    ]


def collision_rows(comparison: Comparison) -> list[dict]:
    """One row an engine and collision."""
    return [
        {"engine": e, "i": c.i, "j": c.j, "begin (s)": c.begin, "contact time (s)": c.duration,
         "largest overlap (m)": c.largest_overlap, "restitution": c.restitution}
        for e, x in comparison.result.exits.items() for c in x.collisions
    ]


def _growth(comparison: Comparison) -> list[Section]:
    if not comparison.result.growth:
        return []
    figure, axes = figures.new_figure(1, 1, width=7, height=4)
    figures.draw_growth(axes[0, 0], comparison.result.growth)
    caption = "How positions part, from identical numbers at time 0; differences of exactly zero are not drawn."
    return [Section(heading="Do the codes agree?", figures=(Figure(uri=figures.png_uri(figure), caption=caption),))]
