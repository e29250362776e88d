"""Torque through circles and the rest of momentum: exact on states made by hand."""

import numpy as np
import pytest

from postproc.averaging.registry import make_cells
from postproc.fields import Subject
from postproc.macro.ring_balance import momentum_rest, net_force, sum_inside, torque_of, torque_through
from postproc.snapshot import Columns, Snapshot


def state(contacts, *, x=((2.0, 0.0), (4.0, 0.0)), v=((0.0, 0.0), (0.0, 0.0))):
    x, v = np.array(x), np.array(v)
    n = len(x)
    particles = {
        "id": np.arange(1, n + 1), "x": x[:, 0], "y": x[:, 1], "radius": np.ones(n), "mass": np.full(n, 3.0),
        "vx": v[:, 0], "vy": v[:, 1],
    }
    walls = {"id": [1, 2], "px": [0.0, 0.0], "py": [0.0, 0.0], "radius": [1.0, 5.0]}
    names = ("i", "j", "px", "py", "fx", "fy")
    table = dict(zip(names, np.array(contacts, dtype=float).reshape(-1, 6).T, strict=True))
    return Snapshot(
        time=0.0, dimension=2, particles=Columns(particles, "particles"), contacts=Columns(table, "contacts"),
        walls=Columns(walls, "walls"),
    )


CHAIN = ((1, -1, 1.0, 0.0, 0.5, 6.0), (2, 1, 3.0, 0.0, 0.5, 2.0), (2, -2, 5.0, 0.0, -0.5, -1.2))
"""A torque of 6 N m from the inner ring through two discs to the outer one."""


def test_torque_of_a_chain_passes_every_circle():
    assert torque_through(state(CHAIN), np.array([1.5, 2.5, 3.9, 4.5])) == pytest.approx(np.full(4, 6.0), rel=1e-15)


def test_it_does_not_matter_which_disc_is_named_first():
    swapped = ((1, -1, 1.0, 0.0, 0.5, 6.0), (1, 2, 3.0, 0.0, -0.5, -2.0), (2, -2, 5.0, 0.0, -0.5, -1.2))
    assert np.array_equal(torque_through(state(swapped), [3.0]), torque_through(state(CHAIN), [3.0]))


def test_radial_forces_carry_no_torque_and_contacts_within_a_layer_do_not_count():
    radial = ((2, 1, 3.0, 0.0, 7.0, 0.0),)
    assert torque_through(state(radial), [3.0]) == 0.0
    beside = ((1, 2, 2.0, 0.0, 0.0, 5.0),)
    assert torque_through(state(beside, x=((2.0, 1.0), (2.0, -1.0))), [1.5, 3.0]) == pytest.approx([0.0, 0.0])


def test_angular_momentum_of_what_is_inside_changes_by_what_passes():
    """Random forces: torque in at the inner ring less torque through a circle is that on orbits and spins inside."""
    rng = np.random.default_rng(1)
    rows = [(*row[:4], *rng.normal(size=2)) for row in CHAIN]
    s = state(rows)
    through = torque_through(s, [1.0 + 1e-9, 3.0])
    on_first = rows[0][2] * rows[0][5] - rows[1][2] * rows[1][5]  # x f_y of all contacts of disc 1, about the centre
    assert through[0] - through[1] == pytest.approx(on_first, rel=1e-12)


def test_sums_inside_circles_and_torque_of_forces():
    s = state(())
    assert np.array_equal(sum_inside(s, [1.0, 3.0, 6.0], [10.0, 5.0]), [0.0, 10.0, 15.0])
    assert np.array_equal(torque_of(s, np.array([[7.0, 1.0], [0.0, -2.0]])), [2.0, -8.0])


def test_rigid_rotation_held_by_the_centripetal_force_leaves_nothing_over():
    omega = 0.7
    angle = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    x = 2.5 * np.column_stack([np.cos(angle), np.sin(angle)])
    v = omega * np.column_stack([-x[:, 1], x[:, 0]])
    subject = Subject(cells=make_cells("rings:4", state((), x=x, v=v)))
    force = np.column_stack([np.full(20, -3.0 * omega**2 * 2.5), np.zeros(20)])
    assert np.abs(momentum_rest(subject.cells, force, subject.velocity)).max() < 1e-13
    assert np.abs(momentum_rest(subject.cells, 0 * force, subject.velocity)).max() > 0.1


def test_rest_is_r_times_the_net_force_per_area():
    subject = Subject(cells=make_cells("rings:1", state(CHAIN)))
    area = np.pi * (25 - 1)
    expected = 3.0 * np.array([0.5 - 0.5, 6.0 - 1.2]) / area  # forces between discs cancel
    assert momentum_rest(subject.cells, net_force(subject.ends), subject.velocity)[0] == pytest.approx(expected)
