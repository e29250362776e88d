"""The front door: missing things are unavailable with the reason, and the command line."""

import csv
import json
import subprocess
import sys

import numpy as np
import pytest

from postproc.average import average, main
from postproc.averaging.registry import CELLS, WrongSetting
from postproc.fields import IN_CELLS, OF_STATE
from postproc.macro.tensors import principal
from postproc.readers.state import write_state
from postproc.results import Unavailable, Value, columns_of, reasons_of
from postproc.snapshot import MissingColumn
from postproc.trajectory import Trajectory, write_trajectory

SHAPES = {"scalar": (), "vector": (2,), "principal": (2,), "tensor": (2, 2)}

NO_BOX = "the state has no box: give the attribute box, or walls on every side"


@pytest.mark.parametrize("kind", CELLS)
def test_every_quantity_keeps_the_promises(states, kind):
    """With everything given, all are available, of their shape, one value a cell."""
    state = states.random_contacts(2, 2, count=80)
    averages = average(state, cells=kind, reference=state, rate=1.0, gravity=(0.0, -9.81))
    assert reasons_of({**averages.in_cells, **averages.of_state}) == {}
    for fields, count in ((IN_CELLS, len(averages.labels)), (OF_STATE, 1)):
        for field in fields:
            assert averages[field.name].shape == (count, *SHAPES[field.rank]), field.name
    assert len(columns_of(averages.in_cells)) == sum(int(np.prod(SHAPES[f.rank])) for f in IN_CELLS)


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
MISSING = {
    ("particles", "mass"): {
        "kinetic_stress", "translational_energy", "kinetic_over_elastic_energy", "inertial_number",
    },
    ("particles", "vx"): {"kinetic_stress", "translational_energy", "kinetic_over_elastic_energy"},
    ("particles", "wz"): {"rotational_energy", "kinetic_over_elastic_energy"},
    ("particles", "inertia"): {"rotational_energy", "kinetic_over_elastic_energy"},
    ("contacts", "overlap"): {"normal_elastic_energy", "kinetic_over_elastic_energy"},
    ("contacts", "kn"): {"normal_elastic_energy", "kinetic_over_elastic_energy"},
    ("contacts", "kt"): {"tangential_elastic_energy", "kinetic_over_elastic_energy"},
    ("contacts", "ux"): {"tangential_elastic_energy", "kinetic_over_elastic_energy"},
    ("walls", "nx"): {"stress_from_walls"},
}


@pytest.mark.parametrize(("group", "column"), MISSING)
def test_a_missing_column_takes_only_what_needs_it(states, group, column):
    full = states.random_contacts(2, 2)
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
    assert "unavailable\n  inertial_number: no strain rate was given" in out


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
])
def test_wrong_input_is_one_line_and_status_2(file, capsys, words, message):
    assert main([w.format(file=file) for w in words], prog="grainproof average") == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("grainproof average: ")
    assert message.format(file=file) in captured.err
    assert captured.err.count("\n") == 1


def test_a_folder_that_cannot_be_written_is_one_line(file, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("postproc.average.os.access", lambda path, mode: path != tmp_path)
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
