"""Springs at contacts that turn: at fixed normals the closed forms, at turning ones what geometry says."""

import numpy as np
import pytest

from reference.analytic.prescribed import Slider
from reference.analytic.turning import TurningSlider

ROWS, DT, K, GAMMA = 240, 1e-6, 3e4, 0.1
TURN = 4e-3
X, Y, Z = np.eye(3)


def course(seed: int = 3):
    """Overlap (one gap), slip rates in legs, a limit that varies: (S,) each."""
    rng = np.random.default_rng(seed)
    overlap = np.where((np.arange(ROWS) > 130) & (np.arange(ROWS) < 136), -1.0, 1.0)
    rate = np.repeat(rng.choice([-1.0, -0.6, 0.4, 1.1], ROWS // 20), 20)
    limit = 0.3 + 0.1 * np.sin(np.arange(ROWS) / 17.0)
    return overlap, rate, limit


def along_y(slider: TurningSlider, overlap, rate, limit, carried=None) -> np.ndarray:
    """Drive along y at a contact with the normal x; return the force along y."""
    normal = np.broadcast_to(X, (ROWS, 1, 3))
    found = slider.force(overlap > 0.0, normal, rate[:, None, None] * Y, limit, limit if carried is None else carried)
    assert not found[..., [0, 2]].any()
    return found[:, 0, 1]


def slider(**changes) -> TurningSlider:
    return TurningSlider(**{"stiffness": K, "damping": GAMMA, "dt": DT, "cut": "total", "keep": "length"} | changes)


@pytest.mark.parametrize("keep", ["length", "projection", "space"])
@pytest.mark.parametrize("cut", ["total", "spring"])
def test_at_a_fixed_normal_it_is_the_closed_form(cut, keep):
    overlap, rate, limit = course()
    closed = Slider(stiffness=K, damping=GAMMA, dt=DT, cut=cut).force(overlap, rate, limit)
    assert along_y(slider(cut=cut, keep=keep), overlap, rate, limit) == pytest.approx(closed, rel=1e-12, abs=1e-12)
    assert (np.abs(closed) > 1.01 * limit).any() == (cut == "spring")


def test_a_stiffness_of_its_own_in_each_row():
    overlap, rate, limit = course()
    k, gamma = K * np.linspace(1.0, 1.5, ROWS), GAMMA * np.linspace(1.0, 1.2, ROWS)
    closed = Slider(stiffness=k, damping=gamma, dt=DT, cut="spring").force(overlap, rate, limit)
    found = along_y(slider(stiffness=k, damping=gamma, cut="spring"), overlap, rate, limit)
    assert found == pytest.approx(closed, rel=1e-12, abs=1e-12)


def test_a_spring_that_lags_is_the_closed_form_where_there_is_one():
    overlap, rate, limit = course()
    closed = Slider(stiffness=K, damping=GAMMA, dt=DT, cut="total").lagging_force(overlap, rate, limit)
    found, known = along_y(slider(lags=True), overlap, rate, limit), ~np.isnan(closed)
    assert 20 < known.sum() < ROWS
    assert found[known] == pytest.approx(closed[known], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("remembers", [True, False])
def test_two_coefficients(remembers):
    overlap, rate, _ = course()
    rate = np.repeat([1.0, -0.6, 1.1, -1.0, 0.4, -0.7], ROWS // 6)  # of the closed form: turns round with every leg
    limit, carried = np.full(ROWS, 0.3473), np.full(ROWS, 0.2519)  # which no row of the legs meets exactly
    straight = Slider(stiffness=K, damping=0.0, dt=DT, cut="total")
    closed = straight.dynamic_force(overlap, rate, limit, carried, remembers=remembers)
    found = along_y(
        slider(damping=0.0, cut="total" if remembers else "spring", remembers=remembers), overlap, rate, limit, carried
    )
    known = ~np.isnan(closed)
    assert known.sum() > 200
    assert found[known] == pytest.approx(closed[known], rel=1e-11, abs=1e-12)


def turned_about(axis, stretched) -> tuple[np.ndarray, np.ndarray]:
    """Stretch a spring in one row along y, then turn the normal x about an axis without slip.

    Returns the force and the contact's own axis y, (S, 3) each.
    """
    angle = TURN * np.arange(ROWS)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turns = [np.eye(3) + np.sin(a) * cross + (1 - np.cos(a)) * cross @ cross for a in angle]
    rate = np.zeros((ROWS, 1, 3))
    rate[0, 0] = Y
    limit = np.full(ROWS, 1.0)
    force = stretched.force(np.full(ROWS, True), np.array([t @ X for t in turns])[:, None], rate, limit, limit)
    return force[:, 0], np.array([t @ Y for t in turns])


START = K * DT
"""Force of the spring that one row has stretched."""


def test_in_the_plane_of_the_turn_the_length_is_kept_exactly():
    force, own = turned_about(Z, slider(damping=0.0))
    assert force == pytest.approx(-START * own, abs=1e-12 * START)


def test_projection_loses_the_cosine_of_every_row():
    force, own = turned_about(Z, slider(damping=0.0, keep="projection"))
    lengths = START * np.cos(TURN) ** np.arange(ROWS)
    assert force == pytest.approx(-lengths[:, None] * own, abs=1e-12 * START)
    assert lengths[-1] == pytest.approx(START * (1 - ROWS * TURN**2 / 2), rel=1e-5)


@pytest.mark.parametrize("keep", ["length", "projection"])
def test_a_spring_along_the_axis_of_the_turn_does_not_change(keep):
    force, _ = turned_about(Y, slider(damping=0.0, keep=keep))
    assert force == pytest.approx(np.tile(-START * Y, (ROWS, 1)), abs=1e-13 * START)


@pytest.mark.parametrize("keep", ["length", "projection"])
def test_a_turn_about_the_normal_is_not_followed(keep):
    force, own = turned_about(X, slider(damping=0.0, keep=keep))
    assert force == pytest.approx(np.tile(-START * Y, (ROWS, 1)), abs=1e-13 * START)
    assert np.abs(own[-1] - Y).max() > 0.5


def test_in_space_nothing_follows():
    force, _ = turned_about(Z, slider(damping=0.0, keep="space"))
    assert force == pytest.approx(np.tile(-START * Y, (ROWS, 1)), abs=1e-13 * START)


def test_askew_to_the_turn_the_length_is_kept_and_the_direction_is_not():
    """Of second order in the angle of a row."""
    axis = np.array([0.0, 1.0, 1.0]) / np.sqrt(2)
    force, own = turned_about(axis, slider(damping=0.0))
    assert np.linalg.norm(force, axis=1) == pytest.approx(np.full(ROWS, START), rel=1e-12)
    lean = np.linalg.norm(force / START + own, axis=1)
    assert lean[1] < TURN**2
    assert ROWS * TURN**2 / 8 < lean[-1] < ROWS * TURN**2


def test_a_sliding_spring_may_resist_the_rate():
    """Where the limit shrinks faster than the spring after the slip has turned round, the two differ."""
    overlap, rate = np.ones(ROWS), np.repeat([1.0, -0.05], ROWS // 2)
    limit = np.concatenate([np.full(ROWS // 2, 0.4), np.linspace(0.4, 0.05, ROWS // 2)])
    found = along_y(slider(cut="rate", keep="space"), overlap, rate, limit)
    total = along_y(slider(keep="space"), overlap, rate, limit)
    slides = np.isclose(np.abs(found), limit, rtol=1e-12)
    assert slides[130:].any()
    assert (np.sign(found[slides]) == -np.sign(rate[slides])).all()
    assert (found[130:] * total[130:] < 0.0).any()


def test_a_limit_that_is_not_known_leaves_the_contact_unknown_until_it_opens():
    overlap, rate, limit = course()
    limit[50] = np.nan
    for cut in ("total", "spring", "rate"):
        found = along_y_any(slider(cut=cut), overlap, rate, limit)
        assert np.isnan(found[50:131]).all()
        assert np.isfinite(found[:50]).all()
        assert np.isfinite(found[131:]).all()


def along_y_any(slider, overlap, rate, limit):
    normal = np.broadcast_to(X, (ROWS, 1, 3))
    return slider.force(overlap > 0.0, normal, rate[:, None, None] * Y, limit, limit)[:, 0, 1]
