"""A box over replicates: what is seen, what takes the place of what chaos left open, in checks, tables and pages."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness.report.replicates import replicate_rows, replicate_sections
from harness.report.tables import csv_text
from harness.studies.compare.biaxial import judge_biaxial
from harness.studies.statistics.kick import kicked
from harness.studies.verdict import Rerun

RERUN = Rerun(scene_file=Path("box.toml"), out=Path("out"), packings=None, replicates=6)
ENGINES = ["lammps", "kernel:lammps"]
COUNT = 6


@pytest.fixture
def judge(box, finished):
    """judge(off) compares six packings of the kernel with a code whose top force is 1 + off + noise times as large.

    The noise, 2 % rms and with a mean of zero, begins at 3 % strain: there chaos has parted the runs.
    """
    box = box.changed(("plateau = ", "strains = [0.02, 0.05]\nplateau = "))
    spread, noise = np.random.default_rng(7).normal(size=(2, COUNT))
    noise = 0.02 * (noise - noise.mean()) / noise.std()

    def run(k: int, factor, mutate):
        eps = box.strain(box.trajectory().series["time"])
        return mutate.series(box.trajectory(lambda e: 1 + (20 + spread[k]) * e), top_fy=lambda f: f * factor(eps))

    def judged(mutate, off=0.0, *, one_packing=False, respond=False):
        starts = [box.start(k) for k in range(COUNT)]
        if not one_packing:
            starts = [replace(s, system=kicked(s.system, s.number)) for s in starts]
        made = []
        for k in range(COUNT):
            made.append(finished("kernel:lammps", k, run(k, lambda e: 1.0 + 0 * e, mutate)))
            factor = lambda e, k=k: np.where(e > 0.03, 1.0 + off + noise[k], 1.0)  # noqa: E731
            made.append(finished("lammps", k, run(k, factor, mutate)))
        response = SimpleNamespace(
            engine="kernel:lammps kicked", of="kernel:lammps", trajectory=made[0].trajectory,
            outcome=SimpleNamespace(status="completed"),
        )
        return judge_biaxial(box.scene, starts, made, ENGINES, RERUN, response=response if respond else None)

    return judged


def by_quantity(checks, level="L3"):
    return {c.quantity: c for c in checks if c.level == level}


def test_equal_codes_agree_or_are_open_and_nothing_is_left_to_chaos(judge, mutate):
    checks, result = judge(mutate)
    found = by_quantity(checks)
    assert {c.verdict for c in found.values()} == {"agrees"}
    assert {"plateau sigma_zz", "sigma_zz at 5 % strain", "volume strain at 2 % strain"} <= set(found)
    assert "top-wall force, whole test" not in by_quantity(checks, "L2")
    assert len(result.judged) == len(found)


def test_a_difference_on_average_is_seen(judge, mutate):
    found = by_quantity(judge(mutate, off=0.2)[0])
    assert found["plateau sigma_zz"].verdict == "differs"
    assert found["plateau sigma_zz"].deviation == pytest.approx(0.2 / 1.1, rel=0.01)
    assert found["plateau sigma_zz"].why.endswith("--replicates 6")
    assert found["volume strain at 2 % strain"].verdict == "agrees"


def test_pairs_of_packings_see_what_independent_kicks_do_not(judge, mutate):
    """Six packings of spread 5 %: only where they are shared does it cancel."""
    paired = {j.tested.measured.quantity: j for j in judge(mutate)[1].judged}["plateau sigma_zz"]
    single = {j.tested.measured.quantity: j for j in judge(mutate, one_packing=True)[1].judged}["plateau sigma_zz"]
    assert (paired.tested.difference.paired, single.tested.difference.paired) == (True, False)
    assert paired.error < single.error
    assert paired.relative == pytest.approx(single.relative)


def test_a_response_is_followed_beside_the_first_packing(judge, mutate):
    checks, result = judge(mutate, respond=True)
    growth = by_quantity(checks, "L2")["top-wall force, growth of the difference"]
    assert growth.verdict == "differs"  # 2 % from one sample to the next are no chaos
    assert "kernel:lammps kicked" in result.growth


def test_rows_and_section_hold_the_same(judge, mutate):
    _, result = judge(mutate, off=0.2)
    rows = replicate_rows(result.judged)
    assert csv_text(rows).count("\n") == len(rows) + 1
    row = next(r for r in rows if r["quantity"] == "plateau sigma_zz")
    assert row["verdict"] == "differs"
    assert row["design"] == "paired"
    assert row["left, error of one run"] > 0
    assert row["difference"] == pytest.approx((row["left, mean"] - row["right, mean"]) / row["scale"])
    (section,) = replicate_sections(result.judged)
    assert len(section.rows) == len(rows)
    assert "Holm" in section.note
    assert replicate_sections(()) == []
