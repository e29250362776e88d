"""Numbers of two reports: to where curves are the same, and by how much quantities moved."""

import numpy as np
import pytest

from harness.report.numbers import FOLLOWED, curve_changes, macro_changes

UNTIL = f"same within {FOLLOWED:g} up to"


def rows(engine, values, **columns):
    return [{"engine": engine, "strain": 0.1 * k, "force": v, **columns} for k, v in enumerate(values)]


def test_the_same_numbers_are_the_same_to_the_end():
    same = {"curves": rows("a", [1.0, 2.0, 3.0])}
    (row,) = curve_changes(same, same, {})
    assert (row["largest in"], row["difference over largest"], row[UNTIL]) == (None, 0.0, "the end")


def test_where_curves_part_is_found_and_measured_over_the_largest_value():
    old = rows("a", [1.0, 2.0, 4.0, 2.0]) + rows("b", [1.0])
    new = rows("a", [1.0, 2.0 * (1 + 1e-12), 4.0 - 1e-6, 2.5]) + rows("b", [2.0]) + rows("c", [1.0])
    a, b = curve_changes({"curves": old}, {"curves": new}, {})
    assert (a["engine"], a["samples"], a["largest in"]) == ("a", 4, "force")
    assert a["difference over largest"] == pytest.approx(0.5 / 4.0)
    assert a[UNTIL] == "strain 0.1"
    assert (b["difference over largest"], b[UNTIL]) == (0.5, "nowhere")


def test_a_number_that_is_gone_is_a_difference_and_two_that_never_were_are_none():
    old, new = rows("a", [1.0, None, None]), rows("a", [1.0, None, 3.0])
    (row,) = curve_changes({"curves": old}, {"curves": new}, {})
    assert row["difference over largest"] == 1.0
    assert row[UNTIL] == "strain 0.1"


def test_other_samples_and_words_are_not_compared():
    (row,) = curve_changes({"curves": rows("a", [1.0])}, {"curves": rows("a", [1.0, 2.0])}, {})
    assert row[UNTIL] == "not comparable: 1 samples before"
    assert row["difference over largest"] is None
    words = [{"engine": "a", "word": "x"}]
    (row,) = curve_changes({"t": words}, {"t": words}, {})
    assert row[UNTIL] == "nothing to compare"
    assert curve_changes({"runs": rows("a", [1.0])}, {"runs": rows("a", [2.0])}, {}) == []
    assert curve_changes({}, {"curves": rows("a", [2.0])}, {}) == []


def test_without_a_place_rows_are_counted():
    old, new = ([{"engine": "a", "vx (m/s)": v} for v in of] for of in ((1.0, 2.0), (1.0, 3.0)))
    (row,) = curve_changes({"exits": old}, {"exits": new}, {})
    assert row[UNTIL] == "row 1 of 2"


def test_an_engine_under_another_name_is_found():
    (row,) = curve_changes({"c": rows("a@1", [1.0])}, {"c": rows("a", [1.0])}, {"a@1": "a"})
    assert (row["engine"], row["difference over largest"]) == ("a", 0.0)


def macro(mean, deviation=None, packings=1, **facts):
    return {"quantity": "peak", "unit": "N/m", "engine": "a", "mean": mean, "standard deviation": deviation,
            "packings": packings, **facts}


def test_a_quantity_that_moved_is_shown_with_the_error_of_its_difference():
    (row,) = macro_changes({"macro": [macro(100.0, 3.0, 9)]}, {"macro": [macro(103.0, 4.0, 4)]}, {})
    assert (row["quantity"], row["old"], row["new"], row["new - old"]) == ("peak (N/m)", 100.0, 103.0, 3.0)
    assert row["its standard error"] == pytest.approx(np.hypot(1.0, 2.0))
    assert (row["packings, old"], row["packings, new"]) == (9, 4)


def test_without_packings_there_is_no_error_and_rounding_is_no_change():
    (row,) = macro_changes({"macro": [macro(1.0)]}, {"macro": [macro(2.0, 0.1, 3)]}, {})
    assert row["its standard error"] is None
    assert macro_changes({"macro": [macro(1.0)]}, {"macro": [macro(1.0 + 1e-12)]}, {}) == []
    (row,) = macro_changes({"macro": [macro(None)]}, {"macro": [macro(1.0)]}, {})
    assert (row["old"], row["new - old"]) == (None, None)
    assert macro_changes({}, {"macro": [macro(1.0)]}, {}) == []
