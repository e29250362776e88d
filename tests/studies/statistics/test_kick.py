"""Kicks: one disc, by as much as declared, reproducible, another for every name."""

import numpy as np
import pytest

from harness.studies.statistics.kick import KICK, kick_seed, kicked


def test_one_disc_is_moved_by_a_kick(box):
    system = box.system
    moved = kicked(system, "lammps", 1).particles.x - system.particles.x
    (particle,) = np.flatnonzero(moved.any(axis=1))
    largest = np.abs(system.particles.x).max()
    ulp = np.spacing(largest)
    assert np.linalg.norm(moved[particle]) == pytest.approx(KICK * largest, abs=ulp)
    assert 4 * 2**-53 * largest < np.linalg.norm(moved[particle]) < 20 * ulp


def test_nothing_else_changes(box):
    system = box.system
    other = kicked(system, "lammps", 1)
    assert other.with_(particles=system.particles) == system
    for name in ("radius", "mass", "v", "spin", "inertia_factor"):
        assert np.array_equal(getattr(other.particles, name), getattr(system.particles, name))


def test_the_same_name_is_the_same_kick_and_another_another(box):
    system = box.system
    names = [("lammps", 1), ("lammps", 2), ("liggghts", 1), ("response",)]
    digests = {kicked(system, *name).digest() for name in names}
    assert len(digests | {system.digest()}) == 5
    assert kicked(system, "lammps", 1).digest() == kicked(box.system, "lammps", 1).digest()


def test_the_seed_follows_from_the_content(box):
    faster = box.system.with_(dt=1.01 * box.system.dt)
    assert kick_seed(box.system, "a") != kick_seed(faster, "a")
    renamed = box.system.with_(scene_name="other", title="other")
    assert kick_seed(box.system, "a") == kick_seed(renamed, "a")


def test_a_lone_disc_at_the_origin_cannot_be_kicked(box):
    from dataclasses import replace

    p = box.system.particles
    alone = {n: getattr(p, n)[:1] for n in ("radius", "mass", "v", "spin", "inertia_factor")}
    lone = replace(p, x=np.zeros((1, 2)), **alone)
    with pytest.raises(ValueError, match="lost"):
        kicked(box.system.with_(particles=lone), "a")
