"""Energies and overlaps of contacts whose numbers depend on who touches whom."""

from dataclasses import replace

import numpy as np
import pytest

from harness.scene.contact import Between, Contact, LinearNormal, NormalNumbers, SlidingNumbers, SpringSliding
from harness.scene.load import load_scene
from harness.scene.materials import materials_of
from harness.scene.resolve import resolve
from harness.scene.system import Wall
from harness.studies.stability.cases import shipped_folder
from harness.studies.stability.invariants import KINDS
from harness.studies.stability.seen import Seen

CONTACT = Contact(
    normal=LinearNormal(normal_stiffness=100.0, normal_damping=0.0, attraction="allowed"),
    sliding=SpringSliding(shear_friction=0.5, shear_stiffness=20.0, shear_damping=0.0),
    between=(
        Between(materials=("soft", "stiff"), normal=NormalNumbers(normal_stiffness=200.0, normal_damping=0.0)),
        Between(
            materials=("stiff", "stiff"), normal=NormalNumbers(normal_stiffness=1e6, normal_damping=0.0),
            sliding=SlidingNumbers(shear_friction=0.5, shear_stiffness=3e5, shear_damping=0.0),
        ),
    ),
)
FLOOR = Wall(index=1, name="floor", point=(0.0, 0.0), normal=(0.0, 1.0), friction=False, material="stiff")
WORDS = ("stiff", "stiff", "soft", "soft")
SPRINGS = np.array([1e6, 1e6, 200.0, 100.0])
"""From the floor upwards."""


def stacked(states, *, words=WORDS, contacts=None):
    """Four discs of 1 kg and radius 1 at rest on a stiff floor; gravity 1 m/s^2; two frames."""
    overlaps = np.array([4.0, 3.0, 2.0, 1.0]) / SPRINGS
    y = np.cumsum([1.0, 2.0, 2.0, 2.0] - overlaps)
    x = np.stack([np.zeros(4), y], axis=1)[None].repeat(2, axis=0)
    run = states.seen(x, walls=(FLOOR,), gravity=(0.0, -1.0), contacts=contacts)
    materials = materials_of(CONTACT, (*words, "stiff"))
    system = replace(
        run.system, particles=replace(run.system.particles, material=np.array(words)), materials=materials,
        sliding=CONTACT.sliding,
    )
    return Seen(system=system, trajectory=run.trajectory)


def test_a_column_rests_on_the_springs_of_its_pairs(states):
    run = stacked(states)
    assert KINDS["column"].measure(run, states.promise("column")) < 1e-9
    held = 0.5 * np.array([16.0, 9.0, 4.0, 1.0]) / SPRINGS
    assert run.elastic == pytest.approx([held.sum()] * 2, rel=1e-9)


@pytest.mark.parametrize("words", [("soft", "soft", "stiff", "stiff"), ("stiff", "soft", "stiff", "soft")])
def test_other_materials_would_be_caught(states, words):
    assert KINDS["column"].measure(stacked(states, words=words), states.promise("column")) > 0.1


def test_springs_count_with_the_stiffness_of_their_pair(states):
    """k_t u^2/2 of three contacts, one of them at the wall."""
    table = {"i": [1.0, 2.0, 3.0, 1.0], "j": [2.0, 3.0, 4.0, -1.0], "ux": [1e-3, 1e-2, 0.1, 1e-4], "uy": [0.0] * 4}
    run = stacked(states, contacts={name: np.array(column) for name, column in table.items()})
    exact = 0.5 * (3e5 * 1e-6 + 20.0 * 1e-4 + 20.0 * 1e-2 + 3e5 * 1e-8)
    assert run.sheared == pytest.approx([exact] * 2, rel=1e-12)


@pytest.fixture(scope="module")
def pairs():
    """The hard case of three pairs, its promise of the last velocities, and a run of LAMMPS with given materials."""
    from harness.engines.lammps import LAMMPS

    if not LAMMPS.probe().available:
        pytest.skip(LAMMPS.probe().detail)
    file = shipped_folder() / "stiff_and_soft_pairs.toml"
    scene = load_scene(file)
    system = resolve(scene, file)

    def measured(folder, words):
        turned = replace(system.particles, material=np.array([words[w] for w in system.particles.material.tolist()]))
        for name, text in LAMMPS.render(system.with_(particles=turned)).items():
            (folder / name).write_text(text)
        assert LAMMPS.run(folder, time_limit=60.0).status == "completed"
        seen = Seen(system=system, trajectory=LAMMPS.read(folder, system))
        promised = next(i for i in scene.expect.invariants if i.name == "end_velocities")
        return KINDS["end_velocities"].measure(seen, promised) / promised.tolerance

    return measured


def test_the_hard_case_holds(pairs, tmp_path):
    assert pairs(tmp_path, {"stiff": "stiff", "soft": "soft"}) < 1.0


def test_the_hard_case_catches_a_table_that_is_turned_round(pairs, tmp_path):
    """The mutant: who is stiff is taken for soft. The mixed pair is none the wiser, the others are."""
    assert pairs(tmp_path, {"stiff": "soft", "soft": "stiff"}) > 10.0
