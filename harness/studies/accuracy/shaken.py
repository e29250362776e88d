"""Whether a rung of a box or a ring is shaken by its own steps: two looks at its physics, against the finest rung.

A step that is too long does not end a run. It shakes the sample: discs gain energy from the steps, dashpots take it
away again, and averages may still look like those of an experiment. So of every run are formed

    balance   of a box the rms of (F_top - F_bottom) over the rms of F_top, from a strain of FROM on; of a ring the rms
              of T_inner + T_outer about its mean over the rms of T_inner, in the steady part. Forces of opposite walls
              differ by the rate of the sample's momentum alone: this is the part that inertia has in them
    energy    kinetic energy of all discs over half their mass times the square of the drive's speed, (m v^2)/(M V^2);
              mean over the frames of the second half of the run; a box has its last one

and held against those of the finest rung of the ladder as ln(a/b) over packings, a t value of which stands in `BEYOND`.
What a knob may do to them by physics is divided out first. With x the knob's own variable over that of the finest rung
(dt: step, rate: rate, stiffness: 1/k, size: 1/sqrt(N); all > 1)::

    rate        balance x, energy x   momentum goes with speeds, and the faster the drive the more of the time samples
                                      are in motion (measured on biaxial_quick, 8 times as fast: balance 4 to 5 times,
                                      energy over V^2 5 to 9 times that as declared)
    stiffness   energy x              what springs let go of is F^2/k (measured at 1/16: 3 to 9 times)
    others      nothing

A different law moves differently, so that there is nothing to hold it against: rungs of `law` are not judged.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from harness.scene.model import Biaxial, Scene
from harness.studies.accuracy.bulk_quantities import FROM
from harness.studies.compare.curves import biaxial_curves
from harness.studies.compare.ring_curves import ring_curves

if TYPE_CHECKING:
    from harness.scene.system import System
    from postproc.trajectory import Trajectory

UNBALANCED, HOT = 2.0, 10.0
"""Times the finest rung's balance, energy, from which on a rung is shaken. On biaxial_quick (8 packings, three engines)
rungs up to 0.18 contact times a step have 0.92 to 0.99 times the balance and 0.4 to 2.1 times the energy (that of one
moment) of the rung at 0.045; at 0.36 it is 4.9 to 8 times the one and 25 to 160 times the other."""

DOUBT = 2.0
"""Standard errors over packings by which a ratio has to exceed these."""

BY_PHYSICS: dict[str, tuple[float, float]] = {"rate": (1.0, 1.0), "stiffness": (0.0, 1.0)}
"""Powers of x by which balance and energy may grow."""

UNJUDGED = ("law",)


@dataclass(frozen=True, kw_only=True)
class Shaking:
    """Of one run, see the module."""

    balance: float
    energy: float


def shaking_of(scene: Scene, system: System, trajectory: Trajectory) -> Shaking:
    """Return both numbers of a run; NaN where nothing was driven or carried."""
    box = isinstance(scene, Biaxial)
    balance, speed = _box(system, trajectory) if box else _ring(scene, trajectory)
    return Shaking(balance=balance, energy=_energy(system, trajectory, speed))


def why_shaken(turned: Mapping[str, float], here: Sequence[Shaking], finest: Sequence[Shaking]) -> str:
    """Say why a rung cannot be believed, "" where nothing speaks against it.

    turned: x of the rung over that of the finest one, by knob. here, finest: packing by packing.
    """
    if any(knob in UNJUDGED for knob in turned):
        return ""
    said = []
    for number, (name, words, limit) in enumerate((
        ("balance", "opposite walls out of balance by", UNBALANCED), ("energy", "kinetic energy", HOT),
    )):
        allowed = math.prod(x ** BY_PHYSICS[knob][number] for knob, x in turned.items() if knob in BY_PHYSICS)
        a, b = (np.array([getattr(s, name) for s in of]) for of in (here, finest))
        ratio, least = _ratio(a, b)
        if least / allowed > limit:
            typical = f" {100 * np.median(a):.2g} %," if name == "balance" else ""
            said.append(f"{words}{typical} {ratio:.{0 if ratio >= 10.0 else 1}f} times the finest rung's")
    return "; ".join(said)


def _ratio(a: np.ndarray, b: np.ndarray) -> tuple[float, float]:
    """Return the ratio of geometric means over packings, and the least that it may be; 0 where it is not known."""
    good = np.isfinite(a) & np.isfinite(b) & (a > 0.0) & (b > 0.0)
    if good.sum() < 2:
        return 0.0, 0.0
    apart = np.log(a[good] / b[good])
    error = apart.std(ddof=1) / np.sqrt(len(apart))
    return float(np.exp(apart.mean())), float(np.exp(apart.mean() - DOUBT * error))


def _box(system: System, trajectory: Trajectory) -> tuple[float, float]:
    """Return the balance, and the rms speed of the top wall, m/s."""
    curves = biaxial_curves(trajectory, system)
    late = curves.strain >= FROM
    top, bottom = curves.force_top[late], curves.force_bottom[late]
    return _part(top - bottom, top), _rms(trajectory.series["top_v"])


def _ring(scene: Scene, trajectory: Trajectory) -> tuple[float, float]:
    """Return the balance, and the speed of the inner ring's rim, m/s."""
    curves = ring_curves(trajectory)
    steady = curves.time >= scene.compare.steady_from
    inner, both = curves.inner_torque[steady], (curves.inner_torque + curves.outer_torque)[steady]
    return _part(both - both.mean() if len(both) else both, inner), abs(scene.rings.omega) * scene.rings.inner_radius


def _energy(system: System, trajectory: Trajectory, speed: float) -> float:
    """Return sum m v^2 / (M V^2), mean over the later half of the frames."""
    mass, axes = system.particles.mass, "xyz"[: system.dimension]
    later = trajectory.frames[len(trajectory.frames) // 2 :]
    if not later or not speed > 0.0:
        return float("nan")
    found = [(mass * (f.particles.vector(*(f"v{a}" for a in axes)) ** 2).sum(axis=1)).sum() for f in later]
    return float(np.mean(found) / (mass.sum() * speed**2))


def _part(rest: np.ndarray, whole: np.ndarray) -> float:
    size = _rms(whole)
    return _rms(rest) / size if size > 0.0 else float("nan")


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).mean())) if len(values) else 0.0
