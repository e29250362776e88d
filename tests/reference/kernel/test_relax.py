"""Packings in balance: residual, wall pressures, and the same bits everywhere."""

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest

from reference.kernel.relax import NotRelaxed, relax_in_box

STIFFNESS, PRESSURE = 1e4, 50.0


def loose(seed, count=24):
    """Discs on a jittered lattice in a box that leaves them little room: some overlap at first."""
    rng = np.random.default_rng(seed)
    side = int(np.ceil(np.sqrt(count)))
    radius = rng.uniform(0.7, 1.2, count)
    places = np.stack(np.divmod(np.arange(count), side)).astype(float)
    return 2.2 * places + 1.3 + rng.uniform(-0.2, 0.2, (2, count)), radius, (2.2 * side + 0.4,) * 2


def forces(x, radius, box, stiffness=STIFFNESS):
    """Net force on each disc, force on the four walls, and all contact forces, by plain loops."""
    count = len(radius)
    net, wall, sizes = np.zeros((2, count)), np.zeros(4), []
    for i in range(count):
        gaps = (x[0, i], x[1, i], box[0] - x[0, i], box[1] - x[1, i])
        for k, gap in enumerate(gaps):
            push = stiffness * max(radius[i] - gap, 0.0)
            wall[k] += push
            net[k % 2, i] += push if k < 2 else -push
            sizes += [push] * int(push > 0)
        for j in range(i):
            branch = x[:, i] - x[:, j]
            distance = np.sqrt(branch @ branch)
            push = stiffness * max(radius[i] + radius[j] - distance, 0.0)
            net[:, i] += push * branch / distance
            net[:, j] -= push * branch / distance
            sizes += [push] * int(push > 0)
    return net, wall, sizes


@pytest.mark.parametrize("tolerance", [1e-4, 1e-9])
@pytest.mark.parametrize("seed", [1, 2])
def test_forces_balance_and_walls_carry_the_pressure(seed, tolerance):
    x, radius, box = loose(seed)
    relaxed = relax_in_box(x, radius, box, stiffness=STIFFNESS, pressure=PRESSURE, tolerance=tolerance)
    net, wall, sizes = forces(relaxed.x, radius, relaxed.box)
    mean = np.mean(sizes)
    assert relaxed.contacts == len(sizes)
    right, top = wall[2] - PRESSURE * relaxed.box[1], wall[3] - PRESSURE * relaxed.box[0]
    worst = max(np.sqrt((net**2).sum(axis=0)).max(), abs(right), abs(top)) / mean
    assert worst == pytest.approx(relaxed.residual, rel=1e-3, abs=1e-12)
    assert worst < tolerance
    assert wall[0] == pytest.approx(PRESSURE * relaxed.box[1], abs=2 * len(radius) * tolerance * mean)
    assert wall[1] == pytest.approx(PRESSURE * relaxed.box[0], abs=2 * len(radius) * tolerance * mean)


def test_the_packing_is_a_minimum_of_the_enthalpy():
    x, radius, box = loose(3)
    relaxed = relax_in_box(x, radius, box, stiffness=STIFFNESS, pressure=PRESSURE, tolerance=1e-9)

    def enthalpy(x, box):
        return sum(f**2 for f in forces(x, radius, box)[2]) / (2 * STIFFNESS) + PRESSURE * box[0] * box[1]

    least, rng = enthalpy(relaxed.x, relaxed.box), np.random.default_rng(0)
    for _ in range(20):
        other = relaxed.x + 1e-4 * rng.normal(size=relaxed.x.shape)
        assert enthalpy(other, tuple(np.array(relaxed.box) + 1e-4 * rng.normal(size=2))) > least


def test_without_pressure_the_box_stays_and_overlaps_go():
    x, radius, box = loose(4)
    assert forces(x, radius, box)[2]
    relaxed = relax_in_box(x, radius, box, stiffness=STIFFNESS, pressure=0.0, tolerance=1e-7)
    assert relaxed.box == box
    net, _, _ = forces(relaxed.x, radius, relaxed.box)
    assert np.sqrt((net**2).sum(axis=0)).max() < 1e-7 * STIFFNESS * radius.mean()


def test_one_disc_between_four_walls():
    """p L = k (R - L/2) on every side, so L = 2 R / (1 + 2 p/k)."""
    relaxed = relax_in_box(np.array([[1.4], [1.2]]), np.ones(1), (3.0, 2.5), stiffness=STIFFNESS, pressure=PRESSURE,
                           tolerance=1e-10)
    side = 2.0 / (1.0 + 2.0 * PRESSURE / STIFFNESS)
    assert relaxed.box == pytest.approx((side, side), rel=1e-9)
    assert relaxed.x[:, 0].tolist() == pytest.approx([side / 2, side / 2], rel=1e-9)
    assert relaxed.contacts == 4


def test_the_given_arrays_are_left_alone():
    x, radius, box = loose(5)
    before = x.copy(), radius.copy()
    relax_in_box(x, radius, box, stiffness=STIFFNESS, pressure=PRESSURE, tolerance=1e-2)
    assert np.array_equal(x, before[0])
    assert np.array_equal(radius, before[1])


def test_too_few_iterations_are_said_so():
    x, radius, box = loose(6)
    with pytest.raises(NotRelaxed, match=r"residual [0-9.e+-]+ of the mean contact force after 40 iterations"):
        relax_in_box(x, radius, box, stiffness=STIFFNESS, pressure=PRESSURE, tolerance=1e-9, max_iterations=40)


@pytest.mark.parametrize("x", [[[1.0, 1.0], [1.0, 1.0]], [[-0.5, 2.0], [1.0, 1.0]]])
def test_a_start_that_cannot_be_relaxed_is_refused(x):
    """Two centres in one place, and a centre behind a wall."""
    with pytest.raises(NotRelaxed):
        relax_in_box(np.array(x), np.ones(2), (4.0, 4.0), stiffness=STIFFNESS, pressure=PRESSURE, tolerance=1e-6)


HASH = """
import hashlib, numpy as np
from reference.kernel.conventions import LAMMPS
from reference.kernel.laws.linear import LinearNormal
from reference.kernel.laws.sliding import SpringSliding
from reference.kernel.model import Cosine, Loaded, Model, Wall
from reference.kernel.relax import relax_in_box
from reference.kernel.simulation import Simulation
rng = np.random.default_rng(1)
radius = rng.uniform(0.7, 1.2, 20)
x = 2.2 * np.stack(np.divmod(np.arange(20), 5)) + 1.3 + rng.uniform(-0.2, 0.2, (2, 20))
packed = relax_in_box(x, radius, (11.0, 11.0), stiffness=1e4, pressure=50.0, tolerance=1e-6)
lx, ly = packed.box
walls = (Wall(name="left", point=(0.0, 0.0), normal=(1.0, 0.0), friction=True),
         Wall(name="bottom", point=(0.0, 0.0), normal=(0.0, 1.0), friction=False),
         Wall(name="right", point=(lx, 0.0), normal=(-1.0, 0.0), friction=False,
              motion=Loaded(mass=5.0, load=0.0, stress=50.0, span=(1, 3), damping=1.0)),
         Wall(name="top", point=(0.0, ly), normal=(0.0, -1.0), friction=True, motion=Cosine(travel=1.0, duration=0.5)))
model = Model(
    x=packed.x, v=rng.normal(size=(2, 20)), spin=rng.normal(size=(1, 20)), radius=radius, mass=np.ones(20),
    inertia=0.5 * radius**2, walls=walls,
    normal=LinearNormal(normal_stiffness=1e4, normal_damping=2.0, attraction="clipped"),
    sliding=SpringSliding(shear_friction=0.5, shear_stiffness=2e3, shear_damping=1.0, algorithm="lammps"),
    convention=LAMMPS, dt=5e-4, gravity=(0.1, -0.3), drag=0.01)
s = Simulation(model)
for _ in range(200):
    s.advance()
state = s.state
parts = [packed.x, np.array(packed.box), state.x, state.v, state.spin, state.wall_d, state.wall_rate, state.wall_force]
print(hashlib.sha256(b"".join(np.ascontiguousarray(p).tobytes() for p in parts)).hexdigest())
"""


def test_the_same_bits_without_the_vector_units_of_the_processor():
    """A packing and a run with friction, a loaded and a driven wall: NumPy's and BLAS' vector code must not show."""
    from numpy._core import _multiarray_umath as built

    able = [f for f in built.__cpu_dispatch__ if built.__cpu_features__.get(f)]
    if not able:
        pytest.skip("this processor has no vector features beyond NumPy's baseline")
    plain = dict(os.environ, NPY_DISABLE_CPU_FEATURES=" ".join(able), OPENBLAS_CORETYPE="Prescott")
    prints = {_printed(env) for env in (dict(os.environ), plain)}
    assert len(prints) == 1
    assert len(prints.pop()) == len(hashlib.sha256().hexdigest())


def _printed(env):
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", HASH], env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()
