"""`ring`: the Couette ring between rough rings, at several densities: motion, density, stress, fabric, stiffness, spin.

    v_phi = v_0 Omega R_i exp(-(r - R_i)/s)        sigma_rr, sigma_phiphi ~ r^0,  sigma_rphi, sigma_phir ~ r^-2

Averages over concentric cells and over the steady time, as the talk makes them; errors know of autocorrelation.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.scene.ring import area_fractions, radii
from harness.studies.reproduce.protocol import Ask, Case, Declared, Result, Study
from harness.studies.reproduce.ring.cases import SPRINGS, cases_of, main_plans
from harness.studies.reproduce.ring.charts import charts_of
from harness.studies.reproduce.ring.measure import STATIC, measure_ring
from harness.studies.reproduce.ring.numbers import (
    TALK,
    Runs,
    checks_of,
    collapse,
    over,
    rate_points,
    rows_of,
    shown_rows,
    table_rows,
)
from harness.studies.reproduce.runs import Made, engines_of, run_cases, study_runs, unsupported
from postproc.results import Unavailable
from reference.values import published_values

RATE_WORDS = (
    "The ring at twice the rate, turned as far: what quasi-static means here. Number: the inertial number at the inner "
    "ring, from the fit and the mean pressure."
)


def cases(ask: Ask) -> Sequence[Case]:
    """Return the rings of a size."""
    return cases_of(ask, STUDY.packings(ask))


def run(ask: Ask) -> Result:
    """Run all rings; profiles, powers of r and stiffness beside the talk's."""
    planned = cases(ask)
    made = run_cases(ask, planned, measure_ring)
    runs = _by_case(made)
    engines = engines_of(made)
    return Result(
        rows=tuple(rows_of(ask, runs)), rates=tuple(rate_points(ask, runs)), rate_words=RATE_WORDS,
        checks=tuple(checks_of(planned, runs, _rerun(ask))), pictures=charts_of(ask, runs, engines),
        tables={"Numbers for which the talk shows a curve": shown_rows(ask, runs),
                "All numbers": table_rows(planned, runs)},
        words=_words(ask, planned, runs, engines),
        runs=study_runs(made), unsupported=unsupported(made),
    )


def _by_case(made: Sequence[Made]) -> Runs:
    found: dict = {}
    for m in made:
        if m.found is not None:
            found.setdefault(m.case, {}).setdefault(m.engine, {})[m.packing] = m.found
    return found


def _rerun(ask: Ask):
    packings = f" --packings {ask.packings}" if ask.packings else ""
    return lambda *engines: f"grainproof reproduce ring --size {ask.size} --engines {','.join(engines)}{packings}"


# --- words ---------------------------------------------------------------------------------------


def _words(ask: Ask, planned: Sequence[Case], runs: Runs, engines: Sequence[str]) -> tuple[str, ...]:
    fractions = {c.name: area_fractions(c.scene) for c in planned}
    said = ["Area fractions of the free annulus (of the bare one): " + ", ".join(
        f"{name} {f['free']:.4f} ({f['bare']:.4f})" for name, f in fractions.items()) + "."]
    if engines:
        said += [_power_words(ask, runs), _collapse_words(ask, runs, engines), _spring_words(runs, engines)]
    said.append(
        "The recalled fits of the paper (v_0, s, non-colinearity, E linear in tr F) set the study up and decide "
        "nothing. A flow of one packing is one realisation: codes part by chaos within seconds, so that what they have "
        "in common is averages within their error bars."
    )
    return tuple(s for s in said if s)


def _power_words(ask: Ask, runs: Runs) -> str:
    parts = [f"{plan.name}: furthest from the talk is {found}"
             for plan in main_plans(ask) if (found := _furthest(runs.get(plan.name, {})))]
    return (
        "Powers of r are fitted one mean diameter away from both rings; their errors are those of a jackknife over "
        "time, as all cells rise and fall together with the torque. sigma_rphi ~ r^-2 is the balance of torque, which "
        "holds for any material; sigma_rr ~ r^0 needs sigma_phiphi = sigma_rr besides, a property of this one. "
        + "; ".join(parts) + "."
    )


def _furthest(of) -> str:
    """Say which power of r of which engine is furthest from the talk's, "" without any."""
    values = {
        (name, e): over(e, by, name).value
        for e, by in of.items() for name in STATIC if any(name in r.numbers for r in by.values())
    }
    if not values:
        return ""
    name, engine = max(values, key=lambda k: abs(values[k] - published_values()[TALK[k[0]]].value))
    return f"{name} of {engine}: {values[name, engine]:.3g}"


def _collapse_words(ask: Ask, runs: Runs, engines: Sequence[str]) -> str:
    found = {e: collapse(ask, runs, e) for e in engines}
    known = {e: c for e, c in found.items() if not isinstance(c, Unavailable)}
    if not known:
        return ""
    shares = ", ".join(f"{c.share:.4f} ({e})" for e, c in known.items())
    return (
        f"One line through E against tr F of all densities explains these parts of the variance: {shares}. For linear "
        "springs it must: where contacts are isotropic, E = k_n tr F/pi follows from how stress, strain and fabric are "
        "averaged, so that the published collapse says how little anisotropic the contacts are, and little of the flow."
    )


def _spring_words(runs: Runs, engines: Sequence[str]) -> str:
    for engine in engines:
        for ring in runs.get(SPRINGS, {}).get(engine, {}).values():
            p = ring.profiles.profiles.get("torque_stiffness")
            if p is not None:
                used = ring.inside & np.isfinite(p.mean)
                known = p.mean[used]
                square = float((radii(ring.scene) ** 2).mean())
                return (
                    "Torque stiffness exists only where contacts have springs: without them there is no curvature, "
                    "which is left out and not zero. In the ring with springs its median over the cells is "
                    f"{np.median(known):.2g} N m, between {known.min():.2g} and {known.max():.2g} ({engine}); "
                    f"k_t <a^2>, the couple of one contact turned against its spring, is "
                    f"{ring.scene.contact.sliding.shear_stiffness * square:.2g} N m."
                )
    return ""


def _declared(size: str) -> Declared:
    return {
        "quick": Declared(says="small rings of 940 discs at two densities, one faster, one with springs", packings=1),
        "paper": Declared(says="densities A, B, C at real size, 120 s; C twice as fast; a small one with springs",
                          packings=3),
    }[size]


STUDY = Study(
    name="ring", title="The Couette ring: shear band, stresses, fabric, stiffness, rotations",
    claim="v_phi = v_0 exp(-(r - R_i)/s) with s/d = 1 to 2; sigma_rr, sigma_phiphi ~ r^0, sigma_rphi ~ r^-2; an "
    "exponential dynamic stress; dilation in the band; E grows with tr F; spins oscillate next to the inner ring.",
    source="S. Luding, Micro-macro transition, simple examples, and Shear banding in granular materials",
    sizes={"quick": _declared("quick"), "paper": _declared("paper")}, engines=("lammps", "liggghts", "kernel"),
    values=("talk_shear_band_width", "talk_ring_stress_rr", "talk_ring_stress_phiphi", "talk_ring_stress_rphi",
            "talk_ring_stress_phir", *(f"recalled_ring_{k}_{w}" for k in "abc" for w in ("v0", "width"))),
    run=run, cases=cases,
)

__all__ = ["STUDY", "run"]
