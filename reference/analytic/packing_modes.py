"""Vibrations of an actual packing: its stiffness matrix, its fastest mode, the largest stable step of the leapfrog.

Small motions about a state at rest obey M q'' = -K q - C q', with q = (u, phi), displacements and rotations of all
particles. A contact of unit normal n (from j to i), lever arms a_i, a_j and a* = a_i a_j/(a_i + a_j) deforms by

    D_n = n.(u_i - u_j)                                     normal
    D_t = (1 - n n)(u_i - u_j) - (a_i w_i + a_j w_j) x n    tangential, w = phi
    D_r = a* (1 - n n)(w_i - w_j)                           rolling
    D_o = a* n.(w_i - w_j)                                  torsion

and stores k_n D_n^2/2 + k_t D_t^2/2 + k_r D_r^2/2 + k_o D_o^2/2 - (f_n/r) |(1 - n n)(u_i - u_j)|^2/2: the last term
is that of a compressive force f_n that turns with its contact, r the distance of the centres (a plane does not turn
it). So K = sum_c B_c^T k_c B_c - ..., and C is the same sum with dashpots for springs. Partner -1 is fixed in space.

The leapfrog of the codes sees x(n) and v(n-1/2) in the forces of step n:

    v(n+1/2) = v(n-1/2) - dt M^-1 [K x(n) + C v(n-1/2)],      x(n+1) = x(n) + dt v(n+1/2)

x(n) = z^n phi gives (M (z - 1)^2 + dt^2 K z + dt C (z - 1)) phi = 0. From the left with the conjugate of phi this is a
real quadratic in z with m > 0, c >= 0; its roots lie in the unit circle if and only if c >= 0, k >= 0 and the value at
z = -1 is positive (Jury), for every phi if and only if

    4 M - 2 dt C - dt^2 K  is positive definite                  (the step below which nothing grows)

Without dashpots that is dt < 2/w_max. A spring that is felt one step late (`late`, K_l of K) acts as the dashpot
-dt K_l: C - dt K_l takes the place of C, and c >= 0 becomes a condition of its own. One spring alone is stable up to
dt = gamma/k, and at no step without a dashpot. The roots of one phi have the product 1 - dt c/m, and where c < 0 they
are complex below the limit of the step (k >= k_l). So nothing grows by more than

    |z|^2 <= 1 + dt lambda,     lambda the largest eigenvalue of M^-1 (dt K_l - C)

in a step, and a mode that no dashpot couples to others by just that: with one spring exp((dt - gamma/k) w^2 t/2).

Sources: the sum over contacts, e.g. S. Luding, Int. J. Solids Struct. 41, 5821 (2004); the force that turns with its
contact: S. Alexander, Phys. Rep. 296, 65 (1998), "initial stress"; the limit of the undamped leapfrog: R. D. Skeel,
BIT 33, 172 (1993). The damped limit is derived above. The tests hold it against lattices, against whole eigenvalue
problems and against forces differentiated numerically.

Valid while no contact opens, closes or slides, and for springs that are symmetric: the arm that a slip is measured
with is the arm of its torque.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

FIXED = -1
"""Second partner of a contact with something that does not move."""

DENSE = 120
"""Degrees of freedom up to which all eigenvalues are computed: safer than an iteration, and as fast."""

PRECISION, LATE_PRECISION = 1e-9, 1e-3
"""Relative, of the largest step of a damped packing, and of one with late springs."""

ROUNDING = 1e-6
"""By which free motions, twofold eigenvalues, seem to grow in a step."""

LEAST = 0.02
"""Of the limit without delay: a step at which late springs without a dashpot are seen to grow, far beyond ROUNDING."""


@dataclass(frozen=True, kw_only=True)
class Contacts:
    """M contacts. i, j: (M,) rows of the partners, j may be FIXED. normal: (M, dim), unit, from j to i.

    arm_i, arm_j: (M,) lever arms in m (that of a fixed partner does not count). reduced: (M,) a* in m.
    distance: (M,) of the centres in m, infinite at a plane.
    """

    i: np.ndarray
    j: np.ndarray
    normal: np.ndarray
    arm_i: np.ndarray
    arm_j: np.ndarray
    reduced: np.ndarray
    distance: np.ndarray

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.normal.shape[1]


@dataclass(frozen=True, kw_only=True)
class Elements:
    """Springs (N/m) or dashpots (kg/s) of the contacts, a number for all or (M,); None: there is none.

    pressing: the compressive forces (M,) in N that turn with their contacts; of springs only.
    """

    normal: float | np.ndarray | None = None
    tangential: float | np.ndarray | None = None
    rolling: float | np.ndarray | None = None
    torsion: float | np.ndarray | None = None
    pressing: np.ndarray | None = None

    @property
    def turns(self) -> bool:
        """Whether they know of rotations."""
        return not self.tangential is self.rolling is self.torsion is None


@dataclass(frozen=True, kw_only=True)
class Packing:
    """N particles on springs, with dashpots besides.

    mass, inertia: (N,) in kg, kg m^2. drag: f = -drag v on every particle, kg/s. late: those of the springs that are
    felt one step late (the tangential, rolling and torsion springs of the talks' algorithm), None: none.

    Raises ValueError for late springs that press, or are more than the springs that there are.

    >>> row = Contacts(i=np.array([0]), j=np.array([1]), normal=np.array([[1.0, 0.0]]), arm_i=np.ones(1),
    ...     arm_j=np.ones(1), reduced=np.full(1, 0.5), distance=np.full(1, 2.0))
    >>> pair = Packing(mass=np.ones(2), inertia=np.ones(2), contacts=row, springs=Elements(normal=1.0))
    >>> round(pair.largest_step(), 6)                       # 2/w, w^2 = 2 k/m
    1.414214
    """

    mass: np.ndarray
    inertia: np.ndarray
    contacts: Contacts
    springs: Elements
    dashpots: Elements = Elements()
    drag: float = 0.0
    late: Elements | None = None

    def __post_init__(self) -> None:
        if self.late is not None and (self.late.pressing is not None or self.late.turns > self.springs.turns):
            raise ValueError("late springs are some of the springs, and none of them presses")

    @property
    def turns(self) -> bool:
        """Whether rotations are degrees of freedom."""
        return self.springs.turns or self.dashpots.turns

    @property
    def inertias(self) -> np.ndarray:
        """Diagonal of M, (D,): of every particle its mass in all directions, then its moment of inertia."""
        spins = {2: 1, 3: 3}[self.contacts.dimension] if self.turns else 0
        columns = [self.mass] * self.contacts.dimension + [self.inertia] * spins
        return np.stack(columns, axis=1).ravel()

    def stiffness_matrix(self):
        """Return K, (D, D), as a sparse matrix; degrees of freedom are ordered particle by particle."""
        return self._matrix(self.springs)

    def damping_matrix(self):
        """Return C, (D, D), as a sparse matrix, with the drag."""
        import scipy.sparse as sparse

        moves = np.tile(np.arange(len(self.inertias) // len(self.mass)) < self.contacts.dimension, len(self.mass))
        return self._matrix(self.dashpots) + sparse.diags_array(self.drag * moves)

    def highest_frequency(self) -> float:
        """w_max, rad/s, without dashpots."""
        return math.sqrt(_largest_eigenvalue(self._scaled(self.stiffness_matrix())))

    def largest_step(self) -> float:
        """Return the step, s, at which 4 M - 2 dt C - dt^2 K ceases to be positive definite; infinite without forces.

        With late springs the same, with K - 2 K_l for K, where every late spring has a dashpot of at least dt k_l;
        else the step below which `growth` is 1, found by halving to LATE_PRECISION: 0 when motions grow at any step.
        """
        k, c = self._scaled(self.stiffness_matrix()), self._scaled(self.damping_matrix())
        if self.late is None:
            return _step_of(k, c)
        limit = _step_of(k - 2 * self._scaled(self._matrix(self.late)), c)
        if self._dashpots_hold(limit):
            return limit
        return self._largest_late_step(limit if math.isfinite(limit) else _step_of(k, c))

    def _dashpots_hold(self, step: float) -> bool:
        """Whether C - dt K_l >= 0 contact by contact."""
        families = ((getattr(e, f) for e in (self.dashpots, self.late)) for f in ("tangential", "rolling", "torsion"))
        return all(late is None or np.all((0.0 if held is None else held) >= step * late) for held, late in families)

    def growth(self, step: float) -> float:
        """Return the largest |z|, (-): by what factor the fastest growing motion grows in a step; 1 is stable.

        From all 2 D eigenvalues of the map (x(n), dt v(n-1/2)) -> (x(n+1), dt v(n+1/2)); for small packings. Free
        motions (|z| = 1, twofold) make it 1 + 1e-7 by rounding.
        """
        k, c = (self._scaled(m).toarray() for m in (self.stiffness_matrix(), self.damping_matrix()))
        if self.late is not None:
            c = c - step * self._scaled(self._matrix(self.late)).toarray()
        one = np.eye(len(k))
        kicked, carried = -(step**2) * k, one - step * c
        return float(np.abs(np.linalg.eigvals(np.block([[one + kicked, carried], [kicked, carried]]))).max())

    def late_growth(self, step: float) -> float:
        """Return what no |z|, (-), exceeds in a step below the limit: sqrt(1 + dt lambda); 1 where nothing can grow.

        Of late springs and dashpots alone, from one eigenvalue, for packings of any size.
        """
        late = step * self._matrix(self.late) if self.late is not None else 0.0 * self.damping_matrix()
        return math.sqrt(1 + step * _largest_eigenvalue(self._scaled(late - self.damping_matrix())))

    def _largest_late_step(self, high: float) -> float:
        """Halve the way between a step at which nothing grows and one at which something does."""
        low = LEAST * high
        if self.growth(low) > 1 + ROUNDING:
            return 0.0
        while high - low > LATE_PRECISION * high:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self.growth(middle) > 1 + ROUNDING else (middle, high)
        return low

    def _scaled(self, matrix):
        """M^-1/2 A M^-1/2."""
        import scipy.sparse as sparse

        root = sparse.diags_array(1 / np.sqrt(self.inertias))
        return (root @ matrix @ root).tocsr()

    def _matrix(self, elements: Elements):
        import scipy.sparse as sparse

        size = len(self.inertias)
        total = sparse.csr_array((size, size))
        deformations = {"normal": _normal, "tangential": _tangential, "rolling": _rolling, "torsion": _torsion}
        for family, deformation in deformations.items():
            strength = getattr(elements, family)
            if strength is not None:
                total = total + self._summed(strength, deformation(self.contacts, _tangents(self.contacts.normal)))
        if elements.pressing is not None:
            total = total - self._summed(elements.pressing / self.contacts.distance, _sideways(self.contacts))
        return total

    def _summed(self, strength: float | np.ndarray, rows: list[tuple]):
        """sum_c s_c B_c^T B_c; rows: of every component of the deformation what it takes of u_i, u_j, w_i, w_j."""
        import scipy.sparse as sparse

        c, of_each = self.contacts, len(self.inertias) // len(self.mass)
        total, count = sparse.csr_array((len(self.inertias),) * 2), len(c.i)
        strength = np.broadcast_to(np.asarray(strength, float), (count,))
        for parts in rows:
            where, what = [], []
            for node, first, values in ((c.i, 0, parts[0]), (c.j, 0, parts[1]), (c.i, c.dimension, parts[2]),
                                        (c.j, c.dimension, parts[3])):
                for axis, column in enumerate([] if values is None else values.T):
                    where.append(of_each * node + first + axis)
                    what.append(np.where(node == FIXED, 0.0, column))
            at = np.where(np.array(what) == 0.0, 0, np.array(where)).ravel()
            rows_at = np.tile(np.arange(count), len(what))
            b = sparse.coo_array((np.concatenate(what), (rows_at, at)), shape=(count, len(self.inertias))).tocsr()
            total = total + b.T @ sparse.diags_array(strength) @ b
        return total


def _tangents(normal: np.ndarray) -> list[np.ndarray]:
    """One unit tangent (M, 2) in 2D; two in 3D, (t1, t2, n) right-handed."""
    if normal.shape[1] == 2:
        return [np.stack([-normal[:, 1], normal[:, 0]], axis=1)]
    least = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    first = np.cross(normal, least)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return [first, np.cross(normal, first)]


def _turning(normal: np.ndarray, tangents: list[np.ndarray]) -> list[np.ndarray]:
    """What (w x n).t takes of w for each tangent t: n x t; in 2D, with t = e_z x n, simply w."""
    if normal.shape[1] == 2:
        return [np.ones((len(normal), 1))]
    return [np.cross(normal, t) for t in tangents]


def _normal(c: Contacts, _: list[np.ndarray]) -> list[tuple]:
    return [(c.normal, -c.normal, None, None)]


def _sideways(c: Contacts) -> list[tuple]:
    return [(t, -t, None, None) for t in _tangents(c.normal)]


def _tangential(c: Contacts, tangents: list[np.ndarray]) -> list[tuple]:
    turns = _turning(c.normal, tangents)
    return [(t, -t, -c.arm_i[:, None] * w, -c.arm_j[:, None] * w) for t, w in zip(tangents, turns, strict=True)]


def _rolling(c: Contacts, tangents: list[np.ndarray]) -> list[tuple]:
    arm = c.reduced[:, None]
    axes = [np.ones((len(c.i), 1))] if c.dimension == 2 else tangents
    return [(None, None, arm * t, -arm * t) for t in axes]


def _torsion(c: Contacts, _: list[np.ndarray]) -> list[tuple]:
    return [(None, None, c.reduced[:, None] * c.normal, -c.reduced[:, None] * c.normal)]


def _step_of(k, c) -> float:
    """Return the dt at which the largest eigenvalue of dt^2 K + 2 dt C is 4; all over the masses.

    It lies between the limit of both largest eigenvalues in one motion, and those of each alone.
    """
    from scipy.optimize import brentq

    square, rate = _largest_eigenvalue(k), _largest_eigenvalue(c)
    if not square and not rate:
        return math.inf
    low = 4 / (rate + math.hypot(rate, 2 * math.sqrt(square)))
    high = 2 / math.sqrt(square) if square else 2 / rate
    if high <= low * (1 + PRECISION):
        return low
    return brentq(lambda dt: _largest_eigenvalue(dt**2 * k + 2 * dt * c) - 4, low * (1 - PRECISION),
                  high * (1 + PRECISION), rtol=PRECISION)


def _largest_eigenvalue(matrix) -> float:
    """Of a symmetric matrix, not below 0."""
    from scipy.sparse import linalg

    if matrix.nnz == 0:
        return 0.0
    if matrix.shape[0] <= DENSE:
        return max(float(np.linalg.eigvalsh(matrix.toarray())[-1]), 0.0)
    start = np.random.default_rng(0).normal(size=matrix.shape[0])
    return max(float(linalg.eigsh(matrix, k=1, which="LA", v0=start, tol=1e-10, return_eigenvectors=False)[0]), 0.0)
