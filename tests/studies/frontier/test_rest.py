"""What is no state at rest is found: forces out of balance, packings that buckle; discs are brought to rest."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.studies.frontier import laws, packings, rest
from harness.studies.frontier.late import LATE_STEPS, VISIBLE, Followed
from harness.studies.frontier.packings import Packed, resting_system
from harness.studies.frontier.probe import FRAMES, STEPS
from harness.studies.frontier.rest import BALANCED, at_rest, residual, unrest
from harness.studies.frontier.theory import linear_packing, theory_of, touching


def lattice(packing, law):
    return resting_system(packing, packing.make(None), law)


def moved(system, way):
    return system.with_(particles=replace(system.particles, x=system.particles.x + way))


@pytest.fixture(scope="module")
def discs(tmp_path_factory):
    """discs(law): thirty discs at random, at rest for linear springs."""
    packed = packings.random_discs(tmp_path_factory.mktemp("packings"), count=30)
    return lambda law: resting_system(packings.RANDOM, packed, law)


@pytest.mark.parametrize("law", [laws.ELASTIC, laws.DASHPOT, laws.VISCOUS])
def test_a_square_lattice_without_tangential_springs_buckles(law):
    """Rows that shift in turn lose f_n/r each time: the smallest eigenvalue is -4 f_n/(r m), the largest 4 k/m."""
    system = lattice(packings.SQUARE, law)
    overlap = laws.OVERLAP * laws.RADIUS
    ratio = -overlap / (2 * laws.RADIUS - overlap)
    smallest, largest = rest._ends(system)
    assert smallest / largest == pytest.approx(ratio, rel=1e-3)
    assert f"buckles under its own pressure, the smallest eigenvalue of M^-1 K is {smallest / largest:.2g}" in unrest(
        system
    )


@pytest.mark.parametrize(("packing", "law"), [
    (packings.SQUARE, laws.FRICTION), (packings.SQUARE, laws.MINDLIN), (packings.TRIANGULAR, laws.ELASTIC),
    (packings.TRIANGULAR, laws.VISCOUS), (packings.FCC, laws.HERTZ),
])
def test_free_motions_are_no_buckling(packing, law):
    """All of a lattice may move as one, and spins without springs turn freely: eigenvalues 0 up to rounding."""
    system = lattice(packing, law)
    assert residual(system) < 1e-10
    assert unrest(system) == ""


def test_a_particle_out_of_its_place_is_told_with_its_force():
    """Six neighbours hold it by 3 k (less what their pressure takes): the force of a shift by 1e-3 overlaps."""
    system = lattice(packings.TRIANGULAR, laws.FRICTION)
    way = np.zeros_like(system.particles.x)
    way[7, 0] = 1e-3 * laws.OVERLAP * laws.RADIUS
    assert residual(moved(system, way)) == pytest.approx(3e-3, rel=2e-3)
    assert "a particle feels a net force of 0.003 of the mean contact force" in unrest(moved(system, way))


def test_nothing_in_contact_is_no_packing():
    system = lattice(packings.TRIANGULAR, laws.ELASTIC)
    gas = system.with_(particles=replace(system.particles, radius=0.9 * system.particles.radius))
    assert at_rest(gas) is gas
    assert "net force of inf" in unrest(gas)


def test_discs_at_rest_for_one_law_are_not_for_another(discs):
    assert residual(discs(laws.ELASTIC)) < BALANCED
    assert at_rest(discs(laws.FRICTION)).particles.x is discs(laws.FRICTION).particles.x
    for law in (laws.HERTZ, laws.MINDLIN):
        assert residual(discs(law)) > 0.1
        assert "not at rest under this law: a particle feels" in unrest(discs(law))


def test_discs_are_brought_to_rest_under_hertz(discs):
    """By ways of some overlaps, a small part of a radius: it stays the packing that it was."""
    before = discs(laws.HERTZ)
    after = at_rest(before)
    assert residual(after) <= BALANCED
    assert unrest(after) == ""
    way = np.linalg.norm(after.particles.x - before.particles.x, axis=1)
    assert 0 < way.max() < 10 * laws.OVERLAP * laws.RADIUS
    assert after.particles.radius is before.particles.radius


def test_what_cannot_be_balanced_is_told(discs, monkeypatch):
    monkeypatch.setattr(rest, "ROUNDS", 2)
    assert "a net force of" in unrest(at_rest(discs(laws.HERTZ)))


def test_the_force_of_a_wall_counts():
    """One disc between four walls, off its centre."""
    box = (2 * laws.RADIUS - 2 * laws.OVERLAP * laws.RADIUS,) * 2
    middle = np.full((1, 2), box[0] / 2)
    one = resting_system(packings.RANDOM, Packed(x=middle, radius=np.array([laws.RADIUS]), box=box, walls=True),
                         laws.ELASTIC)
    assert len(touching(one)[1]) == 4
    assert residual(one) < 1e-12
    shifted = moved(one, [[0.1 * laws.OVERLAP * laws.RADIUS, 0.0]])
    assert residual(shifted) == pytest.approx(0.2, rel=1e-6)
    assert residual(at_rest(shifted)) < BALANCED


# --- springs felt late: how long motions are followed -------------------------------------------------


@pytest.fixture(scope="module")
def followed():
    """Weak dashpots on a dozen particles: motions grow by parts of a thousand in a step."""
    packed = packings.lattice(np.array([[0.0, 0.0], [0.5, math.sqrt(0.75)]]), np.array([1.0, math.sqrt(3.0)]), (3, 2))
    system = resting_system(packings.TRIANGULAR, packed, laws.WEAK)
    assert unrest(system) == ""
    theory = theory_of(system, "kernel:talk")
    return Followed(packing=linear_packing(system, late=True), limit=theory.exact, lowest=0.1 * theory.guess)


def test_a_look_lasts_until_growth_is_seen(followed):
    for beyond in (1.01, 1.05):
        dt = beyond * followed.limit
        steps = followed.steps(dt)
        assert steps % FRAMES == 0
        assert STEPS <= steps < LATE_STEPS
        assert 2 * steps * math.log(followed.packing.growth(dt)) == pytest.approx(math.log(VISIBLE), rel=0.1)
    near = followed.steps(followed.limit)
    assert followed.steps(0.9 * followed.limit) == near > followed.steps(1.01 * followed.limit)
    assert followed.steps(3 * followed.limit) == STEPS
    assert followed.unseen() == ""


def test_growth_that_nobody_sees_is_left_out_with_the_number(followed, monkeypatch):
    monkeypatch.setattr("harness.studies.frontier.late.LATE_STEPS", 1200)
    steps = 1 / math.log(followed.packing.growth(1.02 * followed.limit))
    said = f"2 per cent beyond the limit of theory motions grow by e in {steps:.3g} steps, which 1200 steps do not show"
    assert followed.unseen() == said
    never = replace(followed, limit=0.5 * followed.limit)
    assert "motions grow by nothing" in never.unseen()
