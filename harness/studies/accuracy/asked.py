"""What a user asks for: a knob that the scene has, rungs that make a ladder, a quantity that is computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError
from harness.scene.describe import nearest
from harness.scene.model import Free, Scene

FEWEST, MOST = 2, 40
"""Rungs of a ladder: of one there is nothing to fit, of more nobody asks."""


@dataclass(frozen=True, kw_only=True)
class Knob:
    """One thing that users turn to save time.

    value: what its numbers are. largest: beyond it they mean nothing. ladder: the usual rungs, cheapest first.
    """

    name: str
    value: str
    ladder: tuple[float, ...]
    largest: float


KNOBS: dict[type, dict[str, Knob]] = {
    Free: {
        name: Knob(
            name=name, value="dt_fraction", largest=10.0,
            ladder=(0.64, 0.32, 0.16, 0.08, 0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125),
        )
        for name in ("dt", "scheme")
    },
}
"""By kind of scene; the first is what is turned unless the user says otherwise."""

ELSEWHERE = ("stiffness", "rate", "size", "width", "law")
"""Knobs that have a name and that no kind of scene offers yet."""

QUANTITIES: dict[type, tuple[str, ...]] = {Free: ("exit", "velocity", "spin")}
"""What errors are told of, by kind of scene; the first is the usual one."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """A checked request. values: of the knob, cheapest first."""

    knob: Knob
    values: tuple[float, ...]
    quantity: str


def asked(scene: Scene, file: Path, *, knob: str | None, ladder: Sequence[float] | None, quantity: str | None) -> Asked:
    """Return what is to be done. Raises InputError for what this scene does not have."""
    chosen = _knob(scene, file, knob)
    return Asked(knob=chosen, values=_rungs(chosen, ladder), quantity=_quantity(scene, quantity))


def _knob(scene: Scene, file: Path, name: str | None) -> Knob:
    knobs = KNOBS.get(type(scene), {})
    if not knobs:
        raise InputError(
            file=file, place="kind", expected=f"a kind of scene with a ladder ({', '.join(map(_kind, KNOBS))})",
            got=f'"{_kind(type(scene))}"',
        )
    name = name or next(iter(knobs))
    if name not in knobs:
        known = {k for of in KNOBS.values() for k in of} | set(ELSEWHERE)
        fix = f"scenes of kind {_kind(type(scene))} do not have it" if name in known else nearest(name, list(knobs))
        raise InputError(file="--knob", expected=f"one of {', '.join(knobs)}", got=name, fix=fix)
    return knobs[name]


def _rungs(knob: Knob, ladder: Sequence[float] | None) -> tuple[float, ...]:
    values = knob.ladder if ladder is None else tuple(ladder)
    distinct = len(set(values))
    if not FEWEST <= distinct == len(values) <= MOST:
        got = "one rung" if distinct == 1 else f"{len(values)} rungs, {distinct} of them different"
        raise InputError(
            file="--ladder", expected=f"{FEWEST} to {MOST} different values of {knob.value}", got=got,
            fix="a slope needs several",
        )
    wrong = [v for v in values if not 0.0 < v <= knob.largest]
    if wrong:
        raise InputError(file="--ladder", expected=f"{knob.value} > 0 and <= {knob.largest:g}", got=f"{wrong[0]:g}")
    return tuple(sorted(values, reverse=True))


def _quantity(scene: Scene, name: str | None) -> str:
    known = QUANTITIES[type(scene)]
    if name is not None and name not in known:
        raise InputError(
            file="--quantity", expected=f"one of {', '.join(known)}", got=name, fix=nearest(name, list(known))
        )
    return name or known[0]


def _kind(scene: type) -> str:
    return scene.__struct_config__.tag
