"""Advice in plain words made from its numbers, and what it does not know."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report.advise_verified import verification_limits
from harness.studies.advise.study import told_errors

if TYPE_CHECKING:
    from harness.studies.advise.evidence import Evidence
    from harness.studies.advise.study import Advice
    from harness.studies.advise.verification import Verification

COMBINED = (
    "Errors of knobs that stand out of their noise (more than two standard errors) are added up as if all had one "
    "sign; those that do not, all standard errors, and the scatter of one packing over the root of the packings are "
    "added in quadrature. Times over the scene's own are multiplied."
)


SETTING = {
    "dt": "dt_fraction {:.4g}", "stiffness": "{:.4g} times the scene's stiffness", "rate": "{:.4g} times its rate",
    "size": "{:.0f} particles",
}
"""How a setting is said, by knob."""


def paragraph(advice: Advice) -> str:
    """Return the findings, a sentence each."""
    return " ".join(s for s in (_take(advice), _error(advice), _floor(advice), _against(advice), _basis(advice)) if s)


def limits(advice: Advice, verification: Verification | None = None) -> list[str]:
    """Return what the advice does not know, a sentence each."""
    evidence, choice = advice.evidence, advice.answer
    together = [] if verification is None else verification_limits(verification)
    found = [
        *(together or ["Each knob was turned with all others as declared; that they do not act on each other was not "
                       "measured: run the advised scene before relying on it (`--verify`)."]),
        "Errors are those of one engine against the limits of its own ladders: what its model leaves out is not in "
        "them.",
        "Of many settings with noisy errors the one that looks cheapest looks better than it is, on average.",
    ]
    if not evidence.free:
        found.append(
            f"Limits come from {evidence.packings} packings; their standard errors are themselves known to about "
            f"{100.0 / (2.0 * max(1, evidence.packings - 1)) ** 0.5:.0f} %."
        )
    if evidence.free:
        found.append("Errors are root mean squares over phases of the step; a single run may be off by more.")
    if advice.scene is not None and advice.scene.outputs != evidence.scene.outputs:
        found.append(
            "The advised scene has fewer samples and frames than the declared one, as its few steps must be a multiple "
            "of them."
        )
    missing = [k for k, why in evidence.absent.items() if why.startswith("not measured")]
    if missing:
        found.append(f"Not measured, so in no sum: {', '.join(missing)}.")
    if choice is not None:
        told = told_errors(evidence, choice.engine)
        shown = [r for r in told.values() if r.error or r.bar]
        found += [f"Averaging over {r.value:g} leaves {100 * r.error:+.2g} +- {100 * r.bar:.2g} % against no width; "
                  "that belongs to what the quantity is, and is not counted." for r in shown]
        if choice.extrapolated:
            found.append(f"{', '.join(choice.extrapolated)} lies beyond what was run: climb that rung to be sure.")
        failed = {k: evidence.ladders[choice.engine][k].failed for k in choice.rungs}
        found += [f"Rungs of {k} without an error: {', '.join(f)}." for k, f in failed.items() if f]
    found += refused(evidence, None if choice is None else choice.engine)
    return found


def refused(evidence: Evidence, engine: str | None) -> list[str]:
    """Name the measured steps that were not looked at, as no scene can have them."""
    ladders = evidence.ladders.get(engine) if engine else next(iter(evidence.ladders.values()), None)
    return [
        f"{knob} {', '.join(f'{v:.4g}' for v in la.beyond)}: refused by `scene`, beyond its stability limit of "
        f"{la.largest:.3g}; measured, and not advised whatever their error."
        for knob, la in (ladders or {}).items() if la.beyond
    ]


def _take(advice: Advice) -> str:
    choice, quantity, tolerance = advice.choice, advice.evidence.quantity, _percent(advice.tolerance)
    if choice is None:
        return f"No setting is known that keeps {quantity} within {tolerance}: {advice.why}."
    knobs = ", ".join(SETTING[knob].format(rung.value) for knob, rung in choice.rungs.items())
    effects = f", without {', '.join(choice.without)}" if choice.without else ""
    many = "" if advice.evidence.free else f", {choice.packings} packing{'s' * (choice.packings > 1)}"
    return f"For {quantity} within {tolerance}: {choice.engine} with {knobs}{effects}{many}."


def _error(advice: Advice) -> str:
    answer = advice.answer
    if answer is None:
        return ""
    which = "Expected:" if advice.choice else f"The best known setting ({answer.engine}) is expected to have"
    error = answer.total.error(advice.packings)
    time = _seconds(answer.seconds * advice.packings)
    copies = f" for all {advice.evidence.packings} phases together" if advice.evidence.free else ""
    return f"{which} an error of {_percent(error)} in {time} of CPU time{copies}."


def _floor(advice: Advice) -> str:
    """Say when the tolerance lies below what one packing, or the ladders, can tell."""
    if advice.answer is None or not advice.answer.total.spread:
        return ""
    spread = advice.answer.total.spread
    if not advice.below_floor:
        return f"One packing scatters by {_percent(spread)}."
    told = f"so that {advice.packings} are needed" if advice.choice else "so that one would not do in any case"
    return f"The tolerance lies below the statistical floor: one packing scatters by {_percent(spread)}, {told}."


def _against(advice: Advice) -> str:
    """Compare with the scene as declared."""
    choice = advice.choice
    if choice is None or choice.declared_seconds is None or advice.declared is None:
        return ""
    needed = advice.declared_packings
    if needed is None:
        return (
            f"The scene as declared does not keep it on {choice.engine}: its own settings leave "
            f"{_percent(advice.declared.systematic)} that is seen and {_percent(advice.declared.noise)} of noise."
        )
    ratio = choice.declared_seconds * needed / (choice.seconds * choice.packings)
    if ratio < 1.0 + 1e-9:
        return "The scene as declared does it as fast."
    many = "" if advice.evidence.free else f" ({needed} packing{'s' * (needed > 1)})"
    return f"The scene as declared would need {ratio:.2g} times as long{many}."


def _basis(advice: Advice) -> str:
    choice = advice.answer
    if choice is None:
        return ""
    far = choice.extrapolated
    measured = [k for k in choice.rungs if k not in far]
    told = [f"measured rungs of {', '.join(measured)}"] if measured else []
    told += [f"extrapolated ones of {', '.join(far)}"] if far else []
    kept = [k for k, why in advice.evidence.absent.items() if why.startswith("not measured")]
    told += [f"{', '.join(kept)} as declared, not measured"] if kept else []
    return f"It rests on {'; '.join(told)}."


def _percent(value: float) -> str:
    return f"{100.0 * value:.2g} %"


def _seconds(value: float) -> str:
    for size, unit in ((3600.0, "h"), (60.0, "min"), (1.0, "s"), (1e-3, "ms")):
        if value >= size:
            return f"{_two_digits(value / size)} {unit}"
    return f"{_two_digits(1e6 * value)} us"


def _two_digits(value: float) -> str:
    """Write two digits, and no power of ten: 320, 4.1, 0.05.

    >>> _two_digits(316.2), _two_digits(4.14)
    ('320', '4.1')
    """
    return f"{float(f'{value:.2g}'):g}"
