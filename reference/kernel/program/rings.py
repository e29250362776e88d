"""Rings that turn, as nodes of a plane: all discs of a ring at once, in complex numbers."""

from __future__ import annotations

import cmath
from dataclasses import dataclass

import numpy as np

from reference.kernel.model import Model
from reference.kernel.program.nodes import Nodes
from reference.kernel.program.program import Program


@dataclass(frozen=True, kw_only=True)
class _Ring:
    """omega: rad/s. arms: (M,) conj(x - c) at time 0. centre: conj(c). q, c: (M,) of the nodes. work: (M,)."""

    omega: float
    arms: np.ndarray
    centre: complex
    q: np.ndarray
    c: np.ndarray
    work: np.ndarray

    def turn_to(self, time: float) -> None:
        """conj(r) = exp(-i omega t) conj(r_0);  q = conj(c) + conj(r);  c = i omega r."""
        np.multiply(self.arms, cmath.rect(1.0, -self.omega * time), out=self.work)
        np.add(self.work, self.centre, out=self.q)
        np.conjugate(self.work, out=self.work)
        np.multiply(self.work, 1j * self.omega, out=self.c)


class TurningRings:
    """Turns the glued discs among `nodes`. `step` counts; time is dt times it, so no error accumulates.

    They have their places and velocities at the end of the step when forces are computed: `model.Ring`. Only a plane
    has rings, so that nodes in space are never looked at.
    """

    def __init__(self, model: Model, nodes: Nodes):
        self.dt = model.dt
        self.step = 0
        self._rings = [
            _Ring(
                omega=ring.omega, arms=nodes.q[part] - complex(ring.centre[0], -ring.centre[1]),
                centre=complex(ring.centre[0], -ring.centre[1]), q=nodes.q[part], c=nodes.c[part],
                work=np.empty(len(ring.radius), complex))
            for ring, part in zip(model.rings, model.ring_nodes, strict=True) if ring.omega is not None
        ]

    def turn(self, p: Program) -> None:
        """Add what turns them in a step; nothing where no ring turns."""
        if self._rings:
            p.effect("turning rings")
            p.call("rings", self._move)

    def _move(self) -> None:
        self.step += 1
        for ring in self._rings:
            ring.turn_to(self.step * self.dt)
