"""The numbers judged over replicates, of a box whose every curve is known."""

import numpy as np
import pytest

from harness.studies.compare.biaxial_quantities import OneRun, biaxial_quantities, frames_near
from harness.studies.compare.curves import biaxial_curves


@pytest.fixture
def judged(box):
    return box.changed(("plateau = ", "strains = [0.02, 0.05]\nplateau = "))


def run_of(box, trajectory=None, *, engine="lammps", replicate=0):
    t = trajectory or box.trajectory()
    return OneRun(
        engine=engine, replicate=replicate, curves=biaxial_curves(t, box.system), trajectory=t, system=box.system
    )


def test_values_are_those_of_the_curves(judged):
    """sigma_zz = p (1 + 20 eps), x = x_0 (1 + eps/2): smoothed over the samples around, 1 % coarser than the curve."""
    found = {m.quantity: m for m in biaxial_quantities(judged.scene, [run_of(judged)])}
    assert found["sigma_zz at 5 % strain"].values["lammps"][0] == pytest.approx(200.0, rel=0.01)
    volume = found["volume strain at 2 % strain"]
    assert volume.values["lammps"][0] == pytest.approx(1 - 1.01 * 0.98, rel=0.05)
    assert volume.scale == 0.02
    assert found["plateau sigma_zz"].values["lammps"][0] == pytest.approx(250.0, rel=0.01)


def test_time_averages_have_an_error_of_their_own_and_values_at_a_strain_none(judged):
    found = {m.quantity: m for m in biaxial_quantities(judged.scene, [run_of(judged)])}
    assert found["plateau sigma_zz"].run_error("lammps") > 0
    assert found["sigma_zz at 5 % strain"].run_error("lammps") is None


def test_replicates_and_engines_stand_beside_each_other(judged, mutate):
    weak = mutate.series(judged.trajectory(), top_fy=lambda f: 0.5 * f)
    runs = [run_of(judged), run_of(judged, replicate=3), run_of(judged, weak, engine="liggghts")]
    found = {m.quantity: m for m in biaxial_quantities(judged.scene, runs)}
    values = found["plateau sigma_zz"].values
    assert {e: list(of) for e, of in values.items()} == {"lammps": [0, 3], "liggghts": [0]}
    assert values["liggghts"][0] == pytest.approx(0.5 * values["lammps"][0])


def test_frames_are_the_nearest_ones_once_each_without_the_start(judged):
    run = run_of(judged)
    own = [judged.strain(f.time) for f in run.trajectory]
    near = frames_near((1e-6, 0.02, 0.0201, 0.05), run)
    assert len(near) == 2
    for strain, k in near.items():
        assert strain == pytest.approx(own[k])
        assert min(abs(s - strain) for s in (0.02, 0.05)) < np.diff(own).max()


def test_without_strains_and_plateau_little_is_left(box):
    bare = box.changed(("plateau = [0.05, 0.1]\n", ""))
    assert biaxial_quantities(bare.scene, [run_of(bare)]) == []
