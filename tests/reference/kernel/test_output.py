"""What a run writes: tables, series, the command line, and that looking does not alter the run."""

import json
import subprocess
import sys

import h5py
import numpy as np
import pytest

from reference.kernel.__main__ import main
from reference.kernel.deck import Plan, read_deck
from reference.kernel.model import Constant, Cosine, Loaded
from reference.kernel.output import contact_table, particle_table, wall_table
from reference.kernel.program.simulation import fastest

CONVENTIONS = ("lammps", "liggghts", "talk")


def crowd(dem, dim, **options):
    walls = dem.box(5.4 if dim == 2 else 3.5, dim, friction=("x0", "y0"))
    return dem.cluster(7, dim, across=3 if dim == 2 else 2, squeeze=0.85, speed=2.0, walls=walls, **options)


def vectors(table, letter, dim):
    return np.column_stack([table[letter + a] for a in "xyz"[:dim]])


# --- tables ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("convention", CONVENTIONS)
def test_pair_rows_are_the_forces_at_the_full_step(dem, dim, convention):
    """The plain DEM, evaluated once more at its full-step velocities, has the same contacts."""
    m = crowd(dem, dim, mu=0.4, gn=10.0, gt=5.0, convention=convention)
    simulation, plain = dem.Simulation(m), dem.Plain(m)
    for _ in range(80):
        simulation.advance()
        plain.advance()
    table = contact_table(simulation)
    pairs = table["j"] > 0
    plain.evaluate(advance=False)
    rows = sorted((r.key, r.overlap, r.force[:dim], r.memory["sliding"][0][:dim]) for r in plain.rows if r.key[1] >= 0)
    assert len(rows) > 5
    got = list(zip(table["i"][pairs] - 1, table["j"][pairs] - 1, strict=True))
    assert got == [key for key, *_ in rows]
    np.testing.assert_allclose(table["overlap"][pairs], [r[1] for r in rows], rtol=0, atol=1e-12)
    np.testing.assert_allclose(vectors(table, "f", dim)[pairs], [r[2] for r in rows], rtol=0, atol=1e-7)
    np.testing.assert_allclose(vectors(table, "u", dim)[pairs], [r[3] for r in rows], rtol=0, atol=1e-11)


@pytest.mark.parametrize("dim", [2, 3])
def test_forces_of_the_rows_add_up(dem, dim):
    """Elastic and frictionless, so that half-step and full-step forces are one: rows give every particle's force."""
    simulation = dem.run(dem.Simulation(crowd(dem, dim)), 60)
    table, n = contact_table(simulation), simulation.model.particle_count
    total = np.zeros((n, dim))
    for i, j, f in zip(table["i"], table["j"], vectors(table, "f", dim), strict=True):
        total[int(i) - 1] += f
        if j > 0:
            total[int(j) - 1] -= f
    np.testing.assert_allclose(total, simulation.state.force[:, :n].T, rtol=0, atol=1e-9)
    assert (table["j"] < 0).any()
    assert "ux" not in table


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("steps", [0, 60])
def test_wall_rows_add_up_to_the_wall_table(dem, dim, steps):
    """Rough and smooth walls, with damping: the rows are what acted in the step, like the wall force itself."""
    simulation = dem.run(dem.Simulation(crowd(dem, dim, mu=0.4, gn=10.0, gt=5.0)), steps)
    table, walls = contact_table(simulation), wall_table(simulation)
    for k, force in enumerate(vectors(walls, "f", dim), start=1):
        rows = vectors(table, "f", dim)[table["j"] == -k]
        np.testing.assert_allclose(-rows.sum(axis=0), force, rtol=0, atol=1e-10)
    assert walls["id"].tolist() == list(range(1, 2 * dim + 1))
    assert ((table["j"] == -1) & (table["uy"] != 0)).any() == (steps > 0)  # x0 is rough
    smooth = np.isin(table["j"], [-2, -4])
    assert smooth.any()
    assert not vectors(table, "u", dim)[smooth].any()


@pytest.mark.parametrize("dim", [2, 3])
def test_where_contacts_are(dem, dim):
    """Pairs: on the branch line, R_i - overlap/2 from i; walls: the foot of the centre on the plane."""
    simulation = dem.run(dem.Simulation(crowd(dem, dim, mu=0.4)), 60)
    table, particles, walls = (f(simulation) for f in (contact_table, particle_table, wall_table))
    x = np.column_stack([particles[a] for a in "xyz"[:dim]])
    for row, point in enumerate(vectors(table, "p", dim)):
        i, j, overlap = (table[name][row] for name in ("i", "j", "overlap"))
        i = int(i) - 1
        if j > 0:
            branch = x[i] - x[int(j) - 1]
            distance = np.linalg.norm(branch)
            assert i < j - 1
            assert overlap == pytest.approx(particles["radius"][i] + particles["radius"][int(j) - 1] - distance)
            expected = x[i] - (particles["radius"][i] - overlap / 2) * branch / distance
        else:
            normal = np.array([walls["n" + a][int(-j) - 1] for a in "xyz"[:dim]])
            height = (x[i] - np.array([walls["p" + a][int(-j) - 1] for a in "xyz"[:dim]])) @ normal
            assert overlap == pytest.approx(particles["radius"][i] - height, abs=1e-13)
            expected = x[i] - height * normal
        np.testing.assert_allclose(point, expected, rtol=0, atol=1e-12)
        assert overlap > 0


@pytest.mark.parametrize(("dim", "spins"), [(2, ["wz"]), (3, ["wx", "wy", "wz"])])
def test_particle_columns(dem, dim, spins):
    simulation = dem.run(dem.Simulation(crowd(dem, dim, mu=0.4)), 3)
    table, s, m = particle_table(simulation), simulation.state, simulation.model
    axes = list("xyz"[:dim])
    assert list(table) == ["id", *axes, *("v" + a for a in axes), *spins, "radius", "mass", "inertia"]
    assert table["id"].tolist() == list(range(1, m.particle_count + 1))
    for k, a in enumerate(axes):
        assert np.array_equal(table[a], s.x[k, : m.particle_count])
        assert np.array_equal(table["v" + a], s.v[k, : m.particle_count])
    for k, w in enumerate(spins):
        assert np.array_equal(table[w], s.spin[k, : m.particle_count])
    for name in ("radius", "mass", "inertia"):
        assert np.array_equal(table[name], getattr(m, name))


# --- deck and command line -------------------------------------------------------------------------

DECK = {
    "title": "three discs", "dimension": 2, "convention": "talk", "dt": 4e-4,
    "plan": {"steps": 60, "sample_every": 5, "frame_every": 20, "contacts": True},
    "normal": {"law": "linear", "normal_stiffness": 1e4, "normal_damping": 3.0, "attraction": "allowed"},
    "sliding": {"law": "spring", "shear_friction": 0.5, "shear_stiffness": 2e3, "shear_damping": 1.0},
    "gravity": [0.0, -9.81],
    "walls": [
        {"name": "floor", "point": [0.0, 0.0], "normal": [0.0, 1.0], "friction": True, "motion": {"kind": "fixed"}},
        {"name": "side", "point": [0.0, 0.0], "normal": [1.0, 0.0], "friction": False,
         "motion": {"kind": "constant", "velocity": [0.5, 0.0]}},
        {"name": "lid", "point": [0.0, 6.0], "normal": [0.0, -1.0], "friction": False,
         "motion": {"kind": "loaded", "mass": 2.0, "load": 0.0, "stress": 3.0, "span": [1, 3], "damping": 0.5}},
        {"name": "gate", "point": [8.0, 0.0], "normal": [-1.0, 0.0], "friction": False,
         "motion": {"kind": "cosine", "travel": 0.5, "duration": 0.01}},
    ],
}
PARTICLES = """id,x,y,radius,mass,inertia,vx,vy,wz
1,1.0049999999999999,0.995,1,1,0.5,1,-2,3
2,2.9500000000000002,1.1000000000000001,1,1.25,0.625,-1,0,-4
3,1.8999999999999999,2.7999999999999998,1,0.75,0.375,0,-5,0
"""


def deck(folder, changes=None, particles=PARTICLES):
    folder.mkdir(exist_ok=True)
    (folder / "kernel.json").write_text(json.dumps(DECK | (changes or {})))
    (folder / "particles.csv").write_text(particles)
    return folder


def finished(folder, capsys):
    assert main(folder) == 0
    return json.loads(capsys.readouterr().out.splitlines()[-1])


def test_the_deck_is_read(tmp_path):
    model, plan = read_deck(deck(tmp_path))
    assert plan == Plan(steps=60, sample_every=5, frame_every=20, contacts=True)
    assert model.x[0].tolist() == [1.005, 2.95, 1.9]
    assert model.inertia.tolist() == [0.5, 0.625, 0.375]
    assert model.spin.tolist() == [[3.0, -4.0, 0.0]]
    assert (model.gravity, model.drag, model.periodic) == ((0.0, -9.81), None, None)
    assert [type(w.motion) for w in model.walls[1:]] == [Constant, Loaded, Cosine]
    assert model.walls[2].motion.span == (1, 3)
    assert model.sliding.algorithm == model.convention.sliding == "talk"


def test_without_a_table_there_is_no_effect(tmp_path):
    without = {k: v for k, v in DECK.items() if k not in ("sliding", "gravity")}
    (tmp_path / "kernel.json").write_text(json.dumps(without))
    (tmp_path / "particles.csv").write_text(PARTICLES)
    model, _ = read_deck(tmp_path)
    assert model.sliding is model.gravity is model.drag is model.periodic is None


def test_a_particle_table_of_the_wrong_width_is_refused(tmp_path):
    with pytest.raises(ValueError, match="expected columns id,x,y,radius,mass,inertia,vx,vy,wz, got 8 columns"):
        read_deck(deck(tmp_path, particles="id,x,y,radius,mass,inertia,vx,vy\n1,1,1,1,1,1,1,1\n"))


def test_a_run_writes_series_and_frames(tmp_path, capsys):
    report = finished(deck(tmp_path), capsys)
    assert report["finished"] is True
    assert report["steps"] == 60
    assert set(report["timings"]) == {"setup", "run", "output"}
    header, *rows = (tmp_path / "series.csv").read_text().splitlines()
    names = [f"{w}_{q}" for w in ("floor", "side", "lid", "gate") for q in ("d", "v", "fx", "fy")]
    assert header.split(",") == ["step", "time", *names]
    assert [int(r.split(",")[0]) for r in rows] == list(range(0, 61, 5))
    with h5py.File(tmp_path / "frames.h5") as f:
        assert f.attrs["finished"] == 1
        assert f.attrs["dimension"] == 2
        assert "periodic" not in f.attrs
        assert sorted(f["frame"]) == ["0", "1", "2", "3"]
        assert [(f[f"frame/{k}"].attrs["step"], f[f"frame/{k}"].attrs["time"]) for k in range(4)] == [
            (20 * k, 20 * k * 4e-4) for k in range(4)]
        assert set(f["frame/0"]) == {"particles", "contacts", "walls"}
        assert {"i", "j", "px", "py", "fx", "fy", "ux", "uy", "overlap"} == set(f["frame/2/contacts"])
        assert {"id", "px", "py", "nx", "ny", "fx", "fy"} == set(f["frame/2/walls"])


def test_series_and_frames_are_the_simulation_to_the_last_bit(tmp_path, capsys, dem):
    finished(deck(tmp_path), capsys)
    model, _ = read_deck(tmp_path)
    simulation = fastest(model)
    simulation.advance(60)
    last = (tmp_path / "series.csv").read_text().splitlines()[-1].split(",")
    s = simulation.state
    walls = [v for k in range(4) for v in (s.wall_d[k], s.wall_rate[k], *s.wall_force[:, k])]
    assert [float(v) for v in last] == [60, simulation.time, *walls]
    with h5py.File(tmp_path / "frames.h5") as f:
        for group, table in (("particles", particle_table), ("contacts", contact_table), ("walls", wall_table)):
            for name, values in table(simulation).items():
                assert np.array_equal(f[f"frame/3/{group}/{name}"][()], values)


def test_contact_output_does_not_alter_the_run(tmp_path, capsys):
    plan = DECK["plan"] | {"frame_every": 1, "sample_every": 1}
    finished(deck(tmp_path / "seen", {"plan": plan}), capsys)
    finished(deck(tmp_path / "unseen", {"plan": DECK["plan"] | {"contacts": False}}), capsys)
    with h5py.File(tmp_path / "seen/frames.h5") as seen, h5py.File(tmp_path / "unseen/frames.h5") as unseen:
        assert "contacts" not in unseen["frame/3"]
        for group in ("particles", "walls"):
            for name, values in unseen[f"frame/3/{group}"].items():
                assert np.array_equal(values[()], seen[f"frame/60/{group}/{name}"][()])


def test_periodic_axes_without_walls(tmp_path, capsys):
    finished(deck(tmp_path, {"walls": [], "periodic": [9.0, 0.0], "gravity": None}), capsys)
    with h5py.File(tmp_path / "frames.h5") as f:
        assert f.attrs["periodic"].tolist() == [True, False]
        assert "walls" not in f["frame/0"]
    assert (tmp_path / "series.csv").read_text().splitlines()[0] == "step,time"


@pytest.mark.parametrize(("particles", "message"), [
    (PARTICLES.replace("0,-5,0", "0,-1e6,0"),
     "step 1: particle 3 moves 400 of its radii in one step, through particle 1; take shorter steps or a lower speed"),
    (PARTICLES.replace("1.8999999999999999,", "-1.9,"), "step 0: the centre of particle 3 has passed wall 'side'"),
])
def test_an_unstable_run_says_so_and_leaves_no_finished_file(tmp_path, capsys, particles, message):
    assert main(deck(tmp_path, particles=particles)) == 3
    assert capsys.readouterr().out.splitlines()[-1] == f"unstable: {message}"
    assert (tmp_path / "series.csv").read_text().startswith("step,time,floor_d")
    if (tmp_path / "frames.h5").exists():
        with h5py.File(tmp_path / "frames.h5") as f:
            assert "finished" not in f.attrs


@pytest.mark.parametrize(("speed", "status"), [("0,-5,0", 0), ("0,-1e6,0", 3)])
def test_the_command_line(tmp_path, speed, status):
    deck(tmp_path, particles=PARTICLES.replace("0,-5,0", speed))
    done = subprocess.run([sys.executable, "-m", "reference.kernel", str(tmp_path)], capture_output=True, text=True)
    assert done.returncode == status, done.stderr
    last = done.stdout.splitlines()[-1]
    assert json.loads(last)["finished"] is True if status == 0 else last.startswith("unstable: ")
