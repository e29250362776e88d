"""What bodies really leave with, in the laws of one convention: the limit that a code tends to as dt tends to 0.

Two discs with linear laws are solved phase by phase (`reference.analytic.pair_by_events`). Everything else is computed
by the kernel in the second-order scheme, with steps a few times finer than the finest rung; its own error is then
measured: by the phase of the step, by doubling the step, and by the same run in extended precision.

Conventions differ in more than steps (where slip is measured, what the limit of friction is tested on), so each code is
held against the limit of its own; how far the limits are from one another is told apart.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.registry import KERNEL_PREFIX, find_engine
from harness.engines.word import code_of
from harness.scene.contact import LinearNormal, SpringSliding
from harness.studies.accuracy.exits import Exits, errors
from harness.studies.accuracy.phases import Phased, delays, stepped, with_phases
from reference.analytic.pair_by_events import Bodies, PairLaws, collide
from reference.kernel.conventions import CORRECTED, NAMED, Convention

if TYPE_CHECKING:
    from harness.scene.system import System
    from reference.kernel.model import Model

FINER = 4
"""Times finer than the finest rung."""

PHASES = 4
ROUND_OFF_STEP = 0.02
"""Of a contact time: the step at which double and extended precision are compared."""

NUDGE = 1e-6
"""Of the radius: by what starts are displaced to see how chaos grows; well above the jumps of single steps."""

EXACT = 1e-9
"""Error of the solution by events over the speed of the impact: tolerances a hundred times as wide change less."""


@dataclass(frozen=True, kw_only=True)
class Oracle:
    """exits: of one copy (K = 1). error: by quantity, over the speed at the start. kind, says: what it is, in words.

    round_off: what double precision changes. growth: change of the exit over a displacement of the start in radii, in
    the talks' laws, whose scheme is smooth enough to tell. Both None where they were not measured.
    """

    exits: Exits
    error: Mapping[str, float]
    kind: str
    says: str
    round_off: float | None = None
    growth: float | None = None


def convention_of(engine: str) -> str:
    """Return the name of the convention whose limit an engine tends to; the talks' where it is not known.

    >>> convention_of("kernel:corrected"), convention_of("liggghts@3.8")
    ('talk', 'liggghts')
    """
    name = engine.removeprefix(KERNEL_PREFIX)
    code = code_of(name)
    return code if code in NAMED and code != CORRECTED.name else "talk"


def oracle(system: System, convention: str, *, file: Path, contact_time: float, finest: float) -> Oracle:
    """Return the oracle of a system without copies. finest: the smallest step of the ladder, s."""
    if solved_by_events(system):
        return _by_events(system, NAMED[convention])
    return _by_kernel(system, convention, file=file, contact_time=contact_time, finest=finest)


def solved_by_events(system: System) -> bool:
    """Whether it is two bodies in a plane with linear laws and nothing else."""
    laws = isinstance(system.normal, LinearNormal) and isinstance(system.sliding, SpringSliding | None)
    state = system.sliding is not None and system.sliding.dynamic_friction is not None
    alone = not system.walls and system.rolling is system.torsion is None
    return system.dimension == 2 and len(system.particles) == 2 and laws and not state and alone


def _by_events(system: System, convention: Convention) -> Oracle:
    p = system.particles
    bodies = Bodies(x=p.x, v=p.v, spin=p.spin[:, 0], radius=p.radius, mass=p.mass,
                    inertia=p.inertia_factor * p.mass * p.radius**2)
    parted = collide(bodies, _pair_laws(system, convention))
    exits = Exits(v=parted.v[None], spin=parted.spin[None, :, None])
    tangential = system.sliding is not None
    return Oracle(
        exits=exits, error=dict.fromkeys(("exit", "velocity", *(["spin"] if tangential else [])), EXACT),
        kind="events", says=f"solved by events: {', '.join(parted.phases)}",
    )


def _pair_laws(system: System, convention: Convention) -> PairLaws:
    normal, sliding = system.normal, system.sliding
    rubbing = {} if sliding is None else {
        "shear_friction": sliding.shear_friction, "shear_stiffness": sliding.shear_stiffness,
        "shear_damping": sliding.shear_damping, "slip_arm": convention.slip_arm, "base": convention.limit,
        "tested": "spring" if convention.sliding == "liggghts" else "force",
    }
    return PairLaws(
        normal_stiffness=normal.normal_stiffness, normal_damping=normal.normal_damping, attraction=normal.attraction,
        **rubbing,
    )


# --- by the kernel -----------------------------------------------------------------------------------


def _by_kernel(system: System, convention: str, *, file: Path, contact_time: float, finest: float) -> Oracle:
    fine, coarse = (_mean_exits(system, convention, file, dt=finest / n) for n in (FINER, FINER / 2))
    turns = system.sliding is not None or system.rolling is not None or system.torsion is not None
    best = fine[0]
    halved = errors(coarse[0], best, system, turns=turns)
    spread = errors(fine[1], best, system, turns=turns)
    error = {q: float(max(halved[q].max(), np.sqrt((spread[q] ** 2).mean()))) for q in halved}
    round_off = _round_off(system, convention, file, dt=ROUND_OFF_STEP * contact_time, turns=turns)
    return Oracle(
        exits=best, error=error, kind="kernel", round_off=round_off,
        growth=_growth(system, convention, file, dt=finest, turns=turns) if convention == "talk" else None,
        says=f"second-order kernel at {finest / FINER / contact_time:.3g} contact times a step",
    )


def _mean_exits(system: System, convention: str, file: Path, *, dt: float) -> tuple[Exits, Exits]:
    """Return the mean over a few phases, and the phases."""
    phased = with_phases(stepped(system, dt, system.dt * system.steps), delays(PHASES, dt), file)
    found = _exits(phased, second_order(phased.system, convention))
    return Exits(v=found.v.mean(axis=0, keepdims=True), spin=found.spin.mean(axis=0, keepdims=True)), found


def _round_off(system: System, convention: str, file: Path, *, dt: float, turns: bool) -> float:
    """Difference of the exits in double and extended precision, the same steps in both, by the textbook evaluation."""
    from reference.kernel.corrected import simulate

    phased = with_phases(stepped(system, dt, system.dt * system.steps), np.zeros(1), file)
    model = second_order(phased.system, convention)
    found = []
    for each in (model, model.in_long_double()):
        simulation = simulate(each)
        simulation.advance(phased.system.steps)
        found.append(_states(simulation, phased))
    return float(errors(*found, system, turns=turns)["exit"].max())


def _growth(system: System, convention: str, file: Path, *, dt: float, turns: bool) -> float:
    """Return rms change of the exit over the rms displacement of the start in radii, eight directions drawn."""
    phased = with_phases(stepped(system, dt, system.dt * system.steps), np.zeros(9), file)
    p = phased.system.particles
    size = NUDGE * float(p.radius.mean())
    moved = size * np.random.default_rng(3).standard_normal(p.x.shape)
    moved[: phased.bodies] = 0.0
    nudged = replace(phased, system=phased.system.with_(particles=replace(p, x=p.x + moved)))
    found = _exits(nudged, second_order(nudged.system, convention))
    still = Exits(v=found.v[:1], spin=found.spin[:1])
    changed = errors(Exits(v=found.v[1:], spin=found.spin[1:]), still, system, turns=turns)["exit"]
    return float(np.sqrt((changed**2).mean()) / NUDGE)


def second_order(system: System, convention: str) -> Model:
    """Return the kernel's model of a system: a convention's laws in the second-order scheme."""
    from reference.kernel.deck import read_deck

    name = CORRECTED.name if convention == "talk" else convention
    with tempfile.TemporaryDirectory(prefix="grainproof-oracle-") as folder:
        for file, text in find_engine(KERNEL_PREFIX + name).render(system).items():
            (Path(folder) / file).write_text(text)
        model, _ = read_deck(Path(folder))
    return replace(model, convention=replace(model.convention, scheme="corrected"))


def _exits(phased: Phased, model: Model) -> Exits:
    from reference.kernel.program.simulation import fastest

    simulation = fastest(model)
    simulation.advance(phased.system.steps)
    return _states(simulation, phased)


def _states(simulation, phased: Phased) -> Exits:
    count, state = len(phased.system.particles), simulation.state
    shape = (len(phased.delay), phased.bodies, -1)
    return Exits(v=state.v[:, :count].T.reshape(shape), spin=state.spin[:, :count].T.reshape(shape))
