"""What the report of a Couette ring shows: torque history, profiles with error bands, balances, pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report import ring_panels as panels
from harness.report.page import Section
from harness.report.ring_pictures import chain_figure, overview, spin_figure
from harness.report.ring_tables import TABLES, number_page_rows, published_rows, tables
from harness.scene.ring import area_fractions
from harness.studies.compare.profile_checks import FALSE_ALARM

if TYPE_CHECKING:
    from harness.studies.compare.study import Comparison

__all__ = ["TABLES", "overview", "sections", "tables"]

PUBLISHED_NOTE = (
    "Recalled values are shown for orientation: they were not seen in their source and never decide a verdict. They "
    "belong to rings of the real size at three densities. The talk's range is judged in the sheared regime only."
)
BALANCE_NOTE = (
    "Newton's laws in the steady state. 2 pi r^2 sigma_rphi is the torque of what is inside a circle on what is "
    "outside, from the contacts that link discs across it: with the drag in between it is that of both rings at every "
    "r. Stresses averaged over the area of discs are not exactly that, least of all within a disc of a wall; they are "
    "shown dotted. Residuals are net force, drag and centripetal acceleration per area, times r."
)


def sections(comparison: Comparison) -> list[Section]:
    """The page's sections, without those for which no run of the first packing completed."""
    if not comparison.result.curves:
        return []
    figures = {
        "Velocity": panels.velocity_panels(comparison), "Density": panels.density_panels(comparison),
        "Spin and rotation": panels.profile_panels(comparison, panels.MOTION),
        "Stress": panels.stress_panels(comparison),
        "Fabric": panels.profile_panels(comparison, panels.STRUCTURE),
        "Elastic strain and stiffness": (
            *panels.profile_panels(comparison, panels.STIFFNESS), *panels.stiffness_panel(comparison)
        ),
        "Couple stress": panels.profile_panels(comparison, panels.COUPLES),
    }
    return [
        Section(
            heading="Numbers of the steady state", note=_number_note(comparison), rows=number_page_rows(comparison)
        ),
        Section(heading="Published", note=PUBLISHED_NOTE, rows=published_rows(comparison)),
        Section(heading="Torque", figures=panels.torque_panels(comparison)),
        Section(heading="Profiles", note=_profile_note(comparison)),
        *(Section(heading=heading, figures=made) for heading, made in figures.items() if made),
        Section(heading="Equilibrium", note=BALANCE_NOTE, figures=panels.balance_panels(comparison)),
        *_pictures(comparison),
    ]


def _number_note(comparison: Comparison) -> str:
    nu, scene = area_fractions(comparison.scene), comparison.scene
    bands = {e: b.why for e, of in comparison.result.bands.items() for b in of.values() if b.why}
    none = "".join(f" No shear band in {e}: {why}." for e, why in bands.items())
    return (
        f"Averages from {scene.compare.steady_from:g} s to the end; +- is one standard error, of a single packing that "
        f"of the time average. Area fraction {nu['bare']:.4f} of the bare annulus, {nu['free']:.4f} of the free one "
        "between the glued discs. Torques are those of the discs on the rings, per unit thickness. Powers of r are "
        f"fitted a mean diameter away from both rings.{none}"
    )


def _profile_note(comparison: Comparison) -> str:
    """Say what error bars are, and what could not be had."""
    runs = [p for of in comparison.result.profiles.values() for p in of.values()]
    absent = {name: why for p in runs for name, why in p.absent.items()}
    missing = "".join(f" Not available: {name}, as {why}." for name, why in absent.items())
    several = len(comparison.starts) > 1
    error = "over packings" if several else "of the time average, which knows of autocorrelation"
    return (
        f"Means over {runs[0].frames} frames in {len(runs[0].r)} concentric rings, discs cut by borders by their "
        f"area; bands are one standard error {error}. Ratios, deviators and angles are formed from averages. "
        "Runs of one packing are the same numbers until chaos parts them, and independent afterwards; what is judged "
        f"counts them as independent. In a whole comparison of equal codes a profile is falsely said to differ with a "
        f"probability of {FALSE_ALARM:g} at most.{missing}"
    )


def _pictures(comparison: Comparison) -> list[Section]:
    """Force chains and spins, as far as they were recorded."""
    made = {"Force chains": chain_figure(comparison), "Particle rotations": spin_figure(comparison)}
    return [Section(heading=heading, figures=(figure,)) for heading, figure in made.items() if figure]
