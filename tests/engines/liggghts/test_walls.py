"""Walls of every kind: fixed, driven and loaded, smooth and rough, straight, oblique and along periodic axes."""

from __future__ import annotations

import numpy as np
import pytest

from harness.engines.liggghts import LIGGGHTS
from harness.scene.system import Constant, Cosine, Loaded

pytestmark = pytest.mark.needs_liggghts

FRICTION = (0.5, 60.0, 0.3)
DISC = {"x": [[0, 0.52]], "v": [[0.7, -1.013]], "spin": [2.0]}
SPHERE = {"x": [[0, 0.52, 0]], "v": [[0.7, -1.013, 0.3]], "spin": [[2.0, 1, -1]]}
LID = Loaded(mass=0.7, load=3.0, stress=0.0, span=None, damping=0.4)

SINGLE = {
    "straight": (DISC, (0, 1), None, {}),
    "oblique": (DISC, (-0.3, 1), None, {}),
    "oblique, spheres in a plane": (DISC, (-0.3, 1), None, {"inertia": 0.4}),
    "driven, in contact from the start": ({"x": [[0, 0.48]]}, (0, 1), Constant(velocity=(0.4, 0.5)), {}),
    "belt": (DISC, (0, 1), Constant(velocity=(0.4, 0.0)), {"gravity": (0.0, -5.0)}),
    "oblique belt": (DISC, (-0.3, 1), Constant(velocity=(1.0, 0.3)), {"gravity": (0.0, -5.0)}),
    "cosine that ends within a step": (DISC, (0, 1), Cosine(travel=0.3, duration=0.5013), {}),
    "oblique cosine": (DISC, (0.3, 1), Cosine(travel=0.3, duration=5.0), {}),
    "in space": (SPHERE, (0.1, 1, 0.2), None, {}),
    "belt in space": (SPHERE, (0, 1, 0), Constant(velocity=(0.5, 0.0, 0.3)), {"gravity": (0.0, -5.0, 0.0)}),
}


@pytest.mark.parametrize("kind", SINGLE)
def test_particle_on_a_rough_wall(make, matches, plane, kind):
    start, normal, motion, rest = SINGLE[kind]
    floor = plane(1, "floor", (0,) * len(normal), normal, True, motion)
    matches(make(**start, walls=[floor], sliding=FRICTION, **rest))


def test_a_smooth_wall_leaves_rough_particles_alone(make, matches, plane):
    last = matches(make(**DISC, walls=[plane(1, "floor", (0, 0), (0, 1))], sliding=FRICTION)).frames[-1]
    assert last.particles["wz"] == 2.0
    assert last.particles["vx"] == 0.7


@pytest.mark.parametrize("rough", [False, True])
def test_loaded_lid_presses_a_disc(make, matches, plane, rough):
    walls = [plane(1, "floor", (0, 0), (0, 1), rough), plane(2, "lid", (0, 0.95), (0.1, -1), rough, LID)]
    matches(make(x=[[0, 0.45]], v=[[0.5, 0]], gravity=(0.0, -3.0), walls=walls,
                 sliding=FRICTION if rough else None))


def test_nothing_touches_the_atom_that_keeps_a_walls_state(make, plane, deck, agrees, reference):
    """It is parked far away; here it stands in the way of a disc."""
    system = make(x=[[0.0, 0.0]], v=[[1.0, 0.0]], walls=[plane(1, "lid", (0, 3), (0, -1), False, LID)])
    folder = deck(system)
    data = (folder / "packing.data").read_text()
    row = next(line for line in data.splitlines() if line.startswith("2 1 "))
    (folder / "packing.data").write_text(data.replace(row, " ".join([*row.split()[:4], "0.7 0.1 0"])))
    assert LIGGGHTS.run(folder, time_limit=20).status == "completed"
    agrees(LIGGGHTS.read(folder, system), system, reference(system), 1e-12)


def test_two_loaded_walls_squeeze_a_disc(make, matches, plane):
    """LIGGGHTS keeps one force for both meshes on the disc; each wall moves by its own."""
    heavy = Loaded(mass=0.9, load=2.0, stress=0.0, span=None, damping=0.4)
    walls = [plane(1, "floor", (0, 0), (0, 1), False, heavy), plane(2, "lid", (0, 0.9), (0, -1), False, LID)]
    system = make(x=[[0, 0.45]], v=[[0.5, 0]], walls=walls, gn=0.0)
    trajectory = matches(system)
    frame = next(f for f in trajectory if f.contacts.rows == 2)
    lower, upper = frame.contacts["fy"]
    assert (lower, -upper) == pytest.approx(200.0 * frame.contacts["overlap"])
    assert (-lower, -upper) == pytest.approx(frame.walls["fy"])


def test_smooth_and_rough_meshes_together(make, matches, plane):
    walls = [
        plane(1, "floor", (0, 0), (0, 1), True, Cosine(travel=0.1, duration=0.5)),
        plane(2, "lid", (0, 0.9), (0, -1), False, LID),
        plane(3, "left", (-0.6, 0), (1, 0.1), True),
        plane(4, "right", (1.8, 0), (-1, 0), False),
    ]
    matches(make(x=[[0.1, 0.45], [1.12, 0.46]], v=[[-1.5, 0], [1.3, 0]], walls=walls, sliding=FRICTION))


def test_disc_in_a_rough_groove(make, matches, plane):
    """It touches two rough meshes at once: springs and forces of each are told apart."""
    walls = [plane(1, "left", (0, 0), (1, 1), True), plane(2, "right", (0, 0), (-1, 1), True)]
    system = make(x=[[0, 0.69]], v=[[0.1, 0]], gravity=(0.0, -3.0), walls=walls, sliding=FRICTION, gn=0.0)
    frame = matches(system).frames[-1]
    c = frame.contacts
    assert c["j"].tolist() == [-1, -2]
    normals = frame.walls.vector("nx", "ny")
    force, spring = c.vector("fx", "fy"), c.vector("ux", "uy")
    np.testing.assert_allclose((force * normals).sum(axis=1), 200.0 * c["overlap"], rtol=1e-9)
    assert np.abs(spring).max() > 1e-6
    np.testing.assert_allclose((spring * normals).sum(axis=1), 0, atol=1e-15)


@pytest.mark.parametrize("periodic", [(4.0, 0.0), (4.0, 0.0, 0.0), (4.0, 0.0, 4.0)])
def test_a_loaded_lid_along_periodic_axes(make, matches, plane, periodic):
    """Meshes are tiled there: one particle rolls over the boundary, the other over the tiles' inner edge."""
    up = [0.0] * (len(periodic) - 2)
    walls = [plane(1, "floor", (0, 0, *up), (0, 1, *up), True), plane(2, "lid", (0, 0.9, *up), (0, -1, *up), True, LID)]
    depth = [0.2, 0.1] if up else []
    system = make(
        x=[[0.1, 0.45, *depth[:1]], [2.3, 0.46, *depth[1:]]], v=[[-1.5, 0, *([0.8] * len(up))], [-1.3, 0, *up]],
        periodic=periodic, walls=walls, sliding=FRICTION, steps=800,
    )
    x = matches(system).frames[-1].particles["x"]
    assert x[0] < 0.0
    assert x[1] < 2.0


def test_wall_state_follows_the_motion(make, run, plane):
    """Points of the walls table: d along the normal, or velocity * t for a belt; box between the walls."""
    walls = [
        plane(1, "floor", (0, 0), (0, 1), False, Cosine(travel=0.2, duration=0.4)),
        plane(2, "lid", (0, 3), (0, -1), False, Constant(velocity=(0.5, -0.25))),
        plane(3, "left", (-1, 0), (1, 0)), plane(4, "right", (1, 0), (-1, 0)),
    ]
    trajectory = run(make(x=[[0, 1.5]], walls=walls, steps=200, dt=1e-3))
    for frame in trajectory:
        floor = 0.1 * (1 - np.cos(np.pi * min(frame.time / 0.4, 1.0)))
        assert frame.walls["py"][:2] == pytest.approx([floor, 3 - 0.25 * frame.time])
        assert frame.walls["px"][1] == pytest.approx(0.5 * frame.time)
        assert frame.box == pytest.approx(np.array([[-1, 1], [floor, 3 - 0.25 * frame.time]]))
    assert trajectory.series["lid_d"][-1] == pytest.approx(0.05)
    assert trajectory.series["floor_v"][-1] == pytest.approx(0.1 * np.pi / 0.4)
