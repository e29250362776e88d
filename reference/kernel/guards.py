"""When a run is stopped: bodies that contact laws for small overlaps cannot describe any more.

A centre inside another body. Laws push apart along the line of centres; behind the other centre that line points the
other way, so that bodies which got so far leave on the far side, with all energy and momentum kept: nothing but this
check would tell. Two centres in one place have no line at all. The same limit as for the centre behind a wall.

A leap. A body that moves further than half the smallest radius in one step can pass another between two looks. No step
resolves such an impact: at t_c/50 a head-on pair of that speed would overlap by sixteen radii.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.neighbours import branch_vectors
from reference.kernel.vectors import norm

LONGEST_WAY = 0.5
"""Of the smallest radius: the longest way between two looks at the contacts, and in one step."""


class KernelUnstable(Exception):
    """The run left what the laws can describe; the message says what and where."""


def longest_way(model: Model) -> float:
    """Return how far a body may move between two looks, m."""
    return LONGEST_WAY * min(float(r.min()) for r in (model.radius, *(ring.radius for ring in model.rings)))


def refuse_leap(model: Model, before: np.ndarray, after: np.ndarray, step: int) -> None:
    """Raise KernelUnstable if a particle moved further than `longest_way` between two places (dim, n) a step apart."""
    way = norm((after - before)[:, : model.particle_count])
    k = int(np.argmax(way))
    if way[k] > longest_way(model):
        raise KernelUnstable(
            f"step {step}: particle {k + 1} moves {way[k] / model.radius[k]:.3g} of its radii in one step, and could "
            f"pass another unseen; take a step {way[k] / longest_way(model):.3g} times shorter or a lower speed"
        )


def depths(model: Model, x: np.ndarray, radius: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Return overlap less the smaller radius of pairs of bodies, (M,), m: from 0 on one holds the other's centre."""
    return radius[i] + radius[j] - norm(branch_vectors(model, x, i, j)) - np.minimum(radius[i], radius[j])


def refuse_centres_inside(
    model: Model, x: np.ndarray, radius: np.ndarray, i: np.ndarray, j: np.ndarray, step: int
) -> float:
    """Return the largest depth of pairs, -inf of none; raise KernelUnstable if a centre is inside the other body."""
    found = depths(model, x, radius, i, j)
    k = int(np.argmax(found)) if len(found) else -1
    if k < 0 or found[k] < 0.0:
        return float(found[k]) if k >= 0 else -np.inf
    other = f"particle {j[k] + 1}" if j[k] < model.particle_count else "a glued disc"
    raise KernelUnstable(
        f"step {step}: a centre of particle {i[k] + 1} and {other} lies inside the other body; their contact is too "
        "soft for the speed or the load"
    )
