"""What is installed, and how each engine stands to each effect."""

from __future__ import annotations

import numpy as np

from harness.engines.registry import ENGINES
from harness.scene.model import Background, LinearNormal, SpringSliding
from harness.scene.system import Constant, Cosine, Loaded, Particles, System, Wall


def engine_rows() -> list[dict]:
    """One row an engine: is it here, which version, where or how to get it."""
    probes = {name: engine.probe() for name, engine in ENGINES.items()}
    return [
        {"engine": n, "here": "yes" if p.available else "no", "version": p.version or None, "detail": p.detail}
        for n, p in probes.items()
    ]


def support_rows() -> list[dict]:
    """One row an engine and effect, for systems that call for everything there is, in 2D and in 3D."""
    rows = {}
    for system in (everything(2), everything(3)):
        for name, engine in ENGINES.items():
            for s in engine.supports(system):
                rows.setdefault((s.effect, name, s.level, s.note), []).append(f"{system.dimension}D")
    return [
        {"effect": effect, "engine": name, "in": " ".join(where), "support": level, "note": note}
        for (effect, name, level, note), where in sorted(rows.items())
    ]


def everything(dimension: int) -> System:
    """Return a small system in which every effect is on: what the support table is asked about."""
    up = (0.0,) * (dimension - 1) + (1.0,)
    down, across = tuple(-u for u in up), (1.0, *(0.0,) * (dimension - 1))
    high = tuple(0.02 * u for u in up)
    zero = (0.0,) * dimension
    return System(
        dimension=dimension, particles=_two_bodies(dimension),
        walls=(
            Wall(index=1, name="floor", point=zero, normal=up, friction=True),
            Wall(index=2, name="lid", point=high, normal=down, friction=True,
                 motion=Loaded(mass=1.0, load=1.0, stress=0.0, span=None, damping=1.0)),
            Wall(index=3, name="piston", point=zero, normal=across, friction=False,
                 motion=Cosine(travel=1e-4, duration=1e-2)),
            Wall(index=4, name="belt", point=tuple(0.02 * a for a in across), normal=tuple(-a for a in across),
                 friction=True, motion=Constant(velocity=tuple(1e-2 * u for u in up))),
        ),
        normal=LinearNormal(normal_stiffness=1e5, normal_damping=0.1, attraction="clipped"),
        sliding=SpringSliding(shear_friction=0.5, shear_stiffness=2e4, shear_damping=0.025),
        background=Background(translational_drag=1e-3), gravity=tuple(-9.81 * u for u in up), periodic=None,
        dt=1e-7, steps=10, sample_every=10, frame_every=10, contacts=True,
    )


def _two_bodies(dimension: int) -> Particles:
    x = np.full((2, dimension), 5e-3)
    x[1, 0] += 2.5e-3
    return Particles(
        x=x, radius=np.full(2, 1e-3), mass=np.full(2, 1e-5), v=np.zeros((2, dimension)),
        inertia_factor=np.full(2, 0.5 if dimension == 2 else 0.4), spin=np.zeros((2, 1 if dimension == 2 else 3)),
    )
