"""What is kept beside the runs, and what is made again."""

import json
import logging
from types import SimpleNamespace

import numpy as np
import pytest

from harness.runs.sealed import read_sealed, write_sealed
from harness.studies.accuracy import cost, keep
from harness.studies.accuracy.cost import measure_costs
from harness.studies.accuracy.exits import Exits
from harness.studies.accuracy.oracle import Oracle


def cut(place):
    place.write_text(place.read_text()[:30])


def empty(place):
    place.write_text("{}")


def nothing(place):
    place.write_text("")


def a_list(place):
    place.write_text("[1, 2]")


def one_percent(place):
    """A number times 1.01, the checksum as it was."""
    data = json.loads(place.read_text())
    told = data["seconds"] if "seconds" in data else data["exits"]["v"][0][0]
    told[0] *= 1.01
    place.write_text(json.dumps(data))


def unsealed(place):
    data = json.loads(place.read_text())
    del data["sha256"]
    place.write_text(json.dumps(data))


DAMAGE = pytest.mark.parametrize("damage", [cut, empty, nothing, a_list, one_percent, unsealed])


def test_what_was_written_is_read(tmp_path, caplog):
    place = tmp_path / "times" / "a.json"
    assert read_sealed(place, "it is") is None
    data = {"seconds": [1e-6, 0.1 + 0.2], "reason": "", "none": None}
    write_sealed(place, data)
    assert read_sealed(place, "it is") == data
    assert not caplog.records


@DAMAGE
def test_damaged_times_are_made_again(damage, tmp_path, monkeypatch, caplog):
    made = []

    def run(timed, *_):
        made.append(timed)
        return 1e-6, 0.1

    monkeypatch.setattr(cost, "_run", run)
    monkeypatch.setattr(cost, "timed_as", lambda name: name)
    monkeypatch.setattr(cost, "_refusal", lambda *_: "")
    system = SimpleNamespace(digest=lambda: "abc", steps=10)

    def measured():
        return measure_costs({"lammps": system}, {"lammps": "1"}, kept=tmp_path / "times", opener=None)

    first = measured()
    assert measured() == first
    assert len(made) == 3
    (place,) = (tmp_path / "times").iterdir()
    damage(place)
    with caplog.at_level(logging.WARNING):
        assert measured() == first
    assert len(made) == 6
    assert f"times/{place.name}: it is not what was written" in caplog.text
    assert "made again" in caplog.text


@DAMAGE
def test_damaged_oracles_are_made_again(damage, tmp_path, monkeypatch, caplog):
    made = []

    def oracle(*_, **__):
        made.append(1)
        return Oracle(exits=Exits(v=np.ones((1, 2, 2)), spin=np.ones((1, 2, 1))), error={"exit": 1e-9}, kind="events",
                      says="exact")

    monkeypatch.setattr(keep, "oracle", oracle)
    system = SimpleNamespace(digest=lambda: "abc")

    def kept():
        return keep.kept_oracle(system, "talk", kept=tmp_path / "oracles", file=None, contact_time=1.0, finest=0.1)

    kept()
    kept()
    assert len(made) == 1
    (place,) = (tmp_path / "oracles").iterdir()
    damage(place)
    with caplog.at_level(logging.WARNING):
        assert (kept().exits.v == 1.0).all()
    assert len(made) == 2
    assert "the oracle is made again" in caplog.text
