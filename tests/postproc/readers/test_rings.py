"""Rings among the walls: exact places, rows of two kinds side by side, names of glued discs."""

from pathlib import Path

import numpy as np
import pytest

from postproc.readers.check import check_snapshot
from postproc.readers.rings import GluedRing, name_rings, ring_series, with_glued_discs, with_ring_rows
from postproc.readers.walls import box_from_walls
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import ReadError

PARTICLES = Columns({"id": [1, 2], "x": [0.0, 5.0], "y": [0.0, 1.0], "radius": [0.5, 0.6]}, "particles")
TABLE = Columns({"mill_torque": [1.0, 2.0], "mill_fx": [3.0, 4.0], "mill_fy": [5.0, 6.0]}, "series")
PLANES = Columns(
    {"id": [1.0], "px": [0.0], "py": [0.0], "nx": [1.0], "ny": [0.0], "fx": [-7.0], "fy": [0.0]}, "walls"
)


@pytest.fixture
def mill():
    """Two discs on a circle about (1, 2) that makes a quarter turn in 0.5 s, clockwise."""
    return GluedRing(
        index=2, name="mill", centre=(1.0, 2.0), circle=3.0, x=np.array([[4.0, 2.0], [1.0, 5.0]]),
        radius=np.array([0.1, 0.2]), omega=-np.pi,
    )


def test_a_quarter_turn(mill):
    np.testing.assert_array_equal(mill.places(0.0), mill.x)
    np.testing.assert_allclose(mill.places(0.5), [[1.0, -1.0], [4.0, 2.0]], atol=1e-15)
    np.testing.assert_allclose(ring_series([mill], np.array([0.0, 0.5]))["mill_angle"], [0.0, -np.pi / 2])


def test_glued_discs_are_the_bodies_behind_the_particles(mill):
    bodies = with_glued_discs(PARTICLES, [mill], 0.5)
    np.testing.assert_allclose(bodies.vector("x", "y"), [[0, 0], [5, 1], [1, -1], [4, 2]], atol=1e-15)
    assert bodies["radius"].tolist() == [0.5, 0.6, 0.1, 0.2]
    assert with_glued_discs(PARTICLES, [], 0.5) is PARTICLES
    assert name_rings(np.array([2, 3, 1, 4]), 2, [mill]).tolist() == [2, -2, 1, -2]


def test_rings_alone_have_no_normals_and_bound_no_box(mill):
    walls = with_ring_rows(None, [mill], TABLE, 1)
    expected = {"id": 2, "px": 1, "py": 2, "radius": 3, "torque": 2, "fx": 4, "fy": 6}
    assert {c: v.tolist() for c, v in walls.items()} == {c: [v] for c, v in expected.items()}
    assert box_from_walls(walls, 2) is None
    assert with_ring_rows(None, [], TABLE, 1) is None


def test_beside_planes_each_lacks_what_the_other_has(mill):
    walls = with_ring_rows(PLANES, [mill], TABLE, 0)
    nan = np.nan
    expected = {"id": [1, 2], "px": [0, 1], "py": [0, 2], "nx": [1, nan], "ny": [0, nan], "fx": [-7, 3], "fy": [0, 5],
                "radius": [nan, 3], "torque": [nan, 1]}
    assert set(walls) == set(expected)
    for column, values in expected.items():
        np.testing.assert_array_equal(walls[column], values)
    frame = Snapshot(time=0.0, dimension=2, particles=PARTICLES, walls=walls)
    assert check_snapshot(Path("f"), frame) is frame
    broken = Columns(dict(walls) | {"fx": [nan, 3.0]}, "walls")
    with pytest.raises(ReadError, match=r"walls\.fx: row 1: expected a finite number, got nan"):
        check_snapshot(Path("f"), Snapshot(time=0.0, dimension=2, particles=PARTICLES, walls=broken))
