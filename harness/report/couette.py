"""What the report of a Couette ring shows: torque history, profiles with error bands, balances, pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report import ring_panels as panels
from harness.report.page import Section
from harness.report.replicates import error_rates, looking_again, replicate_page_rows
from harness.report.ring_pictures import chain_figure, overview, spin_figure
from harness.report.ring_tables import TABLES, number_page_rows, published_rows, tables
from harness.report.ring_torque import torque_panels
from harness.report.wall_bands import where_bands_are
from harness.scene.ring import area_fractions
from harness.studies.compare.profile_checks import MOST
from harness.studies.compare.ring_checks import STEADY
from harness.studies.compare.significance import POWER
from harness.studies.statistics.looks import level_of

if TYPE_CHECKING:
    from harness.studies.compare.study import Comparison
    from harness.studies.verdict import Check

__all__ = ["TABLES", "lead", "overview", "sections", "tables"]

PUBLISHED_NOTE = (
    "Recalled values are shown for orientation: they were not seen in their source and never decide a verdict. They "
    "belong to rings of the real size at three densities. The talk's range is judged in the sheared regime only."
)
BALANCE_NOTE = (
    "Newton's laws, averaged over time. 2 pi r^2 sigma_rphi is the torque of what is inside a circle on what is "
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
        Section(heading=_averages(comparison), note=_number_note(comparison), rows=number_page_rows(comparison)),
        *_between_codes(comparison),
        Section(heading="Published", note=PUBLISHED_NOTE, rows=published_rows(comparison)),
        Section(heading="Torque", note=where_bands_are(comparison), figures=torque_panels(comparison)),
        Section(heading="Profiles", note=_profile_note(comparison)),
        *(Section(heading=heading, figures=made) for heading, made in figures.items() if made),
        Section(heading="Equilibrium", note=BALANCE_NOTE, figures=panels.balance_panels(comparison)),
        *_pictures(comparison),
    ]


def lead(comparison: Comparison) -> str:
    """Return what belongs on top: whether the state was shown to be steady, and how; "" without a run."""
    checks = _steadiness(comparison)
    if not checks:
        return ""
    compared, start = "torques of the two halves", f"{comparison.scene.compare.steady_from:g} s"
    if _steady(comparison):
        return f"The state is steady from {start} on as far as it was looked at: {compared} agree in every code."
    apart = ", ".join(
        f"{100 * c.deviation:.0f} % in {c.left} (error bars {100 * c.tolerance:.0f} %)" for c in checks
        if c.verdict != "agrees" and None not in (c.deviation, c.tolerance)
    )
    differ = any(c.verdict == "differs" for c in checks)
    what = "The state is not steady" if differ else "That the state is steady was not shown"
    return (
        f"{what}: {compared} of the time from {start} on differ by {apart}. What follows are averages over that time."
    )


def _steadiness(comparison: Comparison) -> list[Check]:
    return [c for c in comparison.checks if c.quantity == STEADY]


def _steady(comparison: Comparison) -> bool:
    """Whether every run was shown to be steady."""
    checks = _steadiness(comparison)
    return bool(checks) and all(c.verdict == "agrees" for c in checks)


def _averages(comparison: Comparison) -> str:
    if _steady(comparison):
        return "Numbers of the steady state"
    return f"Averages from {comparison.scene.compare.steady_from:g} s on"


def _between_codes(comparison: Comparison) -> list[Section]:
    """The numbers and offsets of pairs of codes, side by side."""
    judged = comparison.result.judged
    if not judged:
        return []
    terms = judged[0].terms
    how = (
        "Over packings, each compared with itself." if terms.paired else
        "One packing: errors are those of time averages, pooled over all codes; packings scatter besides. What has "
        "too few autocorrelation times concludes nothing."
    )
    note = (
        f"Numbers, and of every profile its mean over the cells: what all cells differ by, which tests of single cells "
        f"do not see. Differences are parts of the number, of a mean over cells of the profile's size (its root mean "
        f"square; of the volume fraction that of its variation over r, as its mean is set by the scene). Errors of v_0 "
        f"and s are those of the same fit to another time; what one exponential misses is in both sides alike. {how} "
        f"{error_rates(terms, len(judged), rate=_one_rate(comparison))}\n{looking_again(terms, comparison.looks)}"
    )
    return [Section(heading="Numbers of codes beside each other", note=note, rows=replicate_page_rows(judged))]


def _one_rate(comparison: Comparison) -> str:
    """State the one rate of false alarms of the page, and what shares it; without a full stop."""
    rate, tests = _declared_rate(comparison), comparison.result.tests
    return (
        f"One rate of false alarms holds for this whole page: the {tests} tests of profiles, numbers, means over "
        f"cells, widths against the talk's and balances of single runs are corrected together (Holm; a test of N cells "
        f"hands in N times its smallest p), so that with a probability of {rate:g} at most any of them says that "
        "something differs where nothing does. What is checked against a declared tolerance, sample by sample, has no "
        "chance in it"
    )


def _declared_rate(comparison: Comparison) -> float:
    """That of this look: further looks are made at half the rate of the one before."""
    return level_of(comparison.scene.compare.false_alarms, comparison.looks)


def _number_note(comparison: Comparison) -> str:
    nu, scene = area_fractions(comparison.scene), comparison.scene
    bands = {e: b.why for e, of in comparison.result.bands.items() for b in of.values() if b.why}
    none = "".join(f" No shear band in {e}: {why}." for e, why in bands.items())
    return (
        f"Averages from {scene.compare.steady_from:g} s to the end; +- is one standard error, of a single packing that "
        f"of the time average. Area fraction {nu['bare']:.4f} of the bare annulus, {nu['free']:.4f} of the free one "
        "between the glued discs. Torques are those of the discs on the rings, per unit thickness. Powers of r are "
        f"fitted a mean diameter away from both rings. v_0 and s belong to v_0 exp(-(r - R_i)/s), fitted up to "
        f"{1e3 * scene.compare.band:g} mm from the ring; their errors are those of the fit times the square root of "
        f"chi^2/dof, which make up for errors that are too small and not for another shape.{none}"
        f"{_misfits(comparison)}"
    )


def _misfits(comparison: Comparison) -> str:
    """Say of which codes the fit does not describe the velocities."""
    found = {e: b.misfit for e, of in comparison.result.bands.items() for b in of.values() if b.misfit}
    return "".join(f" {e}: {why}." for e, why in found.items())


def _profile_note(comparison: Comparison) -> str:
    """Say what error bars are, and what could not be had."""
    runs = [p for of in comparison.result.profiles.values() for p in of.values()]
    absent = {name: why for p in runs for name, why in p.absent.items()}
    missing = "".join(f" Not available: {name}, as {why}." for name, why in absent.items())
    several, declared = len(comparison.starts) > 1, comparison.scene.compare
    error = "over packings" if several else "of the time average, which knows of autocorrelation"
    return (
        f"Means over {runs[0].frames} frames in {len(runs[0].r)} concentric rings, discs cut by borders by their "
        f"area; bands are one standard error {error}. Ratios, deviators and angles are formed from averages. "
        "Runs of one packing are the same numbers until chaos parts them, and independent afterwards; what is judged "
        f"counts them as independent. Profiles share the one rate of false alarms of this page, "
        f"{_declared_rate(comparison):g} for {comparison.result.tests} tests together. They agree where no cell "
        f"differs, a difference of {100 * declared.margin:g} % of the profile's size would have been seen in "
        f"{MOST:.0%} of the cells, in each with a probability of {POWER:g}, and no cell is further apart than "
        f"that.{missing}"
    )


def _pictures(comparison: Comparison) -> list[Section]:
    """Force chains and spins, as far as they were recorded."""
    made = {"Force chains": chain_figure(comparison), "Particle rotations": spin_figure(comparison)}
    return [Section(heading=heading, figures=(figure,)) for heading, figure in made.items() if figure]
