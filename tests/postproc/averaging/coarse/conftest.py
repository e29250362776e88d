"""Points over all space, and derivatives by differences, as one fixture: `cg.<builder>(...)`."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from postproc.averaging.coarse.points import Points
from postproc.geometry import positions

SIXTH = {1: 3.0 / 4.0, 2: -3.0 / 20.0, 3: 1.0 / 60.0}
"""Central difference of order six: derivative = sum weight (f(k h) - f(-k h))/h."""


def derivative(f, h: float) -> np.ndarray:
    """d f/dt at 0 of a function of one number."""
    return sum(weight * (f(k * h) - f(-k * h)) for k, weight in SIXTH.items()) / h


def divergence(field, points: np.ndarray, h: float) -> np.ndarray:
    """Sum over a of d field_a.../d x_a at points (K, dim); field: places (K, dim) -> (K, dim, ...)."""
    axes = np.eye(points.shape[1])
    return sum(derivative(lambda t, a=a: field(points + t * axes[a])[:, a], h) for a in range(len(axes)))


def everywhere(state, kernel: str, width: float, spacing: float) -> tuple[Points, float]:
    """Points on a grid over all that the state reaches, and the volume of one: sum times volume is the integral."""
    x = positions(state)
    contacts = [state.contacts["p" + axis] for axis in state.axes]
    reach = Points(snapshot=state, points=x, kernel=kernel, width=width).phi.reach
    lines = [
        np.arange(min(x[:, k].min(), c.min()) - reach, max(x[:, k].max(), c.max()) + reach + spacing, spacing)
        for k, c in enumerate(contacts)
    ]
    points = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, len(lines))
    return Points(snapshot=state, points=points, kernel=kernel, width=width), spacing ** len(lines) * state.thickness


@pytest.fixture(scope="session")
def cg() -> SimpleNamespace:
    """Points over all space, and differences of high order."""
    return SimpleNamespace(derivative=derivative, divergence=divergence, everywhere=everywhere)
