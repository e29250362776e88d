"""Bodies on a lattice: where they stand, how they move, and what is refused."""

import numpy as np
import pytest

from harness.scene.lattice import lattice_particles
from harness.scene.model import Lattice, SphereMass, UniformRadius

EQUAL, DRAWN = UniformRadius(min=0.5, max=0.5), UniformRadius(min=0.4, max=0.6)


def lattice(**changes):
    given = {
        "arrangement": "square", "counts": (3, 2), "spacing": 1.0, "corner": (10.0, 20.0), "radius": EQUAL,
        "mass": SphereMass(density=1.0), "inertia": "disc",
    }
    return Lattice(**(given | changes))


def test_square_rows_run_along_x_first():
    x = lattice_particles(lattice()).x
    assert np.array_equal(x, [[10, 20], [11, 20], [12, 20], [10, 21], [11, 21], [12, 21]])


def test_neighbours_of_a_triangular_lattice_are_one_spacing_apart():
    x = lattice_particles(lattice(arrangement="triangular", counts=(4, 4))).x
    apart = np.linalg.norm(x[:, None] - x[None], axis=2)
    inner = apart[5]
    assert (np.abs(inner - 1.0) < 1e-12).sum() == 6


def test_three_dimensions_are_simple_cubic():
    particles = lattice_particles(lattice(counts=(2, 2, 2), corner=(0.0, 0.0, 0.0)))
    assert particles.x.shape == (8, 3)
    assert particles.spin.shape == (8, 3)
    assert np.array_equal(particles.x[-1], [1, 1, 1])


def test_what_is_drawn_belongs_to_the_seed_and_the_whole_stays_at_rest():
    drawn = lattice(counts=(10, 10), radius=DRAWN, speed=2.0, seed=3)
    one, again, other = (lattice_particles(x) for x in (drawn, drawn, lattice(counts=(10, 10), radius=DRAWN, seed=4)))
    assert np.array_equal(one.radius, again.radius)
    assert np.array_equal(one.v, again.v)
    assert not np.array_equal(one.radius, other.radius)
    assert 0.4 <= one.radius.min() < one.radius.max() <= 0.6
    assert np.abs(one.mass @ one.v).max() < 1e-12
    assert one.v.std() == pytest.approx(2.0, rel=0.2)
    assert not other.v.any()


LATTICE = {
    "arrangement": "square", "counts": [2, 2], "spacing": 4e-3, "corner": [0.0, 0.0], "inertia": "disc",
    "radius": {"kind": "uniform", "min": 1e-3, "max": 1e-3}, "mass": {"kind": "sphere", "density": 2000.0},
}


@pytest.mark.parametrize(("changes", "message"), [
    ({"speed": 1.0}, "bodies_from.seed: expected an integer, as radii or velocities are drawn, got nothing; add seed"),
    ({"counts": [2, 2, 2]}, "bodies_from.counts: expected 2 components, as dimension = 2"),
    ({"corner": [0.0, 0.0, 0.0]}, "bodies_from.corner: expected 2 components, as dimension = 2"),
    ({"counts": [0, 2]}, "bodies_from.counts[0]: expected an integer >= 1, got 0"),
    ({"counts": [2000, 2000]}, "bodies_from.counts: expected at most 1000000 bodies, got [2000, 2000]"),
    ({"radius": {"kind": "uniform", "min": 2e-3, "max": 1e-3}}, "bodies_from.radius.max: expected a number >= "),
    ({"spacing": 1e-4}, "bodies_from, body 2, position: expected an overlap with bodies_from, body 1 of at most half"),
])
def test_a_wrong_lattice_is_refused(scenes, changes, message):
    wrong = {"bodies": [], "bodies_from": LATTICE | changes}
    assert scenes.refusal(scenes.free, wrong).startswith(f"scene.toml: {message}")


def test_triangles_are_flat(scenes):
    cube = LATTICE | {"arrangement": "triangular", "counts": [2, 2, 2], "corner": [0.0, 0.0, 0.0]}
    said = scenes.refusal(scenes.free, {"bodies": [], "bodies_from": cube, "dimension": 3})
    assert said.startswith('scene.toml: bodies_from.arrangement: expected "square" in 3D, got "triangular"')


def test_bodies_are_given_once(scenes):
    said = scenes.refusal(scenes.free, {"bodies_from": LATTICE})
    assert "got bodies and bodies_from" in said
