"""LAMMPS turns the springs of rough bodies late; the program kernel with it, in trajectories of many bodies."""

import dataclasses

import msgspec
import numpy as np
import pytest

from harness.engines.kernel.bench import PROGRAM, TEXTBOOK
from harness.engines.lammps.bench import GRANULAR
from harness.engines.session import Session
from harness.studies.bench.cases import find_case
from harness.studies.bench.problem import problem


def places_after(timed, system, folder, steps):
    folder.mkdir()
    for name, text in timed.render(system, skin=5e-5).items():
        (folder / name).write_text(text)
    with Session(timed, folder, core=None, time_limit=120.0) as session:
        session.run(steps)
        return session.places()


@pytest.mark.parametrize("mu", [1e3, 1e4])
def test_rough_discs_move_as_in_lammps(tmp_path, mu):
    """A hundred discs in a rough box, 600 steps: 1e-14 diameters; springs that are turned at once give 1e-9."""
    case = dataclasses.replace(find_case("2D friction"), speed=0.05)
    system, _ = problem(case, 100, cache=tmp_path / "packings")
    system = system.with_(sliding=msgspec.structs.replace(system.sliding, shear_friction=mu))
    expected, program, textbook = (
        places_after(timed, system, tmp_path / name, 600)
        for name, timed in (("lammps", GRANULAR), ("program", PROGRAM), ("textbook", TEXTBOOK)))
    diameter = 2.0 * system.particles.radius.mean()
    assert np.abs(expected - system.particles.x).max() > 1e-4 * diameter
    assert np.abs(program - expected).max() < 1e-12 * diameter
    assert np.abs(textbook - expected).max() < 1e-12 * diameter
