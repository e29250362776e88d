"""Figures: labels of logarithmic axes that leave each other room."""

import pytest

from harness.report import figures


def labels(low, high, width=3.0):
    """Return the extents in pixels of the labels of a logarithmic axis, laid out for a figure of this width."""
    figure, ((axes,),) = figures.new_figure(1, 1, width=width, height=2.0)
    axes.plot([low, high], [low, high])
    axes.set_xscale("log")
    figures.png_bytes(figure, dpi=100)
    texts = [t for t in (*axes.get_xticklabels(), *axes.get_xticklabels(minor=True)) if t.get_text()]
    boxes = [t.get_window_extent() for t in texts]
    inside = axes.get_window_extent()
    return sorted((b.x0, b.x1) for b in boxes if inside.x0 - 1 <= (b.x0 + b.x1) / 2 <= inside.x1 + 1)


@pytest.mark.parametrize(("low", "high"), [
    (40.0, 500.0), (40.0, 90.0), (2.2, 3.4), (1.0, 1.5), (1e-5, 4e-5), (1e-4, 9e-3), (1e-6, 1.0),
])
def test_labels_of_a_logarithmic_axis_do_not_touch(low, high):
    found = labels(low, high)
    assert len(found) >= 2
    assert all(left[1] < right[0] for left, right in zip(found, found[1:], strict=False))


def test_labels_that_a_figure_chose_stay():
    figure, ((axes,),) = figures.new_figure(1, 1, width=3.0, height=2.0)
    axes.set_xscale("log")
    axes.set_xlim(1.0, 8.0)
    axes.set_xticks([3.0, 4.0], ["three", "four"])
    figures.png_bytes(figure, dpi=50)
    assert [t.get_text() for t in axes.get_xticklabels()] == ["three", "four"]
    assert not any(t.get_text() for t in axes.get_xticklabels(minor=True))
