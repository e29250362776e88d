"""Strength of regular packings of rigid discs or spheres in layers, at failure and along the softening path.

Each particle rests on two neighbours in the layer below (2D: rows of discs) or on four (3D: square layers
of spheres, face-centred cubic at first), by contacts at an angle th from the axis of the largest stress s1.
Contacts within a layer are open or force-free. At failure all others slide, mu = tan(phi), the force being
turned by phi towards the axis; with F and l the components along and across it::

    s1/s3 = c cot(th) cot(th - phi),      c = 1 (2D),  c = 2 (3D, s2 = s3)

hexagonal packing, th0 = 30 degrees: sqrt(3) (sqrt(3) + mu)/(1 - sqrt(3) mu); th0 = 45 degrees: (1 + mu)/(1 - mu);
face-centred cubic along a cube axis, th0 = 45 degrees: 2 (1 + mu)/(1 - mu). The packing locks for phi >= th0.
Rigid particles leave one uniform motion, with nominal strains (compression positive) e1 and e3::

    cos(th) = (1 - e1) cos(th0),      1 - e3 = sin(th)/sin(th0)

so th grows, the ratio falls, and the packing dilates, until layers two apart touch at th = 60 degrees.

Sources: P. W. Rowe, The stress-dilatancy relation for static equilibrium of an assembly of particles in
contact, Proc. R. Soc. Lond. A 269, 500-527 (1962); C. Thornton, The conditions for failure of a
face-centered cubic array of uniform rigid spheres, Geotechnique 29, 441-459 (1979).

Valid for equal, rigid particles without gravity, rows or layers that deform alike (a soft particle shifts
th by the overlap over the diameter) and do not localise. The tests solve the limit analysis as a linear programme.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

TOUCHING = math.pi / 3
"""Contact angle at which layers two apart touch, rad."""
LOOSEST = {2: math.pi / 6, 3: math.pi / 4}
"""Contact angle at which the neighbours within a layer touch, rad, by dimension."""


@dataclass(frozen=True, kw_only=True)
class LayeredPacking:
    """Contact angle th0 (rad) at the start, friction mu (-) >= 0, dimension 2 (discs) or 3 (spheres).

    Raises ValueError for an angle at which particles of a layer, or of every second one, would overlap.

    >>> round(hexagonal(friction=0.2).strength, 3), round(float(hexagonal(friction=0.0).ratio(0.1)), 6)
    (5.12, 1.547771)
    """

    contact_angle: float
    friction: float
    dimension: Literal[2, 3] = 2

    def __post_init__(self) -> None:
        low, slack = LOOSEST[self.dimension], 1e-12
        if not low - slack <= self.contact_angle < TOUCHING:
            raise ValueError(f"contact_angle must lie in [{low:.4f}, {TOUCHING:.4f}) rad, got {self.contact_angle!r}")
        if self.friction < 0:
            raise ValueError(f"friction must not be negative, got {self.friction!r}")

    @property
    def friction_angle(self) -> float:
        """phi = atan(mu), rad."""
        return math.atan(self.friction)

    @property
    def locks(self) -> bool:
        """Whether no stress ratio moves the packing: mu >= tan(th0)."""
        return self.friction >= math.tan(self.contact_angle)

    @property
    def strength(self) -> float:
        """s1/s3 at failure of the undeformed packing; infinite if it locks."""
        return float(self.ratio(0.0))

    @property
    def final_strain(self) -> float:
        """e1 where layers two apart touch and the path ends: 1 - cos(60 degrees)/cos(th0)."""
        return 1 - math.cos(TOUCHING) / math.cos(self.contact_angle)

    def angle(self, strain: np.ndarray) -> np.ndarray:
        """Contact angle th (rad) at axial nominal strain e1 (any shape), compression positive.

        Raises ValueError for a strain outside [0, final_strain].
        """
        strain = np.asarray(strain, dtype=float)
        if np.any((strain < 0) | (strain > self.final_strain + 1e-12)):
            raise ValueError(f"strain must lie in [0, {self.final_strain:.6f}], where the layers touch")
        # acos(0.5 (1 +- eps)) is well-conditioned here: th stays between 30 and 60 degrees.
        return np.arccos((1 - strain) * math.cos(self.contact_angle))

    def ratio(self, strain: np.ndarray) -> np.ndarray:
        """s1/s3 (Cauchy stresses) while the packing yields at axial strain e1 (any shape); infinite if it locks."""
        th = self.angle(strain)
        factor = self.dimension - 1
        with np.errstate(divide="ignore"):
            moving = factor / (np.tan(th) * np.tan(th - self.friction_angle))
        return np.where(th > self.friction_angle, moving, np.inf)

    def lateral_strain(self, strain: np.ndarray) -> np.ndarray:
        """e3 = 1 - sin(th)/sin(th0), compression positive, so negative."""
        return 1 - np.sin(self.angle(strain)) / math.sin(self.contact_angle)

    def volume_ratio(self, strain: np.ndarray) -> np.ndarray:
        """Volume (2D: area) over that at the start: (1 - e1)(1 - e3)^(dimension - 1)."""
        return (1 - np.asarray(strain, dtype=float)) * (1 - self.lateral_strain(strain)) ** (self.dimension - 1)

    def dilatancy(self, strain: np.ndarray) -> np.ndarray:
        """Lateral extension per axial shortening, -(dl3/l3)/(dl1/l1) of the current sizes: cot(th)^2.

        The stress ratio is dilatancy times Rowe's energy ratio tan(th)/tan(th - phi), times 2 in 3D.
        """
        return 1 / np.tan(self.angle(strain)) ** 2


def hexagonal(*, friction: float) -> LayeredPacking:
    """Discs of a triangular lattice, loaded across the rows: th0 = 30 degrees."""
    return LayeredPacking(contact_angle=math.pi / 6, friction=friction)


def face_centred_cubic(*, friction: float) -> LayeredPacking:
    """Spheres, loaded along a cube axis with s2 = s3: th0 = 45 degrees."""
    return LayeredPacking(contact_angle=math.pi / 4, friction=friction, dimension=3)
