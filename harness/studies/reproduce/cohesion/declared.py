"""What the study computes: pressures, adhesions, durations, its cases by name, and what the talk prints of them."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

from msgspec.structs import replace

from harness.scene.model import Biaxial
from harness.studies.reproduce.boxes import PAPER_COUNT, base_scene, shipped, varied
from harness.studies.reproduce.cohesion.drives import drive_cases
from harness.studies.reproduce.cohesion.preparations import preparation_cases
from harness.studies.reproduce.protocol import Ask, Case, Declared
from reference.values import published_values

FILE = shipped("biaxial_cohesion")

PRESSURES = (100.0, 500.0)
RATIOS = {"0": 0.0, "1/2": 0.5, "1": 1.0, "2": 2.0, "4": 4.0}
"""k_c/k_2 as the talk writes it."""

DURATIONS = {"quick": (0.04, 0.08), "paper": (0.08, 0.16, 0.32)}
"""Of the drive, s. The main one is the second; the others show the convergence, at `OF_RATE`."""

MAIN = 1
OF_RATE = ("0", "1")
"""k_c/k_2 whose convergence is shown."""

LOW, HIGH = PRESSURES
MEMORY = f"prepared at {HIGH:g} N/m"

PLATEAU = "plateau sigma_zz"

SIZES = {
    "quick": Declared(says="300 discs, T = 0.08 s", packings=3),
    "paper": Declared(says=f"{PAPER_COUNT} discs, T = 0.16 s", packings=4),
}


def cases(ask: Ask) -> list[Case]:
    """Return the main tests, those at other rates, and what is looked at besides: other drives, another preparation."""
    main, tests = main_cases(ask), main_tests(ask)
    others = [t for k, t in enumerate(DURATIONS[ask.size]) if k != MAIN]
    rated = [_case(ask, p, r, t) for t in others for p in PRESSURES for r in OF_RATE]
    return [*main, *rated, *drive_cases(without_adhesion(tests), FILE), *preparation_cases(tests, FILE)]


def main_cases(ask: Ask) -> list[Case]:
    """Return the ten tests, and five of them again from the preparation at the larger pressure."""
    main = DURATIONS[ask.size][MAIN]
    found = [_case(ask, p, r, main) for p in PRESSURES for r in RATIOS]
    return found + [_case(ask, LOW, r, main, memory=True) for r in RATIOS]


def main_tests(ask: Ask) -> dict[tuple[float, str], Biaxial]:
    """Return the ten tests by side pressure and k_c/k_2."""
    return {key: c.scene for key, c in zip(itertools.product(PRESSURES, RATIOS), main_cases(ask), strict=False)}


def without_adhesion(tests: Mapping[tuple[float, str], Biaxial]) -> dict[float, Biaxial]:
    """Return those at k_c = 0, by side pressure."""
    return {p: scene for (p, ratio), scene in tests.items() if ratio == "0"}


def _case(ask: Ask, pressure: float, ratio: str, duration: float, *, memory: bool = False) -> Case:
    base = base_scene(FILE)
    count = PAPER_COUNT if ask.size == "paper" else base.particles.count
    law = base.contact.normal
    adhesion = RATIOS[ratio] * law.unloading_stiffness
    scene = varied(
        base, FILE, count=count, pressure=pressure, duration=duration,
        prepared_at=HIGH if memory else None,
        title=f"Cohesive box, k_c/k_2 = {RATIOS[ratio]:g}, p = {pressure:g} N/m, T = {duration:g} s, {count} discs"
        + f", {MEMORY}" * memory,
        contact=replace(base.contact, normal=replace(law, adhesion_stiffness=adhesion)),
        compare=replace(base.compare, windows=() if memory else base.compare.windows),  # let go, the box rings at first
    )
    name = case_name(pressure, ratio, duration, memory=memory)
    return Case(name=name, scene=scene, file=FILE, packings=ask.packings or SIZES[ask.size].packings)


def case_name(pressure: float, ratio: str, duration: float, *, memory: bool = False) -> str:
    """Return the name of a test."""
    return f"p_x = {pressure:g} N/m, k_c/k_2 = {ratio}, T = {duration:g} s" + f", {MEMORY}" * memory


# --- what the talk prints -------------------------------------------------------------------------


def value_key(ratio: str) -> str:
    """Return k_c/k_2 as names of published values have it."""
    return f"{RATIOS[ratio]:g}".replace(".", "_")


def talk_without_adhesion() -> dict[float, float]:
    """Return sigma_zz at k_c = 0 by side pressure, N/m."""
    return {p: talk_plateau(p, "0") for p in PRESSURES}


def talk_cohesions() -> dict[str, float]:
    """Return c by k_c/k_2, N/m."""
    return {r: published_values()[f"talk_macro_cohesion_{value_key(r)}"].value for r in RATIOS}


def talk_plateau(pressure: float, ratio: str) -> float:
    """Return sigma_zz, N/m."""
    return published_values()[f"talk_cohesion_{pressure:g}_{value_key(ratio)}"].value
