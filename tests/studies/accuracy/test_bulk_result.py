"""Errors, floors, cheapest settings and the front of ladders that are known."""

from dataclasses import replace

import numpy as np
import pytest

from harness.studies.accuracy.asked import BOX, LAW
from harness.studies.accuracy.bulk_result import Ladder, Rung, cheapest, floor_of, front, scale_of
from harness.studies.accuracy.limit import find_limit, find_order

PACKINGS = 8
QUANTITY = "friction_angle"
SPREAD = np.linspace(-1.0, 1.0, PACKINGS)
"""Of the packings, alike on all rungs."""


def rung(value, numbers, *, seconds=1.0, own=False, status="completed"):
    values = {} if status != "completed" else {QUANTITY: np.asarray(numbers, float)[:, None]}
    return Rung(
        knob="rate", value=value, x=value, label=f"{value:g}", own=own, status=status, reason="" if values else "lost",
        particles=9, dt=1e-6, steps=100, values=values, seconds=seconds if values else None, each=(seconds,) * PACKINGS,
    )


def ladder(numbers, *, knob="rate", engine="lammps", own=1.0, seconds=None):
    """From {value: (K,)}; time goes as 1/value."""
    rungs = tuple(
        rung(v, n, own=v == own, seconds=(8.0 / v if seconds is None else seconds)) for v, n in numbers.items()
    )
    x, values = [r.x for r in rungs], np.array([r.values[QUANTITY] for r in rungs])
    limit = find_limit(x, values, 1.0)
    return Ladder(
        knob=BOX[knob], engine=engine, rungs=rungs, limits={QUANTITY: limit},
        orders={QUANTITY: find_order(x, values)}, scales={QUANTITY: scale_of(limit, None, None)},
    )


def rates(slope=0.4, noise=0.0, seed=0):
    rng = np.random.default_rng(seed)
    return {v: 20.0 + SPREAD + slope * v + noise * rng.standard_normal(PACKINGS) for v in (8.0, 4.0, 2.0, 1.0)}


def test_errors_are_distances_from_the_limit_over_its_size():
    made = ladder(rates())
    found = {r.value: e for r, e in made.known(QUANTITY)}
    assert [found[v].size for v in (8.0, 4.0, 2.0, 1.0)] == pytest.approx([0.16, 0.08, 0.04, 0.02])
    assert all(e.seen and e.signed > 0 and e.packings == PACKINGS for e in found.values())
    assert all(e.bar < 1e-12 for e in found.values()), "what packings share is in no error bar"


def test_error_bars_hold_the_noise_of_both_sides():
    found = [ladder(rates(noise=0.2, seed=s)).known(QUANTITY)[0][1] for s in range(100)]
    off = np.array([abs(e.size - 0.16) / e.bar for e in found])
    assert 0.5 < (off < 1.0).mean() < 0.9


def test_the_floor_is_the_scatter_over_packings():
    made = ladder(rates())
    floor = floor_of(made.own, QUANTITY, 20.0, "deg")
    assert floor.spread == pytest.approx(SPREAD.std(ddof=1) / 20.0)
    assert floor.mean == pytest.approx(floor.spread / np.sqrt(PACKINGS))
    assert floor.value == pytest.approx(20.4)
    assert floor.needed(floor.spread / 10.0) == 100
    assert floor_of(rung(1.0, [1.0] + [np.nan] * 7), QUANTITY, 20.0, "deg") is None
    assert floor_of(None, QUANTITY, 20.0, "deg") is None


def test_the_cheapest_setting_and_why_there_is_none():
    made = ladder(rates())
    assert cheapest(made, QUANTITY, 0.1, None).rung.value == 4.0
    assert cheapest(made, QUANTITY, 0.03, None).rung.value == 1.0
    assert cheapest(made, QUANTITY, 0.01, None).why == "the finest rungs are off by 2 %"
    noisy = ladder(rates(slope=0.0, noise=0.5))
    floor = floor_of(noisy.own, QUANTITY, 20.0, "deg")
    offer = cheapest(noisy, QUANTITY, 0.001, floor)
    assert offer.rung is None
    assert offer.why.startswith("not to be told")
    assert "the floor is" in offer.why


def test_one_rung_that_is_near_by_luck_is_not_enough():
    """Off, near, off: from the finest rung on all have to be near."""
    numbers = rates(slope=0.0) | {2.0: 20.0 + SPREAD + 4.0}
    made = ladder(numbers)
    near = [r.value for r, e in made.known(QUANTITY) if e.most <= 0.05]
    offer = cheapest(made, QUANTITY, 0.05, None)
    assert offer.rung is None or all(v in near for v in (2.0, 1.0) if v <= offer.rung.value)


def test_failed_rungs_have_no_error_and_no_time():
    made = ladder(rates())
    lost = rung(16.0, [], status="unstable")
    whole = Ladder(knob=made.knob, engine="lammps", rungs=(lost, *made.rungs), limits=made.limits, orders=made.orders,
                   scales=made.scales)
    assert whole.error(lost, QUANTITY) is None
    assert lost.seconds is None
    assert lost not in [r for r, _ in whole.known(QUANTITY)]
    assert lost not in [r for _, r, _ in front([whole], QUANTITY)]


def test_a_rung_that_scenes_refuse_is_neither_cheapest_nor_on_the_front():
    """It stays known, and in the limit."""
    made = ladder(rates(slope=0.0, noise=0.1))
    fast, *rest = made.rungs
    assert cheapest(made, QUANTITY, 0.1, None).rung is fast
    assert front([made], QUANTITY)[0][1] is fast
    barred = replace(made, rungs=(replace(fast, beyond=4.5), *rest))
    assert cheapest(barred, QUANTITY, 0.1, None).rung is rest[0]
    assert front([barred], QUANTITY)[0][1] is rest[0]
    assert [r.value for r, _ in barred.known(QUANTITY)] == [8.0, 4.0, 2.0, 1.0]


def test_knobs_add_against_the_limit_of_all():
    """Of the declared setting one knob leaves 2 %, the other 5 %: together 7 %, whichever ladder it is read from."""
    rate = ladder(rates(0.4))
    other = ladder(rates(1.0), knob="stiffness")
    scale = 20.0
    a = rate.whole_error(rate.own, QUANTITY, [other])
    assert a.size == pytest.approx((0.4 + 1.0) / scale)
    b = other.whole_error(other.own, QUANTITY, [rate])
    assert b.size * other.scales[QUANTITY] == pytest.approx(a.size * rate.scales[QUANTITY])
    assert rate.whole_error(rate.rungs[0], QUANTITY, [other]).size == pytest.approx((3.2 + 1.0) / scale)


def test_the_front_is_of_whole_settings():
    rate, soft = ladder(rates(0.4)), ladder(rates(1.0), knob="stiffness")
    slow = ladder(rates(0.4), engine="liggghts", seconds=100.0)
    kept = front([rate, soft, slow], QUANTITY)
    times, sizes = [r.seconds for _, r, _ in kept], [e.most for _, _, e in kept]
    assert times == sorted(times)
    assert sizes == sorted(sizes, reverse=True)
    assert {la.engine for la, _, _ in kept[:-1]} == {"lammps"}
    assert all(la is rate for la, r, _ in kept if r.value > 1.0), "the softer contact is as fast and worse"


def test_a_ladder_of_words_is_told_against_the_declared_law():
    rungs = (rung(0.0, 20.0 + SPREAD, own=True), rung(1.0, 18.0 + SPREAD))
    made = Ladder(knob=LAW, engine="lammps", rungs=rungs, limits={}, orders={}, scales={QUANTITY: 20.0})
    assert made.error(rungs[0], QUANTITY).size == 0.0
    error = made.error(rungs[1], QUANTITY)
    assert (error.signed, error.bar) == (pytest.approx(-0.1), pytest.approx(0.0, abs=1e-12))


def test_packings_without_the_quantity_are_left_out():
    numbers = rates()
    numbers[8.0] = numbers[8.0].copy()
    numbers[8.0][2:] = np.nan
    made = ladder(numbers)
    assert made.known(QUANTITY)[0][1].packings == 2
    assert made.known(QUANTITY)[0][1].size == pytest.approx(0.16)
