"""The numbers that switches are judged by, of every run of a variant, by kind of scene.

Quantities that `grainproof accuracy` tells errors of have its names here too (`harness.studies.accuracy`). A box has
besides what is judged over replicates (`harness.studies.compare.biaxial_quantities`), a ring its other numbers with
their own standard errors (`ring_numbers`). What bodies leave a free scene with, and the stress-strain curve as a whole,
are told as deviations from the scene as declared, whose own value is 0 then: the former over the largest relative speed
at the start (`harness.studies.accuracy.exits`), the latter as rms over strain, over the rms of the curve.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from harness.scene.laws import turning
from harness.scene.model import Biaxial, Couette, Free, Scene
from harness.scene.system import System
from harness.studies.accuracy.asked import QUANTITIES
from harness.studies.accuracy.bulk_quantities import BULK, OF_MACRO, OF_RING, bulk_values
from harness.studies.accuracy.exits import Exits, errors
from harness.studies.accuracy.phases import fastest_pair
from harness.studies.compare.band import band_of
from harness.studies.compare.biaxial_quantities import OneRun, biaxial_quantities
from harness.studies.compare.curves import biaxial_curves
from harness.studies.compare.profiles import ring_profiles, steady_frames, subject_of
from harness.studies.compare.ring_balances import ring_balances
from harness.studies.compare.ring_curves import ring_curves
from harness.studies.compare.ring_numbers import ring_numbers
from harness.studies.effects.variants import BASE
from harness.studies.statistics.family import Measured
from postproc.trajectory import read_frame, read_trajectory

FASTEST = "the largest relative speed at the start"
DEVIATIONS = {
    "exit": FASTEST, "velocity": FASTEST, "spin": FASTEST, "stress_strain": "the rms of the curve as declared",
}
"""Quantities that are deviations from the scene as declared, and what they are a part of."""


@dataclass(frozen=True, kw_only=True)
class VariantRun:
    """A completed run. system: of the variant. trajectory: the file."""

    variant: str
    packing: int
    system: System
    trajectory: Path


def named_quantities(scene: Scene) -> tuple[str, ...]:
    """Return the quantities that can be asked for, the usual one first; those that the scene cannot have left out."""
    known = QUANTITIES[type(scene)]
    if isinstance(scene, Biaxial) and scene.compare.plateau is None:
        known = tuple(n for n in known if n not in ("plateau_angle", "stress_ratio"))
    if isinstance(scene, Biaxial) and not turning(scene.contact):
        known = tuple(n for n in known if n != "friction_angle")
    return known


def measured(scene: Scene, runs: Sequence[VariantRun]) -> list[Measured]:
    """Return all quantities that runs have; "engines" are variants, replicates are packings."""
    return KINDS[type(scene)](scene, runs)


def _box(scene: Biaxial, runs: Sequence[VariantRun]) -> list[Measured]:
    opened, bulk = [], {}
    for run in runs:
        trajectory = read_trajectory(run.trajectory)
        bulk[run.variant, run.packing] = bulk_values(scene, run.system, trajectory, {0.0: None})[0.0]
        opened.append(OneRun(
            engine=run.variant, replicate=run.packing, curves=biaxial_curves(trajectory, run.system),
            trajectory=trajectory, system=run.system,
        ))
    named = [m for b in BULK[Biaxial] if (m := _bulk(scene, b, bulk)) is not None]
    return [*named, *(m for m in biaxial_quantities(scene, opened) if m.quantity not in OF_MACRO.values())]


def _bulk(scene: Biaxial, quantity, bulk: Mapping) -> Measured | None:
    found = {key: values[quantity.name] for key, values in bulk.items() if quantity.name in values}
    if quantity.name in DEVIATIONS:
        found = {
            key: np.atleast_1d(_rms(y - found[BASE, key[1]]) / _rms(found[BASE, key[1]]))
            for key, y in found.items() if (BASE, key[1]) in found
        }
    if not found:
        return None
    values: dict[str, dict[int, float]] = {}
    for (variant, packing), value in found.items():
        values.setdefault(variant, {})[packing] = float(value[0])
    scale = 1.0 if quantity.name in DEVIATIONS else quantity.scale and quantity.scale(scene)
    unit = "1" if quantity.name in DEVIATIONS else quantity.unit
    return Measured(quantity=quantity.name, unit=unit, values=values, scale=scale)


def _rms(y: np.ndarray) -> float:
    return float(np.sqrt((y**2).mean()))


def _ring(scene: Couette, runs: Sequence[VariantRun]) -> list[Measured]:
    numbers = {(r.variant, r.packing): _ring_run(scene, r) for r in runs}
    names = list(dict.fromkeys(name for of in numbers.values() for name in of))
    return [_of_name(name, numbers) for name in names]


def _ring_run(scene: Couette, run: VariantRun) -> Mapping:
    """Return the numbers of one run; without a shear band its width is none."""
    trajectory, short = read_trajectory(run.trajectory), {long: name for name, long in OF_RING.items()}
    subjects = [subject_of(f, scene, run.system) for f in steady_frames(trajectory, scene)]
    profiles = ring_profiles(subjects, run.system)
    balances = ring_balances(ring_curves(trajectory), subjects, run.system)
    band = band_of(profiles, scene, run.system)
    found = {short.get(name, name): n for name, n in ring_numbers(profiles, balances, band).items()}
    if band.why:
        found.pop("band_width", None)
    return found


def _of_name(name: str, numbers: Mapping) -> Measured:
    values: dict[str, dict[int, float]] = {}
    errors_: dict[str, dict[int, float]] = {}
    unit = ""
    for (variant, packing), of in numbers.items():
        if name in of:
            unit = of[name].unit
            values.setdefault(variant, {})[packing] = of[name].value
            if of[name].error is not None:
                errors_.setdefault(variant, {})[packing] = of[name].error
    return Measured(quantity=name, unit=unit, values=values, errors=errors_)


def _free(_: Free, runs: Sequence[VariantRun]) -> list[Measured]:
    base = next((r for r in runs if r.variant == BASE), None)
    if base is None:
        return []
    exits, found = {r.variant: _exits(r) for r in runs}, {}
    for run in runs:
        turns = bool(turning(base.system) or turning(run.system))
        for quantity, value in errors(exits[run.variant], exits[BASE], _measured_by(base), turns=turns).items():
            found.setdefault(quantity, {}).setdefault(run.variant, {})[run.packing] = float(value[0])
    return [Measured(quantity=q, unit="1", values=v, scale=1.0) for q, v in found.items()]


def _measured_by(run: VariantRun) -> System:
    """Return the system by whose speeds deviations are measured: at the start, or at the end if nothing moves then."""
    if fastest_pair(run.system) > 0.0:
        return run.system
    return run.system.with_(particles=replace(run.system.particles, v=_exits(run).v[0]))


def _exits(run: VariantRun) -> Exits:
    """Return velocities and spins of the last frame, one copy."""
    last = read_frame(run.trajectory, run.system.steps // run.system.frame_every).particles
    axes = "xyz"[: run.system.dimension]
    spins = ("wz",) if len(axes) == 2 else ("wx", "wy", "wz")
    return Exits(v=last.vector(*(f"v{a}" for a in axes))[None], spin=last.vector(*spins)[None])


KINDS = {Biaxial: _box, Couette: _ring, Free: _free}
