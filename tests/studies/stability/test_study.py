"""A few quick hard cases end to end, with the codes that are installed."""

import pytest

from harness.cli import main
from harness.engines.registry import ENGINES
from harness.runs.atomic import write_text_atomic
from harness.studies.stability import stability
from harness.studies.stability.cases import shipped_folder

TUNNELS = ["tunnel_particle", "tunnel_particle_3d"]
QUICK = ["alone", "friction_zero", *TUNNELS]


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    out = tmp_path_factory.mktemp("stability")
    return stability(QUICK, out, engines=["lammps", "liggghts", "kernel"], workers=2), out


def test_the_kernel_is_stable(done):
    assert done[0].of("alone", "kernel:talk").ended == "stable"


@pytest.mark.parametrize("case", TUNNELS)
def test_the_kernel_stops_with_its_reason(done, case):
    found = done[0].of(case, "kernel:talk")
    assert found.ended == "failed_loudly"
    assert "particle 1 moves" in found.reason


@pytest.mark.parametrize("case", TUNNELS)
@pytest.mark.parametrize("code", ["lammps", "liggghts"])
def test_a_code_that_says_nothing_is_found_out(done, code, case):
    if not ENGINES[code].probe().available:
        pytest.skip(f"{code} is not installed")
    found = done[0].of(case, code)
    assert found.ended == "failed_silently"
    assert found.as_declared
    assert found.reason.startswith("order: neighbours that passed through each other 1 > 0")


def test_a_refused_scene_is_refused_on_every_code(done):
    found, out = done
    assert {r.ended for r in found.results if r.case == "friction_zero"} == {"refused"}
    assert not list((out / "runs").glob("friction_zero*"))


def test_all_as_declared_is_status_0(done):
    assert done[0].exit_status == 0
    assert done[0].surprises == ()


def test_finished_runs_are_kept(done):
    found, out = done
    again = stability(QUICK, out, engines=["kernel"])
    assert again.of("alone", "kernel:talk").held == found.of("alone", "kernel:talk").held


@pytest.mark.long
def test_springs_wind_up_where_slip_and_normal_are_of_two_times(tmp_path):
    """At contacts askew to the axis of a rigid turn, by dt/2 Omega^2 r sin a cos a; not where both are of one time."""
    engines = ["kernel:lammps", "kernel:talk", "kernel:corrected"]
    found = stability(["rotation_locked_dmt_3d"], tmp_path, engines=engines)
    assert {r.engine: r.ended for r in found.results} == {
        "kernel:lammps": "degraded", "kernel:talk": "stable", "kernel:corrected": "stable"}
    assert found.exit_status == 0


@pytest.mark.long
def test_a_long_turn_makes_energy_without_a_word(tmp_path):
    """In LAMMPS, with nothing but its own numbers to be seen by; `kernel:talk` makes none."""
    if not ENGINES["lammps"].probe().available:
        pytest.skip("lammps is not installed")
    found = stability(["rotation_locked_long_3d"], tmp_path, engines=["lammps", "kernel:talk"])
    assert {r.engine: r.ended for r in found.results} == {"lammps": "failed_silently", "kernel:talk": "stable"}
    assert found.of("rotation_locked_long_3d", "lammps").reason.startswith("energy_not_created")
    assert found.exit_status == 0


def shifted(tmp_path, name, *changes):
    """Copy a shipped case with a few words changed."""
    text = (shipped_folder() / f"{name}.toml").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    write_text_atomic(tmp_path / f"{name}.toml", text)
    return tmp_path


def test_another_ending_than_declared_is_status_1(tmp_path):
    """The kernel stops as it must, but nobody said so."""
    folder = shifted(tmp_path, "tunnel_particle", ('engine = "kernel"', 'engine = "kernel:corrected"'))
    found = stability([], tmp_path / "out", engines=["kernel"], folder=folder)
    assert found.exit_status == 1
    assert [r.expected for r in found.surprises] == ["stable"]


def test_a_refusal_that_does_not_come_is_status_1(tmp_path):
    folder = shifted(tmp_path, "friction_zero", ("shear_friction = 0.0", "shear_friction = 0.1"))
    found = stability([], tmp_path / "out", engines=["kernel"], folder=folder)
    assert found.exit_status == 1
    assert "was taken, though it must be refused" in found.surprises[0].reason


def test_a_twin_runs_along_without_being_shown(tmp_path):
    (result,) = stability(["fast_time"], tmp_path, engines=["kernel"]).results
    assert result.ended == "stable"
    assert [h.invariant for h in result.held if h.tolerance > 0] == ["twin"]


def test_the_command_line_says_what_failed_without_a_word(tmp_path, capsys):
    assert main(["stability", "alone", "--engines", "kernel", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "1 hard case on kernel:talk: all ended as declared" in said
    assert (tmp_path / "stability.html").is_file()


@pytest.mark.parametrize(("words", "message"), [
    (["craddle"], "got craddle; did you mean cradle?"),
    (["cradle", "--engines", "lamps"], "did you mean lammps?"),
])
def test_wrong_words_are_one_line_and_status_2(tmp_path, capsys, words, message):
    out = tmp_path / "out"
    assert main(["stability", *words, "--out", str(out)]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not out.exists()


def test_the_list_names_cases_and_topics(capsys):
    assert main(["stability", "--list", "shear_stiffness"]) == 0
    said = capsys.readouterr().out
    assert "shear_soft" in said
    assert "column" not in said
