"""From measured rings to rows, convergence and checks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.engines.registry import find_engine
from harness.scene.judged import RING_MARGIN
from harness.scene.load import load_scene
from harness.scene.ring import area_fractions
from harness.studies.compare.alarms import handed_in
from harness.studies.compare.band import KNOWN_TO, PUBLISHED
from harness.studies.compare.pairs import pairs_of
from harness.studies.compare.pointwise import window_checks
from harness.studies.compare.profile_checks import FEWEST, profile_tests
from harness.studies.compare.profile_tests import compared_profiles
from harness.studies.compare.ring_checks import run_tests
from harness.studies.compare.versions import by_records, known_records
from harness.studies.reproduce.boxes import shipped
from harness.studies.reproduce.protocol import Ask, Case, Measured, RatePoint, Row
from harness.studies.reproduce.ring.cases import Plan, faster_than, main_plans
from harness.studies.reproduce.ring.measure import STATIC, RingRun
from harness.studies.reproduce.rows import Within, compared, held_against, over_packings, shown
from harness.studies.statistics.multiple import correct_together
from harness.studies.verdict import Check
from postproc.macro.fits.least_squares import Fit, fit_line, points
from postproc.results import Unavailable, headed
from reference.values import Published

EXPONENT_TOLERANCE = 0.1
"""Of the powers of r: what this study sets out to reach."""

WIDTH_TOLERANCE = 1 / 3
"""The talk prints a range, s/d = 1 to 2."""

RECALLED_TOLERANCE = 0.1

SLOPE_TOLERANCE = 0.02
"""Of E over tr F against isotropic contacts: the anisotropy, a tenth, counts in second order."""

TALK = dict(zip(STATIC, ("talk_ring_stress_rr", "talk_ring_stress_phiphi", "talk_ring_stress_rphi",
                         "talk_ring_stress_phir"), strict=True))

SHOWN = (
    "area fraction in the band", "area fraction outside", "eigen-rotation over Omega, lowest near the inner ring",
    "eigen-rotation over Omega, highest near the inner ring", "decay length of kinetic_stress_rr over d",
    "decay length of kinetic_stress_phiphi over d", "tr F in the band", "tr F outside", "dev F in the band",
    "dev F outside", "angle from stress to strain", "angle from stress to fabric",
)
"""Numbers for which the talk shows a picture and prints none."""

PROVEN = "couette_quick"

RATED = ("v_0", "s/d", *STATIC)

Runs = Mapping[str, Mapping[str, Mapping[int, RingRun]]]
"""By case, engine and packing."""


def over(engine: str, runs: Mapping[int, RingRun], name: str) -> Measured:
    """Return a number over packings; of one packing its error is that of the run's own averages."""
    found = [r.numbers[name] for r in runs.values() if name in r.numbers]
    if len(found) == 1:
        return Measured(engine=engine, value=found[0].value, error=found[0].error, packings=1)
    return over_packings(engine, [n.value for n in found])


def unit_of(runs: Mapping[int, RingRun], name: str) -> str:
    """Return the unit of a number."""
    return next((r.numbers[name].unit for r in runs.values() if name in r.numbers), "1")


# --- rows ----------------------------------------------------------------------------------------


def rows_of(ask: Ask, runs: Runs) -> list[Row]:
    """Return all rows: the band and the powers of r of each density, numbers without a talk's, and E over tr F."""
    found: list[Row] = []
    for plan in main_plans(ask):
        for engine, of in runs.get(plan.name, {}).items():
            found += [*_band_rows(plan, engine, of), *_power_rows(plan, engine, of)]
    return [*found, *_stiffness_rows(ask, runs)]


def _named(row: Row, plan: Plan) -> Row:
    return replace(row, quantity=f"{plan.name}: {row.quantity}")


def _band_rows(plan: Plan, engine: str, of: Mapping[int, RingRun]) -> list[Row]:
    none = next((r.band.why for r in of.values() if r.band.why), "")
    width = over(engine, of, "s/d")
    if none:
        return [_named(shown("shear band width s/d", "1", replace(width, value=float("nan"), error=None),
                             f"no shear band: {none}"), plan)]
    note = "" if width.error is None or width.error <= KNOWN_TO else "average longer"
    rows = [compared(PUBLISHED, width, Within(tolerance=WIDTH_TOLERANCE, relative=True), note=note)]
    if plan.density:
        rows += [
            compared(f"recalled_ring_{plan.density}_{word}", over(engine, of, name),
                     Within(tolerance=RECALLED_TOLERANCE, relative=True))
            for word, name in (("v0", "v_0"), ("width", "s/d"))
        ]
    else:
        rows.append(shown("v_0, speed of the discs at the inner ring over its own", "1", over(engine, of, "v_0"),
                          "the published values are those of the large rings"))
    return [_named(r, plan) for r in rows]


def _power_rows(plan: Plan, engine: str, of: Mapping[int, RingRun]) -> list[Row]:
    fits = {name: over(engine, of, name) for name in STATIC if any(name in r.numbers for r in of.values())}
    return [
        _named(compared(TALK[name], ours, Within(tolerance=EXPONENT_TOLERANCE)), plan) for name, ours in fits.items()
    ]


def shown_rows(ask: Ask, runs: Runs) -> list[dict]:
    """Return the numbers for which the talk shows a curve only: a row a ring and number, a column an engine."""
    rows = []
    for plan in main_plans(ask):
        of = runs.get(plan.name, {})
        for name in SHOWN:
            if any(name in r.numbers for by in of.values() for r in by.values()):
                first = next(iter(of.values()))
                cells = {e: _with_error(over(e, by, name)) for e, by in of.items()}
                rows.append({"ring": plan.name, "number": headed(name, unit_of(first, name)), **cells})
    return rows


def _with_error(m: Measured) -> str:
    return f"{m.value:.3g}" if m.error is None else f"{m.value:.3g} +- {m.error:.2g}"


# --- E against tr F ------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True, eq=False)
class Collapse:
    """E = E_0 + E_1 tr F over the cells of all densities, one engine. trace, bulk, error (P,); density (P,): its name.

    share: R^2, the part of the variance of E that the line explains. off: mean residual by density over the rms of all.
    """

    trace: np.ndarray
    bulk: np.ndarray
    error: np.ndarray
    density: np.ndarray
    line: Fit
    share: float
    off: Mapping[str, float]


def collapse(ask: Ask, runs: Runs, engine: str) -> Collapse | Unavailable:
    """Fit bulk stiffness against the trace of the fabric, cells away from the rings, all densities and packings."""
    trace, bulk, error, density = [], [], [], []
    for plan in main_plans(ask):
        for run in runs.get(plan.name, {}).get(engine, {}).values():
            p = run.profiles.profiles
            if "bulk_stiffness" not in p or "fabric_trace" not in p:
                continue
            used = run.inside & np.isfinite(p["bulk_stiffness"].mean) & (p["bulk_stiffness"].error > 0)
            trace += p["fabric_trace"].mean[used].tolist()
            bulk += p["bulk_stiffness"].mean[used].tolist()
            error += p["bulk_stiffness"].error[used].tolist()
            density += [plan.name] * int(used.sum())
    trace, bulk, error, density = (np.array(v) for v in (trace, bulk, error, density))
    line = fit_line(points(trace, bulk))  # cells of a run move together: their scatter tells more than their error bars
    if isinstance(line, Unavailable):
        return line
    left = bulk - np.polyval(line.parameters, trace)
    scatter = float(left.std())
    off = {name: float(left[density == name].mean() / scatter) for name in dict.fromkeys(density.tolist())}
    return Collapse(trace=trace, bulk=bulk, error=error, density=density, line=line, off=off,
                    share=1 - scatter**2 / float(bulk.var()))


def _stiffness_rows(ask: Ask, runs: Runs) -> list[Row]:
    """Return the slope of E over tr F against that of isotropic contacts, and what the line leaves at tr F = 0."""
    rows = []
    for engine in dict.fromkeys(e for plan in main_plans(ask) for e in runs.get(plan.name, {})):
        found = collapse(ask, runs, engine)
        if isinstance(found, Unavailable):
            continue
        slope, offset = (
            Measured(engine=engine, value=p.value, error=p.error, packings=1)
            for p in (found.line.parameter(0), found.line.parameter(1))
        )
        apart = "; ".join(f"{name} lies {o:+.2f} of the scatter off" for name, o in found.off.items())
        why = f"R^2 = {found.share:.4f} of {found.line.points} cells; {apart}"
        rows += [
            held_against(_isotropic(runs), slope, Within(tolerance=SLOPE_TOLERANCE, relative=True), note=why),
            shown("E at tr F = 0", "N/m", offset, "nothing, if E is proportional to tr F"),
        ]
    return rows


def _isotropic(runs: Runs) -> Published:
    """Return the slope k_n/pi: tr sigma = k_n sum a delta/V and tr eps = sum a delta/sum a^2, tr F = pi sum a^2/V.

    With all sums over contacts from both particles, isotropic; the deformation at a contact is half the overlap.
    """
    run = next(r for of in runs.values() for by in of.values() for r in by.values())
    return Published(
        name="isotropic_slope", quantity="slope of E over tr F", unit="N/m", kind="analytical", seen=True,
        value=run.scene.contact.normal.normal_stiffness / np.pi, origin="k_n/pi of linear springs, isotropic contacts",
        conditions="all densities, cells between the layers at the rings", date="2026-11-22", tolerance=SLOPE_TOLERANCE,
        reason="second order in the anisotropy of the contacts, a tenth here",
    )


# --- convergence and checks ----------------------------------------------------------------------


def rate_points(ask: Ask, runs: Runs) -> list[RatePoint]:
    """Return the band and the powers of r of the ring that turns twice as fast, and at its own rate."""
    return [
        RatePoint(quantity=name, unit="1", setting=f"omega = {next(iter(of.values())).scene.rings.omega:g} 1/s",
                  number=_wall_inertia(of), ours=over(engine, of, name))
        for name in RATED for engine in runs.get(faster_than(ask)[1].name, {}) for plan in faster_than(ask)
        for of in [runs.get(plan.name, {}).get(engine, {})] if any(name in r.numbers for r in of.values())
    ]


def _wall_inertia(of: Mapping[int, RingRun]) -> float | None:
    """Inertial number gamma' d sqrt(rho/p), gamma' = v_0 Omega R_i/s of the fit, of the first packing with a band."""
    run = next((r for r in of.values() if r.band.fit is not None and np.isfinite(r.balances.pressure)), None)
    if run is None:
        return None
    rings, mass = run.scene.rings, run.scene.particles.mass
    rate = run.band.fit.v0.value * abs(rings.omega) * rings.inner_radius / run.band.fit.s.value
    density = mass.density * mass.height * run.numbers["area fraction in the band"].value
    return float(rate * run.band.diameter * np.sqrt(density / run.balances.pressure))


def checks_of(cases: Sequence[Case], runs: Runs, rerun) -> list[Check]:
    """Return what `grainproof compare` checks of a ring, case by case: codes among each other, balances of each run.

    Profiles of codes decide over packings, from three on. Of fewer, error bars are those of time, which a slow flow
    makes too small: they decide nothing then but in the ring whose false alarms were counted, `PROVEN` as shipped.
    All tests of a case share one rate of false alarms (`harness.studies.compare.alarms`).
    """
    found = []
    for case in cases:
        of = runs.get(case.name, {})
        if not of:
            continue
        pairs = pairs_of(list(of), friction=True)
        curves, profiles, balances = (
            {e: {k: getattr(r, part) for k, r in by.items()} for e, by in of.items()}
            for part in ("curves", "profiles", "balances")
        )
        told = min(len(by) for by in of.values()) >= FEWEST or case.scene == load_scene(shipped(PROVEN))
        records = known_records([find_engine(e) for e in of], [next(iter(by.values())).system for by in of.values()])
        codes = profile_tests(pairs, profiles, rerun, RING_MARGIN, compared_profiles(pairs, profiles))
        each = run_tests(balances, rerun, RING_MARGIN)
        (alarms,) = correct_together(case.scene.compare.false_alarms, handed_in([*codes, *each]))
        made = [*(window_checks(pairs, case.scene.compare.windows, curves, rerun) if pairs else ()),
                *(c if told else _undecided(c) for c in (t.check(alarms.level) for t in codes)),
                *(by_records(t.check(alarms.level), records) for t in each)]
        found += [replace(c, quantity=f"{case.name}: {c.quantity}") for c in made]
    return found


def _undecided(check: Check) -> Check:
    if check.verdict not in ("agrees", "differs"):
        return check
    why = f"error bars of time in fewer than {FEWEST} packings: a slow flow makes them too small"
    return replace(check, verdict="inconclusive", why=f"{why}; {check.why}")


def table_rows(cases: Sequence[Case], runs: Runs) -> list[dict]:
    """Return every number of every ring, engine and packing, with the area fractions."""
    rows = []
    for case in cases:
        fractions = area_fractions(case.scene)
        for engine, of in runs.get(case.name, {}).items():
            for k, run in of.items():
                rows += [
                    {"ring": case.name, "free area fraction": fractions["free"], "bare": fractions["bare"],
                     "engine": engine, "packing": k + 1, "number": name, "unit": n.unit, "value": n.value,
                     "error": n.error}
                    for name, n in run.numbers.items()
                ]
    return rows
