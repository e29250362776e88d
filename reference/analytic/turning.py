"""What a spring with a limit answers at a contact that turns, row by row; no closed form, but a recursion of six lines.

The spring xi is a vector of the slip that has not slid. A contact with normals n_k is driven with slip velocities v_k
(across n_k), rows dt apart. How codes keep xi in the plane across the turning normal, P = 1 - n n, `keep`:

`length`      xi <- |xi| P xi/|P xi| + v dt: the direction is projected, the length kept (S. Luding, Granular Matter 10,
              235 (2008), section 2.3). Exact where the normal turns in the plane of n and xi; a turn about n
              is not followed
`projection`  xi <- P (xi + v dt): a spring in the plane of the turn loses (angle of a row)^2/2 of its length
`space`       xi <- xi + v dt: what was stretched stays where it was in space

Then the answer, -k xi - gamma v up to the limit, `cut` as in `reference.analytic.prescribed`; "rate" is "total", but a
sliding contact resists the rate whatever its spring says. Contacts that open forget. SI units; all arrays rows first.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

Keep = Literal["length", "projection", "space"]
Cut = Literal["total", "spring", "rate"]


@dataclass(frozen=True, kw_only=True)
class TurningSlider:
    """Spring k (N/m) and dashpot gamma (kg/s), numbers or (S, 1), of C contacts that answer to the same law.

    lags: the spring moves after it has answered. remembers: a contact that slides has the limit `carried` until it
    sticks; with `lags` it sticks only if the spring of the coming row would.

    A spring of 1 m, stretched in the first row, on a normal that then turns towards it, cos(angle) = 0.8:

    >>> slider = TurningSlider(stiffness=1.0, damping=0.0, dt=1.0, cut="total", keep="projection")
    >>> normal, rate = np.array([[[1.0, 0, 0]], [[0.8, 0.6, 0]]]), np.array([[[0, 1.0, 0]], [[0, 0, 0]]])
    >>> force = slider.force(np.array([True, True]), normal, rate, np.full(2, 9.0), np.full(2, 9.0))
    >>> np.linalg.norm(force, axis=-1).round(3).ravel().tolist()
    [1.0, 0.8]
    """

    stiffness: float | np.ndarray
    damping: float | np.ndarray
    dt: float
    cut: Cut
    keep: Keep
    lags: bool = False
    remembers: bool = False

    def force(
        self, touching: np.ndarray, normal: np.ndarray, rate: np.ndarray, limit: np.ndarray, carried: np.ndarray
    ) -> np.ndarray:
        """Return the force against the slip, (S, C, d) in N.

        touching: (S,) bool; normal, rate: (S, C, d), m/s; limit, carried: (S,) in N, what sets a spring sliding and
        what a sliding one exerts. NaN in a limit makes all NaN until the contact opens.
        """
        rows, found = np.broadcast_to, np.zeros(rate.shape)
        k, gamma = (rows(np.reshape(x, (-1, 1)), (len(rate), 1)) for x in (self.stiffness, self.damping))
        xi, slid = np.zeros(rate.shape[1:]), np.zeros((rate.shape[1], 1), bool)
        for row in range(len(rate)):
            if not touching[row]:
                xi, slid = np.zeros_like(xi), np.zeros_like(slid)
                continue
            n, stretch = normal[row], self.dt * rate[row]
            xi = self._kept(xi, n, stretch) + 0.0 * limit[row]
            step = _Row(k=k[row], gamma=gamma[row], rate=rate[row], limit=limit[row], carried=carried[row])
            found[row], xi, slid = self._answer(step, xi, slid, stretch)
        return found

    def _kept(self, xi: np.ndarray, n: np.ndarray, stretch: np.ndarray) -> np.ndarray:
        if self.keep == "projection":
            xi = xi + stretch
            return xi - _dot(xi, n) * n
        if self.keep == "length":
            flat = xi - _dot(xi, n) * n
            length = _size(flat)
            xi = flat * np.divide(_size(xi), length, out=np.ones_like(length), where=length > 0.0)
        return xi if self.lags else xi + stretch

    def _answer(self, step: _Row, xi: np.ndarray, slid: np.ndarray, stretch: np.ndarray):
        """Return force, spring and whether it slides."""
        if self.cut == "spring":
            return step.spring_cut(xi)
        test = step.test(xi)
        slides = _size(test) > np.where(slid & self.remembers, step.carried, step.limit)
        if self.remembers and self.lags:
            slides = np.where(slid, _size(step.test(xi + stretch)) > step.carried, slides)
        against = -step.rate if self.cut == "rate" else test
        force = np.where(slides, step.carried * _unit(against), test)
        stuck = xi + stretch if self.lags else xi
        return force, np.where(slides, -(force + step.gamma * step.rate) / step.k, stuck), slides


@dataclass(frozen=True, kw_only=True)
class _Row:
    """One row: k, gamma (1,), rate (C, d), limits in N."""

    k: np.ndarray
    gamma: np.ndarray
    rate: np.ndarray
    limit: float
    carried: float

    def test(self, xi: np.ndarray) -> np.ndarray:
        return -self.k * xi - self.gamma * self.rate

    def spring_cut(self, xi: np.ndarray):
        """The limit is tested on the spring alone; one that slides answers without its dashpot."""
        slides = self.k * _size(xi) > self.limit
        xi = np.where(slides, self.carried / self.k * _unit(xi), xi)
        return -self.k * xi - np.where(slides, 0.0, self.gamma) * self.rate, xi, slides


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (a * b).sum(axis=-1, keepdims=True)


def _size(a: np.ndarray) -> np.ndarray:
    return np.sqrt(_dot(a, a))


def _unit(a: np.ndarray) -> np.ndarray:
    """Return a/|a|, zero for a vector without length."""
    size = _size(a)
    return np.divide(a, size, out=np.zeros_like(a), where=size > 0.0)
