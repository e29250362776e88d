"""Collisions that the kernel cannot compute: what flies alone, what it is compared with, and what a wrong code gets."""

from dataclasses import replace

import numpy as np
import pytest

from harness.studies.laws.cases import CASES
from harness.studies.laws.collisions import PAIRS, STEPS, TOLERANCE, collision_system, exits, whole_checks
from harness.studies.laws.flights import flown
from harness.studies.laws.judge import STEPPED
from postproc.snapshot import Columns

LAWS = CASES["jkr"]
SYSTEM = collision_system(LAWS)


@pytest.fixture(scope="module")
def flight():
    return flown(LAWS, SYSTEM)


def test_only_what_is_central_and_holds_on_flies():
    assert [name for name in CASES if flown(CASES[name], collision_system(CASES[name])) is not None] == ["jkr"]
    assert flown(LAWS, collision_system(replace(LAWS, floor=True))) is None
    assert flown(replace(LAWS, sliding=CASES["hertz+mindlin"].sliding), SYSTEM) is None


def test_a_flight_begins_where_the_system_does_and_ends_apart(flight):
    first, last = flight.frames[0].particles, flight.frames[-1].particles
    assert flight.steps[-1] == STEPS
    assert np.array_equal(first.vector("x", "y", "z"), SYSTEM.particles.x)
    assert np.array_equal(first.vector("vx", "vy", "vz"), SYSTEM.particles.v)
    assert np.array_equal(last.vector("wx", "wy", "wz"), SYSTEM.particles.spin)
    x = last.vector("x", "y", "z").reshape(PAIRS, 2, 3)
    assert (np.linalg.norm(x[:, 0] - x[:, 1], axis=1) > 1.01 * sum(LAWS.grains.radii)).all()


def test_the_exit_is_the_tabulated_one_to_the_order_of_the_step(flight):
    (one,) = exits(LAWS, "lammps", flight)
    assert one.value.name == "restitution_jkr"
    assert 1e-5 < one.deviation < one.value.tolerance


def changed(flight, name, factor):
    frames = [
        replace(f, particles=Columns(dict(f.particles) | {name: factor * f.particles[name]}, "particles"))
        for f in flight.frames
    ]
    return replace(flight, frames=tuple(frames))


@pytest.mark.parametrize("name", ["x", "vy", "wz"])
def test_a_code_that_flies_otherwise_differs(flight, name):
    same = whole_checks(LAWS, "lammps", flight, flight, "again", right=STEPPED)
    assert [(c.verdict, c.right) for c in same] == [("agrees", STEPPED)] * 3
    checks = whole_checks(LAWS, "lammps", changed(flight, name, 1 + 1e3 * TOLERANCE), flight, "again", right=STEPPED)
    assert "differs" in {c.verdict for c in checks}


def test_a_code_that_lets_go_at_overlap_zero_differs(flight, monkeypatch):
    from reference.analytic import central_flight

    monkeypatch.setattr(central_flight, "jkr_overlap_of_largest_pull", lambda *_: 0.0)
    early = flown(LAWS, SYSTEM)
    checks = whole_checks(LAWS, "lammps", early, flight, "again", right=STEPPED)
    assert max(c.deviation for c in checks) > 1e-3
