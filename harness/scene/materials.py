"""Materials of a free scene: the numbers of the contact laws between every two of them.

The laws are those of `contact` everywhere; `contact.between` replaces numbers for pairs of materials. Codes mix numbers
of materials by rules of their own, so a scene has no such rule: a pair has an entry, or the numbers of `contact`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np
from msgspec.structs import asdict, replace

from harness.scene.contact import Between, Contact, LinearNormal, NormalNumbers, SlidingNumbers, SpringSliding
from harness.scene.describe import nearest
from harness.scene.fault import Fault, show
from harness.scene.grains import Pair
from harness.scene.laws import word
from harness.scene.model import Free, Scene
from harness.scene.placement import Origin
from harness.scene.system import Materials, System


def laws_between(contact: Contact, one: str, other: str) -> Contact:
    """Return the laws with the numbers that two materials have, "" for bodies and walls without a material."""
    k = entry_of(contact, one, other)
    return replace(contact, between=()) if k is None else _with_numbers(contact, contact.between[k])


def entry_of(contact: Contact, one: str, other: str) -> int | None:
    """Return which entry of `contact.between` two materials have, from 0 on; None for the numbers of `contact`."""
    pairs = [sorted(entry.materials) for entry in contact.between]
    return pairs.index(sorted((one, other))) if sorted((one, other)) in pairs else None


def laws_of_pair(contact: Contact, pair: Pair) -> Contact:
    """Return the laws under which a pair meets; those of the scene themselves where it has no materials."""
    return contact if pair.materials is None else laws_between(contact, *pair.materials)


def materials_of(contact: Contact, words: Iterable[str | None]) -> Materials | None:
    """Return the materials of all bodies and walls, their words in alphabetical order; None if none has a word."""
    names = sorted({name or "" for name in words})
    if not any(names):
        return None
    laws = [[laws_between(contact, a, b) for b in names] for a in names]
    normal, sliding = (tuple(tuple(getattr(c, f) for c in row) for row in laws) for f in ("normal", "sliding"))
    return Materials(names=tuple(names), normal=normal, sliding=None if contact.sliding is None else sliding)


def by_law(system: System, first: np.ndarray, second: np.ndarray) -> Iterator[tuple[System, np.ndarray | slice]]:
    """Yield the system with the laws of contacts, and which of them these are; in systems without materials, all.

    first: (C,), row numbers of particles. second: (C,), row numbers too, or minus the index of a wall.
    """
    if system.materials is None:
        yield system, slice(None)
        return
    nodes = np.array([*(w.material for w in reversed(system.walls)), *system.particles.material])
    one, other = (system.materials.numbers(nodes)[np.add(rows, len(system.walls))] for rows in (first, second))
    names = system.materials.names
    for a, b in combinations_with_replacement(range(len(names)), 2):
        which = np.flatnonzero((np.minimum(one, other) == a) & (np.maximum(one, other) == b))
        if len(which):
            yield system.between(names[a], names[b]), which


def stiffness_of_contacts(system: System, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return k_n of contacts under linear laws, (C,), N/m; arguments as of `by_law`."""
    found = np.empty(len(first))
    for pair, which in by_law(system, first, second):
        found[which] = pair.normal.normal_stiffness
    return found


def contact_of(system: System) -> Contact:
    """Return the laws of a system as a scene has them, with an entry for every two materials."""
    laws = {family: getattr(system, family) for family in ("normal", "sliding", "rolling", "torsion")}
    if system.materials is None:
        return Contact(**laws)
    pairs = combinations_with_replacement(system.materials.names, 2)
    return Contact(**laws, between=tuple(_entry(system, *pair) for pair in pairs))


def _entry(system: System, one: str, other: str) -> Between:
    met = system.between(one, other)
    normal, sliding = (
        None if law is None else kind(**{name: getattr(law, name) for name in kind.__struct_fields__})
        for law, kind in ((met.normal, NormalNumbers), (met.sliding, SlidingNumbers))
    )
    return Between(materials=(one, other), normal=normal, sliding=sliding)


def _with_numbers(contact: Contact, entry: Between) -> Contact:
    sliding = contact.sliding if entry.sliding is None else replace(contact.sliding, **asdict(entry.sliding))
    return replace(contact, normal=replace(contact.normal, **asdict(entry.normal)), sliding=sliding, between=())


# --- what can be wrong -----------------------------------------------------------------------


def between_fits_the_scene(scene: Scene) -> Iterator[Fault]:
    """Numbers for pairs: of linear laws, in free scenes, where bodies can say what they are of."""
    contact, place = scene.contact, "contact.between"
    if not contact.between:
        return
    if not isinstance(scene, Free):
        kind = scene.__struct_config__.tag
        yield Fault(
            place=place, expected=f'no such table in a scene with kind = "{kind}", whose bodies have one material',
            got="a table", fix='remove it, or take kind = "free"',
        )
    if not isinstance(contact.normal, LinearNormal):
        law = word(contact.normal)
        yield _no_table(place, f'contact.normal.law = "{law}"', 'remove it; only law = "linear" has one')
    for family in ("rolling", "torsion"):
        if getattr(contact, family) is not None:
            yield _no_table(place, f"a table contact.{family}", f"remove it, or contact.{family}")
    if isinstance(contact.sliding, SpringSliding) and contact.sliding.dynamic_friction is not None:
        yield _no_table(place, "contact.sliding.dynamic_friction", "remove it, or the dynamic coefficient")
    elif not isinstance(contact.sliding, SpringSliding | None):
        law = word(contact.sliding)
        yield _no_table(place, f'contact.sliding.law = "{law}"', 'take contact.sliding.law = "spring", or remove it')


def entries_differ(scene: Scene) -> Iterator[Fault]:
    """Every pair has one entry, and only numbers of laws that the scene has."""
    pairs = [tuple(sorted(b.materials)) for b in scene.contact.between]
    for k, (pair, entry) in enumerate(zip(pairs, scene.contact.between, strict=True)):
        if pair in pairs[:k]:
            yield Fault(
                place=f"contact.between[{k}].materials", expected="a pair without an entry so far",
                got=show(list(entry.materials)), fix=f"contact.between[{pairs.index(pair)}] has it; remove one",
            )
        if entry.sliding is not None and scene.contact.sliding is None:
            yield Fault(
                place=f"contact.between[{k}].sliding", expected="no table, as there is no contact.sliding",
                got="a table", fix="remove it, or add contact.sliding with the numbers of all other pairs",
            )


def material_faults(
    scene: Free, words: Sequence[str | None], origin: Origin, file: Path
) -> Iterator[tuple[Path, Fault]]:
    """Yield words that no entry knows, and entries of what nobody is made of, with the file that has them."""
    entries = scene.contact.between
    known = sorted({name for b in entries for name in b.materials})
    places = [(origin.file, origin.at(i, "material"), name) for i, name in enumerate(words)]
    places += [(file, f"planes[{i}].material", plane.material) for i, plane in enumerate(scene.planes)]
    for where, place, name in places:
        if name is not None and name not in known:
            yield where, _unknown(place, name, known)
    used = {name for *_, name in places}
    for k, name in ((k, name) for k, entry in enumerate(entries) for name in entry.materials):
        if name not in used:
            yield file, Fault(
                place=f"contact.between[{k}].materials", expected="materials that bodies or planes have",
                got=show(name), fix=nearest(name, [u for u in used if u]) or f'write material = "{name}" in a body',
            )


def _unknown(place: str, name: str, known: list[str]) -> Fault:
    expected = f"one of {', '.join(known)}" if known else "no material, as there is no table contact.between"
    fix = nearest(name, known) or f'add [[contact.between]] with materials = ["{name}", "{name}"]'
    return Fault(place=place, expected=expected, got=show(name), fix=fix)


def _no_table(place: str, what: str, fix: str) -> Fault:
    return Fault(place=place, expected=f"no table beside {what}", got="a table", fix=fix)


OF_MATERIALS = (between_fits_the_scene, entries_differ)
"""The checks of a scene whose particles need not be known."""
