"""What a biaxial box shows quantity by quantity, over all packings: wall curves and averages of the frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from harness.report import figures
from harness.report.bands import Band, band_over
from harness.report.page import Figure
from harness.report.panels import counted, draw_bands, panel
from harness.studies.compare.biaxial_quantities import OF_FRAMES
from harness.studies.compare.curves import BiaxialCurves, biaxial_curves
from postproc.results import headed

if TYPE_CHECKING:
    from harness.studies.compare.study import Comparison

STRAIN = "axial strain (%)"

WALLS = {
    "stress_zz": ("σ_zz (N/m)", 1.0, "Axial stress on the top wall."),
    "stress_xx": ("σ_xx (N/m)", 1.0, "Side stress, as measured."),
    "friction_angle": ("secant friction angle (°)", 1.0, "Mobilised friction angle, from both stresses."),
    "volume_strain": ("ε_V (compression > 0)", 1.0, "Volume strain."),
}
"""Attribute of the curves: label, scale, caption."""

CONTROL = {"control_error": ("(F_x - p_x z)/(p_x z) (%)", 100.0, "How far the side wall is from what it should carry.")}

AVERAGES = (
    "volume fraction, inner", "coordination number, inner", "coordination number without rattlers, inner",
    "fabric deviator, inner", "friction angle, inner", "sigma_zz from contacts",
)
JUDGED = "Judged over replicates, in the frames nearest to compare.strains. "
UNREST = ("kinetic over elastic energy", "largest residual force")


def wall_panels(comparison: Comparison) -> tuple[Figure, ...]:
    """What is measured at the walls, with bands over packings."""
    return _wall_panels(comparison, WALLS)


def calm_panels(comparison: Comparison) -> tuple[Figure, ...]:
    """How calm the sample was: the side wall's error and, with recorded contacts, energies and residual forces."""
    return (*_wall_panels(comparison, CONTROL), *_state_panels(comparison, UNREST))


def average_panels(comparison: Comparison) -> tuple[Figure, ...]:
    """Averages of the independent post-processor that all frames can give, with bands; none without contacts."""
    return tuple(_average_panel(comparison, q, bands) for q, bands in average_bands(comparison).items())


def average_bands(comparison: Comparison) -> dict[str, dict[str, Band]]:
    """Return quantity -> engine -> band over strain, of those AVERAGES that the frames of every run can give."""
    runs = comparison.result.replicates
    every = [s for of in runs.values() for s in of]
    shown = [q for q in AVERAGES if every and all(q in s.values for s in every)]
    return {
        q: {e: band_over([s.strain for s in of], [s.values[q] for s in of]) for e, of in runs.items()} for q in shown
    }


def _average_panel(comparison: Comparison, quantity: str, bands: dict[str, Band]) -> Figure:
    label = headed(quantity, next(iter(comparison.result.replicates.values()))[0].units[quantity])
    judged = quantity in OF_FRAMES and comparison.result.judged
    return panel(
        lambda axes: draw_bands(axes, bands, x=STRAIN, y=label, scale=(100.0, 1.0), marker="."),
        f"{_sentence(quantity)} {JUDGED if judged else ''}{counted(bands)}",
    )


def wall_bands(comparison: Comparison, wanted: Sequence[str] = (*WALLS, *CONTROL)) -> dict[str, dict[str, Band]]:
    """Return quantity -> engine -> band over strain, of what is measured at the walls."""
    curves = _all_curves(comparison)
    return {q: {e: _band(of, q) for e, of in curves.items()} for q in wanted}


def _wall_panels(comparison: Comparison, wanted) -> tuple[Figure, ...]:
    bands = wall_bands(comparison, tuple(wanted))
    return tuple(_wall_panel(of, *wanted[quantity]) for quantity, of in bands.items())


def _wall_panel(bands: dict[str, Band], label: str, scale: float, caption: str) -> Figure:
    return panel(
        lambda axes: draw_bands(axes, bands, x=STRAIN, y=label, scale=(100.0, scale)), f"{caption} {counted(bands)}"
    )


def _band(curves: Sequence[BiaxialCurves], quantity: str) -> Band:
    return band_over([c.strain for c in curves], [getattr(c, quantity) for c in curves])


def _all_curves(comparison: Comparison) -> dict[str, list[BiaxialCurves]]:
    """Return the curves of all completed runs by engine; engines in the order of the first packing's curves."""
    found: dict[str, list[BiaxialCurves]] = {e: [] for e in comparison.result.curves}
    for r in comparison.completed:
        curves = biaxial_curves(r.trajectory, comparison.starts[r.packing].system)
        found.setdefault(r.engine, []).append(curves)
    return found


def _state_panels(comparison: Comparison, wanted: Sequence[str]) -> tuple[Figure, ...]:
    """Averages of the frames of the first packing, of those quantities that every engine's frames can give."""
    states = comparison.result.states
    shown = [q for q in wanted if states and all(q in s.values for s in states.values())]
    return tuple(_state_panel(states, q, of_several=len(comparison.starts) > 1) for q in shown)


def _state_panel(states, quantity: str, *, of_several: bool) -> Figure:
    def draw(axes) -> None:
        figures.draw_states(axes, states, quantity)
        if any((s.values[quantity] > 0).any() for s in states.values()):
            axes.set_yscale("log", nonpositive="mask")

    return panel(draw, f"{_sentence(quantity)} First packing." if of_several else _sentence(quantity))


def _sentence(quantity: str) -> str:
    return f"{quantity[0].upper()}{quantity[1:]}."
