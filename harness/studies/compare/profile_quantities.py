"""The profiles of a ring: which averages each is formed from, and how; one line a profile.

Inputs are the post-processor's fields in concentric rings (area weights, polar components) and a few sums that it
makes; `formula` gets their time averages by name. What is not linear is formed from the averages, see
`postproc.propagation`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from postproc.averaging.cells import divide
from postproc.fields import Subject
from postproc.macro.axial import axial
from postproc.macro.contact_ends import outer
from postproc.macro.coordination import contact_number
from postproc.macro.couple_stress import torque_stiffness
from postproc.macro.directions import non_colinearity
from postproc.macro.elastic_strain import bulk_stiffness, shear_stiffness
from postproc.macro.tensors import principal
from postproc.propagation import Means


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One profile: its name, the group that is judged together, its unit ("1": a pure number), and its formula.

    against: name of the profile whose size it is measured by; "" is the largest of its own group. A profile that
    vanishes in theory has no size of its own. centred: its size is that of what it varies by over r, as its mean is
    set by the scene.
    """

    name: str
    group: str
    unit: str
    inputs: tuple[str, ...]
    formula: Callable[[Means], np.ndarray]
    against: str = ""
    centred: bool = False


SUMS: dict[str, Callable[[Subject], np.ndarray]] = {
    "number": lambda s: s.cells.numbers,
    "contact_number": lambda s: s.cells.total(contact_number(s.ends)),
    "branch_moment": lambda s: s.branch_moments,
    "deformation_moment": lambda s: s.cells.contact_density(s.ends, outer(s.contact_deformation, s.ends.l)),
}
"""Inputs that are no fields: sums (K, ...) of one frame, so that ratios are formed of sums over all frames."""


def _velocity(m: Means) -> np.ndarray:
    """Mean velocity (r, phi) by volume."""
    return divide(m["velocity_density"], m["volume_fraction"])


def _spin(m: Means) -> np.ndarray:
    return divide(m["spin_density"], m["volume_fraction"])


def elastic_strain(m: Means) -> np.ndarray:
    """eps = <sum Delta l> . <sum l l>^-1: least squares over the contacts of all frames, (K, 2, 2)."""
    moments = m["branch_moment"]
    good = np.isfinite(moments).all(axis=(1, 2)) & (np.abs(np.linalg.det(np.nan_to_num(moments))) > 0)
    found = np.full(moments.shape, np.nan)
    found[good] = m["deformation_moment"][good] @ np.linalg.inv(moments[good])
    return found


def _component(field: str, a: int, b: int) -> Callable[[Means], np.ndarray]:
    return lambda m: m[field][:, a, b]


def _trace(tensor: np.ndarray) -> np.ndarray:
    return np.trace(tensor, axis1=1, axis2=2)


RR, RP, PR, PP = ("rr", 0, 0), ("rphi", 0, 1), ("phir", 1, 0), ("phiphi", 1, 1)
STRAIN = ("branch_moment", "deformation_moment")
MOTION = ("velocity_density", "volume_fraction")

QUANTITIES = (
    Quantity(name="volume_fraction", group="volume fraction", unit="1", inputs=("volume_fraction",),
             formula=lambda m: m["volume_fraction"], centred=True),
    Quantity(name="v_phi", group="velocity", unit="m/s", inputs=MOTION, formula=lambda m: _velocity(m)[:, 1]),
    Quantity(name="v_r", group="velocity", unit="m/s", inputs=MOTION, formula=lambda m: _velocity(m)[:, 0]),
    Quantity(name="spin", group="spin", unit="rad/s", inputs=("spin_density", "volume_fraction"), formula=_spin),
    Quantity(name="eigen_rotation", group="eigen-rotation", unit="rad/s",
             inputs=("spin_density", "volume_fraction", "rotation_rate"),
             formula=lambda m: _spin(m) - m["rotation_rate"]),
    Quantity(name="D_rphi", group="rate of strain", unit="1/s", inputs=("strain_rate",),
             formula=_component("strain_rate", 0, 1)),
    *(Quantity(name=f"stress_{ab}", group="stress", unit="N/m", inputs=("stress",),
               formula=_component("stress", a, b), against="" if a == b else "stress_rphi")
      for ab, a, b in (RR, PP, RP, PR)),
    Quantity(name="stress_antisymmetric", group="antisymmetric stress", unit="N/m", inputs=("stress",),
             formula=lambda m: axial(m["stress"]), against="stress_rphi"),
    *(Quantity(name=f"kinetic_stress_{ab}", group="kinetic stress", unit="N/m", inputs=("kinetic_stress",),
               formula=_component("kinetic_stress", a, b)) for ab, a, b in (RR, PP, RP)),
    Quantity(name="fabric_trace", group="fabric trace", unit="1", inputs=("fabric",),
             formula=lambda m: _trace(m["fabric"])),
    Quantity(name="fabric_deviator", group="fabric deviator", unit="1", inputs=("fabric",),
             formula=lambda m: principal(m["fabric"]).deviator),
    Quantity(name="coordination_number", group="coordination number", unit="1", inputs=("number", "contact_number"),
             formula=lambda m: divide(m["contact_number"], m["number"])),
    Quantity(name="elastic_strain_isotropic", group="elastic strain", unit="1", inputs=STRAIN,
             formula=lambda m: principal(elastic_strain(m)).isotropic),
    Quantity(name="elastic_strain_deviator", group="elastic strain", unit="1", inputs=STRAIN,
             formula=lambda m: principal(elastic_strain(m)).deviator),
    Quantity(name="bulk_stiffness", group="bulk stiffness", unit="N/m", inputs=("stress", *STRAIN),
             formula=lambda m: bulk_stiffness(principal(m["stress"]), principal(elastic_strain(m)))),
    Quantity(name="shear_stiffness", group="shear stiffness", unit="N/m", inputs=("stress", *STRAIN),
             formula=lambda m: shear_stiffness(principal(m["stress"]), principal(elastic_strain(m)))),
    Quantity(name="non_colinearity_stress_strain", group="non-colinearity", unit="deg", inputs=("stress", *STRAIN),
             formula=lambda m: non_colinearity(principal(m["stress"]).major, principal(elastic_strain(m)).major)),
    Quantity(name="non_colinearity_stress_fabric", group="non-colinearity", unit="deg", inputs=("stress", "fabric"),
             formula=lambda m: non_colinearity(principal(m["stress"]).major, principal(m["fabric"]).major)),
    *(Quantity(name=f"couple_stress_{a}", group="couple stress", unit="N", inputs=("couple_stress",),
               formula=lambda m, k=k: m["couple_stress"][:, k]) for k, a in enumerate(("r", "phi"))),
    Quantity(name="torque_stiffness", group="torque stiffness", unit="N m", inputs=("couple_stress", "curvature"),
             formula=lambda m: torque_stiffness(m["couple_stress"], m["curvature"])),
)
"""All profiles, in the order in which they are shown."""
