"""Balls on a floor under gravity: rigid bounces, the bounce on a spring and dashpot, two balls in a gap.

Heights are those of the centre above the floor (m, upwards positive).

`BouncingBall`: rigid, restitution e at any speed. With H = h0 - R, T = sqrt(2 H/g) and v = sqrt(2 g H) it
strikes for the k-th time (k = 1, 2, ...) at T (1 + 2 (e + ... + e^(k-1))) with speed v e^(k-1), rises to
R + H e^(2k), and is at rest after T (1 + e)/(1 - e).

`DroppedBall`: fall, contact, flight. In contact, with d the overlap, b = gamma/(2 m), w0^2 = k/m,
w^2 = w0^2 - b^2 and d_s = m g/k::

    m d'' = -k d - gamma d' + m g,    d = d_s + exp(-b t) (-d_s cos(w t) + (v - b d_s)/w sin(w t))

until d = 0 again (attraction allowed), the only step that is not closed: one root between the largest
overlap and the first minimum. Gravity in the contact makes e depend on the speed.

`BallsInGap`: two balls, one above the other, between floor and ceiling, all three contacts closed. Linear:
z' = A z around the equilibrium, z = (y1, y2, y1', y2'), solved by the eigenvectors of A.

Sources: elementary mechanics; the cases DEM01 (dropped ball), DEM02 (bounces) and DEM03 (gap) of the MFiX
verification manual. The tests integrate the equations of motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reference.analytic.linear_collision import LinearCollision


@dataclass(frozen=True, kw_only=True)
class BouncingBall:
    """A rigid ball dropped at rest: height h0 of its centre (m) >= radius R (m), 0 <= e < 1, g > 0 (m/s^2).

    >>> ball = BouncingBall(height=0.5, radius=0.1, restitution=0.9, gravity=9.81)
    >>> [round(ball.peak(k), 6) for k in (0, 1, 2)]
    [0.5, 0.424, 0.36244]
    """

    height: float
    radius: float
    restitution: float
    gravity: float

    @property
    def first_strike(self) -> float:
        """T = sqrt(2 H/g), s."""
        return math.sqrt(2 * (self.height - self.radius) / self.gravity)

    @property
    def time_to_rest(self) -> float:
        """Time after which the infinitely many bounces are over, s: T (1 + e)/(1 - e)."""
        return self.first_strike * (1 + self.restitution) / (1 - self.restitution)

    def peak(self, bounces: int) -> float:
        """Height of the centre at the top of the flight after so many bounces, m."""
        return self.radius + (self.height - self.radius) * self.restitution ** (2 * bounces)

    def strike(self, bounce: int) -> float:
        """Time of the k-th strike, k = 1, 2, ..., s: T (1 + 2 (e - e^k)/(1 - e))."""
        e = self.restitution
        return self.first_strike * (1 + 2 * (e - e**bounce) / (1 - e))

    def strike_speed(self, bounce: int) -> float:
        """Speed just before the k-th strike, k = 1, 2, ..., m/s."""
        return self.gravity * self.first_strike * self.restitution ** (bounce - 1)


@dataclass(frozen=True, kw_only=True)
class DroppedBall:
    """A ball dropped at rest on a floor that is a spring and a dashpot; attraction allowed.

    height h0 of its centre (m) > radius R (m); `contact`: stiffness, damping, and the ball's mass as the
    reduced mass, less than critically damped; gravity g (m/s^2) > 0.

    Raises ValueError if the contact is critically or more damped, or the ball starts in contact.

    >>> floor = LinearCollision(stiffness=5e4, damping=0.0, reduced_mass=10.89)
    >>> ball = DroppedBall(height=0.5, radius=0.1, contact=floor, gravity=9.81)
    >>> round(ball.largest_overlap, 5), round(ball.restitution, 12)
    (0.04354, 1.0)
    """

    height: float
    radius: float
    contact: LinearCollision
    gravity: float

    def __post_init__(self) -> None:
        if self.contact.overdamped:
            raise ValueError(f"expected a damping ratio below 1, got {self.contact.damping_ratio:g}")
        if self.height <= self.radius:
            raise ValueError(f"expected height > radius, got {self.height!r} and {self.radius!r}")

    @property
    def touch_time(self) -> float:
        """Time of the fall to the floor, s."""
        return math.sqrt(2 * (self.height - self.radius) / self.gravity)

    @property
    def touch_speed(self) -> float:
        """Approach speed at first touch, m/s."""
        return self.gravity * self.touch_time

    def contact_motion(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Overlap (m) and its rate (m/s) at `time` (s, any shape) after first touch, while the contact lasts."""
        time = np.asarray(time, dtype=float)
        b, w, v = self.contact.decay_rate, self.contact.frequency, self.touch_speed
        rest = self.resting_overlap
        decay, cos, sin = np.exp(-b * time), np.cos(w * time), np.sin(w * time)
        overlap = rest + decay * ((v - b * rest) / w * sin - rest * cos)
        return overlap, decay * (v * cos + (self.gravity - b * v) / w * sin)

    @property
    def resting_overlap(self) -> float:
        """d_s = m g/k, m: overlap of the ball at rest on the floor."""
        return self.contact.reduced_mass * self.gravity / self.contact.stiffness

    @property
    def time_of_maximum(self) -> float:
        """Time from first touch to the largest overlap, s: the first root of tan(w t) = w v/(b v - g)."""
        b, w, v = self.contact.decay_rate, self.contact.frequency, self.touch_speed
        return math.atan2(w * v, b * v - self.gravity) / w

    @property
    def largest_overlap(self) -> float:
        """Overlap at `time_of_maximum`, m."""
        return float(self.contact_motion(self.time_of_maximum)[0])

    @cached_property
    def duration(self) -> float:
        """Time from first touch until d = 0 again, s; infinite if the ball comes to rest on the floor."""
        from scipy.optimize import brentq

        top = self.time_of_maximum
        bottom = top + math.pi / self.contact.frequency
        if self.contact_motion(bottom)[0] >= 0:
            return math.inf
        return brentq(lambda t: self.contact_motion(t)[0], top, bottom, xtol=1e-15 * bottom, rtol=1e-15)

    @property
    def rebound_speed(self) -> float:
        """Speed upwards at the end of the contact, m/s; 0 if it has none."""
        return 0.0 if math.isinf(self.duration) else -float(self.contact_motion(self.duration)[1])

    @property
    def restitution(self) -> float:
        """Rebound speed / touch speed."""
        return self.rebound_speed / self.touch_speed

    @property
    def rebound_height(self) -> float:
        """Height of the centre at the top of the first flight, m."""
        return self.radius + self.rebound_speed**2 / (2 * self.gravity)

    def motion(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Height of the centre (m) and its velocity (m/s, upwards) at `time` >= 0 (s, any shape).

        Fall, contact and first flight. Raises ValueError for a time beyond the second touch.
        """
        time = np.asarray(time, dtype=float)
        contact, flight = time - self.touch_time, time - self.touch_time - self.duration
        if np.any(flight > 2 * self.rebound_speed / self.gravity):
            raise ValueError("the motion is known up to the second touch only")
        overlap, rate = self.contact_motion(np.maximum(contact, 0))
        up = np.maximum(flight, 0)
        stages = [contact < 0, flight <= 0]
        height = np.select(
            stages, [self.height - 0.5 * self.gravity * time**2, self.radius - overlap],
            self.radius + self.rebound_speed * up - 0.5 * self.gravity * up**2,
        )
        return height, np.select(stages, [-self.gravity * time, -rate], self.rebound_speed - self.gravity * up)


@dataclass(frozen=True, kw_only=True)
class BallsInGap:
    """Two balls in a gap between floor (y = 0) and ceiling (y = gap), pressed together, lower ball first.

    gap (m); radius, mass: of the two balls (m, kg); stiffness (N/m), damping (kg/s): of the contacts floor,
    between the balls, ceiling; gravity g (m/s^2). Valid while all three overlaps are positive.

    >>> balls = BallsInGap(gap=1.8e-3, radius=(5e-4, 5e-4), mass=(1.047e-5, 5.236e-6), stiffness=(1e3, 1e3, 1e3),
    ...                    damping=(0.0, 0.0, 0.0), gravity=9.81)
    >>> [round(1e3 * float(y), 4) for y in balls.equilibrium]
    [0.4332, 1.3666]
    """

    gap: float
    radius: tuple[float, float]
    mass: tuple[float, float]
    stiffness: tuple[float, float, float]
    damping: tuple[float, float, float]
    gravity: float

    def overlaps(self, height: np.ndarray) -> np.ndarray:
        """Overlaps (..., 3), m, at floor, between the balls and at the ceiling, of centres at `height` (..., 2), m."""
        height = np.asarray(height, dtype=float)
        lower, upper = height[..., 0], height[..., 1]
        a, b = self.radius
        return np.stack([a - lower, a + b - (upper - lower), b - (self.gap - upper)], axis=-1)

    @staticmethod
    def _coupling(per_contact: tuple[float, float, float]) -> np.ndarray:
        """Return the (2, 2) matrix of a force that each contact exerts in proportion to its overlap or rate."""
        floor, between, ceiling = per_contact
        return np.array([[floor + between, -between], [-between, between + ceiling]])

    @property
    def equilibrium(self) -> np.ndarray:
        """Heights of the centres at rest (2,), m."""
        floor, between, ceiling = np.array(self.stiffness) * self.overlaps(np.zeros(2))
        push = np.array([floor - between, between - ceiling]) - self.gravity * np.array(self.mass)
        return np.linalg.solve(self._coupling(self.stiffness), push)

    @property
    def frequencies(self) -> np.ndarray:
        """Angular frequencies of the two undamped modes (2,), rad/s, ascending."""
        root = np.sqrt(self.mass)
        return np.sqrt(np.linalg.eigvalsh(self._coupling(self.stiffness) / np.outer(root, root)))

    def motion(self, time: np.ndarray, *, height: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Heights and velocities (T, 2), m and m/s, at `time` (T,), s, from `height` and `velocity` (2,) at 0.

        Raises ValueError if a contact has opened at one of the times, or if a mode is critically damped, so
        that A lacks an eigenvector.
        """
        unit = self.frequencies[-1]  # in units of the fast mode heights and velocities are of one size
        start = np.concatenate([np.asarray(height, dtype=float) - self.equilibrium, np.asarray(velocity) / unit])
        rate, mode = np.linalg.eig(self._rates(unit))
        if np.linalg.cond(mode) > 1e6:
            raise ValueError("a mode is critically damped: change the damping a little")
        swing = np.exp(rate * (unit * np.asarray(time, dtype=float))[:, None]) * np.linalg.solve(mode, start)
        state = (swing @ mode.T).real
        heights = state[:, :2] + self.equilibrium
        if np.any(self.overlaps(heights) < 0):
            raise ValueError("a contact opens: the motion is linear only while all three are closed")
        return heights, state[:, 2:] * unit

    def _rates(self, unit: float) -> np.ndarray:
        """Return A (4, 4) for (y, y'/unit) and the time unit * t."""
        mass = np.array(self.mass)[:, None]
        return np.block([
            [np.zeros((2, 2)), np.eye(2)],
            [-self._coupling(self.stiffness) / (mass * unit**2), -self._coupling(self.damping) / (mass * unit)],
        ])
