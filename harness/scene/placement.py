"""Where particles may start: checked on the resolved system, reported where they were written."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.scene.fault import Fault, show
from harness.scene.model import Body
from harness.scene.system import System

COINCIDENT = 1e-9
"""Centres closer than this part of the sum of radii have no direction to push along."""


@dataclass(frozen=True, kw_only=True)
class Origin:
    """The file in which particles were written, and the place of each: ``bodies[3]`` or ``line 12``.

    separator stands between a place and a key of the particle.
    """

    file: Path
    places: Sequence[str]
    separator: str = ", "

    def at(self, index: int, key: str) -> str:
        """Return the place of a key of one particle."""
        return f"{self.places[index]}{self.separator}{key}"


def component_faults(bodies: Sequence[Body], dimension: int, origin: Origin) -> Iterator[Fault]:
    """Yield vectors of particles with too few or too many components; a spin has 1 in 2D, 3 in 3D."""
    wanted = {"position": dimension, "velocity": dimension, "spin": 1 if dimension == 2 else 3}
    for i, body in enumerate(bodies):
        for key, count in wanted.items():
            vector = getattr(body, key)
            if vector is not None and len(vector) != count:
                yield Fault(
                    place=origin.at(i, key), got=f"{len(vector)}: {show(vector)}",
                    expected=f"{count} component{'s' * (count > 1)}, as dimension = {dimension}",
                )


def inside_periodic_box(system: System, origin: Origin) -> Iterator[Fault]:
    """A periodic box starts at the origin and fits two particles side by side with their images."""
    for axis, length in enumerate(system.periodic or ()):
        if not length:
            continue
        least = 4 * float(system.particles.radius.max())
        if length < least:
            yield Fault(
                place="periodic", got=f"{length:g}", fix="else two particles touch twice",
                expected=f"a length >= {least:g} (twice the largest diameter) along {'xyz'[axis]}",
            )
        x = system.particles.x[:, axis]
        for i in np.flatnonzero((x < 0) | (x >= length))[:1]:
            yield Fault(
                place=origin.at(i, "position"), got=f"{x[i]:g}",
                expected=f"{'xyz'[axis]} from 0 to below the periodic length {length:g}",
            )


def before_the_walls(system: System, origin: Origin) -> Iterator[Fault]:
    """Every centre lies on the side of a wall that its normal points to."""
    for wall in system.walls:
        height = (system.particles.x - wall.point) @ np.array(wall.normal)
        for i in np.flatnonzero(height <= 0)[:1]:
            yield Fault(
                place=origin.at(i, "position"), got=f"{show(system.particles.x[i].tolist())}, "
                f"{-height[i]:.3g} m behind it", fix="move the particle or turn the normal round",
                expected=f'a centre in front of the wall "{wall.name}"',
            )


def centres_apart(system: System, origin: Origin) -> Iterator[Fault]:
    """Two centres at one place give a contact without a normal."""
    for i, j in coincident_pairs(system.particles.x, system.particles.radius, system.periodic):
        yield Fault(
            place=origin.at(j, "position"), expected=f"a centre apart from that of {origin.places[i]}",
            got=f"{show(system.particles.x[j].tolist())} for both",
        )


PLACEMENT_CHECKS: tuple[Callable[[System, Origin], Iterator[Fault]], ...] = (
    inside_periodic_box, before_the_walls, centres_apart,
)


def check_placement(system: System, origin: Origin) -> None:
    """Raise InputError for the first particle that starts where it may not."""
    for check in PLACEMENT_CHECKS:
        for fault in check(system, origin):
            raise fault.error(origin.file)


def coincident_pairs(x: np.ndarray, radius: np.ndarray, periodic=None) -> list[tuple[int, int]]:
    """Return index pairs (i < j) of centres x (N, dim) that lie within round-off of each other."""
    from scipy.spatial import cKDTree

    tree = cKDTree(x, boxsize=periodic)
    near = tree.query_pairs(COINCIDENT * 2 * float(radius.max()), output_type="ndarray")
    apart = x[near[:, 0]] - x[near[:, 1]]
    if periodic is not None:
        lengths = np.array(periodic)
        apart -= lengths * np.round(np.divide(apart, lengths, out=np.zeros_like(apart), where=lengths > 0))
    limit = COINCIDENT * radius[near].sum(axis=1)
    return sorted((int(i), int(j)) for i, j in near[np.linalg.norm(apart, axis=1) <= limit])
