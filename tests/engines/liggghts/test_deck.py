"""The deck as text: what is off is not there, nothing depends on the hour, and what LIGGGHTS cannot do."""

from __future__ import annotations

import numpy as np
import pytest

from harness.engines.liggghts import LIGGGHTS
from harness.engines.liggghts.deck import INPUT, MAX_BINS
from harness.engines.liggghts.domain import domain_of
from harness.engines.liggghts.planes import triangles
from harness.scene.model import Background
from harness.scene.system import Constant, Cosine, Loaded

FRICTION = (0.5, 60.0, 0.3)
LID = Loaded(mass=0.7, load=3.0, stress=0.0, span=None, damping=0.4)
WORDS_OF_EFFECTS = {
    "sliding friction": ("tangential history", "coefficientFriction", "contact_distance_factor"),
    "gravity": ("fix gravity",),
    "background drag": ("viscous",),
    "moving walls": ("move/mesh", ".stl", "reset_timestep", "variable zero"),
    "loaded walls": ("carrier",),
    "contacts": ("pair/gran/local", "f_force_", "dump contacts"),
    "clipping": ("limitForce",),
    "periodic axes": (" xu ", "boundary p"),
}


@pytest.fixture(name="full")
def _full(make, plane):
    """A system with every effect."""
    walls = [plane(1, "floor", (0, 0), (0, 1), True), plane(2, "lid", (0, 3), (0, -1), True, LID)]
    return make(
        x=[[1, 1.0], [2.1, 1.0]], walls=walls, sliding=FRICTION, gravity=(0.0, -1.0), periodic=(5.0, 0.0),
        background=Background(translational_drag=0.1), attraction="clipped",
    )


def text(system) -> str:
    return LIGGGHTS.render(system)[INPUT]


def test_the_deck_says_for_what_it_was_written_and_how_to_run_it(full):
    assert "# LIGGGHTS-PUBLIC 3.8.0; run it by: liggghts -in in.liggghts" in text(full).splitlines()[:3]


def test_an_effect_that_is_on_has_its_words_and_one_that_is_off_has_none(make, full):
    bare = text(make(x=[[1, 1.0], [2.1, 1.0]], contacts=False))
    for effect, words in WORDS_OF_EFFECTS.items():
        for word in words:
            assert word in text(full), effect
            assert word not in bare, effect


def test_rendering_is_deterministic(full):
    assert LIGGGHTS.render(full) == LIGGGHTS.render(full)
    assert sorted(LIGGGHTS.render(full)) == [INPUT, "lid.stl", "packing.data"]


def test_numbers_read_back_as_the_same_float(make):
    x = [[0.1 + 0.2, 1 / 3]]
    data = LIGGGHTS.render(make(x=x))["packing.data"]
    assert f"{0.1 + 0.2!r} {1 / 3!r}" in data


def test_a_title_cannot_write_commands(make):
    lines = text(make(x=[[0, 0]], title='x"\nshell rm & $(v)')).splitlines()
    assert lines[0] == "# x shell rm (v)"


def test_a_mesh_covers_the_whole_domain_and_has_its_centre_in_it(make, plane):
    system = make(x=[[0, 0.5], [7, 2.0]], walls=[plane(1, "ramp", (0, 0), (-0.3, 1))])
    bounds = domain_of(system).bounds
    (corners,) = triangles(system, system.walls[0], bounds)
    assert ((corners.mean(axis=0) > bounds[:, 0]) & (corners.mean(axis=0) < bounds[:, 1])).all()
    for x in bounds[0]:
        for y in bounds[1]:
            foot = np.array([x, y, 0.0])
            weights = np.linalg.lstsq(np.vstack([corners.T, np.ones(3)]), np.append(foot, 1.0), rcond=None)[0]
            assert (weights > 0).all()


def test_a_wide_domain_gets_wide_cells(make):
    system = make(x=[[0, 0], [1.0, 0]], v=[[-500.0, 0], [500.0, 0]])
    assert "binsize" in text(system)
    domain = domain_of(system)
    size = float(text(system).split("binsize ")[1].split()[0])
    assert np.prod(np.diff(domain.bounds[:2], axis=1) / size) == pytest.approx(MAX_BINS)


def unsupported(system) -> list[str]:
    return [s.note for s in LIGGGHTS.supports(system) if s.level == "unsupported"]


def test_every_effect_is_judged(full):
    judged = {s.effect: s.level for s in LIGGGHTS.supports(full)}
    assert judged["normal contact: linear"] == judged["loaded walls"] == "exact"
    assert judged["sliding friction: spring"] == "equivalent"
    assert not unsupported(full)


@pytest.mark.parametrize(("inertia", "dimension", "ok"), [
    (0.5, 2, True), (0.4, 2, True), (1.0, 2, False), (0.4, 3, True), (0.5, 3, False),
])
def test_moments_of_inertia_it_can_turn(make, inertia, dimension, ok):
    x = [[0.0] * dimension, [1.0] + [0.0] * (dimension - 1)]
    assert (not unsupported(make(x=x, inertia=inertia, sliding=FRICTION))) == ok
    assert not unsupported(make(x=x, inertia=inertia))


def test_mixed_moments_of_inertia(make):
    notes = unsupported(make(x=[[0, 0], [1, 0]], inertia=np.array([0.4, 0.5]), sliding=FRICTION))
    assert notes == ["I = q m R^2 with q = 0.4, 0.5: one of 0.4, 0.5 for all particles of a 2D run"]


def test_walls_it_cannot_hold(make, plane):
    def notes(wall, periodic, **rest):
        return unsupported(make(x=[[1.0, 1.0]], walls=[wall], periodic=periodic, **rest))

    assert "across a periodic axis" in notes(plane(1, "side", (0, 0), (1, 0)), (5.0, 0.0))[0]
    assert "along a periodic axis" in notes(plane(1, "ramp", (0, 0), (0.1, 1)), (5.0, 0.0))[-1]
    drifting = plane(1, "lid", (0, 3), (0, -1), True, Constant(velocity=(1.0, -1.0)))
    assert "along a periodic axis" in notes(drifting, (5.0, 0.0), sliding=FRICTION)[0]
    assert not notes(drifting, (5.0, 0.0))
    assert not notes(plane(1, "lid", (0, 3), (0, -1), True, Cosine(travel=1.0, duration=1.0)), (5.0, 0.0))


def test_a_load_that_hangs_on_another_loaded_wall(make, plane):
    span = Loaded(mass=1.0, load=0.0, stress=1.0, span=("floor", "lid"), damping=0.0)
    walls = [plane(1, "floor", (0, 0), (0, 1)), plane(2, "lid", (0, 3), (0, -1), motion=LID),
             plane(3, "side", (3, 0), (-1, 0), motion=span)]
    assert unsupported(make(x=[[1, 1.0]], walls=walls)) == [
        "side: the load depends on the place of a wall that is itself loaded"]


def test_a_period_of_two_diameters_is_too_narrow(make):
    assert unsupported(make(x=[[1, 1.0]], periodic=(2.0, 0.0)))
    assert not unsupported(make(x=[[1, 1.0]], periodic=(2.1, 0.0)))


def test_the_cost_grows_with_particles_and_friction(make):
    one, two = make(x=[[0, 0]]), make(x=[[0, 0], [2, 0]])
    rough = make(x=[[0, 0], [2, 0]], sliding=FRICTION)
    costs = [LIGGGHTS.microseconds_per_step(s) for s in (one, two, rough)]
    assert costs == sorted(costs)
    assert costs[0] > 0


def test_the_command_reproduces_the_run(tmp_path):
    assert LIGGGHTS.command(tmp_path)[-2:] == ["-in", INPUT]
