"""What a scene wants to be judged by, kind by kind: the tables `[compare]`, which are never part of a run's hash."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from harness.scene.tables import NonNegative, Positive, Table


class Window(Table):
    """A declared pointwise check: up to `strain` two codes' top-wall forces differ by <= `tolerance`.

    `pairs` is "same_conventions" (an engine and the kernel in that engine's conventions, or two versions of it) or
    "codes" (LAMMPS and LIGGGHTS, each with its own).
    """

    pairs: Literal["same_conventions", "codes"]
    strain: Positive
    tolerance: Positive

    @property
    def limit(self) -> float:
        """Axial strain at which the window ends."""
        return self.strain

    @property
    def says(self) -> str:
        """What is followed, and how far."""
        return f"top-wall force up to {100 * self.strain:g} % strain"


FALSE_ALARMS = 0.05
"""Probability with which a report on codes that are equal says anywhere that they differ."""

MOST_PACKINGS = 1000
"""Of one comparison: an error bar over a thousand packings is 3 % of their spread; more is a slip."""


class Compare(Table):
    """What `grainproof compare` judges; never part of a run's hash.

    `packings` are made unless a command asks otherwise, `replicates` when it asks for replicates without a number. Over
    replicates quantities are judged that belong to the peak, to the `plateau` and to `strains`: with a probability of
    `false_alarms` any of equal codes is said to differ anywhere; codes agree whose difference is shown to be smaller
    than `margin` of the quantity (of a volume strain: of the axial strain).
    """

    packings: Annotated[int, Meta(ge=1, le=MOST_PACKINGS)] = 1
    replicates: Annotated[int, Meta(ge=2, le=MOST_PACKINGS)] | None = None
    false_alarms: Annotated[float, Meta(gt=0, le=0.5)] = FALSE_ALARMS
    margin: Annotated[float, Meta(gt=0, le=1)] = 0.05
    strains: tuple[Positive, ...] = ()
    windows: tuple[Window, ...] = ()
    plateau: Annotated[tuple[float, float], Meta(description="two numbers, a range of strains")] | None = None
    published: tuple[str, ...] = ()
    """Names of `reference/values/*.toml` that hold under this scene's conditions."""


class Agreement(Table):
    """A declared check of whole trajectories: largest difference of x, v, spin over their largest size.

    `pairs` as in `Window`.
    """

    pairs: Literal["same_conventions", "codes"]
    tolerance: Positive


class FreeCompare(Table):
    """What `grainproof compare` judges on a free scene; never part of a run's hash."""

    agreements: tuple[Agreement, ...] = ()


class TimeWindow(Table):
    """A declared pointwise check: up to `time` (s) two codes' torques on the inner ring differ by <= `tolerance`."""

    pairs: Literal["same_conventions", "codes"]
    time: Positive
    tolerance: Positive

    @property
    def limit(self) -> float:
        """Time at which the window ends, s."""
        return self.time

    @property
    def says(self) -> str:
        """What is followed, and how far."""
        return f"torque on the inner ring up to {self.time:g} s"


RING_MARGIN = 0.25
"""Of a profile's size or a number: how small a difference a comparison of rings must be able to see. A quarter is less
than the talk leaves open in the width of the band (1 to 2 diameters, a third either way), and what 0.5 % of area
fraction do to it (the published rings B and C, as recalled): with less than that two codes may not be called equal."""


class RingCompare(Table):
    """What `grainproof compare` judges on a ring; never part of a run's hash.

    Profiles are averages over the frames from `steady_from` (s) on, in `cells` concentric rings; `band` is the distance
    from the inner ring (m) up to which the velocity is fitted by v_0 exp(-(r - R_i)/s). `packings` and `replicates` as
    in `Compare`. With a probability of `false_alarms` anything is said to differ that does not: of equal codes any cell
    of any profile, any number, any mean over cells; of a run any balance; any width from the talk's. Codes agree in a
    profile in which no difference is seen where one of `margin` of its size would have been, and in a number whose
    difference is shown to be smaller than `margin` of it.
    """

    steady_from: NonNegative
    band: Positive
    cells: Annotated[int, Meta(ge=2, le=1000)] = 20
    false_alarms: Annotated[float, Meta(gt=0, le=0.5)] = FALSE_ALARMS
    margin: Annotated[float, Meta(gt=0, le=1)] = RING_MARGIN
    packings: Annotated[int, Meta(ge=1, le=MOST_PACKINGS)] = 1
    replicates: Annotated[int, Meta(ge=2, le=MOST_PACKINGS)] | None = None
    windows: tuple[TimeWindow, ...] = ()
