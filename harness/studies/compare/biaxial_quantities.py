"""The numbers of a biaxial box that are judged over replicates: peak, plateau, and the state at declared strains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.scene.model import Biaxial
from harness.scene.system import System
from harness.studies.compare.curves import BiaxialCurves
from harness.studies.compare.macro import MACRO, OF_THE_PLATEAU, macro_values, within
from harness.studies.compare.states import SHOWN, frame_values
from harness.studies.statistics.family import Measured
from postproc.trajectory import Trajectory
from postproc.uncertainty import estimate

NUMBERS = ("peak sigma_zz", "peak friction angle", "plateau sigma_zz", "plateau friction angle")
"""Of the whole test, see `harness.studies.compare.macro`. Ratio and angle are one quantity."""

OF_FRAMES = ("coordination number without rattlers, inner", "fabric deviator, inner")
"""Averages of the frames nearest to the strains, see `harness.studies.compare.states`."""

CURVES = {"plateau sigma_zz": "stress_zz", "plateau friction angle": "friction_angle"}
"""What a time average is of."""


@dataclass(frozen=True, kw_only=True)
class OneRun:
    """A completed run: whose, of which replicate, and what came of it."""

    engine: str
    replicate: int
    curves: BiaxialCurves
    trajectory: Trajectory
    system: System


@dataclass(frozen=True, kw_only=True)
class Number:
    """A value of one run; error: its own standard error if it is a time average; scale: see `Measured`."""

    value: float
    unit: str
    error: float | None = None
    scale: float | None = None


def biaxial_quantities(scene: Biaxial, runs: Sequence[OneRun]) -> list[Measured]:
    """Return all quantities that any run has, in order."""
    found = [(run, _numbers(scene, run)) for run in runs]
    names = list(dict.fromkeys(name for _, numbers in found for name in numbers))
    return [_measured(name, [(run, numbers[name]) for run, numbers in found if name in numbers]) for name in names]


def _measured(name: str, found: Sequence[tuple[OneRun, Number]]) -> Measured:
    values: dict[str, dict[int, float]] = {}
    errors: dict[str, dict[int, float]] = {}
    for run, number in found:
        values.setdefault(run.engine, {})[run.replicate] = number.value
        if number.error is not None:
            errors.setdefault(run.engine, {})[run.replicate] = number.error
    first = found[0][1]
    return Measured(quantity=name, unit=first.unit, values=values, errors=errors, scale=first.scale)


def _numbers(scene: Biaxial, run: OneRun) -> dict[str, Number]:
    """Return a run's numbers by name."""
    return _of_the_test(scene, run.curves) | _of_curves(scene, run.curves) | _of_frames(scene, run)


def _of_the_test(scene: Biaxial, curves: BiaxialCurves) -> dict[str, Number]:
    values = macro_values(curves, scene)
    return {
        n: Number(value=values[n], unit=MACRO[n][0], error=_own_error(n, scene, curves)) for n in NUMBERS if n in values
    }


def _own_error(name: str, scene: Biaxial, curves: BiaxialCurves) -> float | None:
    """Return the autocorrelation-aware standard error of a plateau mean; None of what is no mean."""
    if name not in OF_THE_PLATEAU:
        return None
    inside = within(curves.strain, scene.compare.plateau)
    return float(estimate(getattr(curves, CURVES[name])[inside]).error)


def _of_curves(scene: Biaxial, curves: BiaxialCurves) -> dict[str, Number]:
    """sigma_zz, smoothed, and the volume strain at each strain; the latter is measured by the axial strain."""
    if not scene.compare.strains:
        return {}
    smooth, found = curves.smoothed(curves.stress_zz), {}
    for strain in scene.compare.strains:
        stress, volume = (float(np.interp(strain, curves.strain, y)) for y in (smooth, curves.volume_strain))
        found[_at("sigma_zz", strain)] = Number(value=stress, unit="N/m")
        found[_at("volume strain", strain)] = Number(value=volume, unit="1", scale=strain)
    return found


def _of_frames(scene: Biaxial, run: OneRun) -> dict[str, Number]:
    """Averages of the recorded frames; what they cannot give is left out."""
    found = {}
    for strain, frame in frames_near(scene.compare.strains, run).items():
        values = frame_values(run.trajectory.frames[frame], run.system)
        for name in OF_FRAMES:
            if name in values:
                value = float(values[name].values[0][SHOWN[name][2]])
                found[_at(name, strain)] = Number(value=value, unit=values[name].unit)
    return found


def frames_near(strains: Sequence[float], run: OneRun) -> Mapping[float, int]:
    """Return the frame nearest to each strain by its own strain, each once and none of the start.

    Of two that are equally near the earlier one, whatever rounding says, so that it is the same in every run.
    """
    z0 = run.curves.z[0]
    top, bottom = run.system.wall("top"), run.system.wall("bottom")
    own = np.array([1.0 - (f.walls["py"][top.index - 1] - bottom.point[1]) / z0 for f in run.trajectory])
    nearest = dict.fromkeys(int(np.argmin(np.round(np.abs(own - s), 9))) for s in strains)
    return {float(own[k]): k for k in nearest if k > 0}


def _at(name: str, strain: float) -> str:
    return f"{name} at {100 * strain:.2g} % strain"
