"""Time averages of a ring in concentric cells, with error bars that know of autocorrelation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from harness.scene.laws import elastic_stiffness
from harness.scene.model import Couette
from harness.scene.system import System
from harness.studies.compare.profile_quantities import QUANTITIES, SUMS, Quantity
from postproc.averaging.fractions import disc_in_circle
from postproc.averaging.registry import make_cells
from postproc.fields import IN_CELLS, Subject
from postproc.propagation import linearised
from postproc.results import Unavailable
from postproc.snapshot import MissingColumn, Snapshot
from postproc.trajectory import Trajectory
from postproc.uncertainty import ENOUGH, ENOUGH_POOLED, LEAST_FREEDOM, SHORT, estimate

FIELDS = {f.name: f for f in IN_CELLS}
ROUNDING = 1e-9
"""Relative: a frame right at the time from which averages are taken belongs to them."""


@dataclass(frozen=True, kw_only=True)
class Profile:
    """A quantity in K cells: mean and standard error (K,), in `unit`.

    samples: effective number (K,). freedom: of the error (K,), None for one less than there are samples. frames:
    how many have a value (K,). short: (K,), too few autocorrelation times for the error to be trusted; needed: as
    many frames as would do. series: what was averaged, (F, K), NaN in gaps; None where only the averages are known.
    """

    unit: str
    mean: np.ndarray
    error: np.ndarray
    samples: np.ndarray
    frames: np.ndarray
    short: np.ndarray
    needed: float
    series: np.ndarray | None = None
    freedom: np.ndarray | None = None

    @property
    def known(self) -> np.ndarray:
        """Degrees of freedom of the error (K,), 0.5 at least; that of one sample where the number is unknown."""
        free = self.samples - 1.0 if self.freedom is None else self.freedom
        return np.maximum(np.nan_to_num(free, nan=0.0), LEAST_FREEDOM)


@dataclass(frozen=True, kw_only=True)
class RingProfiles:
    """Profiles of one run by name; absent: why a quantity is missing.

    edges: (K+1,) radii of the cells, m; frames: number averaged over, `spacing` s apart. glued: (K,), part of each
    cell that glued discs take up.
    """

    edges: np.ndarray
    glued: np.ndarray
    frames: int
    spacing: float
    profiles: Mapping[str, Profile]
    absent: Mapping[str, str] = field(default_factory=dict)

    @property
    def r(self) -> np.ndarray:
        """Middles of the cells, (K,), m."""
        return (self.edges[1:] + self.edges[:-1]) / 2.0

    @property
    def span(self) -> float:
        """Time that is averaged over, s."""
        return self.frames * self.spacing


def steady_frames(trajectory: Trajectory, scene: Couette) -> list[Snapshot]:
    """Return the frames from `steady_from` on."""
    return [f for f in trajectory if f.time >= scene.compare.steady_from * (1.0 - ROUNDING)]


def subject_of(frame: Snapshot, scene: Couette, system: System) -> Subject:
    """Return a frame in the scene's cells. A law without tangential springs is known here, not from forces alone."""
    return Subject(
        cells=make_cells(f"rings:{scene.compare.cells}", frame), kn=elastic_stiffness(system.normal),
        kt=elastic_stiffness(system.sliding) or 0.0,
    )


def ring_profiles(subjects: Sequence[Subject], system: System) -> RingProfiles:
    """Average the steady frames of a run, each in its cells."""
    inputs, absent = _inputs(subjects)
    made, why = {}, {}
    for quantity in QUANTITIES:
        lacking = [absent[name] for name in quantity.inputs if name in absent]
        if lacking:
            why[quantity.name] = lacking[0]
            continue
        profile = _profile(quantity, {name: inputs[name] for name in quantity.inputs})
        if np.isfinite(profile.mean).any():
            made[quantity.name] = profile
        else:
            why[quantity.name] = NOWHERE.get(quantity.name, "no cell has a value")
    edges, times = subjects[0].cells.edges, [s.snapshot.time for s in subjects]
    return RingProfiles(
        edges=edges, glued=glued_part(system, edges), frames=len(subjects), profiles=made, absent=why,
        spacing=(times[-1] - times[0]) / (len(times) - 1),
    )


NOWHERE = {"torque_stiffness": "contacts without tangential springs have no curvature"}


def _inputs(subjects: Sequence[Subject]) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Return each input's series (F, K, ...), and why some are missing."""
    names = dict.fromkeys(name for q in QUANTITIES for name in q.inputs)
    found, absent = {}, {}
    for name in names:
        try:
            found[name] = np.array([_input(name, s) for s in subjects])
        except MissingColumn as missing:
            absent[name] = str(missing)
    return found, absent


def _input(name: str, subject: Subject) -> np.ndarray:
    if name in SUMS:
        return SUMS[name](subject)
    result = FIELDS[name].evaluate(subject)
    if isinstance(result, Unavailable):
        raise MissingColumn(result.reason)
    return result.values


def _profile(quantity: Quantity, inputs: dict[str, np.ndarray]) -> Profile:
    return profile_of(linearised(quantity.formula, inputs), quantity.unit)


def profile_of(series: np.ndarray, unit: str) -> Profile:
    """Average a series (F, K) over its frames, autocorrelation times pooled over the cells."""
    e = estimate(series, pooled=True)
    tau = e.tau[np.isfinite(e.tau)]
    return Profile(
        unit=unit, mean=e.mean, error=e.error, samples=e.samples, frames=e.frames, short=e.doubt == SHORT,
        freedom=e.freedom, needed=ENOUGH_POOLED * float(tau.min()) if tau.size else 0.0, series=series,
    )


def number_of(series: np.ndarray, unit: str) -> Profile:
    """Average the series (F,) of one number over its frames, with its own autocorrelation time: a profile of one cell.

    `samples`, `frames` and `needed` count entries of the series.
    """
    e = estimate(series[:, None])
    return Profile(
        unit=unit, mean=e.mean, error=e.error, samples=e.samples, frames=e.frames, short=e.doubt == SHORT,
        freedom=e.freedom, needed=float(np.nan_to_num(ENOUGH * e.tau[0])), series=series[:, None],
    )


def mean_over(profile: Profile, cells: np.ndarray, weights: np.ndarray | None = None) -> Profile:
    """Return the mean over cells (K,), true where they count, as a number with an error of its own.

    The error is that of the series of this mean, frame by frame: cells move together, so that their errors do not add
    up to it. A gap counts as the cell's mean. weights: of the cells, (K,), alike without.
    """
    w = np.where(cells, 1.0 if weights is None else weights, 0.0)
    filled = np.where(np.isfinite(profile.series), profile.series, profile.mean)
    return number_of(filled[:, cells] @ (w[cells] / w.sum()), profile.unit)


def glued_part(system: System, edges: np.ndarray) -> np.ndarray:
    """Part of each cell between `edges` (K+1,) that the discs glued on the rings take up, (K,)."""
    inside = np.zeros(len(edges))
    for ring in system.rings:
        area = float(np.pi * (ring.radius**2).sum())
        a = np.full(len(edges), ring.radius[0])
        inside += area * disc_in_circle(edges, a, np.full(len(edges), ring.circle))
    return np.diff(inside) / (np.pi * np.diff(edges**2))
