"""When a run is stopped, or not begun: what contact laws for small overlaps, or a scheme, cannot describe any more.

A centre inside another body. Laws push apart along the line of centres; behind the other centre that line points the
other way, so that bodies which got so far leave on the far side, with all energy and momentum kept: nothing but this
check would tell. Two centres in one place have no line at all. The same limit as for the centre behind a wall.

A leap. A body that moves further than half the smallest radius in one step may meet another and part from it again
before anybody looks. Its way through the step is then held against those of all other bodies::

    r(s) = r(0) + s (r(1) - r(0)),   0 <= s <= 1,   r = x_i - x_j

is shortest at s* = -r(0).(r(1) - r(0))/|r(1) - r(0)|^2. With 0 < s* < 1 and |r(s*)| < a_i + a_j they touched on the
way: unseen, if they do so at neither end, and through each other, if r(0).r(1) < 0. Bodies that leap through empty
space are left alone. At t_c/50 a head-on pair that fast would overlap by sixteen radii: no run that means anything is
stopped.

A spring that is felt late. The talks' algorithm feels tangential springs one step late (`laws.slider`): a swing of
frequency W grows by exp(W^2 (dt - gamma/k) t/2) while the contact sticks; W^2 = k (1/m + R^2/I) for one body that
slides at a wall, k R^2/I if it rolls or twists. A run in which the lightest body could gain more than MOST_GROWTH is
not begun. What packings, in which bodies have more contacts than one, and Mindlin's springs, whose stiffness nobody
knows beforehand, make of it is watched on the way (`late_springs`).
"""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.contact import Touching
from reference.kernel.laws.law import Law
from reference.kernel.model import Model
from reference.kernel.neighbours import branch_vectors
from reference.kernel.vectors import dot, norm

LONGEST_WAY = 0.5
"""Of the smallest radius: the longest way between two looks at the contacts, and in one step."""

MOST_GROWTH = 1.0
"""Exponent of what a late spring may make of a swing within a run."""


class KernelUnstable(Exception):
    """The run left what the laws can describe; the message says what and where."""


def longest_way(model: Model) -> float:
    """Return how far a body may move between two looks, m."""
    return LONGEST_WAY * min(float(r.min()) for r in (model.radius, *(ring.radius for ring in model.rings)))


def refuse_leaps(model: Model, before: np.ndarray, after: np.ndarray, radius: np.ndarray, step: int) -> None:
    """Raise KernelUnstable if a particle met another body within the last step and is past it now.

    before, after: places (dim, n) of all nodes a step apart; radius: (n,), m, 0 for walls.
    """
    way = norm((after - before)[:, : model.particle_count])
    for i in np.flatnonzero(way > longest_way(model)):
        j = _met_on_the_way(model, before, after, radius, i)
        if len(j):
            other = f"particle {j[0] + 1}" if j[0] < model.particle_count else "a glued disc"
            raise KernelUnstable(
                f"step {step}: particle {i + 1} moves {way[i] / radius[i]:.3g} of its radii in one step, through "
                f"{other}; take shorter steps or a lower speed"
            )


def _met_on_the_way(model: Model, before: np.ndarray, after: np.ndarray, radius: np.ndarray, i: int) -> np.ndarray:
    """Return the bodies that particle i touched within the step and at neither end, or went through."""
    others = np.flatnonzero(radius > 0.0)
    others = others[others != i]
    start = branch_vectors(model, before, np.full_like(others, i), others)
    moved = (after - before)[:, [i]] - (after - before)[:, others]
    square = dot(moved, moved)
    nearest = -dot(start, moved) / np.where(square > 0.0, square, 1.0)
    reach = radius[i] + radius[others]
    met = (nearest > 0.0) & (nearest < 1.0) & (norm(start + nearest * moved) < reach)
    unseen = (norm(start) >= reach) & (norm(start + moved) >= reach)
    return others[met & (unseen | (dot(start, start + moved) < 0.0))]


def refuse_centres_inside(
    model: Model, x: np.ndarray, radius: np.ndarray, i: np.ndarray, j: np.ndarray, step: int
) -> float:
    """Return the largest depth of pairs, -inf of none; raise KernelUnstable if a centre is inside the other body.

    The depth is the overlap less the smaller radius, m: from 0 on one body holds the other's centre.
    """
    if not len(i):
        return -np.inf
    found = radius[i] + radius[j] - norm(branch_vectors(model, x, i, j)) - np.minimum(radius[i], radius[j])
    k = int(np.argmax(found))
    if found[k] >= 0.0:
        other = f"particle {j[k] + 1}" if j[k] < model.particle_count else "a glued disc"
        raise KernelUnstable(
            f"step {step}: a centre of particle {i[k] + 1} and {other} lies inside the other body: too soft a contact "
            "for the speed or the load"
        )
    return float(found[k])


FAMILIES = {"sliding": "shear", "rolling": "rolling", "torsion": "torsion"}
"""Families that may have springs, and how the numbers of theirs begin."""


def own_spring(law: Law | None, family: str) -> tuple[float | np.ndarray, float | np.ndarray]:
    """Return stiffness, N/m, and damping, kg/s, of a law's spring; zeros where it has none, or none of its own.

    Of a law by pair of materials they are tables.
    """
    return tuple(getattr(law, f"{FAMILIES[family]}_{name}", 0.0) for name in ("stiffness", "damping"))


def friction_of(law: Law, family: str, contact: Touching) -> float | np.ndarray:
    """Return the coefficient of friction of contacts, one number or (M,), (-)."""
    return law.coefficient(contact) if family == "sliding" else getattr(law, f"{FAMILIES[family]}_friction")


def refuse_late_springs(model: Model, steps: int) -> None:
    """Raise KernelUnstable if springs that are felt a step late could make energy within so many steps."""
    for family in FAMILIES:
        growth = _late_growth(model, family, steps)
        if growth > MOST_GROWTH:
            raise KernelUnstable(
                f"step 0: the talks' algorithm feels the {family} spring one step late, and dt = {model.dt:.3g} s is "
                f"larger than its gamma/k: in {steps} steps a contact that sticks could swing up by exp({growth:.3g}); "
                "take more of its damping, a smaller step, or the kernel in another convention"
            )


def _late_growth(model: Model, family: str, steps: int) -> float:
    """Return W^2 (dt - gamma/k) t/2 of the lightest body; 0 of what is not felt late, or has no spring of its own.

    Of springs by pair of materials the one that grows fastest counts, whoever the lightest body touches.
    """
    law = getattr(model, family)
    stiffness, damping = own_spring(law, family)
    if getattr(law, "algorithm", None) != "talk" or not np.all(stiffness):
        return 0.0
    moved = 1.0 / model.mass if family == "sliding" else 0.0
    square = stiffness * float((moved + model.radius**2 / model.inertia).max())
    return float(np.max(0.5 * square * (model.dt - damping / stiffness) * model.dt * steps))
