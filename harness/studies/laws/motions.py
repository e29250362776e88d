"""How two bodies are driven past each other: motions in the contact's own axes.

Axes are (n, t, b): n from body j to body i, or off a plane; t along the contact; b = n x t. All motions but `mixed`
are legs of constant velocity whose numbers are binary fractions, so that overlaps, slips and velocities of the plain
frame carry no rounding at all and closed forms hold to the last digits. Overlaps are odd multiples of half a unit:
none is zero, where rounding would decide whether the bodies touch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

Partner = Literal["pair", "plane"]
"""Two bodies, i and j, or one body and a plane at rest."""


@dataclass(frozen=True, kw_only=True)
class Grains:
    """Radii (m) and masses (kg) of bodies i and j; a body at a plane is as body i."""

    radii: tuple[float, float]
    masses: tuple[float, float]

    def reduced_radius(self, partner: Partner) -> float:
        """R_i R_j/(R_i + R_j), R_i at a plane."""
        r_i, r_j = self.radii
        return r_i * r_j / (r_i + r_j) if partner == "pair" else r_i

    def reduced_mass(self, partner: Partner) -> float:
        """m_i m_j/(m_i + m_j), m_i at a plane."""
        m_i, m_j = self.masses
        return m_i * m_j / (m_i + m_j) if partner == "pair" else m_i


UNEQUAL = Grains(radii=(2.0**-10, 1.25 * 2.0**-10), masses=(2.0**-14, 1.75 * 2.0**-14))
EQUAL_RADII = Grains(radii=(2.0**-10, 2.0**-10), masses=(2.0**-14, 1.75 * 2.0**-14))
"""For laws that a code can only be told for one reduced radius of all its particles."""

DT = 2.0**-20
"""Seconds between rows."""

UNIT = 2.0**-20
"""Unit of overlaps, m: about a thousandth of a radius, and 1 m/s times DT."""

SHARE = 0.75
"""Part of a relative motion that body i makes; j makes the rest."""

GAP, DEEP = -8.5, 31.5
"""Overlaps (units) at which bodies are apart, and at which they shear, roll and twist."""


@dataclass(frozen=True, kw_only=True)
class Leg:
    """`rows` rows of constant rates: overlap in units a row; slip, roll, twist in m/s (see `_Track`)."""

    rows: int
    overlap: float = 0.0
    slip: float = 0.0
    roll: float = 0.0
    twist: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Course:
    """What the contact laws see of a motion with a fixed normal, of rows 0..S, for closed forms.

    overlap (m), separation (its rate, m/s, positive when bodies part), slip (v_t along t of i against j, m/s),
    roll (v_r along t, m/s), twist (v_o, m/s).
    """

    overlap: np.ndarray
    separation: np.ndarray
    slip: np.ndarray
    roll: np.ndarray
    twist: np.ndarray


@dataclass(frozen=True, kw_only=True)
class Motion:
    """Bodies' places, velocities, spins in (n, t, b): (S + 1, bodies, 3); `course` if the normal is fixed."""

    name: str
    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    course: Course | None


LOAD = (
    Leg(rows=56, overlap=1), Leg(rows=24, overlap=-1), Leg(rows=20, overlap=2), Leg(rows=6), Leg(rows=36, overlap=-2),
    Leg(rows=4), Leg(rows=48, overlap=1), Leg(rows=24, overlap=-1), Leg(rows=16, overlap=1), Leg(rows=24, overlap=-1),
    Leg(rows=16, overlap=1), Leg(rows=32, overlap=-1),
)
"""Loading, unloading, reloading further, opening; a second contact with small cycles, and opening again."""

TO_DEPTH, APART = Leg(rows=40, overlap=1), Leg(rows=20, overlap=-2)


def _there_and_back(word: str, speed: float) -> tuple[Leg, ...]:
    """At one depth beyond the limit, back beyond it, within it, a rest; then apart, and once more shortly."""
    def leg(rows: int, sign: float) -> Leg:
        return Leg(rows=rows, **{word: sign * speed})

    return (
        TO_DEPTH, leg(60, 1), leg(90, -1), leg(20, 1), Leg(rows=6), leg(30, 0.5), leg(10, -1), APART,
        Leg(rows=20, overlap=2), leg(14, -1), APART,
    )


SHEAR, ROLL, TWIST = (_there_and_back(w, s) for w, s in (("slip", 1.125), ("roll", 1.0), ("twist", 1.0)))

LOAD_SHEAR = (
    Leg(rows=48, overlap=1, slip=0.5), Leg(rows=20, overlap=0.5, slip=-1.125), Leg(rows=30, overlap=-1, slip=-0.5),
    Leg(rows=30, overlap=1, slip=1.125), Leg(rows=40, overlap=0.25, slip=1.125),
    Leg(rows=50, overlap=-0.5, slip=-1.125),
    Leg(rows=25, overlap=-2, slip=0.25), Leg(rows=30, overlap=1.5, slip=-1.0), Leg(rows=40, overlap=-1.5, slip=0.75),
)
"""Oblique loading and unloading: slip while the limit grows, slip while it shrinks, opening while sliding."""

SEQUENCES = {"load": LOAD, "shear": SHEAR, "load_shear": LOAD_SHEAR, "roll": ROLL, "twist": TWIST}
ROWS = max(sum(leg.rows for leg in legs) for legs in SEQUENCES.values())
"""S: rows of every motion; what ends earlier waits apart."""


def motions(partner: Partner, dimension: int, grains: Grains) -> tuple[Motion, ...]:
    """Return all motions that a contact can make in 2D (no twist) or 3D."""
    names = [name for name in SEQUENCES if dimension == 3 or name != "twist"]
    made = [_of_legs(name, SEQUENCES[name], partner, grains) for name in names]
    return (*made, _mixed(partner, dimension, grains))


# --- legs ------------------------------------------------------------------------------------------


def _of_legs(name: str, legs: tuple[Leg, ...], partner: Partner, grains: Grains) -> Motion:
    rates = {word: _rates(legs, word) for word in ("overlap", "slip", "roll", "twist")}
    overlap = UNIT * (GAP + np.cumsum(rates["overlap"]))
    course = Course(
        overlap=overlap, separation=-UNIT / DT * rates["overlap"], slip=rates["slip"], roll=rates["roll"],
        twist=rates["twist"],
    )
    place = _pair if partner == "pair" else _at_plane
    return Motion(name=name, **place(course, grains), course=course)


def _rates(legs: tuple[Leg, ...], word: str) -> np.ndarray:
    """Rates of rows 0..S; row 0 and the rows after the last leg have none."""
    rates = np.zeros(ROWS + 1)
    ends = np.cumsum([leg.rows for leg in legs])
    for leg, end in zip(legs, ends, strict=True):
        rates[end - leg.rows + 1 : end + 1] = getattr(leg, word)
    return rates


def _pair(course: Course, grains: Grains) -> dict[str, np.ndarray]:
    """Places of i and j on the n axis; slip by equal spins, roll by opposite ones, so that neither brings the other.

    Slip v_t = v_ij - (R_i w_i + R_j w_j) x n: spins w b slip by -(R_i + R_j) w along t. Rolling without slip needs
    R_i w_i = -R_j w_j, and v_r = -a* n x (w_i - w_j) b = R_i w_i along t. Twisting: v_o = a* (w_i - w_j).
    """
    (r_i, r_j), reduced, zero = grains.radii, grains.reduced_radius("pair"), np.zeros(ROWS + 1)
    apart, parting = r_i + r_j - course.overlap, course.separation
    slip, roll = -course.slip / (r_i + r_j), course.roll / r_i
    twist = course.twist / (1.5 * reduced)
    x = _bodies((SHARE * apart, zero, zero), ((SHARE - 1.0) * apart, zero, zero))
    v = _bodies((SHARE * parting, zero, zero), ((SHARE - 1.0) * parting, zero, zero))
    spin = _bodies((twist, zero, slip + roll), (-0.5 * twist, zero, slip - roll * (r_i / r_j)))
    return {"x": x, "v": v, "spin": spin}


def _at_plane(course: Course, grains: Grains) -> dict[str, np.ndarray]:
    """A body above the plane n = 0: it slips as it moves along t, and rolls without slip with w = v_t/R."""
    radius, zero = grains.radii[0], np.zeros(ROWS + 1)
    along = course.slip + course.roll
    x = _bodies((radius - course.overlap, DT * np.cumsum(along), zero))
    v = _bodies((course.separation, along, zero))
    spin = _bodies((course.twist / radius, zero, course.roll / radius))
    return {"x": x, "v": v, "spin": spin}


def _bodies(*components: tuple[np.ndarray, np.ndarray, np.ndarray]) -> np.ndarray:
    """Return (S + 1, bodies, 3) from the (n, t, b) components of each body."""
    return np.stack([np.stack(of, axis=-1) for of in components], axis=1)


# --- everything at once ----------------------------------------------------------------------------


def _mixed(partner: Partner, dimension: int, grains: Grains) -> Motion:
    """Smooth sums of sines in all components; velocities are those of the half step before each row."""
    place = _mixed_pair if partner == "pair" else _mixed_at_plane
    out_of_plane = float(dimension == 3)
    x, v, spin = place(np.arange(ROWS + 1) * DT, out_of_plane, grains)
    spin[..., :2] *= out_of_plane
    return Motion(name="mixed", x=x, v=v, spin=spin, course=None)


def _mixed_pair(
    time: np.ndarray, out_of_plane: float, grains: Grains
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    def branch(t: np.ndarray) -> np.ndarray:
        turn, tilt = _sines(t, 0.02, (1.3, 3.1), 0.4), out_of_plane * _sines(t, 0.015, (1.7, 2.3), 1.1)
        length = sum(grains.radii) - _mixed_overlap(t)
        return length[:, None] * np.stack([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)], -1)

    def both(t: np.ndarray) -> np.ndarray:
        shift = [_sines(t, 5e-5, (1.1, 2.7), phase) for phase in (0.3, 1.9, 4.0)]
        middle = np.stack([*shift[:2], out_of_plane * shift[2]], axis=-1)
        return np.stack([middle + SHARE * branch(t), middle + (SHARE - 1.0) * branch(t)], axis=1)

    return both(time), _half_step_rate(both, time), _mixed_spins(time, bodies=2)


def _mixed_at_plane(
    time: np.ndarray, out_of_plane: float, grains: Grains
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    def body(t: np.ndarray) -> np.ndarray:
        along = [_sines(t, 4e-5, (1.2, 3.4), phase) for phase in (0.7, 2.2)]
        return np.stack([grains.radii[0] - _mixed_overlap(t), along[0], out_of_plane * along[1]], axis=-1)[:, None]

    return body(time), _half_step_rate(body, time), _mixed_spins(time, bodies=1)


def _mixed_overlap(time: np.ndarray) -> np.ndarray:
    """Apart at first and at last, two contacts with ripples, no row with an overlap between 0 and one unit.

    Square roots of the overlap would there amplify the rounding of coordinates, whatever the code.
    """
    return UNIT * (20.0 - 31.5 * np.cos(2.0 * _phase(time)) + 6.0 * np.sin(7.3 * _phase(time) + 3.6))


def _mixed_spins(time: np.ndarray, *, bodies: int) -> np.ndarray:
    sizes, phases = (260.0, 310.0, 420.0), np.linspace(0.2, 5.0, 3 * bodies)
    waves = [_sines(time, sizes[k % 3], (2.1 + 0.3 * k, 4.7), phase) for k, phase in enumerate(phases)]
    return np.stack(waves, axis=-1).reshape(len(time), bodies, 3)


def _sines(time: np.ndarray, size: float, waves: tuple[float, float], phase: float) -> np.ndarray:
    slow, fast = (np.sin(k * _phase(time) + phase) for k in waves)
    return size * (slow + 0.4 * fast)


def _phase(time: np.ndarray) -> np.ndarray:
    return 2.0 * np.pi * time / (ROWS * DT)


def _half_step_rate(path: Callable[[np.ndarray], np.ndarray], time: np.ndarray) -> np.ndarray:
    """Mean velocity of the step that ends at each time, as leapfrog codes have it."""
    return (path(time) - path(time - DT)) / DT
