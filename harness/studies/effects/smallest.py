"""The smallest set of effects that keeps the chosen quantities within the tolerance: found by runs, verified by runs.

    1. An effect can go when its switch alone keeps every chosen quantity within the tolerance, and saves time.
    2. All that can go are left out together and the scene is run on the same packings. Within the tolerance: done.
    3. If not, the one whose switch alone changed most comes back, and again, until the reduced scene holds.

Changes of several switches need not add up, which is why only a run of the reduced scene decides.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from harness.studies.effects.changes import Change
from harness.studies.effects.variants import Variant


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A combination that was run: effects left out together, and what that changed in the chosen quantities."""

    without: tuple[str, ...]
    changes: tuple[Change, ...]

    @property
    def holds(self) -> bool:
        """Whether every chosen quantity was shown to stay within the tolerance."""
        return bool(self.changes) and all(c.verdict == "agrees" for c in self.changes)


@dataclass(frozen=True, kw_only=True)
class Smallest:
    """kept: effects that stay on, by name, with the reason. left_out: those that may go. trials: in order of their run.

    verified: whether a run of the reduced scene shows that it holds; True of a scene that nothing is left out of.
    """

    kept: Mapping[str, str]
    left_out: tuple[str, ...]
    trials: tuple[Trial, ...]
    verified: bool


Run = Callable[[tuple[str, ...]], Sequence[Change]]
"""Runs the scene without effects and returns the changes of the chosen quantities."""


def smallest_set(
    variants: Sequence[Variant], changes: Sequence[Change], chosen: Sequence[str], saves: Mapping[str, float | None],
    run: Run,
) -> Smallest:
    """Return the smallest set. saves: part of the time that leaving an effect out saves, None if not known."""
    kept: dict[str, str] = {}
    able: dict[str, float] = {}
    for v in (v for v in variants if v.effect.on):
        mine = [c for c in changes if c.variant == v.name and c.quantity in chosen]
        why = _why_kept(v, mine, saves.get(v.effect.name))
        if why:
            kept[v.effect.name] = why
        else:
            able[v.effect.name] = max(abs(c.relative) for c in mine)
    trials: list[Trial] = []
    while able:
        trial = Trial(without=tuple(able), changes=tuple(run(tuple(able))))
        trials.append(trial)
        if trial.holds:
            return Smallest(kept=kept, left_out=tuple(able), trials=tuple(trials), verified=True)
        worst = max(able, key=able.get)
        others = [n for n in able if n != worst]
        kept[worst] = f"without it and {', '.join(others)} together the tolerance is not kept" if others else (
            "the run of the reduced scene does not keep the tolerance"
        )
        del able[worst]
    return Smallest(kept=kept, left_out=(), trials=tuple(trials), verified=True)


def _why_kept(variant: Variant, changes: Sequence[Change], saves: float | None) -> str:
    """Say why an effect stays, "" if it may go."""
    if variant.scene is None:
        return variant.reason
    if not changes:
        return "no run without it completed"
    worst = next((c for c in changes if c.verdict == "differs"), None)
    worst = worst or next((c for c in changes if c.verdict != "agrees"), None)
    if worst is not None:
        return f"{worst.quantity} without it: {_told(worst)}, {worst.why}"
    if saves is not None and saves < 0.0:
        return f"it may go, but without it a run takes {-100.0 * saves:.2g} % longer"
    return ""


def _told(change: Change) -> str:
    if change.relative is None:
        return "no value"
    error = "" if not change.error else f" +- {100.0 * change.error:.2g}"
    return f"{100.0 * change.relative:+.3g}{error} %"
