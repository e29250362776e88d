"""Normal laws. Every function takes the scene's law and a `Dashpot` and returns LAMMPS' words.

LAMMPS has tangential damping as a multiple x_t of the normal one only, so gamma_t = x_t c_n. With
gamma_n = 0 and gamma_t > 0 a multiple does not exist; c_n = 2^-100 gamma_t and x_t = 2^100 then give
gamma_t to the last bit and a normal damping thirty orders below it, lost in rounding against f_el.
"""

from __future__ import annotations

from harness.engines.lammps.law.row import Row, missing
from harness.engines.text import number
from harness.scene.contact import (
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    JkrNormal,
    LinearNormal,
    NormalLaw,
    VariableHystereticNormal,
)

TINY = 2.0**-100


def linear(law: LinearNormal, gamma_t: float) -> str:
    """f_el = k_n delta, c_n = gamma_n."""
    damping, _ = damping_and_ratio(law.normal_damping, gamma_t)
    return f"hooke {number(law.normal_stiffness)} {number(damping)} damping velocity"


def hertz(law: HertzNormal, gamma_t: float) -> str:
    """f_el = 4/3 E* sqrt(R*) delta^(3/2), c_n of constant restitution (`coeff_restitution`).

    Elastic spheres (e = 1) with a tangential dashpot carry it by a constant c_n lost in rounding.
    """
    elastic = law.restitution == 1.0 and gamma_t > 0.0
    damping = damping_and_ratio(0.0, gamma_t)[0] if elastic else law.restitution
    style = "velocity" if elastic else "coeff_restitution"
    return f"hertz/material {_material(law, damping)} damping {style}"


def dmt(law: DmtNormal, gamma_t: float) -> str:
    """f_el = 4/3 E* sqrt(R*) delta^(3/2) - 4 pi w R*, c_n = gamma_n."""
    return _adhesive("dmt", law, gamma_t)


def jkr(law: JkrNormal, gamma_t: float) -> str:
    """f_el(a) = 4 E* a^3/(3 R*) - 4 sqrt(pi w E* a^3), delta(a) = a^2/R* - 2 sqrt(pi w a/E*), c_n = gamma_n."""
    return _adhesive("jkr", law, gamma_t)


def _adhesive(style: str, law: DmtNormal | JkrNormal, gamma_t: float) -> str:
    damping, _ = damping_and_ratio(law.normal_damping, gamma_t)
    return f"{style} {_material(law, damping)} {number(law.surface_energy)} damping velocity"


def _material(law: HertzNormal | DmtNormal | JkrNormal, damping: float) -> str:
    return f"{number(law.youngs_modulus)} {number(damping)} {number(law.poisson_ratio)}"


def clip_words(law: NormalLaw) -> str:
    """Return the words that forbid attraction; none when it is allowed, as adhesive laws need it."""
    return " limit_damping" if getattr(law, "attraction", "allowed") == "clipped" else ""


def damping_ratio(law: NormalLaw, gamma_t: float) -> float:
    """Return x_t for a constant gamma_t; see `constant_ratio` for when there is one."""
    return damping_and_ratio(0.0 if isinstance(law, HertzNormal) else law.normal_damping, gamma_t)[1]


def constant_ratio(law: NormalLaw, gamma_t: float) -> bool:
    """Can a constant gamma_t be a multiple of the normal damping? Not where that varies with the overlap."""
    return gamma_t == 0.0 or not isinstance(law, HertzNormal) or law.restitution == 1.0


def damping_and_ratio(normal_damping: float, shear_damping: float) -> tuple[float, float]:
    """Return (c_n, x_t) with x_t c_n = gamma_t.

    >>> damping_and_ratio(2.0, 0.5)
    (2.0, 0.25)
    >>> c, x = damping_and_ratio(0.0, 0.3)
    >>> c * x, c < 1e-30
    (0.3, True)
    """
    if shear_damping == 0.0:
        return normal_damping, 0.0
    if normal_damping == 0.0:
        return shear_damping * TINY, 1.0 / TINY
    return normal_damping, shear_damping / normal_damping


_MODELS = "pair granular has hooke, hertz, hertz/material, dmt, jkr, mdr"
NORMAL: dict[type, Row] = {
    LinearNormal: Row(
        level="exact", words=linear,
        note="hooke: same formula; matched to rounding against an independent velocity-Verlet integration",
    ),
    HertzNormal: Row(
        level="exact", words=hertz,
        note="hertz/material, damping coeff_restitution: same formula, matched to rounding",
    ),
    DmtNormal: Row(level="exact", words=dmt, note="dmt, damping velocity: same formula, matched to rounding"),
    JkrNormal: Row(
        level="partial", words=jkr,
        note="jkr, damping velocity: same formula, matched to rounding; it lets go where the pull is largest, at "
        "delta = -(3/16 (pi w/E*)^2 R*)^(1/3), where surfaces led apart would hold on to 2.08 times that",
    ),
    HystereticNormal: missing(f"Illegal model type hysteretic: {_MODELS} (another plastic, adhesive law)"),
    VariableHystereticNormal: missing(f"Illegal model type luding: {_MODELS} (another plastic, adhesive law)"),
}
