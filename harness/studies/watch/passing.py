"""Bodies that went through each other between two frames, told from where they are and how fast.

A pair with relative position d and velocity w would pass its closest approach b at the time -d.w/w^2 if nothing acted.
It has gone through when

    b < s/2,                               s the sum of the radii: they would have met, within 30 degrees of head-on
    d.w < 0 < (d + w T).w                  the closest approach lies between the frames, T apart
    |d' - d - w T| < s/4                   in the next frame, d', it is where it would be if they had not met at all

A pair that meets cannot be there: what slides around the other body goes along an arc of more than 2.09 s where the
straight way is 1.73 s, and without other bodies it does not get faster, so that it lags by more than s/3; what bounces
is on the other side. Bodies that pass slowly, over several frames, are seen inside each other (`remarks`).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from harness.scene.system import System
from harness.studies.watch.state import State

AIMED, MISSED = 0.5, 0.25
"""Of s: closest approach below which a pair must have met; distance from its free place up to which it has not."""


def passed(system: System, states: list[State]) -> np.ndarray:
    """Return how many pairs have gone through each other since the frame before, (F,); 0 in the first."""
    counts = [_between(system, a, b) for a, b in pairwise(states)]
    return np.array([0, *counts][: len(states)], dtype=float)


def _between(system: System, before: State, after: State) -> int:
    if len(before.x) != len(after.x) or not all(np.isfinite(a).all() for a in (before.x, before.v, after.x)):
        return 0
    duration = after.time - before.time
    i, j = _candidates(system, before, duration)
    d, w = _nearest(before.x[j] - before.x[i], system), before.v[j] - before.v[i]
    step = _nearest(after.x - before.x, system)
    off = step[j] - step[i] - w * duration
    s = before.radius[i] + before.radius[j]
    speed = (w**2).sum(axis=1)
    along = (d * w).sum(axis=1)
    closest = np.linalg.norm(d - (along / np.where(speed > 0, speed, 1.0))[:, None] * w, axis=1)
    through = (along < 0) & (along + speed * duration > 0) & (closest < AIMED * s)
    return int((through & (np.linalg.norm(off, axis=1) < MISSED * s)).sum())


def _candidates(system: System, state: State, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Return rows of pairs that could pass each other: near enough for their speeds, seen from the mean motion.

    At least one of a pair moves by a quarter of its radius more than nothing: until the centres pass, the two have to
    come nearer by s/2 at least.
    """
    from scipy.spatial import cKDTree

    own = np.linalg.norm(state.v - state.v.mean(axis=0), axis=1) * duration
    fast = np.flatnonzero(own > state.radius.min() / 4)
    if not len(fast):
        return np.empty(0, int), np.empty(0, int)
    box = system.periodic
    x = state.x if box is None else _wrapped(state.x, np.array(box))
    # the faster one of a pair looks for the other: both together go no further than twice its way
    reach = 2.0 * own[fast] + AIMED * (state.radius[fast] + state.radius.max())
    near = cKDTree(x, boxsize=box).query_ball_point(x[fast], reach)
    i = np.repeat(fast, [len(n) for n in near])
    j = np.concatenate([np.asarray(n, int) for n in near])
    mine = (own[j] < own[i]) | ((own[j] == own[i]) & (j > i))
    return i[mine], j[mine]


def _wrapped(x: np.ndarray, box: np.ndarray) -> np.ndarray:
    inside = np.where(box > 0, x - box * np.floor(x / np.where(box > 0, box, 1.0)), x)
    return np.where((box > 0) & (inside >= box), 0.0, inside)


def _nearest(apart: np.ndarray, system: System) -> np.ndarray:
    """Return the nearest image along periodic axes."""
    if system.periodic is None:
        return apart
    box = np.array(system.periodic)
    return apart - np.where(box > 0, box * np.round(apart / np.where(box > 0, box, 1.0)), 0.0)
