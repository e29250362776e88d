"""Runs whose motion is known: trajectories written down, no engine behind them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harness.scene.contact import LinearNormal
from harness.scene.expect import Invariant
from harness.scene.system import Particles, System
from harness.studies.stability.seen import Seen
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory

STIFFNESS = 100.0


def system(x, *, v, spin, radius, mass, steps, walls=(), gravity=None, periodic=None, normal=None, contacts=False):
    dim = x.shape[1]
    return System(
        dimension=dim, walls=walls, sliding=None, background=None, gravity=gravity, periodic=periodic, dt=0.1,
        particles=Particles(x=x, radius=radius, mass=mass, inertia_factor=np.full(len(x), 0.5), v=v, spin=spin),
        normal=normal or LinearNormal(normal_stiffness=STIFFNESS, normal_damping=0.0, attraction="allowed"),
        steps=steps, sample_every=1, frame_every=1, contacts=contacts,
    )


def particle_table(x, v, spin, radius, mass):
    axes = "xyz"[: x.shape[1]]
    spins = ("wz",) if x.shape[1] == 2 else ("wx", "wy", "wz")
    columns = {"id": np.arange(1.0, len(x) + 1)} | dict(zip(axes, x.T, strict=True))
    columns |= {f"v{a}": c for a, c in zip(axes, v.T, strict=True)} | dict(zip(spins, spin.T, strict=True))
    return columns | {"radius": radius, "mass": mass, "inertia": 0.5 * mass * radius**2}


def seen(x, *, v=None, spin=None, radius=None, mass=None, walls=(), contacts=None, series=None, **settings):
    """Return a run of x (F, N, dim) and v, spin (F, N, 1); frames are 0.1 s apart. contacts: columns of all frames."""
    x = np.asarray(x, float)
    frames, count, dim = x.shape
    v = np.zeros_like(x) if v is None else np.asarray(v, float)
    spin = np.zeros((frames, count, 1 if dim == 2 else 3)) if spin is None else np.asarray(spin, float)
    radius = np.ones(count) if radius is None else np.asarray(radius, float)
    mass = np.ones(count) if mass is None else np.asarray(mass, float)
    planes = None
    if walls:
        axes = "xyz"[:dim]
        point, normal = (np.array([getattr(w, k) for w in walls], float).T for k in ("point", "normal"))
        planes = {"id": np.arange(1.0, len(walls) + 1)}
        planes |= {f"p{a}": c for a, c in zip(axes, point, strict=True)}
        planes |= {f"n{a}": c for a, c in zip(axes, normal, strict=True)}
    made = tuple(
        Snapshot(
            time=0.1 * k, dimension=dim, particles=Columns(particle_table(x[k], v[k], spin[k], radius, mass)),
            walls=None if planes is None else Columns(planes),
            contacts=None if contacts is None else Columns(contacts),
        )
        for k in range(frames)
    )
    built = system(
        x[0], v=v[0], spin=spin[0], radius=radius, mass=mass, steps=frames - 1, walls=walls,
        contacts=contacts is not None, **settings,
    )
    columns = None if series is None else Columns(series)
    return Seen(system=built, trajectory=Trajectory(frames=made, steps=tuple(range(frames)), series=columns))


def altered(run, frame, **columns):
    """Return a run with some columns of the particles of one frame changed; None takes a row away from all."""
    frames = list(run.trajectory.frames)
    table = {k: frames[frame].particles[k].copy() for k in frames[frame].particles}
    for name, change in columns.items():
        table[name] = change(table[name])
    frames[frame] = replace(frames[frame], particles=Columns(table))
    return Seen(system=run.system, trajectory=replace(run.trajectory, frames=tuple(frames)))


def without_last(run, frame):
    """Return a run that loses its last particle in one frame."""
    frames = list(run.trajectory.frames)
    table = {k: frames[frame].particles[k][:-1] for k in frames[frame].particles}
    frames[frame] = replace(frames[frame], particles=Columns(table))
    return Seen(system=run.system, trajectory=replace(run.trajectory, frames=tuple(frames)))


def promise(name, **more):
    return Invariant(name=name, tolerance=1e-9, reason="a test", **more)


@pytest.fixture
def states():
    """The makers above, and the stiffness of their springs."""
    return SimpleNamespace(
        seen=seen, altered=altered, without_last=without_last, promise=promise, stiffness=STIFFNESS
    )
