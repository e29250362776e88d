"""Whatever happens to a run is a value: which status, which reason."""

from __future__ import annotations

import pytest

from harness.engines.liggghts import LIGGGHTS
from harness.engines.liggghts.deck import INPUT

needs_liggghts = pytest.mark.needs_liggghts


@pytest.fixture(name="outcome")
def _outcome(deck):
    """Run a system, its deck changed by replacing words."""

    def outcome(system, *changes, time_limit=20.0):
        folder = deck(system)
        text = (folder / INPUT).read_text()
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        (folder / INPUT).write_text(text)
        return LIGGGHTS.run(folder, time_limit=time_limit)

    return outcome


@pytest.fixture(name="lidded")
def _lidded(make, plane):
    """A disc between two fixed planes."""

    def lidded(**rest):
        walls = [plane(1, "floor", (0, 0), (0, 1)), plane(2, "lid", (0, 2), (0, -1))]
        return make(**({"x": [[0, 0.6]], "walls": walls} | rest))

    return lidded


@needs_liggghts
def test_completed(lidded, outcome):
    result = outcome(lidded())
    assert (result.status, result.reason) == ("completed", "")
    assert 0 < result.timings["run"] <= result.wall_seconds
    assert result.timings["forces"] >= 0
    assert result.cpu_seconds > 0


@needs_liggghts
@pytest.mark.parametrize(("change", "reason"), [
    (("fix integrate", "fxi integrate"), "Unknown command: fxi integrate grains nve/sphere"),
    (("model hooke/stiffness primitive", "model hoooke primitive"), "Invalid model specified"),
    (("run 400", "run 100"), "stopped at step 100 of 400"),
    (("packing.data", "nothing.data"), "Cannot open file nothing.data"),
    (('print "grainproof', 'print "nothing'), "exit status 0 before its finished marker"),
])
def test_a_broken_deck_crashes_with_the_engines_reason(lidded, outcome, change, reason):
    result = outcome(lidded(), change)
    assert result.status == "crashed"
    assert reason in result.reason
    assert "\n" not in result.reason


@needs_liggghts
def test_a_lost_particle_is_unstable(lidded, outcome):
    result = outcome(lidded(v=[[0, -90.0]], dt=1e-2))
    assert result.status == "unstable"
    assert result.reason.startswith("a particle left the domain after step ")


@needs_liggghts
def test_atoms_lost_before_the_first_look_are_counted(lidded, outcome):
    """LIGGGHTS compares with its last print; the marker compares with the packing."""
    result = outcome(lidded(), ("of 1 atoms", "of 2 atoms"))
    assert (result.status, result.reason) == ("unstable", "1 of 2 atoms were lost")


@needs_liggghts
def test_not_a_number_is_unstable(lidded, outcome):
    """A centre on the plane has no normal: LIGGGHTS goes on with NaN to its end."""
    result = outcome(lidded(x=[[0, 0.0]]))
    assert result.status == "unstable"
    assert result.reason.startswith("not a number in the series at step ")


@needs_liggghts
def test_a_wall_thrown_out_is_unstable(make, plane, outcome):
    from harness.scene.system import Loaded

    lid = Loaded(mass=1e-6, load=1.0, stress=0.0, span=None, damping=0.0)
    walls = [plane(1, "floor", (0, 0), (0, 1)), plane(2, "lid", (0, 0.95), (0, -1), False, lid)]
    result = outcome(make(x=[[0, 0.49]], walls=walls))
    assert result.status == "unstable"


@needs_liggghts
def test_the_time_limit_is_kept_and_progress_is_told(lidded, deck):
    system = lidded(steps=40_000_000, sample_every=100)
    folder = deck(system)
    assert LIGGGHTS.steps_done(folder) == 0
    result = LIGGGHTS.run(folder, time_limit=1.5)
    assert (result.status, result.reason) == ("timed_out", "stopped after the time limit of 1.5 s")
    assert LIGGGHTS.steps_done(folder) > 0
    assert LIGGGHTS.steps_done(folder) % 100 == 0


def test_a_missing_binary_is_told_and_never_raises(lidded, deck, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    probe = LIGGGHTS.probe()
    assert not probe.available
    assert probe.detail == "apt-get install -y --no-install-recommends liggghts"
    result = LIGGGHTS.run(deck(lidded()), time_limit=5)
    assert result.status == "crashed"
    assert result.reason


@needs_liggghts
def test_probe_names_the_package_version():
    probe = LIGGGHTS.probe()
    assert probe.available
    assert probe.version.startswith("3.8")
    assert probe.detail.endswith("liggghts")
