"""The yield line of two tests, and the slope of the cohesion over the pull of a contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from harness.studies.reproduce.boxes import SIDE, BoxRun, base_scene
from harness.studies.reproduce.cohesion.declared import FILE, HIGH, LOW, PLATEAU, RATIOS, case_name
from harness.studies.reproduce.protocol import Measured
from harness.studies.reproduce.rows import over_packings
from harness.studies.reproduce.runs import Made, by_engine
from postproc.macro.fits.yield_locus import mohr_coulomb
from postproc.results import Unavailable


def yield_lines(
    made: Sequence[Made], engine: str, ratio: str, duration: float, *, memory: bool, axial: str = PLATEAU
) -> dict[str, Measured]:
    """Return "angle" (degrees) and "cohesion" (N/m) over packings, from a stress `axial` at both pressures."""
    names = case_name(LOW, ratio, duration, memory=memory), case_name(HIGH, ratio, duration)
    of = [by_engine(made, name).get(engine, {}) for name in names]
    lines = [two_point_line(*(of_p[k] for of_p in of), axial) for k in of[0] if all(k in of_p for of_p in of)]
    return {
        name: over_packings(engine, [line[k] for line in lines]) for k, name in enumerate(("angle", "cohesion"))
    }


def two_point_line(low: BoxRun, high: BoxRun, axial: str = PLATEAU) -> tuple[float, float]:
    """Return phi (degrees) and c (N/m) of the line through two tests; NaN where there is none."""
    sides, stresses = (np.array([r.numbers[name] for r in (low, high)]) for name in (SIDE, axial))
    line = mohr_coulomb(sides, stresses)
    if isinstance(line, Unavailable):
        return float("nan"), float("nan")
    return line.angle.value, line.cohesion.value


def pull(ratio: str) -> float:
    """Return (k_2 - k_1)/(1 + k_2/k_c), N/m: f_min over the largest overlap; 0 without adhesion."""
    law = base_scene(FILE).contact.normal
    r = RATIOS[ratio]
    return (law.unloading_stiffness - law.loading_stiffness) / (1.0 + 1.0 / r) if r else 0.0


def slope(lines: Mapping[tuple[str, str], Mapping[str, Measured]], engine: str) -> Measured:
    """Return s of c = s (k_2 - k_1)/(1 + k_2/k_c), by least squares over k_c > 0, packing by packing."""
    adhesive = [r for r in RATIOS if RATIOS[r]]
    values = [lines[engine, r]["cohesion"].values for r in adhesive]
    count = min(len(v) for v in values)
    x = np.array([pull(r) for r in adhesive])
    return over_packings(engine, [float(x @ [v[k] for v in values] / (x @ x)) for k in range(count)])
