"""Discs that flow between two rings: inserted small, grown to size while the inner ring begins to turn, then sheared.

Only the density of a ring is given, and near the density at which it jams the history of the preparation decides
whether it flows (measured: at equal counts, discs grown without friction stay loose where discs grown in shear carry a
steady torque). So the discs grow as in the published preparation, in shear and with friction, computed by the reference
kernel in the convention of the talks. Growth goes in stages of constant radii; masses are the final ones throughout.
Deterministic in the seed on one machine; the cache keeps what was made (`harness.packing.cache`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.packing.cache import cached_path, read_cached, write_cached
from harness.packing.insertion import insert_in_annulus
from harness.scene.contact import ViscousSliding
from harness.scene.grains import grains_of, inertia_factor, mass_of
from harness.scene.model import Couette
from harness.scene.numerics import requested_step
from harness.scene.ring import area_fractions, radii, rings_of

METHOD = 1
"""Version of the preparation; raising it makes every state anew."""

STAGES = 100
"""Of growth: with a start at half size the radius rises by 0.5 % to 1 % a stage."""

COLUMNS = ("x", "y", "radius", "vx", "vy", "wz")


@dataclass(frozen=True, kw_only=True)
class Flow:
    """x, v: (N, 2) in m, m/s, about the rings' centre; spin (N,), rad/s; radius (N,), m; `path` of the CSV.

    The rings stand as `harness.scene.ring.rings_of` says; the inner one turns at its full rate.
    """

    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    radius: np.ndarray
    path: Path

    @property
    def says(self) -> str:
        """One line on it."""
        speed = float(np.sqrt((self.v**2).sum(axis=1).mean()))
        return f"{len(self.radius)} discs grown in shear, root mean square speed {speed:.2g} m/s"


def grow_ring(scene: Couette, *, seed: int, cache: Path, begin: Callable[[], None] = lambda: None) -> Flow:
    """Return the flowing state of this seed; begin is called when it has to be made. Raises InputError if it cannot."""
    path = cached_path(cache, "ring", _key(scene, seed))
    found = _read_flow(path)
    if found is not None:
        return found
    begin()
    x, v, spin = _grown(scene, inserted(scene, seed))
    write_cached(path, COLUMNS, (*x, radii(scene), *v, *spin), {"seed": seed, "fractions": area_fractions(scene)})
    return _read_flow(path)


def inserted(scene: Couette, seed: int) -> np.ndarray:
    """Centres (2, N) of the small discs at random places, without overlap. Raises InputError without room."""
    r, small = scene.rings, scene.preparation.start_size * radii(scene)
    rng = np.random.default_rng(seed)
    x = insert_in_annulus(small, r.inner_radius + r.grain_radius, r.outer_radius - r.grain_radius, rng)
    if x is None:
        raise InputError(
            file="packing", place="preparation.start_size", expected="discs that find places at random",
            got=f"{scene.preparation.start_size:g}, at which one found none", fix="lower it, or change the seed",
        )
    return x


# --- growth ----------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class _Stage:
    """Constant size and rate for a number of steps; angle: of the inner ring at its begin, rad."""

    size: float
    omega: float
    angle: float
    steps: int


def _stages(scene: Couette, dt: float) -> list[_Stage]:
    """Size grows linearly, the rate as sin^2(pi t/2T); then everything flows at full size and rate.

    The inner ring starts turned back by as much as it will turn, so that it ends where `rings_of` has it.
    """
    growth, steps = scene.preparation, math.ceil(scene.preparation.grow / dt / STAGES)
    done = np.arange(1, STAGES + 1) / STAGES
    size = [*(growth.start_size + (1.0 - growth.start_size) * done), 1.0]
    rate = scene.rings.omega * np.array([*np.sin(0.5 * np.pi * done) ** 2, 1.0])
    count = [steps] * STAGES + [math.ceil(growth.settle / dt)]
    turned = np.cumsum([0.0, *(rate * count * dt)])
    stages = zip(size, rate, turned[:-1] - turned[-1], count, strict=True)
    return [_Stage(size=float(s), omega=float(w), angle=float(a), steps=n) for s, w, a, n in stages if n]


def _grown(scene: Couette, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return x, v (2, N) and spin (1, N) after all stages."""
    from reference.kernel.program.simulation import fastest
    from reference.kernel.simulation import KernelUnstable

    dt = requested_step(scene, grains_of(scene))
    v, spin = np.zeros_like(x), np.zeros((1, x.shape[1]))
    for stage in _stages(scene, dt):
        running = fastest(_model(scene, stage, x, v, spin, dt))
        try:
            running.advance(stage.steps)
        except KernelUnstable as error:
            raise InputError(
                file="packing", place="preparation", expected="discs that can grow in the ring", got=error,
                fix="grow slower, take fewer discs or a smaller numerics.dt_fraction",
            ) from error
        state, n = running.state, x.shape[1]
        x, v, spin = (np.array(a[:, :n]) for a in (state.x, state.v, state.spin))
    return x, v, spin


def _model(scene: Couette, stage: _Stage, x, v, spin, dt: float):
    from reference.kernel.conventions import NAMED
    from reference.kernel.model import Model, Ring

    full, convention = radii(scene), NAMED["talk"]
    mass = mass_of(scene.particles.mass, full)
    rings = (
        Ring(name=r.name, centre=r.centre, x=r.x.T, radius=r.radius, omega=r.omega and stage.omega)
        for r in rings_of(scene)
    )
    rings = (ring if ring.omega is None else ring.turned(stage.angle) for ring in rings)
    return Model(
        x=x, v=v, spin=spin, radius=stage.size * full, mass=mass,
        inertia=inertia_factor(scene.particles.inertia) * mass * full**2, walls=(), rings=tuple(rings),
        convention=convention, dt=dt, drag=scene.background and scene.background.translational_drag,
        **_laws(scene, convention),
    )


def _laws(scene: Couette, convention) -> dict:
    """The normal law of the scene; of its friction what needs no memory: its limit and its dashpot."""
    import msgspec

    from reference.kernel.laws.registry import build_law

    normal = build_law("normal", msgspec.to_builtins(scene.contact.normal), convention)
    rubs = without_memory(scene)
    sliding = None if rubs is None else build_law("sliding", msgspec.to_builtins(rubs), convention, normal)
    return {"normal": normal, "sliding": sliding}


def without_memory(scene: Couette) -> ViscousSliding | None:
    """Return the friction of the preparation: the scene's own, or the limit and the dashpot of its spring."""
    law = scene.contact.sliding
    if law is None or isinstance(law, ViscousSliding):
        return law
    if not law.shear_friction or not law.shear_damping:
        return None
    return ViscousSliding(shear_friction=law.shear_friction, shear_damping=law.shear_damping)


# --- cache -----------------------------------------------------------------------------------


def _key(scene: Couette, seed: int) -> dict:
    import msgspec

    data = msgspec.to_builtins(scene)
    particles = {k: data["particles"][k] for k in ("mass", "inertia", "species")}
    rubs = without_memory(scene)
    return {
        "method": METHOD, "seed": seed, "particles": particles, "rings": data["rings"],
        "growth": data["preparation"], "normal": data["contact"]["normal"],
        "sliding": None if rubs is None else msgspec.to_builtins(rubs), "background": data["background"],
        "dt": requested_step(scene, grains_of(scene)),
    }


def _read_flow(path: Path) -> Flow | None:
    found = read_cached(path)
    if found is None:
        return None
    table, _ = found
    return Flow(
        x=np.column_stack([table["x"], table["y"]]), v=np.column_stack([table["vx"], table["vy"]]),
        spin=table["wz"], radius=table["radius"], path=path,
    )
