"""What a combination of laws answers in any motion and frame, also where the normal turns: stepped row by row.

An independent evaluation of one contact, in the kinematics of the frame itself: it knows how a convention measures slip
and keeps springs on a turning contact (`reference.analytic.turning`), and so by how much its answer depends on the
frame. The force along the normal does not; it comes from the closed forms, and NaN where they do not determine it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from harness.scene.contact import ConstantRolling, MindlinSliding, ViscousSliding
from harness.studies.laws.closed_forms import Contact, limit_base, normal_force
from harness.studies.laws.motions import DT, Grains, Motion, Partner
from reference.analytic import prescribed
from reference.analytic.turning import TurningSlider
from reference.kernel.conventions import NAMED, Convention

if TYPE_CHECKING:
    from harness.studies.laws.arrangement import Arrangement, Track
    from harness.studies.laws.cases import Laws

CUT = {"lammps": "total", "lammps_twisting": "rate", "liggghts": "spring", "talk": "total"}
KEEP = {"lammps": "length", "lammps_twisting": "space", "liggghts": "projection", "talk": "length"}
"""What a convention's algorithms do, in the words of `reference.analytic.turning`."""


Answer = tuple[np.ndarray, np.ndarray]
"""Force and torque."""


@dataclass(frozen=True, kw_only=True)
class Seen:
    """Kinematics of one motion in C frames, rows 1..S, in the axes of space: what the laws see.

    normal, slip (v_t, m/s), spin (relative, rad/s): (S, C, 3). arms: of the torques on i and j, (S, 1).
    """

    contact: Contact
    normal: np.ndarray
    slip: np.ndarray
    spin: np.ndarray
    arms: tuple[np.ndarray, np.ndarray]

    @property
    def touching(self) -> np.ndarray:
        """Rows in which the bodies touch, (S,)."""
        return self.contact.overlap > 0.0

    def along(self, vectors: np.ndarray) -> np.ndarray:
        """Components along the normal, (S, C, 1)."""
        return (vectors * self.normal).sum(axis=-1, keepdims=True)

    def slider(self, algorithm: str, stiffness, damping, *, keep: str = "", remembers: bool = False) -> TurningSlider:
        """A spring and dashpot as the algorithm moves them."""
        return TurningSlider(
            stiffness=stiffness, damping=damping, dt=DT, cut=CUT[algorithm], keep=keep or KEEP[algorithm],
            lags=algorithm == "talk", remembers=remembers and algorithm != "liggghts",
        )

    def pushed(self, slider: TurningSlider, rate: np.ndarray, limit: np.ndarray, carried: np.ndarray) -> np.ndarray:
        """Answer of a slider to a rate (S, C, d)."""
        return slider.force(self.touching, self.normal, rate, limit, carried)


@dataclass(frozen=True, kw_only=True)
class Stepper:
    """The answers of one combination of laws, each found once."""

    laws: Laws
    _found: dict[tuple, dict[str, Answer]] = field(default_factory=dict)

    def answers(self, a: Arrangement, motion: str, convention: str) -> dict[str, Answer]:
        """Return force and torque, (S, bodies, 3) each in (n, t, b), by frame: the plain one and those that rotate."""
        asked = (a.partner, a.dimension, motion, convention)
        if asked not in self._found:
            tracks = [t for t in a.tracks_of(motion) if t.frame.rotation.any() or t.frame.name == "plain"]
            found = stepped(self.laws, tracks, a.partner, a.grains, NAMED[convention])
            self._found[asked] = {t.frame.name: answer for t, answer in zip(tracks, found, strict=True)}
        return self._found[asked]


def stepped(
    laws: Laws, tracks: Sequence[Track], partner: Partner, grains: Grains, convention: Convention
) -> list[Answer]:
    """Return force and torque of every track, (S, bodies, 3) each, in (n, t, b). tracks: of one motion."""
    seen = _seen(tracks, partner, grains, convention)
    total, elastic = (normal_force(laws.normal, seen.contact, damped=d) for d in (True, False))
    base, zero = limit_base(laws.normal, seen.contact, total), np.zeros_like(seen.normal)
    friction = zero if laws.sliding is None else _sliding(laws, seen, base, total)
    rolling = zero if laws.rolling is None else _rolling(laws.rolling, seen, base, elastic)
    torsion = zero if laws.torsion is None else _torsion(laws.torsion, seen, base)
    force, couple = total[:, None, None] * seen.normal + friction, rolling + torsion
    lever = np.cross(seen.normal, friction)
    torques = [sign * couple - arm[..., None] * lever for sign, arm in zip((1.0, -1.0), seen.arms, strict=True)]
    bodies = tracks[0].motion.x.shape[1]
    both = np.stack([force, -force][:bodies], axis=2), np.stack(torques[:bodies], axis=2)
    return [t.frame.back(both[0][:, k], both[1][:, k]) for k, t in enumerate(tracks)]


# --- kinematics ------------------------------------------------------------------------------------


def _seen(tracks: Sequence[Track], partner: Partner, grains: Grains, convention: Convention) -> Seen:
    motion, pair = tracks[0].motion, partner == "pair"
    x, v, w = (np.stack(parts, axis=1)[1:] for parts in zip(*(t.frame.embed(motion) for t in tracks), strict=True))
    contact = _contact(motion, partner, grains, convention)
    half = 0.5 * contact.overlap[:, None]
    shift = {"radius": 0.0 * half, "reduced": half}
    slip_arm = shift[convention.slip_arm if pair else convention.wall_slip_arm]
    torque_arm = shift[convention.torque_arm if pair else convention.wall_torque_arm]
    if pair:
        apart = x[:, :, 0] - x[:, :, 1]
        normal = apart / np.linalg.norm(apart, axis=-1, keepdims=True)
    else:
        normal = np.stack([t.frame.axes[1:, :, 0] for t in tracks], axis=1)
    arms = [(r - slip_arm)[..., None] for r in grains.radii]
    turning = sum(arms[k] * w[:, :, k] for k in range(x.shape[2]))
    across, spin = v[:, :, 0], w[:, :, 0]
    if pair:
        across, spin = across - v[:, :, 1], spin - w[:, :, 1]
    elif convention.wall_spin == "raised":
        spin = spin * ((grains.radii[0] - half) / (grains.radii[0] - 2.0 * half))[..., None]
    slip = across - (across * normal).sum(axis=-1, keepdims=True) * normal - np.cross(turning, normal)
    return Seen(contact=contact, normal=normal, slip=slip, spin=spin, arms=tuple(r - torque_arm for r in grains.radii))


def _contact(motion: Motion, partner: Partner, grains: Grains, convention: Convention) -> Contact:
    """What the normal laws see, in the contact's own axes, where the numbers of legs carry no rounding."""
    x, v = motion.x[1:], motion.v[1:]
    if partner == "pair":
        apart = x[:, 0] - x[:, 1]
        size = np.linalg.norm(apart, axis=1)
        overlap = sum(grains.radii) - size
        separation = ((v[:, 0] - v[:, 1]) * apart).sum(axis=1) / size
    else:
        overlap, separation = grains.radii[0] - x[:, 0, 0], v[:, 0, 0]
    none = np.zeros(len(x))
    return Contact(
        convention=convention, reduced_radius=grains.reduced_radius(partner), reduced_mass=grains.reduced_mass(partner),
        overlap=overlap, separation=separation, slip=none, roll=none, twist=none, torque_arms=(none, none),
    )


# --- along and about the contact -------------------------------------------------------------------


def _sliding(laws: Laws, seen: Seen, base: np.ndarray, total: np.ndarray) -> np.ndarray:
    law, c = laws.sliding, seen.contact
    if isinstance(law, ViscousSliding):
        limit = law.shear_friction * (np.abs(total) if c.convention.viscous_limit == "total" else base)
        return _drag(seen, law.shear_damping, limit)
    algorithm, limit = c.convention.sliding, law.shear_friction * base
    if isinstance(law, MindlinSliding):
        stiffness = np.where(seen.touching, c.elastic(laws.normal).shear_stiffness(c.overlap), 1.0)
        damping = prescribed.constant_restitution_damping(
            stiffness, restitution=laws.normal.restitution, reduced_mass=c.reduced_mass
        )
        return seen.pushed(seen.slider(algorithm, stiffness, damping), seen.slip, limit, limit)
    dynamic = law.dynamic_friction is not None
    carried = law.dynamic_friction * base if dynamic else limit
    slider = seen.slider(algorithm, law.shear_stiffness, law.shear_damping, remembers=dynamic)
    return seen.pushed(slider, seen.slip, limit, carried)


def _drag(seen: Seen, damping: float, limit: np.ndarray) -> np.ndarray:
    """-min(gamma |v|, limit) v/|v|."""
    drag = damping * np.linalg.norm(seen.slip, axis=-1, keepdims=True)
    bound = np.broadcast_to(limit[:, None, None], drag.shape)
    cut = np.divide(bound, drag, out=np.ones_like(drag), where=drag > bound)
    return -damping * cut * seen.slip * seen.touching[:, None, None]


def _rolling(law, seen: Seen, base: np.ndarray, elastic: np.ndarray) -> np.ndarray:
    radius, across = seen.contact.reduced_radius, seen.spin - seen.along(seen.spin) * seen.normal
    if isinstance(law, ConstantRolling):
        whole = seen.contact.convention.constant_rolling == "liggghts"
        size = np.linalg.norm(seen.spin if whole else across, axis=-1, keepdims=True)
        unit = np.divide(across, size, out=np.zeros_like(across), where=size > 0.0)
        return -law.rolling_friction * radius * elastic[:, None, None] * unit
    algorithm, limit = seen.contact.convention.rolling, law.rolling_friction * base
    in_space = seen.contact.convention.rolling_frame == "space"
    slider = seen.slider(algorithm, law.rolling_stiffness, law.rolling_damping, keep="space" if in_space else "")
    if in_space:
        return radius * seen.pushed(slider, radius * across, limit, limit)
    return radius * np.cross(seen.normal, seen.pushed(slider, radius * np.cross(seen.spin, seen.normal), limit, limit))


def _torsion(law, seen: Seen, base: np.ndarray) -> np.ndarray:
    radius, limit = seen.contact.reduced_radius, law.torsion_friction * base
    slider = seen.slider(
        seen.contact.convention.torsion, law.torsion_stiffness, law.torsion_damping, keep="space"
    )
    return radius * seen.pushed(slider, radius * seen.along(seen.spin), limit, limit) * seen.normal
