"""What a study of a talk's result declares, what it is asked, and what it answers.

A study is a module of this package (a package of its own when it is long) with a `STUDY`, and a line in
`harness.studies.reproduce.registry`. `run` gets an `Ask`, makes the runs it needs below ``ask.out`` and returns a
`Result`: plain values. It draws nothing (`harness.report.reproduce` makes page, pictures and tables of any result) and
knows engines only through their protocol. `harness.studies.reproduce.rows` makes rows and their verdicts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from harness.runs.outcome import Outcome
from harness.studies.verdict import Check, Verdict
from reference.values import Published

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress
    from harness.scene.model import Scene
    from postproc.snapshot import Snapshot

Size = Literal["quick", "paper"]
SIZES: tuple[Size, ...] = ("quick", "paper")


@dataclass(frozen=True, kw_only=True)
class Ask:
    """What a user asks of a study. engines: chosen, in one process each unless the user says otherwise.

    packings: None for as many as the size has. measurements: a file of the user's own, for studies that take one.
    time_limit: seconds a run. Runs are kept below ``out/runs``, packings below ``out/packings``, and reused.
    """

    size: Size
    engines: tuple[Engine, ...]
    out: Path
    packings: int | None = None
    measurements: Path | None = None
    workers: int | None = None
    time_limit: float = 3600.0
    progress: Callable[[], Progress] | None = None
    executor: Executor | None = None


@dataclass(frozen=True, kw_only=True)
class Declared:
    """One size of a study. says: what is computed, in a line. packings: how many when the user does not say.

    beyond: seconds on an idle core of what are no runs of its cases: prescribed motion, fits (measured).
    """

    says: str
    packings: int
    beyond: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Case:
    """One scene that a study computes: a variant of the scene in `file`. packings: how many starts it is run from.

    Every chosen engine runs it that can; what `grainproof reproduce` says about the time beforehand follows from it.
    """

    name: str
    scene: Scene
    file: Path
    packings: int


# --- numbers -------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A number of ours, of one engine.

    value: mean over packings. error: its standard error, None where one cannot be told (one packing), 0.0 of what has
    no scatter. values: one a packing, empty where the number is not formed packing by packing.
    """

    engine: str
    value: float
    error: float | None
    packings: int
    values: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Row:
    """A quantity of ours beside the talk's. See `harness.studies.reproduce.rows`, which makes them.

    talk: None where the talk prints no number. deviation: ours - talk in `unit`, tolerance likewise; None when not
    known. why: one line.
    """

    quantity: str
    unit: str
    ours: Measured
    talk: Published | None
    deviation: float | None
    tolerance: float | None
    verdict: Verdict
    why: str


@dataclass(frozen=True, kw_only=True)
class RatePoint:
    """A quantity at one setting of what a study varies to show its convergence (rate, time step, length).

    setting: what it is, in words ("T = 0.16 s"). number: its size as a pure number that tends to 0 in the limit (the
    inertial number of a drive, a time step over a contact time), None where there is none. Points of one quantity and
    engine stand one behind the other, the coarsest first.
    """

    quantity: str
    unit: str
    setting: str
    number: float | None
    ours: Measured


# --- pictures, as data ---------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True, eq=False)
class Line:
    """Values y (P,) at x (P,), with errors (P,) or None. engine: gives it the engine's colour.

    look: "line", "points", "fit" (thin, dashed), "talk" (what the talk prints) or "steps" (a histogram's outline).
    """

    name: str
    x: np.ndarray
    y: np.ndarray
    error: np.ndarray | None = None
    engine: str = ""
    look: Literal["line", "points", "fit", "talk", "steps"] = "line"


@dataclass(frozen=True, kw_only=True, eq=False)
class Chart:
    """Lines over labelled axes; its numbers are written beside the page as ``<name>.csv``. name: a plain word."""

    name: str
    caption: str
    x: str
    y: str
    lines: tuple[Line, ...]
    log_x: bool = False
    log_y: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """A state of discs, coloured by a number each (N,) or moved by arrows (N, 2), m; `title` stands above it."""

    title: str
    frame: Snapshot
    colour: np.ndarray | None = None
    arrows: np.ndarray | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class DiscPicture:
    """Panels side by side on one scale. label: of the colours, with unit. limit: the colours' end; None: the largest.

    diverging: colours run from -limit to limit, else from 0. arrow_scale: drawn length over real length.
    """

    name: str
    caption: str
    panels: tuple[Panel, ...]
    label: str = ""
    limit: float | None = None
    diverging: bool = True
    arrow_scale: float = 1.0


Picture = Chart | DiscPicture


# --- the whole -----------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class StudyRun:
    """One run that was made: on whose account, of which case and packing (counted from 0), and what became of it."""

    engine: str
    case: str
    packing: int
    outcome: Outcome


@dataclass(frozen=True, kw_only=True)
class Result:
    """What a study answers.

    checks: that the codes agree among each other and that runs have the properties they must have. rates, rate_words:
    the study's own convergence, and what it says. tables: further ones, by heading. words: the discussion, paragraph
    by paragraph, made from the numbers. unsupported: engines that cannot compute the scene, and why.
    """

    rows: tuple[Row, ...]
    rates: tuple[RatePoint, ...]
    rate_words: str
    checks: tuple[Check, ...] = ()
    pictures: tuple[Picture, ...] = ()
    tables: Mapping[str, Sequence[Mapping[str, object]]] = field(default_factory=dict)
    words: tuple[str, ...] = ()
    runs: tuple[StudyRun, ...] = ()
    unsupported: Mapping[str, str] = field(default_factory=dict)

    @property
    def broken(self) -> tuple[StudyRun, ...]:
        """Runs that failed; an engine that is missing or cannot compute the scene is said, and is none."""
        return tuple(r for r in self.runs if r.outcome.status in ("crashed", "unstable", "timed_out"))

    @property
    def exit_status(self) -> int:
        """1 when nothing was measured, a run failed, or a row or a check differs; else 0."""
        verdicts = [*(r.verdict for r in self.rows), *(c.verdict for c in self.checks)]
        return 1 if self.broken or not self.rows or "differs" in verdicts else 0


@dataclass(frozen=True, kw_only=True)
class Study:
    """One result of a talk. name: what is typed. claim: what the talk says; source: which talk, which page.

    values: names in `reference.values` that rows are held against. engines: what is run unless the user says;
    cases: the scenes that it computes, none where it needs no run. lacking: engines that lack the law, by name, and
    why. measurements: what file of the user's own it takes, "" for none. refuse: raises InputError for what is asked
    wrongly, before anything is announced or made.
    """

    name: str
    title: str
    claim: str
    source: str
    sizes: Mapping[Size, Declared]
    engines: tuple[str, ...]
    values: tuple[str, ...]
    run: Callable[[Ask], Result]
    cases: Callable[[Ask], Sequence[Case]]
    lacking: Mapping[str, str] = field(default_factory=dict)
    measurements: str = ""
    refuse: Callable[[Ask], None] | None = None

    def check(self, ask: Ask) -> None:
        """Raise InputError for what is asked wrongly."""
        if self.refuse is not None:
            self.refuse(ask)

    def packings(self, ask: Ask) -> int:
        """Return how many packings are asked for."""
        return ask.packings or self.sizes[ask.size].packings
