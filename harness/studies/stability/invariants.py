"""What must hold in a hard case: one function each, from the run's trajectory alone, and one registry.

A function takes the run (`Seen`, cut at `until`) and the case's `Invariant`, and returns a size >= 0 that is compared
with the tolerance: 0 is perfect, beyond the `ruin` of its row the answer means nothing. NaN fails. NotKnown says that
the run does not show it. Symbols: m, x, v, I, omega of particles, E their kinetic energy with that of walls with mass,
U the potential of normal springs (`harness.studies.stability.seen`), V that of weights and loads on walls.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.scene.expect import Invariant
from harness.scene.materials import stiffness_of_contacts
from harness.scene.system import Loaded
from harness.studies.stability.parts import (
    angular_parts,
    behind_walls,
    exact_restitution,
    largest,
    most,
    parting_rate,
    places_apart,
    rates_apart,
    through_rings,
)
from harness.studies.stability.seen import POTENTIALS, Frame, NotKnown, Seen, nearest_image


@dataclass(frozen=True, kw_only=True)
class Kind:
    """An invariant: how it is measured, what its size means, from which size on nothing is left.

    twins: whether it needs the run of another case beside its own.
    """

    measure: Callable[..., float]
    says: str
    ruin: float
    twins: bool = False


# --- of any run --------------------------------------------------------------------------------------


def finite(seen: Seen, _: Invariant) -> float:
    """Return how many recorded numbers of particles and walls are not finite; columns a wall cannot have aside."""
    tables = [(f.snapshot.particles, name) for f in seen.frames for name in f.snapshot.particles]
    if seen.trajectory.series is not None:
        tables += [(seen.trajectory.series, name) for name in seen.trajectory.series]
    return float(sum((~np.isfinite(table[name])).sum() for table, name in tables))


def contained(seen: Seen, _: Invariant) -> float:
    """Return how many particles any frame lacks, or has behind a wall or behind a ring that they started before."""
    worst, count = 0, len(seen.system.particles)
    for frame in seen.frames:
        lost = count - len(frame.x)
        worst = max(worst, lost + int((behind_walls(frame) | through_rings(seen, frame)).sum()))
    return float(worst)


def meets(seen: Seen, _: Invariant) -> float:
    """Return 0 if any frame shows an overlap, else 1: where nothing touches, nothing that contacts do is tested."""
    return 0.0 if any(len(t.overlap) for t in seen.touching) else 1.0


def overlap(seen: Seen, _: Invariant) -> float:
    """Return the largest overlap of any frame over the smaller radius: 1 is a centre inside the other body."""
    return most(float((t.overlap / t.smaller).max()) for t in seen.touching if len(t.overlap))


# --- energy --------------------------------------------------------------------------------------------


def energy(seen: Seen, _: Invariant) -> float:
    """Return the largest |H(t) - H(0)| over the largest E, H = E + U + V + k_t u^2/2: of conservative systems.

    What rests in springs does not count in the scale, so that a pressed packing is judged by its motion.
    """
    total = seen.kinetic + seen.elastic + seen.external + seen.sheared
    return largest(total - total[0], seen.kinetic)


def neighbouring_energy(seen: Seen, _: Invariant) -> float:
    """Return the largest change of H - dt^2/8 sum F^2/m over the largest E: what the leapfrog keeps in place of H.

    With full-step velocities v and forces F at x the scheme keeps m v^2/2 + (1 - w^2 dt^2/4) k x^2/2 of an oscillator
    exactly, w^2 = k/m, and the same of any coupled ones (Hairer, Lubich & Wanner, Acta Numerica 12, 399 (2003)). H
    alone swings by w^2 dt^2/8 of what springs and motion exchange, which would hide any drift.
    """
    kept = seen.kinetic + seen.elastic - seen.system.dt**2 / 8.0 * seen.squared_forces
    return largest(kept - kept[0], seen.kinetic)


def energy_drift(seen: Seen, _: Invariant) -> float:
    """Return the drift of H over the run by a straight line through all frames, over the largest E.

    The leapfrog keeps a neighbouring energy (Hairer, Lubich & Wanner, Acta Numerica 12, 399 (2003)): H swings with the
    springs by O(dt^2) without going anywhere. The line separates the two.
    """
    total = seen.kinetic + seen.elastic + seen.external + seen.sheared
    if len(total) < 3:
        raise NotKnown("fewer than three frames")
    time = np.array([f.time for f in seen.frames])
    slope = np.polyfit(time / time[-1], total - total[0], 1)[0]
    return float(abs(slope) / seen.kinetic.max())


def energy_not_created(seen: Seen, _: Invariant) -> float:
    """Return by how much E + U + V ever exceeds its start and the work of driven walls, over the largest E.

    U of laws with memory is left out (they give back at most k_1 d^2/2 of the start), as are tangential springs, which
    start empty: both only lower what is found, so that nothing is called created that was stored.
    """
    stored = seen.elastic if type(seen.system.normal) in POTENTIALS else np.zeros(len(seen.frames))
    start = seen.kinetic[0] + seen.at_start + seen.external[0]
    gained = seen.kinetic + stored + seen.external - start - seen.work()
    return largest(np.maximum(gained, 0.0), seen.kinetic)


def energy_falls(seen: Seen, _: Invariant) -> float:
    """Return the largest rise of E + U + V above its least value so far, over the largest E: of dashpots alone."""
    total = seen.kinetic + seen.elastic + seen.external + seen.sheared
    return largest(total - np.minimum.accumulate(total), seen.kinetic)


def kinetic_kept(seen: Seen, _: Invariant) -> float:
    """Return |E(end) - E(0)|/E(0): elastic bodies that have parted again."""
    return float(abs(seen.kinetic[-1] / seen.kinetic[0] - 1.0))


# --- momenta ---------------------------------------------------------------------------------------------


def momentum(seen: Seen, _: Invariant) -> float:
    """Return the largest |P(t) - P(0) - M g t| over the largest sum m |v|, P = sum m v: without walls and drag."""
    if seen.system.walls or seen.system.background:
        raise NotKnown("walls or drag take momentum")
    gravity = np.zeros(seen.system.dimension) if seen.system.gravity is None else np.array(seen.system.gravity)
    total = np.array([f.mass @ f.v - f.mass.sum() * gravity * f.time for f in seen.frames])
    size = [float(f.mass @ np.linalg.norm(f.v, axis=1)) for f in seen.frames]
    return largest(np.linalg.norm(total - total[0], axis=1), np.array(size))


def angular_momentum(seen: Seen, _: Invariant) -> float:
    """Return the largest |L(t) - L(0)| over the largest sum m |x - c| |v| + I |omega|, L = sum m (x - c) x v + I omega.

    c: the centre of mass at the start. Only open systems without walls, weight and drag keep it.
    """
    system = seen.system
    if system.walls or system.background or system.gravity or system.periodic:
        raise NotKnown("walls, weight, drag or periodic axes take angular momentum")
    centre = seen.frames[0].mass @ seen.frames[0].x / seen.frames[0].mass.sum()
    found = [angular_parts(f, centre) for f in seen.frames]
    total = np.array([parts.sum(axis=0) for parts, _ in found])
    return largest(np.linalg.norm(total - total[0], axis=1), np.array([size for _, size in found]))


# --- statics -----------------------------------------------------------------------------------------------


def residual(seen: Seen, _: Invariant) -> float:
    """Return the largest |sum f + m g - c v| of a particle in the last frame over the mean contact force."""
    frame, contacts = seen.frames[-1], seen.frames[-1].snapshot.contacts
    if contacts is None or not contacts.rows:
        raise NotKnown("the last frame has no contacts")
    force = contacts.vector(*(f"f{a}" for a in frame.snapshot.axes))
    net = np.zeros_like(frame.x)
    np.add.at(net, contacts["i"].astype(int) - 1, force)
    among = contacts["j"] > 0
    np.subtract.at(net, contacts["j"][among].astype(int) - 1, force[among])
    if seen.system.gravity is not None:
        net += frame.mass[:, None] * np.array(seen.system.gravity)
    if seen.system.background is not None:
        net -= seen.system.background.translational_drag * frame.v
    return float(np.linalg.norm(net, axis=1).max() / np.linalg.norm(force, axis=1).mean())


def quiet(seen: Seen, _: Invariant) -> float:
    """Return the kinetic energy of the last frame over the elastic one: what rests has none."""
    if not seen.elastic[-1] > 0:
        raise NotKnown("nothing touches in the last frame")
    return float(seen.kinetic[-1] / seen.elastic[-1])


def column(seen: Seen, _: Invariant) -> float:
    """Return the largest deviation of a column's overlaps from d_k = sum of the weights above contact k over k_n.

    Newton's first law for every body of a stack on the first plane, linear contacts: times k_n over that of the lowest
    contact, relative to the lowest overlap.
    """
    frame, weight = seen.frames[-1], np.linalg.norm(seen.system.gravity)
    order = np.argsort(frame.x[:, -1])
    x, radius, mass = frame.x[order, -1], frame.radius[order], frame.mass[order]
    found = np.concatenate([[radius[0] - x[0]], radius[1:] + radius[:-1] - np.diff(x)])
    stiffness = stiffness_of_contacts(seen.system, order, np.array([-1, *order[:-1]]))
    wanted = np.cumsum(mass[::-1])[::-1] * weight / stiffness
    return float(np.abs((found - wanted) * (stiffness / stiffness[0])).max() / wanted[0])


def wall_load(seen: Seen, _: Invariant) -> float:
    """Return |mean force on the loaded wall + load| over the load, in the last quarter of the samples."""
    loaded = [w for w in seen.system.walls if isinstance(w.motion, Loaded)]
    series = seen.series
    late = slice(3 * len(series["time"]) // 4, None)
    sizes = []
    for wall in loaded:
        force = sum(n * series[f"{wall.name}_f{a}"][late] for n, a in zip(wall.normal, "xyz", strict=False))
        sizes.append(abs(force.mean() + wall.motion.load) / abs(wall.motion.load))
    if not sizes:
        raise NotKnown("no wall carries a load")
    return most(sizes)


def isostatic(seen: Seen, _: Invariant) -> float:
    """Return |C/(2 N') - 1| of the last frame: C contacts, also with walls, of N' discs that are no rattlers (2D).

    Frictionless discs in balance need two contacts each, to balance two components of force; at vanishing pressure
    there are no more (Moukarzel, PRL 81, 1634 (1998)). A disc with fewer than three contacts is a rattler, and what
    leans on it alone is another.
    """
    contacts = seen.frames[-1].snapshot.contacts
    if contacts is None:
        raise NotKnown("contacts were not recorded")
    i, j = contacts["i"].astype(int), contacts["j"].astype(int)
    rattles = np.zeros(len(seen.system.particles) + 1, bool)
    while True:
        on = ~rattles[i] & ~rattles[np.maximum(j, 0)]
        held = np.bincount(i[on], minlength=len(rattles)) + np.bincount(j[on & (j > 0)], minlength=len(rattles))
        more = (held < 3) & ~rattles
        more[0] = False
        if not more.any():
            break
        rattles |= more
    bearing = len(rattles) - 1 - int(rattles.sum())
    if not bearing:
        raise NotKnown("no disc bears a load")
    return float(abs(on.sum() / (2.0 * bearing) - 1.0))


# --- closed forms ----------------------------------------------------------------------------------------


def free_flight(seen: Seen, _: Invariant) -> float:
    """Return the largest |x(t) - x(0) - v(0) t - g t^2/2| over the largest way: bodies that meet nothing."""
    gravity = np.zeros(seen.system.dimension) if seen.system.gravity is None else np.array(seen.system.gravity)
    first, found, ways = seen.frames[0], [], []
    for frame in seen.frames:
        way = first.v * frame.time + gravity * frame.time**2 / 2
        found.append(float(np.abs(nearest_image(frame.x - first.x - way, seen.system.periodic)).max()))
        ways.append(float(np.abs(way).max()))
    return largest(np.array(found), np.array(ways))


def end_velocities(seen: Seen, promise: Invariant) -> float:
    """Return the largest deviation of the last velocities from `values`, body by body, over the largest of them."""
    wanted = np.array(promise.values, float).reshape(seen.frames[-1].v.shape)
    return float(np.abs(seen.frames[-1].v - wanted).max() / np.abs(wanted).max())


def restitution(seen: Seen, _: Invariant) -> float:
    """Return |e - e_exact| of the only two bodies, or of one body and one plane, met head on.

    e: relative speed after over before, along the line of centres at the start. e_exact: of the linear law
    exp(-b t_contact) (Schwager & Poeschel, Granular Matter 9, 465 (2007)); of Hertz' law the e of the scene; of the
    hysteretic one its closed form (`reference.analytic`).
    """
    before, after = (parting_rate(seen, frame) for frame in (seen.frames[0], seen.frames[-1]))
    return abs(-after / before - exact_restitution(seen))


def order(seen: Seen, _: Invariant) -> float:
    """Return how many neighbours along x ever changed places: bodies on a line cannot pass through one another."""
    first = np.argsort(seen.frames[0].x[:, 0])
    return most(float((~(np.diff(f.x[first, 0]) > 0)).sum()) for f in seen.frames)


def rigid(seen: Seen, _: Invariant) -> float:
    """Return the largest change of a distance between two bodies over that distance at the start."""
    i, j = np.triu_indices(len(seen.frames[0].x), 1)

    def distances(frame: Frame) -> np.ndarray:
        return np.linalg.norm(nearest_image(frame.x[j] - frame.x[i], seen.system.periodic), axis=1)

    start = distances(seen.frames[0])
    return most(float((np.abs(distances(f) - start) / start).max()) for f in seen.frames)


def turns(seen: Seen, promise: Invariant) -> float:
    """Return |turns - values[0]|/values[0]: turns of the line from body 1 to body 2 about z, from its mean rate.

    The rate is L/(m* r^2) with L the z component of the orbital angular momentum of the two, averaged over frames.
    Of a body that turns about another axis, at right angles to the line, it is the z component of its turns.
    """
    rates = []
    for f in seen.frames:
        r, v = f.x[1] - f.x[0], f.v[1] - f.v[0]
        rates.append((r[0] * v[1] - r[1] * v[0]) / (r @ r))
    found = np.mean(rates) * seen.frames[-1].time / (2 * np.pi)
    return float(abs(found / promise.values[0] - 1.0))


def no_ratchet(seen: Seen, _: Invariant) -> float:
    """Return how far the swing of the first body has moved, or changed in size, over its first size.

    The body's component that swings most; middle and half width of its range in the first and the last quarter.
    """
    x = np.array([f.x[0] for f in seen.frames])
    y = x[:, np.ptp(x, axis=0).argmax()]
    quarter = max(len(y) // 4, 2)
    early, late = (np.array([part.min(), part.max()]) for part in (y[:quarter], y[-quarter:]))
    return float(max(abs(late.mean() - early.mean()), abs(np.ptp(late) - np.ptp(early)) / 2) / (np.ptp(early) / 2))


def on_diagonal(seen: Seen, _: Invariant) -> float:
    """Return the largest difference of components of the first body over its radius: a corner is alike on all axes."""
    return most(float(np.ptp(f.x[0] - seen.frames[0].x[0]) / f.radius[0]) for f in seen.frames)


def twin(seen: Seen, promise: Invariant, other: Seen) -> float:
    """Return the largest deviation from the twin's run, its lengths and times scaled.

    |x - s x' - shift| in largest radii, |v - v' s/t| and |omega - omega'/t| a in largest speeds of all frames:
    mechanics has no unit of its own, so another unit may change nothing but rounding.
    """
    if len(seen.frames) != len(other.frames):
        raise NotKnown("the twin has other frames")
    wanted, periodic = promise.twin, seen.system.periodic
    speed = most(float(np.abs(f.v).max()) for f in seen.frames)
    speed = most([speed, *(float(np.abs(f.spin * f.radius[:, None]).max()) for f in seen.frames)])
    pairs = list(zip(seen.frames, other.frames, strict=True))
    apart = [places_apart(mine, theirs, wanted, periodic) for mine, theirs in pairs]
    return most([*apart, *(rates_apart(mine, theirs, wanted, speed) for mine, theirs in pairs)])


KINDS: dict[str, Kind] = {
    "finite": Kind(measure=finite, says="recorded values that are no finite numbers", ruin=0.5),
    "contained": Kind(measure=contained, says="particles lost", ruin=0.5),
    "meets": Kind(measure=meets, says="no frame shows a contact", ruin=2.0),
    "overlap": Kind(measure=overlap, says="largest overlap over the smaller radius", ruin=1.0),
    "energy": Kind(measure=energy, says="largest change of energy, relative", ruin=0.1),
    "neighbouring_energy": Kind(
        measure=neighbouring_energy, says="change of the energy that the scheme keeps, relative", ruin=0.1
    ),
    "energy_drift": Kind(measure=energy_drift, says="drift of energy over the run, relative", ruin=0.1),
    "energy_not_created": Kind(measure=energy_not_created, says="energy created, relative", ruin=0.1),
    "energy_falls": Kind(measure=energy_falls, says="rise of energy, relative", ruin=0.1),
    "kinetic_kept": Kind(measure=kinetic_kept, says="change of kinetic energy, relative", ruin=0.1),
    "momentum": Kind(measure=momentum, says="change of momentum, relative", ruin=1e-3),
    "angular_momentum": Kind(measure=angular_momentum, says="change of angular momentum, relative", ruin=1e-2),
    "residual": Kind(measure=residual, says="largest net force over the mean contact force", ruin=1.0),
    "quiet": Kind(measure=quiet, says="kinetic over elastic energy at the end", ruin=0.1),
    "column": Kind(measure=column, says="overlap off its closed form, relative", ruin=0.5),
    "wall_load": Kind(measure=wall_load, says="force on the loaded wall off its load, relative", ruin=0.5),
    "isostatic": Kind(measure=isostatic, says="contacts off two a disc, relative", ruin=0.5),
    "free_flight": Kind(measure=free_flight, says="place off its closed form, relative", ruin=1e-3),
    "end_velocities": Kind(measure=end_velocities, says="last velocity off its closed form, relative", ruin=0.5),
    "restitution": Kind(measure=restitution, says="restitution off its closed form", ruin=0.2),
    "order": Kind(measure=order, says="neighbours that passed through each other", ruin=0.5),
    "rigid": Kind(measure=rigid, says="change of a distance, relative", ruin=0.1),
    "turns": Kind(measure=turns, says="number of turns off, relative", ruin=0.1),
    "no_ratchet": Kind(measure=no_ratchet, says="move of the swing, relative", ruin=1.0),
    "on_diagonal": Kind(measure=on_diagonal, says="way off the diagonal, in radii", ruin=0.1),
    "twin": Kind(measure=twin, says="deviation from the scaled twin", ruin=0.1, twins=True),
}
"""All invariants by the names that hard cases use; a new one is a function and a row."""
