"""Rings in the checks of a run: columns they must have, values that one kind of wall lacks, discs through a circle."""

from dataclasses import replace

import numpy as np
import pytest

from harness.runs.sanity import find_fault
from harness.scene.system import Ring
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory

NAN = np.nan


@pytest.fixture
def ringed(system):
    """The two particles and the floor of the other tests inside a ring."""
    middle = tuple(system.particles.x.mean(axis=0).tolist())
    body = Ring(
        index=2, name="drum", centre=middle, circle=10.0, x=np.array(middle) + [[10.0, 0.0]],
        radius=np.array([0.1]), omega=1.0,
    )
    return system.with_(rings=(body,))


def run_of(system, *, without=None, through=None, **walls):
    """A good run but for these changes: a column of the series, a particle at a place, columns of the walls."""
    (floor,), (drum,) = system.walls, system.rings
    columns = {
        "id": [1, 2], "px": [floor.point[0], drum.centre[0]], "py": [floor.point[1], drum.centre[1]],
        "nx": [floor.normal[0], NAN], "ny": [floor.normal[1], NAN], "fx": [0, 0], "fy": [0, 0],
        "radius": [NAN, 10.0], "torque": [NAN, 0.0],
    } | walls
    frames = []
    for step in (steps := tuple(range(0, system.steps + 1, system.frame_every))):
        x = system.particles.x + system.particles.v * step * system.dt
        if through is not None and step:
            x[0] = np.array(drum.centre) + through
        table = {"id": [1, 2], "x": x[:, 0], "y": x[:, 1], "radius": system.particles.radius}
        frames.append(Snapshot(time=step * system.dt, dimension=2, particles=Columns(table, "particles"),
                               walls=Columns(columns, "walls")))
    rows = np.arange(0.0, system.steps + 1, system.sample_every)
    names = [f"floor_{c}" for c in ("d", "v", "fx", "fy")] + [f"drum_{c}" for c in ("angle", "torque", "fx", "fy")]
    series = {"step": rows, "time": rows * system.dt} | {c: 0 * rows for c in names if c != without}
    return Trajectory(frames=tuple(frames), steps=steps, series=Columns(series, "series"))


def test_a_plane_and_a_ring(ringed):
    assert find_fault(ringed, run_of(ringed)) is None


@pytest.mark.parametrize(("changes", "status", "reason"), [
    ({"without": "drum_torque"}, "crashed", "no column drum_torque"),
    ({"torque": [NAN, NAN]}, "unstable", "walls torque is nan in row 2"),
    ({"torque": [NAN, np.inf]}, "unstable", "walls torque is inf in row 2"),
    ({"nx": [NAN, NAN]}, "unstable", "walls nx is nan in row 1"),
    ({"fx": [0, NAN]}, "unstable", "walls fx is nan in row 2"),
    ({"id": [1, 3]}, "crashed", "the scene has 2"),
    ({"through": [0.0, 10.1]}, "unstable", "particle 1 went through ring 'drum'"),
])
def test_each_fault_is_found_and_named(ringed, changes, status, reason):
    fault = find_fault(ringed, run_of(ringed, **changes))
    assert fault is not None
    assert fault.status == status
    assert reason in fault.reason


def test_rings_alone_need_a_series(ringed):
    run = run_of(ringed)
    assert find_fault(ringed.with_(walls=()), replace(run, series=None)).reason == "no series of wall forces"
