"""A check and its verdict: values that tables, pages and exit status are made of."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

Verdict = Literal["agrees", "differs", "inconclusive", "not_checked", "known_difference"]
"""`not_checked` is never a pass; `inconclusive` means that the data cannot decide."""

Level = Literal["L0", "L1", "L2", "L3", "run"]
"""L0 law, L1 collision, L2 trajectory until chaos, L3 statistics over packings; "run": a property that
a single run must have, which compares it with nothing but the scene."""


@dataclass(frozen=True, kw_only=True)
class Check:
    """One declared check.

    left, right: what is compared (engines, or an engine and a reference). deviation, tolerance:
    relative, and for a property with a limit its size and the limit; None when not computed.
    why: one line; of a check that differs it ends with the command that reruns it.
    chance: of statistics, what equal codes may differ by at this check's rate of false alarms (`tolerance` is then
    the declared margin). samples: of a pointwise check, how many samples `deviation` is the largest of.
    """

    level: Level
    quantity: str
    left: str
    right: str
    deviation: float | None
    tolerance: float | None
    verdict: Verdict
    why: str
    chance: float | None = None
    samples: int | None = None


@dataclass(frozen=True, kw_only=True)
class Rerun:
    """The command that repeats a comparison for some of its engines. words: what a user types, by engine's name.

    >>> Rerun(scene_file=Path("my scene.toml"), out=Path("out"), packings=None)("lammps", "liggghts")
    "grainproof compare 'my scene.toml' --engines lammps,liggghts --out out"
    """

    scene_file: Path
    out: Path
    packings: int | None
    words: Mapping[str, str] = field(default_factory=dict)
    replicates: int | None = None

    def __call__(self, *engines: str) -> str:
        """Return the command, quoted for a shell. engines: their names in tables."""
        typed = ",".join(self.words.get(name, name) for name in engines)
        words = ["grainproof", "compare", str(self.scene_file), "--engines", typed, "--out", str(self.out)]
        counts = {"--packings": self.packings, "--replicates": self.replicates}
        return shlex.join([*words, *(w for option, n in counts.items() if n for w in (option, str(n)))])


def judged(*, deviation: float, tolerance: float, why: str, rerun: str, **facts) -> Check:
    """Return the check of a declared tolerance; a deviation that is not a number differs."""
    verdict: Verdict = "agrees" if deviation <= tolerance else "differs"
    return Check(
        **facts, deviation=deviation, tolerance=tolerance, verdict=verdict,
        why=why if verdict == "agrees" else f"{why}; rerun: {rerun}",
    )


def not_checked(*, why: str, tolerance: float | None = None, **facts) -> Check:
    """Return the check that could not be made."""
    return Check(**facts, deviation=None, tolerance=tolerance, verdict="not_checked", why=why)


def failed(checks: Iterable[Check]) -> bool:
    """Return whether a check differs, or nothing was compared with anything but its own scene."""
    checks = list(checks)
    compared = any(c.level != "run" and c.verdict != "not_checked" for c in checks)
    return not compared or any(c.verdict == "differs" for c in checks)
