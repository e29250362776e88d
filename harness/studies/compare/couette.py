"""The Couette ring: torque history, profiles and balances of every run, and what they allow to say."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass

from harness.scene.laws import turning
from harness.scene.model import Couette
from harness.studies.compare.alarms import handed_in
from harness.studies.compare.band import Band, band_of, band_tests
from harness.studies.compare.chaos import growth_checks, kicked_run, open_questions
from harness.studies.compare.growth import Growth, difference_growth
from harness.studies.compare.pairs import Pair, pairs_of
from harness.studies.compare.pointwise import parting_checks, window_checks
from harness.studies.compare.profile_checks import profile_tests
from harness.studies.compare.profile_tests import compared_profiles
from harness.studies.compare.profiles import RingProfiles, ring_profiles, steady_frames, subject_of
from harness.studies.compare.ring_balances import RingBalances, ring_balances
from harness.studies.compare.ring_checks import run_tests
from harness.studies.compare.ring_curves import RingCurves, ring_curves
from harness.studies.compare.ring_family import number_tests
from harness.studies.statistics.difference import FEWEST
from harness.studies.statistics.family import Judged, Terms, family_checks, judge_tests
from harness.studies.statistics.multiple import correct_together
from harness.studies.verdict import Check, Rerun


@dataclass(frozen=True, kw_only=True)
class CouetteResult:
    """What the report draws: curves and growth of the first packing, all else by engine and packing.

    judged: numbers and offsets of profiles between codes. tests: how many tests share the rate of false alarms, these
    among them.
    """

    pairs: tuple[Pair, ...]
    curves: Mapping[str, RingCurves]
    growth: Mapping[str, Growth]
    profiles: Mapping[str, Mapping[int, RingProfiles]]
    balances: Mapping[str, Mapping[int, RingBalances]]
    bands: Mapping[str, Mapping[int, Band]]
    judged: tuple[Judged, ...] = ()
    tests: int = 0


@dataclass(frozen=True, kw_only=True)
class Averaged:
    """What averages of steady states say: checks between codes, and of single runs; the rest as above."""

    judged: tuple[Judged, ...]
    tests: int
    of_codes: tuple[Check, ...]
    of_runs: tuple[Check, ...]


def judge_couette(
    scene: Couette, starts, runs, engines: list[str], rerun: Rerun, *, response=None
) -> tuple[list[Check], CouetteResult]:
    """Return all checks of a ring comparison and what the report needs.

    response: the run of a kicked first packing, None if there is none.
    """
    finished = [r for r in runs if r.trajectory is not None]
    pairs = pairs_of(engines, friction=bool(turning(scene.contact)))
    curves, profiles, balances, bands = (defaultdict(dict) for _ in range(4))
    for r in finished:
        system = starts[r.packing].system
        subjects = [subject_of(f, scene, system) for f in steady_frames(r.trajectory, scene)]
        curves[r.engine][r.packing] = ring_curves(r.trajectory)
        profiles[r.engine][r.packing] = ring_profiles(subjects, system)
        balances[r.engine][r.packing] = ring_balances(curves[r.engine][r.packing], subjects, system)
        bands[r.engine][r.packing] = band_of(profiles[r.engine][r.packing], scene, system)
    averaged = judge_averages(scene, engines, pairs, profiles, balances, bands, rerun)
    first_curves = {e: of[0] for e, of in curves.items() if 0 in of}
    checks = [
        *window_checks(pairs, scene.compare.windows, curves, rerun),
        *growth_checks(pairs, first_curves, kicked_run(response, ring_curves), rerun),
        *open_questions(parting_checks(pairs, curves, rerun), averaged.of_codes if len(starts) >= FEWEST else []),
        *averaged.of_codes,
        *averaged.of_runs,
    ]
    first = {r.engine: r.trajectory for r in finished if r.packing == 0}
    return checks, CouetteResult(
        pairs=tuple(pairs), curves={e: curves[e][0] for e in first}, profiles=profiles, balances=balances, bands=bands,
        judged=averaged.judged, tests=averaged.tests,
        growth={p.name: difference_growth(first[p.left], first[p.right]) for p in pairs if not p.missing(first)},
    )


def judge_averages(
    scene: Couette, engines: list[str], pairs: list[Pair], profiles, balances, bands, rerun: Rerun
) -> Averaged:
    """Judge all that rests on averages, at one rate of false alarms (`harness.studies.compare.alarms`)."""
    rate, margin, tested = scene.compare.false_alarms, scene.compare.margin, compared_profiles(pairs, profiles)
    numbers = number_tests(pairs, profiles, balances, bands, tested)
    of_codes = profile_tests(pairs, profiles, rerun, margin, tested)
    of_runs = [*band_tests(engines, bands, rerun), *run_tests(balances, rerun, margin)]
    corrected, others = correct_together(rate, [t.counted for t in numbers], handed_in([*of_codes, *of_runs]))
    several = any(len(of) > 1 for of in profiles.values())
    judged = judge_tests(numbers, Terms(false_alarms=rate, margin=margin, paired=several), corrected)
    return Averaged(
        judged=tuple(judged), tests=others.among,
        of_codes=(*family_checks(judged, rerun), *(t.check(others.level) for t in of_codes)),
        of_runs=tuple(t.check(others.level) for t in of_runs),
    )
