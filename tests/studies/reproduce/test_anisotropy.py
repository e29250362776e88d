"""Deviators of handmade states, and the exponential approach of known limit and rate."""

import numpy as np
import pytest

from harness.scene.load import load_scene
from harness.studies.reproduce import anisotropy
from postproc.snapshot import Columns, Snapshot

SIDE = 14


def lattice(vertical: float, horizontal: float, height: float = 1.0) -> Snapshot:
    """Touching discs on a square lattice; forces (N) along its two directions, no contact where one is 0."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(SIDE), np.arange(SIDE), indexing="ij"))
    x, y = i + 0.5, height * (j + 0.5)
    ids = np.arange(1, SIDE * SIDE + 1)
    number = ids.reshape(SIDE, SIDE)
    pairs = []
    for force, first, second, axis in (
        (horizontal, number[:-1], number[1:], 0), (vertical, number[:, :-1], number[:, 1:], 1)
    ):
        if force:
            pairs += [(a, b, axis, force) for a, b in zip(first.ravel(), second.ravel(), strict=True)]
    a, b, axis, force = (np.array(v) for v in zip(*pairs, strict=True))
    middle = np.stack([(q[a - 1] + q[b - 1]) / 2 for q in (x, y)])
    return Snapshot(
        time=0.0, dimension=2, box=np.array([[0.0, SIDE], [0.0, height * SIDE]]),
        particles=Columns({"id": ids, "x": x, "y": y, "radius": np.full(len(ids), 0.5)}, "particles"),
        contacts=Columns({
            "i": a, "j": b, "px": middle[0], "py": middle[1], "fx": np.where(axis == 0, -force, 0.0),
            "fy": np.where(axis == 1, -force, 0.0), "overlap": np.full(len(a), 1e-3),
        }, "contacts"),
    )


@pytest.fixture
def scene():
    return load_scene(anisotropy.FILES["quick"])


def test_vertical_excess_is_positive(scene):
    """All contacts vertical: everything is 1; on a square lattice structure is isotropic, stress is not."""
    states = anisotropy.anisotropies([lattice(2.0, 1.0), lattice(2.0, 0.0, height=0.9)], scene)
    assert states["eps_D"] == pytest.approx([0.0, 0.1])
    assert states["s_D"] == pytest.approx([1.0 / 3.0, 1.0], abs=1e-2)  # the border of the inner part cuts contacts
    assert states["F_D"] == pytest.approx([0.0, 1.0], abs=1e-2)
    assert states["C_D"] == pytest.approx([0.0, 1.0], abs=1e-2)


def approach(limit: float, rate: float, initial: float, noise: float = 0.0) -> dict[str, np.ndarray]:
    x = 0.25 * np.linspace(0.0, 1.0, 201) ** 2
    y = limit - (limit - initial) * np.exp(-rate * x) + noise * np.random.default_rng(1).normal(size=len(x))
    return {"eps_D": x} | dict.fromkeys(anisotropy.FITTED, y)


def test_a_known_approach_comes_back():
    found = anisotropy.saturations(approach(0.34, 120.0, 0.01))
    for name in anisotropy.FITTED:
        assert found[f"{name} max"] == pytest.approx(0.34, rel=1e-6)
        assert found[f"beta of {name}"] == pytest.approx(120.0, rel=1e-5)


def test_with_noise_within_its_error():
    found = anisotropy.saturations(approach(0.34, 120.0, 0.01, noise=0.01))
    assert found["C_D max"] == pytest.approx(0.34, abs=0.006)  # 0.01 over sqrt(about 100 points), three times and more


def test_what_does_not_saturate_has_no_limit():
    x = np.linspace(0.0, 0.25, 101)
    found = anisotropy.saturations({"eps_D": x} | dict.fromkeys(anisotropy.FITTED, x))
    assert np.isnan(found["C_D max"])


def test_the_mean_over_runs_is_on_one_grid(box_run):
    runs = [box_run({}, states=approach(limit, 100.0, 0.0)) for limit in (0.3, 0.4)]
    x, mean, error = anisotropy.mean_states(runs, "C_D")
    assert mean[-1] == pytest.approx(0.35, abs=1e-6)
    assert error[-1] == pytest.approx(0.05, abs=1e-6)
    assert (np.diff(x) > 0).all()


def test_a_power_of_the_pressure_comes_back(box_run, made):
    pressures, name = (100.0, 200.0, 500.0), "beta of s_D"
    runs = [
        made(anisotropy._name(anisotropy.MU, p, 0.06), "e", k, box_run({name: 4e4 * p ** (-1.0 - 0.1 * k)}))
        for p in pressures for k in (0, 1)
    ]
    assert anisotropy.pressure_exponent(runs, name, "e", pressures, 0.06).values == pytest.approx((-1.0, -1.1))
