"""Advice: the cheapest setting of a scene that keeps a quantity within a tolerance, and what it rests on.

    finished studies -> evidence -> all settings -> the cheapest that holds -> a scene
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

from harness.errors import InputError
from harness.scene.model import Scene
from harness.studies.advise.choose import Choice, best_known, choose, parts_of, spread_at
from harness.studies.advise.combine import Total, total
from harness.studies.advise.evidence import DECIDED, TOLD, Evidence, Rung
from harness.studies.advise.scene import advised_scene, can_run


@dataclass(frozen=True, kw_only=True)
class Advice:
    """choice: the advised setting, None if none keeps the tolerance; best: then the one with the smallest error.

    scene: the advised one, of `best` where there is no choice. declared: what the scene as declared would need on the
    engine of the answer: error and packings by `combine`. why: "" or why nothing keeps the tolerance. needed: packings
    in a study's ladders that would bring their noise down to it, None where that is not what is missing.
    """

    evidence: Evidence
    tolerance: float
    choice: Choice | None
    best: Choice | None
    scene: Scene | None
    declared: Total | None
    why: str
    needed: int | None

    @property
    def answer(self) -> Choice | None:
        """The advised setting, or the best known."""
        return self.choice or self.best

    @property
    def packings(self) -> int | None:
        """Packings that the user makes; of free scenes one run, of all phases."""
        if self.choice is not None:
            return self.choice.packings
        if self.best is None:
            return None
        return 1 if self.evidence.free else self.evidence.packings

    @property
    def below_floor(self) -> bool:
        """Whether one packing scatters by more than the tolerance."""
        spread = 0.0 if self.answer is None else self.answer.total.spread
        return spread > self.tolerance

    @property
    def declared_packings(self) -> int | None:
        """Packings that the scene as declared needs, None if no number does."""
        return None if self.declared is None else self.declared.packings_for(self.tolerance)

    @property
    def exit_status(self) -> int:
        """1 when no setting keeps the tolerance."""
        return 0 if self.choice is not None else 1


def advise(evidence: Evidence, tolerance: float) -> Advice:
    """Choose; raises InputError for evidence without a single ladder that has errors and times."""
    if not any(k in of for of in evidence.ladders.values() for k in DECIDED):
        raise InputError(
            file="--from", expected=f"a ladder of {', '.join(DECIDED)} with errors and times of {evidence.quantity}",
            got=f"none in {evidence.source}", fix="run grainproof accuracy with those knobs",
        )
    allowed = partial(can_run, evidence.scene, evidence.scene_file)
    choice = choose(evidence, tolerance, allowed)
    best = None if choice is not None else best_known(evidence, tolerance, allowed)
    answer = choice or best
    why, needed = ("", None) if choice is not None else _why_not(evidence, best, tolerance)
    return Advice(
        evidence=evidence, tolerance=tolerance, choice=choice, best=best, why=why, needed=needed,
        scene=None if answer is None else advised_scene(
            evidence.scene, evidence.scene_file, answer.settings, packings=answer.packings or evidence.packings
        ),
        declared=None if answer is None else declared_total(evidence, answer.engine),
    )


def declared_total(evidence: Evidence, engine: str) -> Total | None:
    """Return the error of the scene as declared, of the knobs that have their own setting on their ladder."""
    own = {k: la.own for k, la in evidence.ladders[engine].items() if k in DECIDED and la.own is not None}
    return total(parts_of(evidence, engine, own), spread_at(evidence, engine, own.get("size"))) if own else None


def told_errors(evidence: Evidence, engine: str) -> Mapping[str, Rung]:
    """Return the rungs, at the scene's own setting, of knobs whose error is told and not counted."""
    ladders = evidence.ladders.get(engine, {})
    return {k: ladders[k].own for k in TOLD if k in ladders and ladders[k].own is not None}


def _why_not(evidence: Evidence, best: Choice | None, tolerance: float) -> tuple[str, int | None]:
    """Say what stands in the way: errors that are seen, the noise of the ladders, or the user's own scatter."""
    if best is None:
        return "no measured setting makes a scene that can be run", None
    found = best.total
    if found.systematic >= tolerance:
        return (
            f"even the finest settings are off by {_percent(found.systematic)}, which stands out of the noise: climb "
            "further rungs", None
        )
    left = tolerance - found.systematic
    if found.noise >= left:
        return _floor(evidence, found.noise, left)
    return f"one packing scatters by {_percent(found.spread)}: more packings would be needed than there may be", None


def _floor(evidence: Evidence, noise: float, left: float) -> tuple[str, int]:
    """Say from how many packings errors are known too badly, and how many would do; of free scenes phases of the step.

    Boxes and rings need half of the variance for the packings of the answer; a free scene has none.
    """
    share, of = (1.0, "phases of the step") if evidence.free else (2.0, "packings")
    needed = math.ceil(share * evidence.packings * (noise / left) ** 2 * (1.0 - 1e-12))
    rest = "" if evidence.free else ", which leaves half of the variance to the packings of the answer"
    return (
        "the tolerance lies below the statistical floor of these ladders: errors of all knobs together are known to "
        f"{_percent(noise)} of the quantity from {evidence.packings} {of}; about {needed} in each ladder would bring "
        f"that down to {_percent(left / math.sqrt(share))}{rest}", needed
    )


def _percent(value: float) -> str:
    return f"{100.0 * value:.2g} %"
