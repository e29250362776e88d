"""Friction angles from stresses with known angles."""

import math

import numpy as np
import pytest

from harness.studies.reproduce import friction


def ratio(degrees: float) -> float:
    return math.tan(math.radians(45.0 + degrees / 2.0)) ** 2


SIDE = np.array([100.0, 200.0, 500.0])


def test_lines_give_their_angle():
    assert friction.slope_angle(SIDE, ratio(27.0) * SIDE + 30.0) == pytest.approx(27.0, abs=1e-10)
    assert friction.origin_angle(SIDE, ratio(31.0) * SIDE) == pytest.approx(31.0, abs=1e-10)


def test_a_line_with_an_offset_has_two_angles():
    axial = ratio(27.0) * SIDE + 30.0
    assert friction.origin_angle(SIDE, axial) > 27.5


def test_angles_of_both_frictions_are_told_apart(box_run, made):
    duration, runs = 0.06, []
    for mu, angle in ((0.5, 27.0), (0.0, 13.0)):
        for p in SIDE:
            for k in (0, 1):
                a = angle + k
                numbers = {
                    "plateau sigma_zz": ratio(a) * p, "plateau sigma_xx": p,
                    **({"peak sigma_zz": ratio(a + 5) * p, "peak stress ratio": ratio(a + 5)} if mu else {}),
                }
                runs.append(made(friction._name(mu, p, duration), "e", k, box_run(numbers)))
    found = friction.box_angles(runs, "e", SIDE, duration)
    assert found["internal"].values == pytest.approx((32.0, 33.0), abs=1e-9)
    assert found["total"].values == pytest.approx((32.0, 33.0), abs=1e-9)
    assert found["plateau, slope"].values == pytest.approx((27.0, 28.0), abs=1e-9)
    assert found["geometrical"].values == pytest.approx((13.0, 14.0), abs=1e-9)


def test_a_packing_without_a_peak_has_no_internal_angle(box_run, made):
    runs = [made(friction._name(0.5, p, 0.06), "e", 0, box_run({"plateau sigma_zz": 2 * p, "plateau sigma_xx": p}))
            for p in SIDE]
    found = friction.box_angles(runs, "e", SIDE, 0.06)
    assert "internal" not in found
    assert found["plateau, slope"].packings == 1


def test_without_friction_there_is_no_sliding_law(ask):
    for case in friction.cases(ask("quick")):
        assert (case.scene.contact.sliding is None) == case.name.startswith("mu = 0,")
