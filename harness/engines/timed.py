"""What `grainproof bench` asks of a code: a deck without output, and a child that makes steps when told to.

The child (`harness.engines.rounds`) builds the system once and stays, so that short rounds of several codes can be
interleaved and the set-up is in no figure.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np

    from harness.engines.protocol import Probe
    from harness.scene.system import System


class Timed(Protocol):
    """One code in one of the ways in which it can compute a system."""

    name: str
    slow: bool
    """It is given fewer steps, and no large systems."""
    note: str
    """In which way it computes, one line in the code's own words."""

    def probe(self) -> Probe:
        """Say whether the code can run here, and its version."""

    def refusal(self, system: System) -> str:
        """Return why the code does not compute this system, "" if it does."""

    def render(self, system: System, *, skin: float) -> dict[str, str]:
        """Return deck files by name. skin: how far beyond contact pairs are listed, m."""

    def command(self, core: int | None) -> list[str]:
        """Return the child's command, to be started in the deck's folder; `core` is what it pins itself to."""

    def environment(self) -> dict[str, str]:
        """Return the child's environment: one thread."""


class Running(Protocol):
    """A built system in the child."""

    def advance(self, steps: int) -> None:
        """Make steps; this is what is timed."""

    def places(self) -> np.ndarray:
        """Return the positions, (N, dim) in m, ids ascending."""

    def facts(self) -> dict[str, int]:
        """Return what the code can say of itself: bytes `held` and at the `peak`, `rebuilds` of its pair list."""


def refused(supports) -> str:
    """Return the first reason out of an engine's judgements for which it would not be run, "" if there is none."""
    from harness.engines.protocol import REFUSED

    return next((f"{s.effect}: {s.note}" for s in supports if s.level in REFUSED), "")


def ring_refusal(system: System) -> str:
    """The children of the session know particles and fixed planes."""
    return "rings are not timed" if system.rings else ""
