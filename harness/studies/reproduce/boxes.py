"""What the studies of the biaxial box share: variants of a shipped scene, what is measured in a run, and its checks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from harness.scene.checks import first_fault
from harness.scene.derived import peak_inertial_number
from harness.scene.laws import turning
from harness.scene.load import load_scene
from harness.scene.model import Biaxial
from harness.studies.compare.curves import BiaxialCurves, biaxial_curves
from harness.studies.compare.macro import MACRO, macro_values, plateau_mean
from harness.studies.compare.pairs import declared_for, pairs_of
from harness.studies.compare.pointwise import window_checks
from harness.studies.compare.run_checks import CONTROL_TOLERANCE, INERTIA_LIMIT, inertial_numbers
from harness.studies.reproduce.protocol import Ask, Case, Line, Measured, RatePoint
from harness.studies.reproduce.rows import over_packings, spanned
from harness.studies.reproduce.runs import Made, by_engine, engines_of
from harness.studies.statistics.family import Measured as Judgeable
from harness.studies.statistics.family import Terms, family_checks, judge_family
from harness.studies.verdict import Check, judged

if TYPE_CHECKING:
    from harness.scene.system import System
    from postproc.trajectory import Trajectory

PAPER_COUNT = 1950
"""Discs of the talk's box (Luding, IJSS 41, 5821 (2004), recalled)."""

SIDE, LARGEST = "plateau sigma_xx", "largest sigma_zz"
"""Besides `harness.studies.compare.macro.MACRO`: mean over the plateau, and the top of the smoothed curve."""

UNITS: Mapping[str, str] = {name: unit for name, (unit, _) in MACRO.items()} | {SIDE: "N/m", LARGEST: "N/m"}
"""Of the numbers of every `BoxRun`; a study that measures more says the units of those itself."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BoxRun:
    """One run of a box. numbers: by name, see UNITS. inertia: largest inertial number of the drive.

    control: mean over the plateau (the second half of the test where none is declared) of (F_x - p_x z)/(p_x z).
    states: averages of the frames by name, (F,) and more, for studies that take them; else empty.
    """

    curves: BiaxialCurves
    numbers: Mapping[str, float]
    inertia: float
    control: float
    states: Mapping[str, np.ndarray] = field(default_factory=dict)


def shipped(name: str) -> Path:
    """Return a scene file of this checkout by its name."""
    return Path(__file__).resolve().parents[3] / "inputs" / "scenes" / f"{name}.toml"


def base_scene(file: Path) -> Biaxial:
    """Return a shipped box."""
    scene = load_scene(file)
    assert isinstance(scene, Biaxial)
    return scene


def varied(
    base: Biaxial, file: Path, *, title: str, count: int | None = None, pressure: float | None = None,
    prepared_at: float | None = None, duration: float | None = None, **tables,
) -> Biaxial:
    """Return the scene with another number of discs, side pressure, duration, or whole tables.

    It is prepared at the side pressure unless `prepared_at` (N/m) says otherwise.

    The title belongs to the deck, so that one variant has one title. Raises InputError for a scene that cannot be.
    """
    changes = {"title": title, **tables}
    if count is not None:
        changes["particles"] = replace(base.particles, count=count)
    if pressure is not None:
        changes["side"] = replace(tables.get("side", base.side), pressure=pressure)
        changes["preparation"] = replace(base.preparation, pressure=prepared_at or pressure)
    if duration is not None:
        changes["top"] = replace(tables.get("top", base.top), duration=duration)
    scene = replace(base, **changes)
    fault = first_fault(scene, file.parent)
    if fault:
        raise fault.error(file)
    return scene


def measure_box(case: Case, trajectory: Trajectory, system: System) -> BoxRun:
    """Measure a finished run at its walls."""
    curves = biaxial_curves(trajectory, system)
    plateau = case.scene.compare.plateau or (0.5 * case.scene.top.final_strain, case.scene.top.final_strain)
    numbers = macro_values(curves, case.scene) | {
        SIDE: plateau_mean(curves.stress_xx, curves, plateau),
        LARGEST: float(curves.smoothed(curves.stress_zz).max()),
    }
    return BoxRun(
        curves=curves, numbers=numbers, inertia=float(np.nanmax(inertial_numbers(trajectory, system))),
        control=plateau_mean(curves.control_error, curves, plateau),
    )


def number_over_packings(made: Sequence[Made], case: str, name: str) -> dict[str, Measured]:
    """Return a number of a case over its packings, by engine."""
    return {
        engine: over_packings(engine, [run.numbers.get(name, np.nan) for run in of.values()])
        for engine, of in by_engine(made, case).items()
    }


def rate_points(
    made: Sequence[Made], cases: Sequence[Case], name: str, *, quantity: str, unit: str = ""
) -> list[RatePoint]:
    """Return a number (see `BoxRun.numbers`) of one test at several rates, the fastest first, engine by engine."""
    order = sorted(cases, key=lambda c: c.scene.top.duration)
    unit = unit or UNITS[name]
    found = [(c, number_over_packings(made, c.name, name)) for c in order]
    return [
        RatePoint(
            quantity=quantity, unit=unit, setting=f"T = {c.scene.top.duration:g} s",
            number=peak_inertial_number(c.scene), ours=of[engine],
        )
        for engine in engines_of(made) for c, of in found if engine in of
    ]


def rate_words(points: Sequence[RatePoint], *, what: str) -> str:
    """Say how much `what` changes from the second slowest drive to the slowest, over quantities and engines."""
    last = {}
    for a, b in zip(points, points[1:], strict=False):
        if (a.quantity, a.ours.engine) == (b.quantity, b.ours.engine):
            last[b.quantity, b.ours.engine] = b.ours.value / a.ours.value - 1.0
    known = [change for change in last.values() if np.isfinite(change)]
    if not known:
        return "No test ran at two rates."
    low, high = 100 * min(known), 100 * max(known)
    return f"From the second slowest drive to the slowest the {what} changes by {spanned((low, high), '+.1f')} %."


def mean_line(runs: Mapping[int, BoxRun], value: Callable[[BiaxialCurves], np.ndarray], **facts) -> Line:
    """Return a curve against axial strain in per cent: mean over packings, band of its standard error."""
    first = next(iter(runs.values())).curves.strain
    rows = np.array([np.interp(first, r.curves.strain, value(r.curves)) for r in runs.values()])
    error = rows.std(axis=0, ddof=1) / np.sqrt(len(rows)) if len(rows) > 1 else None
    return Line(x=100.0 * first, y=rows.mean(axis=0), error=error, **facts)


# --- checks --------------------------------------------------------------------------------------

Rerun = Callable[..., str]
"""Names of engines in, the command that computes for them out."""


def rerun_of(name: str, ask: Ask) -> Rerun:
    """Return what writes the command of a study for some engines."""
    packings = f" --packings {ask.packings}" if ask.packings else ""
    return lambda *engines: f"grainproof reproduce {name} --size {ask.size} --engines {','.join(engines)}{packings}"


def box_checks(made: Sequence[Made], cases: Sequence[Case], units: Mapping[str, str], rerun: Rerun) -> list[Check]:
    """Return what must hold between the codes, and of each run.

    Between codes: the top wall's force pointwise before chaos, over all cases and packings, as the scenes declare it;
    after it the numbers that `units` names, of every case, packing by packing.
    """
    frictions = {c.name: bool(turning(c.scene.contact)) for c in cases}
    found = []
    for friction in sorted(set(frictions.values())):
        group = [c for c in cases if frictions[c.name] is friction]
        found += between_codes(made, group, units, rerun, friction=friction)
    return [*found, *run_checks(made, cases, rerun)]


def between_codes(
    made: Sequence[Made], cases: Sequence[Case], units: Mapping[str, str], rerun: Rerun, *, friction: bool
) -> list[Check]:
    """Return the checks of the codes among each other, of cases with friction or of cases without."""
    wanted = {c.name for c in cases}
    followed = {c.name for c in cases if c.scene.compare.windows}
    pairs = pairs_of(engines_of([m for m in made if m.case in wanted]), friction=friction)
    compare = cases[0].scene.compare
    windows = {w: None for c in cases for w in c.scene.compare.windows if declared_for(w.pairs, pairs)}
    quantities = [_judgeable(made, c.name, name, unit) for c in cases for name, unit in units.items()]
    terms = Terms(false_alarms=compare.false_alarms, margin=compare.margin, paired=True)
    return [
        *window_checks(pairs, list(windows), _all_curves(made, followed), rerun),
        *family_checks(judge_family(quantities, pairs, terms), rerun),
    ]


def _judgeable(made: Sequence[Made], case: str, name: str, unit: str) -> Judgeable:
    values = {
        engine: {k: run.numbers.get(name, np.nan) for k, run in of.items()}
        for engine, of in by_engine(made, case).items()
    }
    return Judgeable(quantity=f"{name}, {case}", unit=unit, values=values)


def _all_curves(made: Sequence[Made], cases: set[str]) -> dict[str, dict]:
    found: dict[str, dict] = {}
    for m in made:
        if m.case in cases and m.found is not None:
            found.setdefault(m.engine, {})[m.case, m.packing] = m.found.curves
    return found


def run_checks(made: Sequence[Made], cases: Sequence[Case], rerun: Rerun) -> list[Check]:
    """Each engine's side wall carries p_x on average over the plateau, and its drive is slow: the worst of all runs."""
    wanted = {c.name for c in cases}
    found = []
    for engine in engines_of(made):
        runs = {f"{m.case}, packing {m.packing + 1}": m.found for m in made
                if m.engine == engine and m.found is not None and m.case in wanted}
        found += [
            _worst(engine, runs, lambda r: abs(r.control), "p_x",
                   "side wall (F_x - p_x z)/(p_x z), mean of the plateau", CONTROL_TOLERANCE, rerun),
            _worst(engine, runs, lambda r: r.inertia, "slow drive", "rate of the drive (axial inertial number)",
                   INERTIA_LIMIT, rerun),
        ]
    return found


def _worst(engine: str, runs: Mapping[str, BoxRun], of, right: str, quantity: str, tolerance: float, rerun) -> Check:
    where = max(runs, key=lambda name: of(runs[name]))
    return judged(
        level="run", quantity=quantity, left=engine, right=right, deviation=of(runs[where]), tolerance=tolerance,
        why=f"worst of {len(runs)} runs: {where}", rerun=rerun(engine),
    )
