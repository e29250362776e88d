"""What a hard case promises: invariants with tolerances, and how each code is known to end otherwise.

The table `expect` is for `grainproof stability`; it is never part of a run's hash, and all other commands leave it
aside. The names of invariants are those of `harness.studies.stability.invariants`.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from harness.scene.tables import Name, NonNegative, Positive, Table, Vector

Reason = Annotated[str, Meta(min_length=1, max_length=500, description="a text of up to 500 characters")]

Ending = Literal["stable", "degraded", "failed_loudly", "failed_silently", "refused", "unsupported"]
"""How a case can end on a code; the words are explained in `harness.studies.stability.judge`."""


class Twin(Table):
    """Another hard case that must do the same, its lengths and times multiplied by these scales.

    `shift` (m) is added to the twin's places, after they were scaled.
    """

    case: Name
    length_scale: Positive = 1.0
    time_scale: Positive = 1.0
    shift: Vector | None = None


class Invariant(Table):
    """Something that must hold, to `tolerance`, up to `until` (s; the whole run unless given), and why so far.

    Beyond `ruin` the answer means nothing any more; the invariant's own limit unless given. `values` are numbers that
    some invariants take: a closed form's, body by body.
    """

    name: Name
    tolerance: NonNegative
    reason: Reason
    until: Positive | None = None
    ruin: Positive | None = None
    values: tuple[float, ...] | None = None
    twin: Twin | None = None


class KnownOutcome(Table):
    """A code that is known to end otherwise than stable: what is seen, and why, with the evidence."""

    engine: Annotated[str, Meta(pattern=r"\A[a-z]+(:[a-z]+)?\Z", description='a code\'s name, as "lammps"')]
    outcome: Ending
    reason: Reason


class Expect(Table):
    """A hard case: the kinds of trouble it stands for, what must hold, and what is known to go wrong where.

    `refused` says that the scene itself must be turned down, and what the refusal has to name. A `long` case is run
    only when asked for.
    """

    topics: Annotated[tuple[Name, ...], Meta(min_length=1)]
    why: Reason
    invariants: tuple[Invariant, ...] = ()
    outcomes: tuple[KnownOutcome, ...] = ()
    refused: Reason | None = None
    long: bool = False
