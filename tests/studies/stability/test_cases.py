"""Every shipped hard case: read, checked, rendered for every code that takes it."""

import pytest

from harness.engines.protocol import takes
from harness.engines.registry import ENGINES, USUAL, choose_alone
from harness.errors import InputError
from harness.scene.resolve import known_system, needs_packing
from harness.studies.stability.cases import all_cases, choose_cases, read_case, shipped_folder, with_twins
from harness.studies.stability.judge import declared
from harness.studies.stability.topics import TOPICS

CASES = all_cases()
EXPLICIT = [c for c in CASES if c.scene is not None and not needs_packing(c.scene)]

IN_SPACE = {
    "cell_edge", "coincident", "corner", "elastic_packing", "far_away", "grazing", "rotation", "seam", "size_ratio",
    "tunnel_particle",
}
"""Topics that a plane shows only half of: each has a case of spheres too."""

CASE = """
kind = "free"
title = "A case"
dimension = 2
duration = 1e-4
bodies = [{{position = [0.0, 0.0], radius = 1e-3, mass = 1e-5}}]

[contact.normal]
law = "linear"
normal_stiffness = {stiffness}
normal_damping = 0.0
attraction = "allowed"

[numerics]
dt_fraction = 0.02

[outputs]
samples = 20
frames = 20
contacts = false

[expect]
topics = ["{topic}"]
why = "a test"
{more}
[[expect.invariants]]
name = "{invariant}"
tolerance = 1e-9
reason = "a test"
{twin}
"""


@pytest.fixture
def write(tmp_path):
    """Write a case `wrong.toml`; return its file."""

    def made(*, stiffness="1e5", topic="alone", invariant="free_flight", more="", twin=""):
        file = tmp_path / "wrong.toml"
        file.write_text(CASE.format(stiffness=stiffness, topic=topic, invariant=invariant, more=more, twin=twin))
        return file

    return made


def test_there_are_cases_enough_and_every_kind_of_trouble_has_one():
    assert len(CASES) >= 40
    assert {t for c in CASES for t in c.expect.topics} == set(TOPICS)


def test_what_a_plane_shows_only_half_of_has_a_case_in_space():
    spheres = [c for c in CASES if "dimension = 3" in c.file.read_text()]
    assert {t for c in spheres for t in c.expect.topics} >= IN_SPACE
    assert all(c.scene is None or c.scene.dimension == 3 for c in spheres)


@pytest.mark.parametrize("case", [c for c in CASES if c.scene is None], ids=lambda c: c.name)
def test_what_must_be_refused_is_refused_in_one_line_for_the_reason_declared(case):
    assert case.expect.refused in case.refusal
    assert "\n" not in case.refusal


@pytest.mark.parametrize("case", [c for c in CASES if c.scene is not None], ids=lambda c: c.name)
def test_what_runs_promises_something_and_says_why(case):
    assert case.expect.invariants
    assert all(len(i.reason) > 5 for i in case.expect.invariants)
    assert all(o.engine.split(":")[0] in ("lammps", "liggghts", "kernel") for o in case.expect.outcomes)


@pytest.mark.parametrize("case", EXPLICIT, ids=lambda c: c.name)
def test_every_code_that_takes_a_case_has_a_deck_of_it(case):
    system = known_system(case.scene, case.file)
    for engine in (ENGINES[name] for name in ("lammps", "liggghts", "kernel:talk")):
        if takes(engine, system):
            assert engine.render(system)
        else:
            assert declared(case, engine.name)[0] == "unsupported"


def test_the_standard_set_leaves_long_cases_out_unless_asked():
    standard, full = choose_cases(CASES, [], long=False), choose_cases(CASES, [], long=True)
    assert full == CASES
    assert [c for c in CASES if not c.expect.long] == list(standard)


def test_a_topic_names_its_cases():
    chosen = choose_cases(CASES, ["shear_stiffness"], long=False)
    assert {c.name for c in chosen} == {"shear_soft", "shear_stiff", "late_mindlin", "late_rolling", "late_torsion"}
    assert [c.name for c in choose_cases(CASES, ["cradle"], long=False)] == ["cradle"]


def test_a_twin_is_run_along():
    chosen = choose_cases(CASES, ["far_away"], long=False)
    assert {c.name for c in with_twins(chosen, CASES)} >= {"far_away", "unit_base"}


def test_an_unknown_case_is_told_what_was_meant():
    with pytest.raises(InputError, match="got craddle; did you mean cradle"):
        choose_cases(CASES, ["craddle"], long=False)


def test_usual_engines_are_three():
    assert [e.name for e in choose_alone(list(USUAL))] == ["lammps", "liggghts", "kernel:talk"]


@pytest.mark.parametrize(("changes", "message"), [
    ({"invariant": "free_fligth"}, r"expect.invariants\[0\].name: expected one of finite, .* did you mean free_flight"),
    ({"topic": "alnoe"}, "expect.topics: expected words out of .* got alnoe; did you mean alone"),
    ({"invariant": "twin"}, r"expect.invariants\[0\].twin: expected a table for twin, got nothing"),
    ({"twin": 'twin = {case = "alone"}'}, "expected no table for free_flight, got a table"),
    ({"more": "because = 1"}, "expect.because: expected one of topics, why, .*unknown key"),
    ({"stiffness": "-1"}, "normal_stiffness: expected a number > 0, got -1"),
])
def test_a_wrong_case_is_one_line(write, changes, message):
    with pytest.raises(InputError, match=message):
        read_case(write(**changes))


def test_a_scene_is_no_case(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text('kind = "free"\n')
    with pytest.raises(InputError, match="expect: expected a table: this is a hard case, got nothing"):
        read_case(file)


def test_a_twin_that_is_not_there_is_named(write, tmp_path):
    write(invariant="twin", twin='twin = {case = "nobody"}')
    with pytest.raises(InputError, match="expected the name of a hard case that runs, got nobody"):
        all_cases(tmp_path)


def test_an_empty_folder_is_told(tmp_path):
    with pytest.raises(InputError, match=r"expected hard cases \(\*.toml\), got none"):
        all_cases(tmp_path)


def test_a_scene_that_should_be_refused_and_is_not_has_no_refusal(write):
    case = read_case(write(more='refused = "stiffness"'))
    assert case.scene is None
    assert case.refusal == ""


def test_shipped_cases_are_where_the_package_looks():
    assert (shipped_folder() / "cradle.toml").is_file()
