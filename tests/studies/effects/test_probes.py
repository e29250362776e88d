"""Off is the coefficient at zero: on the kernel, and a kernel whose zero is not nothing."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from harness.engines.registry import ENGINES
from harness.scene.load import load_scene
from harness.scene.resolve import resolve
from harness.studies.effects.pairs import on_and_off
from harness.studies.effects.probes import deviation, probe
from harness.studies.effects.variants import variants_of
from harness.studies.prepare import Prepared

SCENES = Path(__file__).resolve().parents[3] / "inputs" / "scenes"
KERNEL = ENGINES["kernel:talk"]


@pytest.fixture(scope="module")
def pairs():
    file = SCENES / "oblique.toml"
    scene = load_scene(file)
    start = Prepared(number=0, system=resolve(scene, file), packing=None)
    only = ("normal damping", "damping attraction", "sliding friction", "background drag", "gravity")
    return on_and_off(scene, file, start, variants_of(scene, file, [start], only))


def probed(pairs, engine, out):
    return probe(pairs, [engine], out, time_limit=60.0, workers=2, progress=None)


@pytest.fixture(scope="module")
def found(pairs, tmp_path_factory):
    return probed(pairs, KERNEL, tmp_path_factory.mktemp("probes"))


def test_zero_is_off_to_round_off(found):
    checks = {c.effect: c for c in found.checks}
    for effect in ("normal damping", "sliding friction", "background drag", "gravity"):
        assert checks[effect].verdict == "agrees", checks[effect]
        assert checks[effect].deviation <= 1e-12
        assert checks[effect].acts > 1e-4


def test_what_has_no_coefficient_is_not_checked(found):
    check = next(c for c in found.checks if c.effect == "damping attraction")
    assert (check.verdict, check.deviation) == ("not_checked", None)
    assert "yes or no" in check.why


def test_output_has_no_spring_without_friction(found):
    on, off = (found.columns["sliding friction", "kernel:talk", which] for which in ("on", "off"))
    assert "series.step" in on
    assert not off - on


@dataclass(frozen=True)
class Rough:
    """A kernel that cannot have no friction: a coefficient of 0 becomes 1e-3."""

    name: str = "kernel:talk"

    def __getattr__(self, name):
        return getattr(KERNEL, name)

    def render(self, system):
        sliding = system.sliding
        if sliding is not None and sliding.shear_friction == 0.0:
            from msgspec.structs import replace as changed

            system = replace(system, sliding=changed(sliding, shear_friction=1e-3))
        return KERNEL.render(system)


def test_a_zero_that_is_not_nothing_is_found(pairs, tmp_path):
    check = next(c for c in probed([p for p in pairs if p.effect == "sliding friction"], Rough(), tmp_path).checks)
    assert check.verdict == "differs"
    assert check.deviation > 1e-6


def test_an_effect_that_does_nothing_is_no_pass(pairs, tmp_path):
    """Weight that is so small that no digit of the run shows it."""
    pair = next(p for p in pairs if p.effect == "gravity")
    faint = replace(pair, on=pair.on.with_(gravity=(0.0, -1e-30)))
    (check,) = probed([faint], KERNEL, tmp_path).checks
    assert check.verdict == "not_checked"
    assert "changes nothing" in check.why


@dataclass(frozen=True)
class Dividing:
    """An engine whose deck divides by the coefficient."""

    name: str = "kernel:talk"

    def __getattr__(self, name):
        return getattr(KERNEL, name)

    def render(self, system):
        if system.background is not None:
            1.0 / system.background.translational_drag  # noqa: B018
        return KERNEL.render(system)


def test_a_deck_that_cannot_say_zero_is_not_checked(pairs, tmp_path):
    (check,) = probed([p for p in pairs if p.effect == "background drag"], Dividing(), tmp_path).checks
    assert check.verdict == "not_checked"
    assert "cannot say it" in check.why


def test_deviation_of_a_run_from_itself_and_from_nan(box):
    run = box.trajectory()
    assert deviation(run, run) == 0.0
    moved = replace(run, frames=tuple(
        replace(f, particles=type(f.particles)({k: np.nan * v if k == "x" else v for k, v in f.particles.items()}))
        for f in run.frames
    ))
    assert deviation(run, moved) == np.inf
