"""Short runs of an effect on, off, and on with its coefficient at zero: off and zero must be one to round-off.

The runs start together and are compared in every frame::

    deviation = max over frames and bodies of |x' - x|/max|x - x(0)| and |v' - v|/max|v|

A run in which the effect changes nothing tells nothing, and is not a check. Rounding grows in a packing, so runs end
long before chaos.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.protocol import Engine
from harness.engines.whole import at_zero
from harness.runs.folder import runs_root
from harness.runs.outcome import reason_of
from harness.runs.pool import Done, run_many
from harness.scene.system import System
from harness.studies.accuracy.shown import Grouped
from harness.studies.effects.footprint import refusal
from harness.studies.effects.pairs import OnOff
from harness.studies.verdict import Verdict
from postproc.trajectory import Trajectory, read_trajectory

if TYPE_CHECKING:
    from harness.runs.progress import Progress

STEPS, FRAMES = 4000, 10

ROUND_OFF = 1e-9
"""Deviation that is rounding: the shipped scenes reach 1e-12 to 1e-10 (measured)."""

ACTS = 1e-6
"""Deviation of on from off below which the effect does nothing in these steps."""


@dataclass(frozen=True, kw_only=True)
class ZeroCheck:
    """Off against zero on one engine. deviation: see the module. acts: the same between on and off.

    exact: whether the coefficient is 0; else it is next to nothing, as 0 is how the scene says off.
    """

    effect: str
    engine: str
    says: str
    verdict: Verdict
    why: str
    deviation: float | None = None
    acts: float | None = None
    steps: int = 0
    exact: bool = True


@dataclass(frozen=True, kw_only=True)
class Probed:
    """What the short runs told. columns: of the output, by effect, engine and "on" or "off"."""

    checks: tuple[ZeroCheck, ...]
    columns: Mapping[tuple[str, str, str], frozenset[str]]


def short(system: System) -> System:
    """Return the first steps of a system, all of them of a short one, in frames with contacts."""
    steps = min(system.steps, STEPS)
    every = max(1, steps // FRAMES)
    return system.with_(steps=every * (steps // every), sample_every=every, frame_every=every)


def probe(
    pairs: Sequence[OnOff], engines: Sequence[Engine], out: Path, *, time_limit: float, workers: int | None,
    progress: Progress | None,
) -> Probed:
    """Run what is not kept below `out`, and compare."""
    plan: dict[tuple[str, str], tuple[Engine, System]] = {}
    refused: dict[tuple[str, str, str], str] = {}
    wanted: dict[tuple[str, str, str], tuple[str, str]] = {}
    for pair in pairs:
        for which, system in (("on", pair.on), ("off", pair.off), ("zero", pair.zero)):
            for engine in engines if system is not None else ():
                key = (pair.effect, engine.name, which)
                refused[key] = _refusal(engine, short(system))
                if not refused[key]:
                    wanted[key] = (engine.name, short(system).digest())
                    plan[wanted[key]] = (engine, short(system))
    jobs = [(f"short runs, {name}", engine, system) for (name, _), (engine, system) in plan.items()]
    shown = Grouped([label for label, *_ in jobs], progress) if progress else None
    done = dict(zip(plan, run_many(
        jobs, runs_root(out), time_limit=time_limit, workers=workers, native="drop", progress=shown
    ), strict=True))
    runs = {key: _trajectory(done[of]) for key, of in wanted.items()}
    checks = tuple(_check(p, e.name, runs, refused) for p in pairs for e in engines)
    columns = {key: _columns(run) for key, run in runs.items() if isinstance(run, Trajectory) and key[2] != "zero"}
    return Probed(checks=checks, columns=columns)


def deviation(a: Trajectory, b: Trajectory) -> float:
    """Return the largest deviation of two runs, infinite where one is no number."""
    found = []
    for columns, relative in ((("x", "y", "z"), True), (("vx", "vy", "vz"), False)):
        first, second = (_values(t, columns) for t in (a, b))
        start = first[:1] if relative else 0.0
        size, apart = np.abs(first - start).max(), np.abs(second - first).max()
        found.append(apart / size if size > 0.0 else (0.0 if apart == 0.0 else np.inf))
    worst = float(np.max(found))
    return worst if np.isfinite(worst) else float("inf")


def _refusal(engine: Engine, system: System) -> str:
    """Ask the engine, and have it write the deck: a coefficient that no deck can say is refused there."""
    try:
        missing = refusal(engine, system)
        if not missing:
            engine.render(system)
    except ArithmeticError as error:
        return f"its deck cannot say it: {error}"
    probe = engine.probe()
    return missing or ("" if probe.available else probe.detail)


def _trajectory(done: Done) -> Trajectory | str:
    """Return the run's trajectory, or why there is none."""
    if done.outcome.status != "completed":
        return reason_of(done.outcome)
    return read_trajectory(done.folder / "trajectory.h5")


def _check(pair: OnOff, engine: str, runs: Mapping, refused: Mapping[tuple[str, str, str], str]) -> ZeroCheck:
    facts = {"effect": pair.effect, "engine": engine, "says": pair.zero_says, "exact": pair.exact}
    if pair.zero is None:
        return ZeroCheck(**facts, verdict="not_checked", why=pair.why_no_zero)
    for which in ("on", "off", "zero"):
        key = (pair.effect, engine, which)
        missing = refused[key] or (runs[key] if isinstance(runs.get(key), str) else "")
        if missing:
            return ZeroCheck(**facts, verdict="not_checked", why=f"{which}: {missing}")
    on, off, zero = (runs[pair.effect, engine, which] for which in ("on", "off", "zero"))
    acts, apart = deviation(off, on), deviation(off, zero)
    facts |= {"deviation": apart, "acts": acts, "steps": int(off.steps[-1])}
    if pair.zero.digest() == pair.off.digest():
        return ZeroCheck(**facts, verdict="not_checked", why="off is written as this number: the runs are one")
    if acts <= ACTS:
        return ZeroCheck(**facts, verdict="not_checked", why="it changes nothing within these steps")
    how = "" if pair.exact else "; 0 is how the scene says off, so off is held against next to nothing"
    if apart <= ROUND_OFF:
        return ZeroCheck(**facts, verdict="agrees", why=f"one to round-off{how}")
    known = at_zero(engine, pair.effect)
    if known:
        return ZeroCheck(**facts, verdict="known_difference", why=known)
    return ZeroCheck(**facts, verdict="differs", why=f"they part by more than {ROUND_OFF:g}{how}")


def _values(trajectory: Trajectory, columns: Sequence[str]) -> np.ndarray:
    """Return (F, N, dim) of all frames."""
    return np.array([
        f.particles.vector(*(c for c in columns if c in f.particles)) for f in trajectory
    ])


def _columns(run: Trajectory) -> frozenset[str]:
    """Return the columns of particles, contacts and walls, and those of the series."""
    found = {f"series.{c}" for c in run.series or ()}
    for frame in run:
        for name in ("particles", "contacts", "walls"):
            found |= {f"{name}.{c}" for c in getattr(frame, name) or ()}
    return frozenset(found)
