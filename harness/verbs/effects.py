"""Which effects a scene calls for, and what each costs and changes."""

from __future__ import annotations

import sys
from pathlib import Path

from harness.arguments import as_count, as_folder, as_names, as_seconds
from harness.verbs.common import add_names, add_verb, show


def add(verbs) -> None:
    """Declare the verb."""
    verb = add_verb(verbs, "effects", _effects, "which effects are on, what each costs and changes")
    verb.add_argument("file", type=Path, metavar="FILE")
    verb.add_argument("--quantity", type=as_names, action="extend", metavar="Q,...",
                      help="what has to stay: friction_angle, plateau_angle, stress_ratio, volume_strain, "
                      "stress_strain; torque, band_width, wall_velocity; exit, velocity, spin; default: the first")
    verb.add_argument("--tolerance", type=float, metavar="T", help="part of it; default: 0.05, of free scenes 0.01")
    add_names(verb, "effect", "effects that are switched, blanks as _; default: all")
    add_names(verb, "engine", "timed and checked; default: lammps,liggghts,kernel:talk")
    verb.add_argument("--by", metavar="E", help="engine whose answers are compared; default: kernel:talk")
    verb.add_argument("--packings", type=as_count, metavar="N", help="default: 4 of a box, 1 of a ring")
    verb.add_argument("--workers", type=as_count, metavar="N", help="runs at a time; default: the number of cores")
    verb.add_argument("--out", type=as_folder, default=Path("out/effects"), metavar="DIR", help="default: out/effects")
    verb.add_argument("--time-limit", type=as_seconds, default=3600.0, metavar="S", help="a run; default: %(default)g")


def _effects(options) -> int:
    from harness.report.effects import NAMES, effects_answer, write_effects
    from harness.report.effects_expected import announcement
    from harness.report.effects_words import paragraph
    from harness.runs.progress import progress_for
    from harness.studies.effects import effects_study

    NAMES.check(options.out)
    wanted = {
        "quantities": options.quantity, "tolerance": options.tolerance, "only": options.effects,
        "engines": options.engines, "by": options.by, "packings": options.packings, "workers": options.workers,
    }
    print(announcement(options.file, **wanted), file=sys.stderr, flush=True)
    study = effects_study(
        options.file, options.out, **wanted, time_limit=options.time_limit, progress=progress_for
    )
    page = write_effects(study, options.out)
    show(effects_answer(study), options)
    if options.json != "-":
        print(f"{paragraph(study)}\nreport: {page}")
    return study.exit_status
