"""The contact law in the words of `pair_coeff` and of the granular form of `fix wall/gran/region`.

LAMMPS (pair granular, hooke / velocity / linear_history), for n from j to i, overlap delta:

    f_n = k_n delta - c_n v_n                          clipped at 0 with `limit_damping`
    f_t = -k_t u - x_t c_n v_t,  |f_t| <= mu |f_n|     u integrates v_t, is turned with n, cut by slip

Tangential damping is a multiple x_t of the normal one, so gamma_t = x_t c_n. With gamma_n = 0 and
gamma_t > 0 a multiple does not exist; c_n = 2^-100 gamma_t and x_t = 2^100 then give gamma_t to the
last bit and a normal damping thirty orders below it, lost in rounding against k_n delta.
"""

from __future__ import annotations

from harness.engines.text import number
from harness.scene.model import LinearNormal, SpringSliding

TINY = 2.0**-100
SMOOTH = "tangential linear_nohistory 0 0"
"""No tangential force: pair granular insists on a tangential model, this one has no history."""
NO_LIMIT = 1e30
"""Friction coefficient of the clone that tells the springs: nothing slips in it."""


def normal_words(normal: LinearNormal, damping: float) -> str:
    """Return the normal law; `damping` is c_n of the module's formula, kg/s."""
    return f"hooke {number(normal.normal_stiffness)} {number(damping)} damping velocity"


def sliding_words(sliding: SpringSliding, ratio: float, friction: float) -> str:
    """Return the tangential law; `ratio` is x_t of the module's formula."""
    return f"tangential linear_history {number(sliding.shear_stiffness)} {number(ratio)} {number(friction)}"


def clip_words(normal: LinearNormal) -> str:
    """Return the words that forbid attraction; none when it is allowed."""
    return " limit_damping" if normal.attraction == "clipped" else ""


def smooth_law(normal: LinearNormal) -> str:
    """Return the law of a frictionless contact."""
    return f"{normal_words(normal, normal.normal_damping)} {SMOOTH}{clip_words(normal)}"


def contact_law(normal: LinearNormal, sliding: SpringSliding | None, friction: float | None = None) -> str:
    """Return the law between particles; `friction` replaces mu (the springs' clone)."""
    if sliding is None:
        return smooth_law(normal)
    damping, ratio = damping_and_ratio(normal.normal_damping, sliding.shear_damping)
    mu = sliding.shear_friction if friction is None else friction
    return f"{normal_words(normal, damping)} {sliding_words(sliding, ratio, mu)}{clip_words(normal)}"


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
