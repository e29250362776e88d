"""A ball or disc on a plane with Coulomb friction: from sliding to rolling, and down an incline.

Signs: x along the plane (down the incline), y away from it, spin w counterclockwise, so that rolling is
s = u + R w = 0 with s the slip of the lowest point, and rolling towards +x has w < 0. Inertia I = q m R^2:
sphere q = 2/5, disc or cylinder q = 1/2.

Level plane: while s != 0, du/dt = -mu g sign(s), R dw/dt = -(mu g/q) sign(s); u - q R w stays. Hence

    t_r = |s0| q / ((1 + q) mu g),     u_r = -R w_r = (u0 - q R w0)/(1 + q)

without spin at first: 2/7 u0/(mu g) and 5/7 u0 for a sphere, 1/3 and 2/3 for a disc, the speed at any mu.

Incline of angle th, started from rest: rolls if tan(th) <= (1 + 1/q) mu (7/2 mu, 3 mu), with
a = g sin(th)/(1 + q) (5/7, 2/3); else it slides with a = g (sin(th) - mu cos(th)) and
R dw/dt = -(mu g/q) cos(th) (5/2, 2).

Source: rigid-body mechanics, e.g. L. D. Landau, E. M. Lifshitz, Mechanics, section 38; the level plane
is case DEM04 of the MFiX verification manual.

Valid for a rigid ball that stays on the plane, one friction coefficient for rest and motion, no rolling
resistance. A soft ball rolls only up to the swinging of its tangential spring. The tests integrate
Coulomb's law.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class SlidingBall:
    """A ball set down on a level plane with velocity u0 (m/s) and spin w0 (rad/s).

    radius R (m), inertia_factor q (-), friction mu (-) > 0, gravity g (m/s^2) > 0.

    >>> ball = SlidingBall(velocity=1.0, spin=0.0, radius=0.05, inertia_factor=0.4, friction=0.3, gravity=9.81)
    >>> round(ball.rolling_velocity, 6), round(ball.time_to_roll * 0.3 * 9.81, 6)
    (0.714286, 0.285714)
    """

    velocity: float
    spin: float
    radius: float
    inertia_factor: float
    friction: float
    gravity: float

    @property
    def slip(self) -> float:
        """s0 = u0 + R w0, m/s."""
        return self.velocity + self.radius * self.spin

    @property
    def time_to_roll(self) -> float:
        """t_r, s: when the slip ends."""
        q = self.inertia_factor
        return abs(self.slip) * q / ((1 + q) * self.friction * self.gravity)

    @property
    def rolling_velocity(self) -> float:
        """u_r, m/s: of the centre from t_r on."""
        q = self.inertia_factor
        return (self.velocity - q * self.radius * self.spin) / (1 + q)

    @property
    def rolling_spin(self) -> float:
        """w_r = -u_r/R, rad/s: from t_r on."""
        return -self.rolling_velocity / self.radius

    @property
    def energy_lost(self) -> float:
        """Kinetic energy lost until it rolls, per mass, J/kg: s0^2/2 q/(1 + q), at any friction."""
        return 0.5 * self.slip**2 * self.inertia_factor / (1 + self.inertia_factor)

    def motion(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Distance of the centre from the start (m), velocity (m/s) and spin (rad/s) at `time` >= 0 (s, any shape)."""
        time = np.asarray(time, dtype=float)
        sliding = np.minimum(time, self.time_to_roll)
        push = -self.friction * self.gravity * np.sign(self.slip)
        velocity = self.velocity + push * sliding
        spin = self.spin + push * sliding / (self.inertia_factor * self.radius)
        distance = self.velocity * sliding + 0.5 * push * sliding**2 + self.rolling_velocity * (time - sliding)
        return distance, velocity, spin


@dataclass(frozen=True, kw_only=True)
class BallOnIncline:
    """A ball released from rest on a plane inclined by `angle` (rad, 0 to pi/2).

    radius R (m), inertia_factor q (-), friction mu (-) >= 0, gravity g (m/s^2) > 0.

    >>> ball = BallOnIncline(angle=math.radians(30), radius=0.05, inertia_factor=0.4, friction=0.2, gravity=10.0)
    >>> ball.rolls, round(ball.acceleration, 6), round(ball.angular_acceleration, 4)
    (True, 3.571429, -71.4286)
    """

    angle: float
    radius: float
    inertia_factor: float
    friction: float
    gravity: float

    @property
    def rolling_friction_needed(self) -> float:
        """The least mu with which the ball rolls: tan(th) q/(1 + q)."""
        return math.tan(self.angle) * self.inertia_factor / (1 + self.inertia_factor)

    @property
    def rolls(self) -> bool:
        """Whether the ball rolls without slip."""
        return self.friction >= self.rolling_friction_needed

    @property
    def friction_force(self) -> float:
        """Friction per mass, up the incline, m/s^2: what rolling needs, mu g cos(th) at most."""
        return min(self.friction, self.rolling_friction_needed) * self.gravity * math.cos(self.angle)

    @property
    def acceleration(self) -> float:
        """Of the centre, down the incline, m/s^2."""
        return self.gravity * math.sin(self.angle) - self.friction_force

    @property
    def angular_acceleration(self) -> float:
        """dw/dt, rad/s^2; negative, since the ball turns clockwise down the incline."""
        return -self.friction_force / (self.inertia_factor * self.radius)
