"""`sound`: waves along a column of spheres, in the third dimension; regular against the closed form, then disordered.

One layer of a periodic face-centred cubic column under pressure is kicked, along the column and across it, with
friction springs also into a spin. Every mode of the layers then swings with the frequencies of its wave; long waves
give the speeds c_P and c_S. Sizes that differ by a part in a thousand open contacts: waves get slower and lose order.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.studies.accuracy.oracle import convention_of
from harness.studies.reproduce.protocol import Ask, Declared, Result, Study
from harness.studies.reproduce.rows import over_packings
from harness.studies.reproduce.runs import run_cases, study_runs, unsupported
from harness.studies.reproduce.sound.cases import EXTENTS, SMOOTH, Setting, cases_of, made_cases, settings_of
from harness.studies.reproduce.sound.charts import STATIONS, charts, transmitted
from harness.studies.reproduce.sound.measure import P, S, SoundRun, closed_form, measure_sound
from harness.studies.reproduce.sound.numbers import (
    SYMBOL,
    MadeBy,
    checks,
    convergence,
    disorder_rows,
    disordered,
    engines_in,
    ratios,
    regular,
    runs_by_case,
    speed_rows,
)
from reference.kernel.conventions import NAMED

PARTS = (0.1, 0.3, 0.5, 0.9)
"""Of the cut-off: where the spectrum of what arrives is tabulated."""

RATE_WORDS = (
    "Single waves run slower than long ones by (k l)^2/24 and more; the speeds above are extrapolated to k = 0. Steps "
    "of a leapfrog raise a frequency w by (w dt)^2/24, so that halving the step quarters what is above 1."
)


def run(ask: Ask) -> Result:
    """Run all columns; speeds, dispersion and pulses against the closed form, and what disorder does."""
    settings = settings_of(ask)
    named = {s.name: s for s in settings}
    made = run_cases(ask, made_cases(ask), lambda case, trajectory, system: measure_sound(
        named[case.name], trajectory, system))
    runs = runs_by_case(made)
    return Result(
        rows=(*speed_rows(settings, runs), *disorder_rows(settings, runs)),
        rates=tuple(convergence(settings, runs)), rate_words=RATE_WORDS,
        checks=tuple(checks(settings, runs, _rerun(ask))), pictures=charts(settings, runs),
        tables={"What arrives of each frequency": attenuation_rows(settings, runs)}, words=_words(settings, runs),
        runs=study_runs(made), unsupported=unsupported(made),
    )


def attenuation_rows(settings: Sequence[Setting], runs: MadeBy) -> list[dict]:
    """Return what arrives at the stations over the regular column, in parts of the spectrum, by disorder and engine."""
    rows, smooth = [], regular(settings)[0]
    cut = smooth.column.material.waves().cut_off
    for width, samples in disordered(settings).items():
        for engine in engines_in(samples, runs):
            if engine not in runs.get(smooth.name, {}):
                continue
            found = {n: transmitted(samples, smooth, runs, engine, n) for n in STATIONS}
            for part in PARTS:
                k = int(np.argmin(np.abs(found[STATIONS[0]][0] / cut - part)))
                cells = {f"layer {n}": f"{mean[k]:.3g} +- {error[k]:.1g}" for n, (_, mean, error) in found.items()}
                frequency = float(found[STATIONS[0]][0][k] / cut)
                rows.append({"disorder": width, "engine": engine, "frequency over cut-off": frequency, **cells})
    return rows


def _rerun(ask: Ask):
    packings = f" --packings {ask.packings}" if ask.packings else ""
    return lambda *engines: f"grainproof reproduce sound --size {ask.size} --engines {','.join(engines)}{packings}"


def _words(settings: Sequence[Setting], runs: MadeBy) -> tuple[str, ...]:
    material = SMOOTH
    said = [
        "The transcript names the subject (3-dimensional modelling of sound propagation, P-wave shape and speed) and "
        f"no number. The set-up is that of the papers as recalled: radius {1e3 * material.radius:g} mm, density "
        f"{material.density:g} kg/m^3, k = {material.stiffness:g} N/m, overlap {material.overlap:g} of the radius; "
        "what decides is the closed form, which holds for any set-up. It counts the pressure: a pressed contact pushes "
        "its spheres further aside, so that c_P falls by F/(2 k D) and c_S by three times as much.",
    ]
    rough = regular(settings)[-1]
    arms = {e: closed_form(rough, e).arms for e in engines_in([rough], runs)}
    if len({round(a, 12) for a in arms.values()}) > 1:
        said.append(
            "With friction springs the codes do not compute the same waves, and must not: where slip is measured at "
            "the radius (LAMMPS) spinning waves are faster than where it is measured at the contact, by delta/(4 R). "
            "Every engine is held against the closed form with its own lever arms; long waves are the same for all."
        )
    late = [e for e in arms if NAMED[convention_of(e)].sliding == "talk"]
    said += [_late(rough, runs[rough.name][e], e) for e in late]
    said += [_slowing(width, samples, runs) for width, samples in disordered(settings).items()]
    return tuple(s for s in said if s)


def _late(setting: Setting, run: SoundRun, engine: str) -> str:
    """Say what a spring that moves behind the force does to a wave: see `reference.kernel.laws.slider`."""
    fastest = float(closed_form(setting, engine).torsion(0.0))
    exponent = fastest**2 * run.dt * float(run.time[-1]) / 2
    return (
        f"{engine} moves a friction spring after it has taken its force, as the talk's algorithm is written: the force "
        f"is a step late, and a swing of frequency w grows by exp(w^2 dt t/2), here by up to exp({exponent:.0f}). "
        "Contacts then slide and open, so that its numbers with friction springs are none of small waves."
    )


def _slowing(width: float, samples: Sequence[Setting], runs: MadeBy) -> str:
    engines = engines_in(samples, runs)
    if not engines:
        return ""
    parts, known = [], False
    for wave in (P, S):
        m = over_packings(engines[0], ratios(samples, runs, wave, engines[0]))
        known = known or m.error is not None
        error = "" if m.error is None else f" +- {100 * m.error:.2g}"
        parts.append(f"{SYMBOL[wave]} is {100 * (1 - m.value):.2g}{error} % lower")
    touch = np.mean([s.packing().contacts_per_sphere for s in samples])
    return (
        f"Disorder {width:g} (sizes differ by up to {width * SMOOTH.overlap:g} of the radius) leaves {touch:.2f} of 12 "
        f"contacts a sphere: {' and '.join(parts)} ({engines[0]}, {len(samples)} sample{'s' * (len(samples) > 1)}"
        f"{', one standard error' if known else ', so no error is known'})."
    )


def _declared(size: str) -> Declared:
    e = EXTENTS[size]
    return Declared(
        says=f"{e.layers} layers of {e.across} x {e.across} spheres; disorder {', '.join(f'{w:g}' for w in e.widths)}",
        packings=e.samples,
    )


STUDY = Study(
    name="sound", title="Sound in a column of spheres",
    claim="3-dimensional modeling of sound propagation: P-wave shape and speed (no number in the transcript).",
    source="S. Luding, Shear banding in granular materials, slides 'Sound'", values=(),
    sizes={size: _declared(size) for size in EXTENTS}, engines=("lammps", "liggghts", "kernel"), run=run,
    cases=cases_of,
)

__all__ = ["STUDY", "run"]
