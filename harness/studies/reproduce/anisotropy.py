"""`anisotropy`: how stress, structure and stiffness of the biaxial box become anisotropic, and where they saturate.

Of the frames' averages without a border layer, over the deviatoric strain eps_D = eps_zz - eps_xx (compression > 0):

    s_D = (sigma_zz - sigma_xx)/(sigma_zz + sigma_xx),  F_D and C_D likewise from F_zz, F_xx and C_zzzz, C_xxxx
    dC_D/d eps_D = beta_C (C_D^max - C_D)                                   (the talk, "An-isotropy")

so that C_D = C_D^max - (C_D^max - C_D(0)) exp(-beta_C eps_D), and the same for s_D and F_D with rates and limits of
their own (S. Luding, Int. J. Sol. Struct. 41, 5821 (2004)). C is the stiffness tensor of the normal springs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace as replaced

import numpy as np
from msgspec.structs import replace

from harness.scene.laws import elastic_stiffness
from harness.scene.model import Biaxial
from harness.studies.reproduce.boxes import (
    BoxRun,
    base_scene,
    box_checks,
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
from postproc.average import average
from postproc.macro.fits.saturation import fit_saturation
from postproc.results import Unavailable
from postproc.snapshot import Snapshot
from reference.values import published_values

FILES = {"quick": shipped("biaxial_quick"), "paper": shipped("biaxial")}
MU = 0.5
PRESSURES = {"quick": (100.0, 200.0, 500.0), "paper": (40.0, 100.0, 200.0, 500.0)}
AT = 100.0
"""N/m: where the talk's number is held against ours, mu is varied, and the convergence is shown."""

OTHER_MU = (0.0,)
"""Coefficients of friction besides: the talk does not print that of this page."""

DURATIONS = {"quick": (0.03, 0.06), "paper": (0.064, 0.128, 0.256)}
MAIN = 1
FRAMES = 100

FITTED = {"s_D": 0.04, "F_D": 0.10, "C_D": 0.10}
"""Up to which eps_D each is fitted: stress until it softens after its peak, structure and stiffness further."""

REACHED = 0.8
"""Part of the way to the limit that the data must cover: what lies further away is no limit but an extrapolation."""

TOLERANCE = 0.05
"""Of C_D max: what this study sets out to reach."""

LIMITS = {f"{q} max": "1" for q in FITTED}
RATES = {f"beta of {q}": "1" for q in FITTED}


def cases(ask: Ask) -> list[Case]:
    """Return the pressures, the other friction, and the other rates."""
    durations = DURATIONS[ask.size]
    main, others = durations[MAIN], [t for k, t in enumerate(durations) if k != MAIN]
    found = [_case(ask, MU, p, main) for p in PRESSURES[ask.size]]
    return [*found, *(_case(ask, mu, AT, main) for mu in OTHER_MU), *(_case(ask, MU, AT, t) for t in others)]


def _case(ask: Ask, mu: float, pressure: float, duration: float) -> Case:
    file = FILES[ask.size]
    base = base_scene(file)
    sliding = replace(base.contact.sliding, shear_friction=mu) if mu else None
    scene = varied(
        base, file, pressure=pressure, duration=duration,
        title=f"Anisotropy, mu = {mu:g}, p = {pressure:g} N/m, T = {duration:g} s, {base.particles.count} discs",
        contact=replace(base.contact, sliding=sliding),
        outputs=replace(base.outputs, samples=500, frames=FRAMES, contacts=True, rotations=False),
    )
    return Case(name=_name(mu, pressure, duration), scene=scene, file=file, packings=STUDY.packings(ask))


def _name(mu: float, pressure: float, duration: float) -> str:
    return f"mu = {mu:g}, p_x = {pressure:g} N/m, T = {duration:g} s"


def run(ask: Ask) -> Result:
    """Run all tests, fit, and put C_D max beside the talk's."""
    planned, main = cases(ask), DURATIONS[ask.size][MAIN]
    made = run_cases(ask, planned, measure)
    of_main = [c for c in planned if c.scene.top.duration == main]
    same = [c for c in planned if c.name.startswith(f"mu = {MU:g}, p_x = {AT:g} N/m, ")]
    rates = [
        point for name in LIMITS
        for point in rate_points(made, same, name, quantity=f"{name}, mu = {MU:g}, p_x = {AT:g} N/m", unit="1")
    ]
    rows = [*_talk_rows(made, ask, main), *_exponent_rows(made, ask, main), *_shown_rows(made, of_main)]
    return Result(
        rows=tuple(rows), rates=tuple(rates), rate_words=rate_words(rates, what="limit"), runs=study_runs(made),
        checks=tuple(box_checks(made, of_main, LIMITS, rerun_of("anisotropy", ask))),
        pictures=_pictures(made, ask, main), words=_words(made, ask, of_main, main), unsupported=unsupported(made),
    )


# --- one run -------------------------------------------------------------------------------------


def measure(case: Case, trajectory, system) -> BoxRun:
    """Measure a run at its walls, average its frames, and fit them."""
    box = measure_box(case, trajectory, system)
    states = anisotropies(trajectory.frames, case.scene)
    return replaced(box, states=states, numbers=box.numbers | saturations(states))


def anisotropies(frames: Sequence[Snapshot], scene: Biaxial) -> dict[str, np.ndarray]:
    """Return "eps_D", "s_D", "F_D" and "C_D" of every frame, (F,); vertical less horizontal, so that they grow."""
    first = np.asarray(frames[0].box)
    rows = []
    for frame in frames:
        strain = 1.0 - np.ptp(frame.box, axis=1) / np.ptp(first, axis=1)
        found = average(
            frame, cells="inner", fields=["stress", "fabric", "stiffness_anisotropy"],
            kn=elastic_stiffness(scene.contact.normal), kt=elastic_stiffness(scene.contact.sliding),
        )
        rows.append((
            strain[1] - strain[0], _excess(found["stress"][0]), _excess(found["fabric"][0]),
            -float(found["stiffness_anisotropy"][0]),
        ))
    return dict(zip(("eps_D", *FITTED), np.array(rows).T, strict=True))


def _excess(tensor: np.ndarray) -> float:
    """(T_yy - T_xx)/(T_yy + T_xx): our y is the talk's z."""
    return float((tensor[1, 1] - tensor[0, 0]) / (tensor[1, 1] + tensor[0, 0]))


def saturations(states: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Return limit and rate of each quantity by the names of LIMITS and RATES; NaN where the fit has none."""
    found = {}
    for name, high in FITTED.items():
        fit = fit_saturation(states["eps_D"], states[name], initial=float(states[name][0]), high=high)
        known = not isinstance(fit, Unavailable) and fit.reached >= REACHED
        found[f"{name} max"] = fit.plateau.value if known else float("nan")
        found[f"beta of {name}"] = fit.rate.value if known else float("nan")
    return found


# --- rows ----------------------------------------------------------------------------------------


def _talk_rows(made: Sequence[Made], ask: Ask, main: float) -> list[Row]:
    return [
        replaced(row, quantity=f"{row.quantity}, mu = {MU:g}, p_x = {p:g} N/m")
        for p in PRESSURES[ask.size]
        for ours in number_over_packings(made, _name(MU, p, main), "C_D max").values()
        for row in [compared("talk_stiffness_anisotropy", ours, Within(tolerance=TOLERANCE), quick=ask.size == "quick")]
    ]


def pressure_exponent(
    made: Sequence[Made], name: str, engine: str, pressures: Sequence[float], main: float
) -> Measured:
    """Return x of a rate ~ p_x^x, packing by packing: slope of ln rate over ln p_x by least squares."""
    of = [by_engine(made, _name(MU, p, main)).get(engine, {}) for p in pressures]
    packings = [k for k in of[0] if all(k in of_p for of_p in of)]
    rates = [[of_p[k].numbers[name] for of_p in of] for k in packings]
    slopes = [
        float(np.polyfit(np.log(pressures), np.log(r), 1)[0]) if np.isfinite(r).all() else float("nan") for r in rates
    ]
    return over_packings(engine, slopes)


def _exponent_rows(made: Sequence[Made], ask: Ask, main: float) -> list[Row]:
    return [
        shown(f"x in {name} ~ p_x^x, mu = {MU:g}", "1", ours, "the talk: the rate depends on p, no number")
        for name in RATES for e in engines_of(made)
        for ours in [pressure_exponent(made, name, e, PRESSURES[ask.size], main)] if ours.packings
    ]


def _shown_rows(made: Sequence[Made], of_main: Sequence[Case]) -> list[Row]:
    """Limits and rates of all tests but those that the talk's number is held against."""
    wanted = [*LIMITS, *RATES]
    return [
        shown(f"{name}, {c.name}", "1", ours, "the talk prints no number")
        for name in wanted for c in of_main
        for ours in number_over_packings(made, c.name, name).values()
        if ours.packings and not (name == "C_D max" and c.name.startswith(f"mu = {MU:g}"))
    ]


# --- pictures and words --------------------------------------------------------------------------

GRID = 0.25
"""eps_D up to which pictures are drawn."""


def _pictures(made: Sequence[Made], ask: Ask, main: float) -> tuple[Picture, ...]:
    engines = engines_of(made)
    return (
        *(_approach(made, q, engines, main) for q in FITTED),
        *(_over_pressure(made, ask, names, main, engines) for names in (LIMITS, RATES)),
    )


def _approach(made: Sequence[Made], quantity: str, engines: Sequence[str], main: float) -> Chart:
    lines = []
    for e in engines:
        runs = by_engine(made, _name(MU, AT, main)).get(e, {})
        if not runs:
            continue
        x, y, error = mean_states(list(runs.values()), quantity)
        lines.append(Line(name=e, engine=e, x=x, y=y, error=error, look="line"))
    if lines:
        first = next(iter(by_engine(made, _name(MU, AT, main)).values()))
        lines.append(_fitted(list(first.values()), quantity))
    talk = published_values()["talk_stiffness_anisotropy"].value
    if quantity == "C_D":
        lines.append(Line(name="talk: maximum", x=np.array([0.0, GRID]), y=np.array([talk, talk])))
    return Chart(
        name=f"approach_{quantity}", x="deviatoric strain ε_zz - ε_xx", y=quantity, lines=tuple(lines),
        caption=f"{quantity} at mu = {MU:g}, p_x = {AT:g} N/m: mean over packings, band of its standard error; dashed: "
        f"exponential approach with the mean limit and rate, fitted up to {FITTED[quantity]:g}.",
    )


def mean_states(runs: Sequence[BoxRun], quantity: str) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Return eps_D (S,), mean over runs (S,) and its standard error, on a grid of strains that all runs reach."""
    end = min(GRID, *(float(r.states["eps_D"].max()) for r in runs))
    x = end * np.linspace(0.0, 1.0, 121) ** 2
    rows = []
    for r in runs:
        strain, value = (np.asarray(r.states[n]) for n in ("eps_D", quantity))
        order = np.argsort(strain, kind="stable")
        rows.append(np.interp(x, strain[order], value[order]))
    error = np.std(rows, axis=0, ddof=1) / np.sqrt(len(rows)) if len(rows) > 1 else None
    return x, np.mean(rows, axis=0), error


def _fitted(runs: Sequence[BoxRun], quantity: str) -> Line:
    limit, rate = (np.nanmean([r.numbers[n] for r in runs]) for n in (f"{quantity} max", f"beta of {quantity}"))
    initial = float(np.mean([r.states[quantity][0] for r in runs]))
    x = np.linspace(0.0, FITTED[quantity], 101)
    return Line(name="fit", x=x, y=limit - (limit - initial) * np.exp(-rate * x), look="fit")


def _over_pressure(
    made: Sequence[Made], ask: Ask, names: Mapping[str, str], main: float, engines: Sequence[str]
) -> Chart:
    lines = []
    for name in names:
        for e in engines:
            found = [
                (p, of[e]) for p in PRESSURES[ask.size]
                for of in [number_over_packings(made, _name(MU, p, main), name)] if e in of and of[e].packings
            ]
            if found:
                lines.append(Line(
                    name=f"{name}, {e}", look="points", x=np.array([p for p, _ in found]),
                    y=np.array([m.value for _, m in found]), error=_errors([m for _, m in found]),
                ))
    limits = names is LIMITS
    return Chart(
        name="limits" if limits else "rates", x="p_x (N/m)", y="limit" if limits else "rate β", log_x=True,
        log_y=not limits, lines=tuple(lines),
        caption=f"{'Limits' if limits else 'Rates'} of the exponential approach over the side pressure, mu = {MU:g}; "
        "bars: standard error over packings.",
    )


def _errors(found: Sequence[Measured]) -> np.ndarray:
    return np.array([np.nan if m.error is None else m.error for m in found])


def _words(made: Sequence[Made], ask: Ask, of_main: Sequence[Case], main: float) -> tuple[str, ...]:
    return (
        " ".join([*_limit_words(made, ask, of_main, main), *_rate_says(made, ask, main)]),
        "The talk does not print friction, adhesion and pressure of this page, nor over which part of the box it "
        "averages. Here C_D counts all contacts of the discs away from the walls, each with the same stiffness.",
    )


def _limit_words(made: Sequence[Made], ask: Ask, of_main: Sequence[Case], main: float) -> list[str]:
    """Say C_D max where the talk's is held against it, without friction, and over all pressures."""
    def of(case: str) -> list[Measured]:
        return [m for m in number_over_packings(made, case, "C_D max").values() if m.packings]

    talk = published_values()["talk_stiffness_anisotropy"].value
    at = of(_name(MU, AT, main))
    other = [m for c in of_main if not c.name.startswith(f"mu = {MU:g}") for m in of(c.name)]
    every = [m for p in PRESSURES[ask.size] for m in of(_name(MU, p, main))]
    said = [f"C_D max at mu = {MU:g}, p_x = {AT:g} N/m: {_range(at)}; the talk: {talk:g}."]
    said += [f"Over all pressures: {_range(every)}."] if every else []
    return said + ([f"Without friction: {_range(other)}."] if other else [])


def _rate_says(made: Sequence[Made], ask: Ask, main: float) -> list[str]:
    """Say the rates where the talk's number is held against ours, and how they depend on the pressure."""
    said = []
    for name in RATES:
        at = [m.value for m in number_over_packings(made, _name(MU, AT, main), name).values() if m.packings]
        x = [pressure_exponent(made, name, e, PRESSURES[ask.size], main) for e in engines_of(made)]
        known = [m.value for m in x if m.packings]
        if at and known:
            said.append(
                f"The {name} is {np.mean(at):.0f} at this pressure and goes as p_x^x, x = {spanned(known, '.2f')}."
            )
    return said


def _range(found: Sequence[Measured]) -> str:
    if not found:
        return "not known"
    return spanned((m.value for m in found), ".3f") + " over engines" * (len(found) > 1)


STUDY = Study(
    name="anisotropy",
    title="Anisotropy: stress, fabric and stiffness against deviatoric strain",
    claim="the stiffness anisotropy C_D approaches its maximum exponentially with the deviatoric strain; the maximum "
    "is constant, about 0.34, the rate depends on the pressure",
    source="S. Luding, 'Shear banding in granular materials', pages 'Stiffness tensor' and 'An-isotropy'",
    sizes={
        "quick": Declared(says="200 discs, p_x = 100, 200, 500 N/m, T = 0.06 s", packings=3),
        "paper": Declared(says="1950 discs, p_x = 40, 100, 200, 500 N/m, T = 0.128 s", packings=3),
    },
    engines=("lammps", "liggghts", "kernel:talk"),
    values=("talk_stiffness_anisotropy",),
    run=run,
    cases=cases,
)
