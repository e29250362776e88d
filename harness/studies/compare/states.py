"""The frames of a run through the post-processor: what the micro-macro averages say against strain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.scene.system import System
from postproc.average import average
from postproc.macro.coordination import MINIMUM_CONTACTS
from postproc.results import Averages, Value
from postproc.snapshot import Snapshot
from postproc.trajectory import Trajectory

XX, XZ, ZX, ZZ = (0, 0), (0, 1), (1, 0), (1, 1)
SHOWN: dict[str, tuple[str, str, tuple[int, ...]]] = {
    "volume fraction": ("box", "volume_fraction", ()),
    "volume fraction, inner": ("inner", "volume_fraction", ()),
    "coordination number, inner": ("inner", "coordination_number", ()),
    "coordination number without rattlers, inner": ("inner", "backbone_coordination_number", ()),
    "rattlers, inner": ("inner", "rattler_fraction", ()),
    "sigma_xx from contacts": ("box", "stress", XX),
    "sigma_zz from contacts": ("box", "stress", ZZ),
    "sigma_xz from contacts": ("box", "stress", XZ),
    "sigma_zx from contacts": ("box", "stress", ZX),
    "sigma_xx from walls": ("box", "stress_from_walls", XX),
    "sigma_zz from walls": ("box", "stress_from_walls", ZZ),
    "friction angle, inner": ("inner", "friction_angle", ()),
    "fabric trace, inner": ("inner", "fabric_trace", ()),
    "fabric deviator, inner": ("inner", "fabric_deviator", ()),
    "kinetic energy": ("box", "translational_energy", ()),
    "rotational energy": ("box", "rotational_energy", ()),
    "elastic energy, normal": ("box", "normal_elastic_energy", ()),
    "elastic energy, tangential": ("box", "tangential_elastic_energy", ()),
    "kinetic over elastic energy": ("box", "kinetic_over_elastic_energy", ()),
    "largest residual force": ("box", "unbalanced_force", ()),
}
"""Quantity: the cells it is averaged over ("inner" is the box without a border layer), the
post-processor's name for it, and the component of a tensor."""

OF_FRICTION = ("rotational energy", "elastic energy, tangential")
"""Quantities that there are with friction only."""


@dataclass(frozen=True, kw_only=True)
class StateCurves:
    """One entry a frame. `values` maps a quantity's name to an array (F,); stresses in N/m (2D).

    What the frames cannot give (no contacts recorded, a box too small for an inner part) is left out.
    """

    strain: np.ndarray
    values: dict[str, np.ndarray]


def state_curves(trajectory: Trajectory, system: System) -> StateCurves:
    """Average every frame."""
    z0 = system.wall("top").point[1] - system.wall("bottom").point[1]
    z = [f.walls["py"][system.wall("top").index - 1] - system.wall("bottom").point[1] for f in trajectory]
    rows = [frame_averages(f, system) for f in trajectory]
    names = [name for name in SHOWN if all(name in row for row in rows)]
    values = {name: np.array([row[name] for row in rows]) for name in names}
    return StateCurves(strain=1.0 - np.array(z) / z0, values=values)


def frame_averages(frame: Snapshot, system: System) -> dict[str, float]:
    """Return the averages of one frame by name.

    A rattler has fewer contacts than hold a disc: two with friction, three without.
    """
    sliding = system.sliding
    settings = {
        "kn": system.normal.normal_stiffness, "kt": sliding.shear_stiffness if sliding else None,
        "minimum_contacts": MINIMUM_CONTACTS if sliding else system.dimension + 1,
    }
    averages = {cells: average(frame, cells=cells, **settings) for cells in ("box", "inner")}
    names = [n for n in SHOWN if sliding or n not in OF_FRICTION]
    found = {n: _one(averages[SHOWN[n][0]], *SHOWN[n][1:]) for n in names}
    return {name: value for name, value in found.items() if value is not None}


def _one(averages: Averages, name: str, component: tuple[int, ...]) -> float | None:
    """Return one number of the only cell, None if it is unavailable."""
    result = (averages.in_cells if name in averages.in_cells else averages.of_state)[name]
    return float(result.values[0][component]) if isinstance(result, Value) else None
