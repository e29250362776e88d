"""Is a scene's time step near the largest one that was measured to be stable? A table answers; nothing is run.

`grainproof frontier` measures, for each kind of laws and each engine, the largest stable step over that of the formula
beyond which scenes are refused (`harness.scene.numerics.particle_limit`). Times the formula's step of the scene at
hand, the smallest of them is the measured limit that the scene is held against.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import resources

from harness.scene.contact import Contact
from harness.scene.derived import Derived
from harness.scene.laws import word
from harness.scene.model import Scene
from harness.scene.numerics import particle_limit

TABLE = "frontier.toml"

MARGIN = 0.2
"""A step closer to the measured limit than this part of it is warned of: what is not seen in small motions (contacts
that close, sizes that meet as they did not in the packings measured) needs room."""

FAMILIES = ("normal", "sliding", "rolling", "torsion")


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One entry: the smallest measured step over the formula's, of how many, and where."""

    engine: str
    of_formula: float
    count: int
    where: str
    dimension: int
    laws: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Table:
    """All entries; date and command of the measurement."""

    entries: tuple[Measured, ...]
    date: str
    command: str
    versions: dict[str, str]


@dataclass(frozen=True, kw_only=True)
class StepLimit:
    """The measured limit of a scene, s. same_laws: the entry is of the scene's own kind of laws, not of others."""

    dt: float
    entry: Measured
    same_laws: bool


@cache
def frontier_table() -> Table:
    """Return the committed table."""
    raw = tomllib.loads(resources.files(__package__).joinpath(TABLE).read_text(encoding="utf-8"))
    entries = tuple(
        Measured(
            engine=row["engine"], of_formula=row["of_formula"], count=row["count"], where=row["where"],
            dimension=row["dimension"], laws=tuple(row[family] for family in FAMILIES),
        )
        for row in raw["measured"]
    )
    return Table(entries=entries, date=raw["date"], command=raw["command"], versions=raw["versions"])


def measured_limit(scene: Scene, derived: Derived, table: Table | None = None) -> StepLimit:
    """Return the smallest measured limit of the scene's kind of laws; of all of its dimension where none is known."""
    table = table or frontier_table()
    laws = tuple("" if law is None else word(law) for law in (getattr(scene.contact, f) for f in FAMILIES))
    near = [e for e in table.entries if e.dimension == scene.dimension]
    same = [e for e in near if e.laws == laws]
    entry = min(same or near, key=lambda e: e.of_formula)
    formula = particle_limit(scene.contact, derived.grains, scene.background).dt
    return StepLimit(dt=entry.of_formula * formula, entry=entry, same_laws=bool(same))


def step_warnings(scene: Scene, derived: Derived, table: Table | None = None) -> Iterator[tuple[str, str]]:
    """Yield (what, why and what to do) for a step too near the measured limit, and for friction springs felt late."""
    table, dt = table or frontier_table(), derived.plan.dt
    limit = measured_limit(scene, derived, table)
    if dt > (1 - MARGIN) * limit.dt:
        most = scene.numerics.dt_fraction * (1 - MARGIN) * limit.dt / dt
        yield "time step near the measured limit", (
            f"dt = {dt:.3g} s is {100 * dt / limit.dt:.0f} % of {limit.dt:.3g} s, the largest stable step measured for "
            f"{_laws_in_words(limit)} ({limit.entry.engine}, {limit.entry.where}; {table.date}); with a margin of "
            f"{100 * MARGIN:.0f} % take numerics.dt_fraction <= {most:.3g}; measured by: {table.command}"
        )
    for family, step in late_springs(scene.contact):
        if dt > step:
            yield f"{family} spring without enough dashpot for kernel:talk", (
                f"dt = {dt:.3g} s is larger than gamma/k = {step:.3g} s of contact.{family}: the talks' algorithm "
                f"feels this spring one step late, and small motions of contacts that stick grow slowly at any larger "
                f"step unless other dashpots hold them (measured {table.date}: {table.command}); no matter of the "
                f"other engines; more {FAMILY_DAMPING[family]} or a smaller step mends it"
            )


FAMILY_DAMPING = {"sliding": "shear_damping", "rolling": "rolling_damping", "torsion": "torsion_damping"}


def late_springs(contact: Contact) -> Iterator[tuple[str, float]]:
    """Yield family and gamma/k, s, of the springs that the talks' algorithm feels one step late."""
    for family, damping in FAMILY_DAMPING.items():
        law = getattr(contact, family)
        stiffness = getattr(law, damping.replace("damping", "stiffness"), None)
        if stiffness is not None:
            yield family, getattr(law, damping) / stiffness


def _laws_in_words(limit: StepLimit) -> str:
    laws = [f"{law} {family}" for family, law in zip(FAMILIES, limit.entry.laws, strict=True) if law]
    return ("" if limit.same_laws else "other laws: ") + ", ".join(laws)
