"""One rate of false alarms for all tests of a report: measured where nothing differs; what is planted is seen."""

from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness.studies.compare.alarms import handed_in, judged_together, smallest_p
from harness.studies.compare.band import Band
from harness.studies.compare.couette import judge_averages
from harness.studies.compare.pairs import pairs_of
from harness.studies.compare.profile_quantities import QUANTITIES
from harness.studies.compare.profiles import RingProfiles, number_of, profile_of
from harness.studies.compare.ring_balances import RingBalances
from harness.studies.verdict import Check, Rerun
from postproc.macro.fits.least_squares import Parameter
from postproc.macro.fits.shear_band import ShearBand

RERUN = Rerun(scene_file=Path("ring.toml"), out=Path("out"), packings=None)
ENGINES = ["lammps", "liggghts", "kernel:lammps", "kernel:liggghts"]
NAMES = ("v_phi", "spin", "volume_fraction", "stress_rr", "stress_rphi", "fabric_trace")
DIAMETER, RATE = 4e-3, 0.05


@dataclass(frozen=True)
class Ring:
    """Made-up runs of equal codes: autocorrelated in time (AR(1), a factor `memory` a frame), cells that correlate."""

    frames: int = 300
    cells: int = 8
    memory: float = 0.5
    packings: int = 1
    neighbours: int = 3

    def series(self, rng, *cells):
        from scipy.signal import lfilter

        white = np.sqrt(1 - self.memory**2) * rng.normal(size=(self.frames + 50, *cells))
        return lfilter([1.0], [1.0, -self.memory], white, axis=0)[50:]

    def field(self, rng):
        wide = self.series(rng, self.cells + self.neighbours - 1)
        return sum(wide[:, k : k + self.cells] for k in range(self.neighbours)) / np.sqrt(self.neighbours)

    def profiles(self, rng, offset):
        made = {n: profile_of(1.0 + offset[n] + 0.5 * self.field(rng), "1") for n in NAMES}
        return RingProfiles(
            edges=np.linspace(0.02, 0.1, self.cells + 1), glued=np.zeros(self.cells), frames=self.frames, spacing=0.1,
            profiles=made, absent={q.name: "not asked for" for q in QUANTITIES if q.name not in made},
        )

    def balances(self, rng, r):
        def number(mean, size):
            return number_of(mean + size * self.series(rng), "N m")

        def field():
            return profile_of(0.05 * self.field(rng), "N/m")

        return RingBalances(
            r=r, inner=number(1.0, 0.3), outer=number(-1.0, 0.3), total=number(0.0, 0.05), drift=number(0.0, 0.05),
            drag=None, through=field(), from_inner=field(), from_outer=field(), circles=np.ones(self.cells, bool),
            momentum=(field(), field()), mean_pressure=number(1.0, 0.3),
        )

    def runs(self, rng):
        """Profiles, balances and bands by engine and packing; what a packing does is common to all engines."""
        profiles, balances, bands = ({e: {} for e in ENGINES} for _ in range(3))
        for k in range(self.packings):
            shift = 0.3 * (self.packings > 1)
            offset = {n: shift * rng.normal(size=self.cells) for n in NAMES}
            for e in ENGINES:
                profiles[e][k] = self.profiles(rng, offset)
                balances[e][k] = self.balances(rng, profiles[e][k].r)
                bands[e][k] = band(2.0 + 0.05 * rng.normal(), 0.05)
        return profiles, balances, bands


def band(width, error):
    """A band at the end of the talk's range, where a false alarm is likeliest."""
    fit = ShearBand(
        v0=Parameter(value=0.7, error=0.01), s=Parameter(value=width * DIAMETER, error=error * DIAMETER), low=0.0,
        high=0.02, method="weighted", chi2=1.0, points=1000,
    )
    return Band(
        fit=fit, why="", diameter=DIAMETER, wall=0.01, reach=0.02, error=error * DIAMETER, nearest=(0.7, 0.01, 1e-3)
    )


@pytest.fixture
def judged(monkeypatch):
    """judged(runs) are the checks of a whole report, and how many tests share their rate; without advice, for speed."""
    monkeypatch.setattr("harness.studies.compare.ring_numbers.band_in_time", lambda profiles, band: {})
    for place in ("harness.studies.compare.profile_checks", "harness.studies.statistics.family"):
        monkeypatch.setattr(f"{place}._more", lambda *_: "")

    def make(runs, rate=RATE):
        scene = SimpleNamespace(compare=SimpleNamespace(false_alarms=rate, margin=0.25))
        averaged = judge_averages(scene, ENGINES, pairs_of(ENGINES, friction=True), *runs, RERUN)
        return [*averaged.of_codes, *averaged.of_runs], averaged.tests

    return make


def alarms(judged, ring, draws, seed, rate=RATE):
    """Part of the reports on equal codes that say anywhere that something differs, and what it was."""
    rng, found = np.random.default_rng(seed), []
    for _ in range(draws):
        checks, _ = judged(ring.runs(rng), rate)
        found.append([f"{c.level} {c.quantity}" for c in checks if c.verdict == "differs"])
    return np.mean([bool(f) for f in found]), Counter(q for f in found for q in f)


def bound(draws, rate=RATE):
    """Three standard errors above the declared rate."""
    return rate + 3.0 * np.sqrt(rate * (1 - rate) / draws)


def test_a_report_on_equal_codes_rarely_says_that_anything_differs(judged):
    part, which = alarms(judged, Ring(frames=200, cells=6), 30, seed=3)
    assert part <= bound(30), which


@pytest.mark.long
@pytest.mark.parametrize("ring", [
    Ring(), Ring(memory=0.0), Ring(memory=0.8, frames=1200), Ring(packings=4, cells=6)])
def test_the_rate_of_false_alarms_is_the_declared_one(judged, ring):
    part, which = alarms(judged, ring, 300, seed=4)
    assert part <= bound(300), which


@pytest.mark.long
def test_without_the_correction_most_reports_would_raise_one(judged):
    """That alarms are rare is the correction's doing: the tests are able to raise them."""
    part, which = alarms(judged, Ring(), 30, seed=5, rate=0.999)
    assert part > 0.3
    assert len({q.split(" ")[0] for q in which}) == 2


PLANTED = {
    "profile: velocity": lambda p, b, w: (_moved(p, 0, "v_phi", 3, 0.6), b, w),
    "mean over cells of spin": lambda p, b, w: (_moved(p, 1, "spin", slice(None), 0.3), b, w),
    "torque on inner + outer ring = 0": lambda p, b, w: (p, _off(b, 0.3), w),
    "shear band width s/d": lambda p, b, w: (p, b, w | {"lammps": {0: band(2.6, 0.05)}}),
}


def _moved(profiles, engine, name, cells, by):
    run = profiles[ENGINES[engine]][0]
    series = run.profiles[name].series.copy()
    series[:, cells] += by
    changed = replace(run, profiles={**run.profiles, name: profile_of(series, "1")})
    return profiles | {ENGINES[engine]: {0: changed}}


def _off(balances, by):
    run = balances["lammps"][0]
    total = replace(run.total, mean=run.total.mean + by)
    return balances | {"lammps": {0: replace(run, total=total)}}


@pytest.mark.parametrize("quantity", PLANTED)
def test_what_is_planted_in_any_kind_of_test_is_seen_at_the_shared_rate(judged, quantity):
    runs = PLANTED[quantity](*Ring().runs(np.random.default_rng(8)))
    checks, tests = judged(runs)
    differs = {c.quantity for c in checks if c.verdict == "differs"}
    assert any(q.startswith(quantity) for q in differs)
    assert tests > 60


def test_a_test_among_more_needs_more_to_see(judged):
    """The same numbers at a hundredth of the rate: what was just seen is not."""
    rng = np.random.default_rng(8)
    runs = Ring().runs(rng)
    sizes = np.linspace(0.1, 0.6, 11)
    seen = [
        next(s for s in sizes if _differs(judged((_moved(runs[0], 0, "v_phi", 3, s), *runs[1:]), rate)[0]))
        for rate in (0.05, 0.0005)
    ]
    assert seen[0] < seen[1]


def _differs(checks):
    return any(c.verdict == "differs" and c.quantity == "profile: velocity" for c in checks)


@pytest.mark.parametrize(("cells", "number", "expected"), [
    ([[0.01, 0.5]], 2, 0.02), ([[0.01], [0.002, 0.4]], 10, 0.02), ([[0.9]], 5, 1.0), ([[]], 3, 1.0), ([], 3, 1.0),
    ([[np.nan, 0.5]], 2, 0.0),
])
def test_several_cells_hand_in_one_p_value(cells, number, expected):
    assert smallest_p((np.array(c) for c in cells), number) == pytest.approx(expected)


def test_what_has_nothing_to_test_hands_in_nothing():
    @dataclass(frozen=True)
    class One:
        p: float | None

        def check(self, level):
            facts = {"level": "run", "quantity": "q", "left": "a", "right": "b", "deviation": self.p, "why": ""}
            return Check(**facts, tolerance=level, verdict="not_checked" if self.p is None else "agrees")

    tests = [One(0.2), One(None), One(0.5)]
    assert handed_in(tests) == [0.2, 0.5]
    assert {c.tolerance for c in judged_together(tests, 0.06)} == {0.03}
