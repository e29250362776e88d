"""What in a watched run cannot be: bodies inside each other or through each other, energy out of nothing.

A remark says that the run cannot be trusted. No remark says only that nothing was found in the frames.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

OVERLAP = 0.5
"""Of the smaller radius. Contact laws are derived for overlaps that are small against it; shipped scenes stay below
0.05. Beyond 1 the centre of one body lies inside the other, or behind a wall."""

ENERGY, MOST_SWING = 0.01, 0.5
"""Of the largest energy of the run, beyond the error of the walls' work and the swing of the leapfrog. A motion of
frequency w keeps v^2/2 + w^2 x^2 (1 - (w dt/2)^2)/2, so that its energy swings by (dt/dt_max)^2 of itself at most,
dt_max = 2/w: 0.1 % at a fiftieth of a contact time, and nothing of it is left behind. Shipped scenes make 0.01 %."""


@dataclass(frozen=True, kw_only=True)
class Remark:
    """what, with its size in `unit`, beyond `limit`; at: when, s, None of a whole run. why: what that means."""

    what: str
    size: float
    limit: float
    unit: str
    at: float | None
    why: str

    @property
    def says(self) -> str:
        """All of it in one line."""
        unit = "" if self.unit == "1" else f" of the {self.unit}"
        when = "" if self.at is None else f" at {self.at:.3g} s"
        return f"{self.size:.3g} > {self.limit:.3g}{unit}{when}: {self.why}"


def remarks(
    time: np.ndarray, curves: dict[str, np.ndarray], *, passed: np.ndarray, made: float | None, work_error: float,
    step: float,
) -> tuple[Remark, ...]:
    """Return what is to be remarked of curves over the frames.

    passed: pairs that went through each other since the frame before, (F,). made, work_error: see `watch.Watch`, J.
    step: dt/dt_max.
    """
    found = [_passed(time, passed), _overlap(time, curves), _energy(curves, made, work_error, step)]
    return tuple(r for r in found if r is not None)


def largest_energy(curves: dict[str, np.ndarray]) -> float:
    """Return the largest energy that particles and contacts held or got, J.

    max(E_kin + E_rot + U_n + U_t) + max(U_g) - min(U_g) + max|W|; weight counts by its change, as its zero is anywhere.
    """
    held = [curves[name] for name in HELD if name in curves]
    weight, work = (curves.get(name, np.zeros(1)) for name in ("energy of weight", "work of walls"))
    return float(np.max(np.sum(held, axis=0), initial=0.0) + np.ptp(weight) + np.abs(work).max(initial=0.0))


HELD = ("kinetic energy", "rotational energy", "elastic energy, normal", "elastic energy, tangential")


def _passed(time: np.ndarray, passed: np.ndarray) -> Remark | None:
    if not passed.any():
        return None
    return Remark(
        what="pairs that passed through each other", size=float(passed.sum()), limit=0.0, unit="1",
        at=float(time[int(np.argmax(passed > 0))]), why="their order is reversed, as if they had not met",
    )


def _overlap(time: np.ndarray, curves: dict[str, np.ndarray]) -> Remark | None:
    overlap = curves.get("largest overlap", np.zeros(0))
    largest = float(overlap.max(initial=0.0))
    if not largest > OVERLAP:
        return None
    inside = "the centre of one body lies inside the other, or behind a wall"
    return Remark(
        what="largest overlap", size=largest, limit=OVERLAP, unit="smaller radius", at=float(time[np.argmax(overlap)]),
        why=inside if largest > 1.0 else "contact laws are of overlaps that are small against the radius",
    )


def _energy(curves: dict[str, np.ndarray], made: float | None, work_error: float, step: float) -> Remark | None:
    whole, limit = largest_energy(curves), ENERGY + min(step**2, MOST_SWING)
    if made is None or made <= work_error + limit * whole:
        return None
    return Remark(
        what="energy made", size=made / whole if whole > 0.0 else np.inf, limit=limit, at=None,
        unit="largest energy of the run",
        why="nothing did that work: the integration or the law made it",
    )
