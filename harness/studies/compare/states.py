"""The frames of a run through the post-processor: what the micro-macro averages say against strain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.scene.system import System
from postproc.averaging.registry import make_cells
from postproc.macro import balance, coordination, energy, fabric, strength, stress, volume_fraction
from postproc.macro.contact_ends import contact_ends
from postproc.macro.tensors import principal
from postproc.macro.wall_stress import stress_from_walls
from postproc.snapshot import Snapshot
from postproc.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class StateCurves:
    """One entry a frame. `values` maps a quantity's name to an array (F,); stresses in N/m (2D).

    "inner" is the box without a border layer, averaged by particle centres.
    """

    strain: np.ndarray
    values: dict[str, np.ndarray]


def state_curves(trajectory: Trajectory, system: System) -> StateCurves:
    """Average every frame; frames without contacts give only what needs none."""
    z0 = system.wall("top").point[1] - system.wall("bottom").point[1]
    top = [f.walls["py"][system.wall("top").index - 1] for f in trajectory]
    rows = [frame_averages(f, system) for f in trajectory]
    values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return StateCurves(strain=1.0 - np.array(top) / z0, values=values)


def frame_averages(frame: Snapshot, system: System) -> dict[str, float]:
    """Return the averages of one frame by name."""
    box, inner = make_cells("box", frame), make_cells("inner", frame)
    moving = float((energy.translational_energy(box) + energy.rotational_energy(box))[0])
    found = {"volume fraction": float(volume_fraction.volume_fraction(box)[0]), "kinetic energy": moving,
             "volume fraction, inner": float(volume_fraction.volume_fraction(inner)[0])}
    if frame.contacts is None:
        return found
    return found | _from_contacts(frame, box, inner, moving, system)


def _from_contacts(frame: Snapshot, box, inner, moving: float, system: System) -> dict[str, float]:
    ends = contact_ends(frame)
    elastic = energy.normal_elastic_energy(ends, box, kn=system.normal.normal_stiffness)
    if system.sliding is not None:
        elastic = elastic + energy.tangential_elastic_energy(ends, box, kt=system.sliding.shear_stiffness)
    whole, middle = stress.stress(ends, box)[0], stress.stress(ends, inner)
    from_walls = stress_from_walls(frame)
    sigma = principal(middle)
    structure = principal(fabric.fabric(ends, inner))
    return {
        "coordination number": float(coordination.coordination_number(ends, inner)[0]),
        "coordination number without rattlers": float(coordination.backbone_coordination_number(ends, inner)[0]),
        "rattlers": float(coordination.rattler_fraction(ends, inner)[0]),
        "sigma_xx from contacts": float(whole[0, 0]),
        "sigma_zz from contacts": float(whole[1, 1]),
        "sigma_xz from contacts": float(whole[0, 1]),
        "sigma_zx from contacts": float(whole[1, 0]),
        "sigma_xx from walls": float(from_walls[0, 0]),
        "sigma_zz from walls": float(from_walls[1, 1]),
        "friction angle, inner": float(strength.friction_angle(sigma.values)[0]),
        "fabric trace, inner": float(2.0 * structure.isotropic[0]),
        "fabric deviator, inner": float(structure.deviator[0]),
        "elastic energy": float(elastic[0]),
        "kinetic over elastic energy": moving / float(elastic[0]) if elastic[0] else float("nan"),
        "largest residual force": float(balance.unbalanced_force(ends, box)[0]),
    }
