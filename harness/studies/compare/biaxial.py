"""The biaxial box: curves, averages and growth of every run, and what they allow to say."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

from harness.scene.laws import turning
from harness.scene.model import Biaxial
from harness.studies.compare.biaxial_quantities import OneRun, biaxial_quantities
from harness.studies.compare.chaos import growth_checks, kicked_run, open_questions
from harness.studies.compare.curves import BiaxialCurves, biaxial_curves
from harness.studies.compare.growth import Growth, difference_growth
from harness.studies.compare.macro import macro_values
from harness.studies.compare.pairs import Pair, pairs_of
from harness.studies.compare.phases import Phase, phases_of
from harness.studies.compare.pointwise import parting_checks, peak_checks, window_checks
from harness.studies.compare.published import published_checks
from harness.studies.compare.run_checks import balance_checks, control_checks, drive_checks, place_checks
from harness.studies.compare.states import StateCurves, state_curves
from harness.studies.statistics.difference import FEWEST
from harness.studies.statistics.family import Judged, Measured, Terms, family_checks, judge_family
from harness.studies.verdict import Check, Rerun


@dataclass(frozen=True, kw_only=True)
class BiaxialResult:
    """What the report draws. Keys are engine names; curves, growth, states and phases are of the first packing.

    replicates: frame averages of all completed runs of an engine, packing by packing. macro: (engine, packing) ->
    quantity -> value. judged: all quantities of all pairs over replicates.
    """

    pairs: tuple[Pair, ...]
    curves: dict[str, BiaxialCurves]
    growth: dict[str, Growth]
    states: dict[str, StateCurves]
    replicates: dict[str, tuple[StateCurves, ...]]
    phases: dict[str, tuple[Phase, ...]]
    macro: dict[tuple[str, int], dict[str, float]]
    judged: tuple[Judged, ...] = ()


def judge_biaxial(
    scene: Biaxial, starts, runs, engines: list[str], rerun: Rerun, *, response=None
) -> tuple[list[Check], BiaxialResult]:
    """Return all checks of a biaxial comparison and what the report needs.

    response: the run of a kicked first packing, None if there is none.
    """
    finished = [r for r in runs if r.trajectory is not None]
    pairs = pairs_of(engines, friction=bool(turning(scene.contact)))
    curves = defaultdict(dict)
    for r in finished:
        curves[r.engine][r.packing] = biaxial_curves(r.trajectory, starts[r.packing].system)
    judged = judge_family(_quantities(scene, starts, finished, curves), pairs, _terms(scene, starts))
    result = _result(scene, starts, finished, pairs, curves, tuple(judged), response)
    kicked = kicked_run(response, lambda t: biaxial_curves(t, starts[0].system))
    replicated = family_checks(judged, rerun)
    with_systems = _with_systems(finished, starts)
    checks = [
        *window_checks(pairs, scene.compare.windows, curves, rerun),
        *growth_checks(pairs, result.curves, kicked, rerun),
        *open_questions([*parting_checks(pairs, curves, rerun), *peak_checks(pairs, curves, rerun)], replicated),
        *replicated,
        *published_checks(scene, engines, result.macro, rerun),
        *control_checks(curves, rerun),
        *place_checks(with_systems, rerun),
        *balance_checks(result.states, rerun),
        *drive_checks(with_systems, result.states, rerun),
    ]
    return checks, result


def _terms(scene: Biaxial, starts) -> Terms:
    """Replicates are paired where they start from packings of their own, not all from one that is kicked."""
    packings = {s.system.particles_digest() for s in starts}
    compare = scene.compare
    return Terms(false_alarms=compare.false_alarms, margin=compare.margin, paired=len(packings) == len(starts))


def _quantities(scene: Biaxial, starts, finished, curves) -> list[Measured]:
    """Return what is judged over replicates; nothing of a single one, as averages of frames take their time."""
    if len(starts) < FEWEST:
        return []
    runs = (
        OneRun(
            engine=r.engine, replicate=r.packing, curves=curves[r.engine][r.packing], trajectory=r.trajectory,
            system=starts[r.packing].system,
        )
        for r in finished
    )
    return biaxial_quantities(scene, list(runs))


def _result(scene: Biaxial, starts, finished, pairs: list[Pair], curves, judged, response) -> BiaxialResult:
    first = {r.engine: r.trajectory for r in finished if r.packing == 0}
    found = defaultdict(dict)
    for r in finished:
        found[r.engine][r.packing] = state_curves(r.trajectory, starts[r.packing].system)
    states = {e: found[e][0] for e in first}
    growth = {p.name: difference_growth(first[p.left], first[p.right]) for p in pairs if not p.missing(first)}
    if response is not None and response.trajectory is not None and response.of in first:
        growth[response.engine] = difference_growth(first[response.of], response.trajectory)
    return BiaxialResult(
        pairs=tuple(pairs), curves={e: curves[e][0] for e in first}, growth=growth, states=states,
        replicates={e: tuple(of[k] for k in sorted(of)) for e, of in found.items()},
        phases={e: phases_of(curves[e][0], states[e], scene.compare.plateau) for e in first},
        macro={(e, k): macro_values(c, scene) for e, of in curves.items() for k, c in of.items()}, judged=judged,
    )


def _with_systems(finished, starts) -> dict[str, list]:
    """Return trajectory and system of every run, by engine."""
    found = defaultdict(list)
    for r in finished:
        found[r.engine].append((r.trajectory, starts[r.packing].system))
    return found
