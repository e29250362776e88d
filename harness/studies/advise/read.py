"""The evidence for an advice, from the JSON of a finished `grainproof accuracy` (and `grainproof effects`).

So advice can be asked for as often as one likes. What the files do not say is not there; nothing is filled in.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path

from harness.errors import InputError
from harness.scene.describe import nearest
from harness.scene.model import Free, Scene
from harness.studies.advise.bulk_ladders import bulk_evidence
from harness.studies.advise.evidence import Evidence, Reduced
from harness.studies.advise.files import ACCURACY, EFFECTS, BulkFile, FreeFile, damaged, read_accuracy, read_effects
from harness.studies.advise.free_ladders import free_evidence


def read_evidence(
    scene: Scene, file: Path, *, quantity: str | None, folder: Path, effects: Path | None, tolerance: float,
    engines: Sequence[str] | None = None,
) -> Evidence:
    """Return what the studies in `folder` and `effects` say of a quantity, the studies' own unless named.

    engines: the only ones to be advised. Raises InputError for a folder without a finished study, one of another scene,
    or without the quantity or an engine.
    """
    place = folder / ACCURACY
    data = read_accuracy(folder, free=isinstance(scene, Free))
    _require_same_scene(scene, data.scene, place, "--from")
    wanted = _quantity(data, quantity, place)
    if isinstance(data, FreeFile):
        found = free_evidence(scene, file, data, wanted, place)
    else:
        found = bulk_evidence(scene, file, data, wanted)
    found = _with(_of_engines(found, _engines(data), engines, place), source=str(folder))
    return found if effects is None else with_effects(found, effects, tolerance=tolerance)


def with_effects(evidence: Evidence, folder: Path, *, tolerance: float) -> Evidence:
    """Add what a finished effects study says; raises InputError if there is none, or it is of another scene."""
    place = folder / EFFECTS
    data, evidence = read_effects(folder), _with(evidence, effects_source=str(folder))
    _require_same_scene(evidence.scene, data.scene, place, "--effects-from")
    if evidence.quantity not in data.quantities:
        return _with(evidence, effects_say=f"that study did not look at {evidence.quantity}: all stay as declared")
    if not data.left_out:
        return _with(evidence, effects_say=f"none may go within {100 * data.tolerance:g} % ({folder})")
    trials = [t for t in data.tables.trials if t.quantity == evidence.quantity]
    last = max(trials, key=lambda t: t.trial, default=None)
    if last is None or last.change is None:
        raise damaged(place, f"without a trial of {evidence.quantity} although effects are left out")
    names, share = tuple(data.left_out), {e: 1.0 - s for e, s in data.saved.items() if s is not None}
    error, bar = last.change / 100.0, (last.error or 0.0) / 100.0
    beyond = "" if abs(error) + bar <= tolerance else ", too much for this tolerance"
    return _with(
        evidence, reduced=Reduced(names=names, error=error, bar=bar, share=share),
        effects_say=f"{', '.join(names)} may go{beyond} ({folder})",
    )


def _engines(data: BulkFile | FreeFile) -> list[str]:
    if isinstance(data, FreeFile):
        return list(dict.fromkeys(p.engine for p in data.tables.points))
    return data.engines


def _of_engines(evidence: Evidence, known: Sequence[str], wanted: Sequence[str] | None, place: Path) -> Evidence:
    """Keep the ladders of the engines that are asked for."""
    if not wanted:
        return evidence
    lacking = next((e for e in wanted if e not in known), None)
    if lacking is not None:
        raise InputError(
            file="--engines", expected=f"some of {', '.join(known)}, which {place} has", got=lacking,
            fix=nearest(lacking, list(known)),
        )
    kept = {e: of for e, of in evidence.ladders.items() if e in wanted}
    return _with(evidence, ladders=kept, engines=tuple(wanted))


def _quantity(data: BulkFile | FreeFile, name: str | None, place: Path) -> str:
    known = _free_quantities(data) if isinstance(data, FreeFile) else list(data.quantities)
    wanted = name or data.quantity
    if wanted not in known:
        raise InputError(
            file="--quantity", expected=f"one of {', '.join(known)}, which {place} has", got=wanted,
            fix=nearest(wanted, known),
        )
    return wanted


def _free_quantities(data: FreeFile) -> list[str]:
    return [q for q in ("exit", "velocity", "spin") if any(getattr(p, q) is not None for p in data.tables.points)]


def _require_same_scene(scene: Scene, theirs: Scene, place: Path, option: str) -> None:
    """Titles do not matter, and not what only `compare` judges by; what the study's version did not know is absent."""
    names = {"kind", *type(scene).__struct_fields__} - {"title", "compare"}
    kind = {"kind"} if type(theirs) is not type(scene) else set()
    other = kind or {n for n in names - {"kind"} if getattr(scene, n) != getattr(theirs, n)}
    if other:
        raise InputError(
            file=option, expected="a study of this scene", got=f"{place}, {_other(other)}",
            fix="run it again for this scene",
        )


def _other(names: set[str]) -> str:
    return f"whose {', '.join(sorted(names))} differ{'s' if len(names) == 1 else ''}"


def _with(evidence: Evidence, **changes) -> Evidence:
    return dataclasses.replace(evidence, **changes)
