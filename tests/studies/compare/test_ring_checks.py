"""Balances of a ring: exact ones agree, each wrong term is found, noise shows nothing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.studies.compare.profiles import steady_frames, subject_of
from harness.studies.compare.ring_balances import ring_balances
from harness.studies.compare.ring_checks import ring_checks
from harness.studies.compare.ring_curves import ring_curves
from harness.studies.verdict import Rerun

RERUN = Rerun(scene_file=Path("ring.toml"), out=Path("out"), packings=None)
TORQUE, THROUGH, STEADY = "torque on inner", "2 pi r^2", "steady: "


@pytest.fixture
def balanced(ring):
    def make(trajectory=None, of=ring, system=None):
        t = trajectory or of.trajectory()
        system = system or of.system
        subjects = [subject_of(f, of.scene, system) for f in steady_frames(t, of.scene)]
        return ring_balances(ring_curves(t), subjects, system)

    return make


def judged(balances, quantity):
    return next(c for c in ring_checks({"a": {0: balances}}, RERUN) if c.quantity.startswith(quantity))


def test_torque_with_drag_is_balanced_and_passes_every_circle(balanced):
    b = balanced()
    assert abs(b.drag.mean[0]) > 0.005 * abs(b.inner.mean[0])
    assert b.circles.sum() == 6  # in the first and the last cell's middle there is no disc on one side
    assert np.nanmax(np.abs(b.from_inner.mean)) < 1e-4 * abs(b.inner.mean[0])
    assert {judged(b, q).verdict for q in (TORQUE, THROUGH, STEADY)} == {"agrees"}


def test_a_drag_that_is_left_out_is_found(balanced, ring):
    b = balanced(system=ring.system.with_(background=None))
    assert judged(b, TORQUE).verdict == "differs"
    assert judged(b, THROUGH).verdict == "differs"


@pytest.mark.parametrize("ring_name", ["inner", "outer"])
def test_a_torque_that_is_wrong_by_a_twentieth_is_found(balanced, ring, mutate, ring_name):
    wrong = mutate.series(ring.trajectory(), **{f"{ring_name}_torque": lambda t: 1.05 * t})
    check = judged(balanced(wrong), TORQUE)
    assert check.verdict == "differs"
    assert check.deviation == pytest.approx(0.05, rel=0.2)


@pytest.mark.parametrize("change", [lambda f: 1.1 * f, lambda f: -f], ids=["too large", "sign"])
def test_contact_forces_that_are_wrong_are_found(balanced, ring, mutate, change):
    wrong = ring.trajectory()
    for column in ("fx", "fy"):
        wrong = mutate.column(wrong, "contacts", column, change)
    assert judged(balanced(wrong), THROUGH).verdict == "differs"


def test_a_torque_that_drifts_is_not_steady(balanced, ring, mutate):
    def drifts(t):
        return t * np.where(np.arange(len(t)) < len(t) // 2, 1.5, 0.5)

    both = mutate.series(ring.trajectory(), inner_torque=drifts, outer_torque=drifts)
    assert judged(balanced(both), STEADY).verdict == "differs"


def test_error_bars_larger_than_a_tenth_of_the_torque_show_no_balance(balanced, ring, mutate):
    rng = np.random.default_rng(1)
    wild = mutate.series(ring.trajectory(), outer_torque=lambda t: t + 3e-3 * rng.normal(size=len(t)))
    check = judged(balanced(wild), TORQUE)
    assert check.verdict == "inconclusive"
    assert check.tolerance > 0.1


def test_momentum_that_is_left_over_is_found(balanced, ring):
    """In the chains torque is balanced and momentum is not: push and pull of a layer differ by what r does."""
    checks = {c.quantity: c.verdict for c in ring_checks({"a": {0: balanced()}}, RERUN)}
    assert checks["equilibrium of every ring, phi"] == "differs"


def test_without_contacts_nothing_is_checked_of_them(balanced, ring):
    b = balanced(ring.trajectory(contacts=False))
    assert judged(b, THROUGH).verdict == "not_checked"
    assert "not recorded" in judged(b, THROUGH).why
    assert judged(b, TORQUE).verdict == "agrees"


def test_the_worst_packing_counts(balanced, ring, mutate):
    wrong = balanced(mutate.series(ring.trajectory(), outer_torque=lambda t: 1.05 * t))
    checks = ring_checks({"a": {0: balanced(), 1: wrong}}, RERUN)
    assert next(c for c in checks if c.quantity.startswith(TORQUE)).verdict == "differs"


def test_a_run_that_is_too_short_is_inconclusive_when_it_is_off(balanced):
    b = balanced()
    short = replace(b.total, short=np.array([True]), mean=np.array([1e-2]))
    assert judged(replace(b, total=short), TORQUE).verdict == "inconclusive"
    within = replace(b.total, short=np.array([True]))
    assert judged(replace(b, total=within), TORQUE).verdict == "agrees"
