"""The bulk quantities of one run that errors are told of, as the comparison of codes forms them.

A quantity is an array (S,): one number, or a curve at S places. What it is measured by, `scale`, is the size of its
limit, of a volume strain the strain at which it is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from harness.scene.model import Biaxial, Couette, Scene
from harness.studies.accuracy.turn import replaced
from harness.studies.compare.band import band_of
from harness.studies.compare.curves import BiaxialCurves, biaxial_curves
from harness.studies.compare.macro import macro_values
from harness.studies.compare.profiles import ring_profiles, steady_frames, subject_of
from harness.studies.compare.ring_balances import ring_balances
from harness.studies.compare.ring_curves import ring_curves
from harness.studies.compare.ring_numbers import ring_numbers

if TYPE_CHECKING:
    from harness.scene.system import System
    from postproc.trajectory import Trajectory

PLACES = 40
"""Of a stress-strain curve: strains at which runs are compared."""

FROM = 0.005
"""Strain from which on a curve is compared: before, smoothing decides."""


@dataclass(frozen=True, kw_only=True)
class Bulk:
    """A quantity. says: what it is. unit of its numbers. scale: it is measured by, None for the size of its limit."""

    name: str
    says: str
    unit: str
    scale: Callable[[Scene], float] | None = None


def _last_strain(scene: Biaxial) -> float:
    return max(scene.compare.strains, default=scene.top.final_strain)


BULK: dict[type, tuple[Bulk, ...]] = {
    Biaxial: (
        Bulk(name="friction_angle", says="friction angle at the peak", unit="deg"),
        Bulk(name="plateau_angle", says="friction angle at the plateau", unit="deg"),
        Bulk(name="stress_ratio", says="stress ratio at the plateau", unit="1"),
        Bulk(name="volume_strain", says="volume strain at the largest declared strain, over that strain", unit="1",
             scale=_last_strain),
        Bulk(name="stress_strain", says="axial stress over the whole test, rms over strain", unit="N/m"),
    ),
    Couette: (
        Bulk(name="torque", says="torque on the inner ring", unit="N m"),
        Bulk(name="band_width", says="width of the shear band s/d", unit="1"),
        Bulk(name="wall_velocity", says="speed of the discs at the inner ring over its own", unit="1"),
    ),
}
"""By kind of scene; the first is what errors are told of unless the user says otherwise."""

OF_MACRO = {
    "friction_angle": "peak friction angle", "plateau_angle": "plateau friction angle",
    "stress_ratio": "plateau stress ratio",
}
OF_RING = {
    "torque": "torque on the inner ring", "band_width": "s/d (width of the band)",
    "wall_velocity": "v_0 (velocity at the inner ring over its own)",
}


def bulk_values(
    scene: Scene, system: System, trajectory: Trajectory, widths: Mapping[float, float | None]
) -> dict[float, dict[str, np.ndarray]]:
    """Return the quantities of one run for each averaging width, by the width's key; None: the scene's own.

    Quantities that a run does not have (no peak, no band) are left out.
    """
    return VALUES[type(scene)](scene, system, trajectory, widths)


def _of_box(scene: Biaxial, system: System, trajectory: Trajectory, widths) -> dict[float, dict[str, np.ndarray]]:
    curves = biaxial_curves(trajectory, system)
    return {key: _of_curves(scene, curves if w is None else replace(curves, width=w)) for key, w in widths.items()}


def _of_curves(scene: Biaxial, curves: BiaxialCurves) -> dict[str, np.ndarray]:
    numbers = macro_values(curves, scene)
    found = {name: np.array([numbers[macro]]) for name, macro in OF_MACRO.items() if macro in numbers}
    strain = curves.strain
    found["volume_strain"] = np.array([np.interp(_last_strain(scene), strain, curves.volume_strain)])
    places = np.linspace(FROM, scene.top.final_strain, PLACES)
    found["stress_strain"] = np.interp(places, strain, curves.smoothed(curves.stress_zz))
    return {name: values for name, values in found.items() if np.isfinite(values).all()}


def _of_ring(scene: Couette, system: System, trajectory: Trajectory, widths) -> dict[float, dict[str, np.ndarray]]:
    return {key: _of_cells(scene, system, trajectory, width) for key, width in widths.items()}


def _of_cells(scene: Couette, system: System, trajectory: Trajectory, cells: float | None) -> dict[str, np.ndarray]:
    if cells is not None:
        scene = replaced(scene, compare=replaced(scene.compare, cells=round(cells)))
    subjects = [subject_of(f, scene, system) for f in steady_frames(trajectory, scene)]
    profiles = ring_profiles(subjects, system)
    band = band_of(profiles, scene, system)
    numbers = ring_numbers(profiles, ring_balances(ring_curves(trajectory), subjects, system), band)
    found = {name: np.array([numbers[n].value]) for name, n in OF_RING.items() if n in numbers}
    if band.why:
        found.pop("band_width", None)
    return {name: values for name, values in found.items() if np.isfinite(values).all()}


VALUES = {Biaxial: _of_box, Couette: _of_ring}
