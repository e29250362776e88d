"""Free scenes: whole trajectories beside each other, and what each body left with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from harness.scene.judged import Agreement
from harness.scene.laws import turning
from harness.scene.model import Free
from harness.studies.compare.exits import ExitValues, exit_values
from harness.studies.compare.finest import Finest, finest_differences
from harness.studies.compare.growth import (
    Compared,
    Growth,
    Lengths,
    compared_columns,
    compared_displacements,
    difference_growth,
)
from harness.studies.compare.pairs import Pair, declared_for, pairs_of
from harness.studies.verdict import Check, Rerun, judged, not_checked
from postproc.trajectory import Trajectory

COLUMNS = {"velocity": ("vx", "vy", "vz"), "spin": ("wx", "wy", "wz")}
"""What is compared over the whole trajectory besides displacements."""

CAUSE = {"displacement": "velocity", "velocity": "velocity", "spin": "spin"}
"""What changes when a law acts: a body that flies on at constant velocity is displaced by none."""


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
    finest = finest_differences(scene, starts[0].system)
    return agreement_checks(pairs, scene.compare.agreements, done, finest, rerun, scene.periodic), result


def agreement_checks(
    pairs: list[Pair], agreements: tuple[Agreement, ...], done: Mapping[str, Trajectory],
    finest: Mapping[str, Finest], rerun: Rerun, periodic: Lengths = None,
) -> list[Check]:
    """Whole trajectories, for every pair of the kind that an agreement declares (level L1)."""
    found = []
    for agreement in agreements:
        facts = {"level": "L1", "tolerance": agreement.tolerance}
        wanted = declared_for(agreement.pairs, pairs)
        if not wanted:
            why = f"declared for {agreement.pairs}, and no two of the engines are such a pair"
            found.append(not_checked(**facts, quantity="whole trajectory", left="-", right="-", why=why))
        for p in wanted:
            pair = {**facts, "left": p.left, "right": p.right}
            missing = p.missing(done)
            if missing:
                found.append(not_checked(**pair, quantity="whole trajectory", why=missing))
                continue
            compared = _compared(done[p.left], done[p.right], periodic)
            found += [_quantity(pair, name, compared, finest, rerun(p.left, p.right)) for name in compared]
    return found


def _compared(a: Trajectory, b: Trajectory, periodic: Lengths) -> dict[str, Compared]:
    columns = {name: compared_columns(a, b, columns) for name, columns in COLUMNS.items()}
    return {"displacement": compared_displacements(a, b, periodic), **columns}


def _quantity(
    facts: dict, name: str, compared: Mapping[str, Compared], finest: Mapping[str, Finest], rerun: str
) -> Check:
    """Judge the difference over the size, and never more finely than the scene's numbers resolve.

    What differs, differs; but agreement of zeros, of rounding, or of bodies on which nothing acts is none.
    """
    facts = {**facts, "quantity": f"{name}, whole trajectory"}
    size = max(compared[name].size, finest[name].value / facts["tolerance"])
    deviation, nothing = compared[name].difference / size, _nothing(name, compared, finest)
    if deviation <= facts["tolerance"] and nothing:
        return not_checked(**facts, why=f"{nothing}: nothing to compare")
    return judged(**facts, deviation=deviation, why="largest over all frames and bodies", rerun=rerun)


def _nothing(name: str, compared: Mapping[str, Compared], finest: Mapping[str, Finest]) -> str:
    """Say why there is nothing to compare, "" if there is something."""
    size, cause = compared[name].size, CAUSE[name]
    if size == 0.0:
        return "zero in both runs at all times"
    if size <= finest[name].value:
        return f"at most {size:.2g} {finest[name].unit}, which is rounding in this scene"
    if compared[cause].change <= finest[cause].value:
        return f"no body's {cause} changes in either run, so no law has acted"
    return ""
