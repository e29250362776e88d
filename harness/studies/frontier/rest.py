"""Is a packing a state at rest under a law? Forces must balance, and no small motion may run away by itself.

A largest stable step has a meaning only there: particles that are out of balance start to move whatever the step, and
a packing that buckles leaves its state with any step, too. Pressed contacts without tangential springs push sideways
(initial stress): the stiffness matrix K of the square lattice without friction has negative eigenvalues.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.scene.system import System
from harness.studies.frontier.theory import NoTheory, linear_packing, touching
from reference.analytic.packing_modes import FIXED

BALANCED = 1e-8
"""Net force on a particle over the mean contact force, at most. The motions of a look change forces by 1e-5 of it."""

BUCKLES = 1e-9
"""Of the largest eigenvalue of M^-1 K, by which the smallest one is below 0: rounding makes 1e-14."""

ROUNDS, LONGEST = 200, 0.3
"""Of Newton's method; the longest way of a round, in mean overlaps: contacts are not lost at once."""

FREE = 1e-9
"""Of the largest eigenvalue of K: softer motions are free, and nothing pushes along them."""


def at_rest(system: System) -> System:
    """Return the system with its particles moved to where forces balance under its own normal law, if they do not.

    Walls and box stay. What is balanced already is returned as it is; what cannot be balanced as far as it got.
    """
    for _ in range(ROUNDS):
        left = residual(system)
        if left <= BALANCED or not np.isfinite(left):
            break
        system = _moved(system, _newton(system))
    return system


def unrest(system: System) -> str:
    """Return why a system is no state at rest under its laws, with the number, "" if it is one."""
    left = residual(system)
    if not left <= BALANCED:
        return (
            f"not at rest under this law: a particle feels a net force of {left:.2g} of the mean contact force, "
            f"{BALANCED:g} at most is called rest"
        )
    try:
        softest, largest = _ends(system)
    except NoTheory:
        return ""
    if softest < -BUCKLES * largest:
        return (
            f"not at rest under this law: the packing buckles under its own pressure, the smallest eigenvalue of "
            f"M^-1 K is {softest / largest:.2g} of the largest one, so that a motion grows with any step"
        )
    return ""


def residual(system: System) -> float:
    """Return the largest net force on a particle over the mean contact force, (-); infinite without contacts.

    Of the normal forces: friction springs are not stretched at the start.
    """
    force = _pressing(system)
    return float(np.linalg.norm(_net(system), axis=1).max() / force.mean()) if len(force) else np.inf


def _smooth(system: System) -> System:
    return system.with_(sliding=None, rolling=None, torsion=None)


def _pressing(system: System) -> np.ndarray:
    return linear_packing(_smooth(system)).springs.pressing


def _net(system: System) -> np.ndarray:
    """Net normal forces on the particles, (N, dim), N."""
    contacts, _ = touching(system)
    force, pairs = _pressing(system)[:, None] * contacts.normal, contacts.j != FIXED
    net = np.zeros_like(system.particles.x)
    np.add.at(net, contacts.i, force)
    np.add.at(net, contacts.j[pairs], -force[pairs])
    return net


def _newton(system: System) -> np.ndarray:
    """Return displacements (N, dim), m, towards balance: net forces over the sizes of the eigenvalues of K.

    The sizes, so that the energy falls along motions that buckle, too; free ones stay where they are.
    """
    values, modes = np.linalg.eigh(linear_packing(_smooth(system)).stiffness_matrix().toarray())
    sizes = np.abs(values)
    held = sizes > FREE * sizes.max()
    along = modes.T @ _net(system).ravel()
    ways = np.divide(along, sizes, out=np.zeros_like(along), where=held)
    way = (modes @ ways).reshape(system.particles.x.shape)
    most = LONGEST * touching(system)[1].mean()
    return way * min(1.0, most / np.linalg.norm(way, axis=1).max())


def _moved(system: System, way: np.ndarray) -> System:
    return system.with_(particles=replace(system.particles, x=system.particles.x + way))


def _ends(system: System) -> tuple[float, float]:
    """Smallest and largest eigenvalue of M^-1 K, 1/s^2. Raises NoTheory."""
    packing = linear_packing(system)
    root = np.sqrt(packing.inertias)
    values = np.linalg.eigvalsh(packing.stiffness_matrix().toarray() / np.outer(root, root))
    return float(values[0]), float(values[-1])
