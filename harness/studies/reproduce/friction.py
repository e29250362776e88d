"""`friction`: friction angles of boxes without cohesion, with mu = 0.5 at several pressures, and over mu.

Of each packing k, over all pressures, from what the walls measured (N/m, compression positive):

    internal angle      slope of the Mohr-Coulomb line sigma_zz = K sigma_xx + b through the peaks
    total angle         the line through the origin and the peaks, K = sum sigma_zz sigma_xx / sum sigma_xx^2
    geometrical angle   slope of the line through the plateaus at mu = 0, which has no peaks
    sin phi = (K - 1)/(K + 1)

The talk prints 27 and 31 degrees without saying how they are formed; this is a reading of them, and 27 degrees is also
arctan 0.5 = 26.6 degrees, the angle of the contacts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from harness.studies.reproduce.boxes import (
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
from harness.studies.reproduce.protocol import Ask, Case, Chart, Declared, Line, Measured, Picture, Result, Row, Study
from harness.studies.reproduce.rows import Within, compared, over_packings, shown, spanned
from harness.studies.reproduce.runs import Made, by_engine, engines_of, run_cases, study_runs, unsupported
from postproc.macro.fits.yield_locus import mohr_coulomb
from postproc.results import Unavailable
from reference.values import published_values

FILES = {"quick": shipped("biaxial_quick"), "paper": shipped("biaxial")}

MU = 0.5
PRESSURES = {"quick": (100.0, 200.0, 500.0), "paper": (40.0, 100.0, 200.0, 500.0)}
SERIES = {"quick": (0.1, 0.25, 1.0), "paper": (0.05, 0.1, 0.2, 0.3, 1.0)}
"""Coefficients of friction at `OF_SERIES`, besides 0 and 0.5."""

OF_SERIES = 100.0
"""N/m."""

DURATIONS = {"quick": (0.03, 0.06), "paper": (0.064, 0.128, 0.256)}
"""Of the drive, s; the second is the main one."""

MAIN = 1
ANGLE_TOLERANCE = 2.0
"""Degrees: what this study sets out to reach."""

PEAK, PLATEAU = "peak friction angle", "plateau friction angle"


def cases(ask: Ask) -> list[Case]:
    """Return mu = 0.5 and 0 at all pressures, the series at one, and the other rates."""
    durations = DURATIONS[ask.size]
    main, others = durations[MAIN], [t for k, t in enumerate(durations) if k != MAIN]
    found = [_case(ask, mu, p, main) for mu in (MU, 0.0) for p in PRESSURES[ask.size]]
    found += [_case(ask, mu, OF_SERIES, main) for mu in SERIES[ask.size]]
    return found + [_case(ask, mu, OF_SERIES, t) for t in others for mu in (MU, 0.0)]


def _case(ask: Ask, mu: float, pressure: float, duration: float) -> Case:
    file = FILES[ask.size]
    base = base_scene(file)
    sliding = replace(base.contact.sliding, shear_friction=mu) if mu else None
    scene = varied(
        base, file, pressure=pressure, duration=duration,
        title=f"Biaxial box, mu = {mu:g}, p = {pressure:g} N/m, T = {duration:g} s, {base.particles.count} discs",
        contact=replace(base.contact, sliding=sliding),
        outputs=replace(base.outputs, samples=500, frames=5, contacts=False, rotations=False),
    )
    return Case(name=_name(mu, pressure, duration), scene=scene, file=file, packings=STUDY.packings(ask))


def _name(mu: float, pressure: float, duration: float) -> str:
    return f"mu = {mu:g}, p_x = {pressure:g} N/m, T = {duration:g} s"


def run(ask: Ask) -> Result:
    """Run all tests, and put the angles beside the talk's."""
    planned, main = cases(ask), DURATIONS[ask.size][MAIN]
    made = run_cases(ask, planned, measure_box)
    of_main = [c for c in planned if c.scene.top.duration == main]
    angles = {e: box_angles(made, e, PRESSURES[ask.size], main) for e in engines_of(made)}
    rows = [*_angle_rows(angles, quick=ask.size == "quick"), *_series_rows(made, ask, main)]
    rates = _rates(made, planned)
    return Result(
        rows=tuple(rows), rates=tuple(rates), rate_words=rate_words(rates, what="angle"), runs=study_runs(made),
        checks=tuple(box_checks(made, of_main, {n: UNITS[n] for n in (PEAK, PLATEAU)}, rerun_of("friction", ask))),
        pictures=_pictures(made, ask, main), words=_words(angles), unsupported=unsupported(made),
        tables={"Tests": _test_rows(made, of_main)},
    )


# --- angles --------------------------------------------------------------------------------------


def peak_stresses(run: BoxRun) -> tuple[float, float]:
    """Return sigma_xx and sigma_zz (N/m) at the peak; NaN of a test without one."""
    axial = run.numbers.get("peak sigma_zz", np.nan)
    return axial / run.numbers.get("peak stress ratio", np.nan), axial


def plateau_stresses(run: BoxRun) -> tuple[float, float]:
    """Return the means sigma_xx and sigma_zz (N/m) over the plateau."""
    return run.numbers[SIDE], run.numbers["plateau sigma_zz"]


def slope_angle(side: np.ndarray, axial: np.ndarray) -> float:
    """Return the angle (degrees) of the straight line through the states; NaN where there is none."""
    line = mohr_coulomb(side, axial)
    return float("nan") if isinstance(line, Unavailable) else line.angle.value


def origin_angle(side: np.ndarray, axial: np.ndarray) -> float:
    """Return the angle (degrees) of the line through the origin, by least squares; NaN of states that are not known."""
    K = float(axial @ side / (side @ side))
    return float(np.degrees(np.arcsin((K - 1.0) / (K + 1.0))))


STATES: dict[str, tuple[float, Callable[[BoxRun], tuple[float, float]], Callable]] = {
    "internal": (MU, peak_stresses, slope_angle),
    "total": (MU, peak_stresses, origin_angle),
    "plateau, slope": (MU, plateau_stresses, slope_angle),
    "plateau, through the origin": (MU, plateau_stresses, origin_angle),
    "geometrical": (0.0, plateau_stresses, slope_angle),
    "geometrical, through the origin": (0.0, plateau_stresses, origin_angle),
}
"""Angles by name: mu, which stresses of a run, and the line through them."""


def box_angles(made: Sequence[Made], engine: str, pressures: Sequence[float], duration: float) -> dict[str, Measured]:
    """Return every angle of STATES over packings, degrees."""
    found = {}
    for name, (mu, stresses, line) in STATES.items():
        of = [by_engine(made, _name(mu, p, duration)).get(engine, {}) for p in pressures]
        shared = [k for k in of[0] if all(k in of_p for of_p in of)]
        states = [np.array([stresses(of_p[k]) for of_p in of]) for k in shared]
        found[name] = over_packings(engine, [line(s[:, 0], s[:, 1]) for s in states if np.isfinite(s).all()])
    return {name: of for name, of in found.items() if of.packings}


# --- rows ----------------------------------------------------------------------------------------

VALUES = {"internal": "talk_internal_angle", "total": "talk_total_angle", "geometrical": "talk_geometrical_angle"}
NO_NUMBER = "the talk prints no number"


def _angle_rows(angles: Mapping[str, Mapping[str, Measured]], *, quick: bool) -> list[Row]:
    goal = Within(tolerance=ANGLE_TOLERANCE)
    held = [
        compared(value, of[name], goal, quick=quick) for name, value in VALUES.items()
        for of in angles.values() if name in of
    ]
    return held + [
        shown(f"{'mu = 0.5: ' * (STATES[name][0] > 0)}{name}", "deg", of[name], NO_NUMBER)
        for name in STATES if name not in VALUES for of in angles.values() if name in of
    ]


def _series(ask: Ask) -> list[float]:
    return sorted({0.0, MU, *SERIES[ask.size]})


def _series_rows(made: Sequence[Made], ask: Ask, main: float) -> list[Row]:
    return [
        shown(f"{name}, mu = {mu:g}, p_x = {OF_SERIES:g} N/m", "deg", ours, NO_NUMBER)
        for name in (PEAK, PLATEAU) for mu in _series(ask)
        for ours in number_over_packings(made, _name(mu, OF_SERIES, main), name).values() if ours.packings
    ]


def _rates(made: Sequence[Made], planned: Sequence[Case]) -> list:
    found = []
    for mu, name in ((MU, PEAK), (MU, PLATEAU), (0.0, PLATEAU)):
        same = [c for c in planned if c.name.startswith(f"mu = {mu:g}, p_x = {OF_SERIES:g} N/m, ")]
        found += rate_points(made, same, name, quantity=f"{name}, mu = {mu:g}, p_x = {OF_SERIES:g} N/m")
    return found


def _test_rows(made: Sequence[Made], of_main: Sequence[Case]) -> list[dict]:
    """One row a test and engine: means over its packings; of peaks over those that have one."""
    heads = {
        "peak sigma_zz (N/m)": "peak sigma_zz", "peak angle (deg)": PEAK, "plateau sigma_zz (N/m)": "plateau sigma_zz",
        "plateau angle (deg)": PLATEAU, "volume strain at the end": "volume strain at the end",
    }
    rows = []
    for c in of_main:
        for engine, of in by_engine(made, c.name).items():
            found = {h: number_over_packings(made, c.name, n)[engine] for h, n in heads.items()}
            rows.append({
                "test": c.name, "engine": engine, "packings": len(of),
                "with a peak": found["peak angle (deg)"].packings,
                **{h: m.value if m.packings else None for h, m in found.items()},
                "side wall off p_x, mean of the plateau": float(np.mean([r.control for r in of.values()])),
                "largest inertial number": max(r.inertia for r in of.values()),
            })
    return rows


# --- pictures and words --------------------------------------------------------------------------


def _pictures(made: Sequence[Made], ask: Ask, main: float) -> tuple[Picture, ...]:
    engines = engines_of(made)
    return (
        _locus(made, ask, main, engines), _mu_chart(made, ask, main, engines),
        *(_curves(made, e, ask, main) for e in engines[:1]),
    )


def _locus(made: Sequence[Made], ask: Ask, main: float, engines: Sequence[str]) -> Chart:
    lines = []
    for mu, stresses, what in ((MU, peak_stresses, "peaks, mu = 0.5"), (0.0, plateau_stresses, "plateaus, mu = 0")):
        for e in engines:
            of = [by_engine(made, _name(mu, p, main)).get(e, {}) for p in PRESSURES[ask.size]]
            states = np.array([stresses(r) for of_p in of for r in of_p.values()]).reshape(-1, 2)
            known = states[np.isfinite(states).all(axis=1)]
            if len(known):
                lines.append(Line(name=f"{what}, {e}", x=known[:, 0], y=known[:, 1], look="points"))
    end = np.array([0.0, max(PRESSURES[ask.size])])
    for name, value in (("27 degrees", "talk_internal_angle"), ("31 degrees", "talk_total_angle"),
                        ("13 degrees", "talk_geometrical_angle")):
        sine = np.sin(np.radians(published_values()[value].value))
        lines.append(Line(name=f"talk: {name}", x=end, y=end * (1 + sine) / (1 - sine)))
    return Chart(
        name="yield", x="σ_xx (N/m)", y="σ_zz (N/m)", lines=tuple(lines),
        caption="Stresses at the peak (mu = 0.5) and at the plateau (mu = 0), one point a packing; lines through the "
        "origin: the talk's angles.",
    )


def _mu_chart(made: Sequence[Made], ask: Ask, main: float, engines: Sequence[str]) -> Chart:
    lines = []
    for name in (PEAK, PLATEAU):
        for e in engines:
            found = [(mu, number_over_packings(made, _name(mu, OF_SERIES, main), name).get(e)) for mu in _series(ask)]
            known = [(mu, m) for mu, m in found if m is not None and m.packings]
            if known:
                errors = [np.nan if m.error is None else m.error for _, m in known]
                lines.append(Line(
                    name=f"{name}, {e}", x=np.array([mu for mu, _ in known]), y=np.array([m.value for _, m in known]),
                    error=np.array(errors), look="points",
                ))
    x = np.linspace(0.0, max(_series(ask)), 101)
    lines.append(Line(name="arctan mu", x=x, y=np.degrees(np.arctan(x))))
    return Chart(
        name="series", x="coefficient of friction of the contacts", y="secant friction angle (degrees)",
        caption=f"Friction angle of the sample over that of the contacts, p_x = {OF_SERIES:g} N/m; bars: standard "
        "error over packings.", lines=tuple(lines),
    )


def _curves(made: Sequence[Made], engine: str, ask: Ask, main: float) -> Chart:
    runs = {mu: by_engine(made, _name(mu, OF_SERIES, main)).get(engine, {}) for mu in _series(ask)}
    return Chart(
        name="curves", x="axial strain (%)", y="secant friction angle (degrees)",
        caption=f"Mobilised friction, p_x = {OF_SERIES:g} N/m ({engine}), smoothed; bands: standard error over "
        "packings.",
        lines=tuple(
            mean_line(of, lambda c: c.smoothed(c.friction_angle), name=f"mu = {mu:g}") for mu, of in runs.items() if of
        ),
    )


def _words(angles: Mapping[str, Mapping[str, Measured]]) -> tuple[str, ...]:
    said = []
    for name, value in VALUES.items():
        talk, ours = published_values()[value].value, [of[name].value for of in angles.values() if name in of]
        if ours:
            said.append(f"{name} {spanned(ours, '.1f')} (the talk: {talk:g})")
    return (
        f"Angles in degrees, over all engines: {'; '.join(said)}.",
        "The talk does not say how its two angles are formed. Read here: internal, the slope of the line through the "
        "peaks of several pressures; total, the line through the origin. The 27 degrees are also arctan 0.5 = 26.6, "
        "the friction of the contacts itself, and then only the total one would be measured.",
        "Peaks are those of the first loading branch; after it the sample moves in bursts. Packings are prepared "
        "without friction, as dense as they get; the talk does not print its preparation.",
    )


STUDY = Study(
    name="friction",
    title="Friction without cohesion: internal, total and geometrical friction angle",
    claim="k_c = 0: an internal friction angle of 27 and a total one of 31 degrees at mu = 0.5, a geometrical one of "
    "13 degrees at mu = 0",
    source="S. Luding, 'Shear banding in granular materials', pages 'Friction - no cohesion' and 'Cohesion - no "
    "friction'",
    sizes={
        "quick": Declared(says="200 discs, p_x = 100, 200, 500 N/m, T = 0.06 s", packings=3),
        "paper": Declared(says="1950 discs, p_x = 40, 100, 200, 500 N/m, T = 0.128 s", packings=3),
    },
    engines=("lammps", "liggghts", "kernel:talk"),
    values=tuple(VALUES.values()),
    run=run,
    cases=cases,
)
