"""The one quantity of a run that is followed sample by sample: the top-wall force of a box, the torque on a ring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Signal:
    """S samples of a run.

    step: (S,). place: (S,) where on its way the test is, strain or time in s. value: (S,).
    quantity: its name. axis: name of the place with its unit, in which a place is `scale` times as large; word: the
    unit after a number. relative: what differences are measured by, the larger of two values ("sample") or of the
    two root mean squares over the whole run ("rms", of a signal that passes zero).
    """

    step: np.ndarray
    place: np.ndarray
    value: np.ndarray
    quantity: str
    axis: str
    word: str
    scale: float
    relative: Literal["sample", "rms"]

    def upto(self, limit: float) -> np.ndarray:
        """Return a mask of the samples with place <= limit but for step 0, the same by construction.

        A place that is no number is inside, so that a check over the mask meets it.
        """
        beyond = np.logical_or.accumulate(self.place > limit * (1.0 + 1e-12))  # whoever comes back stays outside
        return ~beyond & (self.step > 0)

    def at(self, place: float, form: str = "g") -> str:
        """Say a place: "0.2 % strain", "3 s"."""
        return f"{self.scale * place:{form}} {self.word}"


def signal_deviation(a: Signal, b: Signal) -> np.ndarray:
    """Return |a - b| over their size, sample by sample, (S,); see `Signal.relative`.

    0 where both are 0, NaN where one is NaN. Raises ValueError for samples of different steps.
    """
    if not np.array_equal(a.step, b.step):
        raise ValueError("samples of different steps")
    difference = np.abs(a.value - b.value)
    size = np.maximum(np.abs(a.value), np.abs(b.value))
    if a.relative == "rms":
        rms = max(float(np.sqrt(np.mean(s.value**2))) for s in (a, b))
        size = np.where(np.isnan(size), np.nan, rms)
    return np.divide(difference, size, out=np.zeros_like(size), where=size != 0)
