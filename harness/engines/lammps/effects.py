"""Deck lines for what acts on a grain besides contacts, and for its integration."""

from __future__ import annotations

import math

from harness.engines.lammps.packing import INTEGRATORS, kinds
from harness.engines.text import number, numbers
from harness.scene.model import Background
from harness.scene.system import System


def integration_lines(system: System) -> list[str]:
    """Return velocity Verlet: with rotation by moment of inertia, or without where nothing turns."""
    lines = ["", "# velocity Verlet; forces see the half-step velocities v(t+dt/2), w(t+dt/2)"]
    for kind, types in kinds(system).items():
        if kind == "grain":
            lines.append("fix integrate grains nve")
        else:
            of_kind = " ".join(str(t) for t in types)
            lines += [f"group {kind}s type {of_kind}", f"fix integrate_{kind}s {kind}s {INTEGRATORS[kind]}"]
    if system.dimension == 2:
        lines.append("fix flat all enforce2d")
    return [*lines, f"timestep {number(system.dt)}"]


def gravity_lines(gravity: tuple[float, ...] | None) -> list[str]:
    """Return f = m g on the grains; gravity in m/s^2."""
    if gravity is None or not any(gravity):
        return []
    size = math.hypot(*gravity)
    vector = [*(g / size for g in gravity), *[0.0] * (3 - len(gravity))]
    return ["", "# gravity", f"fix gravity grains gravity {number(size)} vector {numbers(vector)}"]


def drag_lines(background: Background | None) -> list[str]:
    """Return f = -c v on the grains, c in kg/s."""
    if background is None:
        return []
    return [
        "",
        "# drag of the surroundings, f = -c v, no torque",
        f"fix drag grains viscous {number(background.translational_drag)}",
    ]
