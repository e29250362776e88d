"""A law of the scene in LIGGGHTS' words, and how well they mean what the scene means."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from harness.engines.liggghts.law.kinds import Kind
from harness.engines.protocol import Level
from harness.engines.text import number as written
from harness.scene.system import System

Value = float | Callable[[Kind, Kind], float]
"""One number, or one for each two kinds that touch."""


@dataclass(frozen=True, kw_only=True)
class Constant:
    """A `property/global`: a table over pairs of types, over types, or one number.

    smooth: its value where a wall takes part that only pushes; None: no other than elsewhere.
    """

    value: Value
    smooth: float | None = None
    over: Literal["peratomtypepair", "peratomtype", "scalar"] = "peratomtypepair"

    def line(self, name: str, kinds: Sequence[Kind]) -> str:
        """Return the command that defines it."""
        if self.over == "scalar":
            return f"fix {name} all property/global {name} scalar {written(self.value)}"
        if self.over == "peratomtype":
            table = " ".join([written(self.value)] * len(kinds))
            return f"fix {name} all property/global {name} peratomtype {table}"
        table = " ".join(written(self._of(a, b)) for a in kinds for b in kinds)
        return f"fix {name} all property/global {name} peratomtypepair {len(kinds)} {table}"

    def _of(self, a: Kind, b: Kind) -> float:
        if self.smooth is not None and (a.smooth or b.smooth):
            return self.smooth
        return self.value(a, b) if callable(self.value) else self.value


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """How LIGGGHTS stands to one effect."""

    level: Level
    note: str


@dataclass(frozen=True, kw_only=True)
class Words:
    """One law: the words of its model, its constants by name, its settings, a comment for the deck.

    judged: by effect, how well this is what the scene means; "unsupported" says why it is not. history:
    what contacts remember for it, one name a number, in LIGGGHTS' order; `ux`, `uy`, `uz` are the spring.
    by_body: some constant differs from one pair of bodies to another. moved_by_output: why its history changes
    whenever contacts are written, "" if it does not.
    """

    model: str = ""
    comment: str = ""
    constants: Mapping[str, Constant] = field(default_factory=dict)
    settings: tuple[str, ...] = ()
    judged: Mapping[str, Judgement] = field(default_factory=dict)
    history: tuple[str, ...] = ()
    by_body: bool = False
    moved_by_output: str = ""


def of_pair(system: System, family: str, number: str) -> Value:
    """Return a number of the "normal" or "sliding" law: one, or with materials one for each two of them."""
    if system.materials is None:
        return getattr(getattr(system, family), number)
    table, place = system.materials.table(family, number), system.materials.number
    return lambda a, b: float(table[place(a.material), place(b.material)])


def exact(note: str) -> Judgement:
    """Return: the same formula."""
    return Judgement(level="exact", note=note)


def equivalent(note: str) -> Judgement:
    """Return: the same after a stated mapping, or in a stated variant."""
    return Judgement(level="equivalent", note=note)


def unsupported(note: str) -> Judgement:
    """Return: not to be had; `note` says why."""
    return Judgement(level="unsupported", note=note)
