"""How two runs part: exact differences, periodic images, what cannot be compared."""

from dataclasses import replace

import numpy as np
import pytest

from harness.studies.compare.growth import (
    column_deviation,
    difference_growth,
    displacement_deviation,
    nearest_image,
)
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory

SIDE = 10.0


def run(*frames, far: float = 0.0, **columns) -> Trajectory:
    """Frames of two discs of radius 0.5 with places given as ((x1, y1), (x2, y2))."""
    snapshots = []
    for k, places in enumerate(frames):
        x = np.array(places, dtype=float)
        table = {"id": [1, 2], "x": x[:, 0] + far, "y": x[:, 1], "radius": [0.5, 0.5]}
        table |= {name: values[k] for name, values in columns.items()}
        snapshots.append(Snapshot(time=0.1 * k, dimension=2, particles=Columns(table, "particles")))
    return Trajectory(frames=tuple(snapshots), steps=tuple(range(len(frames))), series=None)


STILL = ((0, 0), (3, 0))


def test_growth_is_the_rms_over_the_diameter():
    a, b = run(STILL, STILL, STILL), run(STILL, ((0.3, 0.4), (3, 0)), ((0.3, 0.4), (3.3, -0.4)))
    growth = difference_growth(a, b)
    assert growth.time == pytest.approx([0.0, 0.1, 0.2])
    assert growth.difference == pytest.approx([0.0, 0.5 / np.sqrt(2), 0.5], abs=1e-15)


def test_displacement_counts_from_the_start():
    """One disc moves by 2 and by 2.002: one part in a thousand, wherever the origin is."""
    for far in (0.0, 1e6):
        a, b = (run(STILL, ((end, 0), (3, 0)), far=far) for end in (2.0, 2.002))
        assert displacement_deviation(a, b) == pytest.approx(0.002 / 2.002, rel=1e-6)


def test_what_never_moves_has_no_deviation_unless_the_starts_differ():
    assert displacement_deviation(run(STILL, STILL), run(STILL, STILL)) is None
    other = ((0.1, 0), (3, 0))
    assert displacement_deviation(run(STILL, ((1, 0), (3, 0))), run(other, ((1.1, 0), (3, 0)))) > 0.09


def test_a_place_that_is_no_number_is_never_lost():
    bad = run(STILL, ((np.nan, 0), (3, 0)))
    for pair in ((run(STILL, STILL), bad), (bad, run(STILL, STILL)), (bad, bad)):
        assert np.isnan(displacement_deviation(*pair))


def test_periodic_images_are_the_same_place():
    """One engine folds a disc back at x = 10, the other lets it go on: nothing parts."""
    a = run(((9.8, 0), (3, 0)), ((9.9, 0), (3, 0)), ((10.2, 0), (3, 0)))
    b = run(((9.8, 0), (3, 0)), ((9.9, 0), (3, 0)), ((0.2, 0), (3, 0)))
    assert displacement_deviation(a, b, (SIDE, 0.0)) == pytest.approx(0.0, abs=1e-14)
    assert difference_growth(a, b, (SIDE, 0.0)).difference == pytest.approx(np.zeros(3), abs=1e-14)
    assert displacement_deviation(a, b) > 1


def test_nearest_image_leaves_open_axes_alone():
    apart = np.array([[9.0, 9.0], [-6.0, -6.0], [4.0, 4.0]])
    assert np.array_equal(nearest_image(apart, (SIDE, 0.0)), [[-1.0, 9.0], [4.0, -6.0], [4.0, 4.0]])
    assert nearest_image(apart, None) is apart


def test_columns_are_compared_over_their_largest_size():
    a = run(STILL, STILL, vx=[[1.0, 0.0], [0.5, 0.2]], vy=[[0.0, 0.0], [0.0, 0.0]])
    b = run(STILL, STILL, vx=[[1.0, 0.0], [0.5, 0.25]], vy=[[0.0, 0.0], [0.0, 0.0]])
    assert column_deviation(a, b, ("vx", "vy", "vz")) == pytest.approx(0.05)
    assert column_deviation(a, b, ("vy",)) is None
    assert column_deviation(a, b, ("wz",)) is None


def test_a_column_that_is_no_number_is_never_lost():
    a, b = run(STILL, vx=[[0.0, 0.0]]), run(STILL, vx=[[0.0, np.nan]])
    assert np.isnan(column_deviation(a, b, ("vx",)))
    assert np.isnan(column_deviation(b, a, ("vx",)))


@pytest.mark.parametrize("compare", [
    difference_growth, displacement_deviation, lambda a, b: column_deviation(a, b, ("x",)),
])
def test_frames_of_other_steps_are_not_compared(compare):
    a = run(STILL, STILL)
    with pytest.raises(ValueError, match="different steps"):
        compare(a, replace(a, steps=(0, 2)))
