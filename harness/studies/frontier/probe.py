"""One look: do small motions about rest grow in this engine, with this time step?

Particles at rest in balance are given random velocities and spins so small that no contact opens or slides. Velocity
Verlet keeps v^2/2 + w^2 x^2 (1 - (w dt/2)^2)/2 of every motion of frequency w, and x = 0 at the start: below the limit
the kinetic energy therefore never exceeds its start, beyond it the fastest motion grows by the same factor every step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from harness.scene.system import System
from harness.studies.frontier.laws import MASS, OVERLAP, RADIUS, STIFFNESS

if TYPE_CHECKING:
    from harness.runs.pool import Done
    from postproc.trajectory import Trajectory

STEPS, FRAMES = 1200, 60
"""Of one look. One per cent beyond the limit motions grow by 1.3 in a step without dashpots, by 1.02 at least.

What grows far enough opens contacts and slides, and dashpots may then bring all of it to rest again: 3 to 30 per cent
beyond its limit an fcc lattice has done so after 200 to 500 steps, so that frames are taken every 20.
"""

AMPLITUDE = 1e-5
"""Of the start's velocities, in OVERLAP RADIUS sqrt(STIFFNESS/MASS): displacements over overlaps.

So small that motions grow by far more than GROWN before the most weakly pressed contact of a random packing slides.
"""

GROWN = 4.0
"""Factor of the kinetic energy from which it has grown; what balance is left at the start is worth less."""

SEED = 5

Seen = Literal["stable", "unstable", "failed"]


@dataclass(frozen=True, kw_only=True)
class Look:
    """What one step size did. energy: largest kinetic energy over that of the start, inf where numbers ran away.

    reason: of a run that says nothing about stability (`failed`), and how an unstable one ended.
    """

    dt: float
    seen: Seen
    energy: float
    reason: str = ""


def disturbed(rest: System, dt: float, steps: int = STEPS) -> System:
    """Return the system at rest with small random motions, to be followed for so many steps of `dt`, s."""
    rng, p = np.random.default_rng(SEED), rest.particles
    speed = AMPLITUDE * OVERLAP * RADIUS * math.sqrt(STIFFNESS / MASS)
    spins = speed / p.radius[:, None] * rng.normal(size=p.spin.shape) if turns(rest) else p.spin
    moved = {"v": speed * rng.normal(size=p.x.shape), "spin": spins}
    particles = type(p)(**{k: moved.get(k, getattr(p, k)) for k in p.__dataclass_fields__})
    every = steps // FRAMES
    return rest.with_(particles=particles, dt=dt, steps=steps, sample_every=every, frame_every=every)


def turns(system: System) -> bool:
    """Whether a law turns particles."""
    from harness.scene.laws import turning

    return bool(turning(system))


def look(done: Done, dt: float) -> Look:
    """Judge a finished run."""
    from postproc.trajectory import read_trajectory

    outcome = done.outcome
    if outcome.status == "completed":
        energy = growth(read_trajectory(done.folder / "trajectory.h5"))
        return Look(dt=dt, seen="stable" if energy < GROWN else "unstable", energy=energy)
    ran_away = outcome.status == "unstable" or (outcome.status == "crashed" and outcome.steps_done > 0)
    return Look(
        dt=dt, seen="unstable" if ran_away else "failed", energy=math.inf, reason=f"{outcome.status}: {outcome.reason}"
    )


def growth(trajectory: Trajectory) -> float:
    """Return the largest kinetic energy of the frames over the first one's; inf where it is no number."""
    energies = np.array([_kinetic(frame) for frame in trajectory])
    largest = float((energies / energies[0]).max())
    return largest if math.isfinite(largest) else math.inf


def _kinetic(frame) -> float:
    """sum m v^2/2 + I w^2/2, J."""
    p, axes = frame.particles, "xyz"[: frame.dimension]
    spins = ("wz",) if frame.dimension == 2 else ("wx", "wy", "wz")
    with np.errstate(over="ignore", invalid="ignore"):
        moving = sum(p["mass"] * p[f"v{a}"] ** 2 for a in axes).sum()
        return float(0.5 * (moving + sum(p["inertia"] * p[w] ** 2 for w in spins).sum()))
