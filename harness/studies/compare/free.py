"""Free scenes: whole trajectories beside each other, and what each body left with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from harness.scene.laws import turning
from harness.scene.model import Agreement, Free
from harness.studies.compare.exits import ExitValues, exit_values
from harness.studies.compare.growth import (
    Growth,
    Lengths,
    column_deviation,
    difference_growth,
    displacement_deviation,
)
from harness.studies.compare.pairs import Pair, pairs_of
from harness.studies.verdict import Check, Rerun, judged, not_checked
from postproc.trajectory import Trajectory

COLUMNS = {"velocity": ("vx", "vy", "vz"), "spin": ("wx", "wy", "wz")}
"""What is compared over the whole trajectory besides displacements."""


@dataclass(frozen=True, kw_only=True)
class FreeResult:
    """What the report draws; keys are engine names."""

    pairs: tuple[Pair, ...]
    growth: dict[str, Growth]
    exits: dict[str, ExitValues]


def judge_free(scene: Free, starts, runs, engines: list[str], rerun: Rerun) -> tuple[list[Check], FreeResult]:
    """Return all checks of a free comparison and what the report needs."""
    done = {r.engine: r.trajectory for r in runs if r.trajectory is not None}
    pairs = pairs_of(engines, friction=bool(turning(scene.contact)))
    result = FreeResult(
        pairs=tuple(pairs),
        growth={
            p.name: difference_growth(done[p.left], done[p.right], scene.periodic)
            for p in pairs if not p.missing(done)
        },
        exits={e: exit_values(t, starts[0].system) for e, t in done.items()},
    )
    return agreement_checks(pairs, scene.compare.agreements, done, rerun, scene.periodic), result


def agreement_checks(
    pairs: list[Pair], agreements: tuple[Agreement, ...], done: Mapping[str, Trajectory], rerun: Rerun,
    periodic: Lengths = None,
) -> list[Check]:
    """Whole trajectories, for every pair of the kind that an agreement declares (level L1)."""
    found = []
    for agreement in agreements:
        facts = {"level": "L1", "tolerance": agreement.tolerance}
        wanted = [p for p in pairs if p.kind == agreement.pairs]
        if not wanted:
            why = f"declared for {agreement.pairs}, and no two of the engines are such a pair"
            found.append(not_checked(**facts, quantity="whole trajectory", left="-", right="-", why=why))
        for p in wanted:
            found += _agreement(p, {**facts, "left": p.left, "right": p.right}, done, rerun, periodic)
    return found


def _agreement(pair: Pair, facts: dict, done: Mapping[str, Trajectory], rerun: Rerun, periodic: Lengths) -> list[Check]:
    missing = pair.missing(done)
    if missing:
        return [not_checked(**facts, quantity="whole trajectory", why=missing)]
    a, b = done[pair.left], done[pair.right]
    deviations = {"displacement": displacement_deviation(a, b, periodic)}
    deviations |= {name: column_deviation(a, b, columns) for name, columns in COLUMNS.items()}
    return [_quantity(facts, name, d, rerun(pair.left, pair.right)) for name, d in deviations.items()]


def _quantity(facts: dict, name: str, deviation: float | None, rerun: str) -> Check:
    facts = {**facts, "quantity": f"{name}, whole trajectory"}
    if deviation is None:
        return not_checked(**facts, why="zero in both runs at all times: nothing to compare")
    return judged(**facts, deviation=deviation, why="largest over all frames and bodies", rerun=rerun)
