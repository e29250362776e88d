"""The same motion seen otherwise: turned, mirrored, in translation, in rotation. The laws must not care.

A frame gives the axes (n, t, b) of the contact as it moves; in a rotating one each row's velocities are those of
the rotation at that very row, so that slip and rate of separation are exactly the plain frame's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.studies.laws.motions import DT, ROWS, Motion, Partner

TILT = 0.6
"""Angle (rad) between the level plane and the tilted one."""

TOTAL_TURN = 1.0
"""Angle (rad) that a rotating pair turns in all."""

DRIFT = (1.5, 1.0, -0.75)
"""Velocity of a pair in translation, m/s."""


@dataclass(frozen=True, kw_only=True)
class Frame:
    """axes: (S + 1, 3, 3), columns n, t, b. rotation, drift: (3,), rad/s and m/s. swapped: j has the lower id."""

    name: str
    axes: np.ndarray
    rotation: np.ndarray
    drift: np.ndarray
    swapped: bool = False

    @property
    def handedness(self) -> float:
        """-1 for a mirror image, in which spins and torques change sign."""
        return float(np.sign(np.linalg.det(self.axes[0])))

    def embed(self, motion: Motion) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return x, v, spin of the motion's bodies, each (S + 1, bodies, 3), about the contact's origin."""
        x = _turned(self.axes, motion.x)
        v = _turned(self.axes, motion.v) + np.cross(self.rotation, x) + self.drift
        x += (np.arange(ROWS + 1) * DT)[:, None, None] * self.drift
        spin = self.handedness * _turned(self.axes, motion.spin) + self.rotation
        return x, v, spin

    def back(self, force: np.ndarray, torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return force and torque of rows 1..S, (S, bodies, 3), in the axes (n, t, b)."""
        inverse = np.swapaxes(self.axes[1:], 1, 2)
        return _turned(inverse, force), self.handedness * _turned(inverse, torque)


def frames(partner: Partner, dimension: int) -> tuple[Frame, ...]:
    """Return the frames in which a contact of this kind is looked at; the first is the plain one."""
    return _of_pair(dimension) if partner == "pair" else _at_plane(dimension)


def _of_pair(dimension: int) -> tuple[Frame, ...]:
    made = [
        _frame("plain", np.eye(3)),
        _frame("turned", _about(2, 0.7) if dimension == 2 else _about(0, 1.9) @ _about(1, -0.8) @ _about(2, 0.7)),
        _frame("drifting", np.eye(3), drift=np.array([1.0, 1.0, float(dimension == 3)]) * DRIFT),
        _frame("mirrored", np.diag([-1.0, 1.0, 1.0])),
        _frame("relabelled", np.eye(3), swapped=True),
        _rotating("turning", 2),
    ]
    return tuple(made) if dimension == 2 else (*made, _rotating("tumbling", 1))


def _at_plane(dimension: int) -> tuple[Frame, ...]:
    up = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    made = [
        _frame("plain", up),
        _frame("mirrored", np.diag([-1.0, 1.0, 1.0]) @ up),
        _frame("tilted", _about(2, TILT) @ up),
    ]
    return tuple(made) if dimension == 2 else (*made, _frame("turned", _about(1, 0.7) @ up))


def _frame(name: str, axes: np.ndarray, *, drift: np.ndarray | None = None, swapped: bool = False) -> Frame:
    every = np.broadcast_to(axes, (ROWS + 1, 3, 3))
    still = np.zeros(3)
    return Frame(name=name, axes=every, rotation=still, drift=still if drift is None else drift, swapped=swapped)


def _rotating(name: str, axis: int) -> Frame:
    """Rigid rotation at a constant rate about an axis of the plain frame."""
    angles = np.linspace(0.0, TOTAL_TURN, ROWS + 1)
    rotation = TOTAL_TURN / (ROWS * DT) * np.eye(3)[axis]
    return Frame(
        name=name, axes=np.array([_about(axis, a) for a in angles]), rotation=rotation, drift=np.zeros(3)
    )


def _about(axis: int, angle: float) -> np.ndarray:
    """Right-handed rotation about x, y or z, (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    after, before = (axis + 1) % 3, (axis + 2) % 3
    turned = np.eye(3)
    turned[after, after] = turned[before, before] = c
    turned[before, after], turned[after, before] = s, -s
    return turned



def _turned(axes: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Apply the matrix of each row to the vectors of that row, (S, bodies, 3)."""
    return np.einsum("kab,kpb->kpa", axes, vectors)
