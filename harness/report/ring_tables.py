"""The tables of a ring's report: numbers, profiles, balances, torque history."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from harness.report.replicates import replicate_rows
from harness.report.ring_torque import torque_band_rows
from harness.report.wall_bands import TABLE as WALL_BANDS
from harness.report.wall_bands import has_replicates
from harness.scene.ring import area_fractions
from harness.studies.compare.profile_quantities import QUANTITIES
from harness.studies.compare.ring_numbers import Number, ring_numbers
from postproc.results import headed
from reference.values import Published, published_values

if TYPE_CHECKING:
    from harness.studies.compare.profiles import RingProfiles
    from harness.studies.compare.study import Comparison


TABLES = ("numbers", "between_codes", "published", "profiles", "balances", "torque", "growth", WALL_BANDS)


def tables(comparison: Comparison) -> dict[str, list[dict]]:
    """Rows by table name; bands of the torque are of replicates only."""
    rows = (
        number_rows, between_rows, published_rows, profile_rows, balance_rows, torque_rows, growth_rows,
        torque_band_rows,
    )
    made = zip(TABLES, rows, strict=True)
    return {name: make(comparison) for name, make in made if name != WALL_BANDS or has_replicates(comparison)}


def number_rows(comparison: Comparison) -> list[dict]:
    """One row an engine, packing and number; the area fractions are those of all."""
    fractions = [
        {"engine": "all", "packing": None, "quantity": f"area fraction of the {name} annulus", "unit": "1",
         "value": value, "standard error": None}
        for name, value in area_fractions(comparison.scene).items()
    ]
    return fractions + [
        {"engine": e, "packing": k + 1, "quantity": name, "unit": n.unit, "value": _known(n.value),
         "standard error": None if n.error is None else _known(n.error)}
        for e, k, numbers in _numbers(comparison) for name, n in numbers.items()
    ]


def between_rows(comparison: Comparison) -> list[dict]:
    """One row a number, or a profile's mean over cells, and pair of codes."""
    return replicate_rows(comparison.result.judged)


def _numbers(comparison: Comparison) -> Iterator[tuple[str, int, dict[str, Number]]]:
    result = comparison.result
    for engine, of in result.profiles.items():
        for k, profiles in of.items():
            yield engine, k, ring_numbers(profiles, result.balances[engine][k], result.bands[engine][k])


def number_page_rows(comparison: Comparison) -> list[dict]:
    """The numbers for people: one row a number, one column an engine; over several packings mean and its error."""
    found = list(_numbers(comparison))
    engines = dict.fromkeys(e for e, _, _ in found)
    rows: dict[str, dict] = {}
    for engine in engines:
        mine = [numbers for e, _, numbers in found if e == engine]
        for name in dict.fromkeys(n for numbers in mine for n in numbers):
            numbers = [of[name] for of in mine if name in of]
            row = rows.setdefault(name, {"quantity": name, "unit": numbers[0].unit, **engines})
            row[engine] = _shown(numbers)
    return list(rows.values())


def _shown(numbers: list[Number]) -> str:
    values = np.array([n.value for n in numbers])
    error = numbers[0].error if len(numbers) == 1 else float(values.std(ddof=1) / np.sqrt(len(values)))
    tail = f" (n = {len(numbers)})" if len(numbers) > 1 else ""
    return f"{values.mean():.3g}" + ("" if error is None else f" +- {error:.2g}") + tail


def published_rows(comparison: Comparison) -> list[dict]:  # noqa: ARG001
    """What was published of such rings: the talk's value, which decides, and recalled ones, which never do."""
    wanted = ("shear band v_0", "shear band width s/d")
    return [_published_row(v) for v in published_values().values() if v.quantity in wanted]


def _published_row(value: Published) -> dict:
    spread = value.tolerance * value.value if value.tolerance else None
    return {
        "quantity": value.quantity, "value": value.value, "plus or minus": spread,
        "status": "seen: decides" if value.decides else "recalled, not seen: never decides", "origin": value.origin,
        "conditions": value.conditions,
    }


def profile_rows(comparison: Comparison) -> list[dict]:
    """One row an engine, packing and cell: mean and standard error of every profile; nothing where there is none."""
    made = [
        (e, k, p) for e, of in comparison.result.profiles.items() for k, p in of.items()
    ]
    names = {q.name: q.unit for q in QUANTITIES if any(q.name in p.profiles for _, _, p in made)}
    return [_profile_row(e, k, p, names, cell) for e, k, p in made for cell in range(len(p.r))]


def _profile_row(engine: str, packing: int, p: RingProfiles, names: dict[str, str], cell: int) -> dict:
    row = {
        "engine": engine, "packing": packing + 1, "r (m)": float(p.r[cell]), "r_inner (m)": float(p.edges[cell]),
        "r_outer (m)": float(p.edges[cell + 1]), "glued_part": float(p.glued[cell]),
    }
    for name, unit in names.items():
        profile = p.profiles.get(name)
        columns = (headed(name, unit), headed(f"{name}_error", unit), f"{name}_samples")
        of = (profile.mean, profile.error, profile.samples) if profile else ()
        values = [_known(v[cell]) for v in of] or [None] * 3
        row |= dict(zip(columns, values, strict=True))
    return row


def balance_rows(comparison: Comparison) -> list[dict]:
    """One row an engine, packing and ring: torque through its middle circle, what momentum is left over."""
    rows = []
    for engine, of in comparison.result.balances.items():
        for k, b in of.items():
            if b.absent:
                continue
            columns = {
                "torque_through": b.through, "torque_beyond_inner": b.from_inner, "torque_beyond_outer": b.from_outer,
                "residual_r": b.momentum[0], "residual_phi": b.momentum[1],
            }
            for cell, r in enumerate(b.r):
                row = {"engine": engine, "packing": k + 1, "r (m)": float(r)}
                for name, p in columns.items():
                    row[headed(name, p.unit)] = _known(p.mean[cell])
                    row[headed(f"{name}_error", p.unit)] = _known(p.error[cell])
                rows.append(row)
    return rows


def torque_rows(comparison: Comparison) -> list[dict]:
    """One row an engine and sample of the first packing."""
    return [
        {"engine": e, "time (s)": float(c.time[k]), "inner_angle (rad)": float(c.inner_angle[k]),
         "inner_torque (N m)": float(c.inner_torque[k]), "outer_torque (N m)": float(c.outer_torque[k])}
        for e, c in comparison.result.curves.items() for k in range(len(c.step))
    ]


def growth_rows(comparison: Comparison) -> list[dict]:
    """One row a pair and frame."""
    return [
        {"pair": name, "time (s)": float(t), "rms difference over diameter": float(d)}
        for name, g in comparison.result.growth.items() for t, d in zip(g.time, g.difference, strict=True)
    ]


def _known(value: float) -> float | None:
    """None of what is not a number: not computed is no number."""
    return float(value) if np.isfinite(value) else None
