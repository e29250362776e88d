"""The monitors: curves over the frames of a run, and one row each for their worst.

Everything is read from what the run recorded anyway, by the engine's own output of samples and frames: a watched run
has the same deck, the same folder and the same bits as one that is not, and a kept run can be watched later. What
happens between two frames is not seen.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.scene.contact import MindlinSliding
from harness.scene.laws import turning
from harness.scene.system import System
from harness.studies.frontier.formula import formula_limit
from harness.studies.watch.energies import (
    Unknown,
    normal_energy,
    tangential_energy,
    weight,
    work_of_walls,
)
from harness.studies.watch.passing import passed
from harness.studies.watch.remarks import Remark, remarks
from harness.studies.watch.state import State, state_of
from postproc.macro.contact_ends import contact_ends
from postproc.snapshot import MissingColumn
from postproc.trajectory import Trajectory

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.outcome import Outcome

UNITS = {
    **dict.fromkeys((
        "kinetic energy", "rotational energy", "elastic energy, normal", "elastic energy, tangential",
        "energy of weight", "work of walls", "dissipated", "dissipated or in springs",
    ), "J"),
    "momentum": "kg m/s",
    **dict.fromkeys((
        "largest overlap", "largest displacement per step", "lost particles", "numbers not finite", "static residual",
    ), "1"),
}
"""Of the curves, in the order of tables."""

SAYS = {
    "kinetic energy": "sum m v^2/2", "rotational energy": "sum I w^2/2",
    "elastic energy, normal": "from overlaps and the law's potential",
    "elastic energy, tangential": "sum k_t u^2/2", "energy of weight": "-sum m g.x",
    "work of walls": "of walls and rings on the particles",
    "dissipated": "E(0) + work - E(t); where it falls, energy was made",
    "dissipated or in springs": "E(0) + work - E(t) without what springs of friction, rolling and torsion hold",
    "momentum": "|sum m v|", "largest overlap": "over the smaller radius",
    "largest displacement per step": "max |v| dt over the particle's radius",
    "lost particles": "of the scene's", "numbers not finite": "in places, velocities and spins",
    "static residual": "largest net force on a particle over the mean contact force",
}


@dataclass(frozen=True, kw_only=True)
class Watch:
    """curves: by name, (F,), in UNITS, over time (F,), s. absent: why there is no such curve, by name.

    made: the largest fall of the dissipated energy, J, i.e. energy that was made; where springs are not recorded, what
    was made at least, as they begin empty; None where that is not known.
    work_error: by how much the work of walls may be wrong, J. of_frames: how many; 0: the run left nothing to read.
    remarks: what cannot be; with one the run is not to be trusted.
    """

    time: np.ndarray
    curves: dict[str, np.ndarray]
    absent: dict[str, str]
    made: float | None = None
    work_error: float = 0.0
    remarks: tuple[Remark, ...] = ()

    @property
    def of_frames(self) -> int:
        """Number of frames."""
        return len(self.time)

    def rows(self) -> list[dict]:
        """Return a row a quantity: its largest size and when, its last value; what is not known has its reason."""
        rows = [self._row(name) for name in UNITS if name in self.curves or name in self.absent]
        if self.made is not None:
            known = f"; the work of walls is known to {self.work_error:.2g} J" if self.work_error else ""
            whole = "dissipated" in self.curves
            note = ("largest fall of the dissipated energy" if whole else "at least: springs begin empty") + known
            rows.append(_of("energy made", self.made, None, None, "J", note))
        return rows

    def numbers(self) -> dict[str, float | str]:
        """Return the largest size of every curve by its name and unit, why a curve is missing, and remarks."""
        return {
            (f"{r['quantity']} ({r['unit']})" if r["largest"] is not None else r["quantity"]): (
                r["note"] if r["largest"] is None else r["largest"]
            )
            for r in self.rows()
        } | {f"remark: {r.what}": r.says for r in self.remarks}

    def remark_rows(self) -> list[dict]:
        """Return a row a remark."""
        return [
            {"remark": r.what, "size": r.size if np.isfinite(r.size) else None, "beyond": r.limit, "of": r.unit,
             "at time (s)": r.at, "why": r.why}
            for r in self.remarks
        ]

    def _row(self, name: str) -> dict:
        if name in self.absent:
            return _of(name, None, None, None, UNITS[name], f"not available: {self.absent[name]}")
        curve = self.curves[name]
        sizes = np.where(np.isfinite(curve), np.abs(curve), np.inf)
        at = int(np.argmax(sizes))
        if not np.isfinite(curve[at]):
            return _of(name, None, float(self.time[at]), None, UNITS[name], f"no finite number{_WHY.get(name, '')}")
        return _of(name, float(curve[at]), float(self.time[at]), float(curve[-1]), UNITS[name], SAYS[name])


_WHY = {"static residual": ": weight acts and nothing presses"}
"""Of quantities that can be infinite where all numbers are finite."""


def _of(name: str, largest, at, last, unit: str, note: str) -> dict:
    return {"quantity": name, "largest": largest, "at time (s)": at, "last": last, "unit": unit, "note": note}


def watch(system: System, trajectory: Trajectory) -> Watch:
    """Return what the frames and the series of a run say."""
    states = [state_of(system, frame) for frame in trajectory]
    curves: dict[str, np.ndarray] = {}
    absent: dict[str, str] = {}
    for name, made in _monitors(system, states).items():
        try:
            curves[name] = made()
        except Unknown as reason:
            absent[name] = str(reason)
    error = _balance(curves, absent, system, trajectory, states)
    dissipated, time = curves.get("dissipated"), np.array([s.time for s in states])
    made = at_least_made(curves) if dissipated is None else _largest_fall(dissipated)
    return Watch(
        time=time, curves={k: curves[k] for k in UNITS if k in curves}, absent=absent, made=made, work_error=error,
        remarks=remarks(time, curves, passed=passed(system, states), made=made, work_error=error,
                        step=system.dt / formula_limit(system)),
    )


def watch_folder(engine: Engine, system: System, folder: Path, outcome: Outcome) -> Watch:
    """Watch the run in a folder; of one that did not complete what can still be read, else the reason for all."""
    from postproc.trajectory import ReadError, read_trajectory

    if outcome.status in ("unsupported", "unavailable"):
        return nothing(f"the run was not made: {outcome.reason}")
    try:
        done = outcome.status == "completed"
        return watch(system, read_trajectory(folder / "trajectory.h5") if done else engine.read(folder, system))
    except (ReadError, OSError) as error:
        return nothing(f"the run left no whole output: {error}".replace(f"{folder}/", ""))


def nothing(reason: str) -> Watch:
    """Return the watch of a run that left nothing."""
    return Watch(time=np.empty(0), curves={}, absent=dict.fromkeys(UNITS, reason))


def _monitors(system: System, states: list[State]) -> dict[str, Callable[[], np.ndarray]]:
    """Return what makes each curve, for what exists in this system."""
    made = {
        "kinetic energy": lambda: np.array([s.mass @ (s.v**2).sum(axis=1) / 2 for s in states]),
        "elastic energy, normal": lambda: normal_energy(system, states),
        "momentum": lambda: np.array([np.linalg.norm(s.mass @ s.v) for s in states]),
        "largest overlap": lambda: np.array([s.relative.max(initial=0.0) for s in states]),
        "largest displacement per step": lambda: np.array([_displacement(s, system.dt) for s in states]),
        "lost particles": lambda: np.array([float(len(system.particles) - len(s.x)) for s in states]),
        "numbers not finite": lambda: np.array([_not_finite(s) for s in states]),
        "static residual": lambda: _residuals(system, states),
    }
    if turning(system):
        made["rotational energy"] = lambda: np.array([s.inertia @ (s.spin**2).sum(axis=1) / 2 for s in states])
    if system.sliding is not None and hasattr(system.sliding, "shear_stiffness"):
        made["elastic energy, tangential"] = lambda: tangential_energy(system, states)
    if system.gravity is not None:
        made["energy of weight"] = lambda: weight(system, states)
    return made


def _balance(curves, absent, system: System, trajectory: Trajectory, states: list[State]) -> float:
    """Add work and dissipation, as far as they are known; return the error of the work, J."""
    try:
        work = work_of_walls(system, trajectory, states)
    except Unknown as reason:
        absent["work of walls"] = absent["dissipated"] = str(reason)
        return 0.0
    if system.walls or system.rings:
        curves["work of walls"] = work.done
    known = [curves[name] for name in ENERGIES if name in curves]
    energy = np.sum(known, axis=0)
    taken, missing = energy[0] + work.done - energy, _unknown_stores(system, absent)
    if missing:
        absent["dissipated"] = missing
    if not missing:
        curves["dissipated"] = taken
    elif NORMAL not in absent:
        curves["dissipated or in springs"] = taken
    return work.error


NORMAL = "elastic energy, normal"

ENERGIES = (
    "kinetic energy", "rotational energy", "elastic energy, normal", "elastic energy, tangential", "energy of weight",
)


def _unknown_stores(system: System, absent: dict[str, str]) -> str:
    """Return why the energy of the particles is not known as a whole, "" if it is."""
    missing = next((f"{name}: {absent[name]}" for name in ENERGIES if name in absent), "")
    if missing:
        return missing
    for family in ("rolling", "torsion"):
        if hasattr(getattr(system, family), f"{family}_stiffness"):
            return f"springs of {family} are not recorded"
    return "what Mindlin's spring holds is not recorded" if isinstance(system.sliding, MindlinSliding) else ""


def at_least_made(curves: Mapping[str, np.ndarray]) -> float | None:
    """Return what springs that are not recorded cannot have held: they begin empty; None without a balance."""
    taken = curves.get("dissipated or in springs")
    if taken is None:
        return None
    return float((-taken).max(initial=0.0)) if np.isfinite(taken).all() else np.inf


def _largest_fall(curve: np.ndarray) -> float:
    """Return the largest drop below the highest value so far."""
    return float((np.maximum.accumulate(curve) - curve).max(initial=0.0)) if np.isfinite(curve).all() else np.inf


def _displacement(state: State, dt: float) -> float:
    """Largest |v| dt over the radius."""
    return float((np.linalg.norm(state.v, axis=1) * dt / state.radius).max(initial=0.0))


def _not_finite(state: State) -> float:
    arrays = (state.x, state.v, state.spin)
    return float(sum((~np.isfinite(a)).sum() for a in arrays))


def _residuals(system: System, states: list[State]) -> np.ndarray:
    if not system.contacts:
        raise Unknown("contact forces are not recorded: outputs.contacts = true records them")
    try:
        return np.array([_residual(system, s) for s in states])
    except MissingColumn as reason:
        raise Unknown(str(reason)) from None


def _residual(system: System, state: State) -> float:
    """Return max |sum of contact forces + m g| over the mean contact force; nothing pushed and nothing pushing is 0."""
    ends = contact_ends(state.snapshot)
    net = ends.sum_c(ends.f)
    if system.gravity is not None:
        net = net + state.mass[:, None] * np.array(system.gravity)
    sizes = np.linalg.norm(state.snapshot.contacts.vector(*(f"f{a}" for a in state.snapshot.axes)), axis=1)
    largest, mean = float(np.linalg.norm(net, axis=1).max(initial=0.0)), float(sizes.mean()) if len(sizes) else 0.0
    return largest / mean if mean else (0.0 if largest == 0.0 else np.inf)
