"""Rounds, with codes that answer from memory: turns, ratios, failures, and the check that all solve one problem."""

import numpy as np
import pytest

from harness.studies.bench.measure import FEWEST_STEPS, SAME, WARM_STEPS, Effort, distance, measure

EFFORT = Effort(rounds=3, seconds=0.4)


def test_every_round_gives_all_codes_a_turn_and_begins_with_another(fake, opener, entrants, tmp_path):
    codes = [fake("kernel"), fake("a"), fake("b")]
    measure(entrants(*codes), tmp_path, opener, EFFORT)
    names = [name for name, _ in opener.log]
    assert names == ["kernel", "a", "b", "kernel", "a", "b", "a", "b", "kernel", "b", "kernel", "a"]
    steps = {steps for _, steps in opener.log[3:]}
    assert [s for _, s in opener.log[:3]] == [WARM_STEPS] * 3
    assert steps == {400}  # 0.4 s of 1 ms
    assert steps.pop() % FEWEST_STEPS == 0
    assert sorted(opener.closed) == ["a", "b", "kernel"]


def test_times_are_those_of_the_rounds_per_step(fake, opener, entrants, tmp_path):
    codes = [fake("kernel", seconds=[1e-3, 2e-3, 4e-3, 6e-3]), fake("a", seconds=[5e-3, 1e-3, 2e-3, 3e-3])]
    tracks = measure(entrants(*codes), tmp_path, opener, EFFORT)
    assert tracks["kernel"].seconds == pytest.approx([2e-3, 4e-3, 6e-3])
    assert tracks["kernel"].seconds / tracks["a"].seconds == pytest.approx([2.0, 2.0, 2.0])


def test_the_fastest_code_decides_how_long_a_round_is_but_not_below_the_least(fake, opener, entrants, tmp_path):
    measure(entrants(fake("kernel", seconds=[1e-2]), fake("a", seconds=[1e-1])), tmp_path, opener, EFFORT)
    assert {steps for _, steps in opener.log[2:]} == {FEWEST_STEPS}


def test_a_slow_code_gets_its_share(fake, opener, entrants, tmp_path):
    both = [*entrants(fake("kernel")), *entrants(fake("slow"), share=0.125)]
    tracks = measure(both, tmp_path, opener, EFFORT)
    assert {steps for name, steps in opener.log[2:] if name == "slow"} == {50}
    assert tracks["slow"].seconds == pytest.approx([1e-3] * 3)


@pytest.mark.parametrize("lost_at", [0, 1, 3])
def test_a_code_that_is_lost_is_out_and_the_others_go_on(fake, opener, entrants, tmp_path, lost_at):
    tracks = measure(entrants(fake("kernel"), fake("a", lost_at=lost_at)), tmp_path, opener, EFFORT)
    assert (tracks["a"].status, tracks["a"].reason) == ("lost", "gone")
    assert len(tracks["a"].seconds) == 0
    assert len(tracks["kernel"].seconds) == 3
    assert sorted(opener.closed) == ["a", "kernel"]


def test_codes_that_cannot_take_part_are_not_started(fake, opener, entrants, tmp_path):
    codes = [fake("kernel"), fake("absent", available=False), fake("unable", refuses=lambda system: "no such law")]
    tracks = measure(entrants(*codes), tmp_path, opener, EFFORT)
    assert (tracks["absent"].status, tracks["absent"].reason) == ("unavailable", "not here")
    assert (tracks["unable"].status, tracks["unable"].reason) == ("refused", "no such law")
    assert {name for name, _ in opener.log} == {"kernel"}


def test_a_code_that_solves_another_problem_is_not_timed(fake, opener, entrants, tmp_path):
    codes = [fake("kernel"), fake("near", off=0.9 * SAME), fake("far", off=1.1 * SAME), fake("nan", off=np.nan)]
    tracks = measure(entrants(*codes), tmp_path, opener, EFFORT)
    assert tracks["near"].status == "timed"
    assert tracks["near"].off == pytest.approx(0.9 * SAME)
    for label in ("far", "nan"):
        assert tracks[label].status == "differs"
        assert "not the same problem" in tracks[label].reason
        assert len(tracks[label].seconds) == 0


def test_another_case_of_the_kernel_is_not_compared(fake, opener, entrants, tmp_path):
    both = [*entrants(fake("kernel")), *entrants(fake("base", off=5.0), same_problem=False)]
    tracks = measure(both, tmp_path, opener, EFFORT)
    assert tracks["base"].status == "timed"
    assert tracks["base"].off is None


def test_without_the_kernel_the_others_are_still_timed(fake, opener, entrants, tmp_path):
    tracks = measure(entrants(fake("kernel", lost_at=0), fake("a")), tmp_path, opener, EFFORT)
    assert tracks["kernel"].status == "lost"
    assert len(tracks["a"].seconds) == 3


def test_when_all_are_lost_nothing_is_timed(fake, opener, entrants, tmp_path):
    tracks = measure(entrants(fake("kernel", lost_at=0)), tmp_path, opener, EFFORT)
    assert tracks["kernel"].status == "lost"


def test_an_interrupt_ends_all_children(fake, opener, entrants, tmp_path):
    code = fake("kernel")
    code.refuses = lambda system: ""
    broken = fake("a")
    broken.render = lambda system, skin: (_ for _ in ()).throw(KeyboardInterrupt)
    with pytest.raises(KeyboardInterrupt):
        measure(entrants(code, broken), tmp_path, opener, EFFORT)
    assert opener.closed == ["kernel"]


def test_images_are_no_distance(tiny):
    """A code that wraps its positions into the box is where the kernel is."""
    periodic = tiny.with_(periodic=(0.02, 0.0))
    moved = tiny.particles.x + [3e-6, 1e-6]
    assert distance(periodic, moved, moved + [0.02, 0.0]) < 1e-9
    assert distance(periodic, moved, moved + [0.0, 0.02]) > 1e3
    assert distance(tiny, moved, moved + [0.02, 0.0]) > 1e3
