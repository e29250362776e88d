"""Where particles may start: checked on the resolved system, reported where they were written."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.scene.fault import Fault, show
from harness.scene.grains import Pair
from harness.scene.laws import head_on, stiffens
from harness.scene.model import Body
from harness.scene.overlaps import initial_overlaps
from harness.scene.system import System

COINCIDENT = 1e-9
"""Centres closer than this part of the sum of radii have no direction to push along."""

DEEPEST = 0.5
"""Largest overlap at the start over the smaller radius: deeper, one body lies in the other, which is a slip."""


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


def overlaps_shallow(system: System, origin: Origin) -> Iterator[Fault]:
    """Bodies and walls may overlap at the start, but not so far that the contact laws mean nothing."""
    overlaps = initial_overlaps(system)
    deepest = DEEPEST * overlaps.smaller
    for k in np.flatnonzero(overlaps.size > deepest)[:1]:
        i, j = overlaps.first[k], overlaps.second[k]
        other = origin.places[i] if j >= 0 else f'the wall "{system.walls[-j - 1].name}"'
        yield Fault(
            place=origin.at(j if j >= 0 else i, "position"), got=f"{overlaps.size[k]:.3g} m", fix="move them apart",
            expected=f"an overlap with {other} of at most half the smaller radius, {deepest[k]:.3g} m",
        )


def overlaps_within_impact(system: System, origin: Origin) -> Iterator[Fault]:
    """Where a law stiffens, its scales are those of an impact: nothing may start pressed deeper than that."""
    if not stiffens(system.normal):
        return
    mass, radius, overlaps = system.particles.mass, system.particles.radius, initial_overlaps(system)
    for i, j, size in zip(overlaps.first, overlaps.second, overlaps.size, strict=True):
        partner = None if j < 0 else j
        pair = Pair(name="", reduced_mass=_reduced(mass, i, partner), reduced_radius=_reduced(radius, i, partner))
        deepest = head_on(system.normal, pair).largest_overlap
        if size > deepest:
            yield Fault(
                place=origin.at(i if partner is None else j, "position"), got=f"{size:.3g} m",
                expected=f"an overlap of at most {deepest:.3g} m, that of an impact at contact.normal.impact_speed",
                fix="move them apart, or raise impact_speed",
            )


def _reduced(values: np.ndarray, i: int, j: int | None) -> float:
    """Return v_i v_j/(v_i + v_j), at a wall v_i."""
    return float(values[i] if j is None else values[i] * values[j] / (values[i] + values[j]))


def centres_apart(system: System, origin: Origin) -> Iterator[Fault]:
    """Two centres at one place give a contact without a normal."""
    overlaps, radius = initial_overlaps(system), system.particles.radius
    pairs = np.flatnonzero(overlaps.second >= 0)
    first, second = overlaps.first[pairs], overlaps.second[pairs]
    reach = radius[first] + radius[second]
    for k in np.flatnonzero(reach - overlaps.size[pairs] <= COINCIDENT * reach)[:1]:
        yield Fault(
            place=origin.at(second[k], "position"), expected=f"a centre apart from that of {origin.places[first[k]]}",
            got=f"{show(system.particles.x[second[k]].tolist())} for both",
        )


Checks = tuple[Callable[[System, Origin], Iterator[Fault]], ...]

EXPLICIT: Checks = (inside_periodic_box, before_the_walls, overlaps_shallow, overlaps_within_impact)
"""For bodies that a user has placed."""

PACKED: Checks = (before_the_walls, centres_apart)
"""For packings: a file of discs may overlap as it likes, as it is relaxed first."""


def check_placement(system: System, origin: Origin, checks: Checks) -> None:
    """Raise InputError for the first particle that starts where it may not."""
    for check in checks:
        for fault in check(system, origin):
            raise fault.error(origin.file)
