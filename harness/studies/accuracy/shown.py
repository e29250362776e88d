"""Many short runs as few lines: a job a group, its share done by cost."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from harness.runs.progress import Progress


class Grouped:
    """Tells `shown` of groups what it is told of jobs; see `harness.runs.progress.Progress`."""

    def __init__(self, groups: Sequence[str], shown: Progress):
        self._names = list(dict.fromkeys(groups))
        self._group = [self._names.index(name) for name in groups]
        self._shown = shown
        self._costs: list[float] = []
        self._ended: list[float] = [0.0] * len(self._names)
        self._left = Counter(self._group)
        self._counts = dict(self._left)

    def begin(self, labels: list[str], costs: list[float]) -> None:  # noqa: ARG002 (groups have their own)
        """See Progress."""
        self._costs = [max(cost, 1.0) for cost in costs]
        self._shown.begin(self._names, [self._whole(g) for g in range(len(self._names))])

    def running(self, job: int, fraction: float) -> None:
        """See Progress."""
        group = self._group[job]
        self._shown.running(group, (self._ended[group] + fraction * self._costs[job]) / self._whole(group))

    def done(self, job: int, line: str) -> None:  # noqa: ARG002 (one line a group)
        """See Progress."""
        group = self._group[job]
        self._ended[group] += self._costs[job]
        self._left[group] -= 1
        if not self._left[group]:
            self._shown.done(group, f"{self._names[group]}: {self._counts[group]} runs ended")

    def end(self) -> None:
        """See Progress."""
        self._shown.end()

    def _whole(self, group: int) -> float:
        return sum(cost for cost, g in zip(self._costs, self._group, strict=True) if g == group)
