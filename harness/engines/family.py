"""Deck lines that LIGGGHTS has inherited from LAMMPS and that both understand alike."""

from __future__ import annotations

from harness.scene.system import System

MEAN_SPIN = "f_mean_spin"
"""Dump column of the mean spin since the last frame; readers sum it up to rotations."""


def rotation_lines(system: System) -> list[str]:
    """Return what averages spins between frames; nothing when rotations are not asked for."""
    if not system.rotations:
        return []
    every, samples = spin_samples(system)
    return [
        "",
        "# mean spin since the last frame",
        "compute spin grains property/atom omegaz",
        f"fix mean_spin grains ave/atom {every} {samples} {system.frame_every} c_spin",
    ]


def spin_samples(system: System) -> tuple[int, int]:
    """Return every how many steps spins are sampled, and how many samples a frame has.

    Ten steps or fewer, half a contact time of the smallest pair: spins hardly change within it.
    """
    every = max(k for k in range(1, 11) if system.frame_every % k == 0)
    return every, system.frame_every // every
