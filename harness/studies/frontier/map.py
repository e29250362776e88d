"""The map: one property of the random packing is varied at a time, everything else as in a base case."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

from harness.scene.contact import Contact
from harness.studies.frontier.laws import ELASTIC, FRICTION, LawCase, linear, spring
from harness.studies.frontier.packings import RANDOM, PackingCase, random_discs


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One property. law, packing: of one of its values; values: of the quick and of the full size."""

    name: str
    quick: tuple[float, ...]
    full: tuple[float, ...]
    law: Callable[[float], LawCase]
    packing: Callable[[float], PackingCase] = field(default=lambda _: RANDOM)

    def values(self, *, full: bool) -> tuple[float, ...]:
        """Return the values of a size."""
        return self.full if full else self.quick


def _stiffness(ratio: float) -> LawCase:
    return LawCase(name=FRICTION.name, contact=Contact(normal=linear(), sliding=spring(ratio=ratio)))


def _friction(coefficient: float) -> LawCase:
    return LawCase(name=FRICTION.name, contact=Contact(normal=linear(), sliding=spring(friction=coefficient)))


def _damping(ratio: float) -> LawCase:
    contact = Contact(normal=linear(damping=ratio), sliding=spring(damping=ratio / 2))
    return LawCase(name="friction spring, dashpots", contact=contact)


def _sizes(ratio: float) -> PackingCase:
    return PackingCase(name=RANDOM.name, dimension=2, make=partial(random_discs, size_ratio=ratio))


AXES = (
    Axis(name="k_t/k_n", quick=(0.01, 0.1, 0.3, 1.0), full=(0.01, 0.03, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0), law=_stiffness),
    Axis(name="mu", quick=(0.1, 1.0), full=(0.03, 0.1, 0.3, 1.0, 10.0), law=_friction),
    Axis(
        name="damping ratio", quick=(0.03, 0.3, 1.0, 3.0), full=(0.01, 0.03, 0.1, 0.3, 0.6, 1.0, 2.0, 3.0, 10.0),
        law=_damping,
    ),
    Axis(
        name="size ratio", quick=(1.5, 4.0), full=(1.2, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0), law=lambda _: ELASTIC,
        packing=_sizes,
    ),
    Axis(
        name="size ratio, friction", quick=(1.5, 4.0), full=(1.2, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0),
        law=lambda _: FRICTION, packing=_sizes,
    ),
)
