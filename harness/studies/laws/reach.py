"""How much tangential force a contact carries: the largest |f_t| over Coulomb's limit, in shear at one depth.

Codes that cut spring and dashpot together reach one; those that cut the spring alone carry up to
1 + gamma_t |v_t|/(mu f_n) while it sticks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.studies.laws.closed_forms import contact_of, expected, limit_base
from harness.studies.laws.drive import Driven
from reference.kernel.conventions import NAMED, Convention

MOTION = "shear"


@dataclass(frozen=True, kw_only=True)
class Reach:
    """found: of an engine; by_form: of the closed form in its convention."""

    laws: str
    engine: str
    found: float
    by_form: float


def reach(run: Driven, convention: str) -> Reach | None:
    """Return the reach of a completed run of pairs with friction, None of another."""
    laws, a = run.job.laws, run.job.arrangement
    if run.reaction is None or laws.sliding is None or a.partner != "pair":
        return None
    track, chosen = a.tracks_of(MOTION)[0], NAMED[convention]
    answers = track.local(run.reaction)[0], expected(laws, track.motion, a.partner, a.grains, chosen)[0]
    found, by_form = (_largest(force[:, 0], run, chosen) for force in answers)
    return Reach(laws=laws.name, engine=run.engine, found=found, by_form=by_form)


def _largest(force: np.ndarray, run: Driven, convention: Convention) -> float:
    """Return max |f_t|/(mu f) of forces on i (S, 3); rows that a closed form does not determine are left out."""
    laws, a = run.job.laws, run.job.arrangement
    c = contact_of(a.tracks_of(MOTION)[0].motion, a.partner, a.grains, convention)
    limit = laws.sliding.shear_friction * limit_base(laws.normal, c, force[:, 0])
    pressed = limit > 1e-6 * np.nanmax(limit)
    return float(np.nanmax(np.hypot(force[pressed, 1], force[pressed, 2]) / limit[pressed]))
