"""Sliding laws: one function each, from the system to LIGGGHTS' words."""

from __future__ import annotations

from collections.abc import Callable

from harness.engines.liggghts.law.dashpot import damping, pair_restitution
from harness.engines.liggghts.law.kinds import Kind, reduced
from harness.engines.liggghts.law.words import Constant, Judgement, Words, equivalent, of_pair, unsupported
from harness.scene.contact import (
    HertzNormal,
    HystereticNormal,
    LinearNormal,
    MindlinSliding,
    SpringSliding,
    VariableHystereticNormal,
    ViscousSliding,
)
from harness.scene.system import System

SPRING = ("ux", "uy", "uz")
HYSTERETIC = HystereticNormal | VariableHystereticNormal
FAINTEST = 1e-30
"""FrictionViscosity must be above 0; as a multiple of a dashpot this one is lost in rounding."""

OUTPUT_CUTS = (
    "tan_luding cuts its spring in every evaluation, so also when contacts are written, with velocities and so a "
    "normal dashpot of a moment in which it does not run; without normal damping that changes nothing"
)

SAWTOOTH = Judgement(
    level="partial",
    note="tan_luding (FluidViscosity = mu_d/mu_s) cuts the spring to mu_d when it passes mu_s and lets it stick "
    "again at once: friction goes up and down between both where the scene's contact slides on at mu_d",
)


def spring(system: System) -> Words:
    """Spring k_t, dashpot gamma_t, Coulomb's limit."""
    if isinstance(system.normal, HYSTERETIC):
        return _tan_luding(system)
    if isinstance(system.normal, HertzNormal):
        return _unsupported("model hertz has no other tangential stiffness than Mindlin's")
    return Words(
        model=" tangential history", history=SPRING,
        constants={
            "kt": Constant(value=of_pair(system, "sliding", "shear_stiffness"), smooth=0.0),
            "gammat_abs": Constant(value=of_pair(system, "sliding", "shear_damping"), smooth=0.0), **_friction(system),
        },
        judged={
            "sliding friction": _history("mu |f_n|, f_n with damping,"),
            "dynamic friction": unsupported(
                "of its tangential models only tan_luding has a second coefficient, and it reads k_c, which "
                "hooke/stiffness does not keep"
            ),
        },
    )


def mindlin(system: System) -> Words:
    """k_t = 8 G* sqrt(R* delta) and its dashpot, which model hertz hands over."""
    note = "mu |f_n|, f_n with damping,"
    return Words(
        model=" tangential history", history=SPRING, constants=_friction(system),
        comment="# Mindlin's spring and dashpot across it, up to Coulomb's limit",
        judged={"sliding friction": _history(f"f_t = -k_t(overlap now) u, no increments; {note}")},
    )


def viscous(system: System) -> Words:
    """min(gamma_t |v_t|, mu |f_n|) against v_t."""
    if not isinstance(system.normal, LinearNormal):
        return _unsupported("tangential no_history takes the dashpot of the normal model, no other")
    law = system.sliding
    note = "tangential no_history: Coulomb's limit mu |f_n|, f_n with damping; arm R - overlap/2"
    return Words(
        model=" tangential no_history", comment="# dashpot across it, up to Coulomb's limit",
        constants={"gammat_abs": Constant(value=law.shear_damping, smooth=0.0), **_friction(system)},
        judged={"sliding friction": equivalent(note)},
    )


def _tan_luding(system: System) -> Words:
    """Limit mu |f_n + k_c delta|; k_t and gamma_t as multiples of k_1 and of the normal dashpot."""
    law, normal = system.sliding, system.normal
    by_body = law.shear_damping > 0.0 and normal.normal_damping == 0.0

    def damping_ratio(a: Kind, b: Kind) -> float:
        if law.shear_damping == 0.0:
            return FAINTEST
        if not by_body:
            return law.shear_damping / normal.normal_damping
        e = pair_restitution(0.0, a, b, normal.loading_stiffness, carries=True)
        return law.shear_damping / damping(e, reduced(a.mass, b.mass), normal.loading_stiffness) if e < 1.0 else 1.0

    ratio = 1.0 if law.dynamic_friction is None else law.dynamic_friction / law.shear_friction
    return Words(
        model=" tangential tan_luding", history=SPRING, by_body=by_body,
        moved_by_output=OUTPUT_CUTS if normal.normal_damping > 0.0 else "",
        comment="# FluidViscosity: mu_d/mu_s; FrictionViscosity: gamma_t/gamma_n; coeffFrictionStiffness: k_t/k_1",
        constants={
            **_friction(system), "FluidViscosity": Constant(value=ratio),
            "FrictionViscosity": Constant(value=damping_ratio),
            "coeffFrictionStiffness": Constant(value=law.shear_stiffness / normal.loading_stiffness),
        },
        judged={"sliding friction": _history("mu |f_n + k_c overlap|"), "dynamic friction": SAWTOOTH},
    )


def _friction(system: System) -> dict[str, Constant]:
    return {"coefficientFriction": Constant(value=of_pair(system, "sliding", "shear_friction"), smooth=0.0)}


def _history(limit: str) -> Judgement:
    return equivalent(
        f"tangential history: Coulomb's limit {limit} is tested on the spring alone; where it slips there is no "
        "dashpot; the spring is turned with the normal without rescaling; arm R - overlap/2"
    )


def _unsupported(note: str) -> Words:
    return Words(judged={effect: unsupported(note) for effect in ("sliding friction", "dynamic friction")})


SLIDING: dict[type, Callable[[System], Words]] = {
    SpringSliding: spring,
    MindlinSliding: mindlin,
    ViscousSliding: viscous,
}
"""One function a sliding law of the scene."""
