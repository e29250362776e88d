"""The yield line of the cohesion study, on plateaus made from a known angle and cohesion."""

import math

import numpy as np
import pytest

from harness.studies.reproduce.boxes import SIDE
from harness.studies.reproduce.cohesion import declared, lines
from harness.studies.reproduce.rows import over_packings
from postproc.macro.fits.yield_locus import mohr_coulomb
from reference.values import published_values

PHI, C = 13.0, 40.0


def plateau(side: float, phi: float = PHI, c: float = C) -> dict[str, float]:
    """sigma_1 = K sigma_3 + 2 c sqrt(K)."""
    K = math.tan(math.radians(45.0 + phi / 2.0)) ** 2
    return {SIDE: side, declared.PLATEAU: K * side + 2.0 * c * math.sqrt(K)}


def test_a_known_line_comes_back(box_run):
    angle, c = lines.two_point_line(box_run(plateau(101.0)), box_run(plateau(498.0)))
    assert angle == pytest.approx(PHI, abs=1e-12)
    assert c == pytest.approx(C, abs=1e-11)


@pytest.mark.parametrize("wrong", [
    lambda low, high: mohr_coulomb(np.array(declared.PRESSURES), high),      # p_x in place of the measured stress
    lambda low, high: mohr_coulomb(np.array([1e-12, low[1]]), np.array([1e-12, high[1]])),  # through the origin
])
def test_mutants_give_another_line(wrong):
    side = np.array([101.0, 498.0])
    axial = np.array([plateau(s)[declared.PLATEAU] for s in side])
    line = wrong(side, axial)
    assert abs(line.cohesion.value - C) > 0.1


def test_no_line_is_no_number(box_run):
    falling = lines.two_point_line(
        box_run({SIDE: 100.0, declared.PLATEAU: 300.0}), box_run({SIDE: 500.0, declared.PLATEAU: 200.0})
    )
    assert np.isnan(falling).all()


def test_pairs_are_made_packing_by_packing(box_run, made):
    duration = 0.08
    runs = [
        made(declared.case_name(p, "1", duration, memory=False), "e", k, box_run(plateau(p, c=C + k)))
        for p in declared.PRESSURES for k in (0, 1, 2)
    ]
    line = lines.yield_lines(runs[:-1], "e", "1", duration, memory=False)  # packing 2 has no partner
    assert line["cohesion"].values == pytest.approx((C, C + 1.0), abs=1e-10)
    assert line["angle"].values == pytest.approx((PHI, PHI), abs=1e-11)


def test_pull_is_that_of_the_law():
    """f_min/delta_max = k_c (k_2 - k_1)/(k_2 + k_c), delta_min k_c of the talk's law."""
    k_1, k_2 = 5e4, 1e5
    for name, ratio in declared.RATIOS.items():
        k_c = ratio * k_2
        assert lines.pull(name) == pytest.approx(k_c * (k_2 - k_1) / (k_2 + k_c), abs=1e-9)


def test_slope_of_the_cohesion():
    found = {
        ("e", r): {"cohesion": over_packings("e", [s * lines.pull(r) for s in (1.7e-3, 1.9e-3)])}
        for r in declared.RATIOS
    }
    assert lines.slope(found, "e").values == pytest.approx((1.7e-3, 1.9e-3), rel=1e-12)


def test_the_decoded_table_is_that_of_the_talk():
    """The two plateaus that the talk prints give the cohesion that it prints, to two digits, and about 13 degrees."""
    values = published_values()
    angles = []
    for ratio in declared.RATIOS:
        key = declared.value_key(ratio)
        low, high = (values[f"talk_cohesion_{p:g}_{key}"].value for p in declared.PRESSURES)
        line = mohr_coulomb(np.array(declared.PRESSURES), np.array([low, high]))
        assert line.cohesion.value == pytest.approx(values[f"talk_macro_cohesion_{key}"].value, abs=1.0)
        assert line.angle.value == pytest.approx(values[f"talk_macro_angle_{key}"].value, abs=0.01)
        angles.append(line.angle.value)
    assert np.mean(angles) == pytest.approx(values["talk_geometrical_angle"].value, abs=0.2)


def test_ten_tests_and_another_preparation(ask):
    planned = declared.cases(ask("paper"))
    main = declared.main_cases(ask("paper"))
    assert len(main) == 15
    assert main == planned[:15]
    at_px = [c for c in main if declared.MEMORY not in c.name]
    assert len(at_px) == 10
    assert all(c.scene.preparation.pressure == c.scene.side.pressure for c in at_px)
    assert {c.scene.preparation.pressure for c in main if c not in at_px} == {500.0}
    assert {c.scene.particles.count for c in planned} == {1950}
    assert all(c.scene.contact.sliding is None for c in planned)
