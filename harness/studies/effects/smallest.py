"""The smallest set of effects that keeps the chosen quantities within the tolerance: found by runs, verified by runs.

    1. An effect can go when its switch alone keeps every chosen quantity within the tolerance, and saves time: on one
       engine at least by more than its stretches scatter (all of them are faster), and on the mean of all engines,
       those that scatter about no difference counted as none.
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
    """A combination that was run: effects left out together, what that changed in the chosen quantities, and in others.
    """

    without: tuple[str, ...]
    changes: tuple[Change, ...]
    others: tuple[Change, ...] = ()

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
"""Runs the scene without effects and returns the changes of all quantities."""


def smallest_set(
    variants: Sequence[Variant], changes: Sequence[Change], chosen: Sequence[str], saves: Mapping[str, float | None],
    run: Run,
) -> Smallest:
    """Return the smallest set.

    saves: part of the time that leaving an effect out saves, 0 where that is hidden by scatter, None if not known.
    """
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
        trial = _trial(tuple(able), run(tuple(able)), chosen)
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


def _trial(names: tuple[str, ...], changes: Sequence[Change], chosen: Sequence[str]) -> Trial:
    """Tell the chosen quantities, by which it is judged, from the others."""
    wanted = tuple(c for c in changes if c.quantity in chosen)
    return Trial(without=names, changes=wanted, others=tuple(c for c in changes if c.quantity not in chosen))


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
    return _no_gain(saves)


def _no_gain(saves: float | None) -> str:
    """Say why nothing is gained without an effect that may go, "" if something is."""
    if saves is None:
        return "it may go, but what that saves was not measured"
    if saves < 0.0:
        return f"it may go, but without it a run takes {-100.0 * saves:.2g} % longer"
    return "" if saves > 0.0 else "it may go, but that saves nothing that stands out of the scatter of the times"


def _told(change: Change) -> str:
    if change.relative is None:
        return "no value"
    error = "" if not change.error else f" +- {100.0 * change.error:.2g}"
    return f"{100.0 * change.relative:+.3g}{error} %"
