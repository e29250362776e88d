"""The step: velocity Verlet with the half-step velocities of the codes in the contact forces.

    v += dt/2 f/m ;  x += dt v ;  omega += dt/2 T/I
    walls move on ;  candidates are renewed if anything could have been missed
    f, T = forces(x, v(n+1/2), omega(n+1/2)), memories move on by dt
    v += dt/2 f/m ;  omega += dt/2 T/I

This is the order of LAMMPS' and LIGGGHTS' `fix nve/sphere`. Velocity-dependent forces see the
half-step velocity, which makes the scheme first order where there is damping or friction.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.interactions import Forces, Interaction
from reference.kernel.laws.contact import Touching
from reference.kernel.model import Constant, Fixed, Loaded, Model
from reference.kernel.state import initial_state
from reference.kernel.vectors import dot

SKIN_IN_RADII = 0.1
"""Skin of the candidate list in units of the mean radius: results do not depend on it."""


class KernelUnstable(Exception):
    """The run left what the laws can describe; the message says what and where."""


class Simulation:
    """A running system; `advance()` makes one step.

    Raises KernelUnstable when a particle centre passes a wall or a number is no longer finite.
    """

    def __init__(self, model: Model, *, skin: float | None = None):
        self.model = model
        self.state = initial_state(model)
        self.skin = SKIN_IN_RADII * float(model.radius.mean()) if skin is None else skin
        self.rebuilds = 0
        n = model.particle_count
        self._wall_point = self.state.x[:, n:].copy()
        moving = ((k, w.motion) for k, w in enumerate(model.walls) if not isinstance(w.motion, Fixed))
        self._moving_walls = tuple(moving)
        self._inverse_mass = 1.0 / model.mass
        self._inverse_inertia = 1.0 / model.inertia
        self._particles = slice(0, n)
        self.interactions = _interactions(model)
        self._rebuild()
        self.evaluate(advance=False)
        self._wall_acceleration = self._loaded_accelerations()

    @property
    def time(self) -> float:
        """Time of the state, s."""
        return self.state.step * self.model.dt

    def advance(self, steps: int = 1) -> None:
        """Make steps of dt."""
        for _ in range(steps):
            self._kick()
            self._drift()
            self._move_walls()
            self.renew_candidates()
            self.evaluate(advance=True)
            self._kick()
            self._kick_loaded_walls()

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

    def _move_walls(self) -> None:
        """Walls reach their place at the end of the step; their velocity is that of the half step."""
        s, dt = self.state, self.model.dt
        for k, motion in self._moving_walls:
            if isinstance(motion, Loaded):
                s.wall_rate[k] += 0.5 * dt * self._wall_acceleration[k]
                self._shift_wall(k, s.wall_d[k] + dt * s.wall_rate[k])
            elif isinstance(motion, Constant):
                node = self.model.particle_count + k
                s.x[:, node] = self._wall_point[:, k] + self.time * s.v[:, node]
                s.wall_d[k] = self.time * s.wall_rate[k]
            else:
                self._shift_wall(k, motion.displacement(self.time))
                s.wall_rate[k] = motion.rate(self.time)

    def _shift_wall(self, k: int, displacement: float) -> None:
        """Set the wall's displacement along its normal; its velocity is the mean one of the step."""
        s, node = self.state, self.model.particle_count + k
        mean_rate = (displacement - s.wall_d[k]) / self.model.dt
        s.wall_d[k] = displacement
        s.x[:, node] = self._wall_point[:, k] + displacement * s.wall_normal[:, k]
        s.v[:, node] = mean_rate * s.wall_normal[:, k]

    def _kick_loaded_walls(self) -> None:
        self._wall_acceleration = self._loaded_accelerations()
        for k, acceleration in self._wall_acceleration.items():
            self.state.wall_rate[k] += 0.5 * self.model.dt * acceleration

    def _loaded_accelerations(self) -> dict[int, float]:
        loaded = ((k, motion) for k, motion in self._moving_walls if isinstance(motion, Loaded))
        return {k: self._loaded_force(k, motion) / motion.mass for k, motion in loaded}

    def _loaded_force(self, k: int, motion: Loaded) -> float:
        """Return load + stress * extent + F.n - damping d', with the half-step rate d'."""
        s = self.state
        extent = 0.0 if motion.span is None else self._distance(*motion.span)
        pushed = dot(s.wall_force[:, k], s.wall_normal[:, k])
        return motion.load + motion.stress * extent + pushed - motion.damping * s.wall_rate[k]

    def _distance(self, a: int, b: int) -> float:
        """Distance of wall b from wall a along a's normal."""
        s, n = self.state, self.model.particle_count
        return dot(s.x[:, n + b] - s.x[:, n + a], s.wall_normal[:, a])

    # --- forces --------------------------------------------------------------------------------

    def evaluate(self, *, advance: bool) -> None:
        """Compute all forces and torques at the positions of now; with `advance` memories move on by dt."""
        s, m = self.state, self.model
        s.force[:] = 0.0
        if s.torque is not None:
            s.torque[:] = 0.0
        for interaction in self.interactions:
            forces = interaction.evaluate(s, s.v, s.spin, m.dt, advance=advance)
            interaction.remember(forces)
            interaction.last = forces
            interaction.add_to(forces, s.force, s.torque)
            if interaction.walls is not None:
                self._refuse_passed_walls(forces.contact)
        s.wall_force = s.force[:, m.particle_count :].copy()
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

    def _refuse_passed_walls(self, contact: Touching) -> None:
        """Raise when an overlap with a wall reaches the radius: beyond the centre the plane is no wall."""
        s, n = self.state, self.model.particle_count
        passed = np.flatnonzero(contact.overlap >= s.radius.take(contact.i))
        for c in passed[:1]:
            wall = self.model.walls[contact.j[c] - n].name
            raise KernelUnstable(f"step {s.step}: the centre of particle {contact.i[c] + 1} has passed wall '{wall}'")


def _interactions(model: Model) -> list[Interaction]:
    """Particles with particles, with the rough walls and with the smooth ones: those that exist."""
    rough = tuple(k for k, w in enumerate(model.walls) if w.friction and model.turns)
    smooth = tuple(k for k in range(len(model.walls)) if k not in rough)
    made = [Interaction(model, walls=None, rough=model.turns)]
    if rough:
        made.append(Interaction(model, walls=rough, rough=True))
    if smooth:
        made.append(Interaction(model, walls=smooth, rough=False))
    return made
