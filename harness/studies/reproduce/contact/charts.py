"""The pictures of the contact study, as data: nanometres and nanonewtons, as in the talk."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.studies.reproduce.contact.back import Spheres
from harness.studies.reproduce.contact.curves import Cycle, Measurements
from harness.studies.reproduce.contact.fit import LawFit, LineFit, law_force, pull_off_slope
from harness.studies.reproduce.contact.loads import Answer, completed
from harness.studies.reproduce.protocol import Chart, Line


def cycle_chart(name: str, what: str, cycle: Cycle, fit: LawFit) -> Chart:
    """Return a cycle and its fit."""
    turn, deepest = cycle.turn, float(cycle.displacement.max())
    low = float(cycle.displacement.min())
    x = np.linspace(low, deepest, 600)
    ways = ((np.ones(600, dtype=bool), x), (np.zeros(600, dtype=bool), x[::-1]))
    force = np.concatenate([law_force(at, loading, deepest, *fit.values) for loading, at in ways])
    lines = (
        _line("way in", cycle.displacement[: turn + 1], cycle.force[: turn + 1], "points"),
        _line("way back", cycle.displacement[turn + 1 :], cycle.force[turn + 1 :], "points"),
        _line("fit of k_1, k_2, k_c", np.concatenate([at for _, at in ways]), force, "line"),
    )
    k_1, k_2, k_c, _ = fit.values
    return Chart(
        name=name, x="displacement (nm)", y="force (nN)", lines=lines,
        caption=f"{what} and the piecewise linear hysteretic law: k_1 = {k_1:.3g}, k_2 = {k_2:.3g}, "
        f"k_c = {k_c:.3g} N/m.",
    )


def line_chart(found: Measurements, fit: LineFit) -> Chart:
    """Return measured points of pull-off or hysteresis and their line."""
    x = np.linspace(0, float(found.x.max()), 50)
    titles = {"pull-off": ("load", "pull-off"), "hysteresis": ("force (N)", "hysteresis (m)")}[found.kind]
    return Chart(
        name="measured_line", x=titles[0], y=titles[1], caption=f"{found.name} in SI units, and its line.",
        lines=(Line(name=found.name, x=found.x, y=found.y, error=found.error, look="points"),
               Line(name="line", x=x, y=fit.slope * x + fit.offset, look="fit")),
    )


def pull_off_chart(answered: Sequence[Answer], fit: LawFit, spheres: Spheres) -> Chart:
    """Return pull-off against load over the radius, in the axes of the talk's figure."""
    unit = 1e3 / spheres.radius
    lines = [
        Line(name=engine, engine=engine, x=unit * np.array([a.top for a in of]), look="points",
             y=unit * np.array([-float(a.force.min()) for a in of]))
        for engine, of in completed(answered).items()
    ]
    load = unit * np.linspace(0, max((a.top for of in completed(answered).values() for a in of), default=0.0), 20)
    lines.append(Line(name="law: k_c (k_2 - k_1)/(k_1 (k_2 + k_c))", x=load, y=pull_off_slope(*fit.values[:3]) * load))
    return Chart(
        name="pull_off", x="normalized load (mN/m)", y="normalized adhesion force (mN/m)", lines=tuple(lines),
        caption=f"Pull-off against load over a radius of {1e6 * spheres.radius:g} micrometres (chosen), in the kind of "
        "axes of the talk's Fig. 6: the deepest pull that codes answered along prescribed cycles, and the law.",
    )


def hysteresis_chart(answered: Sequence[Answer], fit: LawFit) -> Chart:
    """Return hysteresis against the largest force, in the axes of the talk's figures."""
    lines = [
        Line(name=engine, engine=engine, look="points", x=1e9 * np.array([a.top for a in of]),
             y=1e9 * np.array([a.hysteresis for a in of]))
        for engine, of in completed(answered).items()
    ]
    force = np.linspace(0, max((a.top for of in completed(answered).values() for a in of), default=0.0), 20)
    slope = 1 / fit.values[0] - 1 / fit.values[1]
    lines.append(Line(name="law: 1/k_1 - 1/k_2", x=1e9 * force, y=1e9 * slope * force))
    return Chart(
        name="hysteresis", x="largest force (nN)", y="deformation hysteresis (nm)", lines=tuple(lines),
        caption="Displacement that is left where the force is zero on the way back, against the cycle's largest force.",
    )


def _line(name: str, x: np.ndarray, y: np.ndarray, look: str) -> Line:
    return Line(name=name, x=1e9 * x, y=1e9 * y, look=look)
