"""The monitors: exact energies of collisions, what is not known, and that watching alters no bit."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from harness.cli import main
from harness.engines.registry import ENGINES, find_engine
from harness.report.run import run_answer, write_run_files
from harness.runs.execute import same_trajectory
from harness.runs.outcome import read_outcome
from harness.studies.single import single_run
from harness.studies.stability.cases import shipped_folder
from harness.studies.watch import watch, watch_folder
from harness.studies.watch.remarks import ENERGY as ENERGY_LIMIT
from harness.studies.watch.remarks import largest_energy
from harness.studies.watch.watch import Watch, at_least_made
from postproc.snapshot import Columns
from postproc.trajectory import Trajectory, read_trajectory

M_STAR, STIFFNESS, SPEED = 5e-7, 1e5, 1.0
ENERGY = 0.5 * M_STAR * SPEED**2
PASSED = "pairs that passed through each other"


@pytest.fixture
def made(tmp_path):
    """made(file) runs a scene on the kernel and watches it."""

    def run(file, engine="kernel", out="out", watched=True):
        return single_run(file, find_engine(engine), tmp_path / out, time_limit=60, watched=watched)

    return run


def test_elastic_collision_keeps_energy_and_momentum(made, head_on):
    seen = made(head_on()).watch
    assert np.abs(seen.curves["dissipated"]).max() < 1e-3 * ENERGY
    assert seen.curves["momentum"].max() < 1e-18
    deepest = SPEED * math.sqrt(M_STAR / STIFFNESS) / 1e-3
    assert seen.curves["largest overlap"].max() == pytest.approx(deepest, rel=1e-3)
    assert seen.curves["elastic energy, normal"].max() == pytest.approx(ENERGY, rel=2e-3)
    assert seen.curves["lost particles"].max() == seen.curves["numbers not finite"].max() == 0.0
    assert "rotational energy" not in seen.curves
    assert "work of walls" not in seen.curves


def test_dashpot_takes_what_the_restitution_says(made, head_on):
    gamma = 0.05
    b = gamma / (2 * M_STAR)
    e = math.exp(-math.pi * b / math.sqrt(STIFFNESS / M_STAR - b**2))
    seen = made(head_on(gamma)).watch
    assert seen.curves["dissipated"][-1] == pytest.approx(ENERGY * (1 - e**2), rel=1e-2)
    assert seen.made < 1e-3 * ENERGY


def test_displacement_per_step_is_that_of_the_fastest(made, head_on):
    done = made(head_on())
    assert done.watch.curves["largest displacement per step"][0] == pytest.approx(0.5 * done.system.dt / 1e-3)


def test_work_of_a_wall_is_the_energy_that_it_gives(made, pushed):
    """The disc leaves with 2 u: m (2 u)^2/2."""
    seen = made(pushed()).watch
    given = 0.5 * 1e-6 * 0.2**2
    assert seen.curves["work of walls"][-1] == pytest.approx(given, rel=2e-3)
    assert abs(seen.curves["dissipated"][-1]) < 2e-3 * given
    assert seen.work_error < 2e-3 * given


def test_static_residual_is_the_force_on_a_pressed_pair_over_itself(made, head_on):
    """While two discs press each other the net force on each is the contact force."""
    seen = made(head_on()).watch
    pressed = seen.curves["largest overlap"] > 0
    assert seen.curves["static residual"][pressed] == pytest.approx(1.0)
    assert (seen.curves["static residual"][~pressed] == 0.0).all()


def test_weight(made, head_on):
    """Falling discs: what weight gives is what they move with."""
    seen = made(head_on(more="gravity = [0.0, -9.81]")).watch
    assert np.abs(seen.curves["dissipated"]).max() < 1e-3 * ENERGY
    assert seen.curves["energy of weight"][-1] < 0.0


def test_turning_ring_does_work_against_the_torque(made, head_on):
    from harness.scene.system import Ring
    from harness.studies.watch.energies import work_of_walls
    from harness.studies.watch.state import state_of

    done = made(head_on())
    ring = Ring(
        index=1, name="inner", centre=(0.0, 0.0), circle=1.0, omega=3.0,
        x=np.array([[1.0, 0.0]]), radius=np.array([0.1]),
    )
    time = np.linspace(0.0, done.trajectory.frames[-1].time, 11)
    series = Columns({"time": time, "inner_torque": np.full(11, -2.0)}, "series")
    states = [state_of(done.system, done.trajectory.frames[k]) for k in (0, -1)]
    work = work_of_walls(done.system.with_(rings=(ring,)), replace(done.trajectory, series=series), states)
    assert work.done == pytest.approx([0.0, 6.0 * time[-1]])


def test_what_a_law_with_memory_holds_is_not_known(made, head_on):
    law = 'normal = {law = "hysteretic", loading_stiffness = 1e5, unloading_stiffness = 2e5, adhesion_stiffness = 0.0, '
    seen = made(head_on(normal=law + "normal_damping = 0.0}")).watch
    assert "does not follow from the overlap" in seen.absent["elastic energy, normal"]
    assert seen.absent["dissipated"].startswith("elastic energy, normal")
    assert seen.made is None
    rows = {r["quantity"]: r for r in seen.rows()}
    assert rows["dissipated"]["largest"] is None
    assert rows["kinetic energy"]["largest"] is not None


def test_a_number_that_is_none_is_seen(made, head_on):
    done = made(head_on())
    frame = done.trajectory.frames[3]
    broken = {k: np.array(v) for k, v in frame.particles.items()}
    broken["vx"][0] = np.nan
    frames = list(done.trajectory.frames)
    frames[3] = replace(frame, particles=Columns(broken, "particles"))
    seen = watch(done.system, Trajectory(frames=tuple(frames), steps=done.trajectory.steps, series=None))
    assert seen.curves["numbers not finite"][3] == 1.0
    rows = {r["quantity"]: r for r in seen.rows()}
    assert rows["kinetic energy"]["largest"] is None
    assert rows["kinetic energy"]["note"] == "no finite number"


def test_a_run_that_left_nothing_says_so(made, head_on, tmp_path):
    done = made(head_on())
    crashed = type(done.outcome)(**{
        f: getattr(done.outcome, f) for f in done.outcome.__struct_fields__
    } | {"status": "crashed", "reason": "it did", "trajectory": None})
    seen = watch_folder(find_engine("kernel"), done.system, tmp_path / "nowhere", crashed)
    assert seen.of_frames == 0
    assert all(row["note"].startswith("not available") for row in seen.rows())


ENGINE_NAMES = list(ENGINES)


@pytest.mark.parametrize("name", ENGINE_NAMES)
def test_watching_alters_no_bit_and_no_deck(name, made, head_on):
    """Two folders, one run watched: the same deck, the same trajectory, and nothing left where nobody watched."""
    if not ENGINES[name].probe().available:
        pytest.skip(f"{name} is not installed")
    friction = 'sliding = {law = "spring", shear_friction = 0.5, shear_stiffness = 2e4, shear_damping = 0.01}'
    file = head_on(0.1, normal=f'normal = {{law = "linear", normal_stiffness = 1e5, normal_damping = 0.1, '
                               f'attraction = "allowed"}}\n{friction}')
    plain, seen = made(file, name, "plain", watched=False), made(file, name, "seen")
    assert plain.outcome.deck_digest == seen.outcome.deck_digest
    decks = ENGINES[name].render(plain.system)
    assert all((plain.folder / f).read_bytes() == (seen.folder / f).read_bytes() for f in decks)
    assert same_trajectory(*(read_trajectory(d.folder / "trajectory.h5") for d in (plain, seen)))
    assert plain.watch is None
    assert not (plain.folder / "watch.csv").exists()
    assert "watch" not in json.loads((plain.folder / "outcome.json").read_text())


def test_a_kept_run_is_watched_without_being_made_again(made, head_on):
    plain, seen = made(head_on(), watched=False), made(head_on())
    assert plain.outcome.started == seen.outcome.started
    kept = read_outcome(seen.folder / "outcome.json")
    assert kept.watch["kinetic energy (J)"] == pytest.approx(ENERGY, rel=1e-3)
    assert kept.trajectory == plain.outcome.trajectory


def test_answer_and_page_show_it(made, head_on):
    done = made(head_on())
    write_run_files(done)
    answer = run_answer(done)
    assert {r["quantity"] for r in answer.tables["Watch"]} >= {"kinetic energy", "dissipated"}
    header = (done.folder / "watch.csv").read_text().splitlines()[0]
    assert header.startswith("time (s),kinetic energy (J)")
    assert "data:image/png" in (done.folder / "watch.html").read_text()


# --- remarks -------------------------------------------------------------------------------------------


def remarked(seen):
    return {r.what: r for r in seen.remarks}


def test_sound_collisions_are_not_remarked(made, head_on):
    """Also not at a tenth of a contact time, where the leapfrog's energy swings by 2.5 %."""
    assert made(head_on()).watch.remarks == ()
    coarse = head_on()
    for words in (("dt_fraction = 0.005", "dt_fraction = 0.1"), ("les = 200", "les = 40"), ("mes = 100", "mes = 40")):
        coarse.write_text(coarse.read_text().replace(*words))
    done = made(coarse)
    assert done.watch.made / largest_energy(done.watch.curves) > ENERGY_LIMIT
    assert done.watch.remarks == ()
    assert done.exit_status == 0


def moving(made, head_on, frames):
    """A run of two discs of radius 1 mm whose places and speeds along x are written down, frame by frame."""
    done = made(head_on())
    first = done.trajectory.frames[0]
    found = []
    for k, (xs, vs) in enumerate(frames):
        columns = {name: np.array(first.particles[name]) for name in first.particles}
        columns |= {"x": np.array(xs), "vx": np.array(vs), "y": np.array([0.0, 1e-5])}
        found.append(replace(first, time=1e-5 * k, particles=Columns(columns, "particles")))
    return watch(done.system, Trajectory(frames=tuple(found), steps=tuple(range(len(found))), series=None))


def test_a_pair_that_passed_through_is_remarked(made, head_on):
    """600 m/s each over 1e-5 s: 6 mm, from 5 mm before the other to 7 mm behind it, with no overlap in any frame."""
    fast = [600.0, -600.0]
    remark = remarked(moving(made, head_on, [((0.0, 5e-3), fast), ((6e-3, -1e-3), fast)]))[PASSED]
    assert (remark.size, remark.at) == (1.0, 1e-5)
    assert "order is reversed" in remark.says


@pytest.mark.parametrize("after", [
    ((-0.5e-3, 5.5e-3), [-600.0, 600.0]),  # bounced
    ((0.0, 5e-3), [600.0, -600.0]),  # still before it
    ((9e-3, -4e-3), [600.0, -600.0]),  # not where it would be without the other
])
def test_other_ways_are_not_passing_through(after, made, head_on):
    assert PASSED not in remarked(moving(made, head_on, [((0.0, 5e-3), [600.0, -600.0]), after]))


def test_a_pair_that_flies_by_is_not_remarked(made, head_on):
    """The same speeds, 2.1 radii apart."""
    done = made(head_on())
    first, found = done.trajectory.frames[0], []
    for k, x in enumerate(((0.0, 5e-3), (6e-3, -1e-3))):
        columns = {name: np.array(first.particles[name]) for name in first.particles}
        columns |= {"x": np.array(x), "y": np.array([0.0, 2.1e-3]), "vx": np.array([600.0, -600.0])}
        found.append(replace(first, time=1e-5 * k, particles=Columns(columns, "particles")))
    seen = watch(done.system, Trajectory(frames=tuple(found), steps=(0, 1), series=None))
    assert PASSED not in remarked(seen)


def test_deep_overlaps_and_centres_inside_are_remarked(made, head_on):
    still = [0.0, 0.0]
    deep = remarked(moving(made, head_on, [((0.0, 1.4e-3), still)]))["largest overlap"]
    assert deep.size == pytest.approx(0.6, rel=1e-3)
    assert "small against the radius" in deep.why
    inside = remarked(moving(made, head_on, [((0.0, 0.9e-3), still)]))["largest overlap"]
    assert "inside the other" in inside.why
    assert "largest overlap" not in remarked(moving(made, head_on, [((0.0, 1.6e-3), still)]))


def test_energy_out_of_nothing_is_remarked(made, head_on):
    apart = (0.0, 5e-3)
    seen = moving(made, head_on, [(apart, [1.0, -1.0]), (apart, [1.1, -1.1])])
    made_of_it = remarked(seen)["energy made"]
    assert made_of_it.size == pytest.approx(1 - 1 / 1.21)
    assert "energy made" not in remarked(moving(made, head_on, [(apart, [1.0, -1.0]), (apart, [1.004, -1.004])]))


@pytest.mark.parametrize("name", ["lammps", "liggghts"])
def test_codes_that_let_bodies_pass_are_found_out_on_the_command_line(name, tmp_path, capsys):
    if not ENGINES[name].probe().available:
        pytest.skip(f"{name} is not installed")
    file = shipped_folder() / "pass_through.toml"
    words = ["run", str(file), "--engine", name, "--out", str(tmp_path)]
    assert main(words) == 0, "the code itself says nothing"
    data = tmp_path / "run.json"
    assert main([*words, "--watch", "--json", str(data)]) == 1
    said = capsys.readouterr().out
    assert "not to be trusted: pairs that passed through each other" in said
    rows = json.loads(data.read_text())["remarks"]
    assert {r["remark"] for r in rows} == {PASSED, "largest overlap"}
    (page,) = tmp_path.glob("runs/*/watch.html")
    assert PASSED in page.read_text()


def test_compare_shows_remarks(tmp_path, capsys):
    if not all(ENGINES[name].probe().available for name in ("lammps", "liggghts")):
        pytest.skip("lammps or liggghts is not installed")
    file = shipped_folder() / "pass_through.toml"
    main(["compare", str(file), "--engines", "lammps,liggghts", "--watch", "--out", str(tmp_path)])
    assert "Remarks of the watch" in capsys.readouterr().out
    assert (tmp_path / "remarks.csv").read_text().count(PASSED) == 2
    assert PASSED in (tmp_path / "report.html").read_text()


INCLINE = """
kind = "free"
title = "a disc on a plane, periodic along it"
dimension = 2
duration = 1e-4
gravity = [2.0, -9.5]
periodic = [0.01, 0]
bodies = [{position = [0.0, 0.001], radius = 0.001, mass = 1e-6, velocity = [0.0, -0.01]}]

[contact.normal]
law = "linear"
normal_stiffness = 1e5
normal_damping = 0.1
attraction = "allowed"

[numerics]
dt_fraction = 0.05

[outputs]
samples = 4
frames = 4
contacts = true

[[planes]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 1.0]
friction = false
"""


def test_a_box_that_is_periodic_along_one_axis_leaves_out_what_needs_a_box(made, tmp_path):
    file = tmp_path / "incline.toml"
    file.write_text(INCLINE)
    seen = made(file).watch
    assert "has no box" in seen.absent["static residual"]
    assert seen.curves["kinetic energy"][-1] > 0


def test_what_is_infinite_is_told_without_a_number():
    """Weight acts and nothing presses: JSON knows no such number."""
    seen = Watch(time=np.array([0.0, 1.0]), curves={"static residual": np.array([np.inf, 0.5])}, absent={})
    (row,) = seen.rows()
    assert (row["largest"], row["at time (s)"]) == (None, 0.0)
    assert row["note"] == "no finite number: weight acts and nothing presses"
    json.dumps(seen.rows(), allow_nan=False)


@pytest.mark.parametrize(("taken", "made"), [([0.0, 2.0, 1.0], 0.0), ([0.0, -3.0, 1.0], 3.0)])
def test_springs_that_are_not_recorded_begin_empty(taken, made):
    """What they hold is not known, but not below 0: a balance below 0 is energy made."""
    assert at_least_made({"dissipated or in springs": np.array(taken)}) == made
    assert at_least_made({}) is None
