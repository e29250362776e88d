"""Particles against particles: whole collisions equal an independent integration to rounding."""

from __future__ import annotations

import numpy as np
import pytest

from harness.scene.model import Background

pytestmark = pytest.mark.needs_liggghts

FRICTION = (0.5, 60.0, 0.3)
OBLIQUE = {"x": [[0, 0], [1.02, 0.3]], "v": [[1, 0.2], [-0.7, 0.1]], "spin": [3.0, -2.0], "radius": [0.5, 0.6],
           "mass": [1.0, 1.7]}
SPHERES = {"x": [[0.2, 0.1, 0.2], [1.2, 0.3, 0.4]], "v": [[1, 0.2, 0.3], [-0.7, 0.1, 0]],
           "spin": [[1, 2, 3], [0, 1, -4]], "radius": [0.5, 0.6], "mass": [1.0, 1.7]}


def test_head_on_collision_has_the_restitution_of_the_law(make, run):
    """e = exp(-b t_c), b = gamma/2m*, t_c = pi/sqrt(k/m* - b^2); steps of t_c/1000."""
    k, gamma, m = 200.0, 1.5, 0.5
    b = gamma / (2 * m)
    time = np.pi / np.sqrt(k / m - b**2)
    system = make(x=[[0, 0], [1.0001, 0]], v=[[1, 0], [-1, 0]], kn=k, gn=gamma, steps=1100, dt=time / 1000)
    last = run(system).frames[-1].particles
    relative = last["vx"][1] - last["vx"][0]
    assert relative == pytest.approx(2 * np.exp(-b * time), rel=2e-3)
    assert last["vx"].sum() == pytest.approx(0, abs=1e-14)
    assert not last["vy"].any()


@pytest.mark.parametrize("attraction", ["allowed", "clipped"])
def test_clipping_attraction_is_another_law(make, matches, attraction):
    trajectory = matches(make(x=[[0, 0], [1.02, 0]], v=[[1, 0], [-1, 0]], gn=8.0, attraction=attraction,
                              frame_every=1))
    forces = [f.contacts["fx"] for f in trajectory if f.contacts.rows]
    assert (np.max(forces) > 0) == (attraction == "allowed")
    assert np.min(forces) < 0


@pytest.mark.parametrize("inertia", [0.5, 0.4])
def test_oblique_collision_of_discs_and_of_spheres_in_a_plane(make, matches, inertia):
    matches(make(**OBLIQUE, sliding=FRICTION, inertia=inertia))


def test_gravity_and_drag(make, matches):
    matches(make(**OBLIQUE, sliding=FRICTION, gravity=(0.3, -1.0), background=Background(translational_drag=0.3)))


def test_oblique_collision_in_space(make, matches):
    matches(make(**SPHERES, sliding=FRICTION))


def test_collision_across_a_periodic_boundary(make, matches):
    """Unwrapped positions, the contact point beside particle i, and force and spring of the lower id."""
    start = SPHERES | {"x": [[0.1, 0.1, 0.2], [2.95, 0.3, 0.2]], "v": [[-2, 0.2, 0.3], [0.7, 0.1, 0]]}
    system = make(**start, sliding=FRICTION, periodic=(4.0, 4.0, 4.0), steps=400, frame_every=20)
    trajectory = matches(system)
    assert trajectory.frames[4].particles["x"][0] < 0
    contacts = next(f.contacts for f in trajectory if f.contacts.rows)
    assert (contacts["i"], contacts["j"]) == (1, 2)
    assert contacts["fx"] > 0
    assert -0.7 < contacts["px"] < -0.4


def test_a_spring_does_not_outlive_its_contact(make, matches, plane):
    """A disc bounces between a heavy one and the floor: it touches again before lists are renewed."""
    floor = plane(1, "floor", (0, 0), (0, 1))
    matches(make(
        x=[[0, 0.51], [0, 1.53]], v=[[0.1, 1.0], [0, 0]], mass=[1, 1e6], sliding=(0.5, 6e3, 0.0), kn=2e4, gn=0.0,
        walls=[floor], steps=1600, dt=2e-4,
    ))


def test_a_drop_of_many_spheres(make, matches, plane):
    rng = np.random.default_rng(3)
    grid = np.array([(i, j, k) for i in range(2) for j in range(3) for k in range(2)], float)
    system = make(
        x=grid * 1.02 + [0.6, 0.6, 0.6] + rng.uniform(-0.05, 0.05, grid.shape), radius=0.5, mass=1.0,
        v=rng.normal(0, 0.5, grid.shape), spin=rng.normal(0, 1, grid.shape), sliding=FRICTION, kn=2000.0,
        gravity=(0.0, -3.0, 0.0), periodic=(2.5, 0.0, 2.5), steps=400,
        walls=[plane(1, "floor", (0, 0, 0), (0, 1, 0), friction=True)],
    )
    matches(system, 1e-9)
