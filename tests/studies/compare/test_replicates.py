"""What replicates are made of: packings, kicks, the response; what cannot be replicated."""

import numpy as np
import pytest

from harness.engines.registry import choose_engines, find_engine
from harness.errors import InputError
from harness.scene.load import load_scene
from harness.studies.compare.replicates import (
    AS_DECLARED,
    make_starts,
    planned_runs,
    replicate_count,
    responder,
    start_system,
)
from harness.studies.prepare import Prepared

LAMMPS, KERNEL = find_engine("lammps"), find_engine("kernel:lammps")


def digests(start, engines, *, replicated=True):
    return [start_system(start, e, replicated=replicated).particles_digest() for e in engines]


def test_the_first_replicate_is_the_same_for_all_and_the_plain_run(box):
    first = Prepared(number=0, system=box.system, packing=None)
    assert digests(first, (LAMMPS, KERNEL)) == 2 * [box.system.particles_digest()]


def test_later_ones_are_kicked_each_engine_on_its_own(box):
    starts = [Prepared(number=k, system=box.system, packing=None) for k in (1, 2)]
    found = [d for s in starts for d in digests(s, (LAMMPS, KERNEL))]
    assert len({*found, box.system.particles_digest()}) == 5
    assert digests(starts[0], (LAMMPS, KERNEL), replicated=False) == 2 * [box.system.particles_digest()]


def test_every_engine_runs_every_start_and_the_response_comes_last(box):
    starts = [Prepared(number=k, system=box.system, packing=None) for k in range(2)]
    plan = planned_runs(box.scene, starts, (LAMMPS, KERNEL), replicated=True)
    assert [p.label for p in plan] == [
        "lammps #1", "kernel:lammps #1", "lammps #2", "kernel:lammps #2", "kernel:lammps kicked"
    ]
    assert [p.of for p in plan] == 4 * [""] + ["kernel:lammps"]
    moved = plan[-1].system.particles.x - box.system.particles.x
    assert np.count_nonzero(moved.any(axis=1)) == 1
    assert len({p.system.particles_digest() for p in plan}) == 4
    assert [p.label for p in planned_runs(box.scene, starts[:1], (LAMMPS,), replicated=False)] == ["lammps"]


def test_a_kernel_responds_and_else_the_code_that_is_compared_with_itself(box):
    names = lambda *words: tuple(find_engine(w) for w in words)  # noqa: E731
    assert responder(box.scene, names("lammps", "liggghts", "kernel:lammps")).name == "kernel:lammps"
    assert responder(box.scene, names("lammps", "liggghts")) is None
    assert responder(box.scene, names("kernel:lammps")) is None


def test_free_bodies_have_no_response(flight):
    engines = choose_engines(["lammps", "kernel"])
    assert responder(load_scene(flight), engines) is None


def test_counts(box, flight):
    assert replicate_count(box.scene, None) is None
    assert replicate_count(box.scene, 5) == 5
    declared = box.changed(("plateau", "replicates = 7\nplateau"))
    assert replicate_count(declared.scene, AS_DECLARED) == 7
    for scene, asked, words in (
        (box.scene, AS_DECLARED, "declares none"), (box.scene, 1, "from 2 to 1000"), (box.scene, 1001, "from 2"),
        (load_scene(flight), 4, 'kind = "free"'),
    ):
        with pytest.raises(InputError, match=words):
            replicate_count(scene, asked)


def test_a_packing_from_a_file_is_one_packing_kicked(box, tmp_path):
    (tmp_path / "nine.csv").write_text("id,x,y,radius\n" + "".join(
        f"{k + 1},{0.001 + 0.002 * (k % 3)},{0.001 + 0.002 * (k // 3)},0.001\n" for k in range(9)
    ))
    filed = box.changed(("count = 9, seed = 1, ", ""), (
        "radius = {kind = \"uniform\", min = 0.9e-3, max = 1.1e-3}", "packing = \"nine.csv\""
    ))
    starts = make_starts(
        filed.scene, filed.file, packings=None, replicates=3, cache=tmp_path / "packings", progress=None
    )
    assert [s.number for s in starts] == [0, 1, 2]
    assert len({s.system.particles_digest() for s in starts}) == 1


def test_packings_of_replicates_follow_from_the_seed(box, tmp_path):
    starts = make_starts(box.scene, box.file, packings=None, replicates=2, cache=tmp_path / "packings", progress=None)
    assert len({s.system.particles_digest() for s in starts}) == 2
