"""How fast an error falls with the step: a slope, and how well it is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RESOLVED = 0.04
"""dt_fraction from which on a contact is resolved, 25 steps and more: slopes are of those rungs."""

FEWEST = 3
DRAWS = 200
ABOVE = 5.0
"""Times the error of the oracle: what lies below is not fitted."""


@dataclass(frozen=True, kw_only=True)
class Fit:
    """error ~ dt^slope over `rungs` rungs. error: one standard error, of scatter about the line and of the phases.

    at: error that the line has at the step `reference`.
    """

    slope: float
    error: float
    rungs: int
    reference: float
    at: float


def fit_order(dt: Sequence[float], errors: np.ndarray, *, oracle: float) -> Fit | None:
    """Fit ln rms(error) = p ln dt + c over the rungs above the oracle's error; None with fewer than three.

    dt: (R,). errors: (R, K) by phase. The standard error joins that of the scatter about the line with that of the
    phases, which are drawn again with replacement, the same ones on all rungs.
    """
    dt, size = np.asarray(dt), rms(errors)
    used = _above(size, oracle)
    if used.sum() < FEWEST:
        return None
    x, chosen = np.log(dt[used]), errors[used]
    slope, offset, scatter = _line(x, np.log(size[used]))
    draws = np.random.default_rng(1).integers(0, errors.shape[1], (DRAWS, errors.shape[1]))
    drawn = [_line(x, np.log(rms(chosen[:, d])))[0] for d in draws]
    reference = float(dt[used].min())
    return Fit(
        slope=slope, error=float(np.hypot(scatter, np.std(drawn))), rungs=int(used.sum()), reference=reference,
        at=float(np.exp(offset + slope * np.log(reference))),
    )


def why_no_fit(size: Sequence[float], rungs: int, *, oracle: float) -> str:
    """Return why `fit_order` fits nothing, "" if it fits. size: of the errors of resolved rungs, out of all `rungs`."""
    if len(size) < FEWEST:
        return (
            f"{len(size)} of {rungs} rungs have an answer at {1.0 / RESOLVED:g} steps a contact and more; a line needs "
            f"{FEWEST}"
        )
    used = int(_above(np.asarray(size), oracle).sum())
    if used >= FEWEST:
        return ""
    return (
        f"{used} of {len(size)} rungs of {1.0 / RESOLVED:g} steps a contact and more lie above {ABOVE:g} times the "
        f"error of the oracle, {oracle:.1g}; a line needs {FEWEST}"
    )


def _above(size: np.ndarray, oracle: float) -> np.ndarray:
    return (size > ABOVE * oracle) & (size > 0.0)


def rms(errors: np.ndarray) -> np.ndarray:
    """Return the root mean square over the last axis."""
    return np.sqrt((errors**2).mean(axis=-1))


def step_for(dt: Sequence[float], size: Sequence[float], target: float) -> float | None:
    """Return the largest dt from which on the error stays below `target`, by lines between rungs in the logarithms.

    None where no rung is below it, or where all are: then the ladder does not tell.
    """
    order = np.argsort(dt)
    x, y = np.log(np.asarray(dt)[order]), np.log(np.asarray(size)[order])
    above = np.flatnonzero(y > np.log(target))
    if not len(above) or above[0] == 0:
        return None
    k = above[0]
    return float(np.exp(np.interp(np.log(target), y[k - 1 : k + 1], x[k - 1 : k + 1])))


def _line(x: np.ndarray, y: np.ndarray) -> tuple[float, float, float]:
    """Return slope, offset and the slope's standard error, sqrt(RSS/(n - 2)/Sxx)."""
    dx = x - x.mean()
    square = float(dx @ dx)
    slope = float(dx @ y) / square
    offset = float(y.mean() - slope * x.mean())
    rest = y - offset - slope * x
    return slope, offset, float(np.sqrt(rest @ rest / (len(x) - 2) / square))
