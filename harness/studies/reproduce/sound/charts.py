"""The pictures of the sound study, as data."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.studies.reproduce.protocol import Chart, Line
from harness.studies.reproduce.rows import over_packings
from harness.studies.reproduce.sound.cases import Setting
from harness.studies.reproduce.sound.measure import P, S, closed_form, expected_frequencies
from harness.studies.reproduce.sound.numbers import (
    SYMBOL,
    MadeBy,
    deviations,
    disordered,
    engines_in,
    ratios,
    regular,
)

STATIONS = (20, 60)
"""Layers at which the pulse is drawn, counted from the kicked one."""

TOGETHER = 6
"""Neighbouring frequencies of a spectrum that are taken together."""


def charts(settings: Sequence[Setting], runs: MadeBy) -> tuple[Chart, ...]:
    """Return all charts; of what an engine computes as all others do, that of the first is drawn."""
    named = zip(regular(settings), ("smooth", "rough"), strict=True)
    found = [_dispersion(s, runs, f"dispersion_{w}") for s, w in named]
    found += [_deviations(settings, runs), _pulse(settings, runs), _speeds(settings, runs), _decays(settings, runs)]
    found += [_transmission(settings, runs)]
    return tuple(c for c in found if c is not None and c.lines)


def _dispersion(setting: Setting, runs: MadeBy, name: str) -> Chart | None:
    engines = engines_in([setting], runs)
    if not engines:
        return None
    run, material = runs[setting.name][engines[0]], setting.column.material
    unit = np.sqrt(material.stiffness / material.mass)
    phase, lines = np.linspace(1e-3, np.pi, 200), []
    for kind, b in run.branches.items():
        lines.append(Line(name=f"{kind}: {engines[0]}", x=b.phase / np.pi, y=b.frequency / unit, error=b.error / unit,
                          look="points"))
        curve = expected_frequencies(closed_form(setting, engines[0]), kind, phase, 0.0)
        lines.append(Line(name=f"{kind}: closed form", x=phase / np.pi, y=curve / unit, look="fit"))
    return Chart(
        name=name, x="wavenumber times distance of layers, k l/pi", y="frequency, w/sqrt(k_n/m)", lines=tuple(lines),
        caption=f"Dispersion along the cube axis, {setting.name}: {engines[0]}, and the closed form. What the other "
        "codes deviate by is shown apart.",
    )


def _deviations(settings: Sequence[Setting], runs: MadeBy) -> Chart:
    lines = []
    for s in regular(settings):
        for engine in engines_in([s], runs):
            found = deviations(s, engine, runs[s.name][engine])
            phase = next(iter(runs[s.name][engine].branches.values())).phase
            worst = np.maximum(np.max(list(found.values()), axis=0), 1e-16)
            friction = "springs" if s.rough else "smooth"
            lines.append(Line(name=f"{engine}, {friction}", x=phase / np.pi, y=worst, look="points"))
    return Chart(
        name="dispersion_deviation", x="k l/pi", y="|w/closed form - 1|", lines=tuple(lines), log_y=True,
        caption="Largest relative deviation of all kinds of waves from the closed form in the run's own steps, by "
        "wavenumber and code.",
    )


def _pulse(settings: Sequence[Setting], runs: MadeBy) -> Chart | None:
    smooth = regular(settings)[0]
    engines = engines_in([smooth], runs)
    if not engines:
        return None
    run, waves, lines = runs[smooth.name][engines[0]], smooth.column.material.waves(), []
    unit = waves.layer / waves.compression_speed
    fine = np.linspace(run.time[0], run.time[-1], 3000)
    for n in STATIONS:
        shown = run.time < _arrival_from_behind(smooth, n)
        at, until = run.time[shown], fine[fine < run.time[shown][-1]]
        lines.append(Line(name=f"layer {n}: {engines[0]}", x=at / unit, y=run.along[shown, n], look="points"))
        lines.append(Line(name=f"layer {n}: J_2n", x=until / unit, y=waves.pulse(n, until), look="fit"))
    for width, samples in disordered(settings).items():
        if samples[0].name in runs and engines[0] in runs[samples[0].name]:
            of, n = runs[samples[0].name][engines[0]], STATIONS[-1]
            shown = of.time < _arrival_from_behind(smooth, n)
            lines.append(Line(name=f"layer {n}, disorder {width:g}", x=of.time[shown] / unit, y=of.along[shown, n]))
    return Chart(
        name="pulse", x="time, c_P t/l (layers that a long wave has passed)", y="velocity of the layer over the kick",
        lines=tuple(lines), caption="A kicked layer sends a pulse of compression along the column: layers move with "
        "v_0 J_2n(w_max t), head first and then ever shorter waves. In a disordered column the head comes later and "
        "the shorter waves do not arrive.",
    )


def _arrival_from_behind(setting: Setting, n: int) -> float:
    """Return when the pulse that went the other way round the periodic column is near layer n, s."""
    waves = setting.column.material.waves()
    return 0.9 * (setting.column.layers - n) * waves.layer / waves.compression_speed


def _speeds(settings: Sequence[Setting], runs: MadeBy) -> Chart:
    groups, lines = disordered(settings), []
    for wave in (P, S):
        for engine in engines_in([s for of in groups.values() for s in of], runs):
            ours = [over_packings(engine, ratios(of, runs, wave, engine)) for of in groups.values()]
            error = np.array([np.nan if m.error is None else m.error for m in ours])
            lines.append(Line(name=f"{SYMBOL[wave]}, {engine}", x=np.array(list(groups)), error=error,
                              y=np.array([m.value for m in ours]), look="points"))
    return Chart(
        name="disorder_speeds", x="width of the sizes over the overlap, w", y="speed over that of the regular column",
        lines=tuple(lines), caption="Long waves are slower where contacts have opened; standard errors over samples.",
    )


COHERENT = 0.3
"""Largest rms of what one decaying oscillation leaves of a mode over the mode: beyond, it is no wave any more."""


def decay_over_frequency(samples: Sequence[Setting], runs: MadeBy, wave: str, engine: str):
    """Return k l (M,), and mean and standard error (NaN for one sample) of G/w (M,) over samples.

    NaN where a mode of any sample is not one decaying oscillation.
    """
    found = [runs[s.name][engine].branches[wave] for s in samples if engine in runs.get(s.name, {})]
    part = np.array([np.where(b.left <= COHERENT, b.decay / b.frequency, np.nan) for b in found])
    error = part.std(axis=0, ddof=1) / np.sqrt(len(part)) if len(part) > 1 else np.full(part.shape[1], np.nan)
    return found[0].phase, part.mean(axis=0), error


def _decays(settings: Sequence[Setting], runs: MadeBy) -> Chart:
    lines = []
    for width, samples in disordered(settings).items():
        for engine in engines_in(samples, runs)[:1]:
            phase, mean, error = decay_over_frequency(samples, runs, P, engine)
            known, name = np.isfinite(mean), f"disorder {width:g}: {engine}"
            lines.append(Line(name=name, x=phase[known] / np.pi, y=mean[known], error=error[known], look="points"))
    return Chart(
        name="disorder_decay", x="k l/pi", y="decay of the coherent wave, G/w", lines=tuple(lines),
        caption="A wave of compression loses its order to disorder: amplitude exp(-G t), mean and standard error over "
        "samples. Waves of which one decaying oscillation leaves more than 0.3 are left out.",
    )


def _transmission(settings: Sequence[Setting], runs: MadeBy) -> Chart | None:
    smooth = regular(settings)[0]
    engines = engines_in([smooth], runs)
    if not engines:
        return None
    lines, cut = [], smooth.column.material.waves().cut_off
    for width, samples in disordered(settings).items():
        for n in STATIONS if engines[0] in engines_in(samples, runs) else ():
            frequency, mean, error = transmitted(samples, smooth, runs, engines[0], n)
            lines.append(Line(name=f"disorder {width:g}, layer {n}", x=frequency / cut, y=mean, error=error))
    return Chart(
        name="transmission", x="frequency over the cut-off", y="spectrum of the layer over that of the regular column",
        lines=tuple(lines), log_y=True, caption=f"Disorder lets low frequencies pass: what arrives, {engines[0]}, mean "
        "and standard error over samples.",
    )


def transmitted(samples: Sequence[Setting], smooth: Setting, runs: MadeBy, engine: str, n: int):
    """Return frequencies (B,), rad/s, mean and standard error (B,) over samples (NaN for one) of `transmission`."""
    regular_run = runs[smooth.name][engine]
    found = [transmission(runs[s.name][engine], regular_run, n) for s in samples if engine in runs.get(s.name, {})]
    part = np.array([t for _, t in found])
    error = part.std(axis=0, ddof=1) / np.sqrt(len(part)) if len(part) > 1 else np.full(part.shape[1], np.nan)
    return found[0][0], part.mean(axis=0), error


def transmission(run, regular_run, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies (B,), rad/s, below the cut-off, and the amplitude of layer n over the regular column's."""
    step = run.time[1] - run.time[0]
    frequency = 2 * np.pi * np.fft.rfftfreq(len(run.time), step)
    ours, theirs = (np.abs(np.fft.rfft(r.along[:, n])) ** 2 for r in (run, regular_run))
    top = int(np.searchsorted(frequency, regular_run.branches[P].frequency.max()))
    count = max(1, (top - 1) // TOGETHER)
    used = slice(1, 1 + count * TOGETHER)
    ours, theirs, frequency = (v[used].reshape(count, TOGETHER).mean(axis=1) for v in (ours, theirs, frequency))
    return frequency, np.sqrt(ours / theirs)
