"""One perturbation, one fault: each check is shown to pass on a good run and to fail on a bad one."""

from dataclasses import replace

import numpy as np
import pytest

from harness.runs.sanity import find_fault
from harness.scene.system import Wall
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory


def frame(system, step, *, contacts=None):
    x = system.particles.x + system.particles.v * (step * system.dt)
    axes = "xyz"[: system.dimension]
    particles = {"id": np.arange(1.0, len(x) + 1), **{a: x[:, k] for k, a in enumerate(axes)},
                 "radius": system.particles.radius}
    walls = {"id": [w.index for w in system.walls]}
    for k, a in enumerate(axes):
        walls[f"p{a}"] = [w.point[k] for w in system.walls]
        walls[f"n{a}"] = [w.normal[k] for w in system.walls]
        walls[f"f{a}"] = [0.0 for w in system.walls]
    return Snapshot(time=step * system.dt, dimension=system.dimension, particles=Columns(particles, "particles"),
                    walls=Columns(walls, "walls") if system.walls else None, contacts=contacts)


def run_of(system, **options):
    steps = tuple(range(0, system.steps + 1, system.frame_every))
    rows = np.arange(0.0, system.steps + 1, system.sample_every)
    series = {"step": rows, "time": rows * system.dt}
    for w in system.walls:
        series |= {f"{w.name}_{p}": 0 * rows for p in ("d", "v", *(f"f{a}" for a in "xyz"[: system.dimension]))}
    return Trajectory(frames=tuple(frame(system, s, **options) for s in steps), steps=steps,
                      series=Columns(series, "series"))


def with_frame(run, k, **changes):
    frames = list(run.frames)
    frames[k] = replace(frames[k], **changes)
    return replace(run, frames=tuple(frames))


def with_value(run, k, group, column, row, value):
    table = getattr(run.frames[k], group)
    values = table[column].copy()
    values[row] = value
    return with_frame(run, k, **{group: Columns({**table, column: values}, group)})


def with_series(run, **columns):
    return replace(run, series=Columns({**run.series, **columns}, "series"))


def test_a_good_run_has_no_fault(system):
    assert find_fault(system, run_of(system)) is None


def test_a_good_run_without_walls_needs_no_series(system):
    free = system.with_(walls=())
    assert find_fault(free, replace(run_of(free), series=None)) is None


ROWS = np.arange(0.0, 13, 2)

FAULTS = {
    "last frame missing": (
        lambda r: replace(r, frames=r.frames[:-1], steps=r.steps[:-1]), "crashed", "4 frames, the last at step 9"),
    "no frames": (lambda r: replace(r, frames=(), steps=()), "crashed", "0 frames; expected 5"),
    "frame at a wrong step": (
        lambda r: replace(r, steps=(0, 3, 7, 9, 12)), "crashed", "found step 7 in place of 6"),
    "no series": (lambda r: replace(r, series=None), "crashed", "no series"),
    "series row doubled": (
        lambda r: with_series(r, step=np.where(ROWS == 4, 2, ROWS)), "crashed", "found step 2 in place of 4"),
    "series column missing": (
        lambda r: replace(r, series=Columns({k: v for k, v in r.series.items() if k != "floor_fy"})),
        "crashed", "no column floor_fy"),
    "series not finite": (
        lambda r: with_series(r, floor_fy=np.where(ROWS == 8, np.inf, 0)), "unstable",
        "step 8: series floor_fy is inf"),
    "no walls": (lambda r: with_frame(r, 2, walls=None), "crashed", "step 6: walls []"),
    "particle doubled": (
        lambda r: with_value(r, 2, "particles", "id", 1, 1), "unstable", "step 6: 2 particles of 2, lost: 2"),
    "velocity infinite": (
        lambda r: with_value(r, 4, "particles", "y", 1, -np.inf), "unstable", "particles y is -inf in row 2"),
    "box not finite": (
        lambda r: with_frame(r, 1, box=np.array([[0, 1], [0, np.nan]])), "unstable", "step 3: the box"),
    "wall force not finite": (
        lambda r: with_value(r, 1, "walls", "fx", 0, np.nan), "unstable", "walls fx is nan"),
    "time step doubled": (
        lambda r: with_frame(r, 1, time=2 * r.frames[1].time), "crashed", "time is 0.006, expected 0.003"),
    "centre behind the wall": (
        lambda r: with_value(r, 3, "particles", "y", 0, -1e-9), "unstable", "1e-09 m behind wall 'floor'"),
    "packing shifted": (
        lambda r: with_value(r, 0, "particles", "x", 1, 1e-6), "crashed", "step 0: particle 2 is not where"),
    "radius in single precision": (
        lambda r: with_value(r, 0, "particles", "radius", 0, np.float32(0.1)), "crashed", "step 0: particle 1"),
    "contacts nobody asked for": (
        lambda r: with_frame(r, 0, contacts=Columns({}, "contacts")), "crashed", "contacts nobody asked for"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_is_found_and_named(system, name):
    spoil, status, reason = FAULTS[name]
    fault = find_fault(system, spoil(run_of(system)))
    assert fault is not None
    assert fault.status == status
    assert reason in fault.reason


def contacts(**changes):
    columns = {"i": [1, 1], "j": [2, -1], "px": [0, 0], "py": [0, 0], "fx": [1, 1], "fy": [0, 0],
               "ux": [0, np.nan], "overlap": [0.1, 0.1]}
    return Columns(columns | changes, "table")


@pytest.mark.parametrize(("changes", "found"), [
    ({}, None),
    ({"ux": [np.nan, 0]}, "contacts ux is nan in row 1"),
    ({"ux": [0, np.inf]}, "contacts ux is inf in row 2"),
    ({"fx": [1, np.nan]}, "contacts fx is nan in row 2"),
])
def test_only_what_an_engine_cannot_tell_may_be_nan_and_only_at_walls(system, changes, found):
    asked = system.with_(contacts=True)
    fault = find_fault(asked, run_of(asked, contacts=contacts(**changes)))
    assert (fault is None) == (found is None)
    assert found is None or found in fault.reason


def test_contacts_that_were_asked_for_must_be_there(system):
    asked = system.with_(contacts=True)
    fault = find_fault(asked, run_of(asked))
    assert fault.reason == "step 0: the frame has no contacts though the scene asks for them"


def test_periodic_axes_wrap_and_have_no_behind(system):
    box = system.with_(periodic=(4.0, 0.0))
    run = run_of(box)
    wrapped = [replace(f, particles=Columns({**f.particles, "x": f.particles["x"] % 4.0}, "particles"))
               for f in run.frames]
    assert find_fault(box, replace(run, frames=tuple(wrapped))) is None
    tilted = Wall(index=1, name="floor", point=(3.0, 0.0), normal=(1.0, 0.0), friction=False)
    assert find_fault(box.with_(walls=(tilted,)), run_of(box.with_(walls=(tilted,)))) is None
    assert find_fault(system.with_(walls=(tilted,)), run_of(system.with_(walls=(tilted,)))).status == "unstable"
