"""What Debian's LIGGGHTS 3.8.0 computes wrongly. `tests/engines/liggghts/test_known_defects.py` shows each of them."""

from __future__ import annotations

from dataclasses import replace

from harness.engines.protocol import Defect

OPENING, SORTING, PERIODIC, LIMIT_FORCE = (
    "history outlives its contact", "plastic overlap lost by sorting", "plastic overlap lost at a periodic boundary",
    "adhesion dropped by default",
)
CUT_BY_OUTPUT, ROLLED_BY_OUTPUT, ROLLED_BY_SETUP = (
    "friction changed by contact output", "rolling changed by contact output", "rolling moved by the set-up",
)
FIXED_IN_SPACE, TORSION_OVERWRITES, LOST, TWICE = (
    "rolling couple fixed in space", "torsion and rolling share a memory", "lost particles not told",
    "mesh force counted twice",
)


def _of_this_version(*defects: Defect) -> tuple[Defect, ...]:
    return tuple(replace(d, evidence=f"{d.evidence} (3.8.0)") for d in defects)


DEFECTS: tuple[Defect, ...] = _of_this_version(
    Defect(
        name=OPENING, affects="laws with a memory: tangential history, tan_luding, epsd, luding, edinburgh",
        evidence="a pair that parts and soon meets again still has its old spring: 0.3 N where 0 is right",
        avoided="neigh_modify contact_distance_factor 1.01",
    ),
    Defect(
        name=SORTING, affects="normal model edinburgh, which keeps the largest overlap with a sign; also where a cut "
        "between two MPI processes comes between a pair",
        evidence="sorting that swaps a pair makes it negative, the contact loads anew: 1.5 N where 1 N is right",
        avoided="atom_modify sort 0 0; the constant-k_2 law is refused on several processes",
    ),
    Defect(
        name=PERIODIC, affects="normal model edinburgh, which keeps the largest overlap with a sign",
        evidence="a pair that sticks together crosses the boundary at 2 m/s and flies on at 4.4 m/s",
        avoided="the constant-k_2 law is unsupported with periodic axes",
    ),
    Defect(
        name=LIMIT_FORCE, affects="normal model edinburgh with fixKc",
        evidence="limitForce, on by default, sets every negative force to 0, where -0.5 N is right",
        avoided="limitForce off",
    ),
    Defect(
        name=CUT_BY_OUTPUT, affects="tangential model tan_luding",
        evidence="compute pair/gran/local cuts springs by full-step normal forces: spins 5e-4 off after one impact",
        avoided="with normal damping contact output is unsupported; without, the cut is the same one",
    ),
    Defect(
        name=ROLLED_BY_OUTPUT, affects="rolling model luding",
        evidence="compute pair/gran/local moves the spring on by one more step: spins 30 % off after one impact",
        avoided="contact output is unsupported with it",
    ),
    Defect(
        name=ROLLED_BY_SETUP, affects="rolling model luding",
        evidence="the set-up of a run moves the springs of touching particles on by one more step, too",
        avoided="particles that touch and spin at the start are unsupported with it",
    ),
    Defect(
        name=FIXED_IN_SPACE, affects="rolling models epsd, epsd2, epsd3, luding in 3D",
        evidence="when a pair turns as a rigid body, by 90 degrees, its rolling couple keeps its direction in space",
        avoided="not at all: rolling springs are partial in 3D",
    ),
    Defect(
        name=TORSION_OVERWRITES, affects="rolling model luding with torsion on",
        evidence="twisting wears the rolling couple down, by 13 % in the test: both are one vector with one limit",
        avoided="torsion resistance is unsupported",
    ),
    Defect(
        name=LOST, affects="runs with fixed boundaries",
        evidence="a particle that leaves the domain is dropped, with exit status 0",
        avoided="thermo_modify lost error, and atoms are counted at the end",
    ),
    Defect(
        name=TWICE, affects="fix mesh/surface/stress",
        evidence="after a second set-up the force on a mesh is twice what it should be",
        avoided="step 0 is halved in the deck",
    ),
)
