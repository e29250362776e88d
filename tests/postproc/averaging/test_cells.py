"""Every kind of cell keeps the same promises; each kind its own."""

import numpy as np
import pytest

from postproc.averaging.inner import Inner
from postproc.averaging.registry import CELLS, WrongSetting, make_cells
from postproc.geometry import particle_volumes
from postproc.snapshot import MissingColumn


@pytest.fixture(params=[(kind, dim) for kind in CELLS for dim in (2, 3)], ids=str)
def cells(request, states):
    kind, dim = request.param
    return make_cells(states.words(kind, dim), states.random_contacts(5, dim, count=150))


def test_every_kind_keeps_the_promises(cells):
    """Shapes, linearity, and the three averages' relations to each other."""
    n, k = cells.snapshot.particles.rows, len(cells.labels)
    q = np.random.default_rng(0).normal(size=(n, 3, 3))
    dim = cells.snapshot.dimension
    ones = np.ones(n)
    assert cells.volumes.shape == (k,)
    assert (cells.volumes > 0).all()
    assert cells.total(q).shape == cells.density(q).shape == cells.mean(q).shape == (k, 3, 3)
    np.testing.assert_allclose(cells.density(q) * cells.volumes[:, None, None], cells.total(q), rtol=1e-14)
    np.testing.assert_allclose(cells.mean(q) * cells.total(ones)[:, None, None], cells.total(q), rtol=1e-13)
    np.testing.assert_allclose(cells.total(2.0 * q + 1.0), 2.0 * cells.total(q) + cells.total(np.ones_like(q)))
    assert (cells.total(ones) >= 0).all()
    assert (cells.total(ones).sum() <= n).all()
    assert cells.largest(q[:, 0, 0]).shape == (k,)
    assert cells.gradient(q[:, 0, 0]).shape == (k, dim)
    assert cells.gradient(q[:, 0, :dim], ones).shape == (k, dim, dim)
    assert all(values.shape == (k,) for values in cells.coordinates.values())
    assert set(cells.coordinates) or len(cells.labels) <= 2


def test_box_and_particles_count_every_particle_once(states):
    state = states.random_contacts(3, 2, count=20)
    for kind in ("box", "particles"):
        assert make_cells(kind, state).total(np.ones(20)).sum() == 20


def test_particles_are_cells_of_their_own(states):
    state = states.random_contacts(3, 2)
    cells = make_cells("particles", state)
    assert cells.labels == tuple(str(k) for k in range(1, 10))
    np.testing.assert_array_equal(cells.density(particle_volumes(state)), np.ones(9))


def _grid(states, offset=(0.0, 0.0), n=10, **rest):
    """Centres on a unit grid shifted by `offset`, in a box n x n."""
    x = np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1).reshape(-1, 2) + np.asarray(offset)
    return states.snapshot(x=x, radius=np.full(n * n, 0.4), box=np.array([[0.0, n], [0.0, n]]), **rest)


def test_inner_takes_centres_inside_the_inset_box(states):
    cells = Inner(snapshot=_grid(states, (0.5, 0.5)), margin=2.0)
    assert cells.total(np.ones(100)).tolist() == [36.0]
    assert cells.volumes.tolist() == [36.0]
    assert cells.largest(np.arange(100.0)).tolist() == [77.0]


def test_inner_keeps_periodic_axes_whole(states):
    cells = Inner(snapshot=_grid(states, (-3.5, 0.5), periodic=(True, False)), margin=2.0)
    assert cells.total(np.ones(100)).tolist() == [60.0]
    assert cells.volumes.tolist() == [60.0]


def test_inner_volume_fraction_is_right_on_average(states):
    """Centre weights: exact on average over the place of the border, not for one place."""
    found = [
        Inner(snapshot=_grid(states, (a, b)), margin=1.75).density(np.full(100, np.pi * 0.16))[0]
        for a in np.arange(0.05, 1.0, 0.1) for b in np.arange(0.05, 1.0, 0.1)
    ]
    assert np.mean(found) == pytest.approx(np.pi * 0.16, rel=1e-12)
    assert np.ptp(found) > 0.01


def test_inner_default_margin_is_two_mean_diameters(states):
    assert Inner(snapshot=_grid(states)).bounds == pytest.approx(np.array([[1.6, 8.4], [1.6, 8.4]]))


def test_a_margin_that_leaves_nothing_is_no_cell(states):
    with pytest.raises(MissingColumn, match="nothing is left"):
        _ = Inner(snapshot=_grid(states), margin=5.0).volumes


def test_an_empty_cell_has_density_zero_and_no_mean(states):
    cells = Inner(snapshot=_grid(states, (20.0, 20.0)), margin=1.0)
    assert cells.density(np.ones(100)).tolist() == [0.0]
    assert np.isnan(cells.mean(np.ones(100))).all()
    assert np.isnan(cells.largest(np.ones(100))).all()


@pytest.mark.parametrize(("kind", "margin", "message"), [
    ("spheres", None, "expected one of box, inner, particles, rings, strips, grid, halfplane, points, got 'spheres'"),
    ("box", 0.1, "margin: expected none for cells of kind 'box', got 0.1"),
])
def test_wrong_settings_are_named(states, kind, margin, message):
    with pytest.raises(WrongSetting, match=message):
        make_cells(kind, _grid(states), margin=margin)
