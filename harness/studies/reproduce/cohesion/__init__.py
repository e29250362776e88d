"""`cohesion`: the plateau of ten cohesive, frictionless boxes, and the friction angle and cohesion that follow.

    sigma_zz = K p_x + 2 c sqrt(K),  K = (1 + sin phi)/(1 - sin phi)        (Mohr-Coulomb, two pressures)
    c ~ 1.8e-3 (k_2 - k_1)/(1 + k_2/k_c)                                    (the talk, under "macro cohesion")

(k_2 - k_1)/(1 + k_2/k_c) is the largest pull f_min of a contact over its largest overlap. Stresses of the line are
those that the walls measured. Packing k of both pressures has the same radii, so each packing gives its own phi and c.

How the packing was prepared is not printed, and decides: under this law a contact pulls in proportion to the largest
overlap that it remembers. Prepared at p_x and much stiffer than p_x, a box has no other stress than p_x, so that
sigma_zz is proportional to it and c vanishes, whatever k_c is; cohesion needs a memory that does not follow p_x. So the
boxes at the smaller pressure are computed twice: prepared at p_x (the main ones), and prepared at the larger pressure,
from which the side wall lets them go at the start.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace as replaced

from harness.studies.reproduce.boxes import (
    UNITS,
    box_checks,
    measure_box,
    number_over_packings,
    rate_points,
    rate_words,
    rerun_of,
)
from harness.studies.reproduce.cohesion.charts import pictures
from harness.studies.reproduce.cohesion.declared import (
    DURATIONS,
    LOW,
    MAIN,
    MEMORY,
    OF_RATE,
    PLATEAU,
    PRESSURES,
    RATIOS,
    SIZES,
    case_name,
    cases,
    main_cases,
    main_tests,
    talk_cohesions,
    talk_plateau,
    talk_without_adhesion,
    value_key,
    without_adhesion,
)
from harness.studies.reproduce.cohesion.drives import drive_rows, drive_words
from harness.studies.reproduce.cohesion.lines import slope, yield_lines
from harness.studies.reproduce.cohesion.preparations import preparation_rows, preparation_words
from harness.studies.reproduce.cohesion.tables import reading_rows, test_rows
from harness.studies.reproduce.protocol import Ask, Case, Result, Row, Study
from harness.studies.reproduce.rows import Spread, Within, compared, spanned
from harness.studies.reproduce.runs import Made, engines_of, run_cases, study_runs, unsupported

ANGLE_TOLERANCE = 2.0
"""Degrees: what this study sets out to reach."""

COHESION_TOLERANCE = 0.15
"""Of the talk's cohesion, likewise."""


def run(ask: Ask) -> Result:
    """Run all tests, and put plateaus, angles and cohesions beside the talk's."""
    planned, main = cases(ask), DURATIONS[ask.size][MAIN]
    made = run_cases(ask, planned, measure_box)
    lines, remembered = (
        {(e, r): yield_lines(made, e, r, main, memory=memory) for e in engines_of(made) for r in RATIOS}
        for memory in (False, True)
    )
    rows = [*_plateau_rows(made, ask, main), *_line_rows(lines, ask), *_slope_rows(lines, ask)]
    again = [*_plateau_rows(made, ask, main, memory=True), *_line_rows(remembered, ask), *_slope_rows(remembered, ask)]
    again = [replaced(r, quantity=f"{r.quantity}, {MEMORY}") for r in again]
    rated = [(r, p) for r in OF_RATE for p in PRESSURES]
    rates = [point for r, p in rated for point in _rate_points(made, planned, p, r)]
    of_main, tests = main_cases(ask), main_tests(ask)
    drives = drive_rows(made, without_adhesion(tests), talk_without_adhesion())
    prepared = preparation_rows(made, tests, {key: talk_plateau(*key) for key in tests}, talk_cohesions())
    return Result(
        rows=(*rows, *again), rates=tuple(rates), rate_words=rate_words(rates, what="plateau stress"),
        runs=study_runs(made),
        checks=tuple(box_checks(made, of_main, {PLATEAU: UNITS[PLATEAU]}, rerun_of("cohesion", ask))),
        pictures=pictures(made, lines, remembered, prepared, main), words=_words(rows, again, drives, prepared),
        unsupported=unsupported(made),
        tables={
            "Other readings: the plateau or the top of the smoothed curve": reading_rows(made, main),
            "Another preparation": prepared,
            "Other drives and a heavier side wall, k_c = 0": drives,
            "Tests": test_rows(made, of_main),
        },
    )


def _rate_points(made: Sequence[Made], planned: Sequence[Case], pressure: float, ratio: str):
    same = [c for c in planned if c.name == case_name(pressure, ratio, c.scene.top.duration)]
    return rate_points(made, same, PLATEAU, quantity=f"{PLATEAU}, p_x = {pressure:g} N/m, k_c/k_2 = {ratio}")


# --- rows ----------------------------------------------------------------------------------------


def _plateau_rows(made: Sequence[Made], ask: Ask, main: float, *, memory: bool = False) -> list[Row]:
    return [
        compared(f"talk_cohesion_{p:g}_{value_key(r)}", ours, Spread(), quick=ask.size == "quick")
        for p in (PRESSURES if not memory else (LOW,)) for r in RATIOS
        for ours in number_over_packings(made, case_name(p, r, main, memory=memory), PLATEAU).values()
    ]


def _line_rows(lines: Mapping, ask: Ask) -> list[Row]:
    quick, angle = ask.size == "quick", Within(tolerance=ANGLE_TOLERANCE)
    goals = {r: Within(tolerance=COHESION_TOLERANCE, relative=True) if RATIOS[r] else Spread() for r in RATIOS}
    found = [
        compared(f"talk_macro_cohesion_{value_key(r)}", of["cohesion"], goals[r], quick=quick)
        for (_, r), of in lines.items()
    ]
    return found + [
        compared(f"talk_macro_angle_{value_key(r)}", of["angle"], angle, quick=quick) for (_, r), of in lines.items()
    ]


def _slope_rows(lines: Mapping, ask: Ask) -> list[Row]:
    engines = dict.fromkeys(e for e, _ in lines)
    return [
        compared("talk_cohesion_slope", slope(lines, e), Within(tolerance=COHESION_TOLERANCE, relative=True),
                 quick=ask.size == "quick")
        for e in engines
    ]


# --- words ---------------------------------------------------------------------------------------


def _words(
    rows: Sequence[Row], again: Sequence[Row], drives: Sequence[Mapping], prepared: Sequence[Mapping]
) -> tuple[str, ...]:
    """Say how far the numbers lie from the talk's, from the rows themselves."""
    return (
        f"Ours over the talk's, less one, over all engines. Prepared at p_x: {_apart(rows)}. "
        f"{MEMORY[0].upper()}{MEMORY[1:]}: {_apart(again)}.",
        "Prepared at p_x the box has no stress of its own but p_x (contacts are 1e-3 to 1e-2 of a radius deep): "
        "sigma_zz is then proportional to p_x, adhesion makes the friction angle larger, and the line through both "
        "pressures meets the origin. The talk's rows differ by nearly the same stress at both pressures, so its "
        "contacts must have remembered an overlap that does not follow p_x: from a preparation at one pressure, it "
        "seems. The second series shows how much of that a preparation at the larger pressure brings.",
        *([preparation_words(prepared)] if prepared else []),
        "Not printed in the talk either: rate, mass and damping of the side wall, and where on the curve sigma_zz "
        "was read. Here the side wall is light, so that the sample carries p_x; packings are frictionless and "
        "isotropic, on springs k_1.",
        *([drive_words(drives, talk_without_adhesion())] if drives else []),
        "LAMMPS has no such law. LIGGGHTS computes its dashpot with up to twelve sizes of discs, hence radii in twelve "
        "steps.",
    )


def _apart(rows: Sequence[Row]) -> str:
    known = [r for r in rows if r.deviation is not None]
    kinds = {
        "plateau stresses": [r for r in known if r.quantity.startswith("plateau")],
        "cohesions with k_c > 0": [r for r in known if "cohesion c" in r.quantity and r.talk.name[-2:] != "_0"],
    }
    said = [f"{kind} {_range([r.deviation / r.talk.value for r in of])}" for kind, of in kinds.items() if of]
    angles = [r.deviation for r in known if "angle" in r.quantity]
    return "; ".join([*said, f"angles {spanned(angles, '+.1f')} degrees"] if angles else said)


def _range(parts: Sequence[float]) -> str:
    return f"{spanned((100 * p for p in parts), '+.0f')} %"


STUDY = Study(
    name="cohesion",
    title="Cohesion without friction: plateau stresses, friction angle, macroscopic cohesion",
    claim="bi-axial compression at p_x = 100 and 500 with k_c/k_2 = 0, 1/2, 1, 2, 4: the plateau stress sigma_zz of "
    "all ten, a geometrical friction angle of 13 degrees, and a macroscopic cohesion c = 11, 32, 40, 60, 71 that grows "
    "as 1.8e-3 (k_2 - k_1)/(1 + k_2/k_c)",
    source="S. Luding, 'Shear banding in granular materials', pages 'Bi-axial compression with p_x = const.' and "
    "'Cohesion - no friction'",
    sizes=SIZES,
    engines=("lammps", "liggghts", "kernel:talk"),
    values=(
        *(f"talk_cohesion_{p:g}_{value_key(r)}" for p in PRESSURES for r in RATIOS),
        *(f"talk_macro_{what}_{value_key(r)}" for what in ("cohesion", "angle") for r in RATIOS), "talk_cohesion_slope",
    ),
    run=run,
    cases=cases,
    lacking={"lammps": "has no law with k_1, k_2 and k_c"},
)
