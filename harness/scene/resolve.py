"""From what a person wrote to plain numbers: one function a kind of scene, found in a registry.

A new kind is one struct in `harness.scene.model`, its checks, its `grains_of`, and one line in
`KINDS`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np

from harness.scene.bodies import read_bodies, read_packing_file
from harness.scene.fault import Fault
from harness.scene.grains import Grains, grains_of, inertia_factor, mass_of
from harness.scene.lattice import lattice_particles
from harness.scene.materials import material_faults, materials_of
from harness.scene.model import (
    Biaxial,
    Body,
    ConstantMotion,
    CosineMotion,
    Couette,
    Free,
    LoadedMotion,
    Plane,
    Scene,
    TopWall,
)
from harness.scene.numerics import StepPlan, numerics_faults, plan_steps
from harness.scene.placement import EXPLICIT, PACKED, Origin, check_placement, component_faults
from harness.scene.ring import FlowingDiscs, flowing_discs, rings_of
from harness.scene.system import Constant, Cosine, Cycles, Loaded, Materials, Particles, System, Wall

__all__ = [
    "known_system", "needs_packing", "read_packing_file", "resolve", "resolve_biaxial",
    "resolve_free", "scene_name",
]


class PackedDiscs(Protocol):
    """A packing: x (N, 2) and radius (N,) in m, box (L_x, L_y) with its lower left corner at the origin."""

    x: np.ndarray
    radius: np.ndarray
    box: tuple[float, float]


def resolve(scene: Scene, file: Path, packing: PackedDiscs | FlowingDiscs | None = None) -> System:
    """Return the system that a checked scene in `file` means.

    Raises InputError for what only the particles show: their places, the time step; TypeError when
    the kind of scene needs a packing and none is given.
    """
    return KINDS[type(scene)].resolve(scene, Path(file), packing)


def needs_packing(scene: Scene) -> bool:
    """Whether `resolve` needs a packing for this kind of scene."""
    return KINDS[type(scene)].packed


def known_system(scene: Scene, file: Path) -> System | None:
    """Return the system as far as it is known without making a packing; None if that is too little.

    A packing file is taken as it stands, though a run relaxes it first: good for looking, not for running.

    Raises InputError for everything that can be wrong with a checked scene in `file` by now.
    """
    return KINDS[type(scene)].known(scene, Path(file))


def scene_name(name: str) -> str:
    """Return a file's stem as a word that is safe in decks and folder names.

    >>> scene_name("my scene; $x")
    'my_scene_x'
    """
    return re.sub(r"[^A-Za-z0-9_-]+", "_", name)[:60].strip("_") or "scene"


# --- free scenes -----------------------------------------------------------------------------


def resolve_free(scene: Free, folder: Path, *, name: str = "scene") -> System:
    """Return the system of explicit particles; `folder` is where ``<name>.toml`` and its bodies_file lie.

    Raises InputError for particles that start where they may not, and for a time step too large.
    """
    file = Path(folder) / f"{name}.toml"
    particles, materials, origin = _particles(scene, Path(folder), file)
    system = System(
        dimension=scene.dimension, particles=particles, gravity=scene.gravity, periodic=scene.periodic,
        walls=tuple(_plane_wall(k, plane, materials) for k, plane in enumerate(scene.planes, start=1)),
        materials=materials, **_common(scene, _checked_plan(scene, grains_of(scene, particles), file), name),
    )
    check_placement(system, origin, EXPLICIT)
    return system


def _particles(scene: Free, folder: Path, file: Path) -> tuple[Particles, Materials | None, Origin]:
    if scene.bodies_from is not None:
        particles = lattice_particles(scene.bodies_from)
        places = [f"bodies_from, body {k + 1}" for k in range(len(particles))]
        words, origin = (None,) * len(particles), Origin(file=file, places=places)
    else:
        bodies, origin = _bodies(scene, folder, file)
        _refuse(component_faults(bodies, scene.dimension, origin), origin.file)
        particles, words = _explicit_particles(bodies, scene.dimension), tuple(b.material for b in bodies)
    for place, fault in material_faults(scene, words, origin, file):
        raise fault.error(place)
    materials = materials_of(scene.contact, (*words, *(plane.material for plane in scene.planes)))
    if materials is not None:
        particles = replace(particles, material=np.array([word or "" for word in words]))
    return particles, materials, origin


def _bodies(scene: Free, folder: Path, file: Path) -> tuple[tuple[Body, ...], Origin]:
    if scene.bodies_file is None:
        places = [f"bodies[{i}]" for i in range(len(scene.bodies))]
        return scene.bodies, Origin(file=file, places=places, separator=".")
    path = folder / scene.bodies_file
    bodies, lines = read_bodies(path, scene.dimension)
    return bodies, Origin(file=path, places=[f"line {n}" for n in lines])


def _explicit_particles(bodies: tuple[Body, ...], dimension: int) -> Particles:
    at_rest, no_spin = (0.0,) * dimension, (0.0,) * (1 if dimension == 2 else 3)
    return Particles(
        x=np.array([b.position for b in bodies]),
        radius=np.array([b.radius for b in bodies]),
        mass=np.array([b.mass for b in bodies]),
        inertia_factor=np.array([inertia_factor(b.inertia) for b in bodies]),
        v=np.array([b.velocity or at_rest for b in bodies]),
        spin=np.array([b.spin or no_spin for b in bodies]),
    )


def _plane_wall(index: int, plane: Plane, materials: Materials | None) -> Wall:
    length = math.sqrt(sum(n * n for n in plane.normal))
    return Wall(
        index=index, name=plane.name, point=plane.point, normal=tuple(n / length for n in plane.normal),
        friction=plane.friction, motion=_motion(plane.motion),
        material=None if materials is None else plane.material or "",
    )


def _motion(table: ConstantMotion | CosineMotion | LoadedMotion | None) -> Constant | Cosine | Loaded | None:
    if isinstance(table, ConstantMotion):
        return Constant(velocity=table.velocity)
    if isinstance(table, CosineMotion):
        return Cosine(travel=table.travel, duration=table.duration)
    if isinstance(table, LoadedMotion):
        return Loaded(mass=table.mass, load=table.load, stress=0.0, span=None, damping=table.damping)
    return None


# --- biaxial box -----------------------------------------------------------------------------


def resolve_biaxial(
    scene: Biaxial, x: np.ndarray, radius: np.ndarray, box: tuple[float, float], *, name: str = "scene"
) -> System:
    """Return the box of the talks around a packing at rest: v = omega = 0, no contact history.

    x: (N, 2) centres and radius: (N,) in m; box: (L_x, L_y) in m, lower left corner at the origin.
    The top wall travels final_strain * L_y; the right wall carries side.pressure times the height.

    Raises InputError when the box gets too flat, or the time step is too large.
    """
    file = Path(f"{name}.toml")
    particles = _discs_at_rest(scene, np.asarray(x, float), np.asarray(radius, float))
    width, height = (float(length) for length in box)
    grains = grains_of(scene, particles, side=height)
    _refuse(_height_faults(scene, height, grains), file)
    system = System(
        dimension=2, particles=particles, gravity=None, periodic=None, walls=_box_walls(scene, width, height),
        **_common(scene, _checked_plan(scene, grains, file), name),
    )
    places = [f"disc {k + 1} of the packing" for k in range(len(particles))]
    check_placement(system, Origin(file=file, places=places), PACKED)
    return system


def _discs_at_rest(scene: Biaxial, x: np.ndarray, radius: np.ndarray) -> Particles:
    q = inertia_factor(scene.particles.inertia)
    return Particles(
        x=x, radius=radius, mass=mass_of(scene.particles.mass, radius),
        inertia_factor=np.full(len(radius), q), v=np.zeros_like(x), spin=np.zeros((len(radius), 1)),
    )


def _box_walls(scene: Biaxial, width: float, height: float) -> tuple[Wall, ...]:
    top, side = scene.top, scene.side
    load = Loaded(
        mass=side.mass, load=0.0, stress=side.pressure, span=("bottom", "top"), damping=side.damping
    )
    travel = _top_motion(top, height)
    walls = (
        ("left", (0.0, 0.0), (1.0, 0.0), None),
        ("bottom", (0.0, 0.0), (0.0, 1.0), None),
        ("right", (width, 0.0), (-1.0, 0.0), load),
        ("top", (0.0, height), (0.0, -1.0), travel),
    )
    return tuple(
        Wall(index=k, name=name, point=point, normal=normal, friction=False, motion=motion)
        for k, (name, point, normal, motion) in enumerate(walls, start=1)
    )


def _top_motion(top: TopWall, height: float) -> Cosine:
    way = {"travel": top.final_strain * height, "duration": top.duration}
    return Cosine(**way) if top.cycles is None else Cycles(**way, cycles=top.cycles)


def _height_faults(scene: Biaxial, height: float, grains: Grains):
    final, least = height * (1 - scene.top.final_strain), 4 * grains.largest_radius
    if final < least:
        yield Fault(
            place="top.final_strain", got=f"{scene.top.final_strain:g}, which leaves {final:.3g} m",
            expected=f"a strain that leaves twice the largest diameter, {least:.3g} m of {height:.3g} m",
            fix="take more particles or less strain",
        )


# --- Couette ring ----------------------------------------------------------------------------


def resolve_couette(scene: Couette, state: FlowingDiscs, *, name: str = "scene") -> System:
    """Return the ring around flowing discs: x, v, spin as they are, no contact history, the inner ring turning.

    Raises InputError for two centres at one place, or when the time step is too large.
    """
    file = Path(f"{name}.toml")
    particles = flowing_discs(scene, state)
    plan = _checked_plan(scene, grains_of(scene), file)
    system = System(
        dimension=2, particles=particles, gravity=None, periodic=None, walls=(), rings=rings_of(scene),
        **_common(scene, plan, name),
    )
    places = [f"disc {k + 1} of the packing" for k in range(len(particles))]
    check_placement(system, Origin(file=file, places=places), PACKED)
    return system


# --- all -------------------------------------------------------------------------------------


def _common(scene: Scene, plan: StepPlan, name: str) -> dict:
    return {
        "normal": scene.contact.normal, "sliding": scene.contact.sliding, "rolling": scene.contact.rolling,
        "torsion": scene.contact.torsion, "background": scene.background,
        "dt": plan.dt, "steps": plan.steps, "sample_every": plan.sample_every, "frame_every": plan.frame_every,
        "contacts": scene.outputs.contacts, "rotations": scene.outputs.rotations,
        "scene_name": scene_name(name), "title": scene.title,
    }


def _checked_plan(scene: Scene, grains: Grains, file: Path) -> StepPlan:
    _refuse(numerics_faults(scene, grains), file)
    return plan_steps(scene, grains)


def _refuse(faults, file: Path) -> None:
    for fault in faults:
        raise fault.error(file)


def _known_box(scene: Biaxial, file: Path) -> System | None:
    """The time step needs masses only, which the declared radii give."""
    if scene.particles.packing is None:
        _refuse(numerics_faults(scene, grains_of(scene)), file)
        return None
    x, radius = read_packing_file(file.parent, scene.particles.packing)
    corner = (x - radius[:, None]).min(axis=0)
    box = (x + radius[:, None]).max(axis=0) - corner
    return resolve_biaxial(scene, x - corner, radius, tuple(box), name=file.stem)


def _resolve_packed(scene: Biaxial, file: Path, packing: PackedDiscs | None) -> System:
    if packing is None:
        raise TypeError("a biaxial scene is resolved around a packing")
    return resolve_biaxial(scene, packing.x, packing.radius, packing.box, name=file.stem)


def _known_ring(scene: Couette, file: Path) -> System | None:
    """The time step needs masses only, which the species give."""
    _refuse(numerics_faults(scene, grains_of(scene)), file)


def _resolve_ring(scene: Couette, file: Path, state: FlowingDiscs | None) -> System:
    if state is None:
        raise TypeError("a ring is resolved around flowing discs")
    return resolve_couette(scene, state, name=file.stem)


def _resolve_explicit(scene: Free, file: Path, _: PackedDiscs | None = None) -> System:
    return resolve_free(scene, file.parent, name=file.stem)


@dataclass(frozen=True, kw_only=True)
class Kind:
    """How a kind of scene is resolved, and what is known of it before a packing is made."""

    packed: bool
    known: Callable[[Scene, Path], System | None]
    resolve: Callable[[Scene, Path, PackedDiscs | FlowingDiscs | None], System]


KINDS: dict[type, Kind] = {
    Biaxial: Kind(packed=True, known=_known_box, resolve=_resolve_packed),
    Couette: Kind(packed=True, known=_known_ring, resolve=_resolve_ring),
    Free: Kind(packed=False, known=_resolve_explicit, resolve=_resolve_explicit),
}
