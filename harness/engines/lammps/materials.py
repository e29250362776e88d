"""Materials: an atom type each, a law for every two types, and for each at a wall.

LAMMPS mixes the coefficients of two types that have none of their own by rules of its own (geometric means), so every
two types are given theirs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations_with_replacement, product

from harness.engines.facts import loaded_walls
from harness.engines.lammps.law import wall_law
from harness.engines.lammps.packing import carrier_type, types_of_material, words
from harness.scene.system import System, Wall

WITHOUT = "without a material"


def pair_coefficients(system: System, law: Callable[[System], str]) -> list[str]:
    """Return the `pair_coeff` lines; `law` writes a law in LAMMPS' words."""
    if system.materials is None:
        return [f"pair_coeff * * {law(system)}"]
    lines = []
    for one, other in combinations_with_replacement(words(system), 2):
        text = law(system.between(one, other))
        lines += [f"pair_coeff {i} {j} {text}" for i, j in _type_pairs(system, one, other)]
    return lines + _carrier_lines(system, law)


def materials_comment(system: System) -> list[str]:
    """Return which atom types are of which material."""
    if system.materials is None:
        return []
    types = {word: " ".join(str(t) for t in types_of_material(system, word)) for word in words(system)}
    return [f"# atom types: {', '.join(f'{t} {word or WITHOUT}' for word, t in types.items())}"]


def group_of_materials(system: System) -> list[str]:
    """Return the groups that walls with several laws look at."""
    if all(len(wall_laws(system, wall)) == 1 for wall in system.walls):
        return []
    return [f"group {_group(w)} type {' '.join(map(str, types_of_material(system, w)))}" for w in words(system)]


def wall_laws(system: System, wall: Wall) -> list[tuple[str, str, str]]:
    """Return name, group and law of the fixes that a wall needs: one, unless its laws differ between materials.

    Walls have no capitals in their names, so that no other wall bears such a name.
    """
    laws = {word: wall_law(system.between(word, wall.material), wall) for word in words(system)}
    if len(set(laws.values())) == 1:
        return [(wall.name, "grains", next(iter(laws.values())))]
    return [(f"{wall.name}_OF_{word}", _group(word), law) for word, law in laws.items()]


def _type_pairs(system: System, one: str, other: str) -> Iterator[tuple[int, int]]:
    """Yield every two types of two materials once, the lower number first."""
    found = {tuple(sorted(p)) for p in product(types_of_material(system, one), types_of_material(system, other))}
    yield from sorted(found)


def _carrier_lines(system: System, law: Callable[[System], str]) -> list[str]:
    """The carriers of walls touch nothing, but LAMMPS wants a law for their type."""
    if not loaded_walls(system):
        return []
    first = words(system)[0]
    return [f"pair_coeff * {carrier_type(system)} {law(system.between(first, first))}"]


def _group(word: str) -> str:
    return f"material_{word}" if word else "material"
