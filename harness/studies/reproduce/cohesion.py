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

import numpy as np
from msgspec.structs import replace

from harness.scene.model import Biaxial
from harness.studies.reproduce.boxes import (
    LARGEST,
    PAPER_COUNT,
    SIDE,
    UNITS,
    BoxRun,
    base_scene,
    box_checks,
    mean_line,
    measure_box,
    number_over_packings,
    rate_points,
    rate_words,
    rerun_of,
    shipped,
    varied,
)
from harness.studies.reproduce.drives import drive_cases, drive_rows, drive_words
from harness.studies.reproduce.protocol import Ask, Case, Chart, Declared, Line, Measured, Picture, Result, Row, Study
from harness.studies.reproduce.rows import Spread, Within, compared, over_packings, spanned
from harness.studies.reproduce.runs import Made, by_engine, engines_of, run_cases, study_runs, unsupported
from postproc.macro.fits.yield_locus import mohr_coulomb
from postproc.results import Unavailable
from reference.values import published_values

FILE = shipped("biaxial_cohesion")

PRESSURES = (100.0, 500.0)
RATIOS = {"0": 0.0, "1/2": 0.5, "1": 1.0, "2": 2.0, "4": 4.0}
"""k_c/k_2 as the talk writes it."""

DURATIONS = {"quick": (0.04, 0.08), "paper": (0.08, 0.16, 0.32)}
"""Of the drive, s. The main one is the second; the others show the convergence, at `OF_RATE`."""

MAIN = 1
OF_RATE = ("0", "1")
"""k_c/k_2 whose convergence is shown."""

LOW, HIGH = PRESSURES
MEMORY = f"prepared at {HIGH:g} N/m"

PLATEAU = "plateau sigma_zz"
ANGLE_TOLERANCE = 2.0
"""Degrees: what this study sets out to reach."""

COHESION_TOLERANCE = 0.15
"""Of the talk's cohesion, likewise."""


def cases(ask: Ask) -> list[Case]:
    """Return the ten tests, five of them again with another preparation, and those at other rates."""
    main, *others = (DURATIONS[ask.size][MAIN], *(t for k, t in enumerate(DURATIONS[ask.size]) if k != MAIN))
    found = [_case(ask, p, r, main) for p in PRESSURES for r in RATIOS]
    found += [_case(ask, LOW, r, main, memory=True) for r in RATIOS]
    found += [_case(ask, p, r, t) for t in others for p in PRESSURES for r in OF_RATE]
    return found + drive_cases(_without_adhesion(found), FILE)


def _without_adhesion(planned: Sequence[Case]) -> dict[float, Biaxial]:
    """Return the main tests at k_c = 0, by side pressure: of those the drive is varied further."""
    return {c.scene.side.pressure: c.scene for c in planned[:len(PRESSURES) * len(RATIOS):len(RATIOS)]}


def _case(ask: Ask, pressure: float, ratio: str, duration: float, *, memory: bool = False) -> Case:
    base = base_scene(FILE)
    count = PAPER_COUNT if ask.size == "paper" else base.particles.count
    law = base.contact.normal
    adhesion = RATIOS[ratio] * law.unloading_stiffness
    scene = varied(
        base, FILE, count=count, pressure=pressure, duration=duration,
        prepared_at=HIGH if memory else None,
        title=f"Cohesive box, k_c/k_2 = {RATIOS[ratio]:g}, p = {pressure:g} N/m, T = {duration:g} s, {count} discs"
        + f", {MEMORY}" * memory,
        contact=replace(base.contact, normal=replace(law, adhesion_stiffness=adhesion)),
        compare=replace(base.compare, windows=() if memory else base.compare.windows),  # let go, the box rings at first
    )
    name = _name(pressure, ratio, duration, memory=memory)
    return Case(name=name, scene=scene, file=FILE, packings=STUDY.packings(ask))


def _name(pressure: float, ratio: str, duration: float, *, memory: bool = False) -> str:
    return f"p_x = {pressure:g} N/m, k_c/k_2 = {ratio}, T = {duration:g} s" + f", {MEMORY}" * memory


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
    of_main = [c for c in planned if c.scene.top.duration == main]
    drives = drive_rows(made, _without_adhesion(planned), _talk_without_adhesion())
    return Result(
        rows=(*rows, *again), rates=tuple(rates), rate_words=rate_words(rates, what="plateau stress"),
        runs=study_runs(made),
        checks=tuple(box_checks(made, of_main, {PLATEAU: UNITS[PLATEAU]}, rerun_of("cohesion", ask))),
        pictures=_pictures(made, lines, remembered, main), words=_words(rows, again, drives),
        unsupported=unsupported(made),
        tables={
            "Other readings: the plateau or the top of the smoothed curve": reading_rows(made, main),
            "Other drives and a heavier side wall, k_c = 0": drives,
            "Tests": _test_rows(made, of_main),
        },
    )


def _rate_points(made: Sequence[Made], planned: Sequence[Case], pressure: float, ratio: str):
    same = [c for c in planned if c.name == _name(pressure, ratio, c.scene.top.duration)]
    return rate_points(made, same, PLATEAU, quantity=f"{PLATEAU}, p_x = {pressure:g} N/m, k_c/k_2 = {ratio}")


# --- the yield line ------------------------------------------------------------------------------


def yield_lines(
    made: Sequence[Made], engine: str, ratio: str, duration: float, *, memory: bool, axial: str = PLATEAU
) -> dict[str, Measured]:
    """Return "angle" (degrees) and "cohesion" (N/m) over packings, from a stress `axial` at both pressures."""
    names = _name(LOW, ratio, duration, memory=memory), _name(HIGH, ratio, duration)
    of = [by_engine(made, name).get(engine, {}) for name in names]
    lines = [two_point_line(*(of_p[k] for of_p in of), axial) for k in of[0] if all(k in of_p for of_p in of)]
    return {
        name: over_packings(engine, [line[k] for line in lines]) for k, name in enumerate(("angle", "cohesion"))
    }


def two_point_line(low: BoxRun, high: BoxRun, axial: str = PLATEAU) -> tuple[float, float]:
    """Return phi (degrees) and c (N/m) of the line through two tests; NaN where there is none."""
    sides, stresses = (np.array([r.numbers[name] for r in (low, high)]) for name in (SIDE, axial))
    line = mohr_coulomb(sides, stresses)
    if isinstance(line, Unavailable):
        return float("nan"), float("nan")
    return line.angle.value, line.cohesion.value


def pull(ratio: str) -> float:
    """Return (k_2 - k_1)/(1 + k_2/k_c), N/m: f_min over the largest overlap; 0 without adhesion."""
    law = base_scene(FILE).contact.normal
    r = RATIOS[ratio]
    return (law.unloading_stiffness - law.loading_stiffness) / (1.0 + 1.0 / r) if r else 0.0


def slope(lines: Mapping[tuple[str, str], Mapping[str, Measured]], engine: str) -> Measured:
    """Return s of c = s (k_2 - k_1)/(1 + k_2/k_c), by least squares over k_c > 0, packing by packing."""
    adhesive = [r for r in RATIOS if RATIOS[r]]
    values = [lines[engine, r]["cohesion"].values for r in adhesive]
    count = min(len(v) for v in values)
    x = np.array([pull(r) for r in adhesive])
    return over_packings(engine, [float(x @ [v[k] for v in values] / (x @ x)) for k in range(count)])


# --- rows ----------------------------------------------------------------------------------------


def _key(ratio: str) -> str:
    return f"{RATIOS[ratio]:g}".replace(".", "_")


def _talk_without_adhesion() -> dict[float, float]:
    return {p: _talk_plateau(p, "0") for p in PRESSURES}


def _talk_plateau(pressure: float, ratio: str) -> float:
    return published_values()[f"talk_cohesion_{pressure:g}_{_key(ratio)}"].value


def _plateau_rows(made: Sequence[Made], ask: Ask, main: float, *, memory: bool = False) -> list[Row]:
    return [
        compared(f"talk_cohesion_{p:g}_{_key(r)}", ours, Spread(), quick=ask.size == "quick")
        for p in (PRESSURES if not memory else (LOW,)) for r in RATIOS
        for ours in number_over_packings(made, _name(p, r, main, memory=memory), PLATEAU).values()
    ]


def _line_rows(lines: Mapping, ask: Ask) -> list[Row]:
    quick, angle = ask.size == "quick", Within(tolerance=ANGLE_TOLERANCE)
    goals = {r: Within(tolerance=COHESION_TOLERANCE, relative=True) if RATIOS[r] else Spread() for r in RATIOS}
    found = [
        compared(f"talk_macro_cohesion_{_key(r)}", of["cohesion"], goals[r], quick=quick)
        for (_, r), of in lines.items()
    ]
    return found + [
        compared(f"talk_macro_angle_{_key(r)}", of["angle"], angle, quick=quick) for (_, r), of in lines.items()
    ]


def _slope_rows(lines: Mapping, ask: Ask) -> list[Row]:
    engines = dict.fromkeys(e for e, _ in lines)
    return [
        compared("talk_cohesion_slope", slope(lines, e), Within(tolerance=COHESION_TOLERANCE, relative=True),
                 quick=ask.size == "quick")
        for e in engines
    ]


def reading_rows(made: Sequence[Made], duration: float) -> list[dict]:
    """One row an engine and k_c/k_2: angle and cohesion of every reading, means over packings, and the talk's."""
    readings = {
        f"{what}, {MEMORY if memory else 'prepared at p_x'}": (axial, memory)
        for what, axial in (("plateau", PLATEAU), ("top", LARGEST)) for memory in (False, True)
    }
    rows = []
    for engine in engines_of(made):
        for ratio in RATIOS:
            found = {
                name: yield_lines(made, engine, ratio, duration, memory=memory, axial=axial)
                for name, (axial, memory) in readings.items()
            }
            rows.append({"engine": engine, "k_c/k_2": ratio, **{
                f"{head}, {name}": of[what].value if of[what].packings else None
                for what, head in (("cohesion", "c (N/m)"), ("angle", "phi (deg)")) for name, of in found.items()
            }, "c (N/m), talk": published_values()[f"talk_macro_cohesion_{_key(ratio)}"].value})
    return rows


def _test_rows(made: Sequence[Made], of_main: Sequence[Case]) -> list[dict]:
    """One row a test and engine: means over its packings."""
    names = {"sigma_zz (N/m)": PLATEAU, "sigma_xx (N/m)": SIDE, "largest sigma_zz (N/m)": LARGEST}
    rows = []
    for c in of_main:
        for engine, of in by_engine(made, c.name).items():
            found = {head: number_over_packings(made, c.name, name)[engine] for head, name in names.items()}
            rows.append({
                "test": c.name, "engine": engine, "packings": len(of),
                **{head: m.value for head, m in found.items()},
                "standard error of sigma_zz": found["sigma_zz (N/m)"].error,
                "side wall off p_x, mean of the plateau": float(np.mean([r.control for r in of.values()])),
                "largest inertial number": max(r.inertia for r in of.values()),
            })
    return rows


# --- pictures and words --------------------------------------------------------------------------


def _pictures(made: Sequence[Made], lines: Mapping, remembered: Mapping, main: float) -> tuple[Picture, ...]:
    engines = engines_of(made)
    return (
        _cohesion_chart(lines, remembered, engines),
        *(_plateau_chart(made, engines, p, main) for p in PRESSURES),
        *(_curve_chart(made, engines[0], p, main) for p in PRESSURES if engines),
    )


def _cohesion_chart(lines: Mapping, remembered: Mapping, engines: Sequence[str]) -> Chart:
    x = np.array([pull(r) for r in RATIOS])
    ours = [
        _points(f"{e}, {what}", x, [of[e, r]["cohesion"] for r in RATIOS])
        for of, what in ((lines, "prepared at p_x"), (remembered, MEMORY)) for e in engines
    ]
    values = published_values()
    talk = np.array([values[f"talk_macro_cohesion_{_key(r)}"].value for r in RATIOS])
    formula = values["talk_cohesion_slope"].value * x
    return Chart(
        name="cohesion", x="(k_2 - k_1)/(1 + k_2/k_c) (N/m)", y="macroscopic cohesion c (N/m)",
        caption="Cohesion from the Mohr-Coulomb line against the largest pull of a contact over its overlap; bars: "
        "standard error over packings. Line: the talk's formula.",
        lines=(*ours, Line(name="talk", x=x, y=talk, look="talk"),
               Line(name="talk: 1.8e-3 x", x=x, y=formula, look="fit")),
    )


def _plateau_chart(made: Sequence[Made], engines: Sequence[str], pressure: float, main: float) -> Chart:
    x = np.array(list(RATIOS.values()))
    lines = []
    for memory in (False, True) if pressure == LOW else (False,):
        of = [number_over_packings(made, _name(pressure, r, main, memory=memory), PLATEAU) for r in RATIOS]
        known = [e for e in engines if all(e in m for m in of)]
        what = MEMORY if memory else "prepared at p_x"
        lines += [_points(f"{e}, {what}", x, [m[e] for m in of]) for e in known]
    talk = [_talk_plateau(pressure, r) for r in RATIOS]
    return Chart(
        name=f"plateaus_{pressure:g}", x="k_c/k_2", y="σ_zz at the plateau (N/m)",
        caption=f"Plateau stresses at p_x = {pressure:g} N/m; bars: standard error over packings.",
        lines=(*lines, Line(name="talk", x=x, y=np.array(talk), look="talk")),
    )


def _points(name: str, x: np.ndarray, found: Sequence[Measured]) -> Line:
    return Line(name=name, look="points", x=x, y=np.array([m.value for m in found]), error=_errors(found))


def _curve_chart(made: Sequence[Made], engine: str, pressure: float, main: float) -> Chart:
    runs = {r: by_engine(made, _name(pressure, r, main)).get(engine, {}) for r in RATIOS}
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


def _words(rows: Sequence[Row], again: Sequence[Row], drives: Sequence[Mapping]) -> tuple[str, ...]:
    """Say how far the numbers lie from the talk's, from the rows themselves."""
    return (
        f"Ours over the talk's, less one, over all engines. Prepared at p_x: {_apart(rows)}. "
        f"{MEMORY[0].upper()}{MEMORY[1:]}: {_apart(again)}.",
        "Prepared at p_x the box has no stress of its own but p_x (contacts are 1e-3 to 1e-2 of a radius deep): "
        "sigma_zz is then proportional to p_x, adhesion makes the friction angle larger, and the line through both "
        "pressures meets the origin. The talk's rows differ by nearly the same stress at both pressures, so its "
        "contacts must have remembered an overlap that does not follow p_x: from a preparation at one pressure, it "
        "seems. The second series shows how much of that a preparation at the larger pressure brings.",
        "Not printed in the talk either: rate, mass and damping of the side wall, and where on the curve sigma_zz "
        "was read. Here the side wall is light, so that the sample carries p_x; packings are frictionless and "
        "isotropic, on springs k_1.",
        *([drive_words(drives, _talk_without_adhesion())] if drives else []),
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
    sizes={
        "quick": Declared(says="300 discs, T = 0.08 s", packings=3),
        "paper": Declared(says=f"{PAPER_COUNT} discs, T = 0.16 s", packings=4),
    },
    engines=("lammps", "liggghts", "kernel:talk"),
    values=(
        *(f"talk_cohesion_{p:g}_{_key(r)}" for p in PRESSURES for r in RATIOS),
        *(f"talk_macro_{what}_{_key(r)}" for what in ("cohesion", "angle") for r in RATIOS), "talk_cohesion_slope",
    ),
    run=run,
    cases=cases,
    lacking={"lammps": "has no law with k_1, k_2 and k_c"},
)
