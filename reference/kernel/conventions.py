"""Named variants of what the literature leaves open, one for each code and one for the talks.

Two codes that both "have Coulomb friction with a spring" differ in where the slip is measured, in
what the Coulomb limit is tested on, and in how the spring follows the turning contact. Each choice
is a field here, so that every code can be matched to round-off and their physical difference can
then be measured with one kernel.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

Arm = Literal["radius", "reduced"]
"""Lever arm at a contact: the radius R, or R - overlap/2 up to the contact plane."""

Algorithm = Literal["lammps", "lammps_twisting", "liggghts", "talk"]
"""How a spring sticks and slides: `reference.kernel.laws.slider`."""


@dataclass(frozen=True, kw_only=True)
class Convention:
    """One code's choices.

    slip_arm, torque_arm: lever arm of the slip velocity and of the torque, at a particle contact.
    wall_slip_arm, wall_torque_arm: the same at a wall.
    sliding, rolling, torsion: which algorithm of `reference.kernel.laws.slider` moves the spring.
    limit: friction is limited by mu |f_n| or by mu max(f_n, 0).
    viscous_limit, rolling_frame, constant_rolling: choices of `laws.viscous`, `laws.rolling`, `laws.constant_rolling`.
    scheme: the codes' leapfrog with half-step velocities in the forces, or `reference.kernel.corrected`.
    wall_spin: how fast a particle is taken to roll on a wall: "whole", its spin; "raised", that times
    (R - overlap/2)/(R - overlap).
    """

    name: str
    slip_arm: Arm
    torque_arm: Arm
    wall_slip_arm: Arm
    wall_torque_arm: Arm
    sliding: Algorithm
    rolling: Algorithm
    torsion: Algorithm
    limit: Literal["absolute", "pressing"]
    viscous_limit: Literal["base", "total"]
    rolling_frame: Literal["contact", "space"]
    constant_rolling: Literal["talk", "liggghts"]
    wall_spin: Literal["whole", "raised"]
    scheme: Literal["leapfrog", "corrected"] = "leapfrog"


LAMMPS = Convention(
    name="lammps", slip_arm="radius", torque_arm="reduced", wall_slip_arm="radius", wall_torque_arm="radius",
    sliding="lammps", rolling="lammps", torsion="lammps_twisting", limit="absolute",
    viscous_limit="base", rolling_frame="contact", constant_rolling="talk", wall_spin="whole",
)
"""pair granular and fix wall/gran granular, wheel 2025.7.22.4.0, as run."""

LIGGGHTS = Convention(
    name="liggghts", slip_arm="reduced", torque_arm="reduced", wall_slip_arm="reduced",
    wall_torque_arm="reduced", sliding="liggghts", rolling="liggghts", torsion="liggghts", limit="absolute",
    viscous_limit="total", rolling_frame="space", constant_rolling="liggghts", wall_spin="raised",
)
"""LIGGGHTS-PUBLIC 3.8.0, as run."""

TALK = Convention(
    name="talk", slip_arm="reduced", torque_arm="reduced", wall_slip_arm="reduced",
    wall_torque_arm="reduced", sliding="talk", rolling="talk", torsion="talk", limit="pressing",
    viscous_limit="base", rolling_frame="contact", constant_rolling="talk", wall_spin="whole",
)
"""S. Luding, Granular Matter 10, 235 (2008): test force, sticking / sliding, spring rescaled."""

CORRECTED = replace(TALK, name="corrected", sliding="lammps", rolling="lammps", torsion="lammps", scheme="corrected")
"""The laws of the talks in a second-order scheme; springs are stretched before they are tested."""

CONVENTIONS = {c.name: c for c in (LAMMPS, LIGGGHTS, TALK)}
"""What codes and talks do."""

NAMED = CONVENTIONS | {CORRECTED.name: CORRECTED}
"""All that a deck can name."""
