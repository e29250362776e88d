"""Growth of differences: round-off passes, what starts larger does not, whatever comes later."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from harness.studies.compare.chaos import ALIKE, WORTH, Kicked, growth_checks, kicked_run, open_questions, parting
from harness.studies.compare.pairs import Pair
from harness.studies.compare.signal import Signal
from harness.studies.statistics.kick import KICK
from harness.studies.verdict import Check, Rerun

SAME = Pair(left="lammps", right="kernel:lammps", kind="same_conventions")
CODES = Pair(left="lammps", right="liggghts", kind="codes")
RERUN = Rerun(scene_file=Path("box.toml"), out=Path("out"), packings=None)
TIME = np.linspace(0.0, 0.02, 401)
RATE = 2000.0


@dataclass(frozen=True)
class Run:
    """A force of 1 N with a relative difference from the exact one."""

    difference: np.ndarray

    @property
    def time(self) -> np.ndarray:
        return TIME

    @property
    def signal(self) -> Signal:
        return Signal(
            step=np.arange(len(TIME)), place=TIME, value=1.0 - self.difference, quantity="force", axis="time (s)",
            word="s", scale=1.0, relative="sample",
        )


def grown(start: float, rate: float = RATE) -> np.ndarray:
    """An exponential that ends at fluctuations of size 0.3; nothing at the start."""
    return np.where(TIME > 0, np.minimum(start * np.exp(rate * TIME), 0.3), 0.0)


EXACT = Run(np.zeros_like(TIME))
KICK_RUN = Kicked(engine="kernel:lammps", curves=Run(grown(1e-12)), why="")


def check(difference, *, kicked=KICK_RUN):
    (found,) = growth_checks([SAME], {"lammps": Run(difference), "kernel:lammps": EXACT}, kicked, RERUN)
    return found


@pytest.mark.parametrize("worth", [1.0, 1e3, 1e5])
def test_amplified_round_off_agrees_however_large_it_gets(worth):
    found = check(grown(worth * 1e-12))
    assert found.verdict == "agrees"
    assert found.deviation == pytest.approx(worth * KICK, rel=1e-3)
    assert (found.level, found.tolerance) == ("L2", WORTH)


@pytest.mark.parametrize("start", [1e-5, 1e-3, 0.5])
def test_what_starts_larger_than_round_off_differs(start):
    found = check(grown(start))
    assert found.verdict == "differs"
    assert found.deviation >= 1e-8
    assert found.why.endswith("rerun: grainproof compare box.toml --engines lammps,kernel:lammps --out out")


def test_a_difference_that_comes_on_the_way_differs():
    """At 3 ms the response is 4e-10; a jump to 2e-3 is worth a kick of 5e-9."""
    late = np.where(TIME > 3e-3, 2e-3, 0.0)
    assert check(late).verdict == "differs"
    assert check(np.where(TIME > 9e-3, 2e-3, 0.0)).verdict == "agrees"


def test_equal_runs_agree_and_a_nan_never_does():
    equal = check(np.zeros_like(TIME))
    assert (equal.verdict, equal.deviation) == ("agrees", 0.0)
    assert "equal to the last bit" in equal.why
    assert check(np.where(TIME > 3e-3, np.nan, 0.0)).verdict == "differs"


def test_words_tell_rates_and_times_of_both():
    why = check(grown(1e-10)).why
    assert why.count("e-fold in 0.5 +- ") == 2
    assert "1% apart at 0.00925 s, 9.25 +- " in why  # ln(1e8)/2000 s = 9.21 ms, samples every 0.05 ms
    assert "kernel:lammps kicked: e-fold" in why
    assert "1% apart at 0.0116 s, 11.6 +- " in why  # ln(1e10)/2000 s = 11.51 ms


def test_runs_that_never_part_are_said_so():
    assert parting(Run(np.full_like(TIME, 1e-12)), EXACT).says == "no exponential growth, never 1% apart"


def test_without_a_response_nothing_is_checked():
    found = check(grown(1e-12), kicked=Kicked(engine="kernel:lammps", curves=None, why="kernel:lammps kicked: crashed"))
    assert (found.verdict, found.deviation) == ("not_checked", None)
    assert "crashed" in found.why
    assert growth_checks([SAME], {"lammps": EXACT, "kernel:lammps": EXACT}, None, RERUN) == []
    lost = Kicked(engine="kernel:talk", curves=EXACT, why="")
    assert "no completed run of kernel:talk" in check(grown(1e-12), kicked=lost).why


def test_pairs_without_a_run_have_no_growth():
    assert growth_checks([SAME], {"lammps": EXACT}, KICK_RUN, RERUN) == []


@pytest.mark.parametrize(("factor", "verdict"), [(1.0, "agrees"), (0.5 * ALIKE, "agrees"), (2.0 * ALIKE, "differs")])
def test_conventions_explain_what_the_kernel_shows_too(factor, verdict):
    """Codes 1e-6 apart at once, as the kernel in their two conventions is."""
    first = {
        "lammps": Run(factor * grown(1e-6)), "liggghts": EXACT, "kernel:lammps": Run(grown(1e-6)),
        "kernel:liggghts": EXACT,
    }
    (found,) = growth_checks([CODES], first, KICK_RUN, RERUN)
    assert found.verdict == verdict
    assert found.deviation == pytest.approx(factor, rel=1e-6)
    assert found.tolerance == ALIKE
    del first["kernel:liggghts"]
    assert growth_checks([CODES], first, KICK_RUN, RERUN) == []


def test_what_became_of_the_response(finished):
    from types import SimpleNamespace

    assert kicked_run(None, Run) is None
    outcome = SimpleNamespace(status="crashed")
    lost = SimpleNamespace(trajectory=None, of="kernel:lammps", engine="kernel:lammps kicked", outcome=outcome)
    assert kicked_run(lost, Run) == Kicked(engine="kernel:lammps", curves=None, why="kernel:lammps kicked: crashed")
    done = SimpleNamespace(trajectory=TIME, of="kernel:lammps", engine="kernel:lammps kicked", outcome=outcome)
    assert kicked_run(done, Run).curves.difference is TIME


def test_statistics_take_over_what_chaos_left_open():
    def made(left, verdict, level="L2"):
        return Check(
            level=level, quantity="q", left=left, right="b", deviation=None, tolerance=None, verdict=verdict, why=""
        )

    left_open, decided = made("a", "inconclusive"), made("a", "agrees")
    assert open_questions([left_open, decided], [made("a", "inconclusive", "L3")]) == [decided]
    assert open_questions([left_open, decided], [made("c", "agrees", "L3")]) == [left_open, decided]
    assert open_questions([left_open], [made("a", "not_checked", "L3")]) == [left_open]
