"""What the transcript of the talk shows of the measured contacts: axes and their titles, and no point of a curve.

From ends of axes bounds follow, if the curves stay within the axes and the law is the piecewise linear one. That is
all; they decide nothing.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Axes:
    """One figure: titles with units, largest tick of each axis in SI, and what follows from them."""

    figure: str
    x: str
    y: str
    x_end: float
    y_end: float
    follows: str


FIGURES = (
    Axes(
        figure="Contact force measurement (PIA), Fig. 6", x="Normalized load 0 to 0.8 mN/m",
        y="Normalized adhesion force 0 to 0.5 mN/m", x_end=0.8e-3, y_end=0.5e-3,
        follows="pull-off over load at the far end: k_c (k_2 - k_1)/(k_1 (k_2 + k_c)) <= {ratio:.3g}",
    ),
    Axes(
        figure="Hysteresis (plastic deformation), polystyrene", x="Force 0 to 250 nN",
        y="Deformation hysteresis -5 to 20 nm", x_end=250e-9, y_end=20e-9,
        follows="1/k_1 - 1/k_2 at most {ratio:.3g} m/N: k_1 k_2/(k_2 - k_1) >= {inverse:.3g} N/m",
    ),
    Axes(
        figure="Hysteresis (plastic deformation), borosilicate glass", x="Force 0 to 3000 nN",
        y="Deformation hysteresis -5 to 20 nm", x_end=3000e-9, y_end=20e-9,
        follows="1/k_1 - 1/k_2 at most {ratio:.3g} m/N: k_1 k_2/(k_2 - k_1) >= {inverse:.3g} N/m",
    ),
)


def axes_rows() -> list[dict]:
    """Return the table: what is seen, what is not, what would follow."""
    return [
        {
            "figure": a.figure, "seen: x axis": a.x, "seen: y axis": a.y, "not seen": "every point of the curve, its "
            "scatter, speeds, particle sizes", "would follow if the curve stays within the axes":
            a.follows.format(ratio=a.y_end / a.x_end, inverse=a.x_end / a.y_end), "decides": "nothing",
        }
        for a in FIGURES
    ]
