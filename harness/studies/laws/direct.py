"""Codes against each other: what the difference of their conventions alone does, and that it is nothing else.

Two codes may both compute what their documentation says and still not the same. How far apart they are is measured in
the plain frame; it must be what the closed forms of the two conventions are apart, to rounding.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.registry import KERNEL_PREFIX, kernel_of
from harness.engines.word import code_of
from harness.scene.contact import ConstantRolling, MindlinSliding, SpringRolling, ViscousSliding
from harness.studies.compare.free import COLUMNS
from harness.studies.compare.growth import column_deviation, displacement_deviation
from harness.studies.laws import collisions
from harness.studies.laws.cases import TOLERANCE, Laws
from harness.studies.laws.deviations import apart, known, sizes_of
from harness.studies.laws.drive import Driven
from harness.studies.verdict import Check, Verdict
from reference.kernel.conventions import NAMED, Convention

if TYPE_CHECKING:
    from harness.studies.laws.stepped import Stepper
    from postproc.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class DirectCheck(Check):
    """A check of two codes against each other. tolerance: how far apart their conventions are by closed forms.

    laws, what: of the quantity. reasons: what the conventions differ in, in these laws. off: how far the difference is
    from that, relative: it must be rounding. None where a convention is not known.
    """

    laws: str
    what: str
    reasons: tuple[str, ...]
    off: float | None


def code_pairs(engines: Iterable[str]) -> list[tuple[str, str]]:
    """Return all pairs of engines that are not kernels."""
    return list(combinations([e for e in engines if not e.startswith(KERNEL_PREFIX)], 2))


def direct_checks(
    laws: Laws, left: Mapping[str, Driven], right: Mapping[str, Driven], stepper: Stepper, rerun: str
) -> list[DirectCheck]:
    """Return one check a motion of two codes' completed runs by part; the largest of the parts that both have."""
    parts = [(left[part], right[part]) for part in left if part in right]
    motions = dict.fromkeys(m for one, _ in parts for m in one.job.arrangement.motions)
    found = []
    for motion in motions:
        both = [(a, b) for a, b in parts if motion in a.job.arrangement.motions]
        sizes = [_difference(a, b, motion, stepper) for a, b in both]
        facts = {"level": "L0", "left": both[0][0].engine, "right": both[0][1].engine}
        found.append(_check(laws, motion, sizes, 2.0 * TOLERANCE, facts, rerun))
    return found


Size = tuple[float, float, float]
"""How far apart two codes are, how far their conventions, and the difference of the differences; NaN if unknown."""


def _difference(a: Driven, b: Driven, motion: str, stepper: Stepper) -> Size:
    place = a.job.arrangement
    plain = place.tracks_of(motion)[0]
    answers = [plain.local(run.reaction) for run in (a, b)]
    sizes = sizes_of(answers, place)
    size = apart(*answers, sizes)
    codes = [code_of(run.engine) for run in (a, b)]
    if not all(code in NAMED for code in codes):
        return size, float("nan"), float("nan")
    expected = [stepper.answers(place, motion, code)[plain.frame.name] for code in codes]
    expected = [known(x, e) for x, e in zip(answers, expected, strict=True)]
    differences = [[x - y for x, y in zip(*two, strict=True)] for two in (answers, expected)]
    return size, apart(*expected, sizes), apart(*differences, sizes)


def direct_collisions(
    laws: Laws, runs: Mapping[str, Trajectory], pair: tuple[str, str], rerun: str
) -> list[DirectCheck]:
    """Return the checks of two codes' whole collisions. runs: completed ones by engine, kernels among them."""
    if not all(code in runs for code in pair):
        return []
    kernels = [runs.get(kernel_of(code)) for code in pair]
    measured = _trajectories_apart(*(runs[code] for code in pair))
    expected = dict.fromkeys(measured, float("nan")) if None in kernels else _trajectories_apart(*kernels)
    facts = {"level": "L1", "left": pair[0], "right": pair[1]}
    return [
        _check(laws, f"collisions, {name}", [(size, expected[name], abs(size - expected[name]))],
               2.0 * collisions.TOLERANCE, facts, rerun)
        for name, size in measured.items()
    ]


def _trajectories_apart(a: Trajectory, b: Trajectory) -> dict[str, float]:
    sizes = {"displacement": displacement_deviation(a, b)}
    sizes |= {name: column_deviation(a, b, columns) for name, columns in COLUMNS.items()}
    return {name: size or 0.0 for name, size in sizes.items()}


def _check(laws: Laws, what: str, sizes: list[Size], room: float, facts: dict, rerun: str) -> DirectCheck:
    size, expected, off = (float(np.max(of)) for of in zip(*sizes, strict=True))
    known = [NAMED[code] for code in map(code_of, (facts["left"], facts["right"])) if code in NAMED]
    reasons = convention_differences(laws, *known)
    verdict = _verdict(size, off, room, known=len(known) == 2)
    why = {
        "agrees": "to rounding", "inconclusive": "what the conventions differ by is not known here",
        "known_difference": f"{'; '.join(reasons)}; {off:.1e} off what the conventions differ by",
        "differs": f"{off:.1e} off what the conventions differ by ({'; '.join(reasons) or 'nothing'}); rerun: {rerun}",
    }[verdict]
    return DirectCheck(
        **facts, quantity=f"{laws.name}: {what}", deviation=size, tolerance=None if np.isnan(expected) else expected,
        verdict=verdict, why=why, laws=laws.name, what=what, reasons=tuple(reasons), off=None if np.isnan(off) else off,
    )


def _verdict(size: float, off: float, room: float, *, known: bool) -> Verdict:
    """Equality is not enough where the conventions differ: codes must then differ by as much."""
    if not known or (np.isnan(off) and not np.isnan(size)):
        return "agrees" if size <= room else "inconclusive"
    if not off <= room:
        return "differs"
    return "agrees" if size <= room else "known_difference"


# --- why -------------------------------------------------------------------------------------------


def convention_differences(laws: Laws, *conventions: Convention) -> list[str]:
    """Return what distinguishes two conventions in these laws, "this / that"."""
    if len(conventions) != 2:
        return []
    return [
        f"{what}: {' / '.join(words.get(getattr(c, name), getattr(c, name)) for c in conventions)}"
        for name, what, words, concerns in CHOICES
        if concerns(laws) and len({getattr(c, name) for c in conventions}) == 2
    ]


ARM = {"radius": "R", "reduced": "R - overlap/2"}
CUT = {"lammps": "spring and dashpot together", "liggghts": "the spring alone, the dashpot comes on top"}
LIMIT = {"base": "|f_n + k_c overlap|", "total": "|f_n|"}
FRAME = {"contact": "with the contact", "space": "along axes fixed in space"}
SPIN = {"whole": "its spin", "raised": "its spin times (R - overlap/2)/(R - overlap)"}
COUPLE = {"talk": "f_n without dashpot", "liggghts": "the loading branch, and of the part that does not twist"}


def _slides(laws: Laws) -> bool:
    return laws.sliding is not None


def _slides_with_dashpot(laws: Laws) -> bool:
    law = laws.sliding
    return isinstance(law, MindlinSliding) or getattr(law, "shear_damping", 0.0) > 0.0 and not _drags(laws)


def _drags(laws: Laws) -> bool:
    return isinstance(laws.sliding, ViscousSliding)


def _drags_with_adhesion(laws: Laws) -> bool:
    return _drags(laws) and hasattr(laws.normal, "adhesion_stiffness")


def _rolls(laws: Laws) -> bool:
    return isinstance(laws.rolling, SpringRolling)


CHOICES = (
    ("slip_arm", "slip of pairs at", ARM, _slides),
    ("wall_slip_arm", "slip on planes at", ARM, _slides),
    ("wall_torque_arm", "lever of friction on planes", ARM, _slides),
    ("sliding", "Coulomb's limit cuts", CUT, _slides_with_dashpot),
    ("viscous_limit", "the limit is that of", LIMIT, _drags_with_adhesion),
    ("rolling", "the limit of rolling cuts", CUT, _rolls),
    ("rolling_frame", "the rolling spring is kept", FRAME, _rolls),
    ("wall_spin", "a body rolls on a plane with", SPIN, _rolls),
    ("constant_rolling", "the couple of constant size is of", COUPLE,
     lambda laws: isinstance(laws.rolling, ConstantRolling)),
)
"""Fields of a convention, what they are about, their words, and which laws they concern."""
