"""Sound in a column: packings at rest, linear theory, measured waves with exact answers, mutants that are seen."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harness.engines.registry import ENGINES
from harness.runs.execute import run_one
from harness.scene.load import load_scene
from harness.scene.resolve import resolve
from harness.studies.reproduce.sound import STUDY
from harness.studies.reproduce.sound.cases import Setting
from harness.studies.reproduce.sound.charts import transmission
from harness.studies.reproduce.sound.column import Column, Kick, Look, Material, write_scene
from harness.studies.reproduce.sound.disorder import Sample, lattice_bonds, linear_velocities, relaxed_sample
from harness.studies.reproduce.sound.measure import P, S, closed_form, expected_frequencies, measure_sound
from harness.studies.reproduce.sound.numbers import (
    FREQUENCY_TOLERANCE,
    SPEED_TOLERANCE,
    checks,
    deviations,
    disorder_rows,
    speed_rows,
)
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory, read_trajectory

SMOOTH, ROUGH = Material(), Material(tangential=2e4)
LAYERS, ACROSS, FRAMES = 60, 3, 120


def column(material=SMOOTH, layers=LAYERS):
    return Column(material=material, layers=layers, across=ACROSS)


def regular(of):
    return Sample.regular(of, np.full(of.count, of.material.radius))


def look(of):
    return Look(duration=1.5 * of.box[2] / of.material.waves().shear_speed, frames=FRAMES)


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A small column on the kernel, by convention and roughness: setting, system and trajectory."""
    folder, found = tmp_path_factory.mktemp("sound"), {}

    def run(engine, material):
        if (engine, material) not in found:
            setting = Setting(column=column(material))
            sample = setting.packing()
            file = write_scene(folder, setting.word, "test", setting.column, setting.kick(), look(setting.column),
                               places=sample.places, radius=sample.radius)
            system = resolve(load_scene(file), file)
            outcome, at = run_one(ENGINES[engine], system, folder / "runs", time_limit=120.0)
            assert outcome.status == "completed"
            found[engine, material] = setting, system, read_trajectory(at / "trajectory.h5")
        return found[engine, material]

    return run


# --- the column ----------------------------------------------------------------------------------


def test_the_lattice_has_twelve_neighbours():
    of = column()
    first, second = lattice_bonds(of)
    assert np.bincount(np.concatenate([first, second])).tolist() == [12] * of.count
    box, apart = np.array(of.box), of.places()[first] - of.places()[second]
    apart -= box * np.round(apart / box)
    assert np.linalg.norm(apart, axis=1) == pytest.approx(of.material.waves().spacing, rel=1e-12)


def test_the_scene_kicks_one_layer_and_rests_as_a_whole(ran):
    setting, system, _ = ran("kernel:talk", SMOOTH)
    v, layer = system.particles.v, setting.column.layer
    assert np.abs(v.sum(axis=0)).max() < 1e-12 * np.abs(v).sum()
    assert np.unique(v[layer == 0], axis=0).shape == (1, 3)
    assert system.periodic == setting.column.box
    assert STUDY.engines == ("lammps", "liggghts", "kernel")


# --- disorder ------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", [0.3, 1.0])
def test_a_disordered_sample_is_at_rest(width):
    """Forces counted one by one, contact by contact."""
    of = column()
    sample = relaxed_sample(of, width, seed=2)
    force = np.zeros((of.count, 3))
    box = np.array(of.box)
    for i, j in zip(sample.first, sample.second, strict=True):
        apart = sample.places[i] - sample.places[j]
        apart -= box * np.round(apart / box)
        distance = np.sqrt(apart @ apart)
        push = of.material.stiffness * max(0.0, sample.radius[i] + sample.radius[j] - distance) * apart / distance
        force[i] += push
        force[j] -= push
    assert np.abs(force).max() < 1e-8 * of.material.stiffness * of.material.overlap * of.material.radius
    assert (sample.contacts_per_sphere < 12) == (width == 1.0)


def test_linear_theory_of_the_regular_column_is_the_closed_form():
    """Layers of a kicked column against the modes of the closed form in the same steps."""
    of = column()
    kicked = np.where(of.layer == 0, 1.0, -1.0 / (of.layers - 1))[:, None] * [1.0, 0.0, 1.0]
    dt, waves = 4e-7, of.material.waves()
    found = linear_velocities(regular(of), kicked, dt, 5, 60).reshape(61, of.layers, -1, 3).mean(axis=2)
    time, k = 5 * dt * np.arange(61), 2 * np.pi * np.arange(of.layers) / of.layers
    for axis, branch in ((2, P), (0, S)):
        w = expected_frequencies(waves, branch, k, dt)
        start = np.fft.fft(found[0, :, axis])
        modes = np.fft.ifft(start * np.cos(np.outer(time, w)), axis=1).real
        assert found[:, :, axis] == pytest.approx(modes, abs=1e-10)


# --- runs ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("engine", "material"), [("kernel:talk", SMOOTH), ("kernel:lammps", ROUGH)])
def test_a_run_gives_the_closed_form(ran, engine, material):
    setting, system, trajectory = ran(engine, material)
    found = measure_sound(setting, trajectory, system)
    assert max(d.max() for d in deviations(setting, engine, found).values()) < FREQUENCY_TOLERANCE
    runs = {setting.name: {engine: found}}
    again = lambda *e: "again"  # noqa: E731
    assert {c.verdict for c in checks([setting], runs, again)} == {"agrees"}
    assert {r.verdict for r in speed_rows([setting], runs)} == {"agrees"}
    assert found.speed[P].value == pytest.approx(material.waves().compression_speed, rel=0.1 * SPEED_TOLERANCE)


def test_lever_arms_are_told_apart(ran):
    """The closed form of the other code's lever arms is seen to be wrong, by delta/(4 R)."""
    setting, system, trajectory = ran("kernel:lammps", ROUGH)
    found = measure_sound(setting, trajectory, system)
    wrong = max(d.max() for d in deviations(setting, "kernel:liggghts", found).values())
    assert wrong == pytest.approx(setting.column.material.overlap / 4, rel=0.02)
    assert closed_form(setting, "lammps").arms > closed_form(setting, "liggghts").arms


@pytest.mark.parametrize("mutant", [
    {"stiffness": 1e5 * 1.01}, {"density": 2000.0 * 0.99}, {"overlap": 5e-3}, {"tangential": 1e3}])
def test_another_material_is_seen(ran, mutant):
    """A run of one material, judged as another: the speeds, or at least the frequencies, differ."""
    setting, system, trajectory = ran("kernel:talk", SMOOTH)
    found = measure_sound(setting, trajectory, system)
    other = replace(setting, column=replace(setting.column, material=replace(SMOOTH, **mutant)))
    verdicts = {c.verdict for c in checks([other], {other.name: {"kernel:talk": found}}, lambda *e: "again")}
    assert "differs" in verdicts


def test_a_slow_clock_is_seen(ran):
    """Times three parts in a thousand off: the speeds differ by more than the goal."""
    setting, system, trajectory = ran("kernel:talk", SMOOTH)
    frames = tuple(replace(f, time=1.003 * f.time) for f in trajectory)
    found = measure_sound(setting, replace(trajectory, frames=frames), system)
    assert {r.verdict for r in speed_rows([setting], {setting.name: {"kernel:talk": found}})} == {"differs"}


def test_disorder_slows_waves():
    """By linear theory alone, without an engine; the rows have no verdict, as the talk has no number."""
    of = column(layers=60)
    setting = Setting(column=of, width=1.0, sample=0)
    at, dt = look(of), 4e-7
    every = 8
    frames = int(at.duration / dt / every)
    kicked = np.where(of.layer == 0, 1.0, -1.0 / (of.layers - 1))[:, None] * [1e-5, 0.0, 1e-5]
    v = linear_velocities(setting.packing(), kicked, dt, every, frames)
    ids = np.arange(1, of.count + 1)
    trajectory = Trajectory(series=None, steps=tuple(range(0, (frames + 1) * every, every)), frames=tuple(
        Snapshot(time=k * every * dt, dimension=3, particles=Columns(
            {"id": ids, "vx": v[k, :, 0], "vy": v[k, :, 1], "vz": v[k, :, 2]})) for k in range(frames + 1)))
    system = SimpleNamespace(dt=dt, frame_every=every, particles=SimpleNamespace(v=kicked))
    found = measure_sound(setting, trajectory, system)
    assert found.linear < 1e-12
    rows = disorder_rows([setting], {setting.name: {"theory": found}})
    assert {r.verdict for r in rows} == {"not_checked"}
    assert all(0.8 < r.ours.value < 0.98 for r in rows)


def test_kick_without_friction_turns_nothing():
    assert Setting(column=column()).kick().surface == (0.0, 0.0, 0.0)
    assert any(Setting(column=column(ROUGH)).kick().surface)
    assert Kick(velocity=(1.0, 0.0, 0.0)).surface == (0.0, 0.0, 0.0)


def test_what_arrives_is_told_by_frequency():
    """A column that lets pass half of everything, and nothing above a third of the cut-off but a tenth."""
    time = np.linspace(0.0, 2e-3, 241)
    cut, rng = SMOOTH.waves().cut_off, np.random.default_rng(0)
    w = np.fft.rfftfreq(len(time), time[1] - time[0]) * 2 * np.pi
    full = rng.normal(size=len(w)) + 1j * rng.normal(size=len(w))
    passed = np.where(w < cut / 3, 0.5, 0.1)
    branch = SimpleNamespace(frequency=np.array([cut]))
    one, two = (SimpleNamespace(time=time, branches={P: branch}, along=np.fft.irfft(f, n=len(time))[:, None])
                for f in (full * passed, full))
    frequency, part = transmission(one, two, 0)
    assert frequency.max() < cut
    assert part[frequency < 0.25 * cut] == pytest.approx(0.5, rel=1e-9)
    assert part[frequency > 0.42 * cut] == pytest.approx(0.1, rel=1e-9)


@pytest.mark.parametrize(("error", "count", "said"), [
    (None, 1, "(lammps, 1 sample, so no error is known)."), (0.01, 3, "(lammps, 3 samples, one standard error)."),
])
def test_one_sample_has_no_error(error, count, said, monkeypatch):
    from harness.studies.reproduce import sound

    monkeypatch.setattr(sound, "engines_in", lambda *_: ["lammps"])
    monkeypatch.setattr(sound, "ratios", lambda *_: [])
    monkeypatch.setattr(sound, "over_packings", lambda *_: SimpleNamespace(value=0.95, error=error))
    sample = SimpleNamespace(packing=lambda: SimpleNamespace(contacts_per_sphere=11.5))
    words = sound._slowing(0.001, [sample] * count, {})
    assert words.endswith(said)
    assert ("+-" in words) == (error is not None)
