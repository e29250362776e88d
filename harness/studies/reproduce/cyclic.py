"""`cyclic`: the biaxial box under cycles of axial strain: density and stress against strain, and what accumulates.

The top wall goes down by a strain and up again, z(t) = z_f + (z_0 - z_f)/2 (1 + cos(pi t/T)), the side wall carries
p_x. Per cycle n = 1, 2, ..., from what the walls measure:

    nu             area of the discs over that of the box, at the end of the cycle (the wall is back where it began)
    eps_V          1 - x z/(x_0 z_0) there: what has accumulated
    sigma_zz       mean of the samples around the largest strain
    W              -(integral of sigma_zz dz)/z_0 over the cycle, N/m: work done on the sample per its area, dissipated
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from harness.scene.derived import peak_inertial_number
from harness.studies.compare.curves import BiaxialCurves, biaxial_curves
from harness.studies.compare.run_checks import PLACE_TOLERANCE, place_error
from harness.studies.compare.signal import signal_deviation
from harness.studies.reproduce.boxes import (
    PAPER_COUNT,
    BoxRun,
    base_scene,
    between_codes,
    number_over_packings,
    rate_points,
    rate_words,
    rerun_of,
    shipped,
    varied,
)
from harness.studies.reproduce.protocol import Ask, Case, Chart, Declared, Line, Picture, Result, Row, Study
from harness.studies.reproduce.rows import shown, spanned
from harness.studies.reproduce.runs import Made, by_engine, engines_of, run_cases, study_runs, unsupported
from harness.studies.verdict import Check, judged

FILE = shipped("biaxial_cyclic")
COUNTS = {"quick": 200, "paper": PAPER_COUNT}
CYCLES = {"quick": 5, "paper": 10}
DURATIONS = {"quick": (0.006, 0.012), "paper": (0.0128, 0.0256, 0.0512)}
"""Of half a cycle, s; the second is the main one."""

MAIN = 1
A_CYCLE = 100
"""Samples of a cycle."""

AROUND = 3
"""Samples on either side of the largest strain over which its stress is meaned."""

NU, VOLUME, STRESS, WORK = (
    "area fraction at the end of cycle", "volume strain at the end of cycle", "sigma_zz at the largest strain of cycle",
    "work dissipated in cycle",
)
UNITS = {NU: "1", VOLUME: "1", STRESS: "N/m", WORK: "N/m"}
LAST_CHANGE = "change of the area fraction in the last cycle"
PLACES = "misplacement of the walls over the travel"


def of_cycle(name: str, n: int) -> str:
    """Return a number's name in cycle n, counted from 1."""
    return f"{name} {n}"


def cases(ask: Ask) -> list[Case]:
    """Return the test at every rate, the main one first."""
    durations = DURATIONS[ask.size]
    return [_case(ask, t) for t in (durations[MAIN], *(t for k, t in enumerate(durations) if k != MAIN))]


def _case(ask: Ask, duration: float) -> Case:
    base, count, cycles = base_scene(FILE), COUNTS[ask.size], CYCLES[ask.size]
    scene = varied(
        base, FILE, count=count, duration=duration, top=replace(base.top, cycles=cycles),
        title=f"{cycles} cycles of {100 * base.top.final_strain:g} %, T = {duration:g} s, {count} discs",
        outputs=replace(base.outputs, samples=A_CYCLE * cycles, frames=2 * cycles),
    )
    return Case(name=f"T = {duration:g} s", scene=scene, file=FILE, packings=STUDY.packings(ask))


def run(ask: Ask) -> Result:
    """Run the cycles at all rates, and show what accumulates."""
    planned, cycles = cases(ask), CYCLES[ask.size]
    main = planned[0]
    made = run_cases(ask, planned, measure)
    rates = [
        p for name in UNITS for n in (1, cycles)
        for p in rate_points(made, planned, of_cycle(name, n), quantity=of_cycle(name, n), unit=UNITS[name])
    ]
    names = {of_cycle(name, n): UNITS[name] for name in UNITS for n in (1, cycles) if name != VOLUME}
    rerun = rerun_of("cyclic", ask)
    return Result(
        rows=tuple(_rows(made, main.name, cycles)), rates=tuple(rates), rate_words=_rate_words(rates),
        checks=(*between_codes(made, [main], names, rerun, friction=True), *_place_checks(made, main.name, rerun)),
        pictures=_pictures(made, main.name, cycles), words=_words(made, main.name, cycles), runs=study_runs(made),
        unsupported=unsupported(made), tables={"Cycle by cycle": _cycle_rows(made, main.name, cycles)},
    )


# --- one run -------------------------------------------------------------------------------------


def measure(case: Case, trajectory, system) -> BoxRun:
    """Measure a run's walls, cycle by cycle."""
    curves = biaxial_curves(trajectory, system)
    area = float(np.pi * (system.particles.radius**2).sum())
    numbers = cycle_numbers(curves, area, case.scene.top.cycles)
    numbers[PLACES] = place_error(trajectory, system)
    return BoxRun(
        curves=curves, numbers=numbers, inertia=peak_inertial_number(case.scene, system),
        control=float(curves.control_error.mean()), states={"nu": area / (curves.x * curves.z)},
    )


def cycle_numbers(curves: BiaxialCurves, area: float, cycles: int) -> dict[str, float]:
    """Return the numbers of every cycle by name, from (S,) samples of which every cycle has as many; area: m^2."""
    each = (len(curves.time) - 1) // cycles
    nu, found = area / (curves.x * curves.z), {}
    for n in range(1, cycles + 1):
        begin, end = (n - 1) * each, n * each
        deepest = begin + int(np.argmax(curves.strain[begin : end + 1]))
        near = slice(max(0, deepest - AROUND), deepest + AROUND + 1)
        inside = slice(begin, end + 1)
        found |= {
            of_cycle(NU, n): float(nu[end]), of_cycle(VOLUME, n): float(curves.volume_strain[end]),
            of_cycle(STRESS, n): float(curves.stress_zz[near].mean()),
            of_cycle(WORK, n): float(np.trapezoid(curves.stress_zz[inside], curves.strain[inside])),
        }
    found[LAST_CHANGE] = float(nu[cycles * each] - nu[(cycles - 1) * each])
    return found


# --- rows and checks -----------------------------------------------------------------------------


def _rows(made: Sequence[Made], case: str, cycles: int) -> list[Row]:
    why = "the talk shows a curve and prints no number"
    wanted = {of_cycle(name, n): unit for name, unit in UNITS.items() for n in (1, cycles)} | {LAST_CHANGE: "1"}
    return [
        shown(name, unit, ours, why)
        for name, unit in wanted.items() for ours in number_over_packings(made, case, name).values()
    ]


def _place_checks(made: Sequence[Made], case: str, rerun) -> list[Check]:
    """Each engine's walls are where the cycles have them, at every sample and frame of all of them."""
    return [
        judged(
            level="run", quantity="places of the walls, all cycles", left=engine, right="z(t), frames = series",
            deviation=max(r.numbers[PLACES] for r in of.values()), tolerance=PLACE_TOLERANCE,
            why=f"largest over the travel, {len(of)} packings", rerun=rerun(engine),
        )
        for engine, of in by_engine(made, case).items()
    ]


def _cycle_rows(made: Sequence[Made], case: str, cycles: int) -> list[dict]:
    heads = {NU: "area fraction", VOLUME: "volume strain", STRESS: "sigma_zz (N/m)", WORK: "work (N/m)"}
    rows = []
    for engine in engines_of(made):
        for n in range(1, cycles + 1):
            found = {name: number_over_packings(made, case, of_cycle(name, n))[engine] for name in UNITS}
            errors = {f"{heads[name]}, error": m.error for name, m in found.items()}
            rows.append({"engine": engine, "cycle": n, **{heads[k]: m.value for k, m in found.items()}, **errors})
    return rows


# --- pictures and words --------------------------------------------------------------------------


def _pictures(made: Sequence[Made], case: str, cycles: int) -> tuple[Picture, ...]:
    first = {e: of[0] for e, of in by_engine(made, case).items() if 0 in of}
    if not first:
        return ()
    return (
        _against_strain(first, cycles, "density", "area fraction", lambda r: r.states["nu"]),
        _against_strain(first, cycles, "stress", "σ_zz (N/m)", lambda r: r.curves.stress_zz),
        *(_over_cycles(made, case, cycles, name) for name in (NU, STRESS, WORK)), _parting(first),
    )


def _against_strain(first: dict[str, BoxRun], cycles: int, name: str, label: str, value) -> Chart:
    """The first engine, the first two cycles and the last."""
    engine, run = next(iter(first.items()))
    each, strain, y = (len(run.curves.time) - 1) // cycles, 100 * run.curves.strain, value(run)
    shown_cycles = sorted({1, min(2, cycles), cycles})
    return Chart(
        name=name, x="axial strain (%)", y=label,
        caption=f"{'Density' if name == 'density' else 'Axial stress'} down and up again ({engine}, first packing).",
        lines=tuple(
            Line(name=f"cycle {n}", x=strain[(n - 1) * each : n * each + 1], y=y[(n - 1) * each : n * each + 1])
            for n in shown_cycles
        ),
    )


def _over_cycles(made: Sequence[Made], case: str, cycles: int, name: str) -> Chart:
    n = np.arange(1, cycles + 1)
    lines = []
    for e in engines_of(made):
        found = [number_over_packings(made, case, of_cycle(name, int(k)))[e] for k in n]
        lines.append(Line(
            name=e, engine=e, look="points", x=n.astype(float), y=np.array([m.value for m in found]),
            error=np.array([np.nan if m.error is None else m.error for m in found]),
        ))
    short = {NU: "area_fraction", STRESS: "largest_stress", WORK: "work"}[name]
    return Chart(
        name=short, x="cycle", y=f"{name.removesuffix(' of cycle').removesuffix(' in cycle')} ({UNITS[name]})"
        if UNITS[name] != "1" else name.removesuffix(" of cycle"), lines=tuple(lines),
        caption=f"{name[0].upper()}{name[1:]}; bars: standard error over packings.",
    )


def _parting(first: dict[str, BoxRun]) -> Chart:
    """Every engine's top-wall force beside the first engine's, sample by sample."""
    reference, *others = first
    lines = []
    for e in others:
        apart = signal_deviation(first[reference].curves.signal, first[e].curves.signal)
        lines.append(Line(name=e, engine=e, x=first[e].curves.time[1:], y=np.maximum(apart[1:], 1e-17)))
    return Chart(
        name="parting", x="time (s)", y=f"top-wall force: relative difference from {reference}", log_y=True,
        lines=tuple(lines), caption="How far the codes follow each other, first packing: up to round-off or to "
        "differences of convention at first, until chaos parts them.",
    )


def _words(made: Sequence[Made], case: str, cycles: int) -> tuple[str, ...]:
    def range_of(name: str) -> tuple[float, float]:
        values = [m.value for m in number_over_packings(made, case, name).values()]
        return min(values), max(values)

    if not engines_of(made):
        return ("No run was completed.",)
    first, last, change = (range_of(n) for n in (of_cycle(VOLUME, 1), of_cycle(VOLUME, cycles), LAST_CHANGE))
    return (
        f"Over all engines: after the first cycle the volume strain is {spanned((100 * f for f in first), '.2f')} % "
        f"(compression > 0), after {cycles} cycles {spanned((100 * f for f in last), '.2f')} %; in the last cycle the "
        f"area fraction still changes by {spanned(change, '+.1e')}.",
        "The talk shows such curves beside those of a hypoplastic model, without parameters; there is no number to "
        "hold these against. The packing is dense, as it is prepared without friction.",
    )


def _rate_words(points) -> str:
    said = [
        f"{name}: {rate_words([p for p in points if p.quantity.startswith(name)], what='value')}"
        for name in (NU, STRESS, WORK)
    ]
    return " ".join(said)


STUDY = Study(
    name="cyclic",
    title="Strain-controlled cycles: density and stress against strain",
    claim="density against strain under cyclic deformation, with creep from cycle to cycle",
    source="S. Luding, 'Shear banding in granular materials', page 'Continuum theory: deformation - rotations, cyclic "
    "deformations - creep'",
    sizes={
        "quick": Declared(says="200 discs, five cycles of 2 %, half a cycle in 0.012 s", packings=3),
        "paper": Declared(says="1950 discs, ten cycles of 2 %, half a cycle in 0.0256 s", packings=3),
    },
    engines=("lammps", "liggghts", "kernel"),
    values=(),
    run=run,
    cases=cases,
)
