"""What versions of LAMMPS compute otherwise than the one whose decks were proven (22 Jul 2025), as measured.

tests/engines/lammps/test_versions.py shows each on another version where one is named to it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from harness.scene.overlaps import initial_overlaps
from harness.scene.system import System


@dataclass(frozen=True, kw_only=True)
class Change:
    """Something that versions up to `until` (a date as LAMMPS gives it, yyyymmdd) do; later ones were not seen to.

    effect: what it is part of. touches: does it matter in a system? evidence: what was measured.
    """

    effect: str
    until: int
    touches: Callable[[System], bool]
    evidence: str


def _rolls_at_start(system: System) -> bool:
    """In 2D the couple lies in the plane, where nothing turns, unless something spins."""
    moves = system.dimension == 3 or bool(system.particles.spin.any())
    return system.rolling is not None and moves and initial_overlaps(system).size.size > 0


CHANGES = (
    Change(
        effect="rolling resistance", until=20240829, touches=_rolls_at_start,
        evidence="up to 29 Aug 2024 rolling sds has a couple of nonsense in the forces of the set-up, as of a spring"
        " of 1 m up to the limit mu_r f_n R*: bodies that touch at the start get half a step of it (spins of two"
        " spheres 4 % off after 200 steps); 22 Jul 2025 has none",
    ),
)


def changes(system: System, date: int) -> tuple[Change, ...]:
    """Return what the version of this date does otherwise in this system; date 0 is the version of the decks."""
    return tuple(c for c in CHANGES if 0 < date <= c.until and c.touches(system))
