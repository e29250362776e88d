"""Every study declares everything: what the talk says, sizes, engines, values with their tags, who lacks the law."""

import pytest

from harness.engines.protocol import takes
from harness.engines.registry import ENGINES, choose_engines
from harness.errors import InputError
from harness.report.expected import expected_cases, likely_system
from harness.studies.reproduce.protocol import SIZES
from harness.studies.reproduce.registry import STUDIES, all_studies, find_study
from reference.values import published_values


@pytest.fixture(params=STUDIES)
def study(request):
    return find_study(request.param)


def test_the_issue_is_covered():
    assert {"cohesion", "friction", "anisotropy", "rotations", "cyclic"} <= set(STUDIES)
    assert list(all_studies()) == list(STUDIES)


def test_a_study_declares_itself(study):
    assert study.name in STUDIES
    assert study.title
    assert study.claim
    assert study.source
    assert set(study.sizes) == set(SIZES)
    assert all(d.says and d.packings >= 1 for d in study.sizes.values())
    assert choose_engines(list(study.engines))
    assert set(study.lacking) <= set(ENGINES)
    assert all(study.lacking.values())


def test_its_values_stand_in_the_table_and_say_how_they_are_known(study):
    known = published_values()
    for name in study.values:
        assert known[name].origin
        assert isinstance(known[name].seen, bool)
        assert known[name].conditions


@pytest.mark.parametrize("size", SIZES)
def test_its_cases_can_be_run_by_whom_it_says(study, size, ask):
    cases = study.cases(ask(size))
    names, titles = [c.name for c in cases], [c.scene.title for c in cases]
    assert len(set(names)) == len(names)
    assert len(set(titles)) == len(titles)  # a deck holds its title: two cases must not share a deck by half
    for case in cases[:2]:
        system = likely_system(case.scene, case.file)
        for name in study.lacking:
            assert not takes(ENGINES[name], system)
        for name in study.engines:
            if name in ENGINES and name not in study.lacking:
                assert takes(ENGINES[name], system)


def test_its_time_is_said_beforehand(study, ask):
    asked = ask("quick", "kernel:talk")
    expected = expected_cases(study.cases(asked), asked.engines)
    assert expected.seconds > 0.0
    assert expected.cpu >= 0.0


def test_an_unknown_study_is_refused_with_the_nearest():
    with pytest.raises(InputError, match="did you mean cohesion"):
        find_study("cohesoin")
