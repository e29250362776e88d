"""Other drives: what a faster top wall and a heavier side wall make of a frictionless test, beside the talk's stresses.

The talk prints neither the duration of the drive nor the mass of the side wall. Both may raise what the top wall
carries: a fast drive by the inertia of the sample, a heavy side wall by its own, as the sample has to push it ahead
(m_x x'' = F_x - p_x z - gamma_x x' does not scale with p_x, so it may pass for cohesion). Here both are turned at
k_c = 0, far beyond what is slow, and the plateau and the top of the curve are put beside the talk's. It is a search
for an explanation: nothing is judged by it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from msgspec.structs import replace

from harness.scene.derived import peak_inertial_number
from harness.scene.grains import grains_of
from harness.scene.model import Biaxial
from harness.studies.reproduce.boxes import LARGEST, SIDE, BoxRun, varied
from harness.studies.reproduce.protocol import Case
from harness.studies.reproduce.runs import Made, by_engine, engines_of
from postproc.macro.fits.yield_locus import mohr_coulomb
from postproc.results import Unavailable

DURATIONS = (0.01, 0.02, 0.04)
"""Of the drive, s: the slowest is a quarter or half of the study's own."""

WALLS = {"as in the study": None, "as heavy as the sample": 1.0}
"""Mass of the side wall over that of all particles; None: the scene's own."""

PLATEAU = "plateau sigma_zz"
READINGS = {"plateau": PLATEAU, "top": LARGEST}


def drive_cases(scenes: Mapping[float, Biaxial], file: Path) -> list[Case]:
    """Return the variants of the tests `scenes` (by side pressure, N/m), each from one packing."""
    return [
        Case(name=_name(p, wall, duration), scene=_driven(scene, file, wall, duration), file=file, packings=1)
        for wall in WALLS for duration in DURATIONS for p, scene in scenes.items()
    ]


def _name(pressure: float, wall: str, duration: float) -> str:
    return f"another drive, p_x = {pressure:g} N/m, T = {duration:g} s, side wall {wall}"


def _driven(scene: Biaxial, file: Path, wall: str, duration: float) -> Biaxial:
    part = WALLS[wall]
    side = scene.side if part is None else replace(scene.side, mass=part * grains_of(scene).total_mass)
    return varied(
        scene, file, duration=duration, side=side, compare=replace(scene.compare, windows=()),
        title=f"{scene.title}; T = {duration:g} s, side wall of {side.mass:.3g} kg",
    )


def drive_rows(made: Sequence[Made], scenes: Mapping[float, Biaxial], talk: Mapping[float, float]) -> list[dict]:
    """Return one row an engine, wall and duration: stresses, inertial numbers, and the line through both pressures.

    talk: the talk's sigma_zz by pressure, N/m. The angle and c are those of p_x as set (which the talk has), and of
    the side stress that the wall measured; "off the talk" is the larger relative deviation of both pressures.
    """
    return [
        row for engine in engines_of(made) for wall in WALLS for duration in DURATIONS for what in READINGS
        if (row := _row(made, engine, scenes, talk, wall, duration, what)) is not None
    ]


def _row(
    made: Sequence[Made], engine: str, scenes: Mapping[float, Biaxial], talk: Mapping[float, float], wall: str,
    duration: float, what: str,
) -> dict | None:
    runs = {p: found_run(made, engine, _name(p, wall, duration)) for p in scenes}
    if any(r is None for r in runs.values()):
        return None
    axial = {p: r.numbers[READINGS[what]] for p, r in runs.items()}
    angle, cohesion = line_through(list(scenes), list(axial.values()))
    measured, _ = line_through([r.numbers[SIDE] for r in runs.values()], list(axial.values()))
    return {
        "engine": engine, "side wall": wall, "T (s)": duration, "read": what,
        **{f"I at p_x = {p:g} N/m": peak_inertial_number(_slowed(s, duration)) for p, s in scenes.items()},
        **{f"sigma_zz at p_x = {p:g} N/m (N/m)": s for p, s in axial.items()},
        **{f"sigma_xx at p_x = {p:g} N/m (N/m)": r.numbers[SIDE] for p, r in runs.items()},
        "phi, from p_x (deg)": angle, "phi, from sigma_xx (deg)": measured, "c, from p_x (N/m)": cohesion,
        "off the talk": max(abs(axial[p] / talk[p] - 1.0) for p in scenes),
    }


def _slowed(scene: Biaxial, duration: float) -> Biaxial:
    return replace(scene, top=replace(scene.top, duration=duration))


def found_run(made: Sequence[Made], engine: str, case: str) -> BoxRun | None:
    """Return the first run of a case, None if it has none."""
    return next(iter(by_engine(made, case).get(engine, {}).values()), None)


def line_through(side: Sequence[float], axial: Sequence[float]) -> tuple[float | None, float | None]:
    """Return phi (degrees) and c (N/m) of the Mohr-Coulomb line, None twice where there is none."""
    line = mohr_coulomb(np.array(side), np.array(axial))
    return (None, None) if isinstance(line, Unavailable) else (line.angle.value, line.cohesion.value)


def drive_words(rows: Sequence[Mapping], talk: Mapping[float, float]) -> str:
    """Say which drive comes nearest to the talk's two stresses (N/m, by pressure), and how near.

    Raises ValueError without a row.
    """
    best = min(rows, key=lambda r: r["off the talk"])
    angle, cohesion = line_through(list(talk), list(talk.values()))
    return (
        f"Other drives at k_c = 0 (table below): {len(rows)} readings of durations from {min(DURATIONS):g} to "
        f"{max(DURATIONS):g} s and of a side wall as in the study or as heavy as the sample. Nearest to the talk at "
        f"both pressures comes the {best['read']} of the curve at T = {best['T (s)']:g} s with a side wall "
        f"{best['side wall']}: {100.0 * best['off the talk']:.0f} % off at worst; the line through it has "
        f"phi = {_said(best['phi, from p_x (deg)'], '.1f')} degrees and c = "
        f"{_said(best['c, from p_x (N/m)'], '.0f')} N/m (the talk's two stresses: {_said(angle, '.1f')} and "
        f"{_said(cohesion, '.0f')})."
    )


def _said(value: float | None, digits: str) -> str:
    return "none" if value is None else f"{value:{digits}}"
