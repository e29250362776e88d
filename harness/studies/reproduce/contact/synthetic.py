"""Curves made of a known law and noise, and whether the fit's error bars hold what they promise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.studies.reproduce.contact.curves import Cycle
from harness.studies.reproduce.contact.fit import fit_cycle, law_force

CONFIDENCE = 0.95
QUANTILE = 1.959963984540054
"""Of the normal distribution, two-sided."""


@dataclass(frozen=True, kw_only=True)
class Truth:
    """The law behind synthetic curves (N/m, m), and how they are measured: points each way, noise of the force (N).

    Chosen, of the order that the axes of the talk's curve of polystyrene leave room for (forces to 250 nN, 20 nm).
    """

    k_1: float = 20.0
    k_2: float = 60.0
    k_c: float = 30.0
    x_0: float = 3e-9
    largest: float = 12e-9
    points: int = 150
    noise: float = 2.5e-9

    @property
    def stiffnesses(self) -> np.ndarray:
        """k_1, k_2, k_c, N/m."""
        return np.array([self.k_1, self.k_2, self.k_c])

    def cycle(self, seed: int) -> Cycle:
        """Return one measured cycle with noise."""
        rng = np.random.default_rng(seed)
        way = np.linspace(self.x_0 - 0.4 * self.largest, self.x_0 + self.largest, self.points)
        x = np.concatenate([way, way[-2::-1]])
        loading = np.arange(len(x)) < self.points
        force = law_force(x, loading, float(way[-1]), self.k_1, self.k_2, self.k_c, self.x_0)
        return Cycle(displacement=x, force=force + self.noise * rng.normal(size=len(x)), error=None)


@dataclass(frozen=True, kw_only=True)
class Coverage:
    """How often an interval of 95 % held the truth: share of `curves` x 3 stiffnesses; room: four of its own sigmas.

    Fits of one curve are correlated, so that the room counts curves, not stiffnesses.
    """

    source: str
    share: float
    curves: int

    @property
    def room(self) -> float:
        """4 sqrt(0.95 0.05/curves)."""
        return float(4 * np.sqrt(CONFIDENCE * (1 - CONFIDENCE) / self.curves))


def coverages(truth: Truth, *, curves: int, bootstraps: int, draws: int) -> tuple[Coverage, Coverage]:
    """Return the coverage of the covariance's intervals and of the bootstrap's, over new curves each."""
    plain = [fit_cycle(truth.cycle(1000 + k), draws=0) for k in range(curves)]
    inside = [np.abs(f.values[:3] - truth.stiffnesses) <= QUANTILE * f.errors[:3] for f in plain]
    drawn = [fit_cycle(truth.cycle(5000 + k), draws=draws, seed=k) for k in range(bootstraps)]
    edge = 100 * (1 - CONFIDENCE) / 2
    bounds = [np.percentile(f.bootstrap[:, :3], (edge, 100 - edge), axis=0) for f in drawn]
    between = [(low <= truth.stiffnesses) & (truth.stiffnesses <= high) for low, high in bounds]
    return (
        Coverage(source="covariance", share=float(np.mean(inside)), curves=curves),
        Coverage(source="bootstrap", share=float(np.mean(between)), curves=bootstraps),
    )
