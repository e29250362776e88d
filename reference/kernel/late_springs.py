"""A run that goes on is watched: what springs that are felt a step late make of the swings of its contacts.

The talks' algorithm feels tangential springs one step late (`laws.slider`), which is a dashpot of -dt k: where contacts
stick and dt > gamma/k, swings grow. `guards.refuse_late_springs` asks at step 0 for one body at a wall. It cannot ask
for Mindlin's spring, whose stiffness is that of the overlap of now, and in a packing bodies have more contacts than
one. So contacts are looked at on the way, with their stiffness of now. With

    A = dt K_l - C                              (`reference.analytic.packing_modes`)

K_l of the springs that stuck at this look and at the last, neither at the limit nor open, and C of the dashpots of all
contacts and of the drag, nothing grows in a step by more than sqrt(1 + dt lambda), lambda the largest eigenvalue of
M^-1 A, and dashpots that hold a contact's neighbours count. The motion of now gains the power v.A v.

ln sqrt(1 + dt lambda) adds up for every body over the steps between two looks, for as long as it has such a contact: a
body that slid or flew begins anew, as friction or the flight has ended its swing. Once a body passes
`guards.MOST_GROWTH` the run is stopped if

    up to EXACT degrees of freedom    some motion grows: an eigenvalue of a step of the contacts of now is beyond 1
    above                             the motion has gained energy since the count began

and otherwise, as dashpots take more than the late springs give, the count begins anew. Measured with Hertz-Mindlin
bodies: a disc between two plates swings up at the rate of lambda to 1.6 %, lattices 2 % beyond gamma/k to 1.1 %; random
packings begin to grow at steps up to a tenth larger than those at which lambda begins, and in between runs are let
pass. Where nothing can be fed a look takes what 20 to 30 steps do.

Rolling and torsion springs are those of the guard at step 0 alone; contacts shorter than the time between two looks
are not followed. Walls and glued discs count as fixed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, replace

import numpy as np

from reference.kernel.guards import MOST_GROWTH, KernelUnstable
from reference.kernel.interactions import Forces, Interaction, summed
from reference.kernel.laws.mindlin import MindlinSliding
from reference.kernel.laws.sliding import SpringSliding
from reference.kernel.model import Model
from reference.kernel.simulation import Simulation
from reference.kernel.state import State
from reference.kernel.vectors import dot, norm, spin_cross, torque_cross

LOOKS, LOOK_EVERY = 100, 1000
"""Looks at a run, and the most steps between two: collisions that are shorter go unseen."""

EXACT, GROWS = 120, 1e-6
"""Degrees of freedom up to which all eigenvalues are computed; by how much one is beyond 1 where a motion grows."""

DEEPER = 1e-6
"""Of the overlap: how much deeper a contact is for the slope of its force."""

PRECISION = 1e-4
"""Of the largest eigenvalue of larger systems, over the largest magnitude of all."""

AT_LIMIT = 1e-9
"""Of the limit: a spring that carries less than the limit by this much sticks."""


def feels_late(model: Model) -> bool:
    """Return whether contacts could ever stick on a sliding spring that is felt late and not held by its dashpot."""
    law = model.sliding
    if getattr(law, "algorithm", None) != "talk":
        return False
    return isinstance(law, MindlinSliding) or law.shear_damping < model.dt * law.shear_stiffness


@dataclass(frozen=True, kw_only=True)
class _Contacts:
    """M contacts. i, j: nodes. n: (dim, M). arm_i, arm_j: m. slope: of the normal force, N/m. along: its dashpot, kg/s.

    stiffness, damping: of the sliding spring, N/m and kg/s, 0 where there is none. sticks: whether it does.
    """

    i: np.ndarray
    j: np.ndarray
    n: np.ndarray
    arm_i: np.ndarray
    arm_j: np.ndarray
    slope: np.ndarray
    along: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    sticks: np.ndarray


class LateSprings:
    """Watches a run: `look` at the start and then from time to time.

    exponent: (N,) of what the swings of every body can have grown by since the count began; gained: the energy, J, that
    late springs and dashpots have given to the motion since then, estimated from the moments of the looks.
    """

    def __init__(self, model: Model, steps: int):
        """steps: of the run."""
        self.model, self._steps = model, steps
        self.exponent, self.gained = np.zeros(model.particle_count), 0.0
        self._stuck, self._step = np.empty(0, np.int64), -1

    @property
    def next_look(self) -> int | None:
        """The step at which to look next: LOOKS times a run at least, and at its end; None when it has ended."""
        if self._step < 0:
            return 0
        every = min(LOOK_EVERY, max(self._steps // LOOKS, 1))
        return min(self._step + every, self._steps) if self._step < self._steps else None

    def look(self, simulation: Simulation) -> None:
        """Count the steps since the last look. Raises KernelUnstable."""
        found, state = _contacts(simulation.interactions), simulation.state
        keys = np.minimum(found.i, found.j) * self.model.node_count + np.maximum(found.i, found.j)
        lasting, steps = found.sticks & np.isin(keys, self._stuck), state.step - self._step
        self._stuck, self._step = keys[found.sticks], state.step
        late = np.where(lasting, self.model.dt * found.stiffness, 0.0)
        fed = _Operator(
            self.model, found, along=-found.along, across=late - np.where(found.sticks, found.damping, 0.0),
            drag=self.model.drag or 0.0)
        self._count(fed, found, lasting, steps, state)
        if self.exponent.max(initial=0.0) <= MOST_GROWTH:
            return
        if self._grows(fed, found):
            raise KernelUnstable(self._reason(found, lasting))
        self.exponent[:], self.gained = 0.0, 0.0

    def _count(self, fed: _Operator, found: _Contacts, lasting: np.ndarray, steps: int, state: State) -> None:
        """Add the steps to the exponents of bodies with lasting contacts, and what their motion gained."""
        if (fed.across > 0.0).any():
            square = 1.0 + self.model.dt * largest_eigenvalue(fed, fed.size)
            self.exponent += 0.5 * steps * np.log(square)
            self.gained += steps * self.model.dt * fed.power(state.v, state.spin)
        held = np.zeros(self.model.node_count, bool)
        held[np.concatenate([found.i[lasting], found.j[lasting]])] = True
        self.exponent[~held[: self.model.particle_count]] = 0.0

    def _grows(self, fed: _Operator, found: _Contacts) -> bool:
        """Return whether motions grow, see above."""
        if fed.size > EXACT:
            return self.gained > 0.0
        springs = _Operator(
            self.model, found, along=found.slope, across=np.where(found.sticks, found.stiffness, 0.0), drag=0.0)
        return step_growth(springs.matrix(), fed.matrix(), self.model.dt) > 1.0 + GROWS

    def _reason(self, found: _Contacts, lasting: np.ndarray) -> str:
        held = float((found.damping[lasting] / found.stiffness[lasting]).min())
        return (
            f"step {self._step}: the talks' algorithm feels the sliding spring one step late, and dt = "
            f"{self.model.dt:.3g} s is larger than its gamma/k, {held:.3g} s by now: contacts that stick swing up, by "
            f"exp({self.exponent.max():.3g}) at most so far; take more of its damping, a smaller step, or the kernel "
            "in another convention"
        )

    # --- to go on in another process -----------------------------------------------------------

    def kept(self) -> dict[str, np.ndarray]:
        """Return what the coming looks depend on, as arrays by name, for `take`."""
        return {
            "late_exponent": self.exponent, "late_gained": np.array(self.gained), "late_stuck": self._stuck,
            "late_step": np.array(self._step),
        }

    def take(self, kept: dict[str, np.ndarray]) -> None:
        """Go on from what `kept` returned."""
        self.exponent, self._stuck = kept["late_exponent"], kept["late_stuck"]
        self._step, self.gained = int(kept["late_step"]), float(kept["late_gained"])


class _Operator:
    """x -> M^-1/2 B M^-1/2 x, v.B v the sum of `across` |slip|^2 + `along` (rate of separation)^2 - `drag` |v|^2.

    x: (size,), velocities and spins of the particles times sqrt of M. across, along: (M,).
    """

    def __init__(self, model: Model, found: _Contacts, *, along: np.ndarray, across: np.ndarray, drag: float):
        self.found, self.along, self.across, self.drag = found, along, across, drag
        self.nodes, self.dimension, self.count = model.node_count, model.dimension, model.particle_count
        turning = np.broadcast_to(model.inertia, model.spin.shape)
        self._root = np.sqrt(np.concatenate([np.broadcast_to(model.mass, model.x.shape), turning])).astype(float)

    @property
    def size(self) -> int:
        """Degrees of freedom."""
        return self._root.size

    def power(self, v: np.ndarray, spin: np.ndarray) -> float:
        """Return v.B v of velocities (dim, nodes) and spins (1|3, nodes)."""
        slip, rate = self._rates(v, spin)
        drag = self.drag * (v[:, : self.count] ** 2).sum()
        return float((self.across * dot(slip, slip)).sum() + (self.along * rate**2).sum() - drag)

    def matrix(self) -> np.ndarray:
        """Return all of it, (size, size)."""
        return np.stack([self(row) for row in np.eye(self.size)])

    def __call__(self, x: np.ndarray) -> np.ndarray:
        c, dim, n = self.found, self.dimension, self.count
        moved = np.zeros((len(self._root), self.nodes))
        moved[:, :n] = x.reshape(self._root.shape) / self._root
        slip, rate = self._rates(moved[:dim], moved[dim:])
        shear = self.across * slip
        force, couple = shear + self.along * rate * c.n, torque_cross(c.n, shear)
        fed = [summed(c.i, f, self.nodes) - summed(c.j, f, self.nodes) for f in force]
        fed += [-summed(c.i, c.arm_i * f, self.nodes) - summed(c.j, c.arm_j * f, self.nodes) for f in couple]
        total = np.stack(fed)[:, :n]
        total[:dim] -= self.drag * moved[:dim, :n]
        return (total / self._root).ravel()

    def _rates(self, v: np.ndarray, spin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return slip velocities, (dim, M), and rates of separation, (M,), of the contacts."""
        c = self.found
        apart = v.take(c.i, axis=1) - v.take(c.j, axis=1)
        rate = dot(apart, c.n)
        turning = c.arm_i * spin.take(c.i, axis=1) + c.arm_j * spin.take(c.j, axis=1)
        return apart - rate * c.n - spin_cross(turning, c.n), rate


def step_growth(springs: np.ndarray, fed: np.ndarray, dt: float) -> float:
    """Return the largest |z|, (-), of x(n) = z^n phi in the leapfrog: v += dt (A v - K x), x += dt v; all over sqrt M.

    From all eigenvalues of the map (x, dt v) -> (x, dt v) of one step. springs: K, 1/s^2; fed: A, 1/s; (D, D).
    """
    kicked, carried = -(dt**2) * springs, np.eye(len(fed)) + dt * fed
    step = np.block([[np.eye(len(fed)) + kicked, carried], [kicked, carried]])
    return float(np.abs(np.linalg.eigvals(step)).max())


def largest_eigenvalue(operator: Callable[[np.ndarray], np.ndarray], size: int) -> float:
    """Return the largest eigenvalue of a symmetric operator on vectors (size,), not below 0.

    Above EXACT by ARPACK, from random numbers that are always the same. ARPACK's error is a part of the number that it
    looks for, which is near 0 here, so all eigenvalues are moved beyond 0 first, by twice the largest magnitude.
    """
    from scipy.sparse.linalg import LinearOperator, eigsh

    if size <= EXACT:
        return max(float(np.linalg.eigvalsh(np.stack([operator(row) for row in np.eye(size)]))[-1]), 0.0)
    start = np.random.default_rng(0).normal(size=size)
    if not operator(start).any():
        return 0.0

    def end_of(matvec: Callable[[np.ndarray], np.ndarray], which: str) -> float:
        moved = LinearOperator((size, size), matvec=matvec, dtype=float)
        return float(eigsh(moved, k=1, which=which, v0=start, tol=PRECISION, return_eigenvectors=False)[0])

    beyond = 2.0 * abs(end_of(operator, "LM"))
    return max(end_of(lambda x: operator(x) + beyond * x, "LA") - beyond, 0.0)


def _contacts(interactions: Iterable[Interaction]) -> _Contacts:
    """Return the contacts that acted in the last step, as doubles."""
    each = [_of_interaction(k, k.last) for k in interactions]
    columns = {f.name: np.concatenate([getattr(c, f.name) for c in each], axis=-1) for f in fields(_Contacts)}
    return _Contacts(**{
        name: v.astype(float) if v.dtype.kind == "f" else v for name, v in columns.items()
    })


def _of_interaction(interaction: Interaction, forces: Forces) -> _Contacts:
    """Return the contacts of one kind; smooth ones have nothing but their normal forces."""
    c, law = forces.contact, interaction.sliding
    none, along = np.zeros_like(c.overlap), interaction.normal.damping(c)
    stiffness, damping = (none, none) if law is None else law.spring(c)
    arm_i, arm_j = (none, none) if law is None else (c.torque_arm_i, c.torque_arm_j)
    return _Contacts(
        i=c.i, j=c.j, n=c.n, arm_i=arm_i, arm_j=arm_j, slope=_slope(interaction, forces),
        along=none + (0.0 if along is None else along), stiffness=stiffness, damping=damping,
        sticks=_sticks(interaction, forces),
    )


def _slope(interaction: Interaction, forces: Forces) -> np.ndarray:
    """Return the slope of the elastic normal forces at the overlaps of now, (M,), N/m."""
    c, memory = forces.contact, forces.memory.get("normal")
    deeper = replace(c, overlap=c.overlap * (1.0 + DEEPER))
    here, there = (interaction.normal.elastic(k, memory)[0] for k in (c, deeper))
    return (there - here) / (DEEPER * c.overlap)


def _sticks(interaction: Interaction, forces: Forces) -> np.ndarray:
    """Return which contacts carry less than friction can, (M,)."""
    law: SpringSliding | MindlinSliding | None = interaction.sliding
    if law is None:
        return np.zeros(len(forces.f_n), bool)
    memory, c = forces.memory["sliding"], forces.contact
    if len(memory) > len(c.n):
        return memory[-1] == 0.0
    across = forces.force - dot(forces.force, c.n) * c.n
    limit = law.shear_friction * interaction.pressing(c, forces.f_n, forces.elastic).base
    return norm(across) < (1 - AT_LIMIT) * limit
