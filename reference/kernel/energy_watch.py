"""A closed run is watched: energy that its contacts make out of nothing.

Nothing works on a closed system, whose walls and rings stand still or carry a constant load. So its energy, less what
the leapfrog's own keeps in its place (Hairer, Lubich & Wanner, Acta Numerica 12, 399 (2003))::

    H = E_kin + E_rot + U_n + U_t - sum m g.x + sum_walls (m d'^2/2 - load d) - dt^2/8 sum (F^2/m + T^2/I)

can only fall: dashpots, drag and sliding take. What it has risen above its least value so far is `made`, and is found
whatever the reason, unless dashpots spend it. Three reasons are known:

    Mindlin's spring    its stiffness follows the overlap without a normal force that answers, so U_t = S_t xi^2/2 grows
                        with dS_t/dt xi^2/2 for free (Elata & Berryman, Mech. Mater. 24, 229 (1996)). In an undamped
                        lattice that vibrates by a tenth of its overlaps motions grow thirtyfold in 9e4 steps of
                        t_c/50, in the same time at half and at twice the step, not at restitution 0.999 (measured)
    the second-order    `reference.kernel.corrected` is not symplectic: in an undamped lattice with friction springs of
    scheme              0.8 k_n energy grows by 0.77 in 8000 steps of t_c/50, by 0.02 at half the step (measured)
    a step too long     for stiffnesses that nobody foresaw

A run that has made more than MOST of the largest kinetic energy so far is stopped; from WORTH_SAYING on it says so at
its end. Where nothing but contacts could stop the centre of mass, without walls and rings, its motion does not count.
The kernel in the convention of a code goes on, as that code does, and says so at its end.

Driven walls and rings do work that only their histories tell, and laws with plastic overlap store what their overlap
does not tell: such runs are not watched here (`grainproof run --watch` follows them from what is recorded).
"""

from __future__ import annotations

import numpy as np

from reference.kernel.conventions import CODES
from reference.kernel.guards import FAMILIES, KernelUnstable, friction_of
from reference.kernel.interactions import Forces, Interaction
from reference.kernel.late_springs import late_families
from reference.kernel.laws.mindlin import MindlinSliding
from reference.kernel.model import Fixed, Loaded, Model, Wall
from reference.kernel.simulation import Simulation
from reference.kernel.state import State
from reference.kernel.vectors import dot

LOOKS, LOOK_EVERY = 20, 2000
"""Looks at a run, and the most steps between two: 1 % of a long run's time (2000 discs)."""

WORTH_SAYING, MOST = 0.1, 0.5
"""Of the largest kinetic energy: what a run says that it has made, and what it is stopped for."""

ROUNDING = 1e-10
"""Of all parts of the energy: what is none."""


def is_closed(model: Model) -> bool:
    """Return whether nothing works on the system, and its laws tell what they store."""
    still = all(ring.omega is None for ring in model.rings) and all(_stands(w) for w in model.walls)
    stores = (law for f in FAMILIES if (law := getattr(model, f)) is not None and law.memory_rows(model.dimension))
    return still and all(hasattr(law, "energy") for law in (model.normal, *stores))


def _stands(wall: Wall) -> bool:
    motion = wall.motion
    return isinstance(motion, Fixed) or isinstance(motion, Loaded) and motion.stress == 0.0


def energies(simulation: Simulation) -> tuple[float, tuple[float, ...]]:
    """Return the kinetic energy that contacts can turn into others, and all parts of H, in J.

    Without walls and rings that is the one relative to the centre of mass.
    """
    model, state = simulation.model, simulation.state
    n = model.particle_count
    v, spin, force = state.v[:, :n], state.spin[:, :n], state.force[:, :n]
    kinetic = _half(model.mass, v) + _half(model.inertia, spin)
    parts = [kinetic, *_stored(simulation)]
    parts.append(-model.dt**2 / 4.0 * _half(1.0 / model.mass, force))
    if state.torque is not None:
        parts.append(-model.dt**2 / 4.0 * _half(1.0 / model.inertia, state.torque[:, :n]))
    if model.gravity is not None:
        parts.append(-float((np.asarray(model.gravity)[:, None] * model.mass * state.x[:, :n]).sum()))
    parts += [part for k, wall in enumerate(model.walls) for part in _of_wall(wall, k, state, model.dt)]
    return kinetic - _carried(model, v), tuple(parts)


def _carried(model: Model, v: np.ndarray) -> float:
    """Return the kinetic energy of the centre of mass where nothing could stop it; walls and rings could."""
    if model.walls or model.rings:
        return 0.0
    momentum = (model.mass * v).sum(axis=1)
    return 0.5 * float(momentum @ momentum) / float(model.mass.sum())


def _of_wall(wall: Wall, k: int, state: State, dt: float) -> tuple[float, ...]:
    motion = wall.motion
    if isinstance(motion, Fixed):
        return ()
    pushed = motion.load + float(state.wall_force[:, k] @ state.wall_normal[:, k])
    rate, d = float(state.wall_rate[k]), float(state.wall_d[k])
    return 0.5 * motion.mass * rate**2, -motion.load * d, -(dt**2) / 8.0 * pushed**2 / motion.mass


def _half(weight: np.ndarray, vectors: np.ndarray) -> float:
    return 0.5 * float((weight * dot(vectors, vectors)).sum())


def _stored(simulation: Simulation) -> list[float]:
    """Return what the springs of all contacts hold."""
    found = []
    for interaction, forces in simulation.contacts():
        found.append(float(interaction.normal.energy(forces.contact).sum()))
        families = (f for f in FAMILIES if getattr(interaction, f) is not None and forces.memory.get(f) is not None)
        found += [float(_held(interaction, forces, family).sum()) for family in families]
    return found


def _held(interaction: Interaction, forces: Forces, family: str) -> np.ndarray:
    """Return min(U, (mu f)^2/2k), (M,), in J: a sliding spring that carries mu f together with a dashpot is longer."""
    law, c = getattr(interaction, family), forces.contact
    limit = friction_of(law, family, c) * interaction.pressing(c, forces.f_n, forces.elastic).base
    return np.minimum(law.energy(c, forces.memory[family]), limit**2 / (2.0 * law.spring(c)[0]))


class EnergyWatch:
    """Watches a closed run: `look` at the start and then from time to time.

    made: J, by how much H is above its least value. share: the largest of it over the largest kinetic energy.
    """

    def __init__(self, model: Model, steps: int):
        """steps: of the run."""
        self.model, self._steps, self._step = model, steps, -1
        self._least, self._kinetic, self.made, self.share = np.inf, 0.0, 0.0, 0.0

    @property
    def next_look(self) -> int | None:
        """The step at which to look next; None when the run has ended."""
        if self._step < 0:
            return 0
        every = max(min(LOOK_EVERY, self._steps // LOOKS), 1)
        return min(self._step + every, self._steps) if self._step < self._steps else None

    def look(self, simulation: Simulation) -> None:
        """Compare the energy of now with the least so far. Raises KernelUnstable."""
        kinetic, parts = energies(simulation)
        self._step, now = simulation.state.step, sum(parts)
        self._least, self._kinetic = min(self._least, now), max(self._kinetic, kinetic)
        self.made = now - self._least
        if self.made <= ROUNDING * sum(map(abs, parts)):
            return
        self.share = max(self.share, self.made / self._kinetic if self._kinetic > 0.0 else np.inf)
        if self.share > MOST and self.model.convention.name not in CODES:
            raise KernelUnstable(f"step {self._step}: {self._says()}")

    def warning(self) -> str | None:
        """Return what a run that went to its end has to say, in one line; None if that is nothing."""
        return None if self.share < WORTH_SAYING else self._says()

    def _says(self) -> str:
        return (
            f"contacts have made energy out of nothing, {self.share:.3g} of the largest kinetic energy: "
            f"{_reason(self.model)}"
        )

    # --- to go on in another process -----------------------------------------------------------

    def kept(self) -> dict[str, np.ndarray]:
        """Return what the coming looks depend on, as arrays by name, for `take`."""
        return {"energy_watch": np.array([self._step, self._least, self._kinetic, self.made, self.share])}

    def take(self, kept: dict[str, np.ndarray]) -> None:
        """Go on from what `kept` returned."""
        step, self._least, self._kinetic, self.made, self.share = kept["energy_watch"].tolist()
        self._step = int(step)


def _reason(model: Model) -> str:
    """Return what may be the reason, and what helps."""
    may_be = []
    if late_families(model):
        may_be.append("the talks' algorithm feels springs one step late: take more of their damping or a smaller step")
    if isinstance(model.sliding, MindlinSliding):
        may_be.append("Mindlin's spring follows the overlap and has no potential: take a lower restitution")
    if model.convention.scheme != "leapfrog":
        may_be.append("the second-order scheme needs dashpots where contacts last: take more of them or a smaller step")
    return ", or ".join(may_be) or "the step is too long for these contacts: take a smaller one"
