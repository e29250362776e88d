"""Two runs from one packing, sample by sample, until chaos parts them (level L2).

What is followed is the `Signal` of each run: the force on the top wall of a box, the torque on the inner ring.

A run that is missing gives `not_checked`. With several packings the worst one counts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Sized
from typing import Protocol

import numpy as np

from harness.scene.judged import TimeWindow, Window
from harness.studies.compare.curves import BiaxialCurves
from harness.studies.compare.pairs import Pair, declared_for
from harness.studies.compare.signal import Signal, signal_deviation
from harness.studies.verdict import Check, Rerun, judged, not_checked

PARTED = 1e-2
"""Relative difference of the signal, or of two peaks, at which two runs no longer follow each other."""


class Followed(Protocol):
    """Curves of a run, one of which is its signal."""

    @property
    def signal(self) -> Signal:
        """What is followed sample by sample."""


Followeds = Mapping[str, Mapping[int, Followed]]
"""Curves of any scene by engine and packing."""

Curves = Mapping[str, Mapping[int, BiaxialCurves]]
"""Those of a box."""


def force_deviation(a: BiaxialCurves, b: BiaxialCurves) -> np.ndarray:
    """Return |F_a - F_b| / max(|F_a|, |F_b|) of the top wall, sample by sample, (S,), see `signal_deviation`."""
    return signal_deviation(a.signal, b.signal)


def window_checks(
    pairs: Sequence[Pair], windows: Sequence[Window | TimeWindow], curves: Followeds, rerun: Rerun
) -> list[Check]:
    """The signal, pointwise, for every pair of the kind that a window declares."""
    return [c for w in windows for c in _window_checks(w, declared_for(w.pairs, pairs), curves, rerun)]


def _window_checks(
    window: Window | TimeWindow, pairs: Sequence[Pair], curves: Followeds, rerun: Rerun
) -> list[Check]:
    facts = {"level": "L2", "tolerance": window.tolerance, "quantity": window.says}
    if not pairs:
        why = f"declared for {window.pairs}, and no two of the engines are such a pair"
        return [not_checked(**facts, left="-", right="-", why=why)]
    return [_window_check(p, window.limit, curves, rerun(p.left, p.right), facts) for p in pairs]


def _window_check(pair: Pair, limit: float, curves: Followeds, rerun: str, facts: dict) -> Check:
    facts = {**facts, "left": pair.left, "right": pair.right}
    both = pair.both(curves)
    if not both:
        return not_checked(**facts, why=pair.missing(curves) or "no packing that both completed")
    signals = [(a.signal, b.signal) for a, b in both.values()]
    inside = [signal_deviation(a, b)[a.upto(limit) | b.upto(limit)] for a, b in signals]
    if not all(d.size for d in inside):
        return not_checked(**facts, why="no sample lies in this range")
    samples = np.concatenate(inside)
    return judged(**facts, deviation=float(samples.max()), samples=samples.size, rerun=rerun,
                  why=f"largest of {samples.size} samples{_of(both)}")


def parting_checks(pairs: Sequence[Pair], curves: Followeds, rerun: Rerun) -> list[Check]:
    """Where pointwise agreement ended, for every pair of which both completed."""
    return [_parting_check(p, both, rerun(p.left, p.right)) for p in pairs if (both := p.both(curves))]


def _parting_check(pair: Pair, both: Mapping[int, tuple[Followed, Followed]], rerun: str) -> Check:
    """Judge the whole test: chaos excuses runs that part on the way, but not at the first sample.

    The forces of step 0 are those of the codes' set-ups, which have conventions of their own for contacts that rub at
    the start (LAMMPS lets them slide without friction, LIGGGHTS brakes them): they count among equal conventions only.
    """
    signals = [(a.signal, b.signal) for a, b in both.values()]
    first = signals[0][0]
    facts = {"level": "L2", "quantity": f"{first.quantity}, whole test", "left": pair.left, "right": pair.right}
    after = 0 if pair.kind in ("same_conventions", "same_code") else 1
    deviations = [signal_deviation(a, b)[after:] for a, b in signals]
    worst = float(np.max([d.max(initial=0.0) for d in deviations]))
    followed = [after + _followed(d) for d in deviations]
    if all(n == after + len(d) for n, d in zip(followed, deviations, strict=True)):
        return judged(**facts, deviation=worst, tolerance=PARTED, rerun=rerun, why=f"at all times{_of(both)}")
    if min(followed) == after:
        where = "at step 0 already, where all start from the same numbers" if not after else "at the first sample"
        why = f"apart {where}"
        return judged(**facts, deviation=worst, tolerance=PARTED, rerun=rerun, why=why)
    until = first.at(min(a.place[n - 1] for n, (a, _) in zip(followed, signals, strict=True)), ".3g")
    why = f"followed each other within {PARTED:.0%} up to {until}; then only replicates can tell"
    return Check(**facts, deviation=worst, tolerance=PARTED, verdict="inconclusive", why=why)


def peak_checks(pairs: Sequence[Pair], curves: Curves, rerun: Rerun) -> list[Check]:
    """Whether two runs have one peak, for every pair of which both completed; none where no run has a peak.

    The peak is defined so that round-off should not move it (`harness.studies.compare.peak`); here that is seen.
    """
    found = ((p, list(p.both(curves).values())) for p in pairs)
    return [
        _peak_check(p, both, rerun(p.left, p.right)) for p, both in found if any(c.peak for ab in both for c in ab)
    ]


def _peak_check(pair: Pair, both: Sequence[tuple[BiaxialCurves, BiaxialCurves]], rerun: str) -> Check:
    """Judge the height, and that each peak lies on the other's top; chaos excuses runs that had parted before."""
    facts = {"level": "L2", "quantity": "peak of sigma_zz", "left": pair.left, "right": pair.right}
    apart = [_peaks_apart(a, b) for a, b in both]
    worst = int(np.argmax(apart))
    a, b = both[worst]
    where = " and ".join("nowhere" if c.peak is None else f"at {c.peak.where}" for c in (a, b)) + _of(both)
    deviation = None if np.isinf(apart[worst]) else apart[worst]
    if deviation is not None and deviation <= PARTED:
        return judged(**facts, deviation=deviation, tolerance=PARTED, why=where, rerun=rerun)
    samples = _followed(force_deviation(a, b))
    followed = a.strain[max(samples - 1, 0)]
    if samples and followed < min(c.peak.strain for c in (a, b) if c.peak):
        why = f"{where}: later than {100 * followed:.3g} %, where the runs had parted, so it depends on round-off"
        return Check(**facts, deviation=deviation, tolerance=PARTED, verdict="inconclusive", why=why)
    why = f"{where}, and no chaos had parted the runs before; rerun: {rerun}"
    return Check(**facts, deviation=deviation, tolerance=PARTED, verdict="differs", why=why)


def _peaks_apart(a: BiaxialCurves, b: BiaxialCurves) -> float:
    """Return the relative difference of the peaks' heights, inf if one has none or they are not one peak."""
    p, q = a.peak, b.peak
    if p is None or q is None or not (p.low <= q.strain <= p.high and q.low <= p.strain <= q.high):
        return float("inf")
    left, right = (float(c.smoothed(c.stress_zz)[c.peak.sample]) for c in (a, b))
    return abs(left - right) / max(abs(left), abs(right))


def _followed(deviation: np.ndarray) -> int:
    """Return the number of samples before the first that is not within `PARTED`."""
    apart = np.flatnonzero(~(deviation <= PARTED))
    return int(apart[0]) if apart.size else len(deviation)


def _of(both: Sized) -> str:
    return f" of {len(both)} packings" if len(both) > 1 else ""
