"""Normal laws: one function each, from the system to LIGGGHTS' words."""

from __future__ import annotations

from collections.abc import Callable

from harness.engines.liggghts.law.dashpot import LEAST_RESTITUTION, pair_restitution
from harness.engines.liggghts.law.kinds import MOST_BODIES, Kind, kinds
from harness.engines.liggghts.law.words import Constant, Judgement, Words, exact, of_pair, unsupported
from harness.scene.contact import (
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    JkrNormal,
    LinearNormal,
    SpringSliding,
    VariableHystereticNormal,
)
from harness.scene.system import System

HALF_STEP = "forces see half-step velocities v(t+dt/2)"
CLIP = {"allowed": (), "clipped": ("limitForce on",)}
LEAST_RATIO = 1.0 + 2.0**-52
"""Of k_2 to k_1: the next number above 1, as LIGGGHTS divides by k_2 - k_1."""
SOFTEST, HARDEST = 5e6, 1e9
"""Young's moduli (Pa) outside of which LIGGGHTS asks for `soft_particles yes` or `hard_particles yes`."""


def linear(system: System) -> Words:
    """f_n = k_n delta - gamma_n v_n. It asks for tangential constants too; sliding and rolling laws set them."""
    law = system.normal
    return Words(
        model="model hooke/stiffness", comment=_linear_comment(system),
        settings=("absolute_damping on", *CLIP[law.attraction]),
        constants={
            "kn": Constant(value=of_pair(system, "normal", "normal_stiffness")),
            "gamman_abs": Constant(value=of_pair(system, "normal", "normal_damping")),
            "kt": Constant(value=0.0, smooth=0.0), "gammat_abs": Constant(value=0.0, smooth=0.0),
        },
        judged={
            "normal contact": exact("hooke/stiffness: same formula, matched to rounding"),
            "normal damping": exact(f"absolute_damping; {HALF_STEP}"),
            "damping attraction": exact("no limitForce: the dashpot may pull"),
        },
    )


def _linear_comment(system: System) -> str:
    if isinstance(system.sliding, SpringSliding):
        return "# linear spring and dashpot along the normal and, up to Coulomb's limit, across it"
    if system.sliding is None and system.rolling is None:
        return "# smooth particles; hooke/stiffness asks for tangential constants even when nothing uses them"
    return "# linear spring and dashpot along the normal"


def hertz(system: System) -> Words:
    """f_n = 4/3 E* sqrt(R*) delta^(3/2) - gamma v_n, gamma^2 = 10/3 beta^2 S_n m*, S_n = 2 E* sqrt(R* delta)."""
    law = system.normal
    contact = exact("hertz: same formula, matched to rounding")
    if law.poisson_ratio < 0.0:
        contact = unsupported(f"Poisson's ratio {law.poisson_ratio:g}: 'ERROR: 0 <= poissonsRatio <= 0.5 required'")
    return Words(
        model="model hertz", comment="# Hertz contact with the dashpot of constant restitution",
        settings=CLIP[law.attraction],
        constants={
            "youngsModulus": Constant(value=law.youngs_modulus, over="peratomtype"),
            "poissonsRatio": Constant(value=law.poisson_ratio, over="peratomtype"),
            "coefficientRestitution": Constant(value=law.restitution),
        },
        judged={
            "normal contact": contact,
            "normal damping": _restitution_in_range(law.restitution, exact(f"hertz: same formula; {HALF_STEP}")),
            "damping attraction": exact("no limitForce: the dashpot may pull"),
        },
    )


def hysteretic(system: System) -> Words:
    """k_1, constant k_2, k_c: edinburgh/stiffness with fixed k_c and exponents 1.

    Without `limitForce off` it drops all adhesion. Its history changes sign where a pair is stored the other way
    round, which happens with sorting (off here) and across periodic boundaries.
    """
    law = system.normal
    contact = exact("edinburgh/stiffness fixKc on, limitForce off, exponents 1: same formula, matched to rounding")
    if system.periodic is not None:
        contact = unsupported(
            "edinburgh/stiffness forgets the plastic overlap of a contact that crosses a periodic boundary"
        )
    one, nothing = Constant(value=1.0, over="scalar"), Constant(value=0.0)
    return _hysteretic_words(
        system, contact, model="model edinburgh/stiffness", largest=law.unloading_stiffness,
        comment="# hysteretic, adhesive: k1, constant k2, kc; exponents 1 make the curve piecewise linear",
        settings=("limitForce off", "fixKc on"),
        constants={"overlapExponent": one, "adhesionExponent": one, "surfaceEnergy": nothing},
        history=("largest_overlap", "last_overlap", "adhesion_stiffness", "pull_off_force"),
    )


def hysteretic_variable(system: System) -> Words:
    """k_1, k_2(delta_max), k_c: luding, with delta_max* = k_p/(k_p - k_1) phi_f 2 R*."""
    law = system.normal
    return _hysteretic_words(
        system, exact("luding: same formula, matched to rounding"), model="model luding",
        largest=law.largest_unloading_stiffness, comment="# hysteretic, adhesive: k1, k2(largest overlap), kc",
        settings=("limitForce off",),
        constants={"coefficientPlasticityDepth": Constant(value=law.plasticity_depth)},
        history=("largest_overlap", "adhesion_stiffness", "pull_off_force"),
    )


def dmt(_system: System) -> Words:
    """Not there."""
    return _missing("dmt")


def jkr(_system: System) -> Words:
    """Not there; `sjkr` is a pull proportional to the contact area."""
    return _missing("jkr")


def _hysteretic_words(
    system: System, contact: Judgement, *, model: str, largest: float, comment: str, settings: tuple[str, ...],
    constants: dict[str, Constant], history: tuple[str, ...],
) -> Words:
    """Return what both hysteretic laws share: stiffnesses as multiples of k_1, the dashpot as a restitution."""
    law, carries = system.normal, carries_dashpots(system)

    def e(a: Kind, b: Kind) -> float:
        return pair_restitution(law.normal_damping, a, b, law.loading_stiffness, carries=carries)

    by_body = law.normal_damping > 0.0
    return Words(
        model=model, comment=comment, settings=settings, history=history, by_body=by_body,
        constants={
            "LoadingStiffness": Constant(value=law.loading_stiffness),
            "UnloadingStiffness": Constant(value=max(largest / law.loading_stiffness, LEAST_RATIO)),
            "coefficientAdhesionStiffness": Constant(value=law.adhesion_stiffness / law.loading_stiffness),
            "pullOffForce": Constant(value=0.0), "coefficientRestitution": Constant(value=e), **constants,
        },
        judged={
            "normal contact": contact, "adhesion": contact, "plastic memory": contact,
            "normal damping": _least_restitution(system, e) if by_body else contact,
            "damping attraction": exact("limitForce off: the dashpot may pull"),
        },
    )


def carries_dashpots(system: System) -> bool:
    """Are there tangential or rolling dashpots that are multiples of the normal one?"""
    rolls = system.normal.adhesion_stiffness > 0.0 and getattr(system.rolling, "rolling_damping", 0.0) > 0.0
    return rolls or getattr(system.sliding, "shear_damping", 0.0) > 0.0


def _least_restitution(system: System, e: Callable[[Kind, Kind], float]) -> Judgement:
    """Judge the restitutions of all pairs that may touch; of too many bodies (`too_many_bodies`) some of them."""
    pairs = kinds(system, by_body=True)[-MOST_BODIES - 2 :]
    least = min(e(a, b) for a in pairs for b in pairs)
    able = exact(f"as the restitution, from {least:.6g}, that each two bodies have; {HALF_STEP}")
    return _restitution_in_range(least, able)


def _restitution_in_range(least: float, able: Judgement) -> Judgement:
    if least > LEAST_RESTITUTION:
        return able
    return unsupported(f"restitution {least:.3g}: 'ERROR: 0.05 < coefficientRestitution <= 1 required'")


def _missing(name: str) -> Words:
    note = f"no normal model {name}: LIGGGHTS has hooke, hertz, luding, edinburgh, thornton_ning and their variants"
    effects = ("normal contact", "normal damping", "damping attraction", "adhesion")
    return Words(judged={effect: unsupported(note) for effect in effects})


NORMAL: dict[type, Callable[[System], Words]] = {
    LinearNormal: linear,
    HertzNormal: hertz,
    HystereticNormal: hysteretic,
    VariableHystereticNormal: hysteretic_variable,
    DmtNormal: dmt,
    JkrNormal: jkr,
}
"""One function a normal law of the scene."""
