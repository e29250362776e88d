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

SlipNormal = Literal["end", "middle"]
"""Which normal the slip velocity of a step is measured with, in 3D: that of the step's end or of its middle."""

Algorithm = Literal["lammps", "lammps_twisting", "liggghts", "talk"]
"""How a spring sticks and slides: `reference.kernel.laws.slider`."""


@dataclass(frozen=True, kw_only=True)
class Convention:
    """One code's choices.

    slip_arm, torque_arm: lever arm of the slip velocity and of the torque, at a particle contact.
    wall_slip_arm, wall_torque_arm: the same at a wall.
    slip_normal: forces of the leapfrog see the velocities of the half step. "end" measures their slip with the normal
    n of the step's end, u = v_t - T x n (v_t: of the centres, across n; T = a_i omega_i + a_j omega_j). "middle" turns
    n back by half a step, to n - dt/2 n' with n' = v_t/|d| at a branch d, and takes the part of v - T x (n - dt/2 n')
    across n, which is::

        u = v_t - (T + dt/2 (T.n) v_t/|d|) x n

    A body that turns as one with Omega slips nowhere. Measured at the end it slips by dt/2 Omega^2 |d| sin a cos a at a
    branch at an angle a to the axis, always the same way in the body, and springs wind up with it; measured in the
    middle, with the spins sin(Omega dt)/dt of a turn in steps, by Omega dt/2 cos a of that.
    In the plane T.n = 0, and both are one: 2D has no such choice. The normal of a plane wall does not turn.
    Relative spins, by which rolling and torsion go, vanish in such a turn whatever the normal.
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
    slip_normal: SlipNormal
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
    slip_normal="end", sliding="lammps", rolling="lammps", torsion="lammps_twisting", limit="absolute",
    viscous_limit="base", rolling_frame="contact", constant_rolling="talk", wall_spin="whole",
)
"""pair granular and fix wall/gran granular, wheel 2025.7.22.4.0, as run."""

LIGGGHTS = Convention(
    name="liggghts", slip_arm="reduced", torque_arm="reduced", wall_slip_arm="reduced",
    wall_torque_arm="reduced", slip_normal="end",
    sliding="liggghts", rolling="liggghts", torsion="liggghts", limit="absolute",
    viscous_limit="total", rolling_frame="space", constant_rolling="liggghts", wall_spin="raised",
)
"""LIGGGHTS-PUBLIC 3.8.0, as run."""

TALK = Convention(
    name="talk", slip_arm="reduced", torque_arm="reduced", wall_slip_arm="reduced",
    wall_torque_arm="reduced", slip_normal="middle",
    sliding="talk", rolling="talk", torsion="talk", limit="pressing",
    viscous_limit="base", rolling_frame="contact", constant_rolling="talk", wall_spin="whole",
)
"""S. Luding, Granular Matter 10, 235 (2008): test force, sticking / sliding, spring rescaled. The paper's slip is that
of one moment; in the leapfrog the normal of the middle goes with the velocities of the half step."""

CORRECTED = replace(
    TALK, name="corrected", slip_normal="end", sliding="lammps", rolling="lammps", torsion="lammps", scheme="corrected")
"""The laws of the talks in a second-order scheme; springs are stretched before they are tested. Its velocities are
those of the step's end, as the normal is."""

CONVENTIONS = {c.name: c for c in (LAMMPS, LIGGGHTS, TALK)}
"""What codes and talks do."""

CODES = (LAMMPS.name, LIGGGHTS.name)
"""Conventions that do as a code does, whatever comes of it."""

NAMED = CONVENTIONS | {CORRECTED.name: CORRECTED}
"""All that a deck can name."""
