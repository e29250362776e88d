"""An advice put to the test: the advised scene is run as it is, all knobs turned at once, and held against a reference.

Advice is made of ladders that were climbed one knob at a time. So here

    box, ring   the advised setting, effects left out, and every knob that advice turns at its finest good rung at once,
                all effects on; on the advised engine, from as many packings as advised, the same for both
    free        the advised step at other phases than the ladder's, against the oracle of the scene as declared

Runs, packings, oracles and times are kept below `out` by their content, and are never made twice. The finest setting is
not the limit: what it is expected to be off itself, by the same ladders, is told beside the verdict.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.registry import choose_engines, find_engine
from harness.errors import InputError
from harness.runs.pool import Done
from harness.scene.judged import MOST_PACKINGS
from harness.studies.accuracy.bulk import measure_settings, run_settings
from harness.studies.accuracy.bulk_plan import Setting, lean, pack_settings
from harness.studies.accuracy.bulk_result import Rung as Ran
from harness.studies.accuracy.bulk_rungs import Key, Measured, rung_of, settled
from harness.studies.accuracy.shaken import UNJUDGED, why_shaken
from harness.studies.advise.choose import Choice, choice_of
from harness.studies.advise.evidence import Evidence, KnobLadder, Rung
from harness.studies.advise.scene import Settings, advised_scene, why_not_run
from harness.studies.advise.study import Advice
from harness.studies.advise.verification import (
    Side,
    Verification,
    difference_of,
    mean_and_error,
    verdict_of,
)
from harness.studies.advise.verify_free import verify_free
from harness.studies.statistics.difference import FEWEST, Difference

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

ADVISED, REFERENCE = "as advised", "at their finest"
"""Settings of all knobs."""

AS_ADVISED = 0
"""Number of packings that a command names when it names none."""


def verify(
    advice: Advice, engine: Engine, out: Path, *, packings: int | None, time_limit: float, workers: int | None,
    progress: Callable[[], Progress] | None,
) -> Verification:
    """Run what an advice with a choice says, and the reference; see the module. packings: None for the advised number.
    """
    options = {"time_limit": time_limit, "workers": workers, "progress": progress}
    if advice.evidence.free:
        return verify_free(advice, engine, out, **options)
    settings, count = settings_of(advice), packing_count(advice, packings)
    able = [s for s in settings if not s.reason]
    planned = pack_settings(
        able, advice.evidence.scene_file, count, out / "packings", workers=workers, progress=progress
    )
    done = run_settings(planned, [engine], out, **options)
    filled = {s.label: s for s in (*settings, *planned.settings)}
    return _judged(advice, engine, count, filled, done, measure_settings(planned, done))


def verified_packings(asked: int | None, *, free: bool) -> int | None:
    """Return how many packings a command asks for, None for as many as advised. Raises InputError."""
    if asked in (None, AS_ADVISED):
        return None
    if free:
        raise InputError(
            file="--verify", expected="no number for this kind of scene", got=asked,
            fix="it has as many phases of the step as the study",
        )
    if not FEWEST <= asked <= MOST_PACKINGS:
        raise InputError(
            file="--verify", expected=f"a number of packings from {FEWEST} to {MOST_PACKINGS}", got=asked,
            fix="the spread over packings is the error bar",
        )
    return asked


def packing_count(advice: Advice, packings: int | None) -> int:
    """Return how many packings are run: as many as asked for or advised, two at least, as one has no error bar."""
    return packings or max(FEWEST, advice.choice.packings)


def engine_for(name: str, words: Sequence[str] | None) -> Engine:
    """Return the engine that the studies call `name`. words: engines as the user typed them. Raises InputError."""
    typed = choose_engines(list(words)) if words else ()
    return next((e for e in typed if e.name == name), None) or find_engine(name, option="--verify")


def reference_of(advice: Advice) -> Choice:
    """Return all knobs that the advice turns at their finest good rung, with all effects, and what is expected of it.
    """
    evidence, choice = advice.evidence, advice.choice
    ladders = evidence.ladders[choice.engine]
    finest = {knob: _finest(ladders[knob], rung) for knob, rung in choice.rungs.items()}
    return choice_of(evidence, choice.engine, finest, None, advice.tolerance)


def settings_of(advice: Advice) -> tuple[Setting, ...]:
    """Return the advised setting, and the reference unless it is the same scene; without packings."""
    evidence, choice, reference = advice.evidence, advice.choice, reference_of(advice)
    advised = _setting(evidence, choice.settings, ADVISED)
    finest = _setting(evidence, reference.settings, REFERENCE)
    return (advised,) if finest.scene == advised.scene else (advised, finest)


def _setting(evidence: Evidence, settings: Settings, label: str) -> Setting:
    why = why_not_run(evidence.scene, evidence.scene_file, settings)
    scene = evidence.scene if why else advised_scene(evidence.scene, evidence.scene_file, settings)
    return Setting(
        knob="all knobs", value=0.0, x=0.0, label=label, scene=lean(scene), own=False, reason=why
    )


def _finest(ladder: KnobLadder, advised: Rung) -> Rung:
    """Return the finest rung that a scene may have, or the advised one where it lies beyond what was run."""
    good = [r for r in ladder.rungs if r.value not in ladder.beyond]
    return min((*good, advised), key=lambda r: r.x)


# --- judging -----------------------------------------------------------------------------------------


def _judged(
    advice: Advice, engine: Engine, count: int, settings: Mapping[str, Setting], done: Mapping[Key, Done],
    measured: Mapping[Key, Measured],
) -> Verification:
    choice, reference = advice.choice, reference_of(advice)
    ran = {label: rung_of(s, engine.name, done, measured) for label, s in settings.items()}
    if REFERENCE in ran and ran[ADVISED].good and ran[REFERENCE].good:
        shaking = [[measured[Key(engine.name, y.digest())].shaking for y in settings[n].systems] for n in ran]
        ran[ADVISED] = settled(ran[ADVISED], why_shaken(_turned(advice, reference), *shaking))
    sides = {
        label: _side(advice, name, planned, ran[label])
        for label, name, planned in ((ADVISED, "advised", choice), (REFERENCE, "reference", reference)) if label in ran
    }
    advised, finest = sides[ADVISED], sides.get(REFERENCE)
    scale, over = _scale(advice)
    paired = finest is not None and advised.particles == finest.particles
    found = _compared(advised, finest, scale, paired=paired)
    verdict, why, needed = _verdict(advice, advised, finest, found)
    joint = any(_turns_several(advice, c) for c in (choice, reference))
    singly, together = _of_knobs(advice, reference, advised, finest, scale) if paired else (None, None)
    return Verification(
        quantity=advice.evidence.quantity, unit=advice.evidence.unit, engine=engine.name, free=False, advised=advised,
        reference=finest, count=count, scale=scale, over=over, tolerance=advice.tolerance, difference=found,
        expected=choice.total.error(count), remaining=None if finest is None else reference.total.of_knobs,
        verdict=verdict, why=why, needed=needed, singly=singly, together=together if joint else None, joint=joint,
        untested=tuple(k for k in choice.rungs if choice.rungs[k].value == reference.rungs[k].value),
    )


def _turned(advice: Advice, reference: Choice) -> dict[str, float]:
    """Return x as advised over that of the reference, by knob; other effects move differently, as other laws do."""
    ratios = {k: r.x / reference.rungs[k].x for k, r in advice.choice.rungs.items()}
    return ratios | (dict.fromkeys(UNJUDGED, 1.0) if advice.choice.without else {})


def _side(advice: Advice, name: str, choice: Choice, ran: Ran) -> Side:
    values = ran.values.get(advice.evidence.quantity, np.empty((0, 1)))
    mean, error = mean_and_error(values)
    return Side(
        name=name, settings=choice.settings.values, without=choice.without, particles=ran.particles, steps=ran.steps,
        status=ran.status, reason=ran.reason, values=values, mean=mean, error=error, seconds=ran.seconds,
        foretold_seconds=choice.seconds,
    )


def _scale(advice: Advice) -> tuple[float, str]:
    """Return the smallest scale of the ladders of turned knobs, and what it is."""
    evidence, choice = advice.evidence, advice.choice
    scales = {k: evidence.ladders[choice.engine][k].scale for k in choice.rungs}
    knob, unit = min(scales, key=scales.__getitem__), "" if evidence.unit == "1" else f" {evidence.unit}"
    others = ", ".join(f"{k} {v:.4g}" for k, v in scales.items() if v != scales[knob])
    more = f", the smallest such of the turned knobs ({others})" if others else ""
    return scales[knob], f"{scales[knob]:.4g}{unit}, by which the ladder of {knob} measures its errors{more}"


def _compared(advised: Side, finest: Side | None, scale: float, *, paired: bool) -> Difference | None:
    if finest is None or not (advised.good and finest.good and len(advised.values) and len(finest.values)):
        return None
    return difference_of(advised.values, finest.values, scale, paired=paired)


def _verdict(advice: Advice, advised: Side, finest: Side | None, found: Difference | None):
    """Return the verdict, why, and how many packings would tell."""
    if found is not None:
        return verdict_of(found, advice.tolerance, "packings")
    failed = next((s for s in (advised, finest) if s is not None and not s.good), None)
    if failed is not None:
        return "not_checked", f"the {failed.name} run is {failed.status.replace('_', ' ')}: {failed.reason}", None
    if finest is None:
        knobs = ", ".join(advice.choice.rungs)
        return "not_checked", (
            f"the advised setting has {knobs} at the finest rung and all effects: nothing finer to hold it against; "
            "climb a finer rung"
        ), None
    return "not_checked", f"fewer than {FEWEST} packings have a {advice.evidence.quantity} in both", None


def _turns_several(advice: Advice, choice: Choice) -> bool:
    """Whether a setting is no rung of a ladder: two knobs, or one and effects, are away from the scene as declared."""
    ladders = advice.evidence.ladders[choice.engine]
    turned = [k for k, r in choice.rungs.items() if ladders[k].own is None or ladders[k].own.value != r.value]
    return len(turned) + bool(choice.without) > 1


def _of_knobs(
    advice: Advice, reference: Choice, advised: Side, finest: Side, scale: float
) -> tuple[Difference | None, Difference | None]:
    """Return the knobs' own differences added up, and what was measured less that, on the packings of both.

    Packing k of a study and of a verification have one seed.
    """
    alone = _singly(advice, reference)
    if alone is None:
        return None, None
    singly = difference_of(alone, np.zeros_like(alone), scale, paired=True)
    if not len(advised.values) or not len(finest.values):
        return singly, None
    both = min(len(alone), len(advised.values), len(finest.values))
    return singly, difference_of(advised.values[:both] - finest.values[:both], alone[:both], scale, paired=True)


def _singly(advice: Advice, reference: Choice) -> np.ndarray | None:
    """Return (n, 1) by packing: sum over knobs of the advised rung less the finest; None where a ladder lacks it."""
    total: np.ndarray | float = 0.0
    for knob, rung in advice.choice.rungs.items():
        one, other = np.array(rung.each), np.array(reference.rungs[knob].each)
        if rung.value == reference.rungs[knob].value:
            continue
        if not len(one) or len(one) != len(other):
            return None
        total = total + (one - other)
    if advice.choice.without or np.ndim(total) == 0:
        return None
    return np.reshape(total, (-1, 1))
