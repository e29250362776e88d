"""Local numbers of the rotation study on displacements and rotations that are known in closed form."""

import numpy as np
import pytest

from harness.studies.reproduce import rotations
from postproc.snapshot import Columns, Snapshot

SIDE = 24
BAND = (8.0, 16.0)


def state(u=0.0, theta=0.0, couples: float = 0.0) -> Snapshot:
    """Discs on a square lattice, moved by u (N, 2) and turned by theta; couples: tangential force of every contact."""
    i, j = (a.ravel().astype(float) for a in np.meshgrid(np.arange(SIDE), np.arange(SIDE), indexing="ij"))
    x = np.stack([i + 0.5, j + 0.5], axis=1)
    ids = np.arange(1.0, SIDE * SIDE + 1)
    number = ids.reshape(SIDE, SIDE)
    a, b = number[:-1].ravel(), number[1:].ravel()
    middle = 0.5 * (x[a.astype(int) - 1] + x[b.astype(int) - 1])
    moved = x + u
    return Snapshot(
        time=0.0, dimension=2, box=np.array([[0.0, SIDE], [0.0, SIDE]]),
        particles=Columns({
            "id": ids, "x": moved[:, 0], "y": moved[:, 1], "radius": np.full(len(ids), 0.5),
            "rotation": np.zeros(len(ids)) + theta,
        }, "particles"),
        contacts=Columns({
            "i": a, "j": b, "px": middle[:, 0], "py": middle[:, 1], "fx": np.full(len(a), -1.0),
            "fy": np.full(len(a), couples), "overlap": np.full(len(a), 1e-3),
        }, "contacts"),
    )


def sheared(rate: float) -> tuple[np.ndarray, np.ndarray]:
    """u_x grows by `rate` per length within a band of y; W = -rate/2 there and 0 outside."""
    y = np.tile(np.arange(SIDE) + 0.5, SIDE)
    u = np.zeros((SIDE * SIDE, 2))
    u[:, 0] = rate * np.clip(y - BAND[0], 0.0, BAND[1] - BAND[0])
    return u, np.where((y > BAND[0]) & (y < BAND[1]), -0.5 * rate, 0.0)


def test_discs_that_turn_with_the_continuum():
    u, W = sheared(0.01)
    found = rotations.local_numbers(state(u, W), state())
    assert found[rotations.FOLLOWS] == pytest.approx(1.0, abs=0.1)
    assert found[rotations.TURN] == pytest.approx(np.degrees(0.005) * np.sqrt(1 / 3), rel=1e-6)
    assert found[rotations.IN_BAND] > 3.0
    assert found[rotations.HALF] < 0.3


@pytest.mark.parametrize("wrong", [0.0, -1.0, 2.0])
def test_discs_that_do_not(wrong):
    u, W = sheared(0.01)
    found = rotations.local_numbers(state(u, wrong * W), state())
    assert abs(found[rotations.FOLLOWS] - 1.0) > 0.5


def test_antisymmetric_stress_of_couples():
    """Every contact along x carries f_y = t on i: sigma_xy = -(1/V) sum l_x f_y, sigma_yx = 0, sigma_A is half of it.

    Both ends of a contact count: per area, one contact a disc, 2 (1/2) t; over p = (sigma_xx + sigma_yy)/2 = 1/2.
    """
    t = 1e-3
    found = rotations.local_numbers(state(*sheared(0.01), couples=t), state())
    assert found[rotations.WHOLE] == pytest.approx(t, rel=0.06)  # contacts with the border are missing
    assert found[rotations.CUT] == pytest.approx(t, rel=0.15)
    none = rotations.local_numbers(state(*sheared(0.01)), state())
    assert none[rotations.WHOLE] == pytest.approx(0.0, abs=1e-12)


def test_the_band_is_the_fewest_cells():
    assert rotations.band_cells(np.array([1.0, 5.0, 1.0, 3.0])).tolist() == [False, True, False, False]
    assert rotations.band_cells(np.ones(4)).sum() == 2


def test_strains_are_the_talks():
    assert rotations.STRAINS == (0.0, 0.011, 0.042, 0.091)
