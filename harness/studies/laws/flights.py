"""Whole collisions that the kernel cannot compute, stepped by themselves: bodies that hold on beyond overlap zero."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.scene.contact import JkrNormal
from harness.studies.laws.motions import Grains
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory
from reference.analytic.central_flight import JkrGrip, flight
from reference.analytic.prescribed import ElasticPair

if TYPE_CHECKING:
    from harness.scene.system import System
    from harness.studies.laws.cases import Laws


def flown(laws: Laws, system: System) -> Trajectory | None:
    """Return the trajectory of pairs with a JKR contact and no friction; None for other laws and for walls."""
    if not isinstance(laws.normal, JkrNormal) or laws.sliding or laws.rolling or laws.torsion or system.walls:
        return None
    start, grains = system.particles, laws.grains
    x, v = flight(
        _pairs(start.x), _pairs(start.v), mass=np.array(grains.masses), reach=sum(grains.radii),
        force=_grip(laws.normal, grains), dt=system.dt, steps=system.steps, every=system.frame_every,
    )
    steps = tuple(range(0, system.steps + 1, system.frame_every))
    frames = tuple(_frame(system, step, *of) for step, *of in zip(steps, x, v, strict=True))
    return Trajectory(frames=frames, steps=steps, series=None)


def _pairs(vectors: np.ndarray) -> np.ndarray:
    """Body 2k is i, body 2k + 1 is j of pair k."""
    return vectors.reshape(-1, 2, 3)


def _grip(law: JkrNormal, grains: Grains) -> JkrGrip:
    pair = ElasticPair(
        youngs_modulus=law.youngs_modulus, poisson_ratio=law.poisson_ratio,
        effective_radius=grains.reduced_radius("pair"),
    )
    return JkrGrip(pair=pair, surface_energy=law.surface_energy, damping=law.normal_damping)


def _frame(system: System, step: int, x: np.ndarray, v: np.ndarray) -> Snapshot:
    """Without friction spins stay what they were."""
    vectors = {"": x.reshape(-1, 3), "v": v.reshape(-1, 3), "w": system.particles.spin}
    columns = {f"{k}{axis}": values[:, n] for k, values in vectors.items() for n, axis in enumerate("xyz")}
    columns |= {"id": np.arange(1, len(x) * 2 + 1), "radius": system.particles.radius}
    return Snapshot(time=step * system.dt, dimension=3, particles=Columns(columns, "particles"))
