"""Chaos or a difference? How two runs of the same numbers part, beside how the kernel parts from itself (level L2).

A chaotic system makes a large difference of every small one, but it cannot make one of nothing: what two codes that
compute the same thing differ by is round-off, amplified. How much amplification there is, the system itself tells: one
run is repeated with one disc moved by 1e-15 (`harness.studies.statistics.kick`), and its signal parts from that of the
unmoved run as any small difference does. The ratio of the codes' difference to this response, times 1e-15, is the kick
that their difference is worth. Round-off, which happens in every step at every contact, is worth more than one kick:
2e-14 to 9e-11 in 16 pairs of runs of 200 discs, 8e-14 and 2e-13 in two of 1950, where code and kick reach 1 % at 1.36
and 1.37 % strain; at most 4e-13 without friction, 2e-14 in a ring. A difference of the laws is worth much more, and at
once: friction changed by 2 % 8e-8 to 5e-6, the codes' own conventions of friction 2e-8 to 3e-7. So

- a pair that computes the same thing must never be worth more than `WORTH`, as long as both differences are small
  (below `PARTED`): a difference that starts larger than rounding is a disagreement, not chaos;
- a pair of different conventions must not differ more than `ALIKE` times as much as the kernel does in these two
  conventions, where that was run: then the conventions explain the difference.

Where the response itself reaches `PARTED` pointwise comparison has lost its meaning, and statistics take over.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from harness.engines.registry import KERNEL_PREFIX, kernel_of
from harness.studies.compare.pairs import Pair
from harness.studies.compare.pointwise import PARTED
from harness.studies.compare.signal import Signal, signal_deviation
from harness.studies.statistics.divergence import excess, largest_so_far, reached, reaching_error, rise_of
from harness.studies.statistics.family import SAME
from harness.studies.statistics.kick import KICK
from harness.studies.verdict import Check, Rerun, judged, not_checked
from postproc.trajectory import Trajectory

WORTH = 1e-9
"""Kick that a difference by round-off may be worth: ten times the most that was measured."""

ALIKE = 10.0
"""Times the difference that the kernel shows in the same conventions: 1.0 to 1.2 was measured."""


class Followed(Protocol):
    """Curves of a run: its signal, and the times of its samples, (S,), s."""

    time: np.ndarray

    @property
    def signal(self) -> Signal:
        """What is followed sample by sample."""


@dataclass(frozen=True, kw_only=True)
class Kicked:
    """A run repeated after a kick. engine: whose. curves: None if it did not complete, `why` then says so."""

    engine: str
    curves: Followed | None
    why: str


def kicked_run(response, curves: Callable[[Trajectory], Followed]) -> Kicked | None:
    """Return what came of the response, a run of a comparison; None without one. curves: makes them of a trajectory."""
    if response is None:
        return None
    done = response.trajectory is not None
    return Kicked(
        engine=response.of, curves=curves(response.trajectory) if done else None,
        why="" if done else f"{response.engine}: {response.outcome.status}",
    )


@dataclass(frozen=True, kw_only=True)
class Parting:
    """How two runs part: largest relative difference of the signal so far, (S,), at times (S,), s, and places."""

    time: np.ndarray
    so_far: np.ndarray
    signal: Signal

    @property
    def says(self) -> str:
        """Rate of growth, and where and when the difference reaches `PARTED`."""
        rise, sample = rise_of(self.time, self.so_far), reached(self.so_far, PARTED)
        rate = "no exponential growth" if rise is None else (
            f"e-fold in {1e3 / rise.rate:.2g} +- {1e3 * rise.error / rise.rate**2:.1g} ms"
        )
        if sample is None:
            return f"{rate}, never {PARTED:.0%} apart"
        place, time = self.signal.at(self.signal.place[sample], ".3g"), float(self.time[sample])
        error = "" if rise is None else f" +- {1e3 * reaching_error(rise, time):.1g}"
        return f"{rate}, {PARTED:.0%} apart at {place}, {1e3 * time:.3g}{error} ms"


def parting(a: Followed, b: Followed) -> Parting:
    """Return how two runs part. Raises ValueError for samples of different steps."""
    so_far = largest_so_far(signal_deviation(a.signal, b.signal))
    return Parting(time=a.time, so_far=so_far, signal=a.signal)


@dataclass(frozen=True, kw_only=True)
class _Measure:
    """What a pair's growth is measured by: a response, its name, and what one of its size is worth at most."""

    name: str
    response: Parting
    unit: float
    limit: float
    words: str


def growth_checks(
    pairs: Sequence[Pair], first: Mapping[str, Followed], kicked: Kicked | None, rerun: Rerun
) -> list[Check]:
    """Judge every pair that has something to be measured by. first: runs of one packing, identical to the last bit."""
    return [
        _growth_check(p, first, kicked, rerun(p.left, p.right))
        for p in pairs if not p.missing(first) and (kicked or p.kind not in SAME) and _measurable(p, first)
    ]


def open_questions(checks: Sequence[Check], replicated: Sequence[Check]) -> list[Check]:
    """Leave out what chaos made inconclusive for a pair that was judged over replicates: statistics have taken over."""
    answered = {(c.left, c.right) for c in replicated if c.verdict != "not_checked"}
    return [c for c in checks if c.verdict != "inconclusive" or (c.left, c.right) not in answered]


def _measurable(pair: Pair, first: Mapping[str, Followed]) -> bool:
    return pair.kind in SAME or bool(_conventions(pair, first))


def _conventions(pair: Pair, first: Mapping[str, Followed]) -> tuple[str, ...]:
    """Return the kernels in the conventions of both, none unless both were run and are different."""
    kernels = tuple(dict.fromkeys(kernel_of(e) for e in (pair.left, pair.right) if not e.startswith(KERNEL_PREFIX)))
    return kernels if len(kernels) == 2 and all(k in first for k in kernels) else ()


def _growth_check(pair: Pair, first: Mapping[str, Followed], kicked: Kicked | None, rerun: str) -> Check:
    found = parting(first[pair.left], first[pair.right])
    facts = {
        "level": "L2", "quantity": f"{found.signal.quantity}, growth of the difference", "left": pair.left,
        "right": pair.right,
    }
    if pair.kind in SAME and (kicked.curves is None or kicked.engine not in first):
        why = kicked.why or f"no completed run of {kicked.engine} to compare a kick with"
        return not_checked(**facts, tolerance=WORTH, why=f"no response to a kick: {why}")
    measure = _by_kick(first, kicked) if pair.kind in SAME else _by_conventions(first, _conventions(pair, first))
    most = excess(found.so_far, measure.response.so_far, PARTED)
    place = found.signal.at(found.signal.place[most.sample], ".3g")
    why = f"{measure.words} (at {place}); {found.says}; {measure.name}: {measure.response.says}"
    if not found.so_far.any():
        why = "equal to the last bit at all times"
    return judged(**facts, deviation=measure.unit * most.ratio, tolerance=measure.limit, why=why, rerun=rerun)


def _by_kick(first: Mapping[str, Followed], kicked: Kicked) -> _Measure:
    return _Measure(
        name=f"{kicked.engine} kicked", response=parting(first[kicked.engine], kicked.curves), unit=KICK, limit=WORTH,
        words="the kick that the difference is worth, of the largest coordinate",
    )


def _by_conventions(first: Mapping[str, Followed], kernels: tuple[str, ...]) -> _Measure:
    left, right = kernels
    return _Measure(
        name=f"{left} - {right}", response=parting(first[left], first[right]), unit=1.0, limit=ALIKE,
        words="difference over that of the kernel in these two conventions",
    )
