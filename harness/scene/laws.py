"""The contact laws that scenes can call for, and what the harness has to know of each: one row a law.

Everything that depends on a law's parameters is asked here: time step and stability (`numerics`), what
`grainproof scene` says (`derived`, `explain`), which effects are on (`effects`), how a packing is relaxed
(`studies.prepare`), which elastic energy there is (`studies.compare.states`). A new law is one struct in
`harness.scene.model`, and one row here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from harness.scene import law_scales
from harness.scene.contact import (
    ConstantRolling,
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    JkrNormal,
    LinearNormal,
    MindlinSliding,
    NormalLaw,
    RollingLaw,
    SlidingLaw,
    SpringRolling,
    SpringSliding,
    SpringTorsion,
    VariableHystereticNormal,
    ViscousSliding,
)
from harness.scene.grains import Pair
from harness.scene.law_scales import HeadOn
from harness.scene.tables import Table


class Turning(Protocol):
    """What has laws that can turn particles."""

    sliding: SlidingLaw | None
    rolling: RollingLaw | None
    torsion: SpringTorsion | None


class Springs(NamedTuple):
    """The largest stiffness (N/m) and dashpot (kg/s) that a law shows."""

    stiffness: float
    damping: float


def _never(_: NormalLaw) -> str:
    return ""


@dataclass(frozen=True, kw_only=True)
class NormalRow:
    """A normal law. Words are "" where the law, with these parameters, does not have the thing.

    head_on: its closed forms. numbers: its stiffness in words. damping: what dissipates by a dashpot.
    adhesion: what attracts. clips: it never lets the dashpot pull. remembers: what it keeps of the past.
    first_stiffness: slope of the force on first loading, N/m, where it is one: a packing is relaxed with a
    linear spring of it, so that the law finds every contact in balance. energy_stiffness: k of the stored
    energy k delta^2/2, where the overlap alone decides on it. stiffens: the slope grows with the overlap.
    """

    head_on: Callable[[NormalLaw, Pair], HeadOn]
    numbers: Callable[[NormalLaw], str]
    damping: Callable[[NormalLaw], str]
    adhesion: Callable[[NormalLaw], str] = _never
    clips: Callable[[NormalLaw], bool] = lambda _: False
    remembers: str = ""
    first_stiffness: Callable[[NormalLaw], float] | None = None
    energy_stiffness: Callable[[NormalLaw], float] | None = None
    stiffens: bool = False


@dataclass(frozen=True, kw_only=True)
class TangentialRow:
    """A sliding, rolling or torsion law.

    springs: what it shows where the normal law shows `HeadOn`. numbers: its parameters in words.
    energy_stiffness: k of the stored energy k u^2/2 of its spring u, where it is constant.
    """

    springs: Callable[[Table, NormalLaw, HeadOn], Springs]
    numbers: Callable[[Table], str]
    energy_stiffness: Callable[[Table], float] | None = None


def word(law: Table) -> str:
    """Return the law's own word in scenes: ``hertz``."""
    return law.__struct_config__.tag


def head_on(normal: NormalLaw, pair: Pair) -> HeadOn:
    """Return the head-on collision of a pair under this law."""
    return NORMAL[type(normal)].head_on(normal, pair)


def normal_row(normal: NormalLaw) -> NormalRow:
    """Return what there is to know of a normal law."""
    return NORMAL[type(normal)]


def tangential_row(law: SlidingLaw | RollingLaw | SpringTorsion) -> TangentialRow:
    """Return what there is to know of a tangential law."""
    return TANGENTIAL[type(law)]


def tangential_springs(law: Table | None, normal: NormalLaw, met: HeadOn) -> Springs:
    """Return the springs of a tangential law, nothing where there is none."""
    return Springs(0.0, 0.0) if law is None else TANGENTIAL[type(law)].springs(law, normal, met)


def turning(laws: Turning) -> tuple[str, ...]:
    """Return which of sliding, rolling and torsion are there, in a scene's contact or a system: they turn particles.

    Without any of them there is no tangential force, and all conventions of the kernel are one.
    """
    tables = {"sliding": laws.sliding, "rolling": laws.rolling, "torsion": laws.torsion}
    return tuple(name for name, law in tables.items() if law is not None)


def stiffens(normal: NormalLaw) -> bool:
    """Whether the contact gets stiffer with the overlap, so that its scales hold up to `impact_speed` only."""
    return NORMAL[type(normal)].stiffens


def first_stiffness(normal: NormalLaw) -> float:
    """Return the slope of the force on first loading, N/m: of the linear springs that a packing is relaxed with.

    Relaxed with any other stiffness, k_2 say, the contacts of a box whose law begins with k_1 and without
    memory would not be in balance at the start.

    Raises TypeError for a law whose force does not begin with a straight line; a scene is refused before.
    """
    row = NORMAL[type(normal)]
    if row.first_stiffness is None:
        raise TypeError(f"no packing can be balanced under {word(normal)}")
    return row.first_stiffness(normal)


def elastic_stiffness(law: Table | None) -> float | None:
    """Return k of the stored energy k u^2/2, N/m; None where overlap or spring do not decide on the energy."""
    row = (NORMAL | TANGENTIAL).get(type(law))
    return None if row is None or row.energy_stiffness is None else row.energy_stiffness(law)


def _mindlin(_: MindlinSliding, normal: HertzNormal, met: HeadOn) -> Springs:
    """8 G* sqrt(R* delta) = S_n 4 G*/E* = S_n 2 (1 - nu)/(2 - nu); the dashpot goes with the root of it."""
    ratio = 2 * (1 - normal.poisson_ratio) / (2 - normal.poisson_ratio)
    return Springs(ratio * met.stiffness, math.sqrt(ratio) * met.damping)


def _kg_per_s(law: NormalLaw) -> str:
    return f"{law.normal_damping:g} kg/s" if law.normal_damping else ""


def _restitution(law: HertzNormal) -> str:
    return f"e = {law.restitution:g}" if law.restitution < 1 else ""


def _sticky_spring(law: HystereticNormal | VariableHystereticNormal) -> str:
    return f"k_c = {law.adhesion_stiffness:g} N/m" if law.adhesion_stiffness else ""


def _sticky_surface(law: DmtNormal | JkrNormal) -> str:
    return f"w = {law.surface_energy:g} J/m^2"


def _elastic(law: HertzNormal | DmtNormal | JkrNormal) -> str:
    return f"E = {law.youngs_modulus:g} Pa, nu = {law.poisson_ratio:g}"


NORMAL: dict[type, NormalRow] = {
    LinearNormal: NormalRow(
        head_on=law_scales.linear, damping=_kg_per_s, clips=lambda law: law.attraction == "clipped",
        numbers=lambda law: f"k_n = {law.normal_stiffness:g} N/m",
        first_stiffness=lambda law: law.normal_stiffness, energy_stiffness=lambda law: law.normal_stiffness,
    ),
    HertzNormal: NormalRow(
        head_on=law_scales.hertz, numbers=_elastic, damping=_restitution, stiffens=True,
        clips=lambda law: law.attraction == "clipped",
    ),
    HystereticNormal: NormalRow(
        head_on=law_scales.hysteretic, damping=_kg_per_s, adhesion=_sticky_spring,
        numbers=lambda law: f"k_1 = {law.loading_stiffness:g} N/m, k_2 = {law.unloading_stiffness:g} N/m",
        remembers="largest overlap, with constant k_2", first_stiffness=lambda law: law.loading_stiffness,
    ),
    VariableHystereticNormal: NormalRow(
        head_on=law_scales.hysteretic_variable, damping=_kg_per_s, adhesion=_sticky_spring,
        numbers=lambda law: f"k_1 = {law.loading_stiffness:g} N/m, k_p = {law.largest_unloading_stiffness:g} N/m, "
        f"phi_f = {law.plasticity_depth:g}",
        remembers="largest overlap, which decides on k_2", first_stiffness=lambda law: law.loading_stiffness,
    ),
    DmtNormal: NormalRow(
        head_on=law_scales.dmt, numbers=_elastic, damping=_kg_per_s, adhesion=_sticky_surface, stiffens=True
    ),
    JkrNormal: NormalRow(
        head_on=law_scales.jkr, numbers=_elastic, damping=_kg_per_s, adhesion=_sticky_surface, stiffens=True
    ),
}

TANGENTIAL: dict[type, TangentialRow] = {
    SpringSliding: TangentialRow(
        springs=lambda law, *_: Springs(law.shear_stiffness, law.shear_damping),
        numbers=lambda law: f"mu = {law.shear_friction:g}, k_t = {law.shear_stiffness:g} N/m",
        energy_stiffness=lambda law: law.shear_stiffness,
    ),
    MindlinSliding: TangentialRow(springs=_mindlin, numbers=lambda law: f"mu = {law.shear_friction:g}"),
    ViscousSliding: TangentialRow(
        springs=lambda law, *_: Springs(0.0, law.shear_damping),
        numbers=lambda law: f"mu = {law.shear_friction:g}, gamma_t = {law.shear_damping:g} kg/s",
    ),
    SpringRolling: TangentialRow(
        springs=lambda law, *_: Springs(law.rolling_stiffness, law.rolling_damping),
        numbers=lambda law: f"mu_r = {law.rolling_friction:g}, k_r = {law.rolling_stiffness:g} N/m",
    ),
    ConstantRolling: TangentialRow(
        springs=lambda *_: Springs(0.0, 0.0), numbers=lambda law: f"mu_r = {law.rolling_friction:g}"
    ),
    SpringTorsion: TangentialRow(
        springs=lambda law, *_: Springs(law.torsion_stiffness, law.torsion_damping),
        numbers=lambda law: f"mu_o = {law.torsion_friction:g}, k_o = {law.torsion_stiffness:g} N/m",
    ),
}
