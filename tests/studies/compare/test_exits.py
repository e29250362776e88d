"""Exit values against hand-made flights and the closed forms of a collision."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.scene.contact import LinearNormal
from harness.scene.system import Constant, Particles, System, Wall
from harness.studies.compare.exits import exit_values
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory
from reference.analytic.linear_collision import LinearCollision

MASS, STIFFNESS, DAMPING, SPEED = 1e-5, 1e5, 0.1, 0.3
PAIR = LinearCollision(stiffness=STIFFNESS, damping=DAMPING, reduced_mass=MASS / 2)
NORMAL = LinearNormal(normal_stiffness=STIFFNESS, normal_damping=DAMPING, attraction="allowed")


def system(count: int = 2, **changes) -> System:
    particles = Particles(
        x=np.zeros((count, 2)), radius=np.full(count, 1e-3), mass=np.full(count, MASS), v=np.zeros((count, 2)),
        inertia_factor=np.full(count, 0.5), spin=np.zeros((count, 1)),
    )
    fields = {
        "dimension": 2, "particles": particles, "walls": (), "normal": NORMAL, "sliding": None, "background": None,
        "gravity": None, "periodic": None, "dt": 1e-7, "steps": 10, "sample_every": 1, "frame_every": 1,
        "contacts": False,
    }
    return System(**(fields | changes))


def trajectory(times, x, v, walls=None) -> Trajectory:
    """x, v: (F, N, 2); walls: (F, 2) place of the only wall."""
    frames = []
    for k, t in enumerate(times):
        n = x.shape[1]
        table = {"id": np.arange(1, n + 1), "x": x[k, :, 0], "y": x[k, :, 1], "vx": v[k, :, 0], "vy": v[k, :, 1],
                 "wz": np.arange(n) + 0.5, "radius": np.full(n, 1e-3)}
        wall = None if walls is None else Columns({"id": [1], "px": [walls[k][0]], "py": [walls[k][1]]}, "walls")
        frames.append(Snapshot(time=float(t), dimension=2, particles=Columns(table, "particles"), walls=wall))
    return Trajectory(frames=tuple(frames), steps=tuple(range(len(frames))), series=None)


def collision(times, *, touch: float, cut_at: float = math.inf) -> Trajectory:
    """The exact head-on collision along x, first touch at `touch`, frames up to `cut_at`."""
    times = times[times <= cut_at]
    end = PAIR.duration("allowed")
    since = np.clip(times - touch, 0.0, end)
    overlap, rate = PAIR.motion(since, SPEED)
    e = PAIR.restitution("allowed")
    overlap = np.where(times < touch, SPEED * (times - touch), overlap)
    overlap = np.where(times > touch + end, -e * SPEED * (times - touch - end), overlap)
    rate = np.where(times < touch, SPEED, np.where(times > touch + end, -e * SPEED, rate))
    x, v = np.zeros((2, len(times), 2, 2))
    x[:, 0, 0], x[:, 1, 0] = overlap / 2, 2e-3 - overlap / 2
    v[:, 0, 0], v[:, 1, 0] = rate / 2, -rate / 2
    return trajectory(times, x, v)


def test_closed_forms_of_a_collision():
    """Frame spacing is all that is lost: interpolated times to a few 1e-4 of a contact at 400 frames in it."""
    times = np.linspace(0.0, 5e-5, 900)
    values = exit_values(collision(times, touch=1e-5), system())
    (found,) = values.collisions
    assert (found.i, found.j) == (1, 2)
    assert found.begin == pytest.approx(1e-5, abs=1e-9)
    assert found.duration == pytest.approx(PAIR.duration("allowed"), rel=1e-3)
    assert found.end == pytest.approx(found.begin + found.duration)
    assert found.largest_overlap == pytest.approx(PAIR.largest_overlap(SPEED), rel=1e-4)
    assert found.restitution == pytest.approx(PAIR.restitution("allowed"), rel=1e-12)
    assert values.velocity[0] == pytest.approx([-PAIR.restitution("allowed") * SPEED / 2, 0.0])
    assert values.spin.tolist() == [[0.5], [1.5]]
    assert values.resolution == pytest.approx(times[1])


def test_a_contact_that_lasts_has_no_end():
    (found,) = exit_values(collision(np.linspace(0, 5e-5, 100), touch=1e-5, cut_at=2e-5), system()).collisions
    assert (found.end, found.duration, found.restitution) == (None, None, None)
    assert found.largest_overlap > 0


def test_a_contact_from_the_start_has_no_restitution():
    full = collision(np.linspace(0, 5e-5, 100), touch=-1e-6)
    (found,) = exit_values(full, system()).collisions
    assert found.begin == 0.0
    assert found.end is not None
    assert found.restitution is None


def test_bodies_that_did_not_approach_have_no_restitution():
    """They rest at exactly zero overlap, then one is pushed in: no speed before to divide by."""
    times = np.arange(4) * 1e-6
    x, v = np.zeros((2, 4, 2, 2))
    x[:, 1, 0] = [2e-3, 2e-3 - 1e-6, 2e-3 - 1e-6, 2e-3 + 1e-6]
    v[3, 1, 0] = 1.0
    (found,) = exit_values(trajectory(times, x, v), system()).collisions
    assert found.restitution is None
    assert found.end == pytest.approx(2.5e-6)


def test_one_pair_can_meet_twice():
    times = np.linspace(0, 5e-5, 300)
    once = collision(times, touch=1e-5)
    late = [replace(f, time=f.time + 6e-5) for f in once]
    twice = Trajectory(frames=(*once.frames, *late), steps=tuple(range(600)), series=None)
    first, second = exit_values(twice, system()).collisions
    assert second.begin - first.begin == pytest.approx(6e-5)
    assert first.restitution == pytest.approx(second.restitution)


def test_across_a_periodic_boundary():
    """The same collision shifted so that one body sits behind the boundary at x = 0.02."""
    plain = collision(np.linspace(0, 5e-5, 300), touch=1e-5)
    shifted = [f.particles["x"] - np.array([0.0, 0.02]) for f in plain]
    moved = tuple(
        replace(f, particles=Columns(dict(f.particles) | {"x": x}, "particles"))
        for f, x in zip(plain, shifted, strict=True)
    )
    (there,) = exit_values(replace(plain, frames=moved), system(periodic=(0.02, 0.0))).collisions
    (here,) = exit_values(plain, system()).collisions
    assert there.restitution == pytest.approx(here.restitution)
    assert there.duration == pytest.approx(here.duration)


def test_a_moving_wall_gives_its_speed():
    """A ball at rest is hit by a wall that comes with 2 m/s and leaves with twice that speed: e = 1."""
    times = np.linspace(0, 1e-3, 1001)
    hit = 5e-4
    y = 1e-3 + 1e-3 + np.maximum(times - hit, 0.0) * 4.0
    wall = np.column_stack([np.zeros_like(times), 2.0 * (times - hit) + 1e-3])
    y = np.where((times > hit) & (times < hit + 2e-5), y - 1e-4, y)
    x = np.stack([np.zeros_like(y), y], axis=1)[:, None, :]
    v = np.stack([np.zeros_like(y), np.where(times <= hit, 0.0, 4.0)], axis=1)[:, None, :]
    plane = Wall(index=1, name="ram", point=(0.0, 0.0), normal=(0.0, 1.0), friction=False,
                 motion=Constant(velocity=(0.0, 2.0)))
    (found,) = exit_values(trajectory(times, x, v, wall), system(1, walls=(plane,))).collisions
    assert (found.i, found.j) == (1, -1)
    assert found.restitution == pytest.approx(1.0)


def test_many_bodies_are_not_followed():
    count = 65
    x, v = np.zeros((2, 3, count, 2))
    x[:, :, 0] = 2e-3 * np.arange(count)
    values = exit_values(trajectory(np.arange(3.0), x, v), system(count))
    assert values.collisions == ()
    assert values.velocity.shape == (count, 2)


def test_one_frame_has_no_resolution():
    x = np.array([[[0.0, 0.0], [1.0, 1.0]]])
    values = exit_values(trajectory(np.zeros(1), x, 0 * x), system())
    assert np.isnan(values.resolution)
    assert values.collisions == ()
