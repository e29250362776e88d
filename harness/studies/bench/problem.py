"""From a case and a number of particles to the system that all codes get."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from harness.scene.grains import Pair
from harness.scene.laws import head_on
from harness.scene.system import INERTIA_FACTOR, Particles, System, Wall
from harness.studies.bench.cases import MASS, MEAN_RADIUS, Case
from harness.studies.bench.packing import BenchPacking, bench_packing

STEPS_A_CONTACT = 50
"""Time steps in pi sqrt(m*/k) of the stiffest branch."""


def problem(case: Case, count: int, *, cache: Path) -> tuple[System, BenchPacking]:
    """Return the case's system of `count` particles, and the packing it came from."""
    packing = bench_packing(case.dimension, count, walls=case.walls, cache=cache)
    sides = MEAN_RADIUS * packing.box
    system = System(
        dimension=case.dimension, particles=_particles(case, packing),
        walls=_walls(sides) if case.walls else (), normal=case.normal, sliding=case.sliding, rolling=case.rolling,
        background=case.background, gravity=_gravity(case), periodic=None if case.walls else tuple(sides.tolist()),
        dt=time_step(case), steps=1, sample_every=1, frame_every=1, contacts=False,
        scene_name=case.name, title=f"{count} particles",
    )
    return system, packing


def time_step(case: Case) -> float:
    """Return pi sqrt(m*/k)/STEPS_A_CONTACT, s, k the largest stiffness of the normal law."""
    pair = Pair(name="pair", reduced_mass=0.5 * MASS, reduced_radius=0.5 * MEAN_RADIUS)
    stiffness = head_on(case.normal, pair).stiffness
    return math.pi * math.sqrt(pair.reduced_mass / stiffness) / STEPS_A_CONTACT


def _particles(case: Case, packing: BenchPacking) -> Particles:
    """Discs in 2D, spheres in 3D: the moments of inertia that every code has. Velocities are random, spins zero."""
    count, dim = packing.x.shape
    kind = "disc" if dim == 2 else "sphere"
    rng = np.random.default_rng([count, dim, 1])
    return Particles(
        x=MEAN_RADIUS * packing.x, radius=MEAN_RADIUS * packing.radius, mass=np.full(count, MASS),
        inertia_factor=np.full(count, INERTIA_FACTOR[kind]), v=case.speed * rng.standard_normal((count, dim)),
        spin=np.zeros((count, 1 if dim == 2 else 3)),
    )


def _walls(sides: np.ndarray) -> tuple[Wall, ...]:
    """A box at the origin; rough, which counts only where the laws can turn particles."""
    names = ("left", "right", "bottom", "top", "front", "back")
    made = []
    for k, name in enumerate(names[: 2 * len(sides)]):
        axis, end = np.eye(len(sides))[k // 2], k % 2
        point, normal = end * axis * sides, (1 - 2 * end) * axis
        made.append(Wall(
            index=k + 1, name=name, point=tuple(point.tolist()), normal=tuple(normal.tolist()), friction=True
        ))
    return tuple(made)


def _gravity(case: Case) -> tuple[float, ...] | None:
    return None if not case.gravity else (0.0, -case.gravity, 0.0)[: case.dimension]
