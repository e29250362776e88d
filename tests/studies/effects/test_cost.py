"""Costs of variants from sessions that take turns, with sessions that say what they are told to say."""

import json
from pathlib import Path

import pytest

from harness.engines.session import Lost
from harness.scene.load import load_scene
from harness.scene.resolve import resolve
from harness.studies.effects import cost
from harness.studies.effects.copies import BODIES, copies
from harness.studies.effects.cost import StepCost, step_costs
from harness.studies.effects.variants import BASE

SCENES = Path(__file__).resolve().parents[3] / "inputs" / "scenes"


@pytest.fixture(scope="module")
def system():
    file = SCENES / "oblique_impact.toml"
    return resolve(load_scene(file), file)


class FakeSession:
    """Steps that take as long as it is told; the machine gets slower and slower, for all alike."""

    asked: list = []
    slow = 1.0

    def __init__(self, seconds):
        self.seconds, self.setup_seconds = seconds, 0.5

    def run(self, steps):
        type(self).asked.append(self.seconds)
        type(self).slow *= 1.01
        if self.seconds is None:
            raise Lost("it went away")
        return steps * self.seconds * self.slow

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None


def opener(times):
    left = iter(times)
    return lambda _timed, _place: FakeSession(next(left))


def measured(system, tmp_path, times=(1e-5, 2e-5)):
    systems = {BASE: system, "with gravity": system.with_(gravity=(0.0, -9.81))}
    FakeSession.asked, FakeSession.slow = [], 1.0
    return step_costs("kernel:talk", "1", systems, kept=tmp_path, opener=opener(times), rounds=5)


def test_ratios_are_taken_stretch_by_stretch(system, tmp_path):
    found = measured(system, tmp_path)
    assert found[BASE].ratios == (1.0,) * 5
    assert 1.97 < found["with gravity"].ratio < 2.03, "though the machine slowed down by 10 per cent meanwhile"
    assert len(FakeSession.asked) >= 10
    assert FakeSession.asked[:4] == [1e-5, 2e-5, 2e-5, 1e-5], "another one begins each time"


def test_kept_costs_are_not_measured_again(system, tmp_path):
    first = measured(system, tmp_path)
    again = measured(system, tmp_path, times=())
    assert first == again
    (file,) = tmp_path.glob("*.json")
    assert set(json.loads(file.read_text())) == {BASE, "with gravity"}
    file.write_text("{")
    assert measured(system, tmp_path)[BASE].ratios == (1.0,) * 5


def test_a_session_that_is_lost_has_no_time(system, tmp_path):
    found = measured(system, tmp_path, times=(1e-5, None))
    assert found["with gravity"].step is None
    assert "went away" in found["with gravity"].reason
    assert found[BASE].step > 0.0


def test_an_engine_elsewhere_is_not_timed(system, tmp_path):
    found = step_costs("lammps@2024", "1", {BASE: system}, kept=tmp_path, opener=opener(()))
    assert found[BASE].step is None
    assert "not timed" in found[BASE].reason


def test_small_scenes_are_timed_many_times_side_by_side(system):
    many = copies(system)
    assert len(many.particles) == BODIES
    x = many.particles.x.reshape(-1, 2, 2)
    assert abs((x[:, 1] - x[:, 0]) - (x[0, 1] - x[0, 0])).max() < 1e-12
    assert (abs(x[1:, 0] - x[:-1, 0]).max(axis=1) > 4e-3).all()
    assert copies(many) is many


@pytest.mark.parametrize(
    ("ratios", "differs"),
    [((1.1,) * 7, True), ((1.1,) * 6 + (0.9,), False), ((0.976, 0.992, 1.04), False), ((), False), ((0.5,), False),
     ((0.5,) * 3, True)],
)
def test_when_times_differ(ratios, differs):
    assert StepCost(seconds=(1.0,) * len(ratios), ratios=ratios).differs() is differs


def test_steps_count_for_the_time_of_a_run():
    assert not StepCost(ratios=(0.9, 1.1, 0.9, 1.1)).differs()
    assert StepCost(ratios=(0.9, 1.1, 0.9, 1.1)).differs(steps=1.4)
    assert not StepCost(ratios=(0.9, 1.1, 0.9, 1.1)).shorter(steps=1.4)
    assert StepCost(ratios=(0.9, 1.1, 0.9, 1.1)).shorter(steps=0.7)


def test_schema_is_in_the_name(system, tmp_path, monkeypatch):
    measured(system, tmp_path)
    monkeypatch.setattr(cost, "SCHEMA", cost.SCHEMA + 1)
    measured(system, tmp_path)
    assert len(list(tmp_path.glob("*.json"))) == 2
