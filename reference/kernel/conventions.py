"""Named variants of what the literature leaves open, one for each code and one for the talks.

Two codes that both "have Coulomb friction with a spring" differ in where the slip is measured, in
what the Coulomb limit is tested on, and in how the spring follows the turning contact. Each choice
is a field here, so that every code can be matched to round-off and their physical difference can
then be measured with one kernel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Arm = Literal["radius", "reduced"]
"""Lever arm at a contact: the radius R, or R - overlap/2 up to the contact plane."""


@dataclass(frozen=True, kw_only=True)
class Convention:
    """One code's choices.

    slip_arm, torque_arm: lever arm of the slip velocity and of the torque, at a particle contact.
    wall_slip_arm, wall_torque_arm: the same at a wall.
    sliding: which algorithm of `reference.kernel.laws.sliding` moves the tangential spring.
    """

    name: str
    slip_arm: Arm
    torque_arm: Arm
    wall_slip_arm: Arm
    wall_torque_arm: Arm
    sliding: Literal["lammps", "liggghts", "talk"]


LAMMPS = Convention(
    name="lammps", slip_arm="radius", torque_arm="reduced", wall_slip_arm="radius", wall_torque_arm="radius",
    sliding="lammps",
)
"""pair granular and fix wall/gran granular, wheel 2025.7.22.4.0, as run."""

LIGGGHTS = Convention(
    name="liggghts", slip_arm="reduced", torque_arm="reduced", wall_slip_arm="reduced",
    wall_torque_arm="reduced", sliding="liggghts",
)
"""model hooke/stiffness tangential history of LIGGGHTS-PUBLIC 3.8.0, as run."""

TALK = Convention(
    name="talk", slip_arm="reduced", torque_arm="reduced", wall_slip_arm="reduced",
    wall_torque_arm="reduced", sliding="talk",
)
"""S. Luding, Granular Matter 10, 235 (2008): test force, sticking / sliding, spring rescaled."""

CONVENTIONS = {c.name: c for c in (LAMMPS, LIGGGHTS, TALK)}
