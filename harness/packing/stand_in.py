"""Particles in the place of a packing: they cost nothing, and are as many and as large as the real ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.packing.grow import Flow, inserted
from harness.packing.insertion import insert_loose
from harness.packing.make import Packing
from harness.packing.radii import draw_radii
from harness.scene.model import Biaxial, Couette
from harness.scene.ring import radii


def stand_in(scene: Biaxial | Couette) -> Packing | Flow:
    """Return particles for estimates and for committed decks, never for runs; the same bytes on every machine."""
    return STAND_INS[type(scene)](scene)


def _loose(scene: Biaxial) -> Packing:
    rng = np.random.default_rng(0)
    radius = draw_radii(scene.particles, rng)
    x, side = insert_loose(radius, rng)
    return Packing(x=x.T, radius=radius, box=(side, side), residual=float("nan"), contacts=0, path=Path())


def _small(scene: Couette) -> Flow:
    """Discs of full size at the places of the small ones that they grow from, at rest."""
    x = inserted(scene, scene.particles.seed).T
    return Flow(x=x, v=np.zeros_like(x), spin=np.zeros(len(x)), radius=radii(scene), path=Path())


STAND_INS = {Biaxial: _loose, Couette: _small}
