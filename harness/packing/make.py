"""Make a frictionless packing at rest under pressure, or take it from the cache.

Random radii, random loose insertion, affine compression to just below jamming, overlaps removed at
constant size, then both right and top walls under the target pressure until forces balance
(`reference.kernel.relax`). Deterministic in the seed; the cache key is everything that decides the
result (see `harness.packing.cache`).
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.packing.cache import cached_path, read_cached, write_cached
from harness.packing.insertion import LOOSE, insert_loose
from harness.packing.radii import draw_radii, radii_key
from harness.scene.bodies import read_packing_file
from harness.scene.model import Preparation, RandomParticles

METHOD = 1
"""Version of the preparation; raising it makes every packing anew."""

BELOW_JAMMING = 0.80
"""Area fraction after the affine compression; random discs jam at about 0.84."""


@dataclass(frozen=True, kw_only=True)
class Packing:
    """x: (N, 2), radius: (N,), box: (L_x, L_y) in m; residual and contacts as reached; `path` of the CSV."""

    x: np.ndarray
    radius: np.ndarray
    box: tuple[float, float]
    residual: float
    contacts: int
    path: Path

    @property
    def area_fraction(self) -> float:
        """nu = sum pi a^2 / (L_x L_y)."""
        return float(np.pi * (self.radius**2).sum() / (self.box[0] * self.box[1]))

    @property
    def says(self) -> str:
        """One line on it."""
        return f"{len(self.radius)} particles, {self.contacts} contacts, residual force {self.residual:.2g}"


def make_packing(
    particles: RandomParticles, preparation: Preparation, *, stiffness: float, seed: int, cache: Path,
    scene_folder: Path, begin: Callable[[], None] = lambda: None,
) -> Packing:
    """Return the packing of this seed (or the relaxed packing of the file that the scene names).

    begin is called when it has to be made, and is not in the cache.

    Raises InputError for a broken packing file, or when the packing cannot be brought to balance.
    """
    start = None if particles.packing is None else read_packing_file(scene_folder, particles.packing)
    key = {
        "method": METHOD, "count": particles.count, "seed": seed, "stiffness": stiffness,
        "radius": radii_key(particles),
        "pressure": preparation.pressure, "tolerance": preparation.residual_tolerance,
        "file": None if start is None else [hashlib.sha256(a.tobytes()).hexdigest() for a in start],
    }
    path = cached_path(cache, "packing", key)
    cached = _read_packing(path)
    if cached is not None:
        return cached
    begin()
    x, radius, box = _loose(particles, seed) if start is None else _in_its_box(*start)
    return _store(path, key, _relaxed(x, radius, box, preparation, stiffness, particles), radius)


def _loose(particles: RandomParticles, seed: int):
    rng = np.random.default_rng(seed)
    radius = draw_radii(particles, rng)
    x, side = insert_loose(radius, rng)
    shrink = float(np.sqrt(LOOSE / BELOW_JAMMING))
    return x * shrink, radius, (side * shrink, side * shrink)


def _in_its_box(x: np.ndarray, radius: np.ndarray):
    """Shift centres (N, 2) into the smallest box around the discs, its lower left corner at the origin."""
    x = x - (x - radius[:, None]).min(axis=0)
    return x.T, radius, tuple((x + radius[:, None]).max(axis=0).tolist())


def _relaxed(x, radius, box, preparation: Preparation, stiffness: float, particles: RandomParticles):
    from reference.kernel.relax import NotRelaxed, relax_in_box

    try:
        if particles.packing is None:
            spread = relax_in_box(x, radius, box, stiffness=stiffness, pressure=0.0, tolerance=1e-7)
            x, box = spread.x, spread.box
        return relax_in_box(
            x, radius, box, stiffness=stiffness, pressure=preparation.pressure,
            tolerance=preparation.residual_tolerance,
        )
    except NotRelaxed as error:
        raise InputError(
            file="packing", place="preparation", expected="a packing in balance at this pressure", got=error,
            fix="raise preparation.residual_tolerance or change the seed",
        ) from error


def _store(path: Path, key: dict, relaxed, radius: np.ndarray) -> Packing:
    facts = {"key": key, "box": list(relaxed.box), "residual": relaxed.residual, "contacts": relaxed.contacts}
    write_cached(path, ("x", "y", "radius"), (*relaxed.x, radius), facts)
    return _read_packing(path)


def _read_packing(path: Path) -> Packing | None:
    """Return the cached packing, or None when it is missing or damaged (then it is made anew)."""
    found = read_cached(path)
    if found is None:
        return None
    table, facts = found
    return Packing(
        x=np.column_stack([table["x"], table["y"]]), radius=table["radius"], box=tuple(facts["box"]),
        residual=facts["residual"], contacts=facts["contacts"], path=path,
    )
