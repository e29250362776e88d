"""The pictures of the ring study, as data: profiles of all densities of one engine, and of all engines at one."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from harness.studies.reproduce.protocol import Ask, Chart, Line
from harness.studies.reproduce.ring.cases import SPRINGS, main_plans
from harness.studies.reproduce.ring.measure import RingRun
from harness.studies.reproduce.ring.numbers import Runs, collapse
from postproc.results import Unavailable

PROFILES = (
    ("velocity", "v_phi", "v_phi over that of the inner ring", "Velocity of the discs, exponential in the band.",
     "speed"),
    ("density", "volume_fraction", "area fraction of the discs, glued ones left out", "Dilation at the inner ring.",
     "free"),
    ("spin", "spin", "spin over Omega", "Spin of the discs: layers at the inner ring roll on each other.", "omega"),
    ("eigen_rotation", "eigen_rotation", "(omega - W_rphi) over Omega", "Eigen-rotation.", "omega"),
    ("stress_normal", "stress_rr", "sigma_rr (N/m)", "Static normal stress: r^0 in the talk.", ""),
    ("stress_shear", "stress_rphi", "|sigma_rphi| (N/m)", "Static shear stress: r^-2 in the talk.", "size"),
    ("stress_dynamic", "kinetic_stress_phiphi", "dynamic stress rho <v' v'>_phiphi (N/m)",
     "Dynamic stress: decays from the inner ring.", "size"),
    ("fabric_trace", "fabric_trace", "tr F", "Trace of the fabric.", ""),
    ("fabric_deviator", "fabric_deviator", "dev F", "Deviator of the fabric.", ""),
    ("non_colinearity", "non_colinearity_stress_strain", "angle from stress to elastic strain (degrees)",
     "Stress and elastic strain do not lie along each other.", ""),
)
"""Name, profile, axis, what it shows, scale."""

LOGARITHMIC = {"velocity", "stress_shear", "stress_dynamic"}


def charts_of(ask: Ask, runs: Runs, engines: Sequence[str]) -> tuple[Chart, ...]:
    """Return all charts; nothing without runs."""
    if not engines:
        return ()
    found = [_profile_chart(ask, runs, engines[0], p) for p in PROFILES]
    found += [_codes_chart(ask, runs, engines), _collapse_chart(ask, runs, engines[0]),
              _torque_chart(runs, engines)]
    found += [_distribution_chart(ask, runs, engines[0], *d) for d in (
        ("speeds", "v_phi over Omega R_i", lambda r: r.speeds), ("spins", "spin over Omega", lambda r: r.spins))]
    return tuple(c for c in found if c.lines)


def _first(runs: Runs, case: str, engine: str) -> RingRun | None:
    return next(iter(runs.get(case, {}).get(engine, {}).values()), None)


def _profile_chart(ask: Ask, runs: Runs, engine: str, shown: tuple[str, str, str, str, str]) -> Chart:
    (name, profile, axis, says, scale), lines = shown, []
    for plan in main_plans(ask):
        run = _first(runs, plan.name, engine)
        if run is None or profile not in run.profiles.profiles:
            continue
        line = _line(run, profile, scale, plan.name)
        lines.append(_positive(line) if name in LOGARITHMIC else line)
        if name == "velocity" and run.band.fit is not None:
            depth = np.linspace(0, run.scene.compare.band / run.band.diameter, 50)
            lines.append(Line(name="", x=depth, y=run.band.fit.v0.value * np.exp(-depth / run.band.width), look="fit"))
    return Chart(name=name, x="(r - R_i)/d", y=axis, log_y=name in LOGARITHMIC, lines=tuple(lines),
                 caption=f"{says} {engine}, first packing; standard errors over time.")


def _line(run: RingRun, profile: str, scale: str, name: str, engine: str = "") -> Line:
    p, rings = run.profiles.profiles[profile], run.scene.rings
    factor = {
        "speed": 1 / (rings.omega * rings.inner_radius), "omega": 1 / rings.omega,
        "free": 1 / np.maximum(1 - run.profiles.glued, 1e-9), "size": np.sign(np.nanmean(p.mean)),
    }.get(scale, 1.0)
    return Line(name=name, x=run.depth, y=factor * p.mean, error=np.abs(factor) * p.error, engine=engine)


def _positive(line: Line) -> Line:
    known = np.isfinite(line.y) & (line.y > 0)
    error = np.minimum(line.error[known], 0.9 * line.y[known])
    return Line(name=line.name, x=line.x[known], y=line.y[known], error=error, engine=line.engine, look=line.look)


def _codes_chart(ask: Ask, runs: Runs, engines: Sequence[str]) -> Chart:
    plan = main_plans(ask)[-1] if ask.size == "paper" else main_plans(ask)[0]
    lines = [
        _positive(_line(run, "v_phi", "speed", e, e)) for e in engines
        if (run := _first(runs, plan.name, e)) is not None and "v_phi" in run.profiles.profiles
    ]
    return Chart(name="codes", x="(r - R_i)/d", y="v_phi over that of the inner ring", log_y=True, lines=tuple(lines),
                 caption=f"The same profile of all codes, {plan.name}: chaos makes runs of one packing differ.")


def _collapse_chart(ask: Ask, runs: Runs, engine: str) -> Chart:
    found = collapse(ask, runs, engine)
    if isinstance(found, Unavailable):
        return Chart(name="bulk_stiffness", x="", y="", caption="", lines=())
    lines = [
        Line(name=str(name), x=found.trace[found.density == name], y=found.bulk[found.density == name],
             error=found.error[found.density == name], look="points")
        for name in dict.fromkeys(found.density.tolist())
    ]
    x = np.linspace(found.trace.min(), found.trace.max(), 20)
    lines.append(Line(name="line through all", x=x, y=np.polyval(found.line.parameters, x)))
    return Chart(name="bulk_stiffness", x="tr F", y="E = tr sigma/tr eps (N/m)", lines=tuple(lines),
                 caption=f"Bulk stiffness against the trace of the fabric, cells of all densities, {engine}.")


def _torque_chart(runs: Runs, engines: Sequence[str]) -> Chart:
    lines = []
    for engine in engines:
        run = _first(runs, SPRINGS, engine)
        if run is None or "torque_stiffness" not in run.profiles.profiles:
            continue
        p = run.profiles.profiles["torque_stiffness"]
        known = np.isfinite(p.mean)
        lines.append(Line(name=engine, x=run.depth[known], y=p.mean[known], error=p.error[known], engine=engine,
                          look="points"))
    return Chart(name="torque_stiffness", x="(r - R_i)/d", y="mu l^2 = M/kappa (N m)", lines=tuple(lines),
                 caption="Torque stiffness of the ring with friction springs: couple stress over elastic curvature.")


def _distribution_chart(ask: Ask, runs: Runs, engine: str, name: str, axis: str, of: Callable) -> Chart:
    lines = []
    for plan in main_plans(ask):
        run = _first(runs, plan.name, engine)
        if run is not None:
            d = of(run)
            known = d.density > 0
            lines.append(Line(name=plan.name, x=d.middles[known], y=d.density[known], error=np.minimum(
                d.error[known], 0.9 * d.density[known]), look="steps"))
    return Chart(name=f"distribution_{name}", x=axis, y="probability density", log_y=True, lines=tuple(lines),
                 caption=f"Discs within two diameters of the inner ring, high and low density, {engine}.")
