"""The front door: missing things are unavailable with the reason, and the command line."""

import csv
import json
import subprocess
import sys

import numpy as np
import pytest

from postproc.average import average, main
from postproc.averaging.registry import CELLS, WrongSetting
from postproc.fields import AT_POINTS, IN_CELLS, OF_STATE
from postproc.macro.tensors import principal
from postproc.readers.state import write_state
from postproc.results import Unavailable, Value, columns_of, reasons_of
from postproc.snapshot import MissingColumn
from postproc.trajectory import Trajectory, write_trajectory
from postproc.undefined import OTHERWISE

SHAPES = {
    "scalar": (), "vector": (2,), "principal": (2,), "tensor": (2, 2), "axial": (), "couple": (2,), "stiffness": (3, 3),
    "histogram": (36,),
}

NO_BOX = "the state has no box: give the attribute box, or walls on every side"


@pytest.mark.parametrize("kind", CELLS)
def test_every_quantity_keeps_the_promises(states, kind):
    """With everything given, all are available, of their shape, one value a cell."""
    state = complete(states, states.random_contacts(2, 2, count=80))
    averages = average(state, cells=states.words(kind, 2), reference=state, rate=1.0, gravity=(0.0, -9.81))
    assert reasons_of({**averages.in_cells, **averages.of_state}) == {}
    in_cells = (*IN_CELLS, *AT_POINTS) if kind == "points" else IN_CELLS
    for fields, count in ((in_cells, len(averages.labels)), (OF_STATE, 1)):
        for field in fields:
            assert averages[field.name].shape == (count, *SHAPES[field.rank]), field.name
    assert len(columns_of(averages.in_cells)) == sum(int(np.prod(SHAPES[f.rank])) for f in in_cells)


@pytest.mark.parametrize("name", ["stress", "fabric"])
def test_parts_are_those_of_their_tensor(states, name):
    averages = average(states.random_contacts(2, 2), cells="particles")
    parts = principal(averages[name])
    np.testing.assert_array_equal(averages[f"{name}_deviator"], parts.deviator)
    np.testing.assert_array_equal(averages[f"{name}_principal"], parts.values)
    np.testing.assert_array_equal(averages[f"{name}_major"], parts.major)
    trace = averages["fabric_trace"] if name == "fabric" else 2 * averages["stress_isotropic"]
    np.testing.assert_allclose(trace, np.trace(averages[name], axis1=1, axis2=2), rtol=1e-12, atol=1e-12)


# what is taken away: (group, columns), the quantities that go with it
ENERGY = {"kinetic_over_elastic_energy"}
RATES = {
    "velocity_gradient", "strain_rate", "strain_rate_deviator", "rotation_rate", "eigen_rotation", "sliding_rotation",
}
MOTION = {
    *ENERGY, *RATES, "momentum_density", "velocity", "kinetic_stress", "total_stress", "translational_energy",
    "translational_energy_density",
}
DEFORMATION = {
    "elastic_strain", "elastic_strain_isotropic", "elastic_strain_deviator", "bulk_stiffness", "shear_stiffness",
    "curvature", "torque_stiffness", "non_colinearity_stress_strain", "non_colinearity_strain_fabric",
}
ELASTIC = {*ENERGY, "elastic_energy_density"}
SPRINGS = {"stiffness", "contact_bulk_modulus", "contact_shear_modulus"}
MISSING = {
    ("particles", "mass"): {*MOTION, "inertial_number"},
    ("particles", "vx"): {*MOTION, "velocity_density"},
    ("particles", "wz"): {
        *ENERGY, "rotational_energy", "rotational_energy_density", "spin", "spin_density", "spin_gradient",
        "eigen_rotation", "sliding_rotation", "rolling_rotation",
    },
    ("particles", "inertia"): {*ENERGY, "rotational_energy", "rotational_energy_density"},
    ("particles", "rotation"): {"rotation", "rotation_gradient"},
    ("contacts", "overlap"): {*ELASTIC, *DEFORMATION, "normal_elastic_energy"},
    ("contacts", "kn"): {
        *ELASTIC, *SPRINGS, "normal_elastic_energy", "normal_stiffness", "stiffness_anisotropy",
        "principal_stiffness_anisotropy",
    },
    ("contacts", "kt"): {*ELASTIC, *SPRINGS, "tangential_elastic_energy"},
    ("contacts", "ux"): {*ELASTIC, *DEFORMATION, "tangential_elastic_energy"},
    ("contacts", "mz"): {"contact_couple_stress"},
    ("walls", "nx"): {"stress_from_walls"},
}


def complete(states, state):
    """Add the columns that random states do not have: rotations and couples."""
    rotation, couple = np.linspace(-1, 1, state.particles.rows), np.linspace(-1, 1, state.contacts.rows)
    return states.replace(
        state, particles={**state.particles, "rotation": rotation}, contacts={**state.contacts, "mz": couple}
    )


@pytest.mark.parametrize(("group", "column"), MISSING)
def test_a_missing_column_takes_only_what_needs_it(states, group, column):
    full = complete(states, states.random_contacts(2, 2))
    options = {"reference": full, "rate": 1.0}
    averages = average(states.without(full, group, column), **options)
    reasons = reasons_of({**averages.in_cells, **averages.of_state})
    assert set(reasons) == MISSING[group, column]
    assert all(f"{group} has no column '{column}'" in reason for reason in reasons.values())
    untouched = average(full, **options)
    for name in set(untouched.in_cells) - set(reasons):
        np.testing.assert_array_equal(averages[name], untouched[name])


def test_missing_contacts_box_and_settings(states):
    full = states.random_contacts(2, 2)
    no_contacts = reasons_of(average(states.replace(full, contacts=None)).in_cells)
    assert no_contacts["coordination_number"] == no_contacts["fabric"] == "contacts were not recorded"
    assert "volume_fraction" not in no_contacts
    no_box = reasons_of(average(states.replace(full, box=None)).in_cells)
    assert no_box["volume_fraction"] == no_box["stress"] == NO_BOX
    assert "coordination_number" not in no_box
    nothing = average(full)
    assert nothing.in_cells["inertial_number"] == Unavailable(reason="no strain rate was given")
    assert nothing.of_state["axial_strain"] == Unavailable(reason="no reference state was given")
    with pytest.raises(MissingColumn, match="inertial_number: no strain rate was given"):
        _ = nothing["inertial_number"]


def test_results_are_frozen(states):
    averages = average(states.random_contacts(2, 2))
    with pytest.raises(AttributeError):
        averages.time = 1.0
    assert isinstance(averages.in_cells["stress"], Value)
    with pytest.raises(WrongSetting, match="gravity: expected 2 components, got 3"):
        average(states.random_contacts(2, 2), gravity=(0, 0, 1))


@pytest.fixture
def file(tmp_path, states):
    path = tmp_path / "state.h5"
    write_state(path, states.replace(states.random_contacts(2, 2, count=80), time=0.25))
    return path


def test_table(file, capsys):
    assert main([str(file)]) == 0
    out = capsys.readouterr().out
    assert out.startswith("2D, 80 particles, t = 0.25 s, cells: box\n")
    assert "\nper unit thickness, as none other than 1 was given: stresses are forces per length, N/m\n" in out
    assert "  stress (N/m) " in out
    assert "unavailable\n  displacement: no reference state was given" in out
    assert "\n  inertial_number: no strain rate was given\n" in out


def test_a_state_that_gives_nothing_of_what_was_asked_is_no_success(file, capsys):
    assert main([str(file), "--fields", "displacement"]) == 1
    assert "unavailable\n  displacement: no reference state was given" in capsys.readouterr().out


def test_json_holds_all_digits_and_all_reasons(file, states, capsys):
    assert main([str(file), "--json", "-", "--cells", "particles"]) == 0
    data = json.loads(capsys.readouterr().out)
    expected = average(states.random_contacts(2, 2, count=80), cells="particles")
    np.testing.assert_array_equal(data["in_cells"]["stress"]["values"], expected["stress"])
    assert data["in_cells"]["stress"]["unit"] == "N/m"
    assert data["of_state"]["axial_strain"] == {"unavailable": "no reference state was given"}
    assert data["time"] == 0.25


def test_files_hold_all_digits(file, states, tmp_path):
    folder = tmp_path / "new" / "out"
    assert main([str(file), "--cells", "inner", "--margin", "0.2", "--out", str(folder)]) == 0
    expected = average(states.random_contacts(2, 2, count=80), cells="inner", margin=0.2)
    with open(folder / "cells.csv") as cells, open(folder / "state.csv") as state:
        row = next(csv.DictReader(cells))
        assert float(next(csv.DictReader(state))["time (s)"]) == 0.25
    assert row.pop("cell") == "inner"
    found = {name: float(text or "nan") for name, text in row.items()}
    columns = columns_of(expected.in_cells)
    assert {"volume_fraction", "stress_xy (N/m)", "friction_angle (deg)", "translational_energy (J)"} < set(found)
    assert set(found) == set(columns)
    for name, values in columns.items():
        np.testing.assert_array_equal(found[name], values[0])
    assert json.loads((folder / "average.json").read_text())["cells"] == "inner"


def test_a_trajectory_is_strained_against_its_first_frame(tmp_path, states, capsys):
    first = states.lattice("square")
    last = states.replace(first, box=first.box * 0.9)
    path = tmp_path / "trajectory.h5"
    write_trajectory(path, Trajectory(frames=(first, last), steps=(0, 1), series=None))
    assert main([str(path), "--json", "-"]) == 0
    strain = json.loads(capsys.readouterr().out)["of_state"]["axial_strain"]["values"]
    np.testing.assert_allclose(strain, [[0.1, 0.1]], rtol=1e-12)
    assert main([str(path), "--json", "-", "--frame", "0"]) == 0
    assert json.loads(capsys.readouterr().out)["of_state"]["volumetric_strain"]["values"] == [0.0]


@pytest.mark.parametrize(("words", "message"), [
    (["nothing.h5"], "nothing.h5: file: expected an HDF5 file, got none of this name"),
    (["{file}", "--frame", "1"], "frame: expected a trajectory, which has frames, got a single state"),
    (["{file}", "--margin", "1"], "margin: expected none for cells of kind 'box', got 1.0"),
    (["{file}", "--gravity", "1"], "gravity: expected 2 components, got 1"),
    (["{file}", "--out", "{file}"], "--out: expected a place in a folder, got {file}: {file} is no folder"),
    (["{file}", "--out", "{file}/a/b"], "--out: expected a place in a folder, got {file}/a/b: {file} is no folder"),
    (["{file}", "--json", "{file}/x.json"], "--json: expected a place in a folder, got {file}/x.json: {file}"),
    (["{file}", "--json", "/"], "--json: expected a file, got the folder /; name a file in it"),
    (["{file}", "--json", ""], "--json: expected a file, got the folder .; name a file in it"),
    (["{file}", "--json", "{file}"], "--json: expected a place of its own, got {file}, which is read; name another"),
    (["{file}", "--reference", "a.json", "--json", "a.json"], "--json: expected a place of its own, got a.json"),
    (["average.json", "--out", "."], "--out: expected a place of its own, got average.json, which is read"),
    (["{file}", "--cells", "points:p.csv", "--json", "p.csv"], "--json: expected a place of its own, got p.csv"),
    (["n", "--json", "n.contacts.csv"], "--json: expected a place of its own, got n.contacts.csv, which is read"),
    (["n.particles.csv", "--json", "n.attributes.json"], "expected a place of its own, got n.attributes.json"),
    (["."], ".: file: expected an HDF5 or JSON state, or the NAME of a NAME.particles.csv, got a folder"),
    (["/"], "/: file: expected an HDF5 or JSON state, or the NAME of a NAME.particles.csv, got a folder"),
    (["nobody"], "nobody: file: expected an HDF5 or JSON state, or the NAME of a NAME.particles.csv, got none of them"),
    (["{file}", "--rate", "inf"], "rate: expected a finite number below 1e+30, got inf"),
    (["{file}", "--rate", "nan"], "rate: expected a finite number below 1e+30, got nan"),
    (["{file}", "--kn", "-1"], "kn: expected a number > 0 and below 1e+30, got -1"),
    (["{file}", "--cells", "inner", "--margin", "1e300"], "margin: expected a number > 0 and below 1e+30, got 1e+300"),
    (["{file}", "--minimum-contacts", "-3"], "minimum contacts: expected a whole number >= 1, got -3"),
    (["{file}", "--gravity", "0", "inf"], "gravity: expected finite components below 1e+30, got 0 inf"),
    (["{file}", "--fields", "stres"], "fields: expected all, or names such as stress"),
    (["{file}", "--cells", "rings:3"], "cells rings: expected bounds, as NUMBER:LOW:HIGH, got 3 alone, and the"),
    (["{file}", "--weights", "area"], "weights: expected none for cells of kind 'box', got area"),
])
def test_wrong_input_is_one_line_and_status_2(file, capsys, words, message, monkeypatch):
    monkeypatch.chdir(file.parent)
    assert main([w.format(file=file) for w in words], prog="grainproof average") == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("grainproof average: ")
    assert message.format(file=file) in captured.err
    assert captured.err.count("\n") == 1


@pytest.mark.parametrize(("words", "message"), [
    (["{file}", "--margin", "x"], "argument --margin: expected a number, got 'x'"),
    (["{file}", "--minimum-contacts", "2.5"], "argument --minimum-contacts: expected a whole number, got '2.5'"),
    (["{file}", "--weights", "volume"], "argument --weights: invalid choice: 'volume'"),
    (["{file}", "--frame-of", "cylinder"], "argument --frame-of: invalid choice: 'cylinder'"),
    ([""], "argument STATE: expected the file of a state, got nothing"),
    (["{file}", "--out", " "], "argument --out: expected a folder, got nothing; use . for this one"),
])
def test_words_that_cannot_be_read_are_one_line_too(file, capsys, words, message):
    with pytest.raises(SystemExit) as stop:
        main([w.format(file=file) for w in words], prog="grainproof average")
    assert stop.value.code == 2
    err = capsys.readouterr().err
    assert message in err
    assert err.count("\n") == 1


def test_chosen_fields_cells_and_frame(file, capsys, states):
    words = ["--cells", "rings:2:0.1:1", "--fields", "stress,volume_fraction,axial_strain", "--frame-of", "cartesian",
             "--weights", "centre", "--json", "-"]
    assert main([str(file), *words]) == 0
    data = json.loads(capsys.readouterr().out)
    assert list(data["in_cells"]) == ["volume_fraction", "stress"]
    assert list(data["of_state"]) == ["axial_strain"]
    assert data["frame"] == "cartesian"
    assert data["in_cells"]["stress"]["components"] == ["xx", "xy", "yx", "yy"]
    assert data["coordinates"]["r_outer"]["unit"] == "m"
    state = states.random_contacts(2, 2, count=80)
    expected = average(state, cells="rings:2:0.1:1", frame="cartesian", weights="centre")
    np.testing.assert_array_equal(data["in_cells"]["stress"]["values"], expected["stress"])


def test_places_of_cells_stand_in_the_table(file, tmp_path):
    assert main([str(file), "--cells", "grid:2x3", "--fields", "particles", "--out", str(tmp_path / "o")]) == 0
    with open(tmp_path / "o" / "cells.csv") as f:
        rows = list(csv.DictReader(f))
    assert list(rows[0]) == ["cell", "x (m)", "y (m)", "particles"]
    assert [row["cell"] for row in rows] == ["1 1", "1 2", "1 3", "2 1", "2 2", "2 3"]
    assert sum(float(row["particles"]) for row in rows) == pytest.approx(80, rel=1e-14)


def _undefined_states(states):
    """States in which something is undefined: no contacts, no forces, no particles, one particle, a lattice."""
    state = complete(states, states.random_contacts(2, 2, count=30))
    nothing = np.zeros(state.contacts.rows)
    unloaded = dict.fromkeys(("fx", "fy", "ux", "uy", "overlap", "mz"), nothing)
    yield states.replace(state, contacts={**state.contacts, **unloaded})
    yield states.replace(state, contacts={**state.contacts, "fx": -state.contacts["fx"]})
    yield states.replace(state, contacts={name: [] for name in state.contacts})
    few = {name: values[:3] for name, values in state.particles.items()}
    yield states.replace(state, particles=few, contacts={name: [] for name in state.contacts})


@pytest.mark.parametrize("kind", CELLS)
def test_every_nan_has_its_reason(states, kind):
    seen = set()
    for state in _undefined_states(states):
        averages = average(state, cells=states.words(kind, 2), reference=state, rate=1.0)
        for name, result in averages.in_cells.items():
            if isinstance(result, Unavailable):
                continue
            missing = np.isnan(result.values).reshape(len(result.values), -1).any(axis=1).sum()
            assert bool(result.undefined) == bool(missing), name
            assert result.undefined.startswith(f"in {missing} of {len(averages.labels)} cells: ") or not missing
            assert OTHERWISE not in result.undefined, name
            seen.add(result.undefined)
    assert len(seen) > 3


def test_reasons_of_nan_and_empty_cells_are_shown(states, tmp_path, capsys):
    state = states.snapshot(x=[[0.5, 0.5], [1.5, 0.5]], radius=[0.2, 0.2], box=np.array([[0.0, 4.0], [0.0, 1.0]]))
    write_state(tmp_path / "s.json", state)
    assert main([str(tmp_path / "s.json"), "--cells", "strips:x:4"]) == 0
    out = capsys.readouterr().out
    assert "\n2 of 4 cells without particles: densities and sums are 0 there\n" in out
    assert "\nnan\n" in out
    assert "  coordination_number: in 2 of 4 cells: 2 without particles\n" in out
    assert "  contact_fabric: in 4 of 4 cells: 2 without particles, 2 without contacts\n" in out
    assert main([str(tmp_path / "s.json"), "--cells", "strips:x:4", "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["cells_without_particles"] == 2
    assert data["in_cells"]["coordination_number"]["undefined"] == "in 2 of 4 cells: 2 without particles"
    assert data["in_cells"]["coordination_number"]["values"] == [0.0, 0.0, None, None]


def test_a_folder_that_cannot_be_written_is_one_line(file, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("postproc.options.os.access", lambda path, mode: path != tmp_path)
    assert main([str(file), "--out", str(tmp_path / "new")], prog="average") == 2
    line = f"average: --out: expected a place that can be written, got {tmp_path / 'new'}; name another\n"
    assert capsys.readouterr() == ("", line)
    assert not (tmp_path / "new").exists()


def test_a_disk_that_fails_is_one_line(file, tmp_path, capsys, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device", "cells.csv")

    monkeypatch.setattr("pandas.DataFrame.to_csv", full)
    assert main([str(file), "--out", str(tmp_path / "new")], prog="average") == 2
    assert capsys.readouterr().err == "average: cells.csv: cannot be written: No space left on device\n"


def test_stresses_without_a_thickness_are_forces_per_length(states):
    state = states.random_contacts(2, 2)
    flat, thick = average(state), average(states.replace(state, thickness=0.5))
    space = average(states.random_contacts(3, 3))
    assert [a.in_cells["stress"].unit for a in (flat, thick, space)] == ["N/m", "Pa", "Pa"]
    np.testing.assert_allclose(flat["stress"], 0.5 * thick["stress"], rtol=1e-14)


def test_runs_alone(file):
    """As `python -m postproc`, without the harness being imported."""
    command = [sys.executable, "-X", "importtime", "-m", "postproc", str(file)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("2D, 80 particles")
    loaded = {line.rsplit("|", 1)[-1].strip().split(".")[0] for line in done.stderr.splitlines()}
    assert "postproc" in loaded
    assert not loaded & {"harness", "reference", "pandas", "MDAnalysis", "scipy", "matplotlib"}
