"""Small asks, runs of boxes made by hand, and outcomes."""

from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from harness.engines.registry import choose_engines
from harness.studies.compare.curves import BiaxialCurves
from harness.studies.reproduce.boxes import BoxRun
from harness.studies.reproduce.protocol import Ask
from harness.studies.reproduce.runs import Made


@pytest.fixture
def ask(tmp_path):
    """ask("quick", "kernel:talk", packings=2) is what a user would ask."""

    def make(size="quick", *words, **more) -> Ask:
        return Ask(size=size, engines=choose_engines(list(words) or ["kernel:talk"]), out=tmp_path, **more)

    return make


@pytest.fixture
def tiny(monkeypatch):
    """tiny(module, count, duration) makes a study's boxes small and its drives short."""

    def make(module, count: int, part: float):
        real = module.base_scene

        def small(file):
            scene = real(file)
            return replace(scene, particles=replace(scene.particles, count=count))

        monkeypatch.setattr(module, "base_scene", small)
        monkeypatch.setattr(
            module, "DURATIONS", {size: tuple(t * part for t in of) for size, of in module.DURATIONS.items()}
        )
        if hasattr(module, "COUNTS"):
            monkeypatch.setattr(module, "COUNTS", dict.fromkeys(module.COUNTS, count))

    return make


@pytest.fixture
def curves():
    """curves(strain, force_top, ...) are those of a box 1 m by 1 m whose side is pressed by 100 N/m."""

    def make(strain, *, stress=None, width=None, pressure=100.0) -> BiaxialCurves:
        strain = np.asarray(strain, float)
        x = np.ones(len(strain)) if width is None else np.asarray(width, float)
        z, n = 1.0 - strain, np.arange(len(strain))
        top = x * (pressure if stress is None else np.asarray(stress, float))
        return BiaxialCurves(
            step=n, time=1e-3 * n, strain=strain, x=x, z=z, force_top=top, force_bottom=top,
            force_left=pressure * z, force_right=pressure * z, pressure=pressure,
        )

    return make


@pytest.fixture
def box_run(curves):
    """box_run(**numbers) is a run with such numbers."""

    def make(numbers, **more) -> BoxRun:
        return BoxRun(curves=curves([0.0, 0.1]), numbers=numbers, inertia=1e-4, control=0.0, **more)

    return make


@pytest.fixture
def made():
    """made(case, engine, packing, found) is a finished run."""

    def make(case: str, engine: str, packing: int, found) -> Made:
        return Made(case=case, engine=engine, packing=packing, outcome=None, folder=Path(), found=found)

    return make


