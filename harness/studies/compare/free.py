"""Free scenes: whole trajectories beside each other, and what each body left with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.scene.model import Agreement, Free
from harness.studies.compare.exits import ExitValues, exit_values
from harness.studies.compare.growth import Growth, difference_growth
from harness.studies.compare.pairs import Pair, pairs_of
from harness.studies.verdict import Check, within
from postproc.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class FreeResult:
    """What the report draws; keys are engine names."""

    pairs: tuple[Pair, ...]
    growth: dict[str, Growth]
    exits: dict[str, ExitValues]


def judge_free(scene: Free, starts, runs, engines: list[str], rerun: str) -> tuple[list[Check], FreeResult]:
    """Return all checks of a free comparison and what the report needs."""
    done = {r.engine: r.trajectory for r in runs if r.trajectory is not None}
    pairs = pairs_of(engines)
    both = [p for p in pairs if p.left in done and p.right in done]
    result = FreeResult(
        pairs=tuple(pairs),
        growth={f"{p.left} - {p.right}": difference_growth(done[p.left], done[p.right]) for p in both},
        exits={e: exit_values(t, starts[0].system) for e, t in done.items()},
    )
    wanted = [(p, a) for a in scene.compare.agreements for p in pairs if p.kind == a.pairs]
    return [c for p, a in wanted for c in _agreement(p, a, done, rerun)], result


QUANTITIES = {"displacement": "xyz", "velocity": ("vx", "vy", "vz"), "spin": ("wx", "wy", "wz")}
"""What is compared over the whole trajectory; relative to the largest size in either run.

Positions count from the start: relative to a coordinate far from the origin any path would agree.
"""


def _agreement(pair: Pair, agreement: Agreement, done: dict[str, Trajectory], rerun: str) -> list[Check]:
    facts = {"level": "L1", "left": pair.left, "right": pair.right, "tolerance": agreement.tolerance}
    missing = [e for e in (pair.left, pair.right) if e not in done]
    if missing:
        why = f"no completed run of {' and '.join(missing)}"
        return [Check(**facts, quantity="trajectory", deviation=None, verdict="not_checked", why=why)]
    return [
        _judged(facts, name, trajectory_deviation(done[pair.left], done[pair.right], columns), rerun)
        for name, columns in QUANTITIES.items()
    ]


def _judged(facts: dict, name: str, deviation: float | None, rerun: str) -> Check:
    quantity = f"{name}, whole trajectory"
    if deviation is None:
        why = "zero in both runs at all times: nothing to compare"
        return Check(**facts, quantity=quantity, deviation=None, verdict="not_checked", why=why)
    verdict = within(deviation, facts["tolerance"])
    why = "largest over all frames and bodies" + (f"; rerun: {rerun}" if verdict == "differs" else "")
    return Check(**facts, quantity=quantity, deviation=deviation, verdict=verdict, why=why)


def trajectory_deviation(a: Trajectory, b: Trajectory, columns) -> float | None:
    """Return max |a - b| / max(|a|, |b|) over frames, bodies and components; None if all is zero.

    Positions are taken relative to their first frame. Raises ValueError when the frames are not of
    the same steps.
    """
    if a.steps != b.steps:
        raise ValueError("frames at different steps")
    left, right = _stacked(a, columns), _stacked(b, columns)
    size = max(np.abs(left).max(initial=0.0), np.abs(right).max(initial=0.0))
    return None if size == 0.0 else float(np.abs(left - right).max() / size)


def _stacked(trajectory: Trajectory, columns) -> np.ndarray:
    """Return the columns that there are, (F, C, N); positions as displacements since the first frame."""
    present = [c for c in columns if c in trajectory.frames[0].particles]
    values = np.array([[f.particles[c] for c in present] for f in trajectory])
    return values - values[0] if columns == QUANTITIES["displacement"] else values
