"""The energy balance of a run from its frames and series.

Particles and their contacts gain what walls and rings do on them, less what is dissipated::

    dissipated(t) = E(0) + W(t) - E(t),    E = E_kin + E_rot + U_n + U_t - sum m g.x
    W(t) = -int sum_walls F.v + sum_rings T omega dt

F, T: force and torque of the particles on a wall and a ring. Dissipated is everything that dashpots, sliding, drag,
plastic contacts and errors of the integration take; where it falls, energy was made.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.scene.laws import elastic_stiffness, word
from harness.scene.system import Constant, System
from harness.studies.stability.seen import POTENTIALS, held, sheared
from harness.studies.watch.state import State
from postproc.trajectory import Trajectory


class Unknown(Exception):
    """A run does not show a quantity; the message says why."""


@dataclass(frozen=True, kw_only=True)
class Work:
    """Work of walls and rings on the particles by each frame, (F,), J, and by how much the rule may be wrong, J."""

    done: np.ndarray
    error: float


def normal_energy(system: System, states: list[State]) -> np.ndarray:
    """Energy of the normal springs, (F,), J, from overlaps and the law's potential. Raises Unknown."""
    potential = POTENTIALS.get(type(system.normal))
    if potential is None:
        raise Unknown(f'what the law "{word(system.normal)}" stores does not follow from the overlap')
    return np.array([held(system, potential, s) for s in states])


def tangential_energy(system: System, states: list[State]) -> np.ndarray:
    """k_t u^2/2 of the friction springs, (F,), J. Raises Unknown where springs are not recorded."""
    if elastic_stiffness(system.sliding) is None:
        raise Unknown(f'what the law "{word(system.sliding)}" stores does not follow from its spring')
    if not system.contacts:
        raise Unknown("springs are not recorded: outputs.contacts = true records them")
    found = np.array([sheared(system, s.snapshot) for s in states])
    if np.isnan(found).any():
        raise Unknown("the engine does not tell the springs of all walls")
    return found


def weight(system: System, states: list[State]) -> np.ndarray:
    """-sum m g.x, (F,), J; 0 without gravity."""
    if system.gravity is None:
        return np.zeros(len(states))
    return np.array([-float(s.mass @ (s.x @ np.array(system.gravity))) for s in states])


def work_of_walls(system: System, trajectory: Trajectory, states: list[State]) -> Work:
    """Work by the trapezoidal rule over the samples; its error from every second one (Richardson). Raises Unknown."""
    if not any(w.motion for w in system.walls) and not any(r.omega for r in system.rings):
        return Work(done=np.zeros(len(states)), error=0.0)
    if trajectory.series is None:
        raise Unknown("no series of walls was recorded")
    time, power = trajectory.series["time"], _power(system, trajectory.series)
    done = _integral(time, power)
    coarse = np.interp(time, time[::2], _integral(time[::2], power[::2]))
    error = float(np.abs(coarse - done)[: 2 * (len(time) // 2)].max(initial=0.0)) / 3
    return Work(done=np.interp([s.time for s in states], time, done), error=error)


def _integral(time: np.ndarray, power: np.ndarray) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(np.diff(time) * (power[1:] + power[:-1]) / 2)])


def _power(system: System, series) -> np.ndarray:
    """What walls and rings do on the particles, (S,), W."""
    total = np.zeros(len(series["time"]))
    for wall in (w for w in system.walls if w.motion is not None):
        force = np.stack([series[f"{wall.name}_f{a}"] for a in "xyz"[: system.dimension]])
        if isinstance(wall.motion, Constant):
            total -= np.array(wall.motion.velocity) @ force
        else:
            total -= series[f"{wall.name}_v"] * (np.array(wall.normal) @ force)
    for ring in (r for r in system.rings if r.omega):
        total -= series[f"{ring.name}_torque"] * ring.omega
    return total
