"""The two constitutive models of the second talk, evaluated on measured fields, with residuals (2D).

What the slides ("Constitutive model - no rotations", "... with rotations") leave legible: isotropic stress from
isotropic deformation with a bulk stiffness E that depends on the fabric, deviatoric stress from deviatoric
deformation with a shear stiffness G along a unit-deviator operator D = R^T diag(1, -1) R of given orientation, and with
rotations an asymmetric stress from the sliding component omega* (sliding stiffness S) and the rolling
component omega** (rolling stiffness R) of the eigen-rotations::

    sigma = E(F) eps_V 1 + G(F) eps_D D(phi) + (S omega* + R omega**) A,    A = (0 1; -1 0)

What the transcript leaves open, and what is done here:

- a case distinction of E ("for ... else ..."): E and G are linear in tr F, E = E_0 + E_1 tr F, without a threshold;
- whose orientation phi is (strain, fabric or stress): an argument, so that residuals can be compared;
- in which part of the stress rolling acts ("Stress changes ???"): the asymmetric one;
- increments or totals: the functions do not know; pass stress with elastic strain, or their increments
  (a stress rate with rates of strain in the compression positive sign).

The stiffnesses are fitted to the cells (linear least squares); their errors come from the scatter over cells.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from postproc.macro.axial import axial
from postproc.macro.fits.least_squares import Parameter
from postproc.macro.tensors import principal
from postproc.results import Unavailable

ORIENTATIONS = ("strain", "fabric", "stress")


@dataclass(frozen=True, kw_only=True)
class Measured:
    """Fields of K cells, 2D: stress, elastic strain (both compression positive) and fabric, (K, 2, 2).

    sliding, rolling: omega*, omega** (K,), for the model with rotations: `eigen_rotations`, or in totals the
    antisymmetric part of the elastic strain and a component of the elastic curvature times a length.
    """

    stress: np.ndarray
    strain: np.ndarray
    fabric: np.ndarray
    sliding: np.ndarray | None = None
    rolling: np.ndarray | None = None


@dataclass(frozen=True, kw_only=True)
class Evaluated:
    """A model with its stiffnesses and what it misses.

    stiffnesses: E_0, E_1, G_0, G_1[, S, R] in the unit of stress over deformation. predicted: (K, 2, 2).
    residual: measured - predicted, (K, 2, 2), NaN for cells that were left out. missed: norm of the residual over
    that of the stress, by part: "isotropic", "deviatoric", "asymmetric" and "all" (Frobenius, over cells), so
    that 0 is a perfect model, and 1 one that says nothing. The asymmetric part of a model without rotations is 1.
    cells: how many were used.
    """

    stiffnesses: Mapping[str, Parameter]
    predicted: np.ndarray
    residual: np.ndarray
    missed: Mapping[str, float]
    cells: int


def no_rotations(measured: Measured, orientation: str = "strain") -> Evaluated | Unavailable:
    """sigma = E(F) eps_V 1 + G(F) eps_D D(phi): symmetric, fitted to the cells that have all fields.

    orientation: whose major direction phi is. Raises ValueError for an unknown one; Unavailable with fewer
    than three such cells or when the stiffnesses are not determined (all cells with one tr F).
    """
    return _evaluate(measured, orientation, rotations=False)


def with_rotations(measured: Measured, orientation: str = "strain") -> Evaluated | Unavailable:
    """The same and (S omega* + R omega**) A in the asymmetric part. Raises ValueError without rotations measured."""
    if measured.sliding is None or measured.rolling is None:
        raise ValueError("measured: expected sliding and rolling rotations, got none")
    return _evaluate(measured, orientation, rotations=True)


def unit_deviator(direction: np.ndarray) -> np.ndarray:
    """D = R^T diag(1, -1) R = 2 n n - 1 of directions n (K, 2): (K, 2, 2)."""
    return 2.0 * direction[:, :, None] * direction[:, None, :] - np.eye(direction.shape[1])


ASYMMETRIC = np.array([[0.0, 1.0], [-1.0, 0.0]])
"""A: the stress whose antisymmetric number (sigma_12 - sigma_21)/2 is 1."""


def _evaluate(measured: Measured, orientation: str, *, rotations: bool) -> Evaluated | Unavailable:
    if orientation not in ORIENTATIONS:
        raise ValueError(f"orientation: expected one of {', '.join(ORIENTATIONS)}, got {orientation!r}")
    strain, stress = principal(measured.strain), principal(measured.stress)
    D = unit_deviator(principal(getattr(measured, orientation)).major)
    trace = np.trace(measured.fabric, axis1=1, axis2=2)
    by_fabric = np.stack([np.ones_like(trace), trace], axis=1)
    parts = {
        ("E_0", "E_1"): (strain.isotropic[:, None] * by_fabric, stress.isotropic, np.eye(2)),
        ("G_0", "G_1"): (strain.deviator[:, None] * by_fabric, (measured.stress * D).sum(axis=(1, 2)) / 2.0, D),
    }
    if rotations:
        turned = np.stack([measured.sliding, measured.rolling], axis=1)
        parts["S", "R"] = (turned, axial(measured.stress), ASYMMETRIC)
    known = np.isfinite(measured.stress).all(axis=(1, 2))
    for design, value, _ in parts.values():
        known &= np.isfinite(design).all(axis=1) & np.isfinite(value)
    return _fitted(measured, parts, known)


def _fitted(measured: Measured, parts: Mapping, known: np.ndarray) -> Evaluated | Unavailable:
    predicted = np.zeros(measured.stress.shape)
    stiffnesses: dict[str, Parameter] = {}
    for names, (design, value, basis) in parts.items():
        found = _linear(design[known], value[known])
        if found is None:
            return Unavailable(reason=f"{known.sum()} cells with all fields do not determine {' and '.join(names)}")
        stiffnesses |= dict(zip(names, found, strict=True))
        amplitude = design @ [estimate.value for estimate in found]
        predicted += amplitude[:, None, None] * basis
    predicted[~known] = np.nan
    residual = measured.stress - predicted
    return Evaluated(
        stiffnesses=stiffnesses, predicted=predicted, residual=residual,
        missed=_missed(residual[known], measured.stress[known]), cells=int(known.sum()),
    )


def _linear(design: np.ndarray, value: np.ndarray) -> list[Parameter] | None:
    """Least squares value = design . coefficients, with errors from the scatter; None when not determined."""
    rows, columns = design.shape
    size = np.linalg.norm(design, axis=0)
    if rows <= columns or not (size > 0).all() or np.linalg.matrix_rank(design / size) < columns:
        return None
    found = np.linalg.lstsq(design / size, value, rcond=None)[0] / size
    scatter = ((value - design @ found) ** 2).sum() / (rows - columns)
    covariance = scatter * np.linalg.inv((design / size).T @ (design / size)) / np.outer(size, size)
    return [Parameter(value=float(v), error=float(np.sqrt(c))) for v, c in zip(found, np.diag(covariance), strict=True)]


def _missed(residual: np.ndarray, stress: np.ndarray) -> dict[str, float]:
    """Norm of the residual over that of the stress by part; NaN for a part that the stress does not have."""
    shares = {}
    with np.errstate(invalid="ignore", divide="ignore"):
        for name, part in PARTS.items():
            shares[name] = float(np.linalg.norm(part(residual)) / np.linalg.norm(part(stress)))
    return shares


def _symmetric(T: np.ndarray) -> np.ndarray:
    return (T + T.swapaxes(1, 2)) / 2.0


def _isotropic(T: np.ndarray) -> np.ndarray:
    return np.trace(T, axis1=1, axis2=2)[:, None, None] / 2.0 * np.eye(2)


PARTS = {
    "isotropic": _isotropic,
    "deviatoric": lambda T: _symmetric(T) - _isotropic(T),
    "asymmetric": lambda T: T - _symmetric(T),
    "all": lambda T: T,
}
