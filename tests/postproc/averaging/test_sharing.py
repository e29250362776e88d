"""All kinds of cells that cut particles: every particle is shared out whole, every total is kept, tiles are exact."""

import numpy as np
import pytest

from postproc.average import average
from postproc.averaging.registry import WrongSetting, make_cells
from postproc.averaging.strips import Strips
from postproc.geometry import particle_volumes
from postproc.macro.contact_ends import contact_ends, outer
from postproc.snapshot import Columns, MissingColumn

WEIGHTS = ("area", "centre")
COMPLETE = {
    2: ("strips:x:7", "strips:y:1", "grid:5x3", "grid:64x64", "halfplane:1,0.3:0.4", "rings:60", "rings:1"),
    3: ("strips:z:7", "grid:5x3x2", "halfplane:1,0.3,2:0.4", "rings:9"),
}
"""Cells that cover a crowd between ring walls in a box."""


def ring_walls(dim, *radii, centre=(0.0, 0.0)):
    place = dict(zip(("px", "py", "pz"), (np.full(len(radii), c) for c in (*centre, 0.0)), strict=True))
    force = {"f" + a: np.zeros(len(radii)) for a in "xyz"[:dim]}
    middle = {k: place[k] for k in ("px", "py", "pz")[:dim]}
    return {"id": np.arange(len(radii)) + 1, **middle, **force, "radius": radii}


def crowd(states, dim, seed=0, count=400, inner=0.2, outer=2.0):
    """Particles of very different sizes between two rings; some overlap a ring, some are larger than a cell."""
    rng = np.random.default_rng(seed)
    radius = rng.uniform(0.01, 0.19, count)
    r = rng.uniform(inner + 0.7 * radius, outer - 0.7 * radius)
    r[:2] = inner + 1e-12, outer - 0.51 * radius[1]
    radius[0] = 1e-13  # as small as it gets
    angle = rng.uniform(0, 2 * np.pi, count)
    x = np.column_stack([r * np.cos(angle), r * np.sin(angle), rng.uniform(-1, 1, count)])[:, :dim]
    pairs = np.array([(a, b) for a in range(0, count, 2) for b in (a + 1,)]) + 1
    force = rng.normal(size=(len(pairs), dim))
    box = np.array([[-outer, outer], [-outer, outer], [-1.0, 1.0]])[:dim]
    return states.snapshot(
        x=x, radius=radius, box=box, i=pairs[:, 0], j=pairs[:, 1], force=force,
        point=(x[pairs[:, 0] - 1] + x[pairs[:, 1] - 1]) / 2, walls=ring_walls(dim, inner, outer),
        extra={"particles": {"mass": rng.uniform(1, 2, count), **states.columns("v", rng.normal(size=(count, dim)))}},
    )


@pytest.fixture(params=[(dim, kind, w) for dim in (2, 3) for kind in COMPLETE[dim] for w in WEIGHTS], ids=str)
def complete(request, states):
    dim, kind, weights = request.param
    return make_cells(kind, crowd(states, dim), weights=weights, frame="cartesian")


def test_every_particle_is_shared_out_whole(complete):
    e = complete.entries
    shared = np.bincount(e.particle, weights=e.weight, minlength=complete.snapshot.particles.rows)
    np.testing.assert_allclose(shared, 1.0, rtol=0, atol=1e-12)
    assert (e.weight > 0).all()
    assert (np.diff(e.cell) >= 0).all()


def test_mass_momentum_and_stress_add_up_to_the_totals(complete):
    snapshot = complete.snapshot
    m, v = snapshot.particles["mass"], snapshot.particles.vector(*("v" + a for a in snapshot.axes))
    ends = contact_ends(snapshot)
    for q in (m, m[:, None] * v, particle_volumes(snapshot)):
        np.testing.assert_allclose(complete.total(q).sum(axis=0), q.sum(axis=0), rtol=1e-12, atol=1e-12)
    virial = outer(ends.l, ends.f)
    found = complete.contact_density(ends, virial) * complete.volumes[:, None, None]
    np.testing.assert_allclose(found.sum(axis=0), virial.sum(axis=0), rtol=1e-12, atol=1e-12)


def test_volumes_add_up_to_the_sample(complete):
    name, snapshot = type(complete).__name__, complete.snapshot
    annulus = np.pi * (2.0**2 - 0.2**2) * (1.0 if snapshot.dimension == 2 else 2.0)
    box = 16.0 if snapshot.dimension == 2 else 32.0
    assert complete.volumes.sum() == pytest.approx(annulus if name == "Rings" else box, rel=1e-14)


@pytest.mark.parametrize("dim", [2, 3])
def test_area_weights_say_where_the_area_is(states, dim):
    """Fractions of the box below a line, summed from random points in the particles: an independent count."""
    state = crowd(states, dim, count=60)
    rng = np.random.default_rng(1)
    points = rng.uniform(-1, 1, (40000, dim))
    points = points[(points**2).sum(axis=1) < 1]
    x, a = state.particles.vector(*state.axes), state.particles["radius"]
    places = x[:, None] + a[:, None, None] * points  # (N, points, dim)
    r = np.hypot(places[..., 0], places[..., 1])
    expected = {
        "strips:x:-0.5,0.1,0.3": (places[..., 0] >= 0.1) & (places[..., 0] < 0.3),
        "rings:0.5,1,1.2": (r >= 1.0) & (r < 1.2),
        "grid:4x4" if dim == 2 else "grid:4x4x2":
            ((places >= 0) & (places < np.array([1.0, 1.0, 1.0])[:dim])).all(axis=-1),
    }
    for kind, inside in expected.items():
        cells = make_cells(kind, state, frame="cartesian")
        row = {"strips": 1, "rings": 1, "grid": cells.labels.index(" ".join(["3", "3", "2"][:dim]))
               if kind.startswith("grid") else 0}[kind.split(":")[0]]
        weights = np.bincount(*_of_cell(cells, row), minlength=60)
        np.testing.assert_allclose(weights, inside.mean(axis=1), atol=0.02)
        assert weights.max() > 0.5


def _of_cell(cells, row):
    e = cells.entries
    chosen = e.cell == row
    return e.particle[chosen], e.weight[chosen]


@pytest.mark.parametrize("kind", ["square", "triangular"])
@pytest.mark.parametrize("cells", ["strips:x:4", "strips:y:4", "strips:x:16", "grid:4x4", "box"])
def test_tiles_of_a_lattice_are_all_like_the_lattice(states, kind, cells):
    """Cells that are whole periods of the lattice have its closed-form values, each of them."""
    if cells == "strips:x:16":  # quarters of a period: four neighbours make one
        state = states.lattice(kind)
        found = average(state, cells=cells)["stress"].reshape(4, 4, 2, 2).mean(axis=1)
    else:
        state = states.lattice(kind)
        found = average(state, cells=cells)["stress"]
    spacing, force = 2 * states.R * (1 - 1e-3), states.KN * 2 * states.R * 1e-3
    pressure = (np.sqrt(3) if kind == "triangular" else 1.0) * force / spacing
    np.testing.assert_allclose(found, np.broadcast_to(pressure * np.eye(2), found.shape), atol=1e-11 * pressure)


@pytest.mark.parametrize("cells", ["strips:x:4", "strips:y:8", "grid:4x4", "grid:8x4", "box"])
def test_lattice_cells_of_half_a_period_mirror_each_other(states, cells):
    """The square lattice, shifted by any vector, has the same nu in cells of whole periods, to round-off."""
    lattice = states.lattice("square")
    whole = average(lattice)["volume_fraction"][0]
    for shift in (0.0, 0.1e-3, 0.777e-3):
        particles = {**lattice.particles, "x": lattice.particles["x"] + shift, "y": lattice.particles["y"] - 3 * shift}
        found = average(states.replace(lattice, particles=particles), cells=cells)["volume_fraction"]
        if cells.endswith(("8", "8x4")):
            found = found.reshape(-1, 2) if cells == "strips:y:8" else found.reshape(4, 2, 4).swapaxes(1, 2)
            found = found.mean(axis=-1)
        np.testing.assert_allclose(found, whole, rtol=1e-12)


def test_inner_by_area_of_a_lattice_is_the_lattice(states):
    """Cut by its own border between rows of discs, and right through them, unlike centre weights."""
    lattice = states.replace(states.lattice("square", repeats=6), periodic=(False, False))
    spacing = 2 * states.R * (1 - 1e-3)
    lattice = states.replace(lattice, box=lattice.box - spacing / 2)
    expected = np.pi * states.R**2 / spacing**2
    for margin in (spacing, 1.5 * spacing, 0.25 * spacing + 1e-3):
        found = make_cells("inner", lattice, margin=margin, weights="area").density(particle_volumes(lattice))[0]
        if margin in (spacing, 1.5 * spacing):
            assert found == pytest.approx(expected, rel=1e-12)
        else:
            assert found == pytest.approx(expected, rel=0.2)


def test_circles_of_discs_have_closed_form_polar_stress(states):
    """Discs pressed together along a circle: an arch, sigma_phiphi > 0, all of it in the ring that holds it."""
    n, force, R = 40, 3.0, 1.0
    angle = 2 * np.pi * np.arange(n) / n
    x = R * np.column_stack([np.cos(angle), np.sin(angle)])
    a = R * np.sin(np.pi / n)
    nxt = np.roll(np.arange(n), -1)
    normal = (x - x[nxt]) / np.linalg.norm(x - x[nxt], axis=1)[:, None]
    state = states.snapshot(
        x=x, radius=np.full(n, a), i=np.arange(n) + 1, j=nxt + 1, point=(x + x[nxt]) / 2, force=force * normal,
    )
    averages = average(state, cells="rings:0.5,0.8,1.2")
    volume, tilt = np.pi * (1.2**2 - 0.8**2), np.pi / n
    moment = 2 * n * a * force / volume
    expected = np.diag([moment * np.sin(tilt) ** 2, moment * np.cos(tilt) ** 2])
    np.testing.assert_allclose(averages["stress"], [np.zeros((2, 2)), expected], atol=1e-12 * moment)
    assert averages.in_cells["stress"].components == ("rr", "rphi", "phir", "phiphi")
    np.testing.assert_allclose(averages["volume_fraction"], [0, n * np.pi * a**2 / volume], rtol=1e-13)


def test_what_overlaps_a_ring_wall_stays_in_the_ring_at_it(states):
    state = states.snapshot(x=[[1.06, 0.0], [0.0, 1.96]], radius=[0.1, 0.05], walls=ring_walls(2, 1.0, 2.0))
    cells = make_cells("rings:2", state)
    assert cells.numbers.tolist() == [1.0, 1.0]
    assert make_cells("rings:2:1.0000000000001:2", state).numbers.tolist() == [1.0, 1.0]
    cut = make_cells("rings:2:1.001:2", state).numbers
    assert 0.5 < cut[0] < 1.0
    assert cut[1] == 1.0
    glued = states.replace(state, particles={**state.particles, "x": [1.0, 0.0]})
    assert make_cells("rings:2", glued).numbers[0] == pytest.approx(0.5, abs=0.02)  # half inside: the bare annulus


def test_a_drum_is_one_ring_wall(states):
    state = states.snapshot(x=[[0.0, 0.0], [0.5, 0.0]], radius=[0.3, 0.2], walls=ring_walls(2, 1.0))
    cells = make_cells("rings:4", state)
    assert cells.coordinates["r_inner"].tolist() == [0.0, 0.25, 0.5, 0.75]
    assert cells.numbers.sum() == pytest.approx(2.0, abs=1e-14)
    outside = states.replace(state, particles={**state.particles, "x": [0.0, 1.5]})
    with pytest.raises(WrongSetting, match="one ring wall, of radius 1 m, and particles outside it"):
        make_cells("rings:4", outside)


def test_periodic_images_lie_in_the_cells_they_reach_into(states):
    state = states.snapshot(
        x=[[0.1, 0.5], [1.9, 2.7]], radius=[0.25, 0.25], box=np.array([[0.0, 2.0], [0.0, 1.0]]), periodic=(True, True)
    )
    cells = Strips(snapshot=state, axis=0, edges=np.array([0.0, 0.5, 1.5, 2.0]))
    np.testing.assert_allclose(cells.numbers[1], 0.0)
    np.testing.assert_allclose(cells.numbers.sum(), 2.0, rtol=1e-15)
    np.testing.assert_allclose(cells.numbers[0], cells.numbers[2], rtol=1e-14)
    assert make_cells("grid:2x2", state).numbers.sum() == pytest.approx(2.0, rel=1e-15)


@pytest.mark.parametrize(("kind", "message"), [
    ("rings", "expected a number of cells, NUMBER:LOW:HIGH, or borders as a,b,c, got ''"),
    ("rings:0", "a whole number from 1 to 1000000 for the number of cells, got '0'"),
    ("rings:3:0.5", "got '3:0.5'"),
    ("rings:3:nan:1", "expected a number for a bound, got 'nan'"),
    ("rings:3:1:0.5", "expected a lower bound below the upper one, got 1 and 0.5"),
    ("rings:3:0.1:1", "expected cells inside the sample, between the ring walls, from 0.2 to 2 m, got 0.1 to 1"),
    ("rings:0.5,0.7,0.6", "borders that increase (cells must not overlap), got 0.6 after 0.7"),
    ("rings:-1,1", "expected radii of 0 and more, got -1"),
    ("strips", "expected an axis (x, y), as in strips:x:20, got ''"),
    ("strips:z:3", "expected an axis (x, y), as in strips:x:20, got 'z:3'"),
    ("strips:x:3:0:9", "expected cells inside the sample, x from -2 to 2 m, got 0 to 9"),
    ("strips:x:1e3", "for the number of cells, got '1e3'"),
    ("grid:3", "expected 2 whole numbers like 32x32, got '3'"),
    ("grid:3x-1", "for the cells of an axis, got '-1'"),
    ("grid:9999x9999", "expected at most 1000000 cells, got 9999x9999"),
    ("halfplane:1,0", "expected a normal and a distance, as in halfplane:1,0:0.05, got '1,0'"),
    ("halfplane:0,0:1", "expected a normal that has a direction, got 0,0"),
    ("halfplane:1,0:7", "expected a line that cuts the box, got the distance 7, outside the sample"),
    ("box:3", "expected box alone, got :3 after it"),
    ("ring:3", "expected one of box, inner, particles, rings,"),
])
def test_cells_that_cannot_be_are_one_clear_line(states, kind, message):
    with pytest.raises(WrongSetting) as error:
        make_cells(kind, crowd(states, 2, count=4))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_bounds_that_nobody_knows(states):
    bare = states.snapshot(x=[[0.0, 0.0]], radius=[0.1])
    for kind, message in {
        "rings:3": "expected bounds, as NUMBER:LOW:HIGH, got 3 alone, and the state has no ring walls",
        "strips:x:3": "expected a box, got the state has no box",
        "grid:2x2": "expected a box, got the state has no box",
        "halfplane:1,0:0": "expected a box, got the state has no box",
    }.items():
        with pytest.raises(WrongSetting, match=message.split(",")[0]):
            make_cells(kind, bare)
    askew = states.replace(bare, walls=Columns({**ring_walls(2, 1.0, 2.0), "px": [0.0, 0.1]}, "walls"))
    with pytest.raises(WrongSetting, match="centres up to 0.1 m apart"):
        make_cells("rings:3", askew)
    in_box = states.replace(bare, box=np.array([[-1.0, 1.0], [-1.0, 1.0]]))
    with pytest.raises(WrongSetting, match="cells inside the sample, radii up to 1 m about the centre, got 2"):
        make_cells("rings:3:0:2", in_box)
    periodic = states.replace(in_box, periodic=(True, False))
    with pytest.raises(WrongSetting, match="radii up to 0.9 m"):
        make_cells("rings:3:0:1", periodic)
    crossing = make_cells("halfplane:1,1:0.1", periodic)
    with pytest.raises(MissingColumn, match="the line cuts the periodic axis x; ask for strips"):
        _ = crossing.entries


def test_half_planes_cut_the_box_like_geometry_says(states):
    square = states.snapshot(x=[[0.5, 0.5]], radius=[0.1], box=np.array([[0.0, 1.0], [0.0, 1.0]]))
    corner = (3 - np.sqrt(5)) ** 2 / 4
    for words, below in {"1,0:0.25": 0.25, "1,1:0.5": 0.25, "-1,0:-0.25": 0.75, "1,2:1": 1 - corner}.items():
        assert make_cells(f"halfplane:{words}", square).volumes[0] == pytest.approx(below, rel=1e-14), words
    cube = states.snapshot(x=[[0.5] * 3], radius=[0.1], box=np.array([[0.0, 1.0]] * 3))
    root = np.sqrt(3.0)
    for distance, below in {0.5 / root: 1 / 48, 1.5 / root: 0.5, 2.5 / root: 47 / 48}.items():
        found = make_cells(f"halfplane:1,1,1:{float(distance)!r}", cube).volumes
        np.testing.assert_allclose(found, [below, 1 - below], rtol=1e-13)


def test_half_planes_across_one_axis_are_slabs(states):
    """A normal along an axis, whichever it is: the cross-section jumps where the plane is, and nothing else matters."""
    for dim in (2, 3):
        box = np.array([[-1.0, 2.0], [0.5, 1.5], [0.0, 0.25]])[:dim]
        state = states.snapshot(x=[box.mean(axis=1)], radius=[0.1], box=box)
        whole = np.prod(np.diff(box, axis=1))
        for axis, (low, high) in enumerate(box):
            for sign in (1.0, -1.0):
                words = ",".join(f"{sign * (k == axis):g}" for k in range(dim))
                at = low + 0.3 * (high - low)
                share = 0.3 if sign > 0 else 0.7
                found = make_cells(f"halfplane:{words}:{float(sign * at)!r}", state).volumes
                np.testing.assert_allclose(found, [share * whole, (1 - share) * whole], rtol=1e-13, err_msg=words)


def test_half_planes_do_not_see_which_axis_is_which(states):
    box = np.array([[0.0, 1.0], [0.0, 2.0], [0.0, 0.5]])
    for normal in ([0.0, 0.6, 0.8], [0.6, 0.0, -0.8], [-1.0, 2.0, 3.0]):
        found = []
        for order in ([0, 1, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]):
            state = states.snapshot(x=[[0.5, 0.5, 0.25]], radius=[0.1], box=box[order])
            words = ",".join(repr(normal[k]) for k in order)
            found.append(make_cells(f"halfplane:{words}:0.3", state).volumes)
        np.testing.assert_allclose(found, [found[0]] * 4, rtol=1e-13)


def test_two_discs_in_two_halves_have_one_density(states):
    state = states.snapshot(x=[[0.5, 0.5], [0.5, 1.5]], radius=[0.5, 0.5], box=np.array([[0.0, 1.0], [0.0, 2.0]]))
    for words in ("0,1:1", "0,-1:-1", "1,0:0.5"):
        cells = make_cells(f"halfplane:{words}", state)
        np.testing.assert_allclose(cells.density(np.full(2, np.pi / 4)), np.pi / 4, rtol=1e-13)
