"""The numbers of a ring between codes, and what their profiles differ by as a whole (level L3).

Numbers are both torques, the pressure, v_0 and s/d of the band and the volume fraction in it. Of every profile the mean
over its cells is compared, over the profile's size: a common offset, which no test of single cells sees when it is
smaller than their errors. Its own error is that of the series of this mean.

All are judged as quantities over replicates are (`harness.studies.statistics.family`): codes agree in what is shown to
differ by less than the margin, at the declared rate for all numbers; a difference is seen at that rate for all tests
of the report (`harness.studies.compare.alarms`). Over packings errors are those of the differences packing by packing.
With a single packing they are those of time averages, pooled over all runs, that know of autocorrelation; from fewer
autocorrelation times than they need nothing is concluded.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from harness.studies.compare.band import Band
from harness.studies.compare.pairs import Pair
from harness.studies.compare.profile_tests import Overall
from harness.studies.compare.profile_tests import Tested as ProfileTested
from harness.studies.compare.profiles import Profile, RingProfiles
from harness.studies.compare.ring_balances import RingBalances
from harness.studies.compare.ring_numbers import IN_BAND, numbers_in_time
from harness.studies.compare.significance import difference_of, frames_needed
from harness.studies.statistics.difference import Difference, p_value
from harness.studies.statistics.family import ROUND_OFF, SAME, Measured, Tested

LARGE = 1e6
"""Degrees of freedom of what is known exactly."""

OFFSET = "mean over cells of {}"
"""Name of a common offset, by profile."""

Numbers = Mapping[str, Mapping[int, Mapping[str, Profile]]]
"""Numbers by engine, packing and name."""


def number_tests(
    pairs: Sequence[Pair], profiles: Mapping[str, Mapping[int, RingProfiles]],
    balances: Mapping[str, Mapping[int, RingBalances]], bands: Mapping[str, Mapping[int, Band]],
    tested: Mapping[Pair, Sequence[ProfileTested]],
) -> list[Tested]:
    """Return a test a number or offset and pair. tested: what `compared_profiles` makes."""
    numbers = {
        e: {k: numbers_in_time(p, balances[e][k], bands[e][k]) for k, p in of.items()} for e, of in profiles.items()
    }
    return [
        t for pair in pairs
        for t in (*_numbers(pair, numbers, profiles, tested[pair]), *_offsets(pair, tested[pair]))
    ]


def _numbers(
    pair: Pair, numbers: Numbers, profiles: Mapping[str, Mapping[int, RingProfiles]], tested: Sequence[ProfileTested]
) -> Iterator[Tested]:
    """Yield a test for every number that both have in all packings that both completed.

    The volume fraction is measured by the size of its profile.
    """
    sizes = {IN_BAND: next((t.size for t in tested if t.quantity.name == "volume_fraction"), None)}
    both = list(pair.both(numbers).items())
    if not both:
        return
    span = min(profiles[e][k].span for k, _ in both for e in (pair.left, pair.right))
    for name in (n for n in both[0][1][0] if all(n in side for _, ab in both for side in ab)):
        sides = tuple((a[name], b[name]) for _, (a, b) in both)
        pool = tuple(of[0][name] for of in numbers.values() if 0 in of and name in of[0]) if len(both) == 1 else ()
        seconds = frames_needed(pool) * span / pool[0].frames[0] if pool else 0.0
        overall = Overall(sides=sides, difference=difference_of(sides, pool), needed=seconds)
        found = _tested(pair, name, overall, span, sizes.get(name))
        if found is not None:
            yield found


def _offsets(pair: Pair, tested: Sequence[ProfileTested]) -> Iterator[Tested]:
    """Yield a test for every profile that has a cell."""
    for t in tested:
        if t.difference.used.any() and t.size > 0:
            found = _tested(pair, OFFSET.format(t.quantity.name), t.over_cells(), t.span, t.size)
            if found is not None:
                yield found


def _tested(pair: Pair, name: str, overall: Overall, span: float, size: float | None = None) -> Tested | None:
    """Return the test of one number; None where it has no difference or no scale. size: None for the mean of both."""
    means = [_mean(side) for side in zip(*overall.sides, strict=True)]
    scale = size or 0.5 * abs(means[0][0] + means[1][0])
    d, count = overall.difference.resolved(scale), len(overall.sides)
    if not (d.used[0] and scale > 0):
        return None
    difference = Difference(
        value=float(d.value[0]), error=float(d.error[0]), dof=float(min(d.freedom[0], LARGE)), count=count,
        paired=count > 1,
    )
    needed = f"{overall.needed:.3g} s to average over would do, there are {span:.3g} s"
    doubt = f"too few autocorrelation times, {needed}" if d.short[0] else ""
    return Tested(
        measured=Measured(quantity=name, unit=overall.sides[0][0].unit, values={}), pair=pair, difference=difference,
        left=means[0], right=means[1], scale=scale, doubt=doubt,
        p=p_value(difference, ROUND_OFF * scale if pair.kind in SAME else 0.0),
    )


def _mean(numbers: Sequence[Profile]) -> tuple[float, float]:
    """Mean and standard error of one side: over packings, of a single one that of its time average."""
    values = np.array([float(p.mean[0]) for p in numbers])
    if len(values) == 1:
        return float(values[0]), float(numbers[0].error[0])
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))
