"""The neighbour search: no contact is missed, memory stays bounded whatever the grains do."""

from __future__ import annotations

import math

from harness.engines.facts import loaded_walls
from harness.engines.glued import exclusion_lines, glued
from harness.engines.lammps.box import Box
from harness.engines.lammps.packing import carrier_type
from harness.engines.text import number
from harness.scene.system import System

DEFAULT_ONE = 2000
"""Neighbours of one atom LAMMPS has room for; beyond it dies without a message."""
SKIN = 0.1
"""Skin over the largest radius. Lists are checked every step and rebuilt after half a skin of motion."""


def neighbour_lines(system: System, box: Box) -> list[str]:
    """Return search style, rebuild rule, and the exclusion of wall carriers and pairs of glued discs.

    A box with an open side is too large for bins: all pairs are searched (some ms for 2000 grains).
    """
    skin = SKIN * float(system.particles.radius.max())
    lines = [
        f"neighbor {number(skin)} {'nsq' if box.is_open else 'bin'}",
        "neigh_modify delay 0 every 1 check yes",
    ]
    most = most_neighbours(system, skin)
    if most > DEFAULT_ONE:
        lines.append(f"neigh_modify one {most} page {10 * most}")
    if loaded_walls(system):
        carrier = carrier_type(system)
        lines += [f"neigh_modify exclude type {t} {carrier}" for t in range(1, carrier + 1)]
    return lines + exclusion_lines(system)


def most_neighbours(system: System, skin: float) -> int:
    """Bound the neighbours of one grain: all of them with images, or as many as the space around holds.

    The largest grain sees centres up to R + R_max + skin; twice the smallest discs (spheres) that
    fit there leave room for overlaps. Glued discs may lie anywhere.
    """
    radius, discs = system.particles.radius, glued(system)
    smallest, largest = float(radius.min()), float(radius.max())
    images = 3 ** sum(1 for length in system.periodic or () if length > 0)
    around = 2 * math.ceil(((2 * largest + smallest + skin) / smallest) ** system.dimension)
    return min(len(radius) * images, around) + len(discs)
