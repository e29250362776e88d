"""What the ring study computes: the published densities (paper), or small rings of two densities (quick).

Besides, one ring that turns twice as fast, which shows what the rate does, and one with friction springs, without which
contacts have no curvature, and so no torque stiffness. The shipped scenes are taken as they are, so that runs which
`grainproof compare` has left below ``--out`` are found again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from msgspec.structs import replace

from harness.scene.checks import first_fault
from harness.scene.load import load_scene
from harness.scene.model import Couette
from harness.studies.reproduce.boxes import shipped
from harness.studies.reproduce.protocol import Ask, Case, Size

FASTER = 2.0
"""Times omega, and as much shorter, so that the ring turns as far."""


@dataclass(frozen=True, kw_only=True)
class Plan:
    """One ring: file and name; counts of the two species if they differ from the file's; seconds if they do.

    density: a letter of the published series, or "". steady: time from which averages are taken, s.
    """

    name: str
    file: str
    density: str = ""
    counts: tuple[int, int] | None = None
    duration: float | None = None
    steady: float | None = None
    frames: int | None = None
    faster: bool = False


LONG = {"duration": 120.0, "steady": 60.0, "frames": 240}
"""Of the published series: averages from 60 to 120 s, as recalled; the shipped scenes stop at 60 s."""

PLANS: dict[Size, tuple[Plan, ...]] = {
    "quick": (
        Plan(name="small ring, dense", file="couette_quick"),
        Plan(name="small ring, loose", file="couette_quick", counts=(813, 130)),
        Plan(name="small ring, dense, twice as fast", file="couette_quick", faster=True),
        Plan(name="small ring, springs", file="couette_spring"),
    ),
    "paper": (
        Plan(name="density A", file="couette_a", density="a", **LONG),
        Plan(name="density B", file="couette_b", density="b", **LONG),
        Plan(name="density C", file="couette", density="c", **LONG),
        Plan(name="density C, twice as fast", file="couette", faster=True, **LONG),
        Plan(name="small ring, springs", file="couette_spring"),
    ),
}

SPRINGS = "small ring, springs"


def cases_of(ask: Ask, packings: int) -> Sequence[Case]:
    """Return the rings of a size as cases."""
    return [_case(plan, packings) for plan in PLANS[ask.size]]


def plan_of(ask: Ask, name: str) -> Plan:
    """Return the plan of a case."""
    return next(p for p in PLANS[ask.size] if p.name == name)


def main_plans(ask: Ask) -> list[Plan]:
    """Return the plans of densities: neither faster ones nor those with springs."""
    return [p for p in PLANS[ask.size] if not p.faster and p.name != SPRINGS]


def faster_than(ask: Ask) -> tuple[Plan, Plan]:
    """Return the faster ring and the same at its own rate."""
    fast = next(p for p in PLANS[ask.size] if p.faster)
    return fast, next(p for p in main_plans(ask) if fast.name.startswith(f"{p.name}, "))


def _case(plan: Plan, packings: int) -> Case:
    file = shipped(plan.file)
    scene = load_scene(file)
    assert isinstance(scene, Couette)
    scene = _varied(scene, plan)
    fault = first_fault(scene, file.parent)
    if fault:
        raise fault.error(file)
    return Case(name=plan.name, scene=scene, file=file, packings=packings)


def _varied(scene: Couette, plan: Plan) -> Couette:
    changes: dict[str, object] = {}
    if plan.counts is not None:
        species = tuple(replace(s, count=n) for s, n in zip(scene.particles.species, plan.counts, strict=True))
        changes["particles"] = replace(scene.particles, species=species)
    duration, steady = plan.duration or scene.duration, plan.steady or scene.compare.steady_from
    if plan.faster:
        changes["rings"] = replace(scene.rings, omega=FASTER * scene.rings.omega)
        duration, steady = duration / FASTER, steady / FASTER
    if duration != scene.duration:
        frames = plan.frames or scene.outputs.frames
        samples = scene.outputs.samples if plan.frames is None else 25 * frames
        changes |= {
            "duration": duration, "compare": replace(scene.compare, steady_from=steady),
            "outputs": replace(scene.outputs, frames=frames, samples=samples),
        }
    return replace(scene, title=f"Couette ring: {plan.name}", **changes) if changes else scene
