"""The column: square layers of spheres stacked to a face-centred cubic packing, and the scene that any code can run.

The cube axis is z; bonds of a layer run along x and y. Every second layer is moved by half a spacing along both. The
box is periodic along all axes, so that the pressure is that of the overlap and no wall reflects.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from reference.analytic.fcc_waves import FccColumn

SCENE = """# {title}
#
# Written by `grainproof reproduce sound`: {layers} square layers of {across} x {across} spheres, periodic along all
# axes, pressed together by an overlap of {overlap:g} of the radius; one layer is kicked. `grainproof run` takes it.

kind = "free"
title = "{title}"
dimension = 3
duration = {duration!r}
periodic = {periodic!r}
bodies_file = "{bodies}"

[contact.normal]
law = "linear"
normal_stiffness = {stiffness!r}
normal_damping = 0.0
attraction = "allowed"
{sliding}
[numerics]
dt_fraction = {dt_fraction!r}

[outputs]
samples = {frames}
frames = {frames}
contacts = false
"""

SLIDING = """
[contact.sliding]
law = "spring"
shear_friction = {friction!r}
shear_stiffness = {tangential!r}
shear_damping = 0.0
"""


@dataclass(frozen=True, kw_only=True)
class Material:
    """Spheres of radius R (m) and density (kg/m^3) on springs k_n, k_t (N/m), mu; overlap delta/R of regular packings.

    The set-up of O. Mouraille, W. A. Mulder, S. Luding, J. Stat. Mech. P07023 (2006), as recalled; the closed forms
    that decide hold for any. k_t = 0: without friction.
    """

    radius: float = 1e-3
    density: float = 2000.0
    stiffness: float = 1e5
    tangential: float = 0.0
    friction: float = 0.5
    overlap: float = 1e-3

    @property
    def mass(self) -> float:
        """4/3 pi rho R^3, kg."""
        return float(self.mass_of(self.radius))

    def mass_of(self, radius: np.ndarray) -> np.ndarray:
        """4/3 pi rho a^3, kg, of radii (m, any shape)."""
        return 4 / 3 * math.pi * self.density * np.asarray(radius) ** 3

    def waves(self, arms: float | None = None) -> FccColumn:
        """Return the closed form of the regular packing; arms: see there."""
        return FccColumn(
            normal_stiffness=self.stiffness, tangential_stiffness=self.tangential, mass=self.mass, radius=self.radius,
            overlap=self.overlap * self.radius, arms=arms,
        )


@dataclass(frozen=True, kw_only=True)
class Column:
    """`layers` (even) square layers of `across` x `across` spheres of one material."""

    material: Material
    layers: int
    across: int

    @property
    def count(self) -> int:
        """Number of spheres."""
        return self.layers * self.across**2

    @property
    def box(self) -> tuple[float, float, float]:
        """Periodic lengths, m."""
        waves = self.material.waves()
        return (self.across * waves.spacing, self.across * waves.spacing, self.layers * waves.layer)

    @property
    def layer(self) -> np.ndarray:
        """Number of each sphere's layer, from 0, (N,)."""
        return np.repeat(np.arange(self.layers), self.across**2)

    def places(self) -> np.ndarray:
        """Return the centres of the regular packing (N, 3), m; none lies on the box's border."""
        waves = self.material.waves()
        site = np.stack(np.meshgrid(np.arange(self.across), np.arange(self.across), indexing="ij"), axis=-1)
        flat = np.tile(site.reshape(-1, 2), (self.layers, 1)) + 0.25 + 0.5 * (self.layer % 2)[:, None]
        return np.column_stack([flat * waves.spacing, (self.layer + 0.5) * waves.layer])

    def wavenumbers(self) -> np.ndarray:
        """Return k_m = 2 pi m/(N l) of the modes m = 0 .. N/2, rad/m."""
        return 2 * math.pi * np.arange(self.layers // 2 + 1) / (self.layers * self.material.waves().layer)


@dataclass(frozen=True, kw_only=True)
class Kick:
    """What the kicked layer gets: velocity (3,) and spin times radius (3,), m/s; all others move the opposite way.

    So that the column as a whole rests.
    """

    velocity: tuple[float, float, float]
    surface: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Look:
    """How long a run lasts (s), how often it is looked at, and its time step as part of a contact time."""

    duration: float
    frames: int
    dt_fraction: float = 0.02


def write_scene(
    folder: Path, name: str, title: str, column: Column, kick: Kick, look: Look, *, places: np.ndarray,
    radius: np.ndarray,
) -> Path:
    """Write ``<name>.toml`` and ``<name>.csv`` below `folder`; places (N, 3), radius (N,), m. Return the scene file."""
    from harness.runs.atomic import write_text_atomic

    material = column.material
    sliding = SLIDING.format(friction=material.friction, tangential=material.tangential) if material.tangential else ""
    text = SCENE.format(
        title=title, layers=column.layers, across=column.across, overlap=material.overlap, duration=look.duration,
        periodic=list(column.box), bodies=f"{name}.csv", stiffness=material.stiffness, sliding=sliding,
        dt_fraction=look.dt_fraction, frames=look.frames,
    )
    folder.mkdir(parents=True, exist_ok=True)
    write_text_atomic(folder / f"{name}.csv", _bodies(column, kick, places, radius))
    write_text_atomic(folder / f"{name}.toml", text)
    return folder / f"{name}.toml"


def _bodies(column: Column, kick: Kick, places: np.ndarray, radius: np.ndarray) -> str:
    """Return the table of bodies with 17 digits."""
    kicked = np.where(column.layer == 0, 1.0, -1.0 / (column.layers - 1))[:, None]
    columns = [places, radius, column.material.mass_of(radius), kicked * kick.velocity]
    header = "x,y,z,radius,mass,vx,vy,vz"
    if any(kick.surface):
        columns.append(kicked * kick.surface / column.material.radius)
        header += ",wx,wy,wz"
    rows = np.column_stack(columns)
    return "\n".join([header, *(",".join(f"{v:.17g}" for v in row) for row in rows)]) + "\n"
