"""Tables of the page besides the rows beside the talk's."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.studies.reproduce.boxes import LARGEST, SIDE, number_over_packings
from harness.studies.reproduce.cohesion.declared import MEMORY, PLATEAU, RATIOS, talk_cohesions
from harness.studies.reproduce.cohesion.lines import yield_lines
from harness.studies.reproduce.protocol import Case
from harness.studies.reproduce.runs import Made, by_engine, engines_of


def reading_rows(made: Sequence[Made], duration: float) -> list[dict]:
    """One row an engine and k_c/k_2: angle and cohesion of every reading, means over packings, and the talk's."""
    readings = {
        f"{what}, {MEMORY if memory else 'prepared at p_x'}": (axial, memory)
        for what, axial in (("plateau", PLATEAU), ("top", LARGEST)) for memory in (False, True)
    }
    rows = []
    for engine in engines_of(made):
        for ratio in RATIOS:
            found = {
                name: yield_lines(made, engine, ratio, duration, memory=memory, axial=axial)
                for name, (axial, memory) in readings.items()
            }
            rows.append({"engine": engine, "k_c/k_2": ratio, **{
                f"{head}, {name}": of[what].value if of[what].packings else None
                for what, head in (("cohesion", "c (N/m)"), ("angle", "phi (deg)")) for name, of in found.items()
            }, "c (N/m), talk": talk_cohesions()[ratio]})
    return rows


def test_rows(made: Sequence[Made], of_main: Sequence[Case]) -> list[dict]:
    """One row a test and engine: means over its packings."""
    names = {"sigma_zz (N/m)": PLATEAU, "sigma_xx (N/m)": SIDE, "largest sigma_zz (N/m)": LARGEST}
    rows = []
    for c in of_main:
        for engine, of in by_engine(made, c.name).items():
            found = {head: number_over_packings(made, c.name, name)[engine] for head, name in names.items()}
            rows.append({
                "test": c.name, "engine": engine, "packings": len(of),
                **{head: m.value for head, m in found.items()},
                "standard error of sigma_zz": found["sigma_zz (N/m)"].error,
                "side wall off p_x, mean of the plateau": float(np.mean([r.control for r in of.values()])),
                "largest inertial number": max(r.inertia for r in of.values()),
            })
    return rows
