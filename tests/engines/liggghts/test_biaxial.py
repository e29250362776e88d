"""The biaxial box: trajectory, the loaded wall's equation, contact output and its innocence."""

from __future__ import annotations

import numpy as np
import pytest

from harness.scene.model import Background
from harness.scene.system import Cosine, Loaded

pytestmark = pytest.mark.needs_liggghts

SIDE = Loaded(mass=0.01, load=0.0, stress=200.0, span=("bottom", "top"), damping=0.1)


@pytest.fixture(name="box")
def _box(make, plane):
    """Discs on a disturbed lattice, slightly overlapping each other and the walls."""

    def box(rows: int = 3, **rest):
        rng = np.random.default_rng(0)
        lattice = np.array([(i, j) for j in range(rows) for i in range(rows)]) * 0.01 + 0.0051
        radius = rng.uniform(0.0048, 0.0055, rows**2)
        side = 0.0102 + 0.01 * (rows - 1)
        walls = (
            plane(1, "left", (0, 0), (1, 0)), plane(2, "bottom", (0, 0), (0, 1)),
            plane(3, "right", (side, 0), (-1, 0), motion=SIDE),
            plane(4, "top", (0, side), (0, -1), motion=Cosine(travel=0.1 * side, duration=0.1)),
        )
        given = {"sliding": (0.5, 2e3, 0.1), "steps": 1000, "frame_every": 200} | rest
        return make(
            x=lattice + rng.uniform(-1e-4, 1e-4, lattice.shape), radius=radius,
            mass=1200 * 4 / 3 * np.pi * radius**3, walls=walls, kn=1e4, dt=2e-6,
            background=Background(translational_drag=0.01), **given,
        )

    return box


def test_a_small_box_equals_the_independent_integration(box, matches):
    matches(box(rows=4), 1e-9)


def test_the_loaded_wall_obeys_its_equation(box, run):
    """m d'' = p_x z(t) + F.n - gamma d', d'' by central differences of the series: second order in dt."""
    system = box(sample_every=1, steps=400, frame_every=400)
    s = run(system).series
    dt, side = system.dt, system.wall("top").point[1]
    acceleration = (s["right_d"][2:] - 2 * s["right_d"][1:-1] + s["right_d"][:-2]) / dt**2
    half_rate = (s["right_d"][1:-1] - s["right_d"][:-2]) / dt
    force = SIDE.stress * (side - s["top_d"]) - s["right_fx"]
    expected = (force[1:-1] - SIDE.damping * half_rate) / SIDE.mass
    np.testing.assert_allclose(acceleration, expected, rtol=0, atol=1e-7 * np.abs(expected).max())
    full_rate = half_rate + 0.5 * dt * expected
    np.testing.assert_allclose(s["right_v"][1:-1], full_rate, rtol=0, atol=1e-9 * np.abs(full_rate).max())


def test_contact_output_does_not_touch_the_run(box, run):
    """Bit for bit the same final state, whatever is looked at and how often."""
    plain = run(box(contacts=False, sample_every=40), "plain")
    seen = run(box(contacts=True, sample_every=10, frame_every=50), "seen")
    assert plain.frames[0].contacts is None
    for column in plain.frames[-1].particles:
        np.testing.assert_array_equal(plain.frames[-1].particles[column], seen.frames[-1].particles[column])
    np.testing.assert_array_equal(plain.frames[-1].walls["px"], seen.frames[-1].walls["px"])


def test_a_run_is_repeated_bit_for_bit(box, run):
    first, second = (run(box(steps=200), name).frames[-1].particles for name in ("first", "second"))
    assert all(np.array_equal(first[c], second[c]) for c in first)


def test_contacts_follow_the_contract(box, run):
    """Force of pairs: k_n overlap - gamma_n v_n and -k_t u - gamma_t v_t with full-step velocities."""
    system = box()
    frame = run(system).frames[3]
    p, c, w = frame.particles, frame.contacts, frame.walls
    pairs = c["j"] > 0
    assert (c["i"][pairs] < c["j"][pairs]).all()
    i, j = (c[k][pairs].astype(int) - 1 for k in "ij")
    x, v = p.vector("x", "y"), p.vector("vx", "vy")
    branch = x[i] - x[j]
    r = np.linalg.norm(branch, axis=1)
    n = branch / r[:, None]
    overlap = p["radius"][i] + p["radius"][j] - r
    np.testing.assert_allclose(c["overlap"][pairs], overlap, rtol=1e-9)
    arm = [p["radius"][k] - overlap / 2 for k in (i, j)]
    np.testing.assert_allclose(c.vector("px", "py")[pairs], x[i] - arm[0][:, None] * n, rtol=1e-12)
    vn = ((v[i] - v[j]) * n).sum(axis=1)
    spin = arm[0] * p["wz"][i] + arm[1] * p["wz"][j]
    slip = v[i] - v[j] - vn[:, None] * n - spin[:, None] * np.column_stack([-n[:, 1], n[:, 0]])
    law, u = system.sliding, c.vector("ux", "uy")[pairs]
    fn = system.normal.normal_stiffness * overlap - system.normal.normal_damping * vn
    stretch, limit = law.shear_stiffness * np.linalg.norm(u, axis=1), law.shear_friction * np.abs(fn)
    ft = -law.shear_stiffness * u - law.shear_damping * slip
    cut = -law.shear_stiffness * u * (np.minimum(stretch, limit) / np.where(stretch > 0, stretch, 1))[:, None]
    expected = fn[:, None] * n + np.where((stretch > limit)[:, None], cut, ft)
    sure = np.abs(stretch - limit) > 1e-9 * limit  # a spring just cut lies on the limit to rounding
    assert sure.sum() > 5
    np.testing.assert_allclose(c.vector("fx", "fy")[pairs][sure], expected[sure], atol=1e-9 * np.abs(fn).max())
    for k, wall in enumerate(system.walls):
        rows = c["j"] == -wall.index
        assert rows.any()
        np.testing.assert_allclose(
            -c.vector("fx", "fy")[rows].sum(axis=0), w.vector("fx", "fy")[k], atol=1e-9 * np.abs(w["fx"]).max())
        feet = c.vector("px", "py")[rows] - [w["px"][k], w["py"][k]]
        np.testing.assert_allclose(feet @ wall.normal, 0, atol=1e-16)
        assert not c["ux"][rows].any()


def test_frames_may_lie_between_samples(box, run):
    system = box(sample_every=100, frame_every=125)
    trajectory = run(system)
    assert trajectory.steps == tuple(range(0, 1001, 125))
    assert trajectory.series["step"].tolist() == list(range(0, 1001, 100))
    assert trajectory.frames[4].walls["fx"][2] == trajectory.series["right_fx"][5]


def test_frictionless_box_has_no_springs(box, run):
    contacts = run(box(sliding=None)).frames[-1].contacts
    assert "ux" not in contacts
    assert contacts.rows > 9
