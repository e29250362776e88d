"""Is what an engine left behind a whole run, and of this world? Wrong physics is judged elsewhere.

A check returns None or a Fault. "crashed": the run is not whole (a frame, a row, a table missing).
"unstable": it is whole but has no meaning (a number that is none, a particle lost or through a wall).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from harness.scene.system import System
    from postproc.snapshot import Columns, Snapshot
    from postproc.trajectory import Trajectory

UNKNOWN_AT_WALLS = frozenset(("ux", "uy", "uz", "mx", "my", "mz", "kn", "kt"))
"""Contact columns that may be NaN in the rows of walls (j < 0), where an engine cannot tell them."""

PLANE_ONLY, RING_ONLY = frozenset(("nx", "ny")), frozenset(("radius", "torque"))
"""Columns of walls that are NaN in the rows of the other kind: a ring has no normal, a plane no radius."""

START_TOLERANCE = 1e-9
"""In radii: decks carry 17 digits, so frame 0 differs from the packing by rounding only."""

TIME_TOLERANCE = 1e-6
"""Relative: time is summed step by step in some engines; a wrong time step is off by far more."""


@dataclass(frozen=True, kw_only=True)
class Fault:
    """Why a run that ended by itself is no completed run."""

    status: Literal["unstable", "crashed"]
    reason: str


def find_fault(system: System, trajectory: Trajectory) -> Fault | None:
    """Return the first fault of the trajectory of `system`, None if there is none."""
    fault = _frames_missing(system, trajectory) or _series_missing(system, trajectory)
    if fault:
        return fault
    for step, frame in zip(trajectory.steps, trajectory.frames, strict=True):
        fault = _frame_fault(system, step, frame)
        if fault:
            return fault
    if trajectory.series is not None:
        fault = _not_finite(trajectory.series, "series", trajectory.series["step"])
    return fault or _wrong_start(system, trajectory.frames[0])


def _frame_fault(system: System, step: int, frame: Snapshot) -> Fault | None:
    return (
        _wrong_tables(system, step, frame)
        or _lost_particles(system, step, frame)
        or _not_finite_frame(step, frame)
        or _wrong_time(system, step, frame.time)
        or _outside(system, step, frame)
        or _through_ring(system, step, frame)
    )


def _frames_missing(system: System, trajectory: Trajectory) -> Fault | None:
    expected = tuple(range(0, system.steps + 1, system.frame_every))
    if trajectory.steps == expected and len(trajectory.frames) == len(expected):
        return None
    return _crashed("frames", trajectory.steps, expected)


def _series_missing(system: System, trajectory: Trajectory) -> Fault | None:
    if trajectory.series is None:
        needed = system.walls or system.rings
        return Fault(status="crashed", reason="no series of wall forces") if needed else None
    missing = [c for c in _series_columns(system) if c not in trajectory.series]
    if missing:
        return Fault(status="crashed", reason=f"the series has no column {', '.join(missing)}")
    steps = tuple(trajectory.series["step"])
    expected = tuple(range(0, system.steps + 1, system.sample_every))
    return None if steps == expected else _crashed("series rows", steps, expected)


def _series_columns(system: System) -> list[str]:
    parts = ["d", "v", *(f"f{a}" for a in "xyz"[: system.dimension])]
    rings = [f"{r.name}_{p}" for r in system.rings for p in ("angle", "torque", "fx", "fy")]
    return ["step", "time", *(f"{w.name}_{p}" for w in system.walls for p in parts), *rings]


def _crashed(what: str, steps: tuple, expected: tuple[int, ...]) -> Fault:
    last = f", the last at step {steps[-1]:.0f}" if steps else ""
    wrong = next((f"; found step {s:.0f} in place of {e}" for s, e in zip(steps, expected, strict=False)
                  if s != e), "")
    return Fault(status="crashed", reason=f"{len(steps)} {what}{last}; expected {len(expected)} "
                                          f"up to step {expected[-1]}{wrong}")


def _wrong_tables(system: System, step: int, frame: Snapshot) -> Fault | None:
    walls = [] if frame.walls is None else frame.walls["id"].tolist()
    expected = [w.index for w in (*system.walls, *system.rings)]
    if walls != expected:
        return Fault(status="crashed", reason=f"step {step}: walls {walls}, the scene has {len(expected)}")
    if (frame.contacts is not None) != system.contacts:
        verb = "no contacts though the scene asks for them" if system.contacts else "contacts nobody asked for"
        return Fault(status="crashed", reason=f"step {step}: the frame has {verb}")
    return None


def _lost_particles(system: System, step: int, frame: Snapshot) -> Fault | None:
    ids, count = frame.particles["id"], len(system.particles)
    if np.array_equal(ids, np.arange(1, count + 1)):
        return None
    lost = sorted(set(range(1, count + 1)) - set(ids.tolist()))
    which = f", lost: {', '.join(map(str, lost[:5]))}{' ...' if len(lost) > 5 else ''}" if lost else ""
    return Fault(status="unstable", reason=f"step {step}: {len(ids)} particles of {count}{which}")


def _not_finite_frame(step: int, frame: Snapshot) -> Fault | None:
    if frame.box is not None and not np.isfinite(frame.box).all():
        return Fault(status="unstable", reason=f"step {step}: the box is {frame.box.tolist()}")
    for group in ("particles", "walls", "contacts"):
        table = getattr(frame, group)
        fault = None if table is None else _not_finite(table, group, np.full(table.rows, step))
        if fault:
            return fault
    return None


def _not_finite(table: Columns, group: str, steps: np.ndarray) -> Fault | None:
    for name, values in table.items():
        bad = ~np.isfinite(values)
        if group == "contacts" and name in UNKNOWN_AT_WALLS:
            bad &= ~(np.isnan(values) & (table["j"] < 0))
        if group == "walls" and name in PLANE_ONLY | RING_ONLY:
            rings = ~np.isnan(table["radius"]) if "radius" in table else np.zeros(table.rows, bool)
            bad &= ~(np.isnan(values) & (rings if name in PLANE_ONLY else ~rings))
        if bad.any():
            row = int(np.argmax(bad))
            return Fault(status="unstable", reason=f"step {steps[row]:.0f}: {group} {name} is {values[row]} "
                                                   f"in row {row + 1}, {bad.sum()} such values")
    return None


def _wrong_time(system: System, step: int, time: float) -> Fault | None:
    expected = step * system.dt
    if abs(time - expected) <= TIME_TOLERANCE * expected:
        return None
    return Fault(status="crashed", reason=f"step {step}: time is {time:.9g}, expected {expected:.9g}")


def _outside(system: System, step: int, frame: Snapshot) -> Fault | None:
    """Find a particle whose centre is behind a wall: it is lost for good, the wall pushes no more."""
    x = frame.particles.vector(*frame.axes)
    axes = "xyz"[: system.dimension]
    for row, wall in enumerate(system.walls):
        point = np.array([frame.walls[f"p{a}"][row] for a in axes])
        normal = np.array([frame.walls[f"n{a}"][row] for a in axes])
        if _crosses_periodic_axis(system, normal):
            continue
        distance = (x - point) @ normal
        worst = int(np.argmin(distance))
        if distance[worst] < 0:
            return Fault(status="unstable", reason=f"step {step}: particle {worst + 1} is "
                                                   f"{-distance[worst]:.3g} m behind wall '{wall.name}'")
    return None


def _through_ring(system: System, step: int, frame: Snapshot) -> Fault | None:
    """Find a particle whose centre has passed the circle of a ring: between glued discs, or over one."""
    x = frame.particles.vector(*frame.axes)
    for ring in system.rings:
        before, now = (np.linalg.norm(y - ring.centre, axis=1) < ring.circle for y in (system.particles.x, x))
        if (before != now).any():
            particle = int(np.argmax(before != now)) + 1
            return Fault(status="unstable", reason=f"step {step}: particle {particle} went through ring '{ring.name}'")
    return None


def _crosses_periodic_axis(system: System, normal: np.ndarray) -> bool:
    """Behind and in front mean nothing along an axis that closes on itself."""
    return system.periodic is not None and any(n != 0 and p > 0
                                               for n, p in zip(normal, system.periodic, strict=True))


def _wrong_start(system: System, frame: Snapshot) -> Fault | None:
    """Compare frame 0 with the packing: an engine that renumbers or shifts particles is found out."""
    offset = frame.particles.vector(*frame.axes) - system.particles.x
    if system.periodic is not None:
        box = np.array(system.periodic)
        offset -= np.round(offset / np.where(box > 0, box, np.inf)) * box
    off = np.abs(offset).max(axis=1) / system.particles.radius
    off = np.maximum(off, np.abs(frame.particles["radius"] / system.particles.radius - 1))
    worst = int(np.argmax(off))
    if off[worst] <= START_TOLERANCE:
        return None
    return Fault(status="crashed", reason=f"step 0: particle {worst + 1} is not where or not as large as "
                                          f"the packing has it, by {off[worst]:.3g} radii")
