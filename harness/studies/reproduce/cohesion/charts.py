"""Pictures of the page: cohesion over the pull, plateaus over k_c/k_2, stress over strain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from harness.studies.reproduce.boxes import mean_line, number_over_packings
from harness.studies.reproduce.cohesion.declared import (
    LOW,
    MEMORY,
    PLATEAU,
    PRESSURES,
    RATIOS,
    case_name,
    talk_cohesions,
    talk_plateau,
)
from harness.studies.reproduce.cohesion.lines import pull
from harness.studies.reproduce.cohesion.preparations import PREPARED_AT
from harness.studies.reproduce.protocol import Chart, Line, Measured, Picture
from harness.studies.reproduce.runs import Made, by_engine, engines_of
from reference.values import published_values


def pictures(
    made: Sequence[Made], lines: Mapping, remembered: Mapping, prepared: Sequence[Mapping], main: float
) -> tuple[Picture, ...]:
    """Return all of them. lines, remembered: of both preparations; prepared: rows of another one; main: duration, s."""
    engines = engines_of(made)
    return (
        _cohesion_chart(lines, remembered, prepared, engines),
        *(_plateau_chart(made, engines, p, main) for p in PRESSURES),
        *(_curve_chart(made, engines[0], p, main) for p in PRESSURES if engines),
    )


def _cohesion_chart(
    lines: Mapping, remembered: Mapping, prepared: Sequence[Mapping], engines: Sequence[str]
) -> Chart:
    x = np.array([pull(r) for r in RATIOS])
    ours = [
        _points(f"{e}, {what}", x, [of[e, r]["cohesion"] for r in RATIOS])
        for of, what in ((lines, "prepared at p_x"), (remembered, MEMORY)) for e in engines
    ]
    talk = np.array(list(talk_cohesions().values()))
    formula = published_values()["talk_cohesion_slope"].value * x
    return Chart(
        name="cohesion", x="(k_2 - k_1)/(1 + k_2/k_c) (N/m)", y="macroscopic cohesion c (N/m)",
        caption="Cohesion from the Mohr-Coulomb line against the largest pull of a contact over its overlap; bars: "
        "standard error over packings. Line: the talk's formula.",
        lines=(*ours, *_prepared_lines(prepared), Line(name="talk", x=x, y=talk, look="talk"),
               Line(name="talk: 1.8e-3 x", x=x, y=formula, look="fit")),
    )


def _prepared_lines(prepared: Sequence[Mapping]) -> list[Line]:
    """Return c of another preparation, engine by engine, read at the top of the curve; of one packing."""
    found = []
    for engine in dict.fromkeys(row["engine"] for row in prepared):
        rows = [r for r in prepared if (r["engine"], r["read"]) == (engine, "top") and r["c (N/m)"] is not None]
        found.append(Line(
            name=f"{engine}, prepared at {PREPARED_AT:g} N/m, top of the curve", look="points",
            x=np.array([pull(r["k_c/k_2"]) for r in rows]), y=np.array([r["c (N/m)"] for r in rows]),
        ))
    return found


def _plateau_chart(made: Sequence[Made], engines: Sequence[str], pressure: float, main: float) -> Chart:
    x = np.array(list(RATIOS.values()))
    lines = []
    for memory in (False, True) if pressure == LOW else (False,):
        of = [number_over_packings(made, case_name(pressure, r, main, memory=memory), PLATEAU) for r in RATIOS]
        known = [e for e in engines if all(e in m for m in of)]
        what = MEMORY if memory else "prepared at p_x"
        lines += [_points(f"{e}, {what}", x, [m[e] for m in of]) for e in known]
    talk = [talk_plateau(pressure, r) for r in RATIOS]
    return Chart(
        name=f"plateaus_{pressure:g}", x="k_c/k_2", y="σ_zz at the plateau (N/m)",
        caption=f"Plateau stresses at p_x = {pressure:g} N/m; bars: standard error over packings.",
        lines=(*lines, Line(name="talk", x=x, y=np.array(talk), look="talk")),
    )


def _points(name: str, x: np.ndarray, found: Sequence[Measured]) -> Line:
    return Line(name=name, look="points", x=x, y=np.array([m.value for m in found]), error=_errors(found))


def _curve_chart(made: Sequence[Made], engine: str, pressure: float, main: float) -> Chart:
    runs = {r: by_engine(made, case_name(pressure, r, main)).get(engine, {}) for r in RATIOS}
    return Chart(
        name=f"curves_{pressure:g}", x="axial strain (%)", y="σ_zz (N/m)",
        caption=f"Axial stress at p_x = {pressure:g} N/m ({engine}), smoothed; bands: standard error over packings.",
        lines=tuple(
            mean_line(of, lambda c: c.smoothed(c.stress_zz), name=f"k_c/k_2 = {r}") for r, of in runs.items() if of
        ),
    )


def _errors(found: Sequence[Measured]) -> np.ndarray | None:
    if any(m.error is None for m in found):
        return None
    return np.array([m.error for m in found])
