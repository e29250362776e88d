"""Packings for timing: dense, at rest, inside their box, the same every time."""

import numpy as np
import pytest

from harness.studies.bench import packing as module
from harness.studies.bench.packing import BenchPacking, bench_packing, grid


@pytest.mark.parametrize(("dimension", "walls"), [(2, True), (2, False), (3, True), (3, False)])
def test_a_packing_is_dense_and_at_rest(tmp_path, dimension, walls):
    packing = bench_packing(dimension, 60, walls=walls, cache=tmp_path)
    assert packing.x.shape == (60, dimension)
    assert packing.fraction == pytest.approx(module.FRACTION[dimension])
    assert ((packing.x > 0) & (packing.x < packing.box)).all()
    assert packing.unbalanced < 1e-3
    isostatic = dimension * (1 - 0.25)  # contacts a particle of a stable frictionless packing, rattlers left out
    assert packing.contacts > isostatic


def test_discs_are_numbered_along_the_grid(tmp_path):
    packing = bench_packing(2, 100, walls=True, cache=tmp_path)
    steps = np.linalg.norm(np.diff(packing.x, axis=0), axis=1)
    assert np.median(steps) < 3.0


def test_a_large_packing_is_put_together_and_rests(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "TILE", 50)
    tile = bench_packing(2, 50, walls=True, cache=tmp_path)
    packing = bench_packing(2, 200, walls=True, cache=tmp_path)
    assert np.array_equal(packing.radius, np.tile(tile.radius, 4))
    assert packing.fraction == pytest.approx(tile.fraction, rel=0.02)
    assert packing.contacts == pytest.approx(tile.contacts, rel=0.1)
    assert packing.unbalanced < 0.1
    assert ((packing.x > 0) & (packing.x < packing.box)).all()


def test_repetitions_of_a_periodic_packing_are_in_balance_at_once(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "TILE", 50)
    monkeypatch.setattr(module, "SEAM_STEPS", 0)
    tile = bench_packing(2, 50, walls=False, cache=tmp_path)
    packing = bench_packing(2, 200, walls=False, cache=tmp_path)
    assert packing.contacts == pytest.approx(tile.contacts)
    assert packing.unbalanced == pytest.approx(tile.unbalanced, rel=1e-6, abs=1e-9)


def test_mirror_images_press_as_hard_as_the_wall_did():
    """One disc in a box: pushed by d into all walls; a row of images overlaps by d where 2 d would have been."""
    disc = BenchPacking(x=np.array([[0.9, 0.9]]), radius=np.array([1.0]), box=np.array([1.8, 1.8]),
                        contacts=4.0, unbalanced=0.0)
    x, _, box = module._put_together(disc, 3, mirrored=True)
    assert np.diff(np.sort(x.max(axis=1))) == pytest.approx([1.9, 1.9])
    assert sorted(box) == pytest.approx([1.8, 1.8 + 2 * 1.9])


def test_the_same_packing_every_time_and_a_damaged_file_is_made_again(tmp_path, caplog):
    first = bench_packing(2, 40, walls=True, cache=tmp_path)
    (file,) = tmp_path.iterdir()
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])
    again = bench_packing(2, 40, walls=True, cache=tmp_path)
    assert "made again" in caplog.text
    assert np.array_equal(first.x, again.x)
    assert np.array_equal(bench_packing(2, 40, walls=True, cache=tmp_path).x, first.x)


@pytest.mark.parametrize("count", [1, 7, 100, 2000, 20_000, 100_000])
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_grid_has_as_many_places_as_particles(count, dimension):
    assert np.prod(grid(count, dimension)) == count
    assert len(grid(count, dimension)) == dimension


def test_a_grid_is_as_square_as_can_be():
    assert grid(20_000, 2) == (125, 160)
    assert grid(1000, 3) == (10, 10, 10)
