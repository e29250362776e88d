"""The Couette ring: two circles of glued discs, the discs between them, and what both mean as a system.

After M. Laetzel, S. Luding and H. J. Herrmann, Granular Matter 2, 123 (2000). The glued discs sit with their centres on
R_i and R_o and touch one another. Two area fractions are in use and both are reported: that of the bare annulus
R_i < r < R_o, and that of the free one, R_i + a_g < r < R_o - a_g (a_g: radius of a glued disc), from 1 to 2 % smaller.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Protocol

import numpy as np

from harness.scene.contact import LinearNormal
from harness.scene.fault import Fault
from harness.scene.grains import inertia_factor, mass_of
from harness.scene.laws import word
from harness.scene.model import Couette, Rings
from harness.scene.system import Particles, Ring

DENSEST = 0.9
"""Area fraction of the free annulus: a triangular lattice of equal discs has 0.907."""

PICOMETRE = 12
"""Decimals to which glued discs are placed: the last bits of sine and cosine differ between machines."""

MOST_DISCS = 1_000_000
"""Between the rings, and on each of them: more is a slip."""

NARROWEST = 4.0
"""Least gap between the rings in diameters of the largest disc."""


class FlowingDiscs(Protocol):
    """A state of the preparation about the rings' centre: x, v (N, 2) in m, m/s; spin (N,), rad/s; radius (N,), m."""

    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    radius: np.ndarray


def radii(scene: Couette) -> np.ndarray:
    """Radius of every disc, species after species, (N,), m."""
    return np.concatenate([np.full(s.count, s.radius) for s in scene.particles.species])


def free_bounds(rings: Rings) -> tuple[float, float]:
    """Radii between which no glued disc reaches: R_i + a_g and R_o - a_g, m."""
    return rings.inner_radius + rings.grain_radius, rings.outer_radius - rings.grain_radius


def area_fractions(scene: Couette) -> dict[str, float]:
    """Area of the discs over that of the bare and of the free annulus."""
    discs = float((radii(scene) ** 2).sum())
    bounds = {"bare": (scene.rings.inner_radius, scene.rings.outer_radius), "free": free_bounds(scene.rings)}
    return {name: discs / (outer**2 - inner**2) for name, (inner, outer) in bounds.items()}


def glued_discs(circle: float, radius: float) -> np.ndarray:
    """Centres (M, 2) of discs of this radius on a circle about the origin, as many as fit side by side, m."""
    count = max(3, round(math.pi * circle / radius))
    angle = 2.0 * np.pi * np.arange(count) / count
    return np.round(circle * np.column_stack([np.cos(angle), np.sin(angle)]), PICOMETRE)


def rings_of(scene: Couette) -> tuple[Ring, Ring]:
    """Return the inner ring, which turns, and the outer one, which rests; both about the origin."""
    r = scene.rings
    inner, outer = (glued_discs(circle, r.grain_radius) for circle in (r.inner_radius, r.outer_radius))
    return (
        Ring(
            index=1, name="inner", centre=(0.0, 0.0), circle=r.inner_radius, x=inner,
            radius=np.full(len(inner), r.grain_radius), omega=r.omega,
        ),
        Ring(
            index=2, name="outer", centre=(0.0, 0.0), circle=r.outer_radius, x=outer,
            radius=np.full(len(outer), r.grain_radius),
        ),
    )


def flowing_discs(scene: Couette, state: FlowingDiscs) -> Particles:
    """Return the particles that a run starts with."""
    q = inertia_factor(scene.particles.inertia)
    return Particles(
        x=np.asarray(state.x, float), radius=state.radius, mass=mass_of(scene.particles.mass, state.radius),
        inertia_factor=np.full(len(state.radius), q), v=np.asarray(state.v, float),
        spin=np.asarray(state.spin, float)[:, None],
    )


# --- checks ----------------------------------------------------------------------------------


def few_enough(scene: Couette) -> Iterator[Fault]:
    """As many discs as a box may have, and no more glued ones than those."""
    count, r = sum(s.count for s in scene.particles.species), scene.rings
    if count > MOST_DISCS:
        yield Fault(place="particles.species", expected=f"at most {MOST_DISCS} discs in all", got=str(count))
    if math.pi * max(r.outer_radius, r.inner_radius) > MOST_DISCS * r.grain_radius:
        yield Fault(
            place="rings.grain_radius", got=f"{r.grain_radius:g}", fix="take larger ones",
            expected=f"a radius of which at most {MOST_DISCS} discs fit on a ring",
        )


def rings_leave_room(scene: Couette) -> Iterator[Fault]:
    """The gap holds a few discs, and the circles are larger than what is glued on them."""
    r, largest = scene.rings, float(radii(scene).max())
    inner, outer = free_bounds(r)
    least = inner + NARROWEST * 2 * largest
    if r.inner_radius < 2 * r.grain_radius:
        yield Fault(
            place="rings.grain_radius", expected=f"at most half of rings.inner_radius = {r.inner_radius:g}",
            got=f"{r.grain_radius:g}",
        )
    elif outer < least:
        yield Fault(
            place="rings.outer_radius", expected=f"at least {least + r.grain_radius:.4g}, which leaves room for "
            f"{NARROWEST:.0f} of the largest discs side by side", got=f"{r.outer_radius:g}",
        )


def discs_fit(scene: Couette) -> Iterator[Fault]:
    """Discs denser than a crystal have no place; what grows must be sparse at first."""
    nu, start = area_fractions(scene)["free"], scene.preparation.start_size
    if nu > DENSEST:
        yield Fault(
            place="particles.species", expected=f"discs that fill at most {DENSEST:g} of the free annulus",
            got=f"{nu:.4g}", fix="take fewer discs or a wider ring",
        )
    elif nu * start**2 > 0.4:
        yield Fault(
            place="preparation.start_size", expected=f"at most {math.sqrt(0.4 / nu):.2g}, so that discs find places "
            "at random", got=f"{start:g}",
        )


def ring_turns(scene: Couette) -> Iterator[Fault]:
    """A ring at rest drives nothing."""
    if scene.rings.omega == 0:
        yield Fault(place="rings.omega", expected="a rate that is not 0", got="0", fix="else nothing flows")


def ring_contacts_are_linear(scene: Couette) -> Iterator[Fault]:
    """Growth and glued discs are built and proven with the linear law."""
    law = scene.contact.normal
    if not isinstance(law, LinearNormal):
        yield Fault(place="contact.normal.law", expected='"linear" in a ring', got=f'"{word(law)}"')


def ring_times_in_order(scene: Couette) -> Iterator[Fault]:
    """Averages begin before the run ends, on at least two frames; windows end before it."""
    spacing = scene.duration / scene.outputs.frames
    latest = scene.duration - spacing
    if scene.compare.steady_from > latest * (1 + 1e-12):
        yield Fault(
            place="compare.steady_from", got=f"{scene.compare.steady_from:g}",
            expected=f"at most {latest:g}, so that two frames are left to average over",
        )
    for i, window in enumerate(scene.compare.windows):
        if window.time > scene.duration:
            yield Fault(
                place=f"compare.windows[{i}].time", got=f"{window.time:g}",
                expected=f"a number <= duration = {scene.duration:g}",
            )


def band_within_gap(scene: Couette) -> Iterator[Fault]:
    """The fitted band spans several cells and ends before the outer ring."""
    gap = scene.rings.outer_radius - scene.rings.inner_radius
    least = 4 * gap / scene.compare.cells
    if not least <= scene.compare.band <= gap:
        yield Fault(
            place="compare.band", expected=f"a width from four cells to the gap, {least:.4g} to {gap:.4g}",
            got=f"{scene.compare.band:g}",
        )


OF_RINGS = (
    ring_contacts_are_linear, few_enough, rings_leave_room, discs_fit, ring_turns, ring_times_in_order, band_within_gap,
)
"""The checks, in the order in which faults are reported."""

