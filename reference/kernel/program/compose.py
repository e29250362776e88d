"""From a model to its program: one step of the leapfrog, effect by effect.

    v(n+1/2) = v(n-1/2) + dt f(n)/m      the kick; both half kicks of velocity Verlet at once
    x(n+1) = x(n) + dt v(n+1/2)          the drift; then walls and rings
    f(n+1) = f(x(n+1), v(n+1/2))         contacts, law by law; drag; weight

The full-step velocity v(n) = v(n-1/2) + dt/2 f(n)/m is needed for output only and made there.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

import numpy as np

from reference.kernel.laws.by_pair import LinearByPair
from reference.kernel.laws.hertz import HertzNormal
from reference.kernel.laws.linear import LinearNormal
from reference.kernel.model import Loaded, Model
from reference.kernel.program.arms import lever_arms
from reference.kernel.program.buffers import empty, lined_up
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.corrected import Corrections
from reference.kernel.program.laws.normal import NormalOperations
from reference.kernel.program.laws.registry import NORMAL, has_operations, tangential_laws
from reference.kernel.program.laws.setting import Setting
from reference.kernel.program.nodes import Nodes
from reference.kernel.program.pairs import PairList
from reference.kernel.program.plane import geometry as plane_geometry
from reference.kernel.program.plane import rotation as plane_rotation
from reference.kernel.program.plane.contacts import PlaneContacts
from reference.kernel.program.plane.nodes import PlaneNodes
from reference.kernel.program.program import Program
from reference.kernel.program.rings import TurningRings
from reference.kernel.program.space import geometry as space_geometry
from reference.kernel.program.space import rotation as space_rotation
from reference.kernel.program.space.contacts import SpaceContacts
from reference.kernel.program.space.nodes import SpaceNodes
from reference.kernel.walls import MovingWalls

CORRECTED = {LinearNormal, LinearByPair, HertzNormal}
"""Normal laws whose elastic force is one of the overlap alone, as the corrections ask."""

EFFECTS = {"sliding": "sliding friction", "rolling": "rolling resistance", "torsion": "torsion resistance"}


@dataclass(frozen=True, kw_only=True)
class Dimension:
    """What two and three dimensions do differently: arrays, geometry, rotation."""

    nodes: type[Nodes]
    contacts: type[Contacts]
    geometry: ModuleType
    rotation: ModuleType


DIMENSIONS = {
    2: Dimension(nodes=PlaneNodes, contacts=PlaneContacts, geometry=plane_geometry, rotation=plane_rotation),
    3: Dimension(nodes=SpaceNodes, contacts=SpaceContacts, geometry=space_geometry, rotation=space_rotation),
}


def can_compose(model: Model) -> bool:
    """Return whether every effect of the model has operations; else the textbook evaluation runs."""
    if model.convention.scheme == "corrected" and (_has_couples(model) or type(model.normal) not in CORRECTED):
        return False
    return has_operations(model)


def spin_unit(model: Model, radius: np.ndarray) -> np.ndarray | None:
    """What the nodes' spin variable is omega times of: R where slip is taken at R, else 1; None if nothing turns.

    A law that asks whether two spins are equal must see them as they are.
    """
    if not model.turns and not model.rotations:
        return None
    return radius if _carries_radius(model) else np.ones_like(radius)


def _find_normals(model: Model, nodes: Nodes, c: Contacts) -> None:
    """Compute the overlaps and normals of now, from which laws that follow the contact start."""
    p = Program()
    DIMENSIONS[model.dimension].geometry.overlaps_and_normals(p, model, nodes, c, masked=False)
    p.run()


def one_step(model: Model, nodes: Nodes, walls: MovingWalls, rings: TurningRings, pairs: PairList) -> Program:
    """Kick, drift, walls, rings, forces: the program of a step for this list of pairs."""
    p = Program()
    if model.convention.scheme == "corrected":
        _corrected_step(p, model, nodes, walls, rings, pairs)
        return p
    for part in nodes.parts(nodes.velocity_vector):
        _kick(p, nodes, part)
        _start_from_weights(p, nodes, part)
        _drift(p, nodes, part)
    _move_others(p, nodes, walls, rings)
    _forces(p, model, nodes, pairs)
    if any(isinstance(w.motion, Loaded) for w in model.walls):
        p.effect("loaded walls")
        p.call("walls", walls.kick)
    return p


def _corrected_step(
    p: Program, model: Model, nodes: Nodes, walls: MovingWalls, rings: TurningRings, pairs: PairList
) -> None:
    (c,) = pairs.blocks
    _find_normals(model, nodes, c)
    scheme = Corrections(model, nodes, walls, c)
    scheme.kick(p)
    for part in nodes.parts(nodes.velocity_vector):
        _start_from_weights(p, nodes, part)
        _drift(p, nodes, part)
    _move_others(p, nodes, walls, rings)
    scheme.predict(p)
    _forces(p, model, nodes, pairs, scheme)
    scheme.replace_kick(p)


def _move_others(p: Program, nodes: Nodes, walls: MovingWalls, rings: TurningRings) -> None:
    if nodes.turned is not None:
        p.effect("rotation")
        angle = empty(len(nodes.turned))
        p(np.multiply, nodes.s, nodes.turn_factor, out=angle)
        p(np.add, nodes.turned, angle, out=nodes.turned)
    if walls.moving:
        p.effect("driven walls")
        p.call("walls", walls.move)
    rings.turn(p)


def _forces(p: Program, model: Model, nodes: Nodes, pairs: PairList, scheme: Corrections | None = None) -> None:
    for c in pairs.blocks:
        _find_normals(model, nodes, c)
        _contact_forces(p, model, nodes, c, scheme)
    if model.drag is not None:
        _drag(p, model, nodes)


def _contact_forces(p: Program, model: Model, nodes: Nodes, c: Contacts, scheme: Corrections | None) -> None:
    dimension = DIMENSIONS[model.dimension]
    geometry, rotation = dimension.geometry, dimension.rotation
    normal = NORMAL[type(model.normal)](model.normal, c, keep_elastic=_any(model, "takes_elastic_force"))
    masked = normal.damped or normal.reads_touching or model.turns or scheme is not None
    geometry.overlaps_and_normals(p, model, nodes, c, masked=masked)
    if normal.damped or model.sliding is not None:
        geometry.relative_velocities(p, nodes, c)
    if not model.turns:
        if scheme is not None:
            scheme.find_events(p)
        normal.force(p)
        geometry.sum_normal_forces(p, nodes, c)
        return
    arms = _spins(p, model, nodes, c, rotation)
    if scheme is not None:
        scheme.find_events(p)
    normal.force(p)
    _tangential_forces(p, model, c, normal, rotation)
    sum_forces = geometry.sum_normal_forces if model.sliding is None else geometry.sum_forces
    sum_forces(p, nodes, c)
    p.effect("rotation")
    rotation.sum_torques(p, nodes, c, arms, couple=_has_couples(model))


def _spins(p: Program, model: Model, nodes: Nodes, c: Contacts, rotation: ModuleType) -> np.ndarray | None:
    """Compute slip and relative rolling as far as laws need them; return the arms of the torque, if there is one."""
    slips, torque_arms, slip_arms, factors = model.sliding is not None, None, None, None
    p.effect("rotation")
    if slips:
        torque_arms, slip_arms = _arms(p, model, c)
    if _has_couples(model):
        factors = _reduced_radius_per_spin_unit(nodes, c)
    rotation.slip_and_rolling(p, nodes, c, slips=slips, arms=slip_arms, factors=factors)
    if _has_couples(model) and model.convention.wall_spin == "raised":
        _raise_wall_spins(p, c)
    return torque_arms


def _arms(p: Program, model: Model, c: Contacts) -> tuple[np.ndarray, np.ndarray | None]:
    """Return the arms of torque and of slip, (2, P) each; None for slip if the nodes carry R omega."""
    k = model.convention
    torque_arms = lever_arms(p, c, "torque arms", pairs=k.torque_arm, walls=k.wall_torque_arm)
    if _carries_radius(model):
        return torque_arms, None
    if (k.slip_arm, k.wall_slip_arm) == (k.torque_arm, k.wall_torque_arm):
        return torque_arms, torque_arms
    return torque_arms, lever_arms(p, c, "slip arms", pairs=k.slip_arm, walls=k.wall_slip_arm)


def _carries_radius(model: Model) -> bool:
    """Whether the nodes carry R omega."""
    slips_at_radius = (model.convention.slip_arm, model.convention.wall_slip_arm) == ("radius", "radius")
    return model.sliding is not None and slips_at_radius and not _any(model, "compares_spins")


def _any(model: Model, trait: str) -> bool:
    """Whether any of the model's tangential laws has a trait of `Tangential`."""
    return any(getattr(operations, trait) for _, operations in tangential_laws(model).values())


def _has_couples(model: Model) -> bool:
    return model.rolling is not None or model.torsion is not None


def _reduced_radius_per_spin_unit(nodes: Nodes, c: Contacts) -> np.ndarray:
    """Return a* over the spin units of the ends, (2, P), 0 at walls without friction; walls do not turn."""
    units = nodes.spin_unit[c.ends]
    return lined_up(c.rough * c.reduced_radius / np.where(units > 0, units, 1.0))


def _raise_wall_spins(p: Program, c: Contacts) -> None:
    """rolling *= (R - overlap/2)/(R - overlap) at walls: how fast a particle is taken to roll there."""
    walls = slice(c.particle_pairs.stop, c.smooth_pairs.start)
    overlap, radius, rolling = c.overlap[walls], c.radius[1, walls], c.rolling[..., walls]
    lower, half = c.a[walls], c.b[walls]
    if not len(radius):
        return
    p.effect("relative rotation")
    p(np.subtract, radius, overlap, out=lower)
    p(np.multiply, overlap, 0.5, out=half)
    p(np.subtract, radius, half, out=half)
    p(np.divide, half, lower, out=half)
    p(np.multiply, rolling, half, out=rolling)


def _tangential_forces(
    p: Program, model: Model, c: Contacts, normal: NormalOperations, rotation: ModuleType
) -> None:
    """shear and couple, law by law, all limited by coefficients times the same base."""
    if _any(model, "limited"):
        _find_base(p, model, c, normal)
    if model.sliding is not None and "shear" not in c.history:
        c.shear = c.tangents.buffer("shear")
    setting = Setting(p=p, c=c, model=model, normal=normal, rotation=rotation)
    for family, (law, operations) in tangential_laws(model).items():
        p.effect(EFFECTS[family])
        operations.act(law, setting)


def _find_base(p: Program, model: Model, c: Contacts, normal: NormalOperations) -> None:
    """base = |f| or max(f, 0), f the normal force counted from where an adhesive contact pulls most."""
    c.base = c.buffer("base")
    gripping = normal.gripping(p, c.f_n, c.base)
    p.effect("limit")
    if model.convention.limit == "absolute":
        p(np.abs, gripping, out=c.base)
    else:
        p(np.maximum, gripping, 0.0, out=c.base)


def _kick(p: Program, nodes: Nodes, part: slice) -> None:
    p.effect("motion")
    velocity, work = nodes.velocity_vector[part], nodes.work[: part.stop - part.start]
    p(np.multiply, nodes.force_vector[part], nodes.kick_factor[part], out=work)
    p(np.add, velocity, work, out=velocity)


def _drift(p: Program, nodes: Nodes, part: slice) -> None:
    """Move on what of a part of the velocity vector has places."""
    places = nodes.place_vector[part]
    if not len(places):
        return
    p.effect("motion")
    velocity, work = nodes.velocity_vector[part][: len(places)], nodes.work[: len(places)]
    p(np.multiply, velocity, nodes.drift_factor[part], out=work)
    p(np.add, places, work, out=places)


def _start_from_weights(p: Program, nodes: Nodes, part: slice) -> None:
    """Forces have moved the nodes, and are summed anew."""
    if nodes.rest_force is None:
        p.effect("sum")
        p.fill(nodes.force_vector[part], 0.0)
    else:
        p.effect("gravity")
        p.copy(nodes.rest_force[part], nodes.force_vector[part])


def _drag(p: Program, model: Model, nodes: Nodes) -> None:
    p.effect("background drag")
    factor = lined_up(nodes.drift_factor * (model.drag / model.dt))
    for part in nodes.parts(nodes.place_vector):
        force, work = nodes.force_vector[part], nodes.work[: part.stop - part.start]
        p(np.multiply, nodes.velocity_vector[part], factor[part], out=work)
        p(np.subtract, force, work, out=force)
