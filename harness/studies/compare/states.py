"""The frames of a run through the post-processor: what the micro-macro averages say against strain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.scene.laws import elastic_stiffness, turning, word
from harness.scene.system import System
from postproc.average import average
from postproc.macro.coordination import MINIMUM_CONTACTS
from postproc.results import Averages, Result, Unavailable, Value
from postproc.snapshot import Snapshot
from postproc.trajectory import Trajectory

ENERGY = "kinetic over elastic energy"
"""How far from rest: about the square of how far forces are out of balance."""

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
    "stiffness anisotropy C_D, inner": ("inner", "stiffness_anisotropy", ()),
    "kinetic energy": ("box", "translational_energy", ()),
    "rotational energy": ("box", "rotational_energy", ()),
    "elastic energy, normal": ("box", "normal_elastic_energy", ()),
    "elastic energy, tangential": ("box", "tangential_elastic_energy", ()),
    ENERGY: ("box", "kinetic_over_elastic_energy", ()),
    "largest residual force": ("box", "unbalanced_force", ()),
}
"""Quantity: the cells it is averaged over ("inner" is the box without a border layer), the
post-processor's name for it, and the component of a tensor."""

OF_THE_OVERLAP = ("elastic energy, normal", ENERGY)
"""Quantities that follow from the overlap for a linear spring only."""


@dataclass(frozen=True, kw_only=True)
class StateCurves:
    """One entry a frame. `values` maps a quantity's name to an array (F,), `units` to its unit ("1": a pure number).

    What the frames cannot give (no contacts recorded, a box too small for an inner part, an energy that
    the overlap does not tell) is left out; `absent` says why.
    """

    strain: np.ndarray
    values: dict[str, np.ndarray]
    units: dict[str, str]
    absent: dict[str, str]


def state_curves(trajectory: Trajectory, system: System) -> StateCurves:
    """Average every frame."""
    z0 = system.wall("top").point[1] - system.wall("bottom").point[1]
    z = [f.walls["py"][system.wall("top").index - 1] - system.wall("bottom").point[1] for f in trajectory]
    rows = [_results(f, system) for f in trajectory]
    missing = {n: [r[n] for r in rows if isinstance(r[n], Unavailable)] for n in rows[0]}
    names = [name for name, found in missing.items() if not found]
    return StateCurves(
        strain=1.0 - np.array(z) / z0,
        values={name: np.array([_number(name, row[name]) for row in rows]) for name in names},
        units={name: rows[0][name].unit for name in names},
        absent={name: found[0].reason for name, found in missing.items() if found},
    )


def frame_averages(frame: Snapshot, system: System) -> dict[str, float]:
    """Return the averages of one frame by name, as numbers."""
    return {name: _number(name, value) for name, value in frame_values(frame, system).items()}


def frame_values(frame: Snapshot, system: System) -> dict[str, Value]:
    """Return what the post-processor makes of one frame, by name, without what it cannot give."""
    return {name: result for name, result in _results(frame, system).items() if isinstance(result, Value)}


def _results(frame: Snapshot, system: System) -> dict[str, Result]:
    """Return all quantities that the effects of this system let exist, with the reasons of what is unavailable.

    A rattler has fewer contacts than hold a disc: two with friction, three without.
    """
    sliding = system.sliding
    settings = {
        "kn": elastic_stiffness(system.normal), "kt": elastic_stiffness(sliding),
        "minimum_contacts": MINIMUM_CONTACTS if sliding else system.dimension + 1,
    }
    averages = {cells: average(frame, cells=cells, fields=_fields(cells), **settings) for cells in ("box", "inner")}
    found = {n: _result(averages[SHOWN[n][0]], SHOWN[n][1]) for n in SHOWN if n not in _off(system)}
    if elastic_stiffness(system.normal) is None:
        reason = f'the law "{word(system.normal)}" stores what the overlap does not tell'
        found |= dict.fromkeys(OF_THE_OVERLAP, Unavailable(reason=reason))
    return found


def _fields(cells: str) -> list[str]:
    return list(dict.fromkeys(name for where, name, _ in SHOWN.values() if where == cells))


def _off(system: System) -> set[str]:
    """Return the quantities that the laws of this system do not let exist: spins, and the energy of springs."""
    spins = set() if turning(system) else {"rotational energy"}
    return spins | (set() if elastic_stiffness(system.sliding) else {"elastic energy, tangential"})


def _result(averages: Averages, name: str) -> Result:
    return (averages.in_cells if name in averages.in_cells else averages.of_state)[name]


def _number(name: str, value: Value) -> float:
    """Return the one number of the only cell that is shown."""
    return float(value.values[0][SHOWN[name][2]])
