"""Tangential spring with Coulomb limit, in three named algorithms.

All share: spring elongation xi (dim, M) in the tangent plane, slip velocity v_t of i relative to j,
stiffness k_t, damping gamma_t, Coulomb coefficient mu, force on i f_t = -k_t xi - gamma_t v_t while
sticking. They differ in order, in what the limit is tested on, and in what sliding leaves behind.

`lammps`    turn and rescale xi, xi += v_t dt; test |f_t| > mu |f_n|; sliding: f_t to the limit,
            xi = -(f_t + gamma_t v_t)/k_t          (pair granular linear_history, as run)
`liggghts`  xi += v_t dt, then turn without rescaling; test k_t |xi| > mu |f_n| (no dashpot);
            sliding: xi to the limit, f_t = -k_t xi without dashpot   (tangential history, as run)
`talk`      turn and rescale xi; test force f_t = -k_t xi - gamma_t v_t; sticking: f_t, then
            xi += v_t dt; sliding: f_t to the limit, xi = -(f_t + gamma_t v_t)/k_t
            (S. Luding, Granular Matter 10, 235 (2008), section 2.3; limit mu max(f_n, 0))
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.kernel.vectors import dot, norm

LAMMPS_TURN_THRESHOLD = 1e-10
"""pair granular turns the spring only where k_t |xi.n| exceeds this times the Coulomb limit."""


@dataclass(frozen=True, kw_only=True)
class SpringSliding:
    """Coulomb friction with a tangential spring; `algorithm` as in the module docstring."""

    shear_friction: float
    shear_stiffness: float
    shear_damping: float
    algorithm: str

    def force(self, xi, n, v_t, f_n, dt, *, advance: bool) -> tuple[np.ndarray, np.ndarray]:
        """Return the force on i and the new spring, both (dim, M).

        With `advance` false time stands still: the spring is neither turned nor stretched nor cut
        (the evaluation at set-up and for output); the force keeps to the limit all the same.
        """
        return _ALGORITHMS[self.algorithm](self, xi, n, v_t, f_n, dt if advance else 0.0)

    def energy(self, xi: np.ndarray) -> np.ndarray:
        """Return the stored energy k_t xi^2 / 2, shape (M,), in J."""
        return 0.5 * self.shear_stiffness * dot(xi, xi)


def _lammps(law: SpringSliding, xi, n, v_t, f_n, dt):
    limit = law.shear_friction * np.abs(f_n)
    if not dt:
        return _lammps_set_up(law, xi, v_t, limit)
    along = dot(xi, n)
    turned = np.abs(along) * law.shear_stiffness > LAMMPS_TURN_THRESHOLD * limit
    xi = np.where(turned, _rescaled(xi - along * n, xi), xi) + dt * v_t
    force, slides = _limited(law, xi, v_t, limit)
    return force, np.where(slides, _spring_of(law, force, v_t), xi)


def _liggghts(law: SpringSliding, xi, n, v_t, f_n, dt):
    if dt:
        xi = xi + dt * v_t
        xi = xi - dot(xi, n) * n
    stretch = law.shear_stiffness * norm(xi)
    limit = law.shear_friction * np.abs(f_n)
    slides = stretch > limit
    cut = xi * _ratio(limit, stretch, slides)
    force = -law.shear_stiffness * cut
    force -= np.where(slides, 0.0, law.shear_damping) * v_t
    return force, (cut if dt else xi)


def _talk(law: SpringSliding, xi, n, v_t, f_n, dt):
    limit = law.shear_friction * np.maximum(f_n, 0.0)
    if not dt:
        return _limited(law, xi, v_t, limit)[0], xi
    xi = _rescaled(xi - dot(xi, n) * n, xi)
    force, slides = _limited(law, xi, v_t, limit)
    return force, np.where(slides, _spring_of(law, force, v_t), xi + dt * v_t)


_ALGORITHMS = {"lammps": _lammps, "liggghts": _liggghts, "talk": _talk}


def _limited(law: SpringSliding, xi, v_t, limit):
    """Return the test force cut to the limit, (dim, M), and where it was cut, (M,)."""
    test = -law.shear_stiffness * xi - law.shear_damping * v_t
    size = norm(test)
    slides = size > limit
    return test * _ratio(limit, size, slides), slides


def _lammps_set_up(law: SpringSliding, xi, v_t, limit):
    """Force without advancing; a sliding contact whose spring has no length yet gets none.

    That is pair granular's rule at set-up (as run): the direction of sliding is not known to it.
    """
    force, slides = _limited(law, xi, v_t, limit)
    return np.where(slides & ~xi.any(axis=0), 0.0, force), xi


def _spring_of(law: SpringSliding, force, v_t):
    """Return the spring that carries `force` together with the dashpot."""
    return -(force + law.shear_damping * v_t) / law.shear_stiffness


def _rescaled(turned: np.ndarray, old: np.ndarray) -> np.ndarray:
    """Give the turned spring the length of the old one; a spring turned to zero stays zero."""
    length = norm(turned)
    return turned * _ratio(norm(old), length, length > 0.0)


def _ratio(a: np.ndarray, b: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return a/b where `where` holds, 1 elsewhere."""
    return np.divide(a, b, out=np.ones_like(b), where=where)
