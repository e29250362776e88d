"""Torque and momentum of a steady ring as series over its frames, from contacts and walls (`postproc.macro`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.scene.system import System
from harness.studies.compare.profiles import Profile, mean_over, number_of, profile_of
from harness.studies.compare.ring_curves import RingCurves
from postproc.fields import Subject
from postproc.macro.ring_balance import momentum_rest, net_force, sum_inside, torque_of, torque_through


@dataclass(frozen=True, kw_only=True)
class RingBalances:
    """Time averages of one run with errors; torques in N m (2D of thickness 1: per unit thickness).

    r: (K,) radii, in the middle of the cells. inner, outer: torque on the rings, drag: of the bottom on the discs,
    total: their sum with the drag, which is what the discs gain and lose in angular momentum; drift: torque of the
    outer ring in the second half of the time less that in the first; each one number.
    through: torque from the inside of circles r to their outside, contacts and motion. from_inner, from_outer: what it
    exceeds what enters at the inner ring, or leaves at the outer one, with the drag between. circles: (K,), r that have
    discs on both sides in every frame. momentum: (r, phi) residuals of the balance of momentum, N/m.
    mean_pressure: (sigma_rr + sigma_phiphi)/2, its mean over the cells, N/m.
    absent: why there is nothing of contacts.
    """

    r: np.ndarray
    inner: Profile
    outer: Profile
    total: Profile
    drift: Profile
    drag: Profile | None
    through: Profile | None = None
    from_inner: Profile | None = None
    from_outer: Profile | None = None
    circles: np.ndarray | None = None
    momentum: tuple[Profile, Profile] | None = None
    mean_pressure: Profile | None = None
    absent: str = ""

    @property
    def pressure(self) -> float:
        """The value of `mean_pressure`, N/m; NaN where there is none."""
        return np.nan if self.mean_pressure is None else float(self.mean_pressure.mean[0])


def ring_balances(curves: RingCurves, subjects: Sequence[Subject], system: System) -> RingBalances:
    """Return the balances over the time from the first to the last of the steady frames."""
    start = subjects[0].snapshot.time * (1.0 - 1e-9)
    steady = curves.time >= start
    inner, outer = curves.inner_torque[steady], curves.outer_torque[steady]
    drag = None if system.background is None else np.array([_drag(s, system)[1].sum() for s in subjects])
    balances = {
        "r": subjects[0].cells.coordinates["r"], "inner": _number(inner), "outer": _number(outer),
        "drag": None if drag is None else _number(drag), "total": _sum(_number(-inner - outer), drag),
        "drift": _drift(outer),
    }
    if subjects[0].snapshot.contacts is None:
        return RingBalances(**balances, absent="contacts were not recorded")
    return RingBalances(**balances, **_of_contacts(subjects, system))


def _number(series: np.ndarray) -> Profile:
    return number_of(series, "N m")


def _drift(torque: np.ndarray) -> Profile:
    """Second half less first, errors in quadrature."""
    first, second = (_number(half) for half in np.array_split(torque, 2))
    return Profile(
        unit="N m", mean=second.mean - first.mean, error=np.hypot(first.error, second.error),
        short=first.short | second.short, samples=np.fmin(first.samples, second.samples), frames=second.frames,
        freedom=np.minimum(first.known, second.known),
        needed=2 * max(first.needed, second.needed),
    )


def _sum(walls: Profile, drag: np.ndarray | None) -> Profile:
    """Add the drag, known in the frames only: errors in quadrature, the smaller number of samples."""
    if drag is None:
        return walls
    d = _number(drag)
    matters = d.error > 0.1 * walls.error
    return Profile(
        unit="N m", mean=walls.mean + d.mean, error=np.hypot(walls.error, d.error),
        short=walls.short | (d.short & matters),
        samples=np.fmin(walls.samples, d.samples), frames=walls.frames, freedom=np.minimum(walls.known, d.known),
        needed=max(walls.needed, d.needed),
    )


def _drag(subject: Subject, system: System) -> tuple[np.ndarray, np.ndarray]:
    """Force of the bottom on each disc, (N, 2), N, Cartesian, and its torque about the centre, (N,), N m."""
    v = subject.snapshot.particles.vector("vx", "vy")
    c = 0.0 if system.background is None else system.background.translational_drag
    force = -c * v
    return force, torque_of(subject.snapshot, force)


def _of_contacts(subjects: Sequence[Subject], system: System) -> dict:
    """Return what needs contacts: torques through circles, and the balance of momentum."""
    rows = [_frame(s, system) for s in subjects]
    through, inside, outside, counts, rest, pressure = (np.array(column) for column in zip(*rows, strict=True))
    number = subjects[0].snapshot.particles.rows
    both = ((counts > 0) & (counts < number)).all(axis=0)
    lacks = np.where(both, 0.0, np.nan)
    return {
        "through": profile_of(through, "N m"), "from_inner": profile_of(inside + lacks, "N m"),
        "from_outer": profile_of(outside + lacks, "N m"), "circles": both, "mean_pressure": _pressure(pressure),
        "momentum": tuple(profile_of(rest[:, :, axis], "N/m") for axis in (0, 1)),
    }


def _pressure(series: np.ndarray) -> Profile:
    """Average the pressures of frames and cells (F, K), all cells alike."""
    profile = profile_of(series, "N/m")
    return mean_over(profile, np.isfinite(profile.mean))


def _frame(subject: Subject, system: System) -> tuple[np.ndarray, ...]:
    """One frame: through r, beyond the inner ring's, beyond the outer ring's, discs inside r, residuals, pressure."""
    snapshot, r = subject.snapshot, subject.cells.coordinates["r"]
    force, drag = _drag(subject, system)
    moving = 2.0 * np.pi * r**2 * np.nan_to_num(subject.kinetic_stress[:, 0, 1])
    through = torque_through(snapshot, r) + moving
    inside = sum_inside(snapshot, r, drag)
    inner, outer = (snapshot.walls["torque"][k] for k in np.argsort(snapshot.walls["radius"]))
    rest = momentum_rest(
        subject.cells, net_force(subject.ends) + subject.cells.turned(force), subject.velocity
    )
    return (
        through, through - (-inner + inside), through - (outer - (drag.sum() - inside)),
        sum_inside(snapshot, r, np.ones(len(drag))), rest, np.trace(subject.stress, axis1=1, axis2=2) / 2.0,
    )
