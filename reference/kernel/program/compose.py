"""From a model to its program: one step of the leapfrog, effect by effect.

    v(n+1/2) = v(n-1/2) + dt f(n)/m      the kick; both half kicks of velocity Verlet at once
    x(n+1) = x(n) + dt v(n+1/2)          the drift; then the walls
    f(n+1) = f(x(n+1), v(n+1/2))         contacts, law by law; drag; weight

The full-step velocity v(n) = v(n-1/2) + dt/2 f(n)/m is needed for output only and made there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType

import numpy as np

from reference.kernel.laws.law import NormalLaw
from reference.kernel.laws.linear import LinearNormal
from reference.kernel.laws.sliding import SpringSliding
from reference.kernel.model import Loaded, Model
from reference.kernel.program.arms import LeverArms
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.laws.linear import linear
from reference.kernel.program.nodes import Nodes
from reference.kernel.program.plane import geometry as plane_geometry
from reference.kernel.program.plane import sliding as plane_sliding
from reference.kernel.program.plane.contacts import PlaneContacts
from reference.kernel.program.plane.nodes import PlaneNodes
from reference.kernel.program.program import Program
from reference.kernel.program.space import geometry as space_geometry
from reference.kernel.program.space import sliding as space_sliding
from reference.kernel.program.space.contacts import SpaceContacts
from reference.kernel.program.space.nodes import SpaceNodes
from reference.kernel.program.walls import MovingWalls


@dataclass(frozen=True, kw_only=True)
class Dimension:
    """What two and three dimensions do differently: arrays, geometry, and the laws that have a direction."""

    nodes: type[Nodes]
    contacts: type[Contacts]
    geometry: ModuleType
    sliding: dict[type, Callable]


DIMENSIONS = {
    2: Dimension(nodes=PlaneNodes, contacts=PlaneContacts, geometry=plane_geometry,
                 sliding={SpringSliding: plane_sliding.spring_sliding}),
    3: Dimension(nodes=SpaceNodes, contacts=SpaceContacts, geometry=space_geometry,
                 sliding={SpringSliding: space_sliding.spring_sliding}),
}

NORMAL_LAWS: dict[type, Callable] = {LinearNormal: linear}


def can_compose(model: Model) -> bool:
    """Return whether every effect of the model has operations; else the textbook evaluation runs."""
    if type(model.normal) not in NORMAL_LAWS or model.rolling or model.torsion:
        return False
    sliding, known = model.sliding, DIMENSIONS[model.dimension].sliding
    return sliding is None or (type(sliding) in known and getattr(sliding, "dynamic_friction", None) is None)


def history_of(model: Model) -> dict[str, int]:
    """Return how many rows the laws remember, by family: a tension has a direction in 3D only."""
    return {} if model.sliding is None else {"sliding": 1 if model.dimension == 2 else 3}


def spin_unit(model: Model, radius: np.ndarray) -> np.ndarray | None:
    """What the nodes' spin variable is omega times of: R where slip is taken at R, else 1; None without friction."""
    if model.sliding is None:
        return None
    return radius if _slips_at_radius(model) else np.ones_like(radius)


def remember_normals(model: Model, nodes: Nodes, c: Contacts) -> None:
    """Compute the normals of now and let the contacts keep them."""
    p = Program()
    DIMENSIONS[model.dimension].geometry.overlaps_and_normals(p, model, nodes, c)
    p.run()
    c.remember_normals()


def one_step(model: Model, nodes: Nodes, walls: MovingWalls, c: Contacts) -> Program:
    """Kick, drift, walls, forces: the program of a step for this list of pairs."""
    p = Program()
    _kick(p, nodes)
    _drift(p, nodes)
    if walls.moving:
        p.effect("driven walls")
        p.call("walls", walls.move)
    _start_from_weights(p, nodes)
    _contact_forces(p, model, nodes, c)
    if model.drag is not None:
        _drag(p, model, nodes)
    if any(isinstance(w.motion, Loaded) for w in model.walls):
        p.effect("loaded walls")
        p.call("walls", walls.kick)
    return p


def _contact_forces(p: Program, model: Model, nodes: Nodes, c: Contacts) -> None:
    dimension, sliding, arms = DIMENSIONS[model.dimension], model.sliding, None
    geometry = dimension.geometry
    geometry.overlaps_and_normals(p, model, nodes, c)
    if sliding is not None or _is_damped(model.normal):
        geometry.relative_velocities(p, nodes, c)
        if sliding is not None:
            arms = _slip(p, model, nodes, c)
        geometry.still_where_apart(p, c)
    p.effect("normal contact")
    NORMAL_LAWS[type(model.normal)](p, model.normal, c)
    if sliding is None:
        geometry.sum_normal_forces(p, nodes, c)
        return
    dimension.sliding[type(sliding)](p, sliding, c, model)
    geometry.sum_forces(p, nodes, c)
    geometry.sum_torques(p, nodes, c, arms)


def _is_damped(normal: NormalLaw) -> bool:
    return bool(getattr(normal, "normal_damping", 0.0))


def _slip(p: Program, model: Model, nodes: Nodes, c: Contacts) -> LeverArms:
    """Make v_t the slip velocity; return the arms of the torque."""
    k = model.convention
    p.effect("rotation")
    torque = LeverArms(p, c, pairs=k.torque_arm, walls=k.wall_torque_arm)
    slip = None
    if not _slips_at_radius(model):
        same = (k.slip_arm, k.wall_slip_arm) == (k.torque_arm, k.wall_torque_arm)
        slip = torque if same else LeverArms(p, c, pairs=k.slip_arm, walls=k.wall_slip_arm)
    DIMENSIONS[model.dimension].geometry.slip_velocities(p, nodes, c, slip)
    return torque


def _slips_at_radius(model: Model) -> bool:
    return (model.convention.slip_arm, model.convention.wall_slip_arm) == ("radius", "radius")


def _kick(p: Program, nodes: Nodes) -> None:
    p.effect("motion")
    work = np.empty_like(nodes.velocity_vector)
    p(np.multiply, nodes.force_vector, nodes.kick_factor, out=work)
    p(np.add, nodes.velocity_vector, work, out=nodes.velocity_vector)


def _drift(p: Program, nodes: Nodes) -> None:
    places = nodes.place_vector
    work = np.empty_like(places)
    p(np.multiply, nodes.velocity_vector[: len(places)], nodes.drift_factor, out=work)
    p(np.add, places, work, out=places)
    if nodes.turned is not None:
        p.effect("rotation")
        angle = np.empty_like(nodes.turned)
        p(np.multiply, nodes.s, nodes.turn_factor, out=angle)
        p(np.add, nodes.turned, angle, out=nodes.turned)


def _start_from_weights(p: Program, nodes: Nodes) -> None:
    if nodes.rest_force is None:
        p.effect("sum")
        p.fill(nodes.force_vector, 0.0)
    else:
        p.effect("gravity")
        p.copy(nodes.rest_force, nodes.force_vector)


def _drag(p: Program, model: Model, nodes: Nodes) -> None:
    p.effect("background drag")
    force = nodes.force_vector[: len(nodes.place_vector)]
    factor, work = nodes.drift_factor * (model.drag / model.dt), np.empty_like(force)
    p(np.multiply, nodes.velocity_vector[: len(force)], factor, out=work)
    p(np.subtract, force, work, out=force)
