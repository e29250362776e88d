"""The biaxial test of one run as curves against axial strain, from wall places and wall forces.

Everything here is what an experimenter measures at the walls of the box, from the run's series:

    z = z_0 - d_top, x = x_0 - d_right, eps = 1 - z/z_0, eps_V = 1 - x z/(x_0 z_0) (compression > 0)
    sigma_zz = F_top/x, sigma_xx = F_right/z (N/m: 2D), ratio R = sigma_zz/sigma_xx
    sin(phi) = (R - 1)/(R + 1), the secant friction angle
    control error = (F_right - p_x z)/(p_x z): how far the side wall is from the pressure asked for
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from harness.scene.system import System
from harness.studies.compare.peak import Peak, first_peak
from harness.studies.compare.signal import Signal
from postproc.trajectory import Trajectory

SMOOTHED = 0.005
"""Strain over which a curve is smoothed before its peak is looked for: several bursts long."""


SAME_STRAIN = 1e-12
"""Below it two strains are one: at the ends of a drive rounding alone is left of the steps."""


@dataclass(frozen=True, kw_only=True)
class BiaxialCurves:
    """Arrays of one length S, one entry a sample; SI units, stresses in N/m, forces > 0 in compression.

    width: strain over which curves are smoothed.
    """

    step: np.ndarray
    time: np.ndarray
    strain: np.ndarray
    x: np.ndarray
    z: np.ndarray
    force_top: np.ndarray
    force_bottom: np.ndarray
    force_left: np.ndarray
    force_right: np.ndarray
    pressure: float
    width: float = SMOOTHED

    @property
    def stress_zz(self) -> np.ndarray:
        """F_top / x, N/m."""
        return self.force_top / self.x

    @property
    def stress_xx(self) -> np.ndarray:
        """F_right / z, N/m."""
        return self.force_right / self.z

    @property
    def mean_stress(self) -> np.ndarray:
        """(sigma_zz + sigma_xx)/2, N/m."""
        return 0.5 * (self.stress_zz + self.stress_xx)

    @property
    def strain_rate(self) -> np.ndarray:
        """Rate at which the height shrinks over the height, 1/s, from the places at the samples around."""
        return -np.gradient(self.z, self.time) / self.z

    @property
    def ratio(self) -> np.ndarray:
        """sigma_zz / sigma_xx of measured stresses; NaN without a side stress."""
        nothing = np.full_like(self.stress_zz, np.nan)
        return np.divide(self.stress_zz, self.stress_xx, out=nothing, where=self.stress_xx != 0)

    @property
    def path(self) -> np.ndarray:
        """Strain gone through, forth and back: the axial strain itself where it only grows, else the sum of |d eps|."""
        steps = np.diff(self.strain)
        if (steps > -SAME_STRAIN).all():
            return self.strain
        return abs(self.strain[0]) + np.concatenate([[0.0], np.cumsum(np.abs(steps))])

    @property
    def friction_angle(self) -> np.ndarray:
        """Secant friction angle in degrees; NaN where a stress pulls, as no angle has such a sine."""
        pushes = np.where(self.ratio >= 0, self.ratio, np.nan)
        return np.degrees(np.arcsin((pushes - 1.0) / (pushes + 1.0)))

    @property
    def volume_strain(self) -> np.ndarray:
        """eps_V, compression positive (dilation is negative)."""
        return 1.0 - self.x * self.z / (self.x[0] * self.z[0])

    @property
    def control_error(self) -> np.ndarray:
        """(F_right - p_x z) / (p_x z)."""
        return self.force_right / (self.pressure * self.z) - 1.0

    @cached_property
    def peak(self) -> Peak | None:
        """Where the first loading branch of sigma_zz ends, None without a clear peak, see `first_peak`.

        Of the ratio, the side force that the control check judges would decide where it is judged.
        """
        return first_peak(self.strain, self.stress_zz, self.smoothed(self.stress_zz), settled=self.width)

    def smoothed(self, values: np.ndarray) -> np.ndarray:
        """Return the mean of `values` (S,) over the samples within half of `width` on either side.

        Where samples lie further apart than that, the value itself.
        """
        path = self.path
        near = np.abs(path[:, None] - path) <= 0.5 * self.width
        np.fill_diagonal(near, True)
        return np.array([values[n].mean() for n in near])

    def upto(self, strain: float) -> np.ndarray:
        """Return a mask of the samples with eps <= strain, see `Signal.upto`."""
        return self.signal.upto(strain)

    @property
    def signal(self) -> Signal:
        """What is followed sample by sample: the force on the top wall."""
        return Signal(
            step=self.step, place=self.strain, value=self.force_top, quantity="top-wall force",
            axis="axial strain (%)", word="% strain", scale=100.0, relative="sample",
        )


def biaxial_curves(trajectory: Trajectory, system: System) -> BiaxialCurves:
    """Return the curves of a finished run of a biaxial system."""
    s = trajectory.series
    right, top, bottom, left = (system.wall(n) for n in ("right", "top", "bottom", "left"))
    z0, x0 = top.point[1] - bottom.point[1], right.point[0] - left.point[0]
    return BiaxialCurves(
        step=s["step"], time=s["time"], strain=s["top_d"] / z0, x=x0 - s["right_d"], z=z0 - s["top_d"],
        force_top=s["top_fy"], force_bottom=-s["bottom_fy"],
        force_left=-s["left_fx"], force_right=s["right_fx"], pressure=right.motion.stress,
    )
