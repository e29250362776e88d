"""The judgement of a biaxial comparison: true runs agree, and every wrong one is caught by a named check."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.studies.compare.biaxial import judge_biaxial
from harness.studies.compare.run_checks import inertial_numbers, place_error
from harness.studies.verdict import Rerun, failed
from postproc.snapshot import Columns

WINDOW, SIDE, PLACES, STRESS, INERTIA = (
    "top-wall force up to 2 % strain", "side wall (F_x - p_x z)/(p_x z)", "places of the walls",
    "stress from contacts = from walls", "rate of the drive (axial inertial number)",
)
ENGINES = ["lammps", "kernel:lammps"]
RERUN = Rerun(scene_file=Path("box.toml"), out=Path("out"), packings=None)


@pytest.fixture
def judge(box, finished):
    """judge(trajectories by engine) returns checks and result; several packings as a list."""

    def judged(engines=ENGINES, of=box, **runs):
        runs = {name.replace("_", ":"): r if isinstance(r, list) else [r] for name, r in runs.items()}
        starts = [of.start(k) for k in range(max(map(len, runs.values()), default=1))]
        made = [finished(e, k, t) for e, r in runs.items() for k, t in enumerate(r)]
        return judge_biaxial(of.scene, starts, made, list(engines), RERUN)

    return judged


def test_two_true_runs_agree_in_everything(box, judge):
    true = box.trajectory()
    checks, result = judge(lammps=true, kernel_lammps=true)
    of_interest = [c for c in checks if c.left != "-"]
    assert {c.verdict for c in of_interest} == {"agrees"}
    assert {c.quantity for c in of_interest} == {
        WINDOW, "top-wall force, whole test", SIDE, PLACES, STRESS, INERTIA,
    }
    assert not failed(checks)
    assert set(result.curves) == set(result.states) == set(ENGINES)
    assert not result.growth["lammps - kernel:lammps"].difference.any()
    assert result.macro["lammps", 0] == result.macro["kernel:lammps", 0]


MUTANTS = {
    "top force doubled": (WINDOW, lambda t, m: m.series(t, top_fy=lambda f: 2 * f)),
    "top force of the other sign": (WINDOW, lambda t, m: m.series(t, top_fy=lambda f: -f)),
    "top force one sample late": (WINDOW, lambda t, m: m.series(t, top_fy=lambda f: np.r_[f[0], f[:-1]])),
    "top force of the side wall": (WINDOW, lambda t, m: m.series(t, top_fy=t.series["right_fx"])),
    "top force half a per mille off": (WINDOW, lambda t, m: m.series(t, top_fy=lambda f: 1.0005 * f)),
    "top force no number": (WINDOW, lambda t, m: m.series(t, top_fy=lambda f: np.where(f > 0.7, np.nan, f))),
    "side force doubled": (SIDE, lambda t, m: m.series(t, right_fx=lambda f: 2 * f)),
    "side force of the other sign": (SIDE, lambda t, m: m.series(t, right_fx=lambda f: -f)),
    "side force of the top wall": (SIDE, lambda t, m: m.series(t, right_fx=t.series["top_fy"])),
    "side force no number": (SIDE, lambda t, m: m.series(t, right_fx=lambda f: np.nan * f)),
    "top wall moves up": (PLACES, lambda t, m: m.series(t, top_d=lambda d: -d)),
    "top wall one sample late": (PLACES, lambda t, m: m.series(t, top_d=lambda d: np.r_[d[0], d[:-1]])),
    "top wall a part in 10^6 too fast": (PLACES, lambda t, m: m.series(t, top_d=lambda d: (1 + 1e-6) * d)),
    "top wall no number": (PLACES, lambda t, m: m.series(t, top_d=lambda d: np.nan * d)),
    "side wall moves in": (PLACES, lambda t, m: m.series(t, right_d=lambda d: -d)),
    "side wall is the left one": (PLACES, lambda t, m: m.series(t, right_d=t.series["left_d"])),
    "frames one late": (PLACES, lambda t, m: m.shift(t, "particles", "contacts", "walls", "box")),
    "stresses at the walls a hundredth": (
        INERTIA, lambda t, m: m.series(t, top_fy=lambda f: f / 100, right_fx=lambda f: f / 100),
    ),
    "walls that pull": (INERTIA, lambda t, m: m.series(t, top_fy=lambda f: -3 * f)),
    "a jump of the top wall": (
        INERTIA, lambda t, m: m.series(t, top_d=lambda d: np.where(np.arange(len(d)) > 30, d + 1e-3, d)),
    ),
    "contact forces doubled": (STRESS, lambda t, m: m.column(t, "contacts", "fy", lambda f: 2 * f)),
    "contact forces of the other sign": (STRESS, lambda t, m: m.column(t, "contacts", "fy", lambda f: -f)),
    "contacts one frame late": (STRESS, lambda t, m: m.shift(t, "contacts")),
    "contact forces no numbers": (STRESS, lambda t, m: m.column(t, "contacts", "fy", lambda f: np.nan * f)),
    "wall forces of the other axis": (STRESS, lambda t, m: m.column(t, "walls", "fy", lambda f: f[::-1])),
}


@pytest.mark.parametrize("name", MUTANTS)
def test_wrong_runs_are_caught_by_a_named_check(box, judge, mutate, name):
    quantity, wrong = MUTANTS[name]
    true = box.trajectory()
    checks, _ = judge(lammps=wrong(true, mutate), kernel_lammps=true)
    (check,) = [c for c in checks if c.quantity == quantity and c.left == "lammps"]
    assert check.verdict == "differs"
    assert "; rerun: grainproof compare box.toml --engines lammps" in check.why
    assert failed(checks)
    others = [c for c in checks if c.left == "kernel:lammps"]
    assert {c.verdict for c in others} == {"agrees"}


def test_a_missing_run_is_said_and_the_rest_is_judged(box, judge):
    true = box.trajectory()
    checks, _ = judge(["lammps", "liggghts", "kernel:lammps"], lammps=true, kernel_lammps=true)
    (codes,) = [c for c in checks if c.right == "liggghts"]
    assert (codes.verdict, codes.why) == ("not_checked", "no completed run of liggghts")
    assert not failed(checks)


def test_without_any_run_nothing_is_compared(judge):
    checks, result = judge(["lammps", "liggghts"])
    assert {c.verdict for c in checks if c.level != "run"} == {"not_checked"}
    assert failed(checks)
    assert result.curves == result.growth == result.states == result.phases == result.macro == {}


def test_one_engine_alone_is_not_compared(box, judge):
    checks, _ = judge(["lammps"], lammps=box.trajectory())
    assert failed(checks)
    assert {c.verdict for c in checks if c.level == "run"} == {"agrees"}


def test_every_packing_is_judged(box, judge, mutate):
    true = box.trajectory()
    wrong = mutate.series(true, top_fy=lambda f: 2 * f, right_fx=lambda f: 1.5 * f, top_d=lambda d: -d)
    checks, result = judge(lammps=[true, wrong, true], kernel_lammps=[true, true])
    found = {c.quantity: c.verdict for c in checks if c.left == "lammps"}
    assert found[WINDOW] == found[SIDE] == found[PLACES] == "differs"
    assert sorted(result.macro) == [("kernel:lammps", 0), ("kernel:lammps", 1), *(("lammps", k) for k in range(3))]


def test_a_published_value_is_judged_over_packings(box, judge):
    """Plateau stresses 249.75, 250 and 250.25 N/m: their spread does not reach 183 N/m."""
    asks = box.changed(("plateau = [0.05, 0.1]", 'plateau = [0.05, 0.1]\npublished = ["talk_frictionless_100"]'))
    runs = [box.trajectory(lambda eps, a=a: (1 + 20 * eps) * a) for a in (0.999, 1.0, 1.001)]
    checks, result = judge(["lammps"], of=asks, lammps=runs)
    assert [m["plateau sigma_zz"] for m in result.macro.values()] == pytest.approx([249.75, 250.0, 250.25])
    (published,) = [c for c in checks if c.level == "L3"]
    assert published.verdict == "differs"
    assert published.deviation == pytest.approx(67 / 183)


def test_too_fast_a_drive_is_said(box, judge):
    fast = box.changed(("duration = 0.08", "duration = 0.008"))
    checks, _ = judge(of=fast, lammps=fast.trajectory(), kernel_lammps=fast.trajectory())
    of_both = [c for c in checks if c.quantity == INERTIA]
    assert [c.verdict for c in of_both] == ["differs"] * 2
    assert of_both[0].why.endswith("; rerun: grainproof compare box.toml --engines lammps --out out")


def test_the_inertial_number_is_measured(box):
    """I = eps' sqrt(m/p) with p = 50 (2 + 20 eps) N/m of this box; the fastest is a little after half time."""
    found = inertial_numbers(box.trajectory(), box.system)
    eps = box.strain(np.linspace(0, 0.08, 41))
    rate = 0.05 * np.pi / 0.08 * np.sin(np.pi * np.linspace(0, 1, 41)) / (1 - eps)
    mass = 4 / 3 * np.pi * 2000.0 * 1e-9
    assert found[1:-1] == pytest.approx((rate * np.sqrt(mass / (50 * (2 + 20 * eps))))[1:-1], rel=3e-3)


def test_control_counts_up_to_the_peak_only(box, judge, mutate):
    """R peaks at half time; what the side wall does later is not the check's business."""
    true = box.trajectory(lambda eps: 1 + 400 * eps * (0.1 - eps))
    late = mutate.series(true, right_fx=lambda f: np.where(np.arange(len(f)) > 20, 1.5 * f, f))
    checks, _ = judge(lammps=late, kernel_lammps=true)
    (side,) = [c for c in checks if c.quantity == SIDE and c.left == "lammps"]
    assert side.verdict == "agrees"
    assert "up to the peak at 5 % strain (top from " in side.why


def test_control_counts_over_the_whole_test_where_there_is_no_peak(box, judge, mutate):
    true = box.trajectory()
    late = mutate.series(true, right_fx=lambda f: np.where(np.arange(len(f)) == 40, 1.5 * f, f))
    checks, _ = judge(lammps=late, kernel_lammps=true)
    (side,) = [c for c in checks if c.quantity == SIDE and c.left == "lammps"]
    assert (side.verdict, side.deviation) == ("differs", pytest.approx(0.5))
    assert side.why.startswith("largest over the whole test, which has no peak; rerun")


def test_the_drive_is_judged_and_bursts_are_said_not_to_be(box, judge, mutate):
    """A disc of 8.4e-6 kg at 1 m/s beside the energy of the springs, in the last frame alone."""
    true = box.trajectory()
    last = true.frames[-1].time
    calm, burst = true, replace(true, frames=(*true.frames[:-1], mutate.column(
        true, "particles", "vx", lambda v: v + np.eye(9)[4]).frames[-1]))
    assert burst.frames[-1].time == last
    checks, result = judge(lammps=burst, kernel_lammps=calm)
    drive = {c.left: c for c in checks if c.quantity == INERTIA}
    assert {c.verdict for c in drive.values()} == {"agrees"}
    assert {c.right for c in drive.values()} == {"slow drive"}
    largest = result.states["lammps"].values["kinetic over elastic energy"][-1]
    assert drive["lammps"].why.endswith(f"not of bursts: E_kin/E_el reaches {largest:.2g} at 10 % strain")
    assert "E_kin/E_el reaches 0 at" in drive["kernel:lammps"].why

def test_places_need_not_be_sampled_at_the_frames(box):
    """Frames are at every second sample, the series has every third: they meet at every sixth."""
    true = box.trajectory()
    sparse = replace(true, series=Columns({name: v[::3] for name, v in true.series.items()}, "series"))
    assert place_error(true, box.system) < 1e-14
    assert place_error(sparse, box.system) < 1e-14
    moved = replace(sparse, series=Columns(dict(sparse.series) | {"right_d": -sparse.series["right_d"]}, "series"))
    assert place_error(moved, box.system) > 0.5
