"""The step: velocity Verlet with the half-step velocities of the codes in the contact forces.

    v += dt/2 f/m ;  x += dt v ;  omega += dt/2 T/I
    walls and rings move on ;  candidates are renewed if anything could have been missed
    f, T = forces(x, v(n+1/2), omega(n+1/2)), memories move on by dt
    v += dt/2 f/m ;  omega += dt/2 T/I

This is the order of LAMMPS' and LIGGGHTS' `fix nve/sphere`. Velocity-dependent forces see the
half-step velocity, which makes the scheme first order where there is damping or friction.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.guards import KernelUnstable, refuse_centres_inside, refuse_leaps
from reference.kernel.interactions import Forces, Interaction
from reference.kernel.laws.contact import Touching
from reference.kernel.model import Model
from reference.kernel.state import initial_state
from reference.kernel.walls import MovingWalls

SKIN_IN_RADII = 0.1
"""Skin of the candidate list in units of the mean radius: results do not depend on it."""


class Simulation:
    """A running system; `advance()` makes one step.

    Raises KernelUnstable when a particle centre passes a wall or gets inside another body, when a particle moves
    through another in one step (`reference.kernel.guards`), and when a number is no longer finite.
    """

    def __init__(self, model: Model, *, skin: float | None = None):
        self.model = model
        self.state = initial_state(model)
        self.skin = SKIN_IN_RADII * float(model.radius.mean()) if skin is None else skin
        self.rebuilds = 0
        n = model.particle_count
        self.walls = MovingWalls(model, self, self.state)
        self._turning_rings = tuple(
            (part, ring) for part, ring in zip(model.ring_nodes, model.rings, strict=True) if ring.omega is not None)
        self._inverse_mass = 1.0 / model.mass
        self._inverse_inertia = 1.0 / model.inertia
        self._particles = slice(0, n)
        self.interactions = _interactions(model)
        self._rebuild()
        self.evaluate(advance=False)
        self.walls.start()

    @property
    def time(self) -> float:
        """Time of the state, s."""
        return self.state.step * self.model.dt

    def advance(self, steps: int = 1) -> None:
        """Make steps of dt."""
        for _ in range(steps):
            before = self.state.x.copy()
            self._kick()
            self._drift()
            self.walls.move()
            self._turn_rings()
            self.renew_candidates()
            self.evaluate(advance=True, lag=self.model.lag)
            self.refuse_what_laws_cannot_tell(before)
            self._kick()
            self.walls.kick()
            self.walls.write(self.state)

    def contacts(self) -> list[tuple[Interaction, Forces]]:
        """Return the contacts of now, evaluated with full-step velocities; nothing is changed."""
        s = self.state
        return [(k, k.evaluate(s, s.v, s.spin, self.model.dt, advance=False)) for k in self.interactions]

    # --- the parts of a step -------------------------------------------------------------------

    def _kick(self) -> None:
        s, p, half = self.state, self._particles, 0.5 * self.model.dt
        s.v[:, p] += half * s.force[:, p] * self._inverse_mass
        if s.torque is not None:
            s.spin[:, p] += half * s.torque[:, p] * self._inverse_inertia

    def _drift(self) -> None:
        s, p = self.state, self._particles
        s.x[:, p] += self.model.dt * s.v[:, p]
        if s.turned is not None:
            s.turned += self.model.dt * s.spin[0, p]
        s.step += 1

    def _turn_rings(self) -> None:
        """Rings reach their place at the end of the step, and so do their velocities."""
        s = self.state
        for part, ring in self._turning_rings:
            s.x[:, part] = ring.places(self.time)
            s.v[:, part] = ring.velocities(s.x[:, part])

    # --- what the walls ask and tell -----------------------------------------------------------

    def shift_wall(self, k: int, point: np.ndarray, velocity: np.ndarray) -> None:
        """Put wall k at a point, (dim,), with a velocity."""
        node = self.model.particle_count + k
        self.state.x[:, node], self.state.v[:, node] = point, velocity

    def force_on_wall(self, k: int) -> np.ndarray:
        """Return the force of the particles on wall k, (dim,)."""
        return self.state.wall_force[:, k]

    # --- forces --------------------------------------------------------------------------------

    def evaluate(self, *, advance: bool, lag: float = 0.0) -> None:
        """Compute all forces and torques at the positions of now; with `advance` memories move on by dt.

        lag: the time by which velocities and spins are those of before, s.
        """
        s, m = self.state, self.model
        s.force[:] = 0.0
        if s.torque is not None:
            s.torque[:] = 0.0
        for interaction in self.interactions:
            forces = interaction.evaluate(s, s.v, s.spin, m.dt, advance=advance, lag=lag)
            interaction.remember(forces)
            interaction.last = forces
            interaction.add_to(forces, s.force, s.torque)
            if interaction.walls is not None:
                self._refuse_passed_walls(forces.contact)
        s.wall_force = s.force[:, m.wall_nodes].copy()
        if m.gravity is not None:
            s.force[:, self._particles] += np.asarray(m.gravity)[:, None] * m.mass
        if m.drag is not None:
            s.force[:, self._particles] -= m.drag * s.v[:, self._particles]

    # --- candidates ----------------------------------------------------------------------------

    def renew_candidates(self) -> None:
        """Rebuild as soon as two nodes could have closed a gap of one skin since the last build."""
        moved = np.abs(self.state.x - self._built_at).max(axis=1)
        if not 2.0 * float(np.sqrt(moved @ moved)) < self.skin:  # also true when a number is NaN
            self._rebuild()

    def _rebuild(self) -> None:
        s = self.state
        if not np.isfinite(s.x).all():
            raise KernelUnstable(f"step {s.step}: a position is no longer a finite number")
        for interaction in self.interactions:
            interaction.renew(s, self.skin)
        self._built_at = s.x.copy()
        self.rebuilds += 1

    def refuse_what_laws_cannot_tell(self, before: np.ndarray) -> None:
        """Raise after a leap from the places `before`, and when a centre is inside another body."""
        s, m = self.state, self.model
        refuse_leaps(m, before, s.x, s.radius, s.step)
        for pairs in (k.pairs for k in self.interactions if k.walls is None):
            refuse_centres_inside(m, s.x, s.radius, pairs.i, pairs.j, s.step)

    def _refuse_passed_walls(self, contact: Touching) -> None:
        """Raise when an overlap with a wall reaches the radius: beyond the centre the plane is no wall."""
        s, n = self.state, self.model.particle_count
        passed = np.flatnonzero(contact.overlap >= s.radius.take(contact.i))
        for c in passed[:1]:
            wall = self.model.walls[contact.j[c] - n].name
            raise KernelUnstable(f"step {s.step}: the centre of particle {contact.i[c] + 1} has passed wall '{wall}'")


def _interactions(model: Model) -> list[Interaction]:
    """Particles with particles, with rings, with the rough walls and with the smooth ones: those that exist."""
    rough = tuple(k for k, w in enumerate(model.walls) if w.friction and model.turns)
    smooth = tuple(k for k in range(len(model.walls)) if k not in rough)
    made = [Interaction(model, walls=None, rough=model.turns)]
    if model.rings:
        made.append(Interaction(model, walls=None, rough=model.turns, rings=True))
    if rough:
        made.append(Interaction(model, walls=rough, rough=True))
    if smooth:
        made.append(Interaction(model, walls=smooth, rough=False))
    return made
