"""Frictionless packings by minimising the enthalpy, with the kernel's own forces.

H = sum k_n delta^2 / 2 + p L_x L_y, over all positions and the places of two walls, by FIRE (Bitzek
et al., Phys. Rev. Lett. 97, 170201 (2006), with the semi-implicit step of Guenole et al., Comput.
Mater. Sci. 175, 109584 (2020)). The result is what a slow, frictionless, damped compression
tends to: forces in balance, both walls at pressure p, no velocity, no history.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.kernel.conventions import TALK
from reference.kernel.laws.linear import LinearNormal
from reference.kernel.model import Model, Wall
from reference.kernel.simulation import KernelUnstable, Simulation
from reference.kernel.vectors import norm


@dataclass(frozen=True, kw_only=True)
class Relaxed:
    """A packing in balance. x: (2, N); box: (L_x, L_y); residual: largest net force on a particle or
    wall over the mean contact force; contacts: their number; iterations: force evaluations used."""

    x: np.ndarray
    box: tuple[float, float]
    residual: float
    contacts: int
    iterations: int


class NotRelaxed(Exception):
    """The packing did not reach its residual tolerance; the message says how far it came."""


def relax_in_box(x, radius, box, *, stiffness, pressure, tolerance, max_iterations=200_000) -> Relaxed:
    """Return the packing at rest in a box with four walls, of which right and top obey `pressure`.

    x: (2, N) start positions inside (0, L_x) x (0, L_y); pressure in N/m (2D); with pressure 0 the
    box keeps its size and the tolerance is taken relative to `stiffness` times the mean radius.
    Raises NotRelaxed.
    """
    try:
        with np.errstate(invalid="ignore"):  # a NaN, from centres in one place, ends as NotRelaxed
            return _minimised(_frictionless(x, radius, box, stiffness), pressure, tolerance, max_iterations)
    except KernelUnstable as reason:
        raise NotRelaxed(str(reason)) from reason


def _minimised(model: Model, pressure: float, tolerance: float, max_iterations: int) -> Relaxed:
    system = _Enthalpy(Simulation(model), pressure)
    radius, stiffness = model.radius, model.normal.normal_stiffness
    scale = stiffness * float(radius.mean()) if pressure == 0 else None
    fire = _Fire(system.size)
    largest_step = 0.1 * float(radius.min())
    for iteration in range(max_iterations):
        force = system.force()
        if iteration % 20 == 0:
            residual, contacts = system.residual(scale)
            if residual < tolerance and (contacts or pressure == 0):
                return Relaxed(x=system.positions(), box=system.box(), residual=residual, contacts=contacts,
                               iterations=iteration + 1)
        system.move(_capped(fire.displacement(force), largest_step))
    raise NotRelaxed(f"residual {residual:.3g} of the mean contact force after {max_iterations} iterations, "
                     f"wanted {tolerance:g}")


def _frictionless(x, radius, box, stiffness) -> Model:
    """Elastic discs of unit mass: FIRE needs forces only."""
    n = len(radius)
    planes = (("left", (0.0, 0.0), (1.0, 0.0)), ("bottom", (0.0, 0.0), (0.0, 1.0)),
              ("right", (box[0], 0.0), (-1.0, 0.0)), ("top", (0.0, box[1]), (0.0, -1.0)))
    return Model(
        x=x.copy(), v=np.zeros((2, n)), spin=np.zeros((1, n)), radius=radius, mass=np.ones(n),
        inertia=np.ones(n), dt=1.0, convention=TALK, sliding=None,
        walls=tuple(Wall(name=a, point=b, normal=c, friction=False) for a, b, c in planes),
        normal=LinearNormal(normal_stiffness=stiffness, normal_damping=0.0, attraction="allowed"),
    )


def _capped(step: np.ndarray, largest: float) -> np.ndarray:
    """Shorten a step in which something would move further than `largest`: deep first overlaps."""
    furthest = float(np.abs(step).max())
    return step if furthest <= largest else step * (largest / furthest)


class _Enthalpy:
    """Generalised coordinates [x_1.., y_1.., L_x, L_y] and forces -dH/dq, in units of the stiffness.

    The walls count as sqrt(N) discs each, which is the number of discs that they push.
    """

    def __init__(self, simulation: Simulation, pressure: float):
        self.s = simulation
        self.pressure = pressure
        self.n = simulation.model.particle_count
        self.size = 2 * self.n + (2 if pressure else 0)
        self.unit = 1.0 / simulation.model.normal.normal_stiffness
        self.wall_share = self.n**-0.25

    def force(self) -> np.ndarray:
        self.s.renew_candidates()
        self.s.evaluate(advance=False)
        grains = self.s.state.force[:, : self.n].ravel()
        if not self.pressure:
            return grains * self.unit
        return np.concatenate([grains, self.wall_share * self._wall_force()]) * self.unit

    def _wall_force(self) -> np.ndarray:
        lx, ly = self.box()
        outwards = self.s.state.wall_force
        return np.array([outwards[0, 2] - self.pressure * ly, outwards[1, 3] - self.pressure * lx])

    def move(self, step: np.ndarray) -> None:
        self.s.state.x[:, : self.n] += step[: 2 * self.n].reshape(2, self.n)
        if self.pressure:
            self.s.state.x[0, self.n + 2] += self.wall_share * step[-2]
            self.s.state.x[1, self.n + 3] += self.wall_share * step[-1]

    def residual(self, scale: float | None) -> tuple[float, int]:
        """Largest net force over the mean contact force (or over `scale`), and the contact count."""
        forces = [f for _, f in self.s.contacts()]
        sizes = np.concatenate([f.f_n for f in forces])
        worst = float(norm(self.s.state.force[:, : self.n]).max())
        if self.pressure:
            worst = max(worst, float(np.abs(self._wall_force()).max()))
        if scale is not None:
            return worst / scale, len(sizes)
        return (worst / float(sizes.mean()) if len(sizes) else np.inf), len(sizes)

    def positions(self) -> np.ndarray:
        return self.s.state.x[:, : self.n].copy()

    def box(self) -> tuple[float, float]:
        return float(self.s.state.x[0, self.n + 2]), float(self.s.state.x[1, self.n + 3])


class _Fire:
    """FIRE in units m = k = 1: velocity steered towards the force, stopped when going uphill."""

    start_dt, max_dt, grow, shrink, start_mix, mix_decay, delay = 0.1, 0.6, 1.1, 0.5, 0.1, 0.99, 5

    def __init__(self, size: int):
        self.v = np.zeros(size)
        self.dt, self.mix, self.downhill = self.start_dt, self.start_mix, 0

    def displacement(self, force: np.ndarray) -> np.ndarray:
        if _inner(self.v, force) > 0.0:
            self.downhill += 1
            if self.downhill > self.delay:
                self.dt = min(self.dt * self.grow, self.max_dt)
                self.mix *= self.mix_decay
        else:
            self.v[:] = 0.0
            self.dt, self.mix, self.downhill = self.dt * self.shrink, self.start_mix, 0
            self.dt = max(self.dt, 1e-3)
        self.v += self.dt * force
        size = float(np.sqrt(_inner(force, force)))
        if size > 0.0:
            speed = float(np.sqrt(_inner(self.v, self.v)))
            self.v = (1.0 - self.mix) * self.v + (self.mix * speed / size) * force
        return self.dt * self.v


def _inner(a: np.ndarray, b: np.ndarray) -> float:
    """Inner product by elementwise arithmetic and pairwise sums: the same bits on every machine."""
    return float((a * b).sum())
