"""Another preparation: all boxes of the cohesion study once more, prepared far above both side pressures.

Contacts pull in proportion to the largest overlap that they remember, and cohesion is what does not follow p_x: so the
pressure of the preparation, which the talk does not print, sets its size. All ten tests start here from packings
prepared at PREPARED_AT, from which the side wall lets them go, and are read at the plateau and at the top of the
curve. PREPARED_AT was found by trying 500, 1000 and 2000 N/m, so that a match proves nothing: it says what would have
to be so. Nothing is judged by it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from msgspec.structs import replace

from harness.scene.model import Biaxial
from harness.studies.reproduce.boxes import varied
from harness.studies.reproduce.cohesion.drives import READINGS, found_run, line_through
from harness.studies.reproduce.protocol import Case
from harness.studies.reproduce.rows import spanned
from harness.studies.reproduce.runs import Made, engines_of

PREPARED_AT = 1000.0
"""N/m."""

TALK = "the talk's c (N/m)"

Tests = Mapping[tuple[float, str], Biaxial]
"""Scenes by side pressure (N/m) and k_c/k_2."""


def preparation_cases(tests: Tests, file: Path) -> list[Case]:
    """Return the tests from another preparation, each from one packing."""
    return [
        Case(name=_name(p, ratio), scene=_prepared(scene, file, p), file=file, packings=1)
        for (p, ratio), scene in tests.items()
    ]


def _name(pressure: float, ratio: str) -> str:
    return f"prepared at {PREPARED_AT:g} N/m, p_x = {pressure:g} N/m, k_c/k_2 = {ratio}"


def _prepared(scene: Biaxial, file: Path, pressure: float) -> Biaxial:
    return varied(
        scene, file, pressure=pressure, prepared_at=PREPARED_AT, compare=replace(scene.compare, windows=()),
        title=f"{scene.title}, prepared at {PREPARED_AT:g} N/m",
    )


def preparation_rows(
    made: Sequence[Made], tests: Tests, talk: Mapping[tuple[float, str], float], cohesion: Mapping[str, float]
) -> list[dict]:
    """Return one row an engine, reading and k_c/k_2: stresses, and angle and cohesion of the line, beside the talk's.

    talk: its sigma_zz by side pressure and k_c/k_2, cohesion: its c by k_c/k_2, N/m. Lines are those of p_x as set.
    """
    ratios = list(dict.fromkeys(ratio for _, ratio in tests))
    return [
        row for engine in engines_of(made) for what in READINGS for ratio in ratios
        if (row := _row(made, engine, what, ratio, talk, cohesion)) is not None
    ]


def _row(
    made: Sequence[Made], engine: str, what: str, ratio: str, talk: Mapping[tuple[float, str], float],
    cohesion: Mapping[str, float],
) -> dict | None:
    pressures = [p for p, r in talk if r == ratio]
    runs = {p: found_run(made, engine, _name(p, ratio)) for p in pressures}
    if any(r is None for r in runs.values()):
        return None
    axial = {p: r.numbers[READINGS[what]] for p, r in runs.items()}
    angle, c = line_through(pressures, list(axial.values()))
    columns = {"engine": engine, "read": what, "k_c/k_2": ratio}
    for p, stress in axial.items():
        columns |= {f"sigma_zz at p_x = {p:g} N/m (N/m)": stress, f"the talk's at {p:g} (N/m)": talk[p, ratio]}
    return columns | {
        "phi (deg)": angle, "c (N/m)": c, TALK: cohesion[ratio],
        "stresses off the talk": max((s / talk[p, ratio] - 1.0 for p, s in axial.items()), key=abs),
    }


def preparation_words(rows: Sequence[Mapping]) -> str:
    """Say, reading by reading, how far the stresses are off the talk's, and c beside the talk's."""
    said = []
    for what in READINGS:
        of = [r for r in rows if r["read"] == what]
        if of:
            off = spanned([100.0 * r["stresses off the talk"] for r in of], "+.0f")
            c = ", ".join("none" if r["c (N/m)"] is None else f"{r['c (N/m)']:.0f}" for r in of)
            said.append(f"read at the {what} of the curve, stresses are {off} % off the talk's and c = {c} N/m")
    theirs = ", ".join(f"{r[TALK]:g}" for r in rows if r["read"] == rows[0]["read"])
    return (
        f"Prepared at {PREPARED_AT:g} N/m, a pressure chosen after trying 500, 1000 and 2000: {'; '.join(said)} "
        f"(the talk: {theirs})."
    )
