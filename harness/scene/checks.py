"""What several numbers of a scene must obey together: one small function each, in a list a kind.

A check yields the faults it finds; a scene is refused with the first. What one number must obey
stands in the schema; contact laws in `harness.scene.contact_checks`; time step and outputs in
`harness.scene.numerics`; the places of the particles in `harness.scene.placement`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from harness.scene.contact_checks import OF_CONTACTS
from harness.scene.describe import either, nearest
from harness.scene.fault import Fault, show
from harness.scene.files import name_fault
from harness.scene.laws import NORMAL, first_stiffness, normal_row, turning, word
from harness.scene.materials import OF_MATERIALS
from harness.scene.model import Biaxial, ConstantMotion, CosineMotion, Couette, Free, Plane, Scene
from harness.scene.ring import OF_RINGS
from reference.values import published_values

Check = Callable[[Scene], Iterator[Fault]]

LARGEST_PRESSURE = 0.25
"""Over the stiffness with which a contact begins, both in N/m: twice that part of a radius is the overlap."""

LARGEST_LATTICE = 1_000_000
"""Bodies of a lattice."""

SAMPLED_TIMES = 1001
"""Instants at which the gap of two moving walls is looked at."""


def first_fault(scene: Scene, folder: Path) -> Fault | None:
    """Return the first fault of the scene, whose file lies in `folder`; None if there is none."""
    faults = (fault for check in CHECKS[type(scene)] for fault in check(scene))
    return next(faults, None) or _file_fault(scene, folder)


# --- biaxial ---------------------------------------------------------------------------------


def packing_can_be_relaxed(scene: Biaxial) -> Iterator[Fault]:
    """A packing is made with linear springs; it is in balance under laws that begin as one.

    Laws with a memory begin with k_1, as the box starts with none. Spheres of Hertz and his heirs
    would find other forces than those that were balanced, and a pressure in N/m does not suit them.
    """
    able = [f'"{law.__struct_config__.tag}"' for law, row in NORMAL.items() if row.first_stiffness]
    if normal_row(scene.contact.normal).first_stiffness is None:
        yield Fault(
            place="contact.normal.law", got=f'"{word(scene.contact.normal)}"',
            expected=f"{either(able)} in a biaxial box, whose packing is balanced with linear springs",
            fix='such contacts can be had in a scene with kind = "free"',
        )


def particles_given_once(scene: Biaxial) -> Iterator[Fault]:
    """Either count, radius and seed, or a packing file."""
    p = scene.particles
    drawn = {"count": p.count, "radius": p.radius, "seed": p.seed}
    given = [name for name, value in drawn.items() if value is not None]
    if p.packing is not None and given:
        yield Fault(
            place=f"particles.{given[0]}", expected="nothing beside particles.packing", got=show(drawn[given[0]])
            if given[0] != "radius" else "a table", fix="remove it, or remove packing",
        )
    missing = [name for name in drawn if name not in given]
    if p.packing is None and missing:
        yield Fault(
            place=f"particles.{missing[0]}", expected="count, radius and seed, or packing", got="nothing",
            fix=f"add {missing[0]}",
        )


def radii_in_order(scene: Biaxial) -> Iterator[Fault]:
    """Smallest radius first."""
    radius = scene.particles.radius
    if radius is not None and radius.min > radius.max:
        yield Fault(
            place="particles.radius.max", expected=f"a number >= particles.radius.min = {radius.min:g}",
            got=f"{radius.max:g}",
        )


def one_packing_of_a_file(scene: Biaxial) -> Iterator[Fault]:
    """Several packings differ by their seed; a file has none."""
    if scene.particles.packing is not None and scene.compare.packings > 1:
        yield Fault(
            place="compare.packings", expected="1, as particles.packing is one packing",
            got=str(scene.compare.packings), fix="give count, radius and seed for several",
        )


def pressures_leave_grains_apart(scene: Biaxial) -> Iterator[Fault]:
    """Discs under a pressure p overlap by about p d/k, d their diameter; beyond half a radius a law means nothing.

    p d is the force a contact in a square lattice. Measured with 200 discs: a packing is found at p = k/5, none at k/4.
    """
    stiffness = first_stiffness(scene.contact.normal)
    pressures = {"preparation.pressure": scene.preparation.pressure, "side.pressure": scene.side.pressure}
    for place, pressure in pressures.items():
        if pressure > LARGEST_PRESSURE * stiffness:
            yield Fault(
                place=place, got=f"{pressure:g}", fix="lower it, or stiffen the contacts",
                expected=f"a pressure of at most {LARGEST_PRESSURE * stiffness:g} N/m, a quarter of the normal "
                "stiffness, at which discs overlap by half their radius",
            )


def windows_within_strain(scene: Biaxial) -> Iterator[Fault]:
    """A window ends before the run does."""
    for i, window in enumerate(scene.compare.windows):
        if window.strain > scene.top.final_strain:
            yield Fault(
                place=f"compare.windows[{i}].strain", got=f"{window.strain:g}",
                expected=f"a number <= top.final_strain = {scene.top.final_strain:g}",
            )


def strains_within_strain(scene: Biaxial) -> Iterator[Fault]:
    """Quantities are compared at strains that the run reaches, in rising order."""
    strains = scene.compare.strains
    if list(strains) != sorted(set(strains)) or any(s > scene.top.final_strain for s in strains):
        yield Fault(
            place="compare.strains", got=show(strains),
            expected=f"rising numbers up to top.final_strain = {scene.top.final_strain:g}",
        )


def plateau_within_strain(scene: Biaxial) -> Iterator[Fault]:
    """A plateau is a range of strains that the run reaches."""
    if scene.compare.plateau is None:
        return
    low, high = scene.compare.plateau
    if not 0 <= low < high <= scene.top.final_strain:
        yield Fault(
            place="compare.plateau", got=show(scene.compare.plateau),
            expected=f"two rising numbers from 0 to top.final_strain = {scene.top.final_strain:g}",
        )


def published_values_exist(scene: Biaxial) -> Iterator[Fault]:
    """A published value is named as in `reference/values`, and a plateau value needs a plateau."""
    known = {name: value for name, value in published_values().items() if value.kind == "published"}
    for i, name in enumerate(scene.compare.published):
        place = f"compare.published[{i}]"
        if name not in known:
            yield Fault(
                place=place, expected="the name of a published value in reference/values", got=show(name),
                fix=nearest(name, known),
            )
        elif known[name].quantity.startswith("plateau") and scene.compare.plateau is None:
            yield Fault(
                place="compare.plateau", expected=f"a strain range for {known[name].quantity}", got="nothing",
                fix=f"add plateau, or remove {name} from compare.published",
            )


# --- free ------------------------------------------------------------------------------------


def bodies_given_once(scene: Free) -> Iterator[Fault]:
    """Particles stand in the scene, in a file or on a lattice."""
    given = {"bodies": bool(scene.bodies), "bodies_file": scene.bodies_file, "bodies_from": scene.bodies_from}
    names = [name for name, value in given.items() if value not in (None, False)]
    if len(names) != 1:
        got = " and ".join(names) if names else "none of them"
        yield Fault(place="bodies", expected="one of bodies, bodies_file and bodies_from", got=got)


def lattice_is_drawn_from_a_seed(scene: Free) -> Iterator[Fault]:
    """What is drawn needs a seed; a lattice has as many counts as axes, and triangles only in the plane."""
    lattice = scene.bodies_from
    if lattice is None:
        return
    if lattice.radius.min > lattice.radius.max:
        yield Fault(
            place="bodies_from.radius.max", got=f"{lattice.radius.max:g}",
            expected=f"a number >= bodies_from.radius.min = {lattice.radius.min:g}",
        )
    if lattice.arrangement == "triangular" and scene.dimension == 3:
        yield Fault(place="bodies_from.arrangement", expected='"square" in 3D', got='"triangular"')
    if lattice.seed is None and (lattice.speed or lattice.radius.min < lattice.radius.max):
        yield Fault(
            place="bodies_from.seed", expected="an integer, as radii or velocities are drawn", got="nothing",
            fix="add seed",
        )
    if math.prod(lattice.counts) > LARGEST_LATTICE:
        yield Fault(
            place="bodies_from.counts", got=show(list(lattice.counts)), expected=f"at most {LARGEST_LATTICE} bodies"
        )


def vectors_fit_dimension(scene: Free) -> Iterator[Fault]:
    """Vectors of planes and box have as many components as the scene."""
    vectors = {"gravity": scene.gravity, "periodic": scene.periodic}
    if scene.bodies_from is not None:
        vectors |= {"bodies_from.corner": scene.bodies_from.corner, "bodies_from.counts": scene.bodies_from.counts}
    for i, plane in enumerate(scene.planes):
        vectors |= {f"planes[{i}].point": plane.point, f"planes[{i}].normal": plane.normal}
        if isinstance(plane.motion, ConstantMotion):
            vectors[f"planes[{i}].motion.velocity"] = plane.motion.velocity
    for place, vector in vectors.items():
        if vector is not None and len(vector) != scene.dimension:
            yield Fault(
                place=place, expected=f"{scene.dimension} components, as dimension = {scene.dimension}",
                got=f"{len(vector)}: {show(vector)}",
            )


def gravity_is_on(scene: Free) -> Iterator[Fault]:
    """Gravity zero is no gravity."""
    if scene.gravity is not None and not any(scene.gravity):
        yield Fault(
            place="gravity", expected="a vector other than zero", got=show(scene.gravity),
            fix="remove it: an effect that is off does not exist",
        )


def periodic_is_on(scene: Free) -> Iterator[Fault]:
    """A box without a periodic axis is no box."""
    if scene.periodic is not None and not any(scene.periodic):
        yield Fault(
            place="periodic", expected="a length > 0 for at least one axis", got=show(scene.periodic),
            fix="remove it: without a periodic axis there is no box",
        )


def plane_names_differ(scene: Free) -> Iterator[Fault]:
    """Output columns and decks tell walls apart by name."""
    names = [p.name for p in scene.planes]
    for i, name in enumerate(names):
        if name in names[:i]:
            yield Fault(
                place=f"planes[{i}].name", expected="a name of its own", got=f"{show(name)} again",
                fix=f"planes[{names.index(name)}] has it",
            )


def normals_point_somewhere(scene: Free) -> Iterator[Fault]:
    """A normal has a direction; its length does not matter."""
    for i, plane in enumerate(scene.planes):
        if not any(plane.normal):
            yield Fault(
                place=f"planes[{i}].normal", got=show(plane.normal),
                expected="a vector other than zero that points to the particles",
            )


def motions_are_on(scene: Free) -> Iterator[Fault]:
    """A wall that does not move has no motion table."""
    for i, plane in enumerate(scene.planes):
        motion = plane.motion
        still = isinstance(motion, ConstantMotion) and not any(motion.velocity)
        if still or (isinstance(motion, CosineMotion) and motion.travel == 0):
            yield Fault(
                place=f"planes[{i}].motion", expected="a motion other than zero", got="zero",
                fix="remove the table: a plane without motion is fixed",
            )


def rough_planes_have_friction(scene: Free) -> Iterator[Fault]:
    """At a frictional plane the particles' own tangential laws act, so there must be one."""
    for i, plane in enumerate(scene.planes):
        if plane.friction and not turning(scene.contact):
            yield Fault(
                place=f"planes[{i}].friction", got="true",
                expected="false, as there is no table contact.sliding, rolling or torsion",
                fix="add contact.sliding, whose law the plane would use",
            )


def planes_leave_periodic_axes_free(scene: Free) -> Iterator[Fault]:
    """A plane that closes a periodic axis would be met from both sides."""
    for i, plane in enumerate(scene.planes):
        for axis, length in enumerate(scene.periodic or ()):
            if length and plane.normal[axis]:
                yield Fault(
                    place=f"planes[{i}].normal", got=show(plane.normal),
                    expected=f"no component along the periodic axis {'xyz'[axis]}",
                )


def planes_stay_apart(scene: Free) -> Iterator[Fault]:
    """Parallel planes that face each other may not meet, at the start or by their prescribed motion."""
    for j, second in enumerate(scene.planes):
        for i, first in enumerate(scene.planes[:j]):
            if not _face_each_other(first, second):
                continue
            gap, time = _smallest_gap(first, second, scene.duration)
            if gap <= 0:
                yield Fault(
                    place=f"planes[{j}].motion" if time else f"planes[{j}].point",
                    expected=f"a gap > 0 to the facing plane planes[{i}] {show(first.name)} at all times",
                    got=f"{gap:.3g} m at t = {time:.3g} s",
                )


def _face_each_other(first: Plane, second: Plane) -> bool:
    n = np.array(first.normal) / np.linalg.norm(first.normal)
    m = np.array(second.normal) / np.linalg.norm(second.normal)
    return bool(np.abs(n + m).max() < 1e-9)


def _smallest_gap(first: Plane, second: Plane, duration: float) -> tuple[float, float]:
    """Return the smallest gap (m) and its time (s); loaded walls count as standing."""
    time = np.linspace(0.0, duration, SAMPLED_TIMES)
    n = np.array(first.normal) / np.linalg.norm(first.normal)
    start = float((np.array(second.point) - np.array(first.point)) @ n)
    gap = start - _advance(first, time) - _advance(second, time)
    k = int(gap.argmin())
    return float(gap[k]), float(time[k])


def _advance(plane: Plane, time: np.ndarray) -> np.ndarray:
    """Displacement along the plane's normal (m) at `time` (s)."""
    motion = plane.motion
    if isinstance(motion, ConstantMotion):
        return float(np.array(motion.velocity) @ plane.normal / np.linalg.norm(plane.normal)) * time
    if isinstance(motion, CosineMotion):
        return motion.travel / 2 * (1 - np.cos(np.pi * np.minimum(time / motion.duration, 1.0)))
    return np.zeros_like(time)


def _file_fault(scene: Scene, folder: Path) -> Fault | None:
    named = {Biaxial: ("particles", "packing"), Free: ("bodies_file",)}.get(type(scene), ())
    name = scene if named else None
    for key in named:
        name = getattr(name, key)
    return None if name is None else name_fault(folder, name, ".".join(named))


CHECKS: dict[type, tuple[Check, ...]] = {
    Biaxial: (
        *OF_CONTACTS, *OF_MATERIALS, packing_can_be_relaxed, pressures_leave_grains_apart,
        particles_given_once, radii_in_order, one_packing_of_a_file, windows_within_strain,
        plateau_within_strain, published_values_exist, strains_within_strain,
    ),
    Couette: (*OF_CONTACTS, *OF_MATERIALS, *OF_RINGS),
    Free: (
        *OF_CONTACTS, *OF_MATERIALS,
        bodies_given_once, lattice_is_drawn_from_a_seed, vectors_fit_dimension, gravity_is_on, periodic_is_on,
        plane_names_differ, normals_point_somewhere, motions_are_on, rough_planes_have_friction,
        planes_leave_periodic_axes_free, planes_stay_apart,
    ),
}
