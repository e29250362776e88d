"""How far bodies are from the exact exit values, copy by copy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from harness.studies.accuracy.phases import Phased, fastest_pair
from postproc.snapshot import Snapshot

if TYPE_CHECKING:
    from harness.scene.system import System

GAINED, LOST_MOMENTUM = 0.1, 1e-9
"""Of the kinetic energy, of the sum of all |p|: a run that gains or loses so much has no exit values."""


@dataclass(frozen=True, kw_only=True)
class Exits:
    """v (K, N, dim) in m/s, spin (K, N, 1|3) in rad/s, of K copies."""

    v: np.ndarray
    spin: np.ndarray


def exits_of(last: Snapshot, phased: Phased) -> Exits:
    """Return velocities and spins of the last frame, copy by copy."""
    axes = "xyz"[: phased.system.dimension]
    spins = ("wz",) if len(axes) == 2 else ("wx", "wy", "wz")
    shape = (len(phased.delay), phased.bodies, -1)
    return Exits(
        v=last.particles.vector(*(f"v{a}" for a in axes)).reshape(shape),
        spin=last.particles.vector(*spins).reshape(shape),
    )


def errors(got: Exits, exact: Exits, system: System, *, turns: bool) -> Mapping[str, np.ndarray]:
    """Return (K,) errors by quantity, over the largest relative speed at the start.

    velocity: rms over the bodies of |v - v_exact|. spin: of R |w - w_exact|; only where something turns bodies.
    exit: both together, root of the sum of squares.
    """
    speed, radius = fastest_pair(system), system.particles.radius[: exact.v.shape[1]]
    velocity = np.sqrt(((got.v - exact.v) ** 2).sum(axis=2).mean(axis=1)) / speed
    if not turns:
        return {"exit": velocity, "velocity": velocity}
    turned = ((got.spin - exact.spin) ** 2).sum(axis=2) * radius**2
    spin = np.sqrt(turned.mean(axis=1)) / speed
    return {"exit": np.hypot(velocity, spin), "velocity": velocity, "spin": spin}


def fault(last: Snapshot, phased: Phased) -> tuple[str, str]:
    """Return what became of a completed run that has no exit values, and why; "completed" and "" if it has."""
    p, system = phased.system.particles, phased.system
    axes = "xyz"[: system.dimension]
    x, v = (last.particles.vector(*(f"{k}{a}" for a in axes)) for k in ("", "v"))
    gained = _energy(p, v, exits_of(last, phased).spin.reshape(len(p), -1)) / _energy(p, p.v, p.spin) - 1.0
    if not gained <= GAINED:
        return "unstable", f"kinetic energy grew by {100 * gained:.3g} %"
    if not system.walls:
        moved = np.abs((p.mass[:, None] * (v - p.v)).sum(axis=0)).max()
        if not moved <= LOST_MOMENTUM * float((p.mass * np.linalg.norm(p.v, axis=1)).sum()):
            return "unstable", f"momentum changed by {moved:.3g} kg m/s"
    return ("unfinished", "bodies still touch at the end") if _touching(x, phased) else ("completed", "")


def _energy(p, v: np.ndarray, spin: np.ndarray) -> float:
    inertia = p.inertia_factor * p.mass * p.radius**2
    return float((p.mass * (v**2).sum(axis=1)).sum() + (inertia * (spin**2).sum(axis=1)).sum())


def _touching(x: np.ndarray, phased: Phased) -> bool:
    from scipy.spatial import cKDTree

    p = phased.system.particles
    near = cKDTree(x).query_pairs(2.0 * float(p.radius.max()), output_type="ndarray")
    i, j = near[:, 0], near[:, 1]
    pairs = np.linalg.norm(x[i] - x[j], axis=1) < p.radius[i] + p.radius[j]
    return bool(pairs.any()) or any(
        ((x - w.point) @ np.array(w.normal) < p.radius).any() for w in phased.system.walls
    )
