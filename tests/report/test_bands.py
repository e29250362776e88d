"""Bands over replicates, and the panels that show them."""

import numpy as np
import pytest

from harness.report.bands import Band, band_over
from harness.report.panels import counted, draw_bands, panel
from harness.report.wall_bands import band_rows


def test_the_band_is_mean_and_standard_error():
    x = np.linspace(0.0, 1.0, 5)
    band = band_over([x] * 3, [x - 1.0, x, x + 1.0])
    assert band.count == 3
    assert band.mean == pytest.approx(x)
    assert band.error == pytest.approx(np.full(5, 1.0 / np.sqrt(3.0)))


def test_one_curve_has_no_error():
    x = np.arange(3.0)
    assert band_over([x], [x]).error is None


def test_samples_elsewhere_are_interpolated_and_never_invented():
    band = band_over([np.array([0.0, 1.0, 2.0]), np.array([0.5, 1.5])], [np.zeros(3), np.array([1.0, 3.0])])
    assert band.mean[1] == pytest.approx(1.0)
    assert np.isnan(band.mean[[0, 2]]).all()


def test_a_band_is_drawn_only_where_there_is_an_error():
    x = np.arange(3.0)
    seen = []

    def draw(axes):
        bands = {"a": Band(place=x, mean=x, error=x, count=2), "b": Band(place=x, mean=x, error=None, count=1)}
        draw_bands(axes, bands, x="strain", y="a long name " * 5, scale=(100, 2))
        seen.append(axes)

    figure = panel(draw, "caption")
    (axes,) = seen
    assert figure.panel
    assert len(axes.collections) == 1
    assert axes.lines[0].get_xydata().tolist() == [[0, 0], [100, 2], [200, 4]]
    assert max(map(len, axes.get_ylabel().split("\n"))) <= 34
    assert [t.get_text() for t in axes.get_legend().get_texts()] == ["a", "b"]


@pytest.mark.parametrize(("counts", "said"), [
    ((1, 1), "One packing, hence no bands."), ((3, 3), "n = 3."), ((1, 3), "n = 1 to 3; a single curve has none."),
])
def test_what_a_band_is_of_is_said(counts, said):
    x = np.arange(2.0)
    assert counted({str(k): Band(place=x, mean=x, error=None, count=n) for k, n in enumerate(counts)}).endswith(said)


def test_bands_are_rows_with_units_in_their_columns():
    x = np.array([0.0, 0.5])
    many = {"a": Band(place=x, mean=x + 1, error=x + 0.1, count=3), "b": Band(place=x, mean=x, error=None, count=1)}
    rows = band_rows({"force": many, "ratio": many}, {"force": "N", "ratio": "1"}, "time (s)")
    assert rows[1] == {
        "engine": "a", "time (s)": 0.5, "replicates": 3, "force, mean (N)": 1.5, "force, standard error (N)": 0.6,
        "ratio, mean": 1.5, "ratio, standard error": 0.6,
    }
    assert [(r["engine"], r["time (s)"]) for r in rows] == [("a", 0.0), ("a", 0.5), ("b", 0.0), ("b", 0.5)]
    assert rows[2]["force, standard error (N)"] is None
