"""A law measured back: two spheres driven along the cycle on every code that has the law, fitted like a measurement.

The law has no rate in it, so that the speed of the drive is anything; only the order of the overlaps counts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.protocol import Prescribed
from harness.scene.contact import HystereticNormal
from harness.scene.system import INERTIA_FACTOR, Particles, System
from harness.studies.laws.cases import Laws
from harness.studies.laws.drive import Driven, Driver, Job
from harness.studies.reproduce.contact.curves import Cycle

if TYPE_CHECKING:
    from harness.engines.protocol import Engine

ROWS = 240
"""Of the drive: half in, half back."""

BEYOND = 0.25
"""How far the spheres are apart at the start and at the end, over the largest overlap."""

SHARE = 0.5
"""Rows lie so far between simple fractions of the path that none is at overlap zero or at a kink."""


@dataclass(frozen=True, kw_only=True)
class Spheres:
    """Two equal spheres: radius (m) and density (kg/m^3)."""

    radius: float
    density: float

    @property
    def mass(self) -> float:
        """4/3 pi rho R^3, kg."""
        return float(4 / 3 * np.pi * self.density * self.radius**3)


@dataclass(frozen=True, kw_only=True, eq=False)
class Indenter:
    """Sphere 1 driven against sphere 2 at rest, to the overlap `largest` (m) and back."""

    spheres: Spheres
    largest: float
    partner: str = "pair"
    dimension: int = 3

    @property
    def overlap(self) -> np.ndarray:
        """Overlaps of rows 0..ROWS, m; negative apart."""
        rise = (np.arange(ROWS // 2 + 1) + SHARE) / (ROWS // 2 + SHARE)
        way = -BEYOND + (1 + BEYOND) * rise
        return self.largest * np.concatenate([way, way[-2::-1]])

    @property
    def path(self) -> Prescribed:
        """Places, velocities and spins of both, row by row."""
        x, dt = np.zeros((ROWS + 1, 2, 3)), self.dt
        x[:, 0, 0] = 2 * self.spheres.radius - self.overlap
        v = np.zeros_like(x)
        v[1:] = np.diff(x, axis=0) / dt
        return Prescribed(x=x, v=v, spin=np.zeros_like(x))

    @property
    def dt(self) -> float:
        """Seconds between rows: the drive is at 1 mm/s on average."""
        return float(2 * (1 + BEYOND) * self.largest / ROWS / 1e-3)

    def system(self, laws: Laws, name: str) -> System:
        """Return the system of the two spheres with these laws."""
        path, two = self.path, np.ones(2)
        particles = Particles(
            x=path.x[0], v=path.v[0], spin=path.spin[0], radius=self.spheres.radius * two,
            mass=self.spheres.mass * two, inertia_factor=INERTIA_FACTOR["sphere"] * two,
        )
        return System(
            dimension=3, particles=particles, walls=(), **laws.tables(), background=None, gravity=None, periodic=None,
            dt=self.dt, steps=ROWS, sample_every=ROWS, frame_every=ROWS, contacts=False, scene_name=name,
            title="two spheres driven along a measured cycle",
        )

    def cycle(self, driven: Driven) -> Cycle:
        """Return what a code answered as a measurement: displacement is the overlap, force that on sphere 1."""
        return Cycle(displacement=self.overlap[1:], force=driven.reaction.force[:, 0, 0], error=None)


def law_of(k_1: float, k_2: float, k_c: float) -> HystereticNormal:
    """Return the law of a scene."""
    return HystereticNormal(
        loading_stiffness=float(k_1), unloading_stiffness=float(k_2), adhesion_stiffness=float(k_c), normal_damping=0.0,
    )


def drive(law: HystereticNormal, indenter: Indenter, engine: Engine, driver: Driver) -> Driven:
    """Return what became of the cycle on one engine."""
    laws = Laws(name="hysteretic_fitted", normal=law, dimensions=(3,))
    return driver.drive(Job(laws=laws, engine=engine, arrangement=indenter))
