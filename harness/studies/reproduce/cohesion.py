"""`cohesion`: the plateau of ten cohesive, frictionless boxes, and the friction angle and cohesion that follow.

    sigma_zz = K p_x + 2 c sqrt(K),  K = (1 + sin phi)/(1 - sin phi)        (Mohr-Coulomb, two pressures)
    c ~ 1.8e-3 (k_2 - k_1)/(1 + k_2/k_c)                                    (the talk, under "macro cohesion")

(k_2 - k_1)/(1 + k_2/k_c) is the largest pull f_min of a contact over its largest overlap. Stresses of the line are
those that the walls measured. Packing k of both pressures has the same radii, so each packing gives its own phi and c.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from harness.studies.reproduce.boxes import (
    PAPER_COUNT,
    SIDE,
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
from harness.studies.reproduce.protocol import Ask, Case, Chart, Declared, Line, Measured, Picture, Result, Row, Study
from harness.studies.reproduce.rows import Spread, Within, compared, over_packings
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

PLATEAU = "plateau sigma_zz"
ANGLE_TOLERANCE = 2.0
"""Degrees: what this study sets out to reach."""

COHESION_TOLERANCE = 0.15
"""Of the talk's cohesion, likewise."""


def cases(ask: Ask) -> list[Case]:
    """Return the ten tests, and those at other rates."""
    main, *others = (DURATIONS[ask.size][MAIN], *(t for k, t in enumerate(DURATIONS[ask.size]) if k != MAIN))
    found = [_case(ask, p, r, main) for p in PRESSURES for r in RATIOS]
    return found + [_case(ask, p, r, t) for t in others for p in PRESSURES for r in OF_RATE]


def _case(ask: Ask, pressure: float, ratio: str, duration: float) -> Case:
    base = base_scene(FILE)
    count = PAPER_COUNT if ask.size == "paper" else base.particles.count
    law = base.contact.normal
    adhesion = RATIOS[ratio] * law.unloading_stiffness
    scene = varied(
        base, FILE, count=count, pressure=pressure, duration=duration,
        title=f"Cohesive box, k_c/k_2 = {RATIOS[ratio]:g}, p = {pressure:g} N/m, T = {duration:g} s, {count} discs",
        contact=replace(base.contact, normal=replace(law, adhesion_stiffness=adhesion)),
    )
    return Case(name=_name(pressure, ratio, duration), scene=scene, file=FILE, packings=STUDY.packings(ask))


def _name(pressure: float, ratio: str, duration: float) -> str:
    return f"p_x = {pressure:g} N/m, k_c/k_2 = {ratio}, T = {duration:g} s"


def run(ask: Ask) -> Result:
    """Run all tests, and put plateaus, angles and cohesions beside the talk's."""
    planned, main = cases(ask), DURATIONS[ask.size][MAIN]
    made = run_cases(ask, planned, measure_box)
    lines = {(e, r): yield_lines(made, e, r, main) for e in engines_of(made) for r in RATIOS}
    rows = [*_plateau_rows(made, ask, main), *_line_rows(lines, ask), *_slope_rows(lines, ask)]
    rated = [(r, p) for r in OF_RATE for p in PRESSURES]
    rates = [point for r, p in rated for point in _rate_points(made, planned, p, r)]
    of_main = [c for c in planned if c.scene.top.duration == main]
    return Result(
        rows=tuple(rows), rates=tuple(rates), rate_words=rate_words(rates, what="plateau stress"),
        runs=study_runs(made),
        checks=tuple(box_checks(made, of_main, (PLATEAU,), rerun_of("cohesion", ask))),
        pictures=_pictures(made, lines, main), words=_words(rows), unsupported=unsupported(made),
        tables={"Tests": _test_rows(made, of_main)},
    )


def _rate_points(made: Sequence[Made], planned: Sequence[Case], pressure: float, ratio: str):
    same = [c for c in planned if c.name.startswith(f"p_x = {pressure:g} N/m, k_c/k_2 = {ratio}, ")]
    return rate_points(made, same, PLATEAU, quantity=f"{PLATEAU}, p_x = {pressure:g} N/m, k_c/k_2 = {ratio}")


# --- the yield line ------------------------------------------------------------------------------


def yield_lines(made: Sequence[Made], engine: str, ratio: str, duration: float) -> dict[str, Measured]:
    """Return "angle" (degrees) and "cohesion" (N/m) over packings, from the plateaus of both pressures."""
    of = [by_engine(made, _name(p, ratio, duration)).get(engine, {}) for p in PRESSURES]
    lines = [two_point_line(*(of_p[k] for of_p in of)) for k in of[0] if all(k in of_p for of_p in of)]
    return {
        name: over_packings(engine, [line[k] for line in lines]) for k, name in enumerate(("angle", "cohesion"))
    }


def two_point_line(low: BoxRun, high: BoxRun) -> tuple[float, float]:
    """Return phi (degrees) and c (N/m) of the line through two tests; NaN where there is none."""
    side, axial = (np.array([r.numbers[name] for r in (low, high)]) for name in (SIDE, PLATEAU))
    line = mohr_coulomb(side, axial)
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


def _plateau_rows(made: Sequence[Made], ask: Ask, main: float) -> list[Row]:
    return [
        compared(f"talk_cohesion_{p:g}_{_key(r)}", ours, Spread(), quick=ask.size == "quick")
        for p in PRESSURES for r in RATIOS
        for ours in number_over_packings(made, _name(p, r, main), PLATEAU).values()
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


def _test_rows(made: Sequence[Made], of_main: Sequence[Case]) -> list[dict]:
    """One row a test and engine: means over its packings."""
    names = {"sigma_zz (N/m)": PLATEAU, "sigma_xx (N/m)": SIDE, "largest sigma_zz (N/m)": "largest sigma_zz"}
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


def _pictures(made: Sequence[Made], lines: Mapping, main: float) -> tuple[Picture, ...]:
    engines = engines_of(made)
    return (
        _cohesion_chart(lines, engines), *(_locus_chart(made, e, main) for e in engines[:1]),
        *(_curve_chart(made, engines[0], p, main) for p in PRESSURES if engines),
    )


def _cohesion_chart(lines: Mapping, engines: Sequence[str]) -> Chart:
    x = np.array([pull(r) for r in RATIOS])
    ours = [
        Line(
            name=e, engine=e, look="points", x=x, y=np.array([lines[e, r]["cohesion"].value for r in RATIOS]),
            error=_errors([lines[e, r]["cohesion"] for r in RATIOS]),
        )
        for e in engines
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


def _locus_chart(made: Sequence[Made], engine: str, main: float) -> Chart:
    found = []
    for r in RATIOS:
        side, axial = (
            [number_over_packings(made, _name(p, r, main), n)[engine] for p in PRESSURES
             if engine in by_engine(made, _name(p, r, main))]
            for n in (SIDE, PLATEAU)
        )
        x = np.array([m.value for m in side])
        found.append(Line(name=f"k_c/k_2 = {r}", x=x, y=np.array([m.value for m in axial]), error=_errors(axial),
                          look="points"))
        talk = [published_values()[f"talk_cohesion_{p:g}_{_key(r)}"].value for p in PRESSURES]
        found.append(Line(name="talk" if r == "0" else "", x=np.array(PRESSURES), y=np.array(talk), look="talk"))
    return Chart(
        name="plateaus", x="σ_xx (N/m)", y="σ_zz at the plateau (N/m)", lines=tuple(found),
        caption=f"Plateau stresses of all ten tests ({engine}) and the talk's.",
    )


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


def _words(rows: Sequence[Row]) -> tuple[str, ...]:
    """Say how far the numbers lie from the talk's, from the rows themselves."""
    known = [r for r in rows if r.deviation is not None]
    kinds = {
        "plateau stresses": [r for r in known if r.quantity.startswith("plateau")],
        "cohesions with k_c > 0": [r for r in known if "cohesion c" in r.quantity and not r.quantity.endswith("= 0")],
    }
    said = [f"{kind}: {_range([r.deviation / r.talk.value for r in of])}" for kind, of in kinds.items() if of]
    angles = [r for r in known if "angle" in r.quantity]
    said += [f"angles: {min(r.deviation for r in angles):+.1f} to {max(r.deviation for r in angles):+.1f} degrees"]
    return (
        f"Ours over the talk's, less one, over all engines: {'; '.join(said)}.",
        "What is not printed in the talk and decides such numbers: rate, mass and damping of the side wall, how the "
        "packing was prepared, and where on the curve sigma_zz was read. Here the side wall is light, so that the "
        "sample carries p_x; packings are frictionless and isotropic at the pressure of the test, on springs k_1.",
        "LAMMPS has no such law. LIGGGHTS computes its dashpot with up to twelve sizes of discs, hence radii in twelve "
        "steps.",
    )


def _range(parts: Sequence[float]) -> str:
    return f"{100 * min(parts):+.0f} to {100 * max(parts):+.0f} %"


STUDY = Study(
    name="cohesion",
    title="Cohesion without friction: plateau stresses, friction angle, macroscopic cohesion",
    claim="bi-axial compression at p_x = 100 and 500 with k_c/k_2 = 0, 1/2, 1, 2, 4: the plateau stress sigma_zz of "
    "all ten, a geometrical friction angle of 13 degrees, and a macroscopic cohesion c = 11, 32, 40, 60, 71 that grows "
    "as 1.8e-3 (k_2 - k_1)/(1 + k_2/k_c)",
    source="S. Luding, 'Shear banding in granular materials', pages 'Bi-axial compression with p_x = const.' and "
    "'Cohesion - no friction'",
    sizes={
        "quick": Declared(says="300 discs, T = 0.08 s, two packings", packings=2),
        "paper": Declared(says=f"{PAPER_COUNT} discs, T = 0.16 s, four packings", packings=4),
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
