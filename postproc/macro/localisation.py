"""How much of a sample takes part in its deformation, and where the band lies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.results import Unavailable


@dataclass(frozen=True, kw_only=True)
class Localisation:
    """Where a rate is concentrated among K cells.

    participation: (sum V g)^2/(sum V sum V g^2), the fraction of the volume that would carry the whole
        deformation evenly: 1 when uniform, V_band/V for a uniform band.
    half: smallest fraction of the volume that carries half of it: 1/2 when uniform.
    centre: (dim,) mean position, weighted by V g. spread: (dim,) standard deviations along the axes of
        the weighted covariance, largest first. direction: (dim,) unit vector along the largest, the
        band's own when spread[0] is clearly the largest; its last component that is not 0 is positive.
    """

    participation: float
    half: float
    centre: np.ndarray
    spread: np.ndarray
    direction: np.ndarray


def localisation(rate: np.ndarray, volumes: np.ndarray, positions: np.ndarray) -> Localisation | Unavailable:
    """Measure the localisation of `rate` (K,), for example the deviator of D or of a strain; any unit.

    Its sign does not matter. volumes: (K,). positions: (K, dim) middles of the cells. Cells whose rate is
    not known (NaN: empty) are left out, with their volume. Unavailable when nothing deforms.
    The participation ratio is that of localised modes: Bell and Dean, Discuss. Faraday Soc. 50, 55 (1970).
    """
    known = np.isfinite(rate)
    g, V, x = np.abs(rate[known]), volumes[known], positions[known]
    if not (V * g).sum() > 0:
        return Unavailable(reason=f"nothing deforms in {len(g)} cells")
    share = V * g / (V * g).sum()
    centre = share @ x
    variance, axes = np.linalg.eigh(np.einsum("k,ka,kb->ab", share, x - centre, x - centre))
    return Localisation(
        participation=float((V * g).sum() ** 2 / (V.sum() * (V * g**2).sum())),
        half=_smallest_fraction(share, g, V, 0.5),
        centre=centre, spread=np.sqrt(np.maximum(variance[::-1], 0.0)), direction=_upward(axes[:, -1]),
    )


def _smallest_fraction(share: np.ndarray, g: np.ndarray, V: np.ndarray, part: float) -> float:
    """Volume of the most active cells that together carry `part`, over the volume; the last one in part."""
    order = np.argsort(-g, kind="stable")
    carried = np.concatenate([[0.0], np.cumsum(share[order])])
    filled = np.concatenate([[0.0], np.cumsum(V[order])])
    return float(np.interp(part, carried, filled) / V.sum())


def _upward(axis: np.ndarray) -> np.ndarray:
    last = axis[np.flatnonzero(np.abs(axis) > 1e-12)[-1]]
    return axis * np.sign(last)
