"""What is checked on a biaxial box: pointwise agreement, then what one packing can still say.

Every function takes finished runs and returns `Check`s; a run that is missing gives `not_checked`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from harness.scene.model import Biaxial, Window
from harness.studies.compare.curves import BiaxialCurves
from harness.studies.compare.pairs import Pair
from harness.studies.verdict import Check, within

CONTROL_TOLERANCE = 0.02
"""The side wall's stress may differ from p_x by 2 % up to the peak: beyond, the test is not stress-controlled."""

INERTIA_LIMIT = 1e-3
"""Inertial number below which flow counts as quasi-static (GDR MiDi, Eur. Phys. J. E 14, 341 (2004))."""

PARTED = 1e-2
"""Relative difference of the top-wall force at which two runs no longer follow each other."""

Curves = Mapping[str, BiaxialCurves]


def force_deviation(a: BiaxialCurves, b: BiaxialCurves) -> np.ndarray:
    """Return |F_a - F_b| / max(|F_a|, |F_b|) of the top wall, sample by sample; 0 where both vanish."""
    difference = np.abs(a.force_top - b.force_top)
    size = np.maximum(np.abs(a.force_top), np.abs(b.force_top))
    return np.divide(difference, size, out=np.zeros_like(size), where=size > 0)


def window_checks(pairs: list[Pair], windows: tuple[Window, ...], curves: Curves, rerun: str) -> list[Check]:
    """Top-wall force, pointwise, for every pair of the kind that a window declares (level L2)."""
    return [_window_check(p, w, curves, rerun) for w in windows for p in pairs if p.kind == w.pairs]


def _window_check(pair: Pair, window: Window, curves: Curves, rerun: str) -> Check:
    facts = {
        "level": "L2", "left": pair.left, "right": pair.right, "tolerance": window.tolerance,
        "quantity": f"top-wall force up to {100 * window.strain:g} % strain",
    }
    if pair.left not in curves or pair.right not in curves:
        return Check(**facts, deviation=None, verdict="not_checked", why=_missing(pair, curves))
    a, b = curves[pair.left], curves[pair.right]
    inside = b.upto(window.strain)
    if not inside.any():
        return Check(**facts, deviation=None, verdict="not_checked", why="no sample lies in this range")
    deviation = float(force_deviation(a, b)[inside].max())
    verdict = within(deviation, window.tolerance)
    why = f"largest of {int(inside.sum())} samples" + (f"; rerun: {rerun}" if verdict == "differs" else "")
    return Check(**facts, deviation=deviation, verdict=verdict, why=why)


def _missing(pair: Pair, curves: Curves) -> str:
    return "no completed run of " + " and ".join(e for e in (pair.left, pair.right) if e not in curves)


def parting_checks(pairs: list[Pair], curves: Curves) -> list[Check]:
    """Where pointwise agreement ended; after it one packing cannot decide (level L2)."""
    return [_parting_check(p, curves) for p in pairs if p.left in curves and p.right in curves]


def _parting_check(pair: Pair, curves: Curves) -> Check:
    a, b = curves[pair.left], curves[pair.right]
    apart = np.flatnonzero(force_deviation(a, b) > PARTED)
    whole = not apart.size
    end = float(b.strain[-1] if whole else b.strain[apart[0]])
    why = (
        f"within {PARTED:.0%} all the way to {100 * end:.3g} % strain" if whole
        else f"followed each other within {PARTED:.0%} up to {100 * end:.3g} % strain; after it only replicates can tell"
    )
    return Check(
        level="L2", quantity="top-wall force, whole test", left=pair.left, right=pair.right,
        deviation=float(force_deviation(a, b).max()), tolerance=PARTED,
        verdict="agrees" if whole else "inconclusive", why=why,
    )


def quasistatic_checks(curves: Curves, inertial_number: float, rerun: str) -> list[Check]:
    """Was the test what it claims to be? Control of the side wall up to the peak, and slowness."""
    return [_control_check(name, c, rerun) for name, c in curves.items()] + [_inertia_check(inertial_number)]


def _control_check(name: str, c: BiaxialCurves, rerun: str) -> Check:
    error = float(np.abs(c.control_error[: c.peak + 1]).max())
    verdict = within(error, CONTROL_TOLERANCE)
    why = f"largest up to the peak at {100 * c.strain[c.peak]:.3g} % strain"
    return Check(
        level="run", quantity="side wall (F_x - p_x z)/(p_x z)", left=name, right="p_x", deviation=error,
        tolerance=CONTROL_TOLERANCE, verdict=verdict, why=why + (f"; rerun: {rerun}" if verdict == "differs" else ""),
    )


def _inertia_check(number: float) -> Check:
    return Check(
        level="run", quantity="inertial number", left="scene", right="quasi-static", deviation=number,
        tolerance=INERTIA_LIMIT, verdict=within(number, INERTIA_LIMIT), why="largest, from the drive", unit="I",
    )


# --- numbers of the whole test: reported, and judged only with replicates -----------------------

MACRO: dict[str, tuple[str, Callable[[BiaxialCurves, tuple[float, float]], float]]] = {
    "peak stress ratio": ("", lambda c, _: float(c.ratio[c.peak])),
    "peak friction angle": ("deg", lambda c, _: float(c.friction_angle[c.peak])),
    "strain at the peak": ("", lambda c, _: float(c.strain[c.peak])),
    "plateau sigma_zz": ("N/m", lambda c, p: plateau_mean(c.stress_zz, c, p)),
    "plateau stress ratio": ("", lambda c, p: plateau_mean(c.ratio, c, p)),
    "plateau friction angle": ("deg", lambda c, p: plateau_mean(c.friction_angle, c, p)),
    "volume strain at the end": ("", lambda c, _: float(c.volume_strain[-1])),
}
"""Quantity: unit and how it is formed from curves and the plateau's strain range."""


def plateau_mean(values: np.ndarray, curves: BiaxialCurves, plateau: tuple[float, float]) -> float:
    """Return the mean over strain, not over time: the drive is slow at its ends."""
    low, high = plateau
    inside = (curves.strain >= low) & (curves.strain <= high)
    strain = curves.strain[inside]
    return float(np.trapezoid(values[inside], strain) / (strain[-1] - strain[0]))


def macro_values(curves: BiaxialCurves, scene: Biaxial) -> dict[str, float]:
    """Return the numbers of one test by name; plateau values only if the scene declares a plateau."""
    plateau = scene.compare.plateau
    wanted = {k: f for k, (_, f) in MACRO.items() if plateau is not None or not k.startswith("plateau")}
    return {name: f(curves, plateau) for name, f in wanted.items()}
