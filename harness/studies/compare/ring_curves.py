"""The torque history of a ring: what an experimenter measures at its two walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.studies.compare.signal import Signal
from postproc.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class RingCurves:
    """Arrays of one length S, one entry a sample.

    time: s. inner_angle: that the inner ring has turned, rad, counter-clockwise. inner_torque, outer_torque: of the
    discs on each ring about its centre, N m (2D of thickness 1: per unit thickness); in steady shear
    counter-clockwise the inner one is negative and the outer one as large and positive.
    """

    step: np.ndarray
    time: np.ndarray
    inner_angle: np.ndarray
    inner_torque: np.ndarray
    outer_torque: np.ndarray

    @property
    def signal(self) -> Signal:
        """What is followed sample by sample: the torque on the inner ring, which passes zero."""
        return Signal(
            step=self.step, place=self.time, value=self.inner_torque, quantity="torque on the inner ring",
            axis="time (s)", word="s", scale=1.0, relative="rms",
        )


def ring_curves(trajectory: Trajectory) -> RingCurves:
    """Return the curves of a finished run of a ring."""
    s = trajectory.series
    return RingCurves(
        step=s["step"], time=s["time"], inner_angle=s["inner_angle"], inner_torque=s["inner_torque"],
        outer_torque=s["outer_torque"],
    )
