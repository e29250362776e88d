"""The second-order scheme of `reference.kernel.corrected` as a program.

Besides the operations of a step there are two looks at the contacts that begin or end in it: one between kinematics and
laws, which knows when they did and stretches new springs accordingly, and one at the end, which gives the
velocities what the half kicks missed. Both do nothing in a step in which no contact changes.

What the next step needs of this one is history, so that it follows the pairs through a renewal of the list: "slip",
"f_n" and "shear" of the last forces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.kernel.corrected import missed_force, share_in_contact
from reference.kernel.interactions import Forces
from reference.kernel.laws.contact import Touching
from reference.kernel.model import Model
from reference.kernel.neighbours import branch_vectors
from reference.kernel.program.buffers import empty
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.memory import amounts_of
from reference.kernel.program.nodes import Nodes
from reference.kernel.program.program import Program
from reference.kernel.vectors import dot, norm, torque_cross
from reference.kernel.walls import MovingWalls


def history_rows(model: Model) -> dict[str, int]:
    """Return the rows of the scheme's own history; none in the leapfrog."""
    if model.convention.scheme != "corrected":
        return {}
    amounts = 1 if model.dimension == 2 else 3
    sliding = {"slip": amounts, "shear": amounts} if model.sliding is not None else {}
    return {"f_n": 1} | sliding


def amounts(history: np.ndarray) -> np.ndarray:
    """Return history rows as laws have them: (P,) for one row, (3, P) for three."""
    return history[0] if len(history) == 1 else history


@dataclass(frozen=True, kw_only=True)
class _Events:
    """K contacts that began or ended in the step, with their places of now and their forces while they touched.

    n: (dim, K). overlap, theta, f_n, elastic: (K,). f_t: (dim, K) on i.
    """

    i: np.ndarray
    j: np.ndarray
    n: np.ndarray
    overlap: np.ndarray
    theta: np.ndarray
    f_n: np.ndarray
    elastic: np.ndarray
    f_t: np.ndarray


def take_last_forces(history: dict[str, np.ndarray], rows: np.ndarray, last: Forces) -> None:
    """Start the scheme's history, for the pairs `rows`, from forces of the set-up."""
    n = last.contact.n
    history["f_n"][0, rows] = last.f_n
    if "slip" in history and last.contact.v_t is not None:
        history["slip"][:, rows] = amounts_of(n, last.contact.v_t)
        history["shear"][:, rows] = amounts_of(n, last.f_n * n - last.force)


class Corrections:
    """The scheme's operations on one list of pairs, in the order in which `compose.one_step` asks for them."""

    def __init__(self, model: Model, nodes: Nodes, walls: MovingWalls, c: Contacts):
        self.model, self.nodes, self.walls, self.c = model, nodes, walls, c
        self.half_kick, self.new_kick = (empty(len(nodes.velocity_vector)) for _ in range(2))
        self.half_factor = 0.5 * nodes.kick_factor
        self.before = nodes.place_vector.copy()
        self.touched, self.changed = (c.overlap > 0.0).astype(float), np.empty(c.count, bool)
        self.begun, self.ended = np.empty(0, np.intp), None
        c.f_n = c.history["f_n"][0]
        if model.sliding is not None:
            c.shear = amounts(c.history["shear"])
            c.mean_v_t = c.tangents.buffer("mean v_t")

    # --- operations ------------------------------------------------------------------------------

    def kick(self, p: Program) -> None:
        """v += dt/2 f/m, and the places of before are kept."""
        p.effect("second order")
        p.copy(self.nodes.place_vector, self.before)
        p.effect("motion")
        p(np.multiply, self.nodes.force_vector, self.half_factor, out=self.half_kick)
        p(np.add, self.nodes.velocity_vector, self.half_kick, out=self.nodes.velocity_vector)

    def predict(self, p: Program) -> None:
        """v += dt/2 f/m again: the velocities that forces will see; walls have their rates at the end of the step."""
        p.effect("second order")
        p(np.add, self.nodes.velocity_vector, self.half_kick, out=self.nodes.velocity_vector)
        if self.walls.moving:
            p.call("walls", self.walls.predict)

    def find_events(self, p: Program) -> None:
        """mean_v_t = (slip before + v_t)/2; then what begins or ends."""
        c = self.c
        p.effect("second order")
        if self.model.sliding is not None:
            slip = amounts(c.history["slip"])
            c.tangents.turn(p, slip, keep_length=True, above=None)
            p(np.add, slip, c.v_t, out=c.mean_v_t)
            p(np.multiply, c.mean_v_t, 0.5, out=c.mean_v_t)
            p.copy(c.v_t, slip)
        p.call("events", self._find)

    def replace_kick(self, p: Program) -> None:
        """v += dt/2 (f new - f old)/m; then the impulses that the half kicks missed."""
        p.effect("second order")
        p(np.multiply, self.nodes.force_vector, self.half_factor, out=self.new_kick)
        p(np.subtract, self.new_kick, self.half_kick, out=self.new_kick)
        p(np.add, self.nodes.velocity_vector, self.new_kick, out=self.nodes.velocity_vector)
        if self.walls.loaded:
            p.call("walls", self.walls.replace_kick)
        p.call("impulses", self._apply)

    # --- in a step -------------------------------------------------------------------------------

    def _find(self) -> None:
        c = self.c
        np.not_equal(c.touching, self.touched, out=self.changed)
        rows = np.flatnonzero(self.changed)
        np.copyto(self.touched, c.touching)
        begins = c.touching[rows] > 0.0
        self.begun, ended = rows[begins], rows[~begins]
        self.ended = None
        if len(self.begun) and self.model.sliding is not None:
            gap, _ = self._overlap(self.begun, self.nodes.places(self.before))
            theta = share_in_contact(c.overlap[self.begun], gap)
            c.mean_v_t[..., self.begun] = theta * c.v_t[..., self.begun]
        if len(ended) and self.model.normal.attraction != "clipped":
            overlap, before = self._overlap(ended, self.nodes.places(self.before))
            gap, n = self._overlap(ended, self.nodes.places())
            f_t = self._tangential_force(ended, before)
            self.ended = self._events(
                ended, n, share_in_contact(overlap, gap), f_t - dot(f_t, n) * n, touched=overlap, overlap=gap)

    def _apply(self) -> None:
        if len(self.begun):
            gap, _ = self._overlap(self.begun, self.nodes.places(self.before))
            overlap, n = self._overlap(self.begun, self.nodes.places())
            theta, f_t = share_in_contact(overlap, gap), self._tangential_force(self.begun, n)
            self._give(self._events(self.begun, n, theta, f_t, touched=overlap, overlap=overlap))
        if self.ended is not None:
            self._give(self.ended)

    def _tangential_force(self, rows: np.ndarray, n: np.ndarray) -> np.ndarray:
        """Force on i, (dim, K), that stands in the buffers: of now, or while the laws wait, of the last step."""
        if self.model.sliding is None:
            return np.zeros_like(n)
        shear = self.c.shear[..., rows]
        return -shear if len(n) == 3 else shear * np.stack([n[1], -n[0]])

    def _events(self, rows, n, theta, f_t, *, touched: np.ndarray, overlap: np.ndarray) -> _Events:
        """`touched`: overlap at the end of the step at which they touch; `overlap`: that of now, of either sign."""
        c, law = self.c, self.model.normal
        elastic, _ = law.elastic(self._touching(rows, n, touched), None)
        return _Events(i=c.i[rows], j=c.j[rows], n=n, overlap=overlap, theta=theta, elastic=elastic,
                       f_n=c.f_n[rows].copy(), f_t=f_t)

    def _overlap(self, rows: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return overlaps, negative for gaps, (K,), and normals, (dim, K), at the places x."""
        c, n = self.c, self.model.particle_count
        i, j = c.i[rows], c.j[rows]
        branch, wall = branch_vectors(self.model, x, i, j), np.flatnonzero((j >= n) & (j < self.model.wall_nodes.stop))
        normal = self.walls.normal[:, j[wall] - n]
        branch[:, wall] = dot(x[:, i[wall]] - x[:, j[wall]], normal) * normal
        distance = norm(branch)
        return c.radius_sum[rows] - distance, branch / distance

    def _give(self, e: _Events) -> None:
        """Add the impulses to the nodes i and take them from the nodes j, with the moments of their tangential part."""
        model, n = self.model, self.model.particle_count
        friction = 0.0 if model.sliding is None else model.sliding.coefficient(e)
        along, across = missed_force(model, e.theta, f_n=e.f_n, elastic=e.elastic, f_t=e.f_t, friction=friction)
        impulse, moment = model.dt * (along * e.n + across), model.dt * torque_cross(e.n, across)
        body = e.j < n
        for node, signed, on in ((e.i, impulse, np.ones_like(body)), (e.j, -impulse, body)):
            self.nodes.push(node[on], signed[:, on] / model.mass[node[on]])
            if model.sliding is not None:
                arm = model.radius[node[on]] - 0.5 * e.overlap[on]
                self.nodes.spin_up(node[on], -arm * moment[:, on] / model.inertia[node[on]])
        for k in np.flatnonzero(~body):
            self.walls.push(e.j[k] - n, -impulse[:, k])

    def _touching(self, rows: np.ndarray, n: np.ndarray, overlap: np.ndarray) -> Touching:
        """What the elastic force asks for."""
        c = self.c
        return Touching(i=c.i[rows], j=c.j[rows], n=n, overlap=overlap, v_n=np.zeros_like(overlap),
                        reduced_radius=c.reduced_radius[rows])
