"""What the masses of a scene's particles mean for its time scales, before or after a packing exists."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import singledispatch
from itertools import combinations_with_replacement

import numpy as np

from harness.scene.model import Biaxial, Couette, DiscMass, Free, Inertia, LoadedMotion, Scene, SphereMass
from harness.scene.system import INERTIA_FACTOR, Particles

AREA_FRACTION = 0.84
"""Random discs jam near this area fraction; used to estimate the size of a box that is not packed yet."""


@dataclass(frozen=True, kw_only=True)
class Pair:
    """Two particles that touch, or one that touches a wall, and what they are.

    reduced_mass: m* = m_i m_j/(m_i + m_j), kg, at a wall m_i. reduced_radius: R* = a_i a_j/(a_i + a_j), m,
    at a wall a_i. materials: the words of both, "" for none; None in scenes without materials. at_wall: the second is a
    wall.
    """

    name: str
    reduced_mass: float
    reduced_radius: float
    materials: tuple[str, str] | None = None
    at_wall: bool = False


@dataclass(frozen=True, kw_only=True)
class Grains:
    """Particles as far as time scales ask for them.

    count; mean_mass, total_mass in kg; largest_radius in m; pairs: the smallest, mean and largest one.
    inverse_mass, inverse_turning: largest 1/m and 1/(q m) of a particle in 1/kg, q from I = q m a^2.
    lightest: no contact of the lightest particle is stiffer than this one. heaviest: no contact is stiffer.
    turning_share: what one rolling or torsion spring k adds to w^2 of a spin, over k/(q m): 2 (a_ij/a_i)^2
    between particles that turn against each other, a_ij/a_i at most a_max/(a_min + a_max); 1 at a wall.
    side: length of the box (m) along a wall, None when there is no box; per_wall: particles that
    touch one wall of that length. parts: in scenes with materials the particles of each, with the pairs they are in.
    """

    dimension: int
    count: int
    mean_mass: float
    total_mass: float
    largest_radius: float
    pairs: tuple[Pair, ...]
    inverse_mass: float
    inverse_turning: float
    lightest: Pair
    heaviest: Pair
    turning_share: float
    side: float | None = None
    per_wall: float = 1.0
    parts: tuple[Grains, ...] = ()


def mass_of(law: SphereMass | DiscMass, radius: np.ndarray) -> np.ndarray:
    """Masses (kg) of particles of the given radii (m), any shape.

    Sphere: 4/3 pi rho a^3; disc of height h: pi rho h a^2. Written as products, whose bits are the same
    on every machine, because they stand in the committed decks.
    """
    if isinstance(law, DiscMass):
        return math.pi * law.density * law.height * (radius * radius)
    return 4.0 / 3.0 * math.pi * law.density * (radius * radius * radius)


def inertia_factor(inertia: Inertia) -> float:
    """Return q in I = q m a^2 for a name, or the number itself."""
    return INERTIA_FACTOR[inertia] if isinstance(inertia, str) else float(inertia)


@singledispatch
def grains_of(scene: Scene, particles: Particles | None = None, side: float | None = None) -> Grains:  # noqa: ARG001
    """Return the particles of a scene; a new kind of scene registers its own function here.

    particles: the actual ones, which only a box with declared radii can do without; side: height of
    a packed box in m.
    """
    raise TypeError(f"no particles known for a scene of type {type(scene).__name__}")


@grains_of.register
def _(scene: Biaxial, particles: Particles | None = None, side: float | None = None) -> Grains:
    """Extremes as declared, else as they are; averages as they are, else as declared."""
    declared = scene.particles.radius
    if particles is None:
        low, high, count = declared.min, declared.max, scene.particles.count
        moments = [_uniform_moment(low, high, n) for n in (1, 2, 3)]
    else:
        radius, count = particles.radius, len(particles)
        low, high = (declared.min, declared.max) if declared else (float(radius.min()), float(radius.max()))
        moments = [float((radius**n).mean()) for n in (1, 2, 3)]
    return _box_grains(scene, count, low, high, moments, side)


@grains_of.register
def _(scene: Free, particles: Particles | None = None, side: float | None = None) -> Grains:  # noqa: ARG001
    """Masses as given; a single particle can touch walls only."""
    p = particles
    low, high = float(p.radius.min()), float(p.radius.max())
    grains = Grains(
        dimension=scene.dimension, count=len(p), mean_mass=float(p.mass.mean()), total_mass=float(p.mass.sum()),
        largest_radius=high, pairs=_free_pairs(p),
        inverse_mass=float(1.0 / p.mass.min()), inverse_turning=float(1.0 / (p.inertia_factor * p.mass).min()),
        lightest=Pair(name="lightest", reduced_mass=float(p.mass.min()), reduced_radius=high),
        heaviest=Pair(name="heaviest", reduced_mass=float(p.mass.max()), reduced_radius=high),
        turning_share=_turning_share(low, high), per_wall=_touching_loaded_walls(scene, p),
    )
    return grains if p.material is None else _with_materials(grains, scene, p)


@grains_of.register
def _(scene: Couette, particles: Particles | None = None, side: float | None = None) -> Grains:  # noqa: ARG001
    """Species as declared. A glued disc is heavier than any: its contacts are slower than those of free pairs."""
    species = scene.particles.species
    count, radius = (np.array([getattr(s, name) for s in species]) for name in ("count", "radius"))
    law, q = scene.particles.mass, inertia_factor(scene.particles.inertia)
    mass, mean = mass_of(law, radius), float((count * radius).sum() / count.sum())
    low, high, least = float(radius.min()), float(radius.max()), float(mass.min())
    sizes = {"smallest": low, "mean radius": mean, "largest": high}
    return Grains(
        dimension=2, count=int(count.sum()), mean_mass=float((count * mass).sum() / count.sum()),
        total_mass=float((count * mass).sum()), largest_radius=high,
        pairs=tuple(Pair(name=n, reduced_mass=mass_of(law, a) / 2, reduced_radius=a / 2) for n, a in sizes.items()),
        inverse_mass=1 / least, inverse_turning=1 / (q * least),
        lightest=Pair(name="lightest", reduced_mass=least, reduced_radius=high),
        heaviest=Pair(name="heaviest", reduced_mass=float(mass.max()), reduced_radius=high),
        turning_share=_turning_share(low, high),
    )


def _box_grains(scene: Biaxial, count: int, low: float, high: float, moments: list, side: float | None) -> Grains:
    law, q = scene.particles.mass, inertia_factor(scene.particles.inertia)
    mean = mass_of(law, 1.0) * (moments[1] if isinstance(law, DiscMass) else moments[2])
    side = side or math.sqrt(count * math.pi * moments[1] / AREA_FRACTION)
    radii = {"smallest": low, "mean radius": moments[0], "largest": high}
    least = mass_of(law, low)
    return Grains(
        dimension=2, count=count, mean_mass=mean, total_mass=count * mean, largest_radius=high,
        pairs=tuple(Pair(name=n, reduced_mass=mass_of(law, a) / 2, reduced_radius=a / 2) for n, a in radii.items()),
        inverse_mass=1 / least, inverse_turning=1 / (q * least),
        lightest=Pair(name="lightest", reduced_mass=least, reduced_radius=high),
        heaviest=Pair(name="heaviest", reduced_mass=mass_of(law, high), reduced_radius=high),
        turning_share=_turning_share(low, high), side=side, per_wall=max(1.0, side / (2 * moments[0])),
    )


def _free_pairs(particles: Particles) -> tuple[Pair, ...]:
    """Pairs of the two lightest, of two mean and of the two heaviest particles."""
    order = np.lexsort((particles.radius, particles.mass))
    mass, radius = particles.mass[order], particles.radius[order]
    if len(mass) == 1:
        return (Pair(name="particle and wall", reduced_mass=float(mass[0]), reduced_radius=float(radius[0])),)
    if len(mass) == 2:
        return (_pair("only", mass, radius),)
    mean = Pair(name="mean mass", reduced_mass=float(mass.mean() / 2), reduced_radius=float(radius.mean() / 2))
    return (_pair("smallest", mass[:2], radius[:2]), mean, _pair("largest", mass[-2:], radius[-2:]))


def _with_materials(grains: Grains, scene: Free, particles: Particles) -> Grains:
    """Return them with the lightest pair of every two materials, and the particles of each material as a part."""
    p, words = particles, sorted(set(particles.material.tolist()))
    found = (_lightest_pair(p, a, b) for a, b in combinations_with_replacement(words, 2))
    pairs = [pair for pair in found if pair is not None]
    pairs += [_lightest_at_wall(p, a, b) for a in words for b in sorted({w.material or "" for w in scene.planes})]
    parts = []
    for word in words:
        mine = p.material == word
        inverse_mass, inverse_turning = (float(1.0 / m[mine].min()) for m in (p.mass, p.inertia_factor * p.mass))
        touched = tuple(pair for pair in pairs if word in pair.materials[: 1 if pair.at_wall else 2])
        parts.append(replace(grains, inverse_mass=inverse_mass, inverse_turning=inverse_turning, pairs=touched))
    return replace(grains, pairs=tuple(pairs), parts=tuple(parts))


def _lightest_pair(particles: Particles, one: str, other: str) -> Pair | None:
    """Return the pair of the lightest particles of two materials; None of a material of one particle with itself."""
    i, j = _lightest(particles, one), _lightest(particles, other)
    rows = i[:2] if one == other else np.array([i[0], j[0]])
    if len(rows) < 2:
        return None
    pair = _pair(f"{_said(one)}-{_said(other)}", particles.mass[rows], particles.radius[rows])
    return replace(pair, materials=(one, other))


def _lightest_at_wall(particles: Particles, word: str, wall: str) -> Pair:
    i = _lightest(particles, word)[0]
    return Pair(
        name=f"{_said(word)}-wall" + (f" of {wall}" if wall else ""), reduced_mass=float(particles.mass[i]),
        reduced_radius=float(particles.radius[i]), materials=(word, wall), at_wall=True,
    )


def _lightest(particles: Particles, word: str) -> np.ndarray:
    """Return the rows of the particles of a material, lightest first."""
    rows = np.flatnonzero(particles.material == word)
    return rows[np.argsort(particles.mass[rows], kind="stable")]


def _said(word: str) -> str:
    return word or "without material"


def _pair(name: str, mass: np.ndarray, radius: np.ndarray) -> Pair:
    """Return the pair of two particles; mass (2,) in kg, radius (2,) in m."""
    return Pair(
        name=name, reduced_mass=float(mass.prod() / mass.sum()), reduced_radius=float(radius.prod() / radius.sum())
    )


def _turning_share(low: float, high: float) -> float:
    return max(1.0, 2 * (high / (low + high)) ** 2)


def _touching_loaded_walls(scene: Free, particles: Particles) -> float:
    """Return the most particles that touch one loaded wall at the start, at least one."""
    most = 1
    for plane in scene.planes:
        if isinstance(plane.motion, LoadedMotion):
            height = (particles.x - plane.point) @ np.array(plane.normal) / np.linalg.norm(plane.normal)
            most = max(most, int((height <= particles.radius * (1 + 1e-6)).sum()))
    return float(most)


def _uniform_moment(low: float, high: float, n: int) -> float:
    """<a^n> of U(low, high): sum_k low^k high^(n-k) / (n+1), exact for low = high too."""
    return sum(low**k * high ** (n - k) for k in range(n + 1)) / (n + 1)
