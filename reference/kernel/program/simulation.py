"""A running system on the fast kernel; the same face as `reference.kernel.simulation.Simulation`.

The list of pairs is looked at after every interval of steps. If by then two nodes could have closed a gap of one skin,
a contact may have been missed: the interval is taken back and made again from a new list. Margins make that rare, the
look afterwards makes it safe.

Between two looks nothing moves further than half the smallest radius, so that no body passes another unseen; where a
list had a pair nearly so deep, centres inside other bodies are looked for then (`reference.kernel.guards`).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from reference.kernel.corrected import simulate
from reference.kernel.guards import KernelUnstable, longest_way, refuse_centres_inside, refuse_leaps
from reference.kernel.interactions import Forces, Interaction
from reference.kernel.model import Model
from reference.kernel.program.compose import DIMENSIONS, can_compose, one_step, spin_unit
from reference.kernel.program.corrected import history_rows, take_last_forces
from reference.kernel.program.memory import memories
from reference.kernel.program.nodes import Nodes
from reference.kernel.program.pairs import BLOCK, PairList, Remembered, normals
from reference.kernel.program.rings import TurningRings
from reference.kernel.simulation import Simulation
from reference.kernel.state import State
from reference.kernel.vectors import dot
from reference.kernel.walls import MovingWalls

CHECK_EVERY = 8
"""Fewest steps between two looks at the list."""

CHECK_WITHIN = 64
"""Most steps between two looks."""

MARGIN = 1.5
"""The list is renewed when CHECK_EVERY more steps would use up the skin, moving 1.5 times as fast as the last ones."""

LOOKAHEAD = 4.0
"""The next look comes before what is left of the skin is used up even by moving 4 times as fast."""


class ProgramSimulation:
    """`advance(steps)`; `state`, `contacts()` and `interactions` are made from the program's arrays when asked for.

    Raises KernelUnstable as `Simulation` does.
    """

    def __init__(self, model: Model, *, skin: float | None = None):
        self.model = model
        self._textbook = Simulation(model, skin=skin)
        self.skin = self._textbook.skin
        self.rebuilds = 0
        self._longest_way = longest_way(model)
        state = self._textbook.state
        if model.convention.scheme == "leapfrog":
            self._textbook_forgets_forces()
        self._dimension = DIMENSIONS[model.dimension]
        self._memories = memories(model)
        self.nodes: Nodes = self._dimension.nodes(model, state, spin_unit=spin_unit(model, state.radius))
        self.walls = MovingWalls(model, self.nodes, state)
        self.walls.start()
        self.rings = TurningRings(model, self.nodes)
        if model.convention.scheme == "leapfrog":
            self.nodes.step_back()
        self._in_step = True
        self._pairs: PairList | None = None
        self._renew(self.skin)

    @property
    def time(self) -> float:
        """Time of the state, s."""
        return self.walls.step * self.model.dt

    @property
    def operations(self) -> list[str]:
        """What a step does, "effect: operation" in order."""
        return self._program.names

    @property
    def history(self) -> dict[str, np.ndarray]:
        """What listed pairs remember, (P,) by name; empty without laws that do."""
        return self._pairs.history

    @property
    def state(self) -> State:
        """The state of now, with full-step velocities."""
        self._hand_over()
        return self._textbook.state

    @property
    def interactions(self) -> list[Interaction]:
        """The contacts that acted in the last step."""
        self._hand_over()
        return self._textbook.interactions

    def contacts(self) -> list[tuple[Interaction, Forces]]:
        """Return the contacts of now, evaluated with full-step velocities; nothing is changed."""
        self._hand_over()
        return self._textbook.contacts()

    def advance(self, steps: int = 1) -> None:
        """Make steps of dt."""
        end = self.walls.step + steps
        while self.walls.step < end:
            self._let_go()
            self._advance_checked(min(self._interval, end - self.walls.step))

    # --- to go on in another process -----------------------------------------------------------

    def kept(self) -> dict[str, np.ndarray]:
        """Return what the coming steps depend on, as arrays by name, for `take`."""
        remembered = self._pairs.remembered(self.nodes.count)
        return {
            **{f"nodes_{k}": values for k, values in enumerate(self.nodes.snapshot())},
            "walls": np.array(self.walls.snapshot()), "walls_here": self.walls.here.copy(), "keys": remembered.keys,
            **{f"history_{name}": values for name, values in remembered.history.items()},
        }

    def take(self, kept: dict[str, np.ndarray]) -> None:
        """Go on from what `kept` of a simulation of the same model returned, to the same last bit."""
        self._let_go()
        self.nodes.restore([kept[name] for name in sorted(kept) if name.startswith("nodes_")])
        self.walls.restore([tuple(row) for row in kept["walls"].tolist()])
        self.walls.here[:] = kept["walls_here"]
        history = {n.removeprefix("history_"): v for n, v in kept.items() if n.startswith("history_")}
        self._renew(self.skin, Remembered(keys=kept["keys"], history=history))

    # --- the guarded interval ------------------------------------------------------------------

    def _advance_checked(self, steps: int) -> None:
        """Make a few steps, and make them again from a new list if a contact could have been missed.

        A list that may not last is renewed before the next steps and not at once: its contacts hold the last forces.
        After a leap fewer steps are made.
        """
        if self._renewal_is_due:
            self._renew(self.skin)
        kept, start, skin = self._snapshot(), self.walls.step, self.skin
        while True:
            self.rings.step = start
            self._program.run(steps)
            self.walls.step = start + steps
            moved = self._largest_move()
            leapt = moved > self._longest_way and self._leapt(kept, steps)
            if not leapt and 2.0 * moved < self._list_skin:
                break
            self._restore(kept)
            steps = steps // 2 if leapt else steps
            skin = 2.0 * skin if start == self._built_in_step and not leapt else skin
            self._renew(skin)
        self._refuse_passed_walls()
        if self._deepest + 2.0 * moved >= 0.0:
            self._refuse_centres_inside()
        self._look_ahead(moved, steps)

    def _leapt(self, kept: tuple, steps: int) -> bool:
        """Return whether a body moved too far in these steps; raise if a single one took it through another."""
        places = kept[0][0]
        if steps > 1:
            return self.nodes.largest_distance(places) > self._longest_way
        self._refuse_passed_walls()
        radius = self._textbook.state.radius
        refuse_leaps(self.model, self.nodes.places(places), self.nodes.places(), radius, self.walls.step)
        return False

    def _refuse_centres_inside(self) -> float:
        """Return how deep the deepest pair of bodies is; raise if a centre is inside another body."""
        i, j = self._pairs.i, self._pairs.j
        bodies = (j < self.model.wall_nodes.start) | (j >= self.model.wall_nodes.stop)
        radius = self._textbook.state.radius
        return refuse_centres_inside(
            self.model, self.nodes.places(), radius, i[bodies], j[bodies], self.walls.step)

    def _look_ahead(self, moved: float, steps: int) -> None:
        """Decide whether the list is renewed before the next interval, and how long that is."""
        age = self.walls.step - self._built_in_step
        pace = max((moved - self._moved) / steps, moved / age)
        left = 0.5 * self._list_skin - moved
        self._renewal_is_due = MARGIN * CHECK_EVERY * pace >= left
        self._interval = min(2 * self._interval, CHECK_WITHIN)
        if LOOKAHEAD * pace * self._interval > left:
            self._interval = max(int(left / (LOOKAHEAD * pace)), CHECK_EVERY)
        self._moved = moved

    def _renew(self, skin: float, old: Remembered | None = None) -> None:
        """Find the pairs anew and compose the program for them. old: what is remembered, else of the pairs of now."""
        if not np.isfinite(self.nodes.place_vector).all():
            raise KernelUnstable(f"step {self.walls.step}: a position is no longer a finite number")
        if old is None and self._pairs is not None:
            old = self._pairs.remembered(self.nodes.count)
        self._pairs, self._program, state = None, None, self._textbook.state
        rows = {family: memory.rows for family, memory in self._memories.items()} | history_rows(self.model)
        self._pairs = PairList(
            self.model, self.nodes.places(), state, skin, history=rows, kind=self._dimension.contacts,
            block=BLOCK if self.model.convention.scheme == "leapfrog" else None)
        if old is None:
            self._take_memories()
        else:
            self._pairs.inherit(old, self.nodes.count)
        self._deepest = self._refuse_centres_inside()
        self._program = one_step(self.model, self.nodes, self.walls, self.rings, self._pairs)
        self._built_at, self._built_in_step = self.nodes.place_vector.copy(), self.walls.step
        self._list_skin, self._moved, self._interval, self._renewal_is_due = skin, 0.0, CHECK_EVERY, False
        self.rebuilds += 1

    def _largest_move(self) -> float:
        moved = self.nodes.largest_distance(self._built_at)
        if not math.isfinite(moved):
            raise KernelUnstable(f"step {self.walls.step}: a position is no longer a finite number")
        return moved

    def _snapshot(self) -> tuple:
        return self.nodes.snapshot(), self.walls.snapshot(), self._pairs, {
            name: values.copy() for name, values in self._pairs.history.items()
        }

    def _restore(self, kept: tuple) -> None:
        nodes, walls, self._pairs, history = kept
        self.nodes.restore(nodes)
        self.walls.restore(walls)
        for name, values in history.items():
            self._pairs.history[name][:] = values

    def _refuse_passed_walls(self) -> None:
        """Raise when a particle centre has passed a wall: beyond it the plane is no wall."""
        i, j = self._pairs.at_walls
        if not len(i):
            return
        places, wall = self.nodes.places(), j - self.model.particle_count
        height = dot(places[:, i] - places[:, j], self.walls.normal[:, wall])
        for first in np.flatnonzero(height <= 0.0)[:1]:
            raise KernelUnstable(
                f"by step {self.walls.step}: the centre of particle {i[first] + 1} has passed wall "
                f"'{self.model.walls[wall[first]].name}'"
            )

    # --- the textbook's view -------------------------------------------------------------------

    def _hand_over(self) -> None:
        """Bring the textbook simulation to the state of now, for everything that only looks."""
        if self._in_step:
            self._recall_set_up()
            return
        state = self._textbook.state
        half = self.nodes.half_step_velocities()
        self.nodes.write(state)
        state.step = self.walls.step
        state.wall_force = state.force[:, self.model.wall_nodes].copy()
        self.walls.write(state)
        for interaction in self._textbook.interactions:
            rows = self._hand_pairs_to(interaction)
            forces = interaction.evaluate(state, *half, self.model.dt, advance=False, lag=self.model.lag)
            interaction.last = self._as_they_acted(interaction, forces, rows[forces.touching])
        self._in_step = True

    def _textbook_forgets_forces(self) -> None:
        """Those of the set-up take much room, and are wanted only by who looks before the first step."""
        for interaction in self._textbook.interactions:
            interaction.last = None

    def _recall_set_up(self) -> None:
        """Make the forces of the set-up again, from contacts that remembered nothing."""
        state = self._textbook.state
        for interaction in self._textbook.interactions:
            if interaction.last is None:
                kept = interaction.pairs.memory
                interaction.pairs.memory = {family: np.zeros_like(memory) for family, memory in kept.items()}
                interaction.last = interaction.evaluate(state, state.v, state.spin, self.model.dt, advance=False)
                interaction.pairs.memory = kept

    def _let_go(self) -> None:
        """Before steps: the textbook's contacts and what they remember are no longer those of now."""
        if not self._in_step:
            return
        nothing = np.empty(0, np.intp)
        self._textbook_forgets_forces()
        for interaction in self._textbook.interactions:
            interaction.pairs.replace(nothing, nothing)
        self._in_step = False

    def _as_they_acted(self, interaction: Interaction, forces: Forces, rows: np.ndarray) -> Forces:
        """Return the forces and memories of the last step in the place of those evaluated now for the pairs `rows`."""
        force, couple = self._dimension.contacts.vectors(self._pairs.force[..., rows]), None
        if forces.couple is not None:
            couple = -np.atleast_2d(self._pairs.couple[..., rows])
        memory = dict.fromkeys(forces.memory) | interaction.pairs.recall(forces.touching)
        return replace(forces, force=force, f_n=dot(force, forces.contact.n), couple=couple, memory=memory)

    def _hand_pairs_to(self, interaction: Interaction) -> np.ndarray:
        """Give an interaction its pairs and their memories; return which of the program's they are, in its order."""
        i, j, rows = self._pairs_of(interaction)
        n = normals(self.model, self._textbook.state, i, j)
        interaction.pairs.replace(i, j)
        for family in interaction.pairs.memory:
            history = self.history[family][:, rows]
            interaction.pairs.memory[family] = self._memories[family].to_textbook(n, history, i, j)
        return rows

    def _take_memories(self) -> None:
        """Start from what the textbook remembers after its set-up, which found the same pairs."""
        for interaction in self._textbook.interactions:
            i, j, rows = self._pairs_of(interaction)
            n = normals(self.model, self._textbook.state, i, j)
            for family, remembered in interaction.pairs.memory.items():
                self.history[family][:, rows] = self._memories[family].from_textbook(n, remembered, i, j)
            if "f_n" in self.history:
                take_last_forces(self.history, rows[interaction.last.touching], interaction.last)

    def _pairs_of(self, interaction: Interaction) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return i, j of an interaction's pairs, in the order of its keys, and where they are in the program's list."""
        i, j = self._pairs.i, self._pairs.j
        rows = np.flatnonzero(interaction.owns(j))
        rows = rows[np.lexsort((j[rows], i[rows]))]
        return i[rows], j[rows], rows


def fastest(model: Model) -> Simulation | ProgramSimulation:
    """Return the program kernel where it has operations for every effect of the model, else the textbook one."""
    return ProgramSimulation(model) if can_compose(model) else simulate(model)
