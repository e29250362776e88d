"""The whole study with codes that answer from memory, and one tiny run with what is really there."""

import dataclasses

import numpy as np
import pytest

from harness.engines.benches import KERNEL
from harness.studies.bench import announced, bench
from harness.studies.bench.cases import find_case
from harness.studies.bench.measure import Effort

EFFORT = Effort(rounds=2, seconds=0.1)


def small(name: str, **changes):
    return dataclasses.replace(find_case(name), quick=(12,), full=(12, 20), **changes)


@pytest.fixture
def run(fake, opener, tmp_path):
    def run(*codes, cases=(), quick=True):
        kernel = fake("kernel")
        return bench(quick=quick, out=tmp_path, cases=cases, timed=[kernel, *codes], kernel=kernel, opener=opener,
                     effort=EFFORT)

    return run


def test_every_case_at_every_size_has_its_cell(run, fake):
    cases = [small("2D elastic"), small("2D dashpot")]
    quick = [(c.case.name, c.count) for c in run(fake("a"), cases=cases).cells]
    assert quick == [("2D elastic", 12), ("2D dashpot", 12)]
    assert [c.count for c in run(fake("a"), cases=cases, quick=False).cells] == [12, 20, 12, 20]


def test_the_kernel_runs_the_base_in_the_same_rounds(run, fake):
    done = run(fake("a"), cases=[small("2D elastic"), small("2D dashpot")], quick=False)
    assert set(done.cells[0].tracks) == {"kernel", "a"}
    assert set(done.cells[-1].tracks) == {"kernel", "a", "kernel, 2D elastic"}


def test_a_quick_run_has_extras_at_few_sizes(run, fake, monkeypatch):
    monkeypatch.setattr("harness.studies.bench.study.QUICK_EXTRAS", (20,))
    cases = [small("2D elastic"), small("2D dashpot")]
    cases[1] = dataclasses.replace(cases[1], quick=(12, 20))
    cells = run(fake("a"), fake("s", slow=True), cases=cases).cells
    assert [len(c.tracks) for c in cells] == [2, 2, 4]


def test_a_case_without_operations_is_skipped_and_named(fake, opener, tmp_path):
    kernel = fake("kernel", refuses=lambda system: "no rolling" if system.rolling else "")
    done = bench(quick=True, out=tmp_path, timed=[kernel], kernel=kernel, opener=opener, effort=EFFORT,
                 cases=[small("2D friction, rolling", base=None), small("2D friction", base=None)])
    assert done.skipped == {"2D friction, rolling": "no rolling"}
    assert [c.case.name for c in done.cells] == ["2D friction"]
    assert done.exit_status == 0


def test_when_time_is_up_the_other_cells_are_left_out_and_named(fake, opener, tmp_path):
    """A clock that moves on by 10 s whenever it is looked at: at the start, and before every cell."""
    kernel, ticks = fake("kernel"), iter(range(0, 1000, 10))
    done = bench(quick=False, out=tmp_path, cases=[small("2D elastic"), small("2D dashpot")], timed=[kernel],
                 kernel=kernel, opener=opener, effort=EFFORT, time_limit=25.0, clock=lambda: next(ticks))
    assert [(c.case.name, c.count) for c in done.cells] == [("2D elastic", 12), ("2D elastic", 20)]
    assert done.left_out == (("2D dashpot", 12), ("2D dashpot", 20))
    assert all(c.seconds > 0.0 for c in done.cells)


def test_what_there_is_to_do_is_announced():
    cases = [small("2D elastic"), small("2D dashpot")]
    said = announced(quick=False, time_limit=90.0, cases=cases)
    assert said == "4 cells, up to 20 particles; none is begun later than after 1.5 minutes"


def test_slow_codes_get_no_large_systems(run, fake, monkeypatch):
    monkeypatch.setattr("harness.studies.bench.study.SLOW_LIMIT", {True: 2000, False: 15})
    cells = run(fake("s", slow=True), cases=[small("2D elastic")], quick=False).cells
    assert ["s" in c.tracks for c in cells] == [True, False]


@pytest.mark.parametrize(("options", "status"), [
    ({}, 0), ({"available": False}, 0), ({"refuses": lambda system: "no"}, 0), ({"lost_at": 1}, 1), ({"off": 1.0}, 1),
])
def test_only_a_failure_is_a_failure(run, fake, options, status):
    assert run(fake("a", **options), cases=[small("2D elastic")]).exit_status == status


def test_all_codes_get_the_same_skin(run, fake):
    one, other = fake("a"), fake("b")
    run(one, other, cases=[small("2D elastic, fast", base=None)])
    assert one.told["skin"] == other.told["skin"] == pytest.approx(0.2e-3)


def test_a_tiny_run_with_the_real_kernel(tmp_path):
    """Program and textbook in child processes: they agree, take time, and tell their memory."""
    from harness.engines.kernel.bench import TEXTBOOK

    case = dataclasses.replace(small("2D friction", base=None), full=(12,))
    done = bench(quick=False, out=tmp_path, cases=[case], timed=[KERNEL, TEXTBOOK],
                 effort=Effort(rounds=2, seconds=0.002))
    (cell,) = done.cells
    kernel, textbook = cell.tracks["kernel"], cell.tracks["textbook"]
    assert done.exit_status == 0
    assert kernel.status == textbook.status == "timed"
    assert textbook.off < 1e-6
    assert (kernel.seconds > 0).all()
    assert len(kernel.seconds) == 2
    assert kernel.facts["peak"] >= kernel.facts["held"] > 12 * 8 * 5
    assert kernel.facts["rebuilds"] >= 1
    assert np.isfinite(cell.load)
