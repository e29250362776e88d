"""Time step, its stability limit, and how steps are divided among samples and frames."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from harness.scene.contact import Contact, NormalLaw
from harness.scene.fault import Fault
from harness.scene.grains import Grains, Pair
from harness.scene.law_scales import HeadOn
from harness.scene.laws import Springs, head_on, tangential_springs
from harness.scene.materials import laws_of_pair
from harness.scene.model import Background, Biaxial, Free, LoadedMotion, Scene, SideWall

MOST_STEPS = 2_000_000_000
"""Step counters of the engines are 32-bit integers."""

USUAL_FRACTION = 0.02
"""Of a contact time: a usual time step."""

DEEPEST = 0.5
"""Largest overlap of an impact over R* that a law for small overlaps is taken to."""

COORDINATION = {2: 6, 3: 12}
"""Neighbours in the densest packing of equal particles: triangular lattice, FCC."""


@dataclass(frozen=True, kw_only=True)
class StepPlan:
    """dt (s) and step counts; `sample_every` and `frame_every` divide `steps`."""

    dt: float
    steps: int
    sample_every: int
    frame_every: int


@dataclass(frozen=True, kw_only=True)
class PairScales:
    """A pair of the scene and what its law makes of it head-on."""

    pair: Pair
    met: HeadOn


@dataclass(frozen=True, kw_only=True)
class StabilityLimit:
    """Largest stable dt (s), the part of the system that sets it ("particles" or a wall's name), its zeta."""

    dt: float
    part: str
    damping_ratio: float


def requested_step(scene: Scene, grains: Grains) -> float:
    """Return dt_fraction times the time scale of the smallest pair, s."""
    return scene.numerics.dt_fraction * met_head_on(scene.contact, grains)[0].met.time_scale


def met_head_on(contact: Contact, grains: Grains) -> tuple[PairScales, ...]:
    """Return the pairs under their laws: the smallest first, with materials the one of the shortest time."""
    found = [PairScales(pair=p, met=head_on(laws_of_pair(contact, p).normal, p)) for p in grains.pairs]
    return tuple(sorted(found, key=lambda s: s.met.time_scale) if grains.parts else found)


def plan_steps(scene: Scene, grains: Grains) -> StepPlan:
    """Round the number of steps up to a common multiple of samples and frames; dt = duration/steps.

    So dt is never larger than asked for, the run ends exactly at the duration, and every sample and
    frame falls on a step.
    """
    needed = _steps_needed(scene, grains)
    block = math.lcm(scene.outputs.samples, scene.outputs.frames)
    steps = -(-needed // block) * block
    return StepPlan(
        dt=scene.duration / steps, steps=steps,
        sample_every=steps // scene.outputs.samples, frame_every=steps // scene.outputs.frames,
    )


def stability_limit(scene: Scene, grains: Grains) -> StabilityLimit:
    """Return the step below which velocity Verlet with lagged damping is stable in a dense packing.

    For a mode of frequency w and damping ratio zeta, the dashpot seeing half-step velocities::

        dt < (2/w) (sqrt(1 + zeta^2) - zeta)

    (at the limit the growth factor of the leapfrog is -1: 4 - (w dt)^2 - 4 zeta w dt = 0).
    Particles: w^2 = Z {max[k_n + k_t (1 + 1/q), 2 k_t/q] + s k_r/q} / m_min with Z = 6 in 2D, 12 in 3D,
    and 2 zeta w the same with dashpots for springs, plus the background drag over m_min. In 2D the two
    cases bound the translations (w^2 = 6 k/m without friction, exact) and the spins of a triangular
    lattice of equal particles; 12 lies above the exact 8 of FCC. k_r, the larger one of the rolling and
    the torsion stiffness, which act about axes at right angles, adds at most s k_r/q to either
    (s: `Grains.turning_share`). A wall with mass M touched by n particles: w^2 = 2 n k_n/M,
    2 zeta w = (2 n gamma_n + gamma_wall)/M.

    k_n, k_t and their dashpots are the largest that the laws show: k_2 or k_p of a hysteretic law; of laws
    that stiffen, those at the largest overlap of an impact at `impact_speed`. With materials the particles of each are
    asked with the largest springs and dashpots that they meet, m_min the lightest of that material: the rows of the
    stiffness matrix over the masses, which bound its eigenvalues, know the springs of one particle only.
    Dense disc packings became unstable at 1.2 times this limit or later (measured with linear laws, LAMMPS
    and LIGGGHTS).
    """
    limits = [particle_limit(scene.contact, grains, scene.background)]
    limits += [_wall_limit(name, wall, scene.contact, grains) for name, wall in loaded_walls(scene)]
    return min(limits, key=lambda limit: limit.dt)


def particle_limit(contact: Contact, grains: Grains, background: Background | None = None) -> StabilityLimit:
    """Return the part of `stability_limit` that the particles set."""
    return min((_part_limit(contact, part, background) for part in grains.parts or (grains,)), key=lambda s: s.dt)


def _part_limit(contact: Contact, grains: Grains, background: Background | None) -> StabilityLimit:
    square, rate = _particle_rates(contact, grains)
    if background:
        rate += background.translational_drag * grains.inverse_mass
    return _limit("particles", square, rate)


def stiffest_at_wall(contact: Contact, grains: Grains) -> HeadOn:
    """Return what the stiffest contact at a wall shows: of the heaviest particle, by any law of materials."""
    laws = [laws_of_pair(contact, pair) for pair in grains.pairs if pair.at_wall] or [contact]
    return max((head_on(c.normal, grains.heaviest) for c in laws), key=lambda met: met.stiffness)


def leapfrog_limit(square: float, rate: float) -> float:
    """Return (2/w)(sqrt(1+zeta^2) - zeta) from w^2 (1/s^2) and 2 zeta w (1/s), without cancellation."""
    return 4 / (rate + math.hypot(rate, 2 * math.sqrt(square)))


def loaded_walls(scene: Scene) -> list[tuple[str, LoadedMotion | SideWall]]:
    """Return name and table of the walls that move under a load."""
    if isinstance(scene, Biaxial):
        return [("right", scene.side)]
    planes = scene.planes if isinstance(scene, Free) else ()
    return [(p.name, p.motion) for p in planes if isinstance(p.motion, LoadedMotion)]


def numerics_faults(scene: Scene, grains: Grains) -> Iterator[Fault]:
    """Yield what is wrong with time step and outputs."""
    yield from _deep_impact_fault(scene.contact.normal, grains)
    yield from _stability_fault(scene, grains)
    needed = _steps_needed(scene, grains)
    if needed > MOST_STEPS:
        place = "top.duration" if isinstance(scene, Biaxial) else "duration"
        yield Fault(
            place=place, expected=f"at most {MOST_STEPS} steps of {requested_step(scene, grains):.3g} s",
            got=f"{needed:.3g} steps in {scene.duration:g} s", fix="shorten the run or soften the contacts",
        )
    steps = plan_steps(scene, grains).steps
    if steps > 2 * needed:
        yield Fault(
            place="outputs", fix="take fewer, and frames that divide samples",
            expected=f"samples and frames with a common multiple of at most twice the {needed} steps needed",
            got=f"samples = {scene.outputs.samples}, frames = {scene.outputs.frames}",
        )


def _stability_fault(scene: Scene, grains: Grains) -> Iterator[Fault]:
    limit, dt = stability_limit(scene, grains), requested_step(scene, grains)
    if dt <= limit.dt:
        return
    largest = scene.numerics.dt_fraction * limit.dt / dt
    yield Fault(
        place="numerics.dt_fraction",
        expected=f"at most {largest:.3g}, the stability limit dt = 2/omega (sqrt(1 + zeta^2) - zeta) "
        f"= {limit.dt:.3g} s of the {limit.part}",
        got=f"{scene.numerics.dt_fraction:g} (dt = {dt:.3g} s)",
        fix=_stability_fix(limit, largest),
    )


def _stability_fix(limit: StabilityLimit, largest: float) -> str:
    """Name what else would help: beyond zeta = 1 damping shortens the step more than stiffness does."""
    if limit.part != "particles":
        return "lower it, or make the wall heavier"
    if limit.damping_ratio > 1:
        return f"lower it, or the damping: zeta = {limit.damping_ratio:.3g} is what makes the limit so small"
    return "lower it; 0.02 to 0.05 is usual" if largest >= USUAL_FRACTION else "lower it"


def _steps_needed(scene: Scene, grains: Grains) -> int:
    """Duration over the requested step, rounded up; 1e-9 of a step is round-off."""
    return max(1, math.ceil(scene.duration / requested_step(scene, grains) - 1e-9))


def _deep_impact_fault(normal: NormalLaw, grains: Grains) -> Iterator[Fault]:
    """Laws for small overlaps mean nothing when bodies run into each other's cores."""
    for pair in grains.pairs:
        overlap = head_on(normal, pair).largest_overlap
        if overlap is not None and overlap > DEEPEST * pair.reduced_radius:
            yield Fault(
                place="contact.normal.impact_speed", fix="lower it, or make the bodies stiffer",
                expected=f"a speed at which the overlap stays below R*/2 = {DEEPEST * pair.reduced_radius:.3g} m",
                got=f"{normal.impact_speed:g}, which presses the {pair.name} pair {overlap:.3g} m together",
            )


def _particle_rates(contact: Contact, grains: Grains) -> tuple[float, float]:
    """W^2 (1/s^2) and 2 zeta w (1/s) of the fastest mode of the particles."""
    squares, rates = zip(*(_rates_under(laws, grains) for laws in _laws_met(contact, grains)), strict=True)
    return max(squares), max(rates)


def _laws_met(contact: Contact, grains: Grains) -> list[Contact]:
    """Return the laws of all pairs, which are one without materials; those of no pair, of a part, are of no use."""
    found = {laws_of_pair(contact, pair): None for pair in grains.pairs}
    return list(found) or [contact]


def _rates_under(contact: Contact, grains: Grains) -> tuple[float, float]:
    met = head_on(contact.normal, grains.lightest)
    laws = (contact.sliding, contact.rolling, contact.torsion)
    sliding, rolling, torsion = (tangential_springs(law, contact.normal, met) for law in laws)
    turning = Springs(*(max(pair) for pair in zip(rolling, torsion, strict=True)))
    stiffness = _network_rate(met.stiffness, sliding.stiffness, turning.stiffness, grains)
    return stiffness, _network_rate(met.damping, sliding.damping, turning.damping, grains)


def _network_rate(normal: float, shear: float, turning: float, grains: Grains) -> float:
    """Z {max[c_n + c_t (1 + 1/q), 2 c_t/q] + s c_r/q} / m_min for springs or dashpots c."""
    both = normal * grains.inverse_mass + shear * (grains.inverse_mass + grains.inverse_turning)
    spins = grains.turning_share * turning * grains.inverse_turning
    return COORDINATION[grains.dimension] * (max(both, 2 * shear * grains.inverse_turning) + spins)


def _wall_limit(name: str, wall: LoadedMotion | SideWall, contact: Contact, grains: Grains) -> StabilityLimit:
    contacts, met = 2 * grains.per_wall, stiffest_at_wall(contact, grains)
    square = contacts * met.stiffness / wall.mass
    rate = (contacts * met.damping + wall.damping) / wall.mass
    return _limit(f'wall "{name}"', square, rate)


def _limit(part: str, square: float, rate: float) -> StabilityLimit:
    return StabilityLimit(
        dt=leapfrog_limit(square, rate), part=part, damping_ratio=rate / (2 * math.sqrt(square))
    )


