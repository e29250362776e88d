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

from harness.scene.contact import Contact, MindlinSliding
from harness.scene.derived import Derived
from harness.scene.laws import tangential_springs, word
from harness.scene.materials import laws_of_pair
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
            f"{_laws_in_words(limit)} ({limit.entry.engine}, {limit.entry.where}); with a margin of "
            f"{100 * MARGIN:.0f} % take numerics.dt_fraction <= {most:.3g}; {_measured(table)}"
        )
    for late in late_springs(scene.contact, derived):
        if dt > late.held:
            yield f"{late.family} spring without enough dashpot for kernel:talk", (
                f"dt = {dt:.3g} s > gamma/k = {late.held:.3g} s of contact.{late.family}{late.at}: the talks' "
                "algorithm feels this spring one step late, so that contacts that stick swing up unless other dashpots "
                f"hold them, and kernel:talk stops; {late.mend} or a smaller step mends it; no matter of the other "
                f"engines; {_measured(table)}"
            )


FAMILY_DAMPING = {"sliding": "shear_damping", "rolling": "rolling_damping", "torsion": "torsion_damping"}


@dataclass(frozen=True, kw_only=True)
class LateSpring:
    """A spring that the talks' algorithm feels one step late. held: gamma/k, s, up to which its dashpot holds it.

    at: the overlap, or the pair of materials, that these are taken at, in words, "" where they do not depend
    on it; mend: what lengthens gamma/k.
    """

    family: str
    held: float
    mend: str
    at: str = ""


def late_springs(contact: Contact, derived: Derived) -> Iterator[LateSpring]:
    """Yield the springs that are felt late.

    Mindlin's S_t = 8 G* sqrt(R* delta) grows with the overlap, gamma_t with the root of it::

        gamma_t/S_t = 2 sqrt(5/6) beta sqrt(m*/S_t)

    is the smallest one at the deepest overlap: that of an impact at `impact_speed`, of the pair where it is smallest.
    Contacts that a load presses deeper are held for shorter.
    """
    for family, damping in FAMILY_DAMPING.items():
        stiffness = damping.replace("damping", "stiffness")
        laws = [(getattr(laws_of_pair(contact, p.pair), family), p.pair) for p in derived.pairs]
        found = [(getattr(law, damping) / getattr(law, stiffness), p) for law, p in laws if hasattr(law, stiffness)]
        if found:
            held, pair = min(found, key=lambda both: both[0])
            at = "" if pair.materials is None else f" of the {pair.name} pair"
            yield LateSpring(family=family, held=held, mend=f"more {damping}", at=at)
    if isinstance(contact.sliding, MindlinSliding):
        yield _late_mindlin(contact, derived)


def _late_mindlin(contact: Contact, derived: Derived) -> LateSpring:
    springs = [(tangential_springs(contact.sliding, contact.normal, p.met), p) for p in derived.pairs]
    held, pair = min(((s.damping / s.stiffness, p) for s, p in springs), key=lambda both: both[0])
    at = (
        f" (~ overlap^-1/4; at the {pair.met.largest_overlap:.3g} m of the {pair.pair.name} pair at "
        "normal.impact_speed)"
    )
    return LateSpring(family="sliding", held=held, mend="a lower normal.restitution", at=at)


def _measured(table: Table) -> str:
    """Say when and by what the table was measured; which engines, and into which file, stands in it."""
    return f"measured {table.date} by `{table.command.partition(' --engines')[0].partition(' --table')[0]}`"


def _laws_in_words(limit: StepLimit) -> str:
    laws = [f"{law} {family}" for family, law in zip(FAMILIES, limit.entry.laws, strict=True) if law]
    return ("" if limit.same_laws else "other laws: ") + ", ".join(laws)
