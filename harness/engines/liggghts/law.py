"""The contact law in the words of `pair_style gran` and `fix wall/gran`.

LIGGGHTS (hooke/stiffness with absolute_damping, tangential history), n from j to i, overlap delta:

    f_n = k_n delta - gamma_n v_n                     clipped at 0 with `limitForce`
    f_t = -k_t u - gamma_t v_t  or, when k_t |u| > mu |f_n|,  the spring alone, cut to mu |f_n|

Constants are tables over atom types. Type 1 is everything that exists; type 2 exists only for meshes
without friction beside meshes with friction, because all meshes share one `fix wall/gran`: its
tangential constants are zero.
"""

from __future__ import annotations

from harness.engines.facts import is_rough
from harness.engines.liggghts.planes import meshes
from harness.engines.text import number
from harness.scene.system import System, Wall

SMOOTH_TYPE = 2


def type_count(system: System) -> int:
    """Return the number of atom types."""
    return SMOOTH_TYPE if _mixed(system) else 1


def wall_type(system: System, wall: Wall) -> int:
    """Return the atom type whose constants a wall has."""
    return SMOOTH_TYPE if _mixed(system) and wall in meshes(system) and not is_rough(system, wall) else 1


def law_lines(system: System) -> list[str]:
    """Return the constants and the law between particles."""
    normal, sliding = system.normal, system.sliding
    if sliding is None:
        tangential = {"kt": 0.0, "gammat_abs": 0.0}
        note = "# smooth particles; hooke/stiffness asks for tangential constants even when nothing uses them"
    else:
        tangential = {"kt": sliding.shear_stiffness, "gammat_abs": sliding.shear_damping,
                      "coefficientFriction": sliding.shear_friction}
        note = "# linear spring and dashpot along the normal and, up to Coulomb's limit, across it"
    return [
        "", note,
        _constant("kn", normal.normal_stiffness, system),
        _constant("gamman_abs", normal.normal_damping, system),
        *(_constant(name, value, system, smooth=0.0) for name, value in tangential.items()),
        f"pair_style gran {model_words(sliding is not None)} {setting_words(system)}",
        "pair_coeff * *",
    ]


def model_words(rough: bool) -> str:
    """Return the contact model, with tangential springs if it is rough."""
    return "model hooke/stiffness" + (" tangential history" if rough else "")


def setting_words(system: System) -> str:
    """Return the settings of the model; in a wall's line they must come last."""
    clip = " limitForce on" if system.normal.attraction == "clipped" else ""
    return "absolute_damping on" + clip


def _mixed(system: System) -> bool:
    return len({is_rough(system, w) for w in meshes(system)}) == 2


def _constant(name: str, value: float, system: System, smooth: float | None = None) -> str:
    """Return one table over pairs of types; `smooth` is the value where type 2 takes part."""
    values = [value]
    if type_count(system) == SMOOTH_TYPE:
        values += [value if smooth is None else smooth] * 3
    table = " ".join(number(v) for v in values)
    return f"fix {name} all property/global {name} peratomtypepair {type_count(system)} {table}"
