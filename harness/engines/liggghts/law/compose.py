"""From a system to the whole law: the words of all its laws together."""

from __future__ import annotations

from functools import reduce

import numpy as np

from harness.engines.liggghts.law.couples import ROLLING, TORSION
from harness.engines.liggghts.law.kinds import (
    MOST_BODIES,
    Kind,
    bodies,
    kinds,
    type_of_wall,
    types_of_glued,
    types_of_particles,
)
from harness.engines.liggghts.law.normal import HARDEST, NORMAL, SOFTEST
from harness.engines.liggghts.law.sliding import SLIDING
from harness.engines.liggghts.law.words import Constant, Judgement, Words
from harness.scene.contact import HertzNormal
from harness.scene.system import System, Wall


def words(system: System) -> tuple[Words, ...]:
    """Return the words of the laws that are on: normal, sliding, rolling, torsion."""
    tables = {"normal": NORMAL, "sliding": SLIDING, "rolling": ROLLING, "torsion": TORSION}
    laws = ((rows, getattr(system, family)) for family, rows in tables.items())
    return tuple(rows[type(law)](system) for rows, law in laws if law is not None)


def judgements(system: System) -> dict[str, Judgement]:
    """Return how LIGGGHTS stands to the effects that are laws, by effect."""
    return reduce(lambda a, b: a | b, (dict(w.judged) for w in words(system)))


def too_many_bodies(system: System) -> str:
    """Return why the tables of a dashpot would be too large, "" if they are not."""
    count = len(bodies(system))
    if count <= MOST_BODIES or not _by_body(system):
        return ""
    return (
        f"LIGGGHTS makes this dashpot of a table over pairs of bodies: up to {MOST_BODIES} different radii or masses, "
        f"not {count}"
    )


def law_lines(system: System) -> list[str]:
    """Return the constants and the law between particles."""
    laws = words(system)
    kinds_of_all = kinds(system, by_body=_by_body(system))
    constants: dict[str, Constant] = reduce(lambda a, b: a | b, (dict(w.constants) for w in laws))
    return [
        "", *(w.comment for w in laws if w.comment), *_materials_comment(kinds_of_all),
        *(constant.line(name, kinds_of_all) for name, constant in constants.items()),
        f"pair_style gran {model_words(system, rough=len(laws) > 1)} {setting_words(system)}".rstrip(),
        "pair_coeff * *",
    ]


def _materials_comment(kinds_of_all: tuple[Kind, ...]) -> list[str]:
    """Return which atom types are of which material."""
    if kinds_of_all[0].material is None:
        return []
    said = (f"{t} {kind.material or 'without a material'}" for t, kind in enumerate(kinds_of_all, start=1))
    return [f"# atom types: {', '.join(said)}"]


def header_lines(system: System) -> list[str]:
    """Return what has to stand before the particles: leave for moduli that LIGGGHTS finds unusual."""
    if not isinstance(system.normal, HertzNormal):
        return []
    modulus = system.normal.youngs_modulus
    return ["soft_particles yes"] * (modulus < SOFTEST) + ["hard_particles yes"] * (modulus > HARDEST)


def model_words(system: System, *, rough: bool) -> str:
    """Return the contact model: all laws, or what only pushes."""
    laws = words(system)
    return "".join(w.model for w in (laws if rough else laws[:1]))


def setting_words(system: System) -> str:
    """Return the settings of the model; in a wall's line they must come last."""
    return " ".join(setting for w in words(system) for setting in w.settings)


def type_count(system: System) -> int:
    """Return the number of atom types."""
    return len(kinds(system, by_body=_by_body(system)))


def particle_types(system: System) -> np.ndarray:
    """Return the atom type of every particle, (N,)."""
    return types_of_particles(system, by_body=_by_body(system))


def glued_types(system: System) -> np.ndarray:
    """Return the atom type of every glued disc, (M,)."""
    return types_of_glued(system, by_body=_by_body(system))


def wall_type(system: System, wall: Wall) -> int:
    """Return the atom type whose constants a wall has."""
    return type_of_wall(system, wall, by_body=_by_body(system))


def history(system: System) -> tuple[str, ...]:
    """Return the names of the numbers that a contact remembers, in LIGGGHTS' order."""
    return tuple(name for w in words(system) for name in w.history)


def observation_moves(system: System) -> str:
    """Return why writing contacts would change the run, "" if it does not."""
    return next((w.moved_by_output for w in words(system) if w.moved_by_output), "")


def told_history(system: System) -> tuple[str, ...]:
    """Return the names of the numbers that contact output tells: what contacts remember, if that has a spring."""
    names = history(system)
    return names if "ux" in names else ()


def _by_body(system: System) -> bool:
    return any(w.by_body for w in words(system))
