"""Collisions: what prescribed motion cannot see, integration and inertia, a few hundred steps, no chaos.

One free system a combination of laws: pairs far from each other, and balls above a floor. Three impacts are made for
closed forms, the others are drawn: oblique, with spin, in 3D.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.registry import kernel_of
from harness.scene.system import INERTIA_FACTOR, Particles, System, Wall
from harness.studies.compare.free import COLUMNS
from harness.studies.compare.growth import column_deviation, displacement_deviation
from harness.studies.laws.motions import DT, Grains
from harness.studies.verdict import Check, judged, not_checked
from reference.values import Published, published_values

if TYPE_CHECKING:
    from harness.studies.laws.cases import Laws
    from postproc.snapshot import Snapshot
    from postproc.trajectory import Trajectory

STEPS, FRAMES = 640, 5
"""Steps of `motions.DT`, six contact times of the linear law; frames after the initial one."""

TOLERANCE = 1e-10
"""Of whole collisions, a code against the kernel in its conventions: rounding, amplified by a few contacts."""

SPEED, SPIN = 0.5, 1500.0
"""Approach of the impacts made for closed forms, m/s, and the spin of the one that slides to the end, rad/s."""

PAIRS, FLOOR_BALLS, SEED = 8, 4, 20240107
SPACING = 8.0

HEAD_ON, SLIDING, ON_FLOOR = 0, 2, 2 * PAIRS
"""First body of the impact without spin, of the one that slides, of the one on the floor without spin."""


@dataclass(frozen=True, kw_only=True)
class Impacts:
    """Places, velocities, spins of all bodies, (N, 3), and which of (i, j) each is (0 or 1)."""

    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    role: np.ndarray


def collision_system(laws: Laws) -> System:
    """Return the system of all impacts with these laws."""
    made, grains = impacts(laws.grains, floor=laws.floor), laws.grains
    particles = Particles(
        x=made.x, v=made.v, spin=made.spin, radius=np.array(grains.radii)[made.role],
        mass=np.array(grains.masses)[made.role], inertia_factor=np.full(len(made.role), INERTIA_FACTOR["sphere"]),
    )
    floor = Wall(index=1, name="floor", point=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), friction=True)
    return System(
        dimension=3, particles=particles, walls=(floor,) if laws.floor else (), **laws.tables(), background=None,
        gravity=None, periodic=None, dt=DT, steps=STEPS, sample_every=STEPS, frame_every=STEPS // FRAMES,
        contacts=False, scene_name=f"collisions-{laws.name}", title=f"Collisions, {laws.name.replace('_', ' ')}",
    )


def impacts(grains: Grains, *, floor: bool) -> Impacts:
    """Return the impacts; drawn ones are the same for all laws of one kind of grains."""
    rng = np.random.default_rng(SEED)
    sets = [_pair(k, grains, rng) for k in range(PAIRS)]
    sets += [_ball(k, grains, rng) for k in range(FLOOR_BALLS)] if floor else []
    x, v, spin, role = (np.concatenate(parts) for parts in zip(*sets, strict=True))
    return Impacts(x=x, v=v, spin=spin, role=role)


def _pair(k: int, grains: Grains, rng: np.random.Generator):
    """Pair number k, above the floor: body i comes along n on j; the first two head-on along x."""
    r_i, r_j = grains.radii
    place = SPACING * r_i * np.array([k % 4, 2.0 + k // 4, 0.0])
    n, t, b = np.eye(3) if k < 2 else _axes(rng)
    gap, along = rng.uniform(5e-6, 2e-5), rng.uniform(-0.5, 0.5, 2)
    spins = rng.uniform(-300.0, 300.0, (2, 3))
    approach = SPEED if k < 2 else rng.uniform(0.3, 0.8)
    relative = -approach * n + (0.0 if k < 2 else along[0] * t + along[1] * b)
    x = np.array([place + (r_i + r_j + gap) * n, place])
    if k < 2:
        spins = np.array([SPIN * b, SPIN * b]) * (k == 1)
    drift = np.zeros(3) if k < 2 else rng.uniform(-0.2, 0.2, 3)
    return x, np.array([drift + 0.6 * relative, drift - 0.4 * relative]), spins, np.array([0, 1])


def _ball(k: int, grains: Grains, rng: np.random.Generator):
    """Ball number k above the floor y = 0; the first falls straight and does not spin."""
    radius = grains.radii[0]
    place = np.array([SPACING * radius * k, radius + rng.uniform(5e-6, 2e-5), 0.0])
    along, spin = rng.uniform(-0.5, 0.5, 2) * (k > 0), rng.uniform(-300.0, 300.0, 3) * (k > 0)
    velocity = np.array([along[0], -SPEED if k == 0 else -rng.uniform(0.3, 0.8), along[1]])
    return place[None], velocity[None], spin[None], np.array([0])


def _axes(rng: np.random.Generator) -> np.ndarray:
    """Three orthonormal rows, drawn."""
    n, other = rng.normal(size=(2, 3))
    n /= np.linalg.norm(n)
    b = np.cross(n, other)
    b /= np.linalg.norm(b)
    return np.array([n, np.cross(b, n), b])


# --- checks ----------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Exit:
    """A number of one run that has a closed form; `value` says which."""

    laws: str
    engine: str
    value: Published
    found: float

    @property
    def deviation(self) -> float:
        """Relative."""
        return abs(self.found - self.value.value) / abs(self.value.value)


def whole_checks(
    laws: Laws, engine: str, run: Trajectory, reference: Trajectory, rerun: str, *, right: str
) -> list[Check]:
    """Return the checks of whole collisions against `right`: the kernel in the engine's conventions, or what flies."""
    deviations = {"displacement": displacement_deviation(run, reference)}
    deviations |= {name: column_deviation(run, reference, columns) for name, columns in COLUMNS.items()}
    return [
        judged(
            level="L1", quantity=f"{laws.name}: collisions, {name}", left=engine, right=right,
            deviation=0.0 if deviation is None else deviation, tolerance=TOLERANCE, rerun=rerun,
            why=f"largest over {len(run) - 1} frames and all bodies",
        )
        for name, deviation in deviations.items()
    ]


def without_kernel(laws: Laws, engine: str, why: str) -> Check:
    """Return the check that there is no kernel to compare with."""
    return not_checked(
        level="L1", quantity=f"{laws.name}: collisions", left=engine, right=kernel_of(engine),
        tolerance=TOLERANCE, why=why,
    )


def exits(laws: Laws, engine: str, run: Trajectory) -> list[Exit]:
    """Return what the bodies left with, where a tabulated closed form says what that should be."""
    values = [v for v in published_values().values() if v.quantity.startswith(f"{laws.name}: ")]
    found = [MEASURES[v.quantity.removeprefix(f"{laws.name}: ")](run) for v in values]
    return [Exit(laws=laws.name, engine=engine, value=v, found=f) for v, f in zip(values, found, strict=True)]


def exit_check(one: Exit, rerun: str) -> Check:
    """Return the check of one exit value."""
    return judged(
        level="L1", quantity=one.value.quantity, left=one.engine, right=one.value.name, deviation=one.deviation,
        tolerance=one.value.tolerance, rerun=rerun,
        why=f"{one.found:.6g}, closed form {one.value.value:.6g}; {one.value.reason}",
    )


def _restitution(run: Trajectory) -> float:
    return -_relative(run.frames[-1], "vx", HEAD_ON) / _relative(run.frames[0], "vx", HEAD_ON)


def _floor_restitution(run: Trajectory) -> float:
    before, after = (float(f.particles["vy"][ON_FLOOR]) for f in (run.frames[0], run.frames[-1]))
    return -after / before


def _kick(run: Trajectory) -> float:
    """Relative tangential velocity after the impact that slides to its end: there was none before."""
    return _relative(run.frames[-1], "vy", SLIDING)


def _relative(frame: Snapshot, name: str, first: int) -> float:
    """Velocity of a body relative to the next one."""
    return float(frame.particles[name][first] - frame.particles[name][first + 1])


MEASURES: Mapping[str, Callable[[Trajectory], float]] = {
    "restitution": _restitution, "restitution on a floor": _floor_restitution, "velocity gained by sliding": _kick,
}
"""By the second half of a value's `quantity`."""
