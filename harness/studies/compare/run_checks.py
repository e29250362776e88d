"""What every single run of a biaxial box must obey, whatever the other codes say (level "run").

Slow: the drive's rate over the whole run. Stress-controlled: the side wall's stress up to the peak. As
declared: walls where the programme has them. Consistent: the stress of the contacts is that of the walls.
None of these says that the sample stayed near equilibrium: what it did after the peak is measured in
`harness.studies.compare.phases` and shown, not judged.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from harness.scene.system import System
from harness.studies.compare.curves import BiaxialCurves, biaxial_curves
from harness.studies.compare.pointwise import Curves
from harness.studies.compare.states import ENERGY, StateCurves
from harness.studies.verdict import Check, Rerun, judged
from postproc.averaging.registry import make_cells
from postproc.macro.inertial_number import inertial_number
from postproc.trajectory import Trajectory

Runs = Mapping[str, Iterable[tuple[Trajectory, System]]]
"""Trajectory and system of every packing, by engine."""

CONTROL_TOLERANCE = 0.02
"""The side wall's stress may differ from p_x by 2 % up to the peak: beyond, the test is not stress-controlled."""

INERTIA_LIMIT = 1e-3
"""Inertial number below which a rate counts as slow (GDR MiDi, Eur. Phys. J. E 14, 341 (2004))."""

PLACE_TOLERANCE = 1e-9
"""Of the top wall's travel. The motion is prescribed, so rounding alone is left: 1e-15 measured."""

BALANCE_TOLERANCE = 0.05
"""Contacts and walls differ by what accelerates and drags the particles: in bursts up to 10 % in a frame
(measured), in the middle of all frames 1 %."""


def drive_checks(runs: Runs, states: Mapping[str, StateCurves], rerun: Rerun) -> list[Check]:
    """Each engine's test was driven slowly, from its first sample to its last; bursts are no part of this check."""
    return [
        judged(
            level="run", quantity="rate of the drive (axial inertial number)", left=engine, right="slow drive",
            deviation=float(np.max([inertial_numbers(*r).max() for r in of])), tolerance=INERTIA_LIMIT,
            why=f"largest over the run, of the top wall's rate alone; not of bursts: {_energy(states.get(engine))}",
            rerun=rerun(engine),
        )
        for engine, of in runs.items()
    ]


def _energy(states: StateCurves | None) -> str:
    """Say the largest E_kin/E_el of a run's frames and where it was."""
    if states is None or ENERGY not in states.values or np.isnan(states.values[ENERGY]).all():
        return "E_kin/E_el not available"
    k = int(np.nanargmax(states.values[ENERGY]))
    return f"E_kin/E_el reaches {states.values[ENERGY][k]:.2g} at {100 * states.strain[k]:.3g} % strain"


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
    errors = [np.abs(c.control_error[: None if c.peak is None else c.peak.sample + 1]).max() for c in curves]
    worst = int(np.argmax(errors))
    peak = curves[worst].peak
    return judged(
        level="run", quantity="side wall (F_x - p_x z)/(p_x z)", left=engine, right="p_x",
        deviation=float(errors[worst]), tolerance=CONTROL_TOLERANCE, rerun=rerun,
        why="largest over the whole test, which has no peak" if peak is None
        else f"largest up to the peak at {peak.where}; later it is shown, not judged",
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
    """d(t) = travel/2 (1 - cos(pi t/T)), at rest from the end of the motion on."""
    return motion.travel / 2.0 * (1.0 - np.cos(np.pi * np.minimum(time, motion.end) / motion.duration))


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
