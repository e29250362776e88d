"""Which settings keep a quantity within a tolerance, from measured ladders."""

from __future__ import annotations

import sys
from pathlib import Path

from harness.arguments import as_count, as_folder, as_seconds
from harness.verbs.common import add_names, add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "advise", _advise, "the cheapest settings that keep a quantity within a tolerance")
    verb.add_argument("file", type=Path, metavar="FILE")
    verb.add_argument("--tolerance", type=float, required=True, metavar="T", help="as a part of the quantity: 0.01")
    verb.add_argument("--quantity", metavar="Q", help="friction_angle, torque, exit, ...; default: the study's own")
    verb.add_argument("--from", dest="source", type=as_folder, metavar="DIR",
                      help="folder of a finished grainproof accuracy; without it one is run")
    verb.add_argument("--effects-from", type=as_folder, metavar="DIR",
                      help="folder of a finished grainproof effects; without either one is run")
    add_names(verb, "engine", "to run, with --from to choose among; default: the studies' own")
    verb.add_argument("--packings", type=as_count, metavar="N", help="of the studies that are run; not with --from")
    verb.add_argument(
        "--verify", type=as_count, nargs="?", const=0, metavar="N",
        help="run the advised scene, all knobs at once, and hold it against the finest settings on N packings (without "
        "N: as many as advised, at least 2), a free one against the oracle",
    )
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    verb.add_argument("--out", type=as_folder, default=Path("out/advise"), metavar="DIR", help="default: %(default)s")
    verb.add_argument("--time-limit", type=as_seconds, default=3600.0, metavar="S", help="a run; default: %(default)g")


def _advise(options) -> int:
    from harness.report.advise import NAMES, advise_answer, exit_status, write_advice
    from harness.scene.load import load_scene
    from harness.scene.model import Free
    from harness.studies.advise import advise, read_evidence
    from harness.studies.advise.verify import verified_packings
    from harness.studies.effects.asked import asked_quantities, asked_tolerance

    _require_no_packings(options)
    scene = load_scene(options.file)
    packings = verified_packings(options.verify, free=isinstance(scene, Free))
    tolerance = asked_tolerance(scene, options.tolerance)
    asked_quantities(scene, [options.quantity] if options.quantity else None)
    NAMES.check(options.out)
    ladders, effects = _studies(options)
    evidence = read_evidence(
        scene, options.file, quantity=options.quantity, folder=ladders, effects=effects, tolerance=tolerance,
        engines=options.engines if options.source is not None else None,
    )
    advice = advise(evidence, tolerance)
    page = write_advice(advice, options.out)
    found = _verified(options, advice, packings, options.out if options.source is not None else ladders)
    if found is not None:
        write_advice(advice, options.out, found)
    show(advise_answer(advice, found), options)
    if options.json != "-":
        print("\n".join([*_words(options, advice, found), f"report: {page}"]))
    return exit_status(advice, found)


def _verified(options, advice, packings: int | None, kept: Path):
    """Return what came of a verification; None if none was asked for, or there is no choice to be verified.

    kept: where its runs are: with those of the ladders, where these are the command's own.
    """
    from harness.report.advise_expected import verification_announcement
    from harness.runs.progress import progress_for
    from harness.studies.advise.verify import engine_for, verify

    if options.verify is None or advice.choice is None:
        return None
    engine = engine_for(advice.choice.engine, options.engines)
    print(
        verification_announcement(advice, engine, packings=packings, workers=options.workers), file=sys.stderr,
        flush=True,
    )
    return verify(
        advice, engine, kept, packings=packings, time_limit=options.time_limit, workers=options.workers,
        progress=progress_for,
    )


def _words(options, advice, found) -> list[str]:
    """Return what is said below the tables."""
    from harness.report.advise_verified import NOTHING, verification_line
    from harness.report.advise_words import limits, paragraph

    verified = [verification_line(found)] if found else [NOTHING] if options.verify is not None else []
    return [paragraph(advice), *verified, *limits(advice, found)]


def _require_no_packings(options) -> None:
    """A finished study has the packings that it has."""
    from harness.errors import InputError

    if options.source is not None and options.packings is not None:
        raise InputError(
            file="--packings", expected="nothing beside --from", got=options.packings,
            fix="the ladders there have packings of their own; run grainproof accuracy with other ones",
        )


def _studies(options) -> tuple[Path, Path | None]:
    """Return the folders of the studies, run if they are not named."""
    if options.source is not None:
        return options.source, options.effects_from
    ladders = options.out / "accuracy"
    _run_accuracy(options, ladders)
    effects = options.effects_from
    if effects is None:
        effects = options.out / "effects"
        _run_effects(options, effects)
    return ladders, effects


def _run_accuracy(options, out: Path) -> None:
    from harness.report.accuracy import write_accuracy
    from harness.report.accuracy_bulk import write_bulk
    from harness.report.accuracy_expected import announcement
    from harness.runs.progress import progress_for
    from harness.studies.accuracy import accuracy
    from harness.studies.accuracy.bulk import BulkAccuracy

    asked = {
        "engines": options.engines, "knob": None, "ladder": None, "quantity": options.quantity,
        "packings": options.packings, "workers": options.workers,
    }
    print(announcement(options.file, **asked, phases=None), file=sys.stderr, flush=True)
    done = accuracy(options.file, out, **asked, time_limit=options.time_limit, progress=progress_for)
    write = write_bulk if isinstance(done, BulkAccuracy) else write_accuracy
    write(done, out)


def _run_effects(options, out: Path) -> None:
    from harness.report.effects import write_effects
    from harness.report.effects_expected import announcement
    from harness.runs.progress import progress_for
    from harness.studies.effects import effects_study

    wanted = {
        "quantities": [options.quantity] if options.quantity else None, "tolerance": options.tolerance,
        "only": None, "engines": options.engines, "by": None, "packings": options.packings,
        "workers": options.workers,
    }
    print(announcement(options.file, **wanted), file=sys.stderr, flush=True)
    write_effects(
        effects_study(options.file, out, **wanted, time_limit=options.time_limit, progress=progress_for), out
    )
