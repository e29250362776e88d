"""What every single run of a biaxial box must obey, whatever the other codes say (level "run").

Quasi-static: the inertial number over the whole run, and the side wall's stress up to the peak. As
declared: walls where the programme has them. Consistent: the stress of the contacts is that of the walls.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from harness.scene.system import System
from harness.studies.compare.curves import BiaxialCurves, biaxial_curves
from harness.studies.compare.pointwise import Curves
from harness.studies.compare.states import StateCurves
from harness.studies.verdict import Check, Rerun, judged
from postproc.averaging.registry import make_cells
from postproc.macro.inertial_number import inertial_number
from postproc.trajectory import Trajectory

Runs = Mapping[str, Iterable[tuple[Trajectory, System]]]
"""Trajectory and system of every packing, by engine."""

CONTROL_TOLERANCE = 0.02
"""The side wall's stress may differ from p_x by 2 % up to the peak: beyond, the test is not stress-controlled."""

INERTIA_LIMIT = 1e-3
"""Inertial number below which flow counts as quasi-static (GDR MiDi, Eur. Phys. J. E 14, 341 (2004))."""

PLACE_TOLERANCE = 1e-9
"""Of the top wall's travel. The motion is prescribed, so rounding alone is left: 1e-15 measured."""

BALANCE_TOLERANCE = 0.05
"""Contacts and walls differ by what accelerates and drags the particles: in bursts up to 10 % in a frame
(measured), in the middle of all frames 1 %."""


def inertia_checks(runs: Runs, rerun: Rerun) -> list[Check]:
    """Each engine's test was slow, from its first sample to its last."""
    return [
        judged(
            level="run", quantity="inertial number, axial", left=engine, right="quasi-static",
            deviation=float(np.max([inertial_numbers(*r).max() for r in of])), tolerance=INERTIA_LIMIT,
            why="largest over the run, from the top wall's motion and the mean stress at the walls",
            rerun=rerun(engine),
        )
        for engine, of in runs.items()
    ]


def inertial_numbers(trajectory: Trajectory, system: System) -> np.ndarray:
    """Return I of every sample, (S,), as measured: rate of the axial strain, (sigma_zz + sigma_xx)/2, mean mass.

    NaN where the walls do not press.
    """
    curves, cells = biaxial_curves(trajectory, system), make_cells("box", trajectory.frames[0])
    pairs = zip(curves.strain_rate, curves.mean_stress, strict=True)
    return np.array([inertial_number(rate, cells, np.array([p]))[0] for rate, p in pairs])


def control_checks(curves: Curves, rerun: Rerun) -> list[Check]:
    """Each engine's side wall carries the stress asked for, up to the peak of the curve, in every packing."""
    return [_control_check(engine, list(of.values()), rerun(engine)) for engine, of in curves.items()]


def _control_check(engine: str, curves: list[BiaxialCurves], rerun: str) -> Check:
    peaks = [c.peak for c in curves]
    errors = [np.abs(c.control_error[: k + 1]).max() for c, k in zip(curves, peaks, strict=True)]
    worst = int(np.argmax(errors))
    peak = curves[worst].strain[peaks[worst]]
    return judged(
        level="run", quantity="side wall (F_x - p_x z)/(p_x z)", left=engine, right="p_x",
        deviation=float(errors[worst]), tolerance=CONTROL_TOLERANCE, rerun=rerun,
        why=f"largest up to the peak at {100 * peak:.3g} % strain",
    )


def place_checks(runs: Runs, rerun: Rerun) -> list[Check]:
    """Each engine's walls are where the programme has them, and frames and series say the same."""
    return [
        judged(
            level="run", quantity="places of the walls", left=engine, right="z(t), frames = series",
            deviation=float(np.max([place_error(*r) for r in of])), tolerance=PLACE_TOLERANCE,
            why="largest over the top wall's travel", rerun=rerun(engine),
        )
        for engine, of in runs.items()
    ]


def place_error(trajectory: Trajectory, system: System) -> float:
    """Return the largest misplacement of the moving walls over the travel of the top wall.

    Top: series and frames against z(t) of the scene. Right: frames against the series, at the steps
    that both have.
    """
    top, right, series = system.wall("top"), system.wall("right"), trajectory.series
    at_frames = np.array([f.time for f in trajectory])
    place = {a: np.array([f.walls[f"p{a}"] for f in trajectory]) for a in "xy"}
    _, sample, frame = np.intersect1d(series["step"], trajectory.steps, return_indices=True)
    errors = (
        series["top_d"] - _prescribed(top.motion, series["time"]),
        top.point[1] - place["y"][:, top.index - 1] - _prescribed(top.motion, at_frames),
        right.point[0] - place["x"][frame, right.index - 1] - series["right_d"][sample],
    )
    return float(np.max([np.abs(e).max() for e in errors]) / abs(top.motion.travel))


def _prescribed(motion, time: np.ndarray) -> np.ndarray:
    """d(t) = travel/2 (1 - cos(pi t/T)), at rest from T on."""
    return motion.travel / 2.0 * (1.0 - np.cos(np.pi * np.minimum(time / motion.duration, 1.0)))


def balance_checks(states: Mapping[str, StateCurves], rerun: Rerun) -> list[Check]:
    """Each engine's contacts carry the stress that its walls measure; none for runs without contacts."""
    return [_balance_check(e, s, rerun(e)) for e, s in states.items() if "sigma_zz from contacts" in s.values]


def _balance_check(engine: str, states: StateCurves, rerun: str) -> Check:
    per_axis = [_apart(*(states.values[f"sigma_{a} from {k}"] for k in ("contacts", "walls"))) for a in ("xx", "zz")]
    return judged(
        level="run", quantity="stress from contacts = from walls", left=engine, right="walls",
        deviation=float(np.median(np.max(per_axis, axis=0))), tolerance=BALANCE_TOLERANCE,
        why=f"sigma_xx and sigma_zz, median of {len(states.strain)} frames", rerun=rerun,
    )


def _apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return |a - b| / max(|a|, |b|), NaN for 0/0."""
    with np.errstate(invalid="ignore"):
        return np.abs(a - b) / np.maximum(np.abs(a), np.abs(b))
