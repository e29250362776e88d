"""`contact`: the hysteretic law from measured curves, with error bars, into a scene, and measured back on the codes.

The talk shows how a contact is pressed, released and pulled off, and the law with k_1, k_2, k_c made for it; its curves
are pictures of which the transcript keeps the axes. So the fit is proven on curves of a known law with noise, applied
to a file of the user's own where there is one, and every code that has the law must answer it back.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.studies.laws.drive import Driver
from harness.studies.reproduce.contact.axes import axes_rows
from harness.studies.reproduce.contact.back import Indenter, Spheres, law_of
from harness.studies.reproduce.contact.charts import cycle_chart, hysteresis_chart, line_chart, pull_off_chart
from harness.studies.reproduce.contact.curves import Measurements, read_measurements
from harness.studies.reproduce.contact.fit import (
    DRAWS,
    NAMES,
    LawFit,
    LineFit,
    fit_cycle,
    fit_line,
    propagated,
    pull_off_slope,
)
from harness.studies.reproduce.contact.loads import (
    Answer,
    answers,
    back_rows,
    law_checks,
    load_rows,
    refused,
    slope_rates,
)
from harness.studies.reproduce.contact.scene import write_fitted_scene
from harness.studies.reproduce.contact.synthetic import Coverage, Truth, coverages
from harness.studies.reproduce.protocol import Ask, Chart, Declared, Measured, Result, Row, Study
from harness.studies.reproduce.rows import Within, held_against, shown
from harness.studies.verdict import Check, judged
from reference.values import Published

SPHERES = Spheres(radius=2e-6, density=1050.0)
"""Of the scene and of the drive: chosen (polystyrene, some micrometres); no measured curve says them."""

FIT_TOLERANCE = 0.02
"""Of a stiffness that is known: what the fit of one synthetic curve sets out to reach, error bar included."""

CURVES = {"quick": (200, 60, 100), "paper": (2000, 400, 400)}
"""Synthetic curves for the covariance and for the bootstrap, and its draws."""

BEYOND = {"quick": 8.0, "paper": 57.0}
"""Seconds of fits and drives on an idle core (measured)."""

RATE_WORDS = (
    "Nothing here has a rate: the law knows no time, and paths are prescribed. What converges is the fit: error bars "
    "fall with the number of points; and pull-off over load is the same at every load, as the law is linear."
)


def run(ask: Ask) -> Result:
    """Fit synthetic curves and the user's file, write the scene, and measure the law back on every engine that has it.

    Raises InputError for a file that is none of the three kinds, before anything is run.
    """
    found = None if ask.measurements is None else read_measurements(ask.measurements)
    truth = Truth()
    synthetic = fit_cycle(truth.cycle(1))
    own = _own_fit(found)
    source = found.name if isinstance(own, LawFit) else "a synthetic curve"
    fit = own if isinstance(own, LawFit) else synthetic
    scene = write_fitted_scene(ask.out / "scenes" / "contact_fitted.toml", fit, SPHERES, source)
    driver = Driver(root=ask.out / "runs", time_limit=min(ask.time_limit, 600.0), workers=1)
    answered = answers(law_of(*fit.values[:3]), Indenter(spheres=SPHERES, largest=fit.largest), ask.engines, driver)
    covered = coverages(truth, curves=CURVES[ask.size][0], bootstraps=CURVES[ask.size][1], draws=CURVES[ask.size][2])
    return Result(
        rows=(*_synthetic_rows(synthetic, truth), *_own_rows(found, own), *back_rows(answered, fit),
              *load_rows(answered, fit)),
        rates=(*_by_points(truth), *slope_rates(answered)), rate_words=RATE_WORDS,
        checks=(*(_coverage_check(c) for c in covered), *law_checks(answered, fit, _rerun(ask))),
        pictures=_pictures(truth, synthetic, found, own, answered, fit),
        tables={"What the transcript shows": axes_rows(), "Error bars": _error_rows(synthetic, own, found)},
        words=_words(synthetic, own, found, covered, scene), unsupported=refused(answered),
    )


def refuse(ask: Ask) -> None:
    """Raise InputError for packings, of which there are none, and for a file that no law can be fitted to."""
    if ask.packings is not None:
        raise InputError(file="--packings", expected="nothing, as contact has no packings", got=ask.packings)
    if ask.measurements is not None:
        _own_fit(read_measurements(ask.measurements), draws=0)


def _own_fit(found: Measurements | None, draws: int = DRAWS) -> LawFit | LineFit | None:
    if found is None:
        return None
    return fit_cycle(found.cycle(), name=found.name, draws=draws) if found.kind == "cycle" else fit_line(found)


# --- rows ----------------------------------------------------------------------------------------


def _synthetic_rows(fit: LawFit, truth: Truth) -> list[Row]:
    return [
        held_against(
            Published(
                name=f"synthetic_{name}", quantity=f"{name} of a synthetic curve", value=float(value), unit="N/m",
                kind="analytical", origin="the law that the curve was made of", seen=True, date="2026-11-22",
                conditions=f"noise {1e9 * truth.noise:g} nN, {2 * truth.points - 1} points", tolerance=FIT_TOLERANCE,
                reason="what the fit of one curve sets out to reach",
            ),
            Measured(engine="fit", value=float(fit.values[k]), error=float(fit.errors[k]), packings=1),
            Within(tolerance=FIT_TOLERANCE, relative=True), note=f"bootstrap error {fit.bootstrap_errors[k]:.2g} N/m",
        )
        for k, (name, value) in enumerate(zip(NAMES[:3], truth.stiffnesses, strict=True))
    ]


def _own_rows(found: Measurements | None, own: LawFit | LineFit | None) -> list[Row]:
    if isinstance(own, LineFit):
        unit, quantity = ("1", "pull-off over load") if found.kind == "pull-off" else ("m/N", "1/k_1 - 1/k_2")
        ours = Measured(engine="fit", value=own.slope, error=own.slope_error, packings=1)
        why = f"slope of {own.points} points; offset {own.offset:.3g} +- {own.offset_error:.2g}, which the law has not"
        return [shown(f"{quantity}, {found.name}", unit, ours, why)]
    if not isinstance(own, LawFit):
        return []
    rows = []
    for k, name in enumerate(NAMES):
        known = np.isfinite(own.errors[k])
        error = float(own.errors[k]) if known else None
        ours = Measured(engine="fit", value=float(own.values[k]), error=error, packings=1)
        why = f"fit of {found.name}; bootstrap error {own.bootstrap_errors[k]:.2g}" if known else (
            "no point lies on the adhesive branch: this is the least k_c that the deepest pull allows")
        rows.append(shown(f"{name}, {found.name}", "m" if name == "x_0" else "N/m", ours, why))
    return rows


def _by_points(truth: Truth):
    from dataclasses import replace

    from harness.studies.reproduce.protocol import RatePoint

    found = []
    for points in (40, 150, 600):
        fit = fit_cycle(replace(truth, points=points).cycle(1), draws=0)
        ours = Measured(engine="fit", value=float(fit.values[2]), error=float(fit.errors[2]), packings=1)
        found.append(RatePoint(quantity="k_c of a synthetic curve", unit="N/m", setting=f"{points} points each way",
                               number=1 / points, ours=ours))
    return found


def _coverage_check(c: Coverage) -> Check:
    return judged(
        level="L3", quantity=f"95 % intervals of k_1, k_2, k_c, {c.source}", left="fit", right="known law",
        deviation=abs(c.share - 0.95), tolerance=c.room, rerun="grainproof reproduce contact",
        why=f"hold the truth in {100 * c.share:.1f} % of {c.curves} curves",
    )


def _error_rows(synthetic: LawFit, own, found: Measurements | None) -> list[dict]:
    fits = {"synthetic curve": synthetic} | ({found.name: own} if isinstance(own, LawFit) else {})
    return [
        {
            "curve": name, "number": number, "value": float(f.values[k]), "error, covariance": float(f.errors[k]),
            "error, bootstrap": float(f.bootstrap_errors[k]), "noise (N)": f.noise,
        }
        for name, f in fits.items() for k, number in enumerate(NAMES)
    ]


# --- pictures and words --------------------------------------------------------------------------


def _pictures(
    truth: Truth, synthetic: LawFit, found: Measurements | None, own: LawFit | LineFit | None,
    answered: Sequence[Answer], fit: LawFit,
) -> tuple[Chart, ...]:
    pictures = [cycle_chart("synthetic_cycle", "A synthetic curve", truth.cycle(1), synthetic)]
    if isinstance(own, LawFit):
        pictures.append(cycle_chart("measured_cycle", found.name, found.cycle(), own))
    if isinstance(own, LineFit):
        pictures.append(line_chart(found, own))
    return (*pictures, pull_off_chart(answered, fit, SPHERES), hysteresis_chart(answered, fit))


def _rerun(ask: Ask):
    file = f" --measurements {ask.measurements.name}" if ask.measurements else ""
    return lambda *engines: f"grainproof reproduce contact --size {ask.size} --engines {','.join(engines)}{file}"


def _words(
    synthetic: LawFit, own: LawFit | LineFit | None, found: Measurements | None, covered: Sequence[Coverage],
    scene: Path,
) -> tuple[str, ...]:
    slope, error = propagated(own if isinstance(own, LawFit) else synthetic, pull_off_slope)
    of = found.name if isinstance(own, LawFit) else "the synthetic curve"
    said = [
        "The transcript keeps axes and titles of the talk's three figures and no point of a curve (table below). No "
        "measured value is made up for them: the bounds that follow from the axes decide nothing.",
        "Error bars of the fit were held against curves of a known law: 95 % intervals hold the truth in "
        + " and ".join(f"{100 * c.share:.1f} % ({c.source}, {c.curves} curves)" for c in covered) + ".",
        f"From k_1, k_2, k_c of {of} pull-off over load follows as {slope:.4g} +- {error:.2g}, without an offset: this "
        "law has no adhesion of a contact that was never pressed. A measured line with an offset (the talk's figure "
        "may have one) needs a constant pull-off force besides.",
        f"The fitted law stands in the folder of --out as the scene {scene.parent.name}/{scene.name}, which every "
        "command takes.",
    ]
    if isinstance(own, LawFit) and not own.adhesive:
        said.append("The file shows no adhesive branch, so that k_c is not determined: the pull jumps off, as it does "
                    "where the spring of the instrument is softer than k_c.")
    return tuple(said)


STUDY = Study(
    name="contact", title="The contact law from measured curves",
    claim="force-displacement and adhesion curves of the contact force measurement (PIA): pull-off against load, "
    "hysteresis against force of polystyrene and borosilicate glass, and the law with k_1, k_2, k_c for them.",
    source="S. Luding, Shear banding in granular materials, slides 'Contact force measurement (PIA)', 'Hysteresis "
    "(plastic deformation)', 'Contact model'",
    sizes={size: Declared(says=f"{c} synthetic curves, {b} with bootstrap; six loads on each code", packings=1,
                          beyond=BEYOND[size]) for size, (c, b, _) in CURVES.items()},
    engines=("lammps", "liggghts", "kernel:talk"), values=(), run=run, cases=lambda _: (),
    lacking={"lammps": "has no law with k_1, k_2 and k_c"},
    measurements="a CSV file: displacement (nm),force (nN) or load (nN),pull-off (nN) or force (nN),hysteresis (nm)",
    refuse=refuse,
)
