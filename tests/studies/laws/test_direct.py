"""Codes against each other: kernels in two conventions stand for the codes."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harness.engines.protocol import Reaction
from harness.engines.registry import ENGINES
from harness.runs.pool import run_many
from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.cases import CASES
from harness.studies.laws.collisions import collision_system
from harness.studies.laws.direct import code_pairs, convention_differences, direct_checks, direct_collisions
from harness.studies.laws.drive import Driver, Job
from harness.studies.laws.reach import reach
from harness.studies.laws.stepped import Stepper
from postproc.trajectory import read_trajectory
from reference.kernel.conventions import NAMED

PAIR = ("lammps", "liggghts")
PLACE = arrangement("pair", 2)


def as_code(done, name):
    return replace(done, job=replace(done.job, engine=SimpleNamespace(name=name)))


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """driven(laws) is one run by code, of pairs in 2D."""
    driver = Driver(root=tmp_path_factory.mktemp("runs"), time_limit=60.0, workers=1)

    def drive(laws):
        runs = [driver.drive(Job(laws=CASES[laws], engine=ENGINES[f"kernel:{c}"], arrangement=PLACE)) for c in PAIR]
        assert [r.status for r in runs] == ["completed", "completed"]
        return {name: as_code(run, name) for name, run in zip(PAIR, runs, strict=True)}

    return drive


def judged(runs, laws):
    left, right = ({run.part: run} for run in runs.values())
    return {c.what: c for c in direct_checks(CASES[laws], left, right, Stepper(laws=CASES[laws]), "again")}


def test_pairs_are_of_codes():
    assert code_pairs(["lammps", "liggghts", "kernel:talk", "yade"]) == [
        ("lammps", "liggghts"), ("lammps", "yade"), ("liggghts", "yade"),
    ]
    assert code_pairs(["kernel:talk", "kernel:lammps"]) == []


def test_what_conventions_differ_by_is_known_to_rounding(driven):
    checks = judged(driven("hertz+mindlin"), "hertz+mindlin")
    assert set(checks) == set(PLACE.motions)
    assert checks["load"].verdict == "agrees"
    for motion in ("shear", "load_shear", "mixed"):
        c = checks[motion]
        assert (c.verdict, c.left, c.right) == ("known_difference", *PAIR)
        assert c.deviation > 0.5
        assert c.deviation == pytest.approx(c.tolerance, abs=1e-12)
        assert c.off < 1e-13
        assert "Coulomb's limit cuts: spring and dashpot together / the spring alone" in c.why
        assert "slip of pairs at: R / R - overlap/2" in c.reasons


def test_without_friction_there_is_no_difference(driven):
    checks = judged(driven("hertz"), "hertz")
    assert {c.verdict for c in checks.values()} == {"agrees"}
    assert convention_differences(CASES["hertz"], NAMED["lammps"], NAMED["liggghts"]) == []


def test_differences_are_named_where_they_matter():
    def words(laws):
        return [w.partition(": ")[0] for w in convention_differences(CASES[laws], *(NAMED[c] for c in PAIR))]

    arms = ["slip of pairs at", "slip on planes at", "lever of friction on planes"]
    assert words("linear+spring") == words("linear+viscous") == arms
    assert words("hertz+mindlin") == words("linear+spring_damped") == [*arms, "Coulomb's limit cuts"]
    assert words("linear+rolling")[0] == "the limit of rolling cuts"
    assert "the couple of constant size is of" in words("linear+spring+rolling_constant")


def test_anything_else_differs(driven):
    runs = driven("linear+spring")
    force = runs["liggghts"].reaction.force.copy()
    row = PLACE.tracks_of("shear")[0].bodies[0]
    force[80, row] *= 1 + 1e-9
    wrong = replace(runs["liggghts"], reaction=Reaction(force=force, torque=runs["liggghts"].reaction.torque))
    checks = judged(runs | {"liggghts": wrong}, "linear+spring")
    assert [m for m, c in checks.items() if c.verdict == "differs"] == ["shear"]
    assert checks["shear"].why.endswith("rerun: again")
    assert checks["shear"].off > 1e-10


def test_a_code_of_unknown_conventions_is_not_judged_by_them(driven):
    runs = driven("linear+spring")
    yade = {"lammps": runs["lammps"], "yade": as_code(runs["liggghts"], "yade")}
    checks = judged(yade, "linear+spring")
    assert checks["shear"].verdict == "inconclusive"
    assert (checks["shear"].tolerance, checks["shear"].off) == (None, None)
    assert checks["load"].verdict == "agrees"


def test_codes_that_are_equal_where_their_conventions_differ_differ(driven):
    """One of the two does not what it is known to do."""
    runs = driven("linear+spring")
    checks = judged(runs | {"liggghts": as_code(runs["lammps"], "liggghts")}, "linear+spring")
    assert checks["shear"].deviation == 0.0
    assert checks["shear"].verdict == "differs"
    assert checks["load"].verdict == "agrees"


def test_two_versions_of_a_code_must_agree(driven):
    run = driven("linear+spring")["lammps"]
    checks = judged({"lammps": run, "lammps@2": as_code(run, "lammps@2024.8")}, "linear+spring")
    assert {c.verdict for c in checks.values()} == {"agrees"}


def test_parts_that_one_code_lacks_are_left_out(driven):
    runs = driven("linear+spring")
    laws = CASES["linear+spring"]
    assert direct_checks(laws, {"pairs in 2D": runs["lammps"]}, {}, Stepper(laws=laws), "again") == []


@pytest.fixture(scope="module")
def collided(tmp_path_factory):
    laws = CASES["linear+viscous"]
    jobs = [(c, ENGINES[f"kernel:{c}"], collision_system(laws)) for c in PAIR]
    done = run_many(jobs, tmp_path_factory.mktemp("runs"), time_limit=60.0)
    runs = {d.label: read_trajectory(d.folder / "trajectory.h5") for d in done}
    return runs | {f"kernel:{c}": run for c, run in runs.items()}


def test_collisions_are_compared_with_what_the_kernels_differ_by(collided):
    laws = CASES["linear+viscous"]
    checks = direct_collisions(laws, collided, PAIR, "again")
    assert [c.what for c in checks] == [f"collisions, {w}" for w in ("displacement", "velocity", "spin")]
    assert {c.verdict for c in checks} == {"known_difference"}
    assert all(1e-6 < c.deviation == c.tolerance for c in checks)
    equal = collided | {"liggghts": collided["lammps"]}
    assert {c.verdict for c in direct_collisions(laws, equal, PAIR, "again")} == {"differs"}
    same = equal | {"kernel:liggghts": collided["lammps"]}
    assert {c.verdict for c in direct_collisions(laws, same, PAIR, "again")} == {"agrees"}
    other = collided | {"kernel:liggghts": collided["lammps"]}
    assert {c.verdict for c in direct_collisions(laws, other, PAIR, "again")} == {"differs"}
    alone = {c: collided[c] for c in PAIR}
    assert {c.verdict for c in direct_collisions(laws, alone, PAIR, "again")} == {"inconclusive"}
    assert direct_collisions(laws, {"lammps": collided["lammps"]}, PAIR, "again") == []


@pytest.mark.parametrize(("laws", "expected"), [
    ("linear+spring", (1.0, 1.0)), ("linear+spring_damped", (1.0, 1.2865)), ("hertz+mindlin", (1.0, 3.4887)),
])
def test_how_much_friction_carries(laws, expected, driven):
    """LIGGGHTS adds the dashpot to a spring that sticks."""
    for (name, run), most in zip(driven(laws).items(), expected, strict=True):
        found = reach(run, name)
        assert (found.laws, found.engine) == (laws, name)
        assert found.found == pytest.approx(most, rel=1e-4)
        assert found.found == pytest.approx(found.by_form, rel=1e-12)
        assert found.found >= 1.0 - 1e-12


def test_the_dashpot_is_what_friction_carries_more():
    """1 + gamma_t v/(mu f_n) of Mindlin's law at the depth of the shear, by hand, is the most that there can be."""
    laws, radius, mass = CASES["hertz+mindlin"], PLACE.grains.reduced_radius("pair"), PLACE.grains.reduced_mass("pair")
    overlap, e = 31.5 * 2.0**-20, 0.6
    contact = np.sqrt(radius * overlap)
    f_n = 4 / 3 * 1e8 / (2 * (1 - 0.25**2)) * contact * overlap
    stiffness = 8 * 1e8 / (4 * (2 - 0.25) * (1 + 0.25)) * contact
    gamma = np.sqrt(10 / 3) * -np.log(e) / np.hypot(np.log(e), np.pi) * np.sqrt(stiffness * mass)
    most = 1 + gamma * 1.125 / (laws.sliding.shear_friction * f_n)
    assert 3.4887 < most < 3.9
    assert most - 3.4887 < stiffness * 1.125 * 2.0**-20 / (laws.sliding.shear_friction * f_n)


def test_no_reach_without_friction(driven):
    assert reach(driven("hertz")["lammps"], "lammps") is None
