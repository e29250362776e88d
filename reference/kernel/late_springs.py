"""A run that goes on is watched: what springs that are felt a step late make of the swings of its contacts.

The talks' algorithm feels sliding, rolling and torsion springs one step late (`laws.slider`), which is a dashpot of
-dt k: where contacts stick and dt > gamma/k, swings grow. `guards.refuse_late_springs` asks at step 0 for one body at a
wall. It cannot ask for Mindlin's spring, whose stiffness is that of the overlap of now, and in a packing bodies have
more contacts than one. So contacts are looked at on the way, with their stiffness of now. With

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
pass. Looks are so near to each other that swings grow by little from one to the next. They take 2 to 3 % of a long
run's time where nothing can be fed, 13 to 21 % where something is and dashpots hold it (2000 discs).

A run that goes to its end says by how much swings could have grown, if it is WORTH_SAYING and they do grow. A contact
that is over before the second look is not followed: at a step of a fiftieth of its contact time a collision grows by
exp(0.1) to exp(0.3), the scheme's error of first order. Measured with 36 discs, elastic, at mu = 10, over 2e5 such
steps: with Mindlin springs the gas cools, to 0.2 of its energy (0.1 if they are felt in time); with linear ones it
heats by 27 %, and the guard at step 0 does not let it begin.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.guards import FAMILIES, MOST_GROWTH, KernelUnstable, own_spring
from reference.kernel.laws.mindlin import MindlinSliding
from reference.kernel.model import Model
from reference.kernel.simulation import Simulation
from reference.kernel.small_motions import (
    EXACT,
    ContactsOfNow,
    LargestEigenvalue,
    Operator,
    contacts_of_now,
    step_growth,
)
from reference.kernel.state import State

LOOKS, LOOK_EVERY, LOOK_WITHIN = 100, 1000, 0.5 * MOST_GROWTH
"""Looks at a run, the most steps between two, and by what exponent swings can grow from one to the next."""

WORTH_SAYING = 0.05
"""Exponent from which on a run says what it made of its swings: their energy by a tenth."""

GROWS = 1e-6
"""By how much an eigenvalue is beyond 1 where a motion grows."""


def late_families(model: Model) -> tuple[str, ...]:
    """Return the families whose contacts could ever stick on a spring that is felt late and not held by its dashpot."""
    return tuple(family for family in FAMILIES if _may_be_fed(model, family))


def _may_be_fed(model: Model, family: str) -> bool:
    law = getattr(model, family)
    if getattr(law, "algorithm", None) != "talk":
        return False
    if isinstance(law, MindlinSliding):
        return True
    stiffness, damping = own_spring(law, family)
    return bool(np.any(damping < model.dt * stiffness))


class LateSprings:
    """Watches a run: `look` at the start and then from time to time.

    exponent: (N,) of what the swings of every body can have grown by since the count began; gained: the energy, J, that
    late springs and dashpots have given to the motion since then, estimated from the moments of the looks. ended: the
    largest exponent of swings that friction or a flight has ended.
    """

    def __init__(self, model: Model, steps: int):
        """steps: of the run."""
        self.model, self._steps = model, steps
        self._largest = LargestEigenvalue()
        self.exponent, self.gained, self.ended = np.zeros(model.particle_count), 0.0, 0.0
        self._stuck: dict[str, np.ndarray] = {family: np.empty(0, np.int64) for family in late_families(model)}
        self._step, self._rate = -1, 0.0

    @property
    def next_look(self) -> int | None:
        """The step at which to look next: LOOKS times a run at least, and at its end; None when it has ended."""
        if self._step < 0:
            return 0
        every = max(min(LOOK_EVERY, self._steps // LOOKS), 1)
        if self._rate * every > LOOK_WITHIN:
            every = max(int(LOOK_WITHIN / self._rate), 1)
        return min(self._step + every, self._steps) if self._step < self._steps else None

    def look(self, simulation: Simulation) -> None:
        """Count the steps since the last look. Raises KernelUnstable."""
        model, state = self.model, simulation.state
        found = contacts_of_now(model, simulation.interactions)
        lasting, steps = self._lasting(found), state.step - max(self._step, 0)
        self._step = state.step
        fed = Operator(model, found, _feeding(found, lasting, model.dt), drag=model.drag or 0.0)
        self._count(fed, found, lasting, steps, state)
        largest = self.exponent.max(initial=0.0)
        if largest <= (MOST_GROWTH if self.next_look is not None else WORTH_SAYING):
            return
        if not self._grows(fed, found):
            self.exponent[:], self.gained = 0.0, 0.0
        elif largest > MOST_GROWTH:
            raise KernelUnstable(self._reason(found, lasting))

    def _lasting(self, found: ContactsOfNow) -> dict[str, np.ndarray]:
        """Return which late springs stick at this look and did at the last, (M,) by family; remember those of now.

        The first look counts no steps, and all that stick tell when to look next.
        """
        keys = np.minimum(found.i, found.j) * self.model.node_count + np.maximum(found.i, found.j)
        sticks = {family: found.springs[family].sticks for family in self._stuck}
        lasting = sticks if self._step < 0 else {
            family: sticks[family] & np.isin(keys, stuck) for family, stuck in self._stuck.items()}
        self._stuck = {family: keys[now] for family, now in sticks.items()}
        return lasting

    def _count(self, fed: Operator, found: ContactsOfNow, lasting: dict, steps: int, state: State) -> None:
        """Add the steps to the exponents of bodies with lasting contacts, and what their motion gained."""
        self._rate = 0.0
        if any((fed.weights[family] > 0.0).any() for family in lasting):
            square = 1.0 + self.model.dt * self._largest.of(fed, fed.size)
            self._rate = 0.5 * float(np.log(square))
            self.exponent += steps * self._rate
            self.gained += steps * self.model.dt * fed.power(state.v, state.spin)
        held = np.zeros(self.model.node_count, bool)
        for late in lasting.values():
            held[np.concatenate([found.i[late], found.j[late]])] = True
        free = ~held[: self.model.particle_count]
        self.ended = max(self.ended, float(self.exponent[free].max(initial=0.0)))
        self.exponent[free] = 0.0

    def _grows(self, fed: Operator, found: ContactsOfNow) -> bool:
        """Return whether motions grow, see above."""
        if fed.size > EXACT:
            return self.gained > 0.0
        stiffness = {family: np.where(s.sticks, s.stiffness, 0.0) for family, s in found.springs.items()}
        springs = Operator(self.model, found, {"normal": found.slope} | stiffness)
        return step_growth(springs.matrix(), fed.matrix(), self.model.dt) > 1.0 + GROWS

    def _reason(self, found: ContactsOfNow, lasting: dict[str, np.ndarray]) -> str:
        springs = {family: found.springs[family] for family, late in lasting.items() if late.any()}
        held = {f: float((s.damping[lasting[f]] / s.stiffness[lasting[f]]).min()) for f, s in springs.items()}
        family = min(held, key=held.get)
        return (
            f"step {self._step}: the talks' algorithm feels the {family} spring one step late, and dt = "
            f"{self.model.dt:.3g} s is larger than its gamma/k, {held[family]:.3g} s by now: contacts that stick swing "
            f"up, by exp({self.exponent.max():.3g}) at most so far; take more of its damping, a smaller step, or the "
            "kernel in another convention"
        )

    def warning(self) -> str | None:
        """Return what a run that went to its end has to say, in one line; None if that is nothing."""
        most = max(self.ended, float(self.exponent.max(initial=0.0)))
        if most < WORTH_SAYING:
            return None
        return (
            f"the talks' algorithm feels {' and '.join(self._stuck)} springs one step late, and dt = "
            f"{self.model.dt:.3g} s is larger than gamma/k: swings of contacts that stick could have grown by "
            f"exp({most:.3g})"
        )

    # --- to go on in another process -----------------------------------------------------------

    def kept(self) -> dict[str, np.ndarray]:
        """Return what the coming looks depend on, as arrays by name, for `take`."""
        return {
            "late_exponent": self.exponent.copy(), "late_gained": np.array(self.gained),
            "late_step": np.array(self._step), "late_rate": np.array(self._rate), "late_ended": np.array(self.ended),
            **{f"late_stuck_{family}": stuck for family, stuck in self._stuck.items()}, **self._largest.kept(),
        }

    def take(self, kept: dict[str, np.ndarray]) -> None:
        """Go on from what `kept` returned."""
        self.exponent = kept["late_exponent"]
        self._stuck = {family: kept[f"late_stuck_{family}"] for family in self._stuck}
        self._step, self.gained = int(kept["late_step"]), float(kept["late_gained"])
        self._rate, self.ended = float(kept["late_rate"]), float(kept["late_ended"])
        self._largest.take(kept)


def _feeding(found: ContactsOfNow, lasting: dict[str, np.ndarray], dt: float) -> dict[str, np.ndarray]:
    """Return A at the contacts, (M,) by family: dt k of lasting late springs less gamma of all that sticks."""
    weights = {"normal": -found.along}
    for family, s in found.springs.items():
        late = np.where(lasting[family], dt * s.stiffness, 0.0) if family in lasting else 0.0
        weights[family] = late - np.where(s.sticks, s.damping, 0.0)
    return weights
