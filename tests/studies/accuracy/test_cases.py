"""Effects taken away one after the other."""

from pathlib import Path

import msgspec

from harness.scene.contact import HertzNormal
from harness.scene.load import load_scene
from harness.studies.accuracy.cases import cases_of, undamped

FOLDER = Path(__file__).resolve().parents[3] / "inputs" / "scenes"


def test_only_cases_that_differ():
    found = cases_of(load_scene(FOLDER / "oblique_impact.toml"))
    assert [c.name for c in found] == ["as declared", "without friction", "without friction and dashpot"]
    assert [c.declared for c in found] == [True, False, False]
    assert found[1].scene.contact.sliding is None
    assert found[1].scene.contact.normal.normal_damping == 0.1
    assert found[2].scene.contact.normal.normal_damping == 0.0
    assert [c.name for c in cases_of(found[1].scene)] == ["as declared", "without dashpot"]
    assert len(cases_of(found[2].scene)) == 1


def test_hertz_loses_its_dashpot_by_its_restitution():
    law = HertzNormal(youngs_modulus=1e7, poisson_ratio=0.3, restitution=0.7, attraction="clipped", impact_speed=1.0)
    assert undamped(law) == msgspec.structs.replace(law, restitution=1.0)
