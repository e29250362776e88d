"""What the report of a biaxial box shows: curves, growth, states at four strains, numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.report import biaxial_panels, figures
from harness.report.page import Figure, Section
from harness.report.panels import panel
from harness.report.replicates import replicate_rows, replicate_sections
from harness.report.wall_bands import TABLE as WALL_BANDS
from harness.report.wall_bands import band_rows, has_replicates, where_bands_are
from harness.studies.compare.macro import MACRO
from harness.studies.compare.pointwise import force_deviation
from postproc.results import headed

if TYPE_CHECKING:
    from harness.studies.compare.phases import Phase
    from harness.studies.compare.study import Comparison, Run

SHOWN_STRAINS = (0.0, 0.011, 0.042, 0.091)
"""Axial strains of the talk's pictures: 0, 1.1, 4.2 and 9.1 per cent."""


TABLES = ("macro", "phases", "deviation", "curves", "states", "averages", "growth", "replicates", WALL_BANDS)


def tables(comparison: Comparison) -> dict[str, list[dict]]:
    """Rows by table name: macroscopic numbers, parts of the test, curves sample by sample, state averages.

    Bands of wall curves are of replicates only.
    """
    rows = (
        macro_rows, phase_rows, deviation_rows, curve_rows, state_rows, average_rows, growth_rows, _replicate_rows,
        wall_band_rows,
    )
    made = zip(TABLES, rows, strict=True)
    return {name: make(comparison) for name, make in made if name != WALL_BANDS or has_replicates(comparison)}


def sections(comparison: Comparison) -> list[Section]:
    """The page's sections, without those for which no run of the first packing completed."""
    if not comparison.result.curves:
        return []
    return [
        *replicate_sections(comparison.result.judged, comparison.looks),
        Section(heading="Numbers of the whole test", note=MACRO_NOTE, rows=macro_page_rows(comparison)),
        Section(
            heading="Stress and volume against strain", note=where_bands_are(comparison),
            figures=biaxial_panels.wall_panels(comparison),
        ),
        *_agreement(comparison),
        Section(
            heading="How calm was the sample?", note=PHASE_NOTE, rows=phase_page_rows(comparison),
            figures=biaxial_panels.calm_panels(comparison),
        ),
        *_averages(comparison),
        *_pictures(comparison),
    ]


def overview(comparison: Comparison):
    """Return the one picture, None when no run of the first packing completed."""
    from harness.report.overview import overview as drawn

    return drawn(comparison) if comparison.result.curves else None


MACRO_NOTE = (
    "Stress ratios are formed from measured stresses, never from p_x. Stresses per unit thickness (N/m), volume strain "
    "positive in compression. The peak is that of the first loading branch of sigma_zz, smoothed over 0.5 % strain: "
    "its largest value before it first falls clearly; from and to say where the curve is within 3 % of it. A test that "
    "never falls clearly has no peak. With one packing these numbers have no error bar: they are shown, not judged. "
    "s: standard deviation over n packings."
)
PHASE_NOTE = (
    "Measured, not judged, of the first packing. The verdict on the rate of the drive counts the top wall's motion "
    "alone, and the one on the side wall ends at the peak: neither says that the sample stays near equilibrium. That "
    "it does would show in a small kinetic over elastic energy (E_kin/E_el, of the recorded frames) and a small swing "
    "of sigma_zz: standard deviation, lowest and highest value about the mean over the strain of that part."
)
DEVIATION_NOTE = (
    "Relative difference of the top-wall force up to the given axial strain (largest so far), of the first packing; "
    "checks take the worst of all. kernel:lammps and "
    "kernel:liggghts are the same NumPy kernel in the conventions of each code."
)


def macro_rows(comparison: Comparison) -> list[dict]:
    """One row a quantity and engine: mean and standard deviation over packings (None of a single one)."""
    macro = comparison.result.macro
    engines = list(dict.fromkeys(e for e, _ in macro))
    return [
        {"quantity": n, "unit": MACRO[n][0], "engine": e, "mean": float(np.mean(values)),
         "standard deviation": float(np.std(values, ddof=1)) if len(values) > 1 else None, "packings": len(values)}
        for n in MACRO for e in engines if (values := [v[n] for (f, _), v in macro.items() if f == e and n in v])
    ]


def macro_page_rows(comparison: Comparison) -> list[dict]:
    """The same for people: one row a quantity, one column an engine."""
    rows: dict[str, dict] = {}
    engines = dict.fromkeys(e for e, _ in comparison.result.macro)
    for r in macro_rows(comparison):
        row = rows.setdefault(r["quantity"], {"quantity": r["quantity"], "unit": r["unit"], **engines})
        spread = r["standard deviation"]
        row[r["engine"]] = f"{r['mean']:.4g}" + ("" if spread is None else f" (s = {spread:.2g}, n = {r['packings']})")
    return list(rows.values())


def phase_rows(comparison: Comparison) -> list[dict]:
    """One row an engine and part of the test, see `harness.studies.compare.phases`."""
    return [_phase_row(e, p) for e, phases in comparison.result.phases.items() for p in phases]


def _phase_row(engine: str, phase: Phase) -> dict:
    median, largest = phase.energy or (None, None)
    s = phase.swing
    return {
        "engine": engine, "part": phase.name, "strain, from": phase.low, "strain, to": phase.high,
        "E_kin/E_el, median": median, "E_kin/E_el, largest": largest,
        "side wall error, largest": phase.control, "sigma_zz, mean (N/m)": None if s is None else s.mean,
        "sigma_zz, standard deviation over mean": None if s is None else s.deviation,
        "sigma_zz, lowest over mean - 1": None if s is None else s.lowest,
        "sigma_zz, highest over mean - 1": None if s is None else s.highest,
    }


def phase_page_rows(comparison: Comparison) -> list[dict]:
    """The same for people: one row a part and quantity, one column an engine; without what nobody can tell."""
    made = phase_rows(comparison)
    engines = dict.fromkeys(r["engine"] for r in made)
    rows: dict[tuple[str, str], dict] = {}
    for r in made:
        for quantity, value in r.items():
            if quantity not in ("engine", "part") and value is not None:
                row = rows.setdefault((r["part"], quantity), {"part": r["part"], "quantity": quantity, **engines})
                row[r["engine"]] = value
    return list(rows.values())


STATIONS = (0.0001, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1)


def deviation_rows(comparison: Comparison) -> list[dict]:
    """One row a pair, one column a strain: the largest relative difference of the top force so far."""
    curves = comparison.result.curves
    pairs = [p for p in comparison.result.pairs if not p.missing(curves)]
    return [{"left": p.left, "right": p.right, **_upto(curves[p.left], curves[p.right])} for p in pairs]


def _upto(a, b) -> dict[str, float | None]:
    deviation = force_deviation(a, b)
    inside = {s: a.upto(s) for s in STATIONS if s <= a.strain[-1] * 1.0001}
    return {f"{100 * s:g} %": float(deviation[m].max()) if m.any() else None for s, m in inside.items()}


CURVES = {
    "strain": "1", "stress_zz": "N/m", "stress_xx": "N/m", "ratio": "1", "friction_angle": "deg", "volume_strain": "1",
    "control_error": "1", "force_top": "N", "force_bottom": "N", "force_right": "N", "x": "m", "z": "m", "time": "s",
}
"""Curve and its unit; a box of discs of unit thickness."""


def curve_rows(comparison: Comparison) -> list[dict]:
    """One row an engine and sample."""
    found = {
        e: {headed(q, unit): getattr(c, q).tolist() for q, unit in CURVES.items()}
        for e, c in comparison.result.curves.items()
    }
    return [
        {"engine": e, **dict(zip(columns, row, strict=True))}
        for e, columns in found.items() for row in zip(*columns.values(), strict=True)
    ]


def wall_band_rows(comparison: Comparison) -> list[dict]:
    """One row an engine and strain: mean over the engine's runs and standard error of what the page draws of walls."""
    return band_rows(biaxial_panels.wall_bands(comparison), CURVES, "strain")


def state_rows(comparison: Comparison) -> list[dict]:
    """One row an engine and frame."""
    return [
        {"engine": e, "strain": float(s.strain[k]), **{headed(q, s.units[q]): float(v[k]) for q, v in s.values.items()}}
        for e, s in comparison.result.states.items() for k in range(len(s.strain))
    ]


def average_rows(comparison: Comparison) -> list[dict]:
    """One row a quantity, engine and frame: mean over the engine's runs, standard error (None of a single one)."""
    return [
        {"quantity": q, "unit": comparison.result.replicates[e][0].units[q], "engine": e, "strain": float(b.place[k]),
         "mean": float(b.mean[k]), "standard error": None if b.error is None else float(b.error[k]), "runs": b.count}
        for q, bands in biaxial_panels.average_bands(comparison).items() for e, b in bands.items()
        for k in range(len(b.place))
    ]


def _replicate_rows(comparison: Comparison) -> list[dict]:
    return replicate_rows(comparison.result.judged)


def growth_rows(comparison: Comparison) -> list[dict]:
    """One row a pair and frame."""
    return [
        {"pair": name, "time (s)": float(t), "rms difference over diameter": float(d)}
        for name, g in comparison.result.growth.items() for t, d in zip(g.time, g.difference, strict=True)
    ]


# --- figures -----------------------------------------------------------------------------------


def _agreement(comparison: Comparison) -> list[Section]:
    """Nothing when no pair of engines completed."""
    growth = comparison.result.growth
    if not growth:
        return []
    shown = (
        panel(lambda axes: figures.draw_growth(axes, growth), "How positions part, from identical numbers at time 0."),
        panel(lambda axes: figures.draw_signal_deviation(axes, comparison), FORCE_CAPTION),
    )
    return [Section(heading="Do the codes agree?", note=DEVIATION_NOTE, rows=deviation_rows(comparison), figures=shown)]


FORCE_CAPTION = (
    "The same in the force on the top wall; horizontal bars are the declared checks: tolerance up to that strain, and "
    "for which pairs."
)


def _averages(comparison: Comparison) -> list[Section]:
    shown = biaxial_panels.average_panels(comparison)
    judged = comparison.result.judged
    paired = PAIRED_NOTE if judged and judged[0].tested.difference.paired else ""
    note = " ".join(filter(None, (AVERAGE_NOTE, paired, where_bands_are(comparison, "averages"), _absent(comparison))))
    return [Section(heading="Micro-macro averages", note=note, figures=shown)] if shown else []


AVERAGE_NOTE = (
    'Averages of the independent post-processor from particles and contacts; "inner" leaves out a border layer.'
)
PAIRED_NOTE = (
    "Bands of two codes may overlap although the codes differ: bands hold what packings do to all codes alike, which "
    "the differences over replicates leave out."
)


def _absent(comparison: Comparison) -> str:
    """Say which quantities the frames cannot give, and why."""
    every = (s for of in comparison.result.replicates.values() for s in of)
    reasons = {q: why for s in every for q, why in s.absent.items()}
    return "".join(f"Not available: {q}, as {why}. " for q, why in reasons.items()).strip()


def _pictures(comparison: Comparison) -> list[Section]:
    """Force chains and rotations near the talk's four strains, one row an engine; what was recorded of them."""
    runs = [r for r in comparison.completed if r.packing == 0]
    system, found = comparison.starts[0].system, []
    if runs and system.contacts:
        found.append(Section(heading="Force chains", figures=(_chains(runs, comparison),)))
    if runs and system.rotations:
        found.append(Section(heading="Particle rotations", figures=(_rotations(runs, comparison),)))
    return found


def _chosen_frames(comparison: Comparison) -> list[int]:
    """Return the frames nearest to the shown strains, each once; strain is prescribed, the same for all engines."""
    strain = next(iter(comparison.result.states.values())).strain
    return list(dict.fromkeys(int(np.argmin(np.abs(strain - s))) for s in SHOWN_STRAINS))


def _chains(runs: list[Run], comparison: Comparison) -> Figure:
    chosen, view = _chosen_frames(comparison), figures.common_view(runs)
    figure, axes = figures.new_figure(len(runs), len(chosen), width=3.25 * len(chosen), height=3.3 * len(runs))
    width = figures.typical_force(runs[0].trajectory.frames[chosen[-1]])
    for row, run in zip(axes, runs, strict=True):
        for a, k in zip(row, chosen, strict=True):
            figures.draw_force_chains(a, run.trajectory.frames[k], full_width=width, view=view)
            a.set_title(_panel_title(run, k, comparison), fontsize=8)
    return Figure(uri=figures.png_uri(figure, dpi=90), caption=(
        "Contact forces at the frames nearest to the four strains of S. Luding's talk (0, 1.1, 4.2, 9.1 %); "
        f"a line 3 points wide carries {width:.2g} N."
    ))


def _rotations(runs: list[Run], comparison: Comparison) -> Figure:
    """One colour scale a strain: rotations grow a hundredfold, and each picture should show its own."""
    chosen, view = _chosen_frames(comparison), figures.common_view(runs)
    figure, axes = figures.new_figure(len(runs), len(chosen), width=3.25 * len(chosen), height=3.5 * len(runs))
    for column, k in zip(axes.T, chosen, strict=True):
        values = [np.degrees(r.trajectory.frames[k].particles["rotation"]) for r in runs]
        limit = max(float(np.percentile(np.abs(v), 95)) for v in values) or 1.0
        for a, run, v in zip(column, runs, values, strict=True):
            discs = figures.draw_rotations(a, run.trajectory.frames[k], v, limit=limit, view=view)
            a.set_title(_panel_title(run, k, comparison), fontsize=8)
        figure.colorbar(discs, ax=column, location="bottom", shrink=0.8, aspect=30, label="rotation (°)")
    return Figure(uri=figures.png_uri(figure, dpi=90), caption=ROTATION_CAPTION)


ROTATION_CAPTION = (
    "Rotation of every disc since the start, counter-clockwise positive, one colour scale a strain. The kernel sums "
    "its spins in every step; the engines average them between frames from samples every few steps."
)


def _panel_title(run: Run, frame: int, comparison: Comparison) -> str:
    return f"{run.engine}, ε = {100 * comparison.result.states[run.engine].strain[frame]:.1f} %"
