"""What LIGGGHTS 3.8.0 does wrong, shown on the installed version; a test that fails here means that it was repaired."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.engines.liggghts import LIGGGHTS, defects
from harness.engines.liggghts.deck import INPUT
from harness.engines.protocol import Prescribed
from harness.scene.contact import HystereticNormal, LinearNormal, SpringRolling, SpringSliding
from harness.scene.system import Constant, Loaded

pytestmark = pytest.mark.needs_liggghts

R, DT, UNIT = 1e-3, 1e-6, 1e-6
ELASTIC = LinearNormal(normal_stiffness=1e5, normal_damping=0.0, attraction="allowed")
PLASTIC = HystereticNormal(loading_stiffness=5e4, unloading_stiffness=1e5, adhesion_stiffness=5e4, normal_damping=0.0)
STICKY = HystereticNormal(
    loading_stiffness=5e4, unloading_stiffness=1.5e5, adhesion_stiffness=1e5, normal_damping=0.0
)
DAMPED = HystereticNormal(loading_stiffness=5e4, unloading_stiffness=1e5, adhesion_stiffness=5e4, normal_damping=0.5)
SPRING = SpringSliding(shear_friction=0.5, shear_stiffness=3e4, shear_damping=0.0)
ROLLING = SpringRolling(rolling_friction=0.1, rolling_stiffness=2e4, rolling_damping=0.0)


def told(name: str) -> str:
    """Return what to do when a defect is gone."""
    assert name in {d.name for d in LIGGGHTS.known_defects()}
    version = LIGGGHTS.probe().version
    return f"LIGGGHTS {version} no longer shows '{name}': take it out of defects.py, and what avoids it"


def pair(make, path: Prescribed, **laws):
    return make(x=path.x[0], radius=R, mass=6e-5, dt=DT, contacts=False, **laws)


def head_on(overlaps, *, slip=0.0, dimension=2, roll=None, twist=None) -> Prescribed:
    """Two bodies on the x axis with these overlaps (UNIT), body 2 sliding by with `slip` (m/s) at the rows it names."""
    overlaps = np.array([-20.0, *overlaps]) * UNIT
    x, v = np.zeros((len(overlaps), 2, dimension)), np.zeros((len(overlaps), 2, dimension))
    spin = np.zeros((len(overlaps), 2, 2 * dimension - 3))
    x[:, 1, 0] = 2.0 * R - overlaps
    v[1:, 1, 1] = slip
    if roll is not None:
        spin[1:, 0, -1] = roll
        spin[1:, 1, -1] = -np.asarray(roll)
    if twist is not None:
        spin[1:, 0, 0] = twist
    return Prescribed(x=x, v=v, spin=spin)


def test_every_defect_is_shown_here():
    """By name: each constant of `defects` is used by a test of this module."""
    words = {name for name in vars(defects) if name.isupper() and isinstance(vars(defects)[name], str)}
    source = Path(__file__).read_text()
    assert all(f"defects.{word}" in source for word in words)
    assert {vars(defects)[word] for word in words} == {d.name for d in LIGGGHTS.known_defects()}


def test_history_outlives_its_contact(make, lead, answer):
    slip = np.array([1.0] * 10 + [0.0] * 12)
    path = head_on([10.0] * 10 + [-5.0] * 6 + [10.0] * 6, slip=slip)
    system = pair(make, path, normal=ELASTIC, sliding=SPRING)
    right = answer(system, path).force[-1, 0, 1]
    lists = "delay 0 every 1 check yes"
    naive = lead(system, path, ("delay 0 every 1 check no", lists)).force[-1, 0, 1]
    avoided = lead(system, path, ("delay 0 every 1 check no", f"{lists} contact_distance_factor 1.01"), name="avoided")
    assert right == avoided.force[-1, 0, 1] == 0.0
    assert abs(naive) > 0.1, told(defects.OPENING)


def test_plastic_overlap_lost_by_sorting(make, lead, answer):
    """A pair with a plastic overlap makes half a turn, past which atoms are sorted the other way round."""
    loaded = head_on([*range(-15, 41, 5), *[30.0] * 41])
    turn = np.concatenate([np.zeros(13), np.linspace(0.0, np.pi, 41)])
    half = 0.5 * (loaded.x[:, 1, :1] - loaded.x[:, 0, :1])
    arm = half * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    path = replace(loaded, x=np.stack([-arm, arm], axis=1))
    system = pair(make, path, normal=PLASTIC)
    forces = {
        name: np.linalg.norm(lead(system, path, ("sort 0 0", words), name=name).force[-1, 0])
        for name, words in (("naive", f"sort 1 {R}"), ("avoided", "sort 0 0"))
    }
    right = np.linalg.norm(answer(system, path).force[-1, 0])
    assert forces["avoided"] == pytest.approx(right, rel=1e-12)
    assert forces["naive"] == pytest.approx(PLASTIC.loading_stiffness * 30.0 * UNIT, rel=1e-9), told(defects.SORTING)


def test_plastic_overlap_lost_at_a_periodic_boundary(make, deck):
    """Two discs that stick to each other fly; the same flight is taken away from and across the boundary."""
    def speeds(name: str, shift: float) -> np.ndarray:
        system = make(
            x=[[2e-3 + shift, 5e-3], [4e-3 - 2e-6 + shift, 5e-3]], v=[[2.3, 0], [1.7, 0]], radius=R, mass=6e-5, dt=1e-6,
            steps=1600, normal=STICKY, contacts=False, periodic=(20e-3, 0.0),
        )
        assert "periodic boundary" in " ".join(s.note for s in LIGGGHTS.supports(system) if s.level == "unsupported")
        folder = deck(system, name)
        assert LIGGGHTS.run(folder, time_limit=60).status == "completed"
        return np.sort(LIGGGHTS.read(folder, system).frames[-1].particles["vx"])

    inside, across = speeds("inside", 0.0), speeds("across", 15e-3)
    assert np.abs(inside - across).max() > 1e-3, told(defects.PERIODIC)


def test_adhesion_dropped_by_default(make, lead, answer):
    path = head_on([*range(-15, 41, 5), *range(35, 4, -5)])
    system = pair(make, path, normal=PLASTIC)
    pull = answer(system, path).force[:, 0, 0].max()
    assert pull > 0.1
    assert lead(system, path).force[:, 0, 0].max() == pytest.approx(pull, rel=1e-12)
    naive = lead(system, path, ("limitForce off", ""), name="naive").force[:, 0, 0].max()
    assert naive == 0.0, told(defects.LIMIT_FORCE)


def runs_with_and_without_output(make, deck, **laws) -> np.ndarray:
    """Return the spins after an oblique collision of two discs, with (row 0) and without contact output."""
    ends = []
    for contacts in (True, False):
        system = make(
            x=[[0, 0], [2.0e-3, 0.2e-3]], v=[[0.6, 0.3], [-0.6, -0.1]], spin=[200.0, -100.0], radius=R, mass=6e-5,
            dt=2.5e-7, steps=800, frame_every=1, sample_every=100, contacts=contacts, **laws,
        )
        judged = {s.effect: s.level for s in LIGGGHTS.supports(system)}
        assert (judged.get("contact output") == "unsupported") == contacts
        folder = deck(system, f"contacts_{contacts}")
        assert LIGGGHTS.run(folder, time_limit=60).status == "completed"
        ends.append(LIGGGHTS.read(folder, system).frames[-1].particles["wz"])
    return np.array(ends)


def test_friction_changed_by_contact_output(make, deck):
    told_run, silent = runs_with_and_without_output(make, deck, normal=DAMPED, sliding=SPRING)
    assert np.abs(told_run - silent).max() > 1e-4 * np.abs(silent).max(), told(defects.CUT_BY_OUTPUT)


def test_rolling_changed_by_contact_output(make, deck):
    told_run, silent = runs_with_and_without_output(make, deck, normal=PLASTIC, sliding=SPRING, rolling=ROLLING)
    assert np.abs(told_run - silent).max() > 1e-3 * np.abs(silent).max(), told(defects.ROLLED_BY_OUTPUT)


def test_rolling_moved_by_the_setup(make, deck, kernel_frames):
    """One step from a state that touches and spins: the couple is one of two steps."""
    system = make(
        x=[[0, 0], [1.99e-3, 0]], spin=[20.0, -20.0], radius=R, mass=6e-5, dt=1e-7, steps=2, frame_every=1,
        sample_every=1, contacts=False, normal=PLASTIC, rolling=ROLLING,
    )
    assert "set-up" in " ".join(s.note for s in LIGGGHTS.supports(system) if s.level == "unsupported")
    right = kernel_frames(system)[1].spin[0, 0] - 20.0
    folder = deck(system)
    assert LIGGGHTS.run(folder, time_limit=60).status == "completed"
    found = LIGGGHTS.read(folder, system).frames[1].particles["wz"][0] - 20.0
    assert abs(found / right - 1.0) > 0.5, told(defects.ROLLED_BY_SETUP)


def test_rolling_couple_fixed_in_space(make, lead):
    """Two spheres roll about z, then turn together by a right angle about the line between them."""
    rows, turning = 20, 40
    path = head_on([10.0] * (rows + turning), dimension=3, roll=np.array([50.0] * rows + [0.0] * turning))
    path.spin[1 + rows:, :, 0] = 0.5 * np.pi / (turning * DT)
    system = pair(make, path, normal=ELASTIC, sliding=SPRING, rolling=ROLLING)
    torque = lead(system, path).torque
    before, after = torque[rows - 1, 0], torque[-1, 0]
    assert abs(before[2]) > 10.0 * abs(before[1])
    assert after == pytest.approx(before, rel=1e-6, abs=1e-6 * abs(before[2])), told(defects.FIXED_IN_SPACE)


def test_torsion_and_rolling_share_a_memory(make, lead):
    """Two spheres roll up to the limit, then twist: rolling has stopped, so its couple has no reason to change."""
    rows = 40
    path = head_on(
        [30.0] * 2 * rows, dimension=3, roll=np.array([400.0] * rows + [0.0] * rows),
        twist=np.array([0.0] * rows + [400.0] * rows),
    )
    system = pair(make, path, normal=PLASTIC, rolling=ROLLING)
    couples = lead(system, path).torque[:, 0, 2]
    assert couples[-1] == pytest.approx(couples[rows - 1], rel=1e-12)
    torn = lead(system, path, ("limitForce off", "limitForce off torsion on"), name="torsion").torque[:, 0, 2]
    assert abs(torn[-1]) < 0.9 * abs(couples[-1]), told(defects.TORSION_OVERWRITES)


def test_lost_particles_not_told(make, deck):
    system = make(x=[[0, 0], [4.0, 0]], v=[[-1.0, 0], [0, 0]], steps=4000, dt=1e-2, gn=0.0)
    folder = deck(system)
    text = (folder / INPUT).read_text()
    assert "thermo_modify lost error" in text
    data = (folder / "packing.data").read_text()
    edge = next(line for line in data.splitlines() if line.endswith("xlo xhi"))
    (folder / "packing.data").write_text(data.replace(edge, "-3 12 xlo xhi"))
    (folder / INPUT).write_text(text.replace("thermo_modify lost error", "thermo_modify"))
    result = LIGGGHTS.run(folder, time_limit=60)
    assert (result.status, result.reason) == ("unstable", "1 of 2 atoms were lost"), told(defects.LOST)


def test_mesh_force_counted_twice(make, plane, deck):
    """A lid with a mass lies on a disc: its force at step 0, without the deck's correction."""
    lid = plane(2, "lid", (0, 0.95), (0, -1), False, Loaded(mass=0.7, load=3.0, stress=0.0, span=None, damping=0.4))
    floor = plane(1, "floor", (0, 0), (0, 1), False, Constant(velocity=(0.0, 0.0)))
    system = make(x=[[0, 0.475]], walls=[floor, lid], gn=0.0, steps=4, frame_every=4, sample_every=1)
    folder = deck(system)
    text = (folder / INPUT).read_text()
    correction = "*(1.0-0.5*(step==0))"
    assert correction in text
    (folder / INPUT).write_text(text.replace(correction, ""))
    assert LIGGGHTS.run(folder, time_limit=60).status == "completed"
    force = LIGGGHTS.read(folder, system).series["lid_fy"][0]
    assert force == pytest.approx(2.0 * 200.0 * 0.025), told(defects.TWICE)
