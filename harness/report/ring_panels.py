"""What a ring shows quantity by quantity: profiles of all codes with their error bands."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from harness.report import figures
from harness.report.bands import Band
from harness.report.page import Figure
from harness.report.panels import draw_bands, panel

if TYPE_CHECKING:
    from harness.studies.compare.couette import CouetteResult
    from harness.studies.compare.profiles import Profile, RingProfiles
    from harness.studies.compare.study import Comparison

DEPTH = "(r - R_i)/d"
RADIUS = "r (mm)"

Shown = Mapping[str, tuple[str, str]]
"""Profile: label and caption."""

MOTION: Shown = {
    "spin": ("spin ω (rad/s)", "Mean spin of the discs, counter-clockwise positive."),
    "eigen_rotation": ("ω* = ω - W (rad/s)", "Eigen-rotation: spin beyond that of the mean flow."),
    "D_rphi": ("D_rφ (1/s)", "Rate of shear, from the slope of velocities within each ring."),
    "v_r": ("v_r (m/s)", "Radial velocity: nothing where the state is steady."),
}
STRESS: Shown = {
    "stress_antisymmetric": ("(σ_rφ - σ_φr)/2 (N/m)", "Antisymmetric stress: nothing while spins are steady."),
    "kinetic_stress_rr": ("kinetic σ_rr (N/m)", "Kinetic (dynamic) stress, radial."),
    "kinetic_stress_rphi": ("kinetic σ_rφ (N/m)", "Kinetic (dynamic) stress, shear."),
}
STRUCTURE: Shown = {
    "fabric_trace": ("tr F", "Trace of the fabric: contact number density."),
    "fabric_deviator": ("dev F", "Deviator of the mean fabric."),
    "coordination_number": ("C", "Mean number of contacts."),
}
STIFFNESS: Shown = {
    "elastic_strain_isotropic": ("ε isotropic", "Elastic strain of the contacts, isotropic part."),
    "elastic_strain_deviator": ("ε deviator", "Elastic strain of the contacts, deviator."),
    "bulk_stiffness": ("E = tr σ/tr ε (N/m)", "Bulk stiffness."),
    "shear_stiffness": ("G = dev σ/dev ε (N/m)", "Shear stiffness."),
    "non_colinearity_stress_strain": ("stress to strain (°)", "Angle from the stress to the elastic strain."),
    "non_colinearity_stress_fabric": ("stress to fabric (°)", "Angle from the stress to the fabric."),
}
COUPLES: Shown = {
    "couple_stress_r": ("M_r (N)", "Couple stress, face across r."),
    "couple_stress_phi": ("M_φ (N)", "Couple stress, face across φ."),
    "torque_stiffness": ("M/κ (N m)", "Torque stiffness."),
}


def profile_panels(comparison: Comparison, wanted: Shown) -> tuple[Figure, ...]:
    """One panel a profile that some run has."""
    result = comparison.result
    return tuple(
        _profile_panel(result, name, label, caption, comparison) for name, (label, caption) in wanted.items()
        if any(name in p.profiles for of in result.profiles.values() for p in of.values())
    )


def _profile_panel(result: CouetteResult, name: str, label: str, caption: str, comparison: Comparison) -> Figure:
    bands = profile_bands(result, name)
    return panel(lambda axes: _draw(axes, bands, comparison, label), caption)


def _draw(axes, bands: Mapping[str, Band], comparison: Comparison, label: str, *, scale: float = 1.0) -> None:
    draw_bands(axes, in_diameters(bands, comparison), x=DEPTH, y=label, scale=(1.0, scale))


def in_diameters(bands: Mapping[str, Band], comparison: Comparison) -> dict[str, Band]:
    """Return the bands over (r - R_i)/d."""
    inner, d = comparison.scene.rings.inner_radius, diameter(comparison)
    return {
        e: Band(place=(b.place - inner) / d, mean=b.mean, error=b.error, count=b.count) for e, b in bands.items()
    }


def diameter(comparison: Comparison) -> float:
    """Mean diameter of the discs, m."""
    return 2.0 * float(comparison.starts[0].system.particles.radius.mean())


def profile_bands(result: CouetteResult, name: str) -> dict[str, Band]:
    """Return a profile of every engine that has it, with one standard error: of time, or over packings."""
    return bands_of({e: list(of.values()) for e, of in result.profiles.items()}, lambda p: p.profiles.get(name))


def bands_of(runs: Mapping[str, Sequence[RingProfiles]], pick: Callable[[RingProfiles], Profile | None]):
    """Return the band of what `pick` finds in each engine's runs."""
    found = {}
    for engine, of in runs.items():
        profiles = [(p.r, q) for p in of if (q := pick(p)) is not None]
        if profiles:
            found[engine] = _band([r for r, _ in profiles], [q for _, q in profiles])
    return found


def _band(r: Sequence[np.ndarray], profiles: Sequence[Profile]) -> Band:
    means, n = np.array([p.mean for p in profiles]), len(profiles)
    error = profiles[0].error if n == 1 else means.std(axis=0, ddof=1) / np.sqrt(n)
    return Band(place=r[0], mean=means.mean(axis=0), error=error, count=n)


# --- panels of their own -----------------------------------------------------------------------


def velocity_panels(comparison: Comparison) -> tuple[Figure, ...]:
    """Velocity, logarithmic and linear, with the fits."""
    caption = "Velocity over that of the inner ring; dashed: fits of v_0 exp(-(r - R_i)/s) where they were made."
    return (
        panel(lambda axes: draw_velocity(axes, comparison), caption),
        panel(lambda axes: draw_velocity(axes, comparison, log=False), "The same, linear."),
    )


def draw_velocity(axes, comparison: Comparison, *, log: bool = True) -> None:
    """Draw v_phi/(Omega R_i) of every engine and its fit."""
    scene, result = comparison.scene, comparison.result
    wall, d = scene.rings.omega * scene.rings.inner_radius, diameter(comparison)
    bands = in_diameters(profile_bands(result, "v_phi"), comparison)
    draw_bands(axes, bands, x=DEPTH, y="v_φ/(Ω R_i)", scale=(1.0, 1.0 / wall))
    for engine, of in result.bands.items():
        fit = next(iter(of.values())).fit
        if fit is not None:
            depth = np.linspace(fit.low, fit.high, 50)
            axes.plot(depth / d, fit.v0.value * np.exp(-depth / fit.s.value), color=figures.line_style(engine)["color"],
                      linestyle="--", lw=0.8)
    seen = [b.mean / wall for b in bands.values()]
    if log and any((v > 0).any() for v in seen):
        axes.set_yscale("log", nonpositive="mask")
        least = min(float(v[v > 0].min()) for v in seen if (v > 0).any())
        axes.set_ylim(least / 3.0, 1.5)


def density_panels(comparison: Comparison) -> tuple[Figure, ...]:
    """Volume fraction of the whole cells, and of what the glued discs leave of them."""
    from harness.scene.ring import area_fractions

    nu = area_fractions(comparison.scene)
    return (
        panel(lambda axes: draw_density(axes, comparison, free=False),
              f"Volume fraction of whole rings; dotted: mean over the bare annulus, {nu['bare']:.4f}."),
        panel(lambda axes: draw_density(axes, comparison, free=True),
              "Volume fraction of what glued discs leave of the rings; dotted: mean over the free annulus between "
              f"them, {nu['free']:.4f}."),
    )


def draw_density(axes, comparison: Comparison, *, free: bool) -> None:
    """Draw the volume fraction, bare or free."""
    from harness.scene.ring import area_fractions

    result = comparison.result
    bands = profile_bands(result, "volume_fraction")
    if free:
        glued = next(iter(next(iter(result.profiles.values())).values())).glued
        bands = {
            e: Band(place=b.place, mean=b.mean / (1 - glued), error=b.error / (1 - glued), count=b.count)
            for e, b in bands.items()
        }
    kind = "free" if free else "bare"
    _draw(axes, bands, comparison, f"ν, {kind}")
    axes.axhline(area_fractions(comparison.scene)[kind], color="#444444", lw=0.8, linestyle=":")


COMPONENTS = {"stress_rr": "-", "stress_phiphi": "--", "stress_rphi": "-.", "stress_phir": ":"}
"""Component of the stress and how its line is drawn."""


def stress_panels(comparison: Comparison) -> tuple[Figure, ...]:
    """Stress of each kind over r, and the torque it carries."""
    if not profile_bands(comparison.result, "stress_rr"):
        return ()
    return (
        panel(lambda axes: _draw_stress(axes, comparison, ("stress_rr", "stress_phiphi")),
              "Static stress: rr full, φφ dashed; statics of the ring: r^0. Cells narrower than a disc show layers."),
        panel(lambda axes: _draw_stress(axes, comparison, ("stress_rphi", "stress_phir")),
              "Static shear stress: rφ dash-dotted, φr dotted; black: r^-2 of the inner ring's torque."),
        *profile_panels(comparison, STRESS),
    )


def _draw_stress(axes, comparison: Comparison, names: Sequence[str]) -> None:
    for name in names:
        for engine, b in profile_bands(comparison.result, name).items():
            style = figures.line_style(engine) | {"linestyle": COMPONENTS[name]}
            if name != names[0]:
                style.pop("label")
            axes.plot(1e3 * b.place, b.mean, **style)
            axes.fill_between(1e3 * b.place, b.mean - b.error, b.mean + b.error, color=style["color"], alpha=0.15, lw=0)
    if names[0] == "stress_rphi":
        balances = next(iter(next(iter(comparison.result.balances.values())).values()))
        line = -balances.inner.mean[0] / (2.0 * np.pi * balances.r**2)
        axes.plot(1e3 * balances.r, line, color="black", lw=1.0)
    axes.set_xlabel(RADIUS)
    axes.set_ylabel("σ (N/m)")
    axes.grid(alpha=0.3)


def balance_panels(comparison: Comparison) -> tuple[Figure, ...]:
    """Torque through circles against both walls, and what is left over of momentum."""
    if not any(b.through is not None for of in comparison.result.balances.values() for b in of.values()):
        return ()
    return (
        panel(lambda axes: draw_torque_through(axes, comparison),
              "2π r² σ_rφ over the torque of the inner ring. Through circles, with the error of its difference from "
              "that torque and the drag between. Thin dots: area averages in rings, which smear a contact over its "
              "disc and follow the layers. Crosses: both rings."),
        panel(lambda axes: _draw_rest(axes, comparison, 0), "Left over of radial momentum, over the pressure."),
        panel(lambda axes: _draw_rest(axes, comparison, 1), "Left over of momentum along φ, over the pressure."),
    )


def draw_torque_through(axes, comparison: Comparison) -> None:
    """Draw the torque through circles and that of area averages, first packing of each engine."""
    for engine, of in comparison.result.balances.items():
        k, b = next(iter(of.items()))
        style, torque = figures.line_style(engine), -float(b.inner.mean[0])
        if b.through is None or not torque:
            continue
        _line(axes, 1e3 * b.r, b.from_inner, 1.0 / torque, style, above=1.0)
        stress = comparison.result.profiles[engine][k].profiles["stress_rphi"].mean
        of_areas = 2 * np.pi * b.r**2 * stress / float(b.through.mean.mean())  # of the same frames
        axes.plot(1e3 * b.r, of_areas, color=style["color"], linestyle=":", lw=0.8)
        rings = comparison.scene.rings
        axes.plot([1e3 * rings.inner_radius, 1e3 * rings.outer_radius], [1.0, float(b.outer.mean[0]) / torque], "x",
                  color=style["color"], ms=5)
    axes.set_xlabel(RADIUS)
    axes.set_ylabel("torque through r, over the inner ring's")
    axes.grid(alpha=0.3)


def _draw_rest(axes, comparison: Comparison, axis: int) -> None:
    for engine, of in comparison.result.balances.items():
        b = next(iter(of.values()))
        if b.momentum is not None and b.pressure:
            _line(axes, 1e3 * b.r, b.momentum[axis], 1.0 / b.pressure, figures.line_style(engine))
    axes.set_xlabel(RADIUS)
    axes.set_ylabel(f"residual {'rφ'[axis]}, over the pressure")
    axes.grid(alpha=0.3)


def _line(axes, x: np.ndarray, p: Profile, scale: float, style: dict, *, above: float = 0.0) -> None:
    mean, error = above + scale * p.mean, abs(scale) * p.error
    axes.plot(x, mean, **style)
    axes.fill_between(x, mean - error, mean + error, color=style["color"], alpha=0.2, lw=0)


def stiffness_panel(comparison: Comparison) -> tuple[Figure, ...]:
    """Bulk stiffness against the trace of the fabric: linear in the published rings."""
    E, F = (profile_bands(comparison.result, name) for name in ("bulk_stiffness", "fabric_trace"))
    if not E:
        return ()
    return (panel(lambda axes: _draw_against(axes, F, E), "Bulk stiffness against tr F, one point a ring."),)


def _draw_against(axes, F: Mapping[str, Band], E: Mapping[str, Band]) -> None:
    for engine in E:
        style = figures.line_style(engine)
        axes.errorbar(
            F[engine].mean, E[engine].mean, xerr=F[engine].error, yerr=E[engine].error, fmt=".", lw=0.6, ms=4,
            color=style["color"], label=engine,
        )
    axes.set_xlabel("tr F")
    axes.set_ylabel("E (N/m)")
    axes.grid(alpha=0.3)
