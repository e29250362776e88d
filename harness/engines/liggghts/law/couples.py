"""Rolling and torsion resistance: one function each, from the system to LIGGGHTS' words.

How LIGGGHTS moves the couple T of a rolling spring (epsd, epsd2, epsd3, luding; as run), a* = R_i R_j/(R_i + R_j):

    w = omega_i - omega_j; at a wall w = omega_i (R - delta/2)/(R - delta);   w_t = w - (w.n) n
    T += k_r a*^2 w_t dt;   if |T| > mu_r f a*: T is cut to that, no dashpot; else gamma_r a*^2 w_t besides
    couple on i: -(T + gamma_r a*^2 w_t), on j the opposite one

f is |f_n|, in `luding` |f_n + k_c delta|. T is neither turned nor projected when the normal turns: it stays fixed in
space. In 2D there is nothing to turn; in 3D the law is not frame invariant.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from harness.engines.liggghts.domain import runs_as_discs
from harness.engines.liggghts.law.dashpot import FAINT, damping, rolling_ratio
from harness.engines.liggghts.law.kinds import Kind, reduced
from harness.engines.liggghts.law.sliding import HYSTERETIC
from harness.engines.liggghts.law.words import Constant, Judgement, Words, equivalent, exact, unsupported
from harness.scene.contact import (
    ConstantRolling,
    HertzNormal,
    LinearNormal,
    SpringRolling,
    SpringSliding,
    SpringTorsion,
)
from harness.scene.overlaps import initial_overlaps
from harness.scene.system import System

COUPLE = ("rolling_x", "rolling_y", "rolling_z")
UNUSED = ("torsion_x", "torsion_y", "torsion_z")


def rolling_spring(system: System) -> Words:
    """Spring k_r, dashpot gamma_r, limit: the model whose stiffness, dashpot and limit can be the scene's."""
    if not isinstance(system.normal, LinearNormal | HYSTERETIC):
        return _rolling(unsupported("the rolling models take k_r as a multiple of k_n, which varies with the overlap"))
    if getattr(system.normal, "adhesion_stiffness", 0.0) > 0.0:
        return _rolling_luding(system)
    if _epsd2_has_stiffness(system) and system.rolling.rolling_damping == 0.0:
        return _epsd2(system)
    return _epsd3(system)


def rolling_constant(system: System) -> Words:
    """-mu_r a* f_el against w_t/|w|."""
    if not isinstance(system.normal, HertzNormal | LinearNormal):
        return _rolling(unsupported("cdt: the couple goes with k_1 overlap, which is not the elastic force here"))
    judged = exact("cdt: same formula")
    if system.dimension == 3:
        note = "cdt divides the rolling by the whole relative spin: the couple shrinks where the contact twists too"
        judged = Judgement(level="partial", note=note)
    return _rolling(
        judged, model=" rolling_friction cdt", constants=_friction(system), comment="# constant rolling torque"
    )


def torsion_spring(_system: System) -> Words:
    """Not there."""
    note = (
        "no torsion spring of its own: torsionTorque on adds the twist to the rolling, torsion on of rolling luding "
        "keeps both in one history"
    )
    return Words(judged={"torsion resistance": unsupported(note)})


def _epsd2_has_stiffness(system: System) -> bool:
    """epsd2 takes k_r from k_t: does that fit, or is k_t free because nothing else uses it?"""
    stiffness = system.rolling.rolling_stiffness
    if not isinstance(system.normal, LinearNormal):
        return stiffness == system.normal.loading_stiffness
    return not isinstance(system.sliding, SpringSliding) or stiffness == system.sliding.shear_stiffness


def _epsd2(system: System) -> Words:
    shared = {}
    if isinstance(system.normal, LinearNormal):
        shared = {"kt": Constant(value=system.rolling.rolling_stiffness, smooth=0.0)}
    return _rolling(
        _spring_judgement(system, "epsd2 (k_r = k_t)", "|f_n|"), model=" rolling_friction epsd2",
        constants=shared | _friction(system), comment="# rolling: spring and limit, k_r = k_t", history=COUPLE,
    )


def _epsd3(system: System) -> Words:
    """Stiffness as a multiple, at least 1, of k_n mu_r^2; dashpot as a part of the critical one of each pair."""
    law, normal = system.rolling, system.normal
    linear = isinstance(normal, LinearNormal)
    ratio = law.rolling_stiffness / ((normal.normal_stiffness if linear else normal.loading_stiffness)
                                     * law.rolling_friction**2)
    judged = _spring_judgement(system, "epsd3 (rollingStiffness = k_r/(k_n mu_r^2))", "|f_n|")
    if ratio < 1.0:
        judged = unsupported(f"k_r = {ratio:.3g} k_n mu_r^2: 'ERROR: rollingStiffness >= 1 required for SI units'")
    return _rolling(
        judged, model=" rolling_friction epsd3", history=COUPLE, by_body=law.rolling_damping > 0.0,
        comment="# rolling: spring, dashpot and limit; rollingStiffness: k_r/(k_n mu_r^2)",
        constants={**_friction(system), "coefficientRollingViscousDamping": _damping_part(system),
                   "rollingStiffness": Constant(value=ratio, over="scalar")},
    )


def _rolling_luding(system: System) -> Words:
    """As epsd3 with the limit of an adhesive contact; its dashpot is multiplied by that of the normal law."""
    law, normal = system.rolling, system.normal
    judged = _spring_judgement(system, "luding (coeffRollingStiffness = k_r/k_1)", "|f_n + k_c overlap|")
    turning = any(ring.omega for ring in system.rings)
    if turning or (np.any(system.particles.spin) and len(initial_overlaps(system).size)):
        judged = unsupported("luding moves its history at the set-up too, where bodies that touch and spin begin")
    return _rolling(
        judged, model=" rolling_friction luding", history=COUPLE + UNUSED, by_body=law.rolling_damping > 0.0,
        moved_by_output="rolling luding turns its spring on in every evaluation, so also when contacts are written",
        comment="# rolling: spring, dashpot and limit; coeffRollingStiffness: k_r/k_1",
        constants={
            **_friction(system), "coefficientRollingViscousDamping": _damping_part(system, of_normal_dashpot=True),
            "coeffRollingStiffness": Constant(value=law.rolling_stiffness / normal.loading_stiffness),
        },
    )


def _damping_part(system: System, *, of_normal_dashpot: bool = False) -> Constant:
    """Return the part of the critical dashpot, a table if there is one."""
    law, normal, discs = system.rolling, system.normal, runs_as_discs(system)
    if law.rolling_damping == 0.0:
        return Constant(value=0.0)

    def part(a: Kind, b: Kind) -> float:
        if a.mass == b.mass == math.inf:
            return 0.0
        eta = rolling_ratio(law.rolling_damping, law.rolling_stiffness, a, b, discs=discs)
        if not of_normal_dashpot:
            return eta
        faint = damping(FAINT, reduced(a.mass, b.mass), normal.loading_stiffness)
        return eta / (normal.normal_damping or faint)

    return Constant(value=part)


def _friction(system: System) -> dict[str, Constant]:
    return {"coefficientRollingFriction": Constant(value=system.rolling.rolling_friction, smooth=0.0)}


def _spring_judgement(system: System, model: str, limit: str) -> Judgement:
    note = f"rolling {model}: the limit mu_r {limit} is tested on the spring alone; where it slips there is no dashpot"
    if system.dimension == 2:
        return equivalent(note)
    return Judgement(
        level="partial", note=f"{note}; the couple stays fixed in space when the contact turns: not frame invariant"
    )


def _rolling(judged: Judgement, **words) -> Words:
    return Words(judged={"rolling resistance": judged}, **words)


ROLLING: dict[type, Callable[[System], Words]] = {
    SpringRolling: rolling_spring,
    ConstantRolling: rolling_constant,
}
TORSION: dict[type, Callable[[System], Words]] = {SpringTorsion: torsion_spring}
"""One function a law of the scene."""
