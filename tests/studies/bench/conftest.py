"""A code that answers from memory: no process, no clock."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest

from harness.engines.protocol import Probe
from harness.engines.session import Lost
from harness.studies.bench.measure import Entrant


@dataclass
class FakeTimed:
    """A code whose steps cost `seconds[k]` in its k-th request to run (the last value from then on)."""

    name: str
    seconds: list[float] = field(default_factory=lambda: [1e-3])
    slow: bool = False
    note: str = "fake"
    available: bool = True
    refuses: Callable[[object], str] = lambda system: ""
    off: float = 0.0
    lost_at: int | None = None
    facts: dict[str, int] = field(default_factory=dict)
    told: dict[str, int] = field(default_factory=dict)

    def probe(self) -> Probe:
        return Probe(available=self.available, version="1", detail="not here")

    def refusal(self, system) -> str:
        return self.refuses(system)

    def render(self, system, *, skin) -> dict[str, str]:
        self.told = {"count": len(system.particles), "skin": skin, "x": system.particles.x}
        return {"deck": self.name}


class FakeSession:
    """What the opener gives; `log` gathers (name, steps) of all sessions in order, `closed` the names."""

    def __init__(self, timed: FakeTimed, folder, log: list, closed: list):
        assert (folder / "deck").read_text() == timed.name
        self.timed, self.log, self.closed, self.requests = timed, log, closed, 0
        self.x = timed.told["x"]

    def run(self, steps: int) -> float:
        if self.requests == self.timed.lost_at:
            raise Lost("gone")
        cost = self.timed.seconds[min(self.requests, len(self.timed.seconds) - 1)]
        self.requests += 1
        self.log.append((self.timed.name, steps))
        return steps * cost

    def places(self) -> np.ndarray:
        """All have moved by 1, this code by `off` more."""
        return self.x + np.array([1.0 + self.timed.off] + [0.0] * (self.x.shape[1] - 1))

    def facts(self) -> dict[str, int]:
        return self.timed.facts

    def close(self) -> None:
        self.closed.append(self.timed.name)


class Track:
    """An opener that remembers."""

    def __init__(self):
        self.log: list[tuple[str, int]] = []
        self.closed: list[str] = []

    def __call__(self, timed, folder):
        return FakeSession(timed, folder, self.log, self.closed)


@pytest.fixture
def fake():
    return FakeTimed


@pytest.fixture
def opener():
    return Track()


@pytest.fixture
def entrants(tiny):
    """Entrants of the same tiny system from codes."""

    def make(*codes, **options):
        return [Entrant(label=c.name, timed=c, system=tiny, skin=1e-4, **options) for c in codes]

    return make


@pytest.fixture(scope="session")
def tiny(tmp_path_factory):
    """Twelve discs with friction in a box."""
    from harness.studies.bench.cases import find_case
    from harness.studies.bench.problem import problem

    return problem(find_case("2D friction"), 12, cache=tmp_path_factory.mktemp("packings"))[0]
