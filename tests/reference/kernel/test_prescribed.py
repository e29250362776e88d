"""Bodies driven along a path: the child process, what it refuses, and forces known in closed form."""

import json
import subprocess
import sys

import numpy as np
import pytest

from reference.kernel.model import Cosine
from reference.kernel.prescribed import driven


def path_of(x, dt, spin_rows):
    """A path through x (S + 1, N, dim) with the mean velocity of each step in its later row."""
    v = np.zeros_like(x)
    v[1:] = np.diff(x, axis=0) / dt
    return {"x": x, "v": v, "spin": np.broadcast_to(spin_rows, (*x.shape[:2], np.shape(spin_rows)[-1])).copy()}


def pressed_pair(overlaps, dim=2):
    """Particle 2 comes along x to give these overlaps with particle 1 (radii 1)."""
    x = np.zeros((len(overlaps), 2, dim))
    x[:, 1, 0] = 2.0 - np.array(overlaps)
    return x


def test_a_plastic_cycle_with_opening_in_between(dem):
    """k_1 up, k_2 down, -k_c delta, apart, and a first loading again."""
    m = dem.model([[0.0, 0.0], [2.1, 0.0]], normal=dem.table("normal", "hysteretic", normal_damping=0.0))
    overlaps = np.array([-0.1, 0.05, 0.1, 0.08, 0.01, -0.01, 0.02])
    force, torque = driven(m, **path_of(pressed_pair(overlaps), m.dt, [0.0]))
    expected = np.array([4e3 * 0.05, 4e3 * 0.1, 4e3 * 0.1 - 1e4 * 0.02, -2e3 * 0.01, 0.0, 4e3 * 0.02])
    np.testing.assert_allclose(force[:, 1, 0], expected, rtol=0, atol=1e-9)
    np.testing.assert_allclose(force[:, 0], -force[:, 1], rtol=0, atol=0)
    assert not torque.any()


def test_spins_reach_the_laws_as_they_are_given(dem):
    """Two discs pressed by 0.1 and turning against each other: the spring is stretched by the given slip."""
    spring = {"law": "spring", "shear_friction": 50.0, "shear_stiffness": 3e3, "shear_damping": 0.0}
    m = dem.model([[0.0, 0.0], [2.1, 0.0]], normal=dem.table("normal", "linear"), sliding=spring, convention="liggghts")
    x = pressed_pair([-0.1] + [0.1] * 4)
    force, torque = driven(m, x, np.zeros_like(x), np.full((5, 2, 1), 2.0))
    slip = 2 * 0.95 * 2.0  # both surfaces, arm R - overlap/2; the normal points from 2 to 1, along -x
    np.testing.assert_allclose(force[:, 0, 1], -3e3 * slip * m.dt * np.arange(1, 5), rtol=1e-12)
    np.testing.assert_allclose(torque[:, :, 0], 0.95 * force[:, :1, 1] * np.ones((1, 2)), rtol=1e-12)


def test_gravity_and_drag_do_not_act(dem):
    m = dem.model([[0.0, 0.0], [2.1, 0.0]], gravity=(0.0, -10.0), drag=3.0)
    force, _ = driven(m, **path_of(pressed_pair([-0.1, -0.05, 0.1]), m.dt, [0.0]))
    assert force[0].tolist() == [[0.0, 0.0], [0.0, 0.0]]
    assert force[1, 0].tolist() == pytest.approx([-1e3, 0.0])


def test_long_ways_between_rows_miss_no_contact(dem):
    m = dem.model([[0.0, 0.0], [2.1, 0.0]])
    x = pressed_pair([-0.1, -50.0, 0.1, -90.0, 0.2])
    force, _ = driven(m, x, np.zeros_like(x), np.zeros((5, 2, 1)))
    np.testing.assert_allclose(force[:, 1, 0], [0.0, 1e3, 0.0, 2e3], rtol=1e-12)


def test_what_is_refused(dem):
    m = dem.model([[0.0, 0.0], [2.1, 0.0]])
    x = pressed_pair([-0.1, 0.1])
    still, spin = np.zeros_like(x), np.zeros((2, 2, 1))
    with pytest.raises(ValueError, match=r"v: expected shape \(2, 2, 2\), got \(1, 2, 2\)"):
        driven(m, x, still[:1], spin)
    with pytest.raises(ValueError, match="touch in row 0"):
        driven(m, x[::-1], still, spin)
    moving = dem.wall("lid", (0.0, 9.0), (0.0, -1.0), motion=Cosine(travel=1.0, duration=1.0))
    with pytest.raises(ValueError, match="fixed walls"):
        driven(dem.model([[0.0, 0.0], [2.1, 0.0]], walls=[moving]), x, still, spin)


DECK = {
    "title": "rolling on a floor", "dimension": 3, "convention": "lammps", "dt": 1e-3,
    "plan": {"steps": 3, "sample_every": 1, "frame_every": 1, "contacts": False},
    "normal": {"law": "linear", "normal_stiffness": 1e4, "normal_damping": 0.0, "attraction": "allowed"},
    "rolling": {"law": "spring", "rolling_friction": 9.0, "rolling_stiffness": 2e3, "rolling_damping": 1.5},
    "walls": [
        {"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "friction": True, "motion": {"kind": "fixed"}}],
}


def test_the_child_process(tmp_path):
    """A sphere that rolls on a floor with rolling resistance alone: couple -R^2 (k_r angle + gamma_r rate)."""
    (tmp_path / "kernel.json").write_text(json.dumps(DECK))
    header, row = "id,x,y,z,radius,mass,inertia,vx,vy,vz,wx,wy,wz", "1,0,0,2,0.5,1,0.1,0,0,0,0,0,0"
    (tmp_path / "particles.csv").write_text(f"{header}\n{row}\n")
    x = np.array([[[0, 0, 2.0]], [[0, 0, 0.49]], [[0, 0, 0.49]], [[0, 0, 0.49]]])
    spin = np.zeros((4, 1, 3))
    spin[1:, 0] = [3.0, 4.0, 7.0]
    np.savez(tmp_path / "path.npz", x=x, v=np.zeros_like(x), spin=spin)
    done = subprocess.run([sys.executable, "-m", "reference.kernel.prescribed", str(tmp_path)], capture_output=True,
                          text=True, check=True)
    assert json.loads(done.stdout.splitlines()[-1])["finished"]
    with np.load(tmp_path / "reaction.npz") as reaction:
        force, torque = reaction["force"], reaction["torque"]
    np.testing.assert_allclose(force[:, 0], [[0, 0, 1e4 * 0.01]] * 3, rtol=1e-10, atol=1e-12)
    size = -(0.5**2) * (2e3 * 1e-3 * np.arange(1, 4) + 1.5)
    np.testing.assert_allclose(torque[:, 0], size[:, None] * [3.0, 4.0, 0.0], rtol=1e-10, atol=1e-12)
