"""The ring study: powers of r and their errors on flows with known answers, E over tr F, and what decides."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness.studies.compare.profiles import Profile, RingProfiles
from harness.studies.compare.ring_numbers import Number
from harness.studies.reproduce.protocol import Ask
from harness.studies.reproduce.ring import STUDY, cases
from harness.studies.reproduce.ring.cases import FASTER, PLANS, SPRINGS, faster_than, main_plans
from harness.studies.reproduce.ring.measure import STATIC, _decay, _exponents
from harness.studies.reproduce.ring.numbers import _undecided, collapse, over, rows_of
from harness.studies.verdict import Check
from postproc.results import Unavailable
from reference.values import published_values

EDGES = np.linspace(0.08, 0.155, 21)
R = (EDGES[1:] + EDGES[:-1]) / 2
INSIDE = (EDGES[:-1] > 0.088) & (EDGES[1:] < 0.147)


def ask(size="quick"):
    return Ask(size=size, engines=(), out=Path("nowhere"))


def profile(mean, error):
    return Profile(unit="N/m", mean=mean, error=error, samples=np.full(20, 50.0), frames=np.full(20, 200),
                   short=np.zeros(20, dtype=bool), needed=0.0)


def profiles(**found):
    return RingProfiles(edges=EDGES, glued=np.zeros(20), frames=200, spacing=0.3, profiles=found)


def flow(rng, shear=-2.0, normal=0.0, frames=200):
    """Stress (F, 20, 2, 2) whose size jumps from frame to frame as a whole, with a little noise in each cell."""
    size = np.exp(0.5 * rng.normal(size=frames))[:, None]
    noise = 1 + 0.05 * rng.normal(size=(2, frames, 20))
    stress = np.empty((frames, 20, 2, 2))
    stress[..., 0, 0] = stress[..., 1, 1] = 0.05 * size * (R / R[0]) ** normal * noise[0]
    stress[..., 0, 1] = stress[..., 1, 0] = 0.01 * size * (R / R[0]) ** shear * noise[1]
    return stress


def exponents(stress):
    error = stress.std(axis=0, ddof=1) / np.sqrt(len(stress))
    found = {name: profile(stress.mean(axis=0)[:, a, b], error[:, a, b]) for name, (a, b) in
             {"stress_rr": (0, 0), "stress_phiphi": (1, 1), "stress_rphi": (0, 1), "stress_phir": (1, 0)}.items()}
    subjects = [SimpleNamespace(stress=s) for s in stress]
    return _exponents(profiles(**found), subjects, INSIDE)


def test_powers_of_r_are_found():
    found = exponents(flow(np.random.default_rng(0), shear=-2.0, normal=0.0))
    assert found["power of r of sigma_rphi"].value == pytest.approx(-2.0, abs=0.03)
    assert found["power of r of r sigma_rr"].value == pytest.approx(1.0, abs=0.03)
    steeper = exponents(flow(np.random.default_rng(0), shear=-1.7))
    assert abs(steeper["power of r of sigma_rphi"].value + 2.0) > 0.2


def test_errors_of_powers_cover():
    """Flows that jump as a whole: the jackknife's 95 % intervals (Student's t) cover; cells' own are useless."""
    rng, inside, sizes = np.random.default_rng(1), [], []
    for _ in range(120):
        n = exponents(flow(rng, frames=100))["power of r of sigma_rphi"]
        inside.append(abs(n.value + 2.0) <= 2.262 * n.error)
        sizes.append(n.error)
    assert np.mean(inside) == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / 120))
    stress = flow(rng, frames=100)[..., 0, 1]
    error = stress.std(axis=0, ddof=1) / 10 / stress.mean(axis=0)
    x = np.log(R[INSIDE])
    naive = float(np.sqrt(np.mean(error[INSIDE] ** 2) / ((x - x.mean()) ** 2).sum()))
    assert naive > 5 * np.mean(sizes)


def test_decay_of_the_dynamic_stress():
    scene = SimpleNamespace(rings=SimpleNamespace(inner_radius=EDGES[0]), compare=SimpleNamespace(band=0.04))
    band = SimpleNamespace(diameter=0.0077)
    mean = 1e-4 * np.exp(-(R - EDGES[0]) / (2.5 * 0.0077))
    found = _decay(profiles(kinetic_stress_rr=profile(mean, 0.05 * mean)), "kinetic_stress_rr", scene, band)
    assert found.value == pytest.approx(2.5, rel=1e-9)
    flat = _decay(profiles(kinetic_stress_rr=profile(1 / mean, 0.05 / mean)), "kinetic_stress_rr", scene, band)
    assert isinstance(flat, Unavailable)


# --- rows ----------------------------------------------------------------------------------------


def ring(numbers=None, why="", low=1.0, high=2.0, slope=352.1 / np.pi):
    trace = np.linspace(low, high, 20)
    bulk = slope * trace
    found = profiles(fabric_trace=profile(trace, 0.01 * trace), bulk_stiffness=profile(bulk, 0.02 * bulk))
    given = {"s/d": (1.5, 0.05), "v_0": (0.6, 0.01)} | {n: (published_values()[t].value, 0.02) for n, t in zip(
        STATIC, ("talk_ring_stress_rr", "talk_ring_stress_phiphi", "talk_ring_stress_rphi", "talk_ring_stress_phir"),
        strict=True)} | (numbers or {})
    return SimpleNamespace(
        numbers={k: Number(value=v, error=e, unit="1") for k, (v, e) in given.items()}, inside=INSIDE, profiles=found,
        band=SimpleNamespace(why=why, fit=None, diameter=0.0077),
        scene=SimpleNamespace(contact=SimpleNamespace(normal=SimpleNamespace(normal_stiffness=352.1))),
    )


def runs(size="quick", **changes):
    return {p.name: {"lammps": {0: ring(low=1.0 + k, high=2.0 + k, **changes)}}
            for k, p in enumerate(main_plans(ask(size)))}


def verdicts(found):
    return {r.quantity.split(": ")[-1]: r.verdict for r in found}


def test_what_the_talk_says_is_met():
    found = verdicts(rows_of(ask(), runs()))
    assert found["shear band width s/d"] == "agrees"
    assert {found[name] for name in STATIC} == {"agrees"}
    assert found["slope of E over tr F"] == "agrees"


@pytest.mark.parametrize(("changes", "name"), [
    ({"numbers": {"s/d": (2.4, 0.05)}}, "shear band width s/d"),
    ({"numbers": {"power of r of sigma_rphi": (-1.7, 0.02)}}, "power of r of sigma_rphi"),
    ({"numbers": {"power of r of r sigma_rr": (1.3, 0.02)}}, "power of r of r sigma_rr"),
    ({"slope": 1.05 * 352.1 / np.pi}, "slope of E over tr F"),
])
def test_what_is_missed_differs(changes, name):
    assert verdicts(rows_of(ask(), runs(**changes)))[name] == "differs"


def test_an_error_bar_across_the_tolerance_decides_nothing():
    found = verdicts(rows_of(ask(), runs(numbers={"power of r of sigma_rphi": (-1.95, 0.06)})))
    assert found["power of r of sigma_rphi"] == "inconclusive"


def test_recalled_values_never_decide():
    found = rows_of(ask("paper"), runs("paper", numbers={"v_0": (0.2, 0.01)}))
    recalled = [r for r in found if r.talk is not None and not r.talk.decides]
    assert len(recalled) == 6
    assert {r.verdict for r in recalled} == {"inconclusive"}


def test_without_a_band_there_is_no_width():
    found = [r for r in rows_of(ask(), runs(why="the inner ring slips")) if "width" in r.quantity]
    assert {r.verdict for r in found} == {"not_checked"}
    assert "slips" in found[0].why


def test_collapse_tells_densities_apart():
    """Two densities on two lines: the residuals by density say so."""
    apart = runs()
    second = list(apart)[1]
    apart[second] = {"lammps": {0: ring(low=2.0, high=3.0, slope=150.0)}}
    one, two = (collapse(ask(), r, "lammps") for r in (runs(), apart))
    assert one.share == pytest.approx(1.0)
    assert two.share < 0.999
    assert isinstance(collapse(ask(), {}, "lammps"), Unavailable)


def test_errors_over_packings_and_of_one():
    one, three = ({k: ring({"s/d": (1.4 + 0.1 * k, 0.3)}) for k in range(n)} for n in (1, 3))
    assert over("lammps", one, "s/d").error == 0.3
    assert over("lammps", three, "s/d").error == pytest.approx(0.1 / np.sqrt(3))


# --- cases ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", list(PLANS))
def test_every_ring_is_a_scene(size):
    made = {c.name: c.scene for c in cases(ask(size))}
    fast, own = faster_than(ask(size))
    assert made[fast.name].rings.omega == FASTER * made[own.name].rings.omega
    assert made[fast.name].duration * FASTER == made[own.name].duration
    assert made[SPRINGS].contact.sliding is not None
    assert {STUDY.sizes[size].packings} == {c.packings for c in cases(ask(size))}


def test_shipped_rings_stay_as_they_are():
    """So that runs which a comparison has made are found again."""
    from harness.scene.load import load_scene

    first = cases(ask())[0]
    assert first.scene == load_scene(first.file)


@pytest.mark.parametrize(("verdict", "becomes"), [
    ("agrees", "inconclusive"), ("differs", "inconclusive"), ("not_checked", "not_checked")])
def test_errors_of_time_alone_decide_nothing(verdict, becomes):
    facts = {"level": "L3", "quantity": "profile", "left": "a", "right": "b", "deviation": 1.0, "tolerance": 0.5}
    check = Check(**facts, verdict=verdict, why="")
    assert _undecided(check).verdict == becomes
