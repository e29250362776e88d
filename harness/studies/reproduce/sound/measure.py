"""What is measured in a run: the modes of the layers, their frequencies, speeds of long waves, the pulse itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from harness.studies.accuracy.oracle import convention_of
from harness.studies.reproduce.sound.cases import Setting
from harness.studies.reproduce.sound.disorder import linear_velocities
from postproc.macro.fits.least_squares import Parameter
from postproc.macro.waves import layer_means, long_wave_speed, modes, oscillations
from postproc.results import Unavailable
from reference.analytic.fcc_waves import FccColumn, in_steps
from reference.kernel.conventions import NAMED

if TYPE_CHECKING:
    from harness.scene.system import System
    from postproc.trajectory import Trajectory

LONG = 0.35
"""Largest k l of the waves from which the speed of long waves is extrapolated: 18 layers a wavelength and more."""

BRANCHES = {False: 40, True: 25}
"""Modes, spread over the zone, whose frequencies are measured besides the long ones; regular and disordered."""

P, S, ROLLING, TORSION = "compression", "shear", "rolling", "torsion"


@dataclass(frozen=True, kw_only=True, eq=False)
class Branch:
    """One kind of wave: phase k l (M,), frequency and error (M,), rad/s; decay and its error (M,), 1/s, of disorder.

    left: (M,) rms of what the fit leaves of a mode over that of the mode: in a regular column next to nothing.
    """

    phase: np.ndarray
    frequency: np.ndarray
    error: np.ndarray
    decay: np.ndarray
    decay_error: np.ndarray
    left: np.ndarray


@dataclass(frozen=True, kw_only=True, eq=False)
class SoundRun:
    """One run. speed: of long waves by kind, m/s. time (F,), s; along (F, layers): mean v_z over that of the kick.

    linear: largest deviation of the mean velocities of layers from linear theory with the same steps, over the kick;
    of regular columns without friction springs and of disordered ones, else None.
    """

    branches: Mapping[str, Branch]
    speed: Mapping[str, Parameter | Unavailable]
    time: np.ndarray
    dt: float
    along: np.ndarray
    linear: float | None


def measure_sound(setting: Setting, trajectory: Trajectory, system: System) -> SoundRun:
    """Measure a finished run."""
    layer, radius = setting.column.layer, setting.column.material.radius
    time = np.array([frame.time for frame in trajectory])
    along, across = (layer_means(trajectory, c, layer) for c in ("vz", "vx"))
    kicked = float(along[0, 0])
    groups = {(P,): [modes(along)]}
    if setting.rough:
        turning, twisting = (radius * layer_means(trajectory, c, layer) for c in ("wy", "wz"))
        groups |= {(S, ROLLING): [modes(across), modes(turning)], (TORSION,): [modes(twisting)]}
    else:
        groups |= {(S,): [modes(across)]}
    branches: dict[str, Branch] = {}
    for names, channels in groups.items():
        branches |= _branches(names, np.array(channels), time, setting)
    speeds = {name: _speed(branches[name], setting) for name in (P, S)}
    return SoundRun(
        branches=branches, speed=speeds, time=time, dt=system.dt, along=along / kicked,
        linear=_from_linear(setting, system, along, across),
    )


def closed_form(setting: Setting, engine: str) -> FccColumn:
    """Return the closed form with the lever arms at which an engine measures slip and applies friction."""
    waves, convention = setting.column.material.waves(), NAMED[convention_of(engine)]
    arm = {"radius": waves.radius, "reduced": waves.spacing / 2}
    return setting.column.material.waves(arms=arm[convention.slip_arm] * arm[convention.torque_arm])


def expected_frequencies(waves: FccColumn, branch: str, phase: np.ndarray, dt: float) -> np.ndarray:
    """Return the closed form of a branch at phases k l (M,) in a leapfrog's steps of dt, rad/s; dt = 0: exact."""
    wavenumber = np.asarray(phase) / waves.layer
    exact = {
        P: waves.compression, TORSION: waves.torsion, S: lambda k: waves.shear(k)[..., 0],
        ROLLING: lambda k: waves.shear(k)[..., -1],
    }[branch](wavenumber)
    return in_steps(exact, dt) if dt else exact


def _branches(names: tuple[str, ...], channels: np.ndarray, time: np.ndarray, setting: Setting) -> dict[str, Branch]:
    """Return the frequencies of modes (channels, F, modes) by the names of the waves in them, ascending."""
    layers = setting.column.layers
    chosen = _chosen_modes(layers, BRANCHES[setting.width > 0])
    found = [oscillations(channels[:, :, m], time, len(names), decaying=setting.width > 0) for m in chosen]
    phase = 2 * np.pi * chosen / layers
    return {
        name: Branch(
            phase=phase, left=np.array([o.residual for o in found]), **{
                field: np.array([getattr(o, source)[k] for o in found])
                for field, source in (("frequency", "frequency"), ("error", "frequency_error"), ("decay", "decay"),
                                      ("decay_error", "decay_error"))
            },
        )
        for k, name in enumerate(names)
    }


def _chosen_modes(layers: int, count: int) -> np.ndarray:
    """Return all long modes, and `count` spread up to the edge of the zone."""
    long = np.arange(1, int(LONG * layers / (2 * np.pi)) + 1)
    spread = np.linspace(1, layers // 2, count).astype(int)
    return np.unique(np.concatenate([long, spread]))


def _speed(branch: Branch, setting: Setting) -> Parameter | Unavailable:
    long = branch.phase <= LONG
    wavenumber = branch.phase[long] / setting.column.material.waves().layer
    return long_wave_speed(wavenumber, branch.frequency[long])


def _from_linear(setting: Setting, system: System, along: np.ndarray, across: np.ndarray) -> float | None:
    """Return how far the layers are from what the dynamic matrix of the packing gives, over the kick."""
    if setting.rough:
        return None
    means = _linear_means(
        setting, float(system.particles.v[0, 2]), system.dt, system.frame_every, len(along) - 1
    )
    largest = max(np.abs(means[..., 2] - along).max(), np.abs(means[..., 0] - across).max())
    return float(largest / abs(along[0, 0]))


@lru_cache(maxsize=32)
def _linear_means(setting: Setting, kick: float, dt: float, every: int, frames: int) -> np.ndarray:
    """Return the mean velocities of layers (frames + 1, layers, 3) by linear theory, m/s: one packing, all engines."""
    layers = setting.column.layers
    kicked = np.where(setting.column.layer == 0, 1.0, -1.0 / (layers - 1))[:, None] * [kick, 0.0, kick]
    velocities = linear_velocities(setting.packing(), kicked, dt, every, frames)
    return velocities.reshape(frames + 1, layers, -1, 3).mean(axis=2)
