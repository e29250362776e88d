"""What a ladder says, in plain words made from its numbers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from harness.report.accuracy_tables import VAGUE, is_own, percent
from harness.studies.accuracy.result import TARGETS, best

if TYPE_CHECKING:
    from harness.studies.accuracy.fit import Fit
    from harness.studies.accuracy.result import Point, Track
    from harness.studies.accuracy.study import Accuracy

FINEST = TARGETS[-1]


def paragraph(accuracy: Accuracy) -> str:
    """Return the findings, a sentence each, leaving out what was not found."""
    sentences = [
        *(_slopes(accuracy, case) for case in accuracy.cases), _scenes_own(accuracy), _steps_needed(accuracy),
        *(_cheapest(accuracy, target) for target in TARGETS), _floor(accuracy), _beyond(accuracy),
        _failed(accuracy),
    ]
    return " ".join(s for s in sentences if s)


def _slopes(accuracy: Accuracy, case: str) -> str:
    quantity = accuracy.asked.quantity
    tracks = {t.engine: t for t in accuracy.tracks if t.case == case and t.known(quantity)}
    fits = {e: fit for e, t in tracks.items() if (fit := t.fits.get(quantity)) and fit.error <= VAGUE}
    where = "The scene as declared" if case == accuracy.cases[0] else f"The scene {case}"
    if not fits:
        return f"{where}: no order can be told, for the reasons in the table Orders."
    told = ", ".join(f"{fit} ({', '.join(engines)})" for fit, engines in _alike(fits).items())
    others = ", ".join(e for e in tracks if e not in fits)
    untold = f"; of {others} it cannot be told, for the reasons in the table Orders" if others else ""
    return f"{where}: halving the step divides the error by 2^p, p = {told}{untold}."


def _alike(fits: dict[str, Fit]) -> dict[str, list[str]]:
    """Return engines by what their slopes look like."""
    found: dict[str, list[str]] = {}
    for engine, fit in fits.items():
        found.setdefault(f"{fit.slope:.2f} ± {fit.error:.2f}", []).append(engine)
    return found


def _scenes_own(accuracy: Accuracy) -> str:
    own, quantity = accuracy.scene.numerics.dt_fraction, accuracy.asked.quantity
    found = {t.engine: p.size(quantity) for t in accuracy.declared for p in t.known(quantity) if is_own(accuracy, p)}
    told = ", ".join(f"{engine} {percent(size)}" for engine, size in found.items())
    return f"At the scene's own step, dt_fraction = {own:g}, errors are: {told}." if told else ""


def _steps_needed(accuracy: Accuracy) -> str:
    """Compare the engine that needs fewest steps for the finest target with the others."""
    quantity = accuracy.asked.quantity
    steps = {t: n for t in accuracy.declared if (n := t.steps_for(quantity, FINEST)) is not None}
    if len(steps) < 2:
        return ""
    least = min(steps, key=steps.__getitem__)
    others = ", ".join(f"{n / steps[least]:.3g} times as many by {t.engine} ({n:.3g})"
                       for t, n in steps.items() if t is not least)
    price = _price(steps, least)
    return (
        f"Between rungs, where the ladders reach an error of {percent(FINEST)}, it takes {steps[least]:.3g} steps by "
        f"{least.engine}, {others}{price}."
    )


def _price(steps: dict[Track, float], least: Track) -> str:
    timed = {t: 1e3 * t.cost.step * n for t, n in steps.items() if t.cost.step is not None}
    if least not in timed or len(timed) < 2:
        return ""
    return f"; in CPU time that is {', '.join(f'{ms:.2g} ms by {t.engine}' for t, ms in timed.items())}"


def _cheapest(accuracy: Accuracy, target: float) -> str:
    choice = best(accuracy.declared, accuracy.asked.quantity, target)
    if choice.point is None:
        return f"No timed setting of this ladder stays below {percent(target)}."
    return (
        f"Cheapest rung below {percent(target)}: {choice.track.engine} at dt_fraction = {choice.point.value:.4g}, "
        f"{1e3 * choice.point.seconds:.2g} ms."
    )


def _floor(accuracy: Accuracy) -> str:
    """Say how far the limits of the codes' own laws are from that of the talk's: no step mends that."""
    quantity = accuracy.asked.quantity
    apart = {t.engine: off for t in accuracy.declared if (off := t.parted.get(quantity, 0.0)) > 0.0}
    if not apart:
        return ""
    told = ", ".join(f"{percent(off)} ({engine})" for engine, off in apart.items())
    return (
        f"Errors are against each code's own laws. Without any error of the step these give answers that are {told} "
        "from those of the talk's laws: a smaller step does not bring them nearer."
    )


def _beyond(accuracy: Accuracy) -> str:
    """Name the rungs that were measured and that no scene can have."""
    found = [(t.engine, [p for p in t.points if p.beyond is not None and p.good]) for t in accuracy.declared]
    limits = [p.beyond for _, points in found for p in points]
    if not limits:
        return ""
    told = "; ".join(f"{engines} at {values}" for values, engines in _grouped(
        (_values(points), engine) for engine, points in found if points
    ).items())
    return (
        f"Beyond the scene's limit of {limits[0]:.3g}, so measured and shown, but in no budget and on no front: {told} "
        "(dt_fraction)."
    )


def _failed(accuracy: Accuracy) -> str:
    """Name the rungs without an answer, and why there is none."""
    quantity = accuracy.asked.quantity
    told = [
        f"{t.engine} at {_values([p])} ({p.reason or p.status})"
        for t in accuracy.declared if t.known(quantity) for p in t.points if not p.good
    ]
    return f"No answer: {'; '.join(told)}." if told else ""


def _grouped(pairs: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Return the second words by what stands first, those that share it together."""
    found: dict[str, list[str]] = {}
    for first, second in pairs:
        found.setdefault(first, []).append(second)
    return {first: ", ".join(of) for first, of in found.items()}


def _values(points: Iterable[Point]) -> str:
    return ", ".join(f"{p.value:.4g}" for p in points)
