"""The collisions: who meets whom, and how numbers are read off them."""

import numpy as np
import pytest

from harness.engines.registry import ENGINES
from harness.runs.pool import run_many
from harness.studies.laws.cases import CASES
from harness.studies.laws.collisions import (
    HEAD_ON,
    ON_FLOOR,
    SLIDING,
    SPEED,
    TOLERANCE,
    collision_system,
    exit_check,
    exits,
    impacts,
    whole_checks,
)
from harness.studies.laws.motions import EQUAL_RADII, UNEQUAL
from postproc.trajectory import read_trajectory


@pytest.mark.parametrize(("grains", "floor"), [(UNEQUAL, True), (EQUAL_RADII, False)])
def test_bodies_start_apart_and_meet_their_partner_only(grains, floor):
    made = impacts(grains, floor=floor)
    radius = np.array(grains.radii)[made.role]
    for i in range(len(radius)):
        for j in range(i + 1, len(radius)):
            gap = np.linalg.norm(made.x[i] - made.x[j]) - radius[i] - radius[j]
            partners = i % 2 == 0 and j == i + 1 and j < ON_FLOOR
            assert (0.0 < gap < 2.1e-5) if partners else gap > 2e-3
    if floor:
        height = made.x[:, 1] - radius
        assert (height[ON_FLOOR:] < 2.1e-5).all()
        assert (height[ON_FLOOR:] > 0.0).all()
        assert (height[:ON_FLOOR] > 5e-3).all()


def test_impacts_made_for_closed_forms_are_what_they_say():
    made = impacts(UNEQUAL, floor=True)
    for first in (HEAD_ON, SLIDING):
        branch, approach = made.x[first] - made.x[first + 1], made.v[first] - made.v[first + 1]
        assert np.cross(branch, approach) == pytest.approx(0.0, abs=1e-18)
        assert -approach[0] == pytest.approx(SPEED)
    assert not made.spin[HEAD_ON : HEAD_ON + 2].any()
    assert made.spin[SLIDING : SLIDING + 2].tolist() == [[0.0, 0.0, 1500.0]] * 2
    assert made.v[ON_FLOOR].tolist() == [0.0, -SPEED, 0.0]
    assert not made.spin[ON_FLOOR].any()


@pytest.fixture(scope="module")
def trajectories(tmp_path_factory):
    names = ("hysteretic", "elastic+spring_damped")
    jobs = [(n, ENGINES["kernel:lammps"], collision_system(CASES[n])) for n in names]
    done = run_many(jobs, tmp_path_factory.mktemp("runs"), time_limit=60.0)
    return {d.label: read_trajectory(d.folder / "trajectory.h5") for d in done}


def test_exit_values_are_within_their_tolerance(trajectories):
    for name, run in trajectories.items():
        found = exits(CASES[name], "kernel:lammps", run)
        assert len(found) == 1
        check = exit_check(found[0], "again")
        assert check.verdict == "agrees"
        assert 0.0 < check.deviation < check.tolerance


def test_whole_collisions_are_compared_in_places_velocities_and_spins(trajectories):
    laws, run = CASES["elastic+spring_damped"], trajectories["elastic+spring_damped"]
    same = whole_checks(laws, "lammps", run, run, "again", right="kernel:lammps")
    assert [(c.verdict, c.deviation, c.tolerance) for c in same] == [("agrees", 0.0, TOLERANCE)] * 3
    other = whole_checks(laws, "lammps", run, trajectories["hysteretic"], "again", right="kernel:lammps")
    assert [c.verdict for c in other] == ["differs"] * 3


def test_all_bodies_have_met_and_parted(trajectories):
    for run in trajectories.values():
        before, after = (f.particles.vector("vx", "vy", "vz") for f in (run.frames[0], run.frames[-1]))
        assert (np.abs(after - before).max(axis=1) > 0.05).all()
        still = run.frames[-2].particles.vector("vx", "vy", "vz")
        assert after == pytest.approx(still, abs=1e-12)
