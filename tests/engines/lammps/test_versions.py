"""Another version of LAMMPS: ours under another name, and the one that $GRAINPROOF_OTHER_LAMMPS names."""

import os
import sys

import numpy as np
import pytest

from harness.engines.lammps import LAMMPS
from harness.engines.lammps.changes import CHANGES
from harness.engines.registry import find_engine
from harness.scene.contact import LinearNormal, SpringRolling
from harness.scene.system import Particles, System
from harness.studies.compare.growth import column_deviation, displacement_deviation

OTHER = "GRAINPROOF_OTHER_LAMMPS"
needs_other = pytest.mark.skipif(OTHER not in os.environ, reason=f"${OTHER} names no other Python with LAMMPS")
ROLLING = SpringRolling(rolling_friction=0.1, rolling_stiffness=2e3, rolling_damping=0.01)


@pytest.fixture
def here_elsewhere():
    return find_engine(f"lammps@{sys.executable}")


def touching(dim: int = 3, spin: float = 1.0, gap: float = 0.0, **laws) -> System:
    """Two spinning bodies that touch at the start."""
    x = np.zeros((2, dim))
    x[1, :2] = [1.5e-3 + gap, 1.2e-3 + gap]
    spins = [[200.0], [-80.0]] if dim == 2 else [[200.0, 30.0, 40.0], [-50.0, 10.0, 70.0]]
    grains = Particles(
        x=x, radius=np.full(2, 1e-3), mass=np.full(2, 1e-5), inertia_factor=np.full(2, 0.5 if dim == 2 else 0.4),
        v=np.zeros((2, dim)), spin=spin * np.array(spins),
    )
    fields = {"normal": LinearNormal(normal_stiffness=1e5, normal_damping=1.0, attraction="allowed"), "sliding": None}
    return System(
        dimension=dim, particles=grains, walls=(), background=None, gravity=None, periodic=None, dt=2e-7, steps=200,
        sample_every=10, frame_every=10, contacts=False, **(fields | laws),
    )


def trajectory(engine, system, folder):
    folder.mkdir()
    for name, text in engine.render(system).items():
        (folder / name).write_text(text)
    result = engine.run(folder, time_limit=60.0)
    assert result.status == "completed", result
    return engine.read(folder, system)


def test_the_same_library_under_another_name_computes_the_same(here_elsewhere, tmp_path):
    """Through the other way of starting it, with nothing of this environment on its path but the harness."""
    system = touching(rolling=ROLLING)
    ours, theirs = (
        trajectory(e, system, tmp_path / str(k)) for k, e in enumerate((LAMMPS, here_elsewhere))
    )
    assert displacement_deviation(ours, theirs) == 0.0
    assert column_deviation(ours, theirs, ("wx", "wy", "wz")) == 0.0
    assert here_elsewhere.changes(system) == ()
    assert here_elsewhere.render(system) == LAMMPS.render(system)


def test_its_command_repeats_its_run(here_elsewhere, tmp_path):
    words = here_elsewhere.command(tmp_path)
    assert words[0] == sys.executable
    assert words[1].endswith("apart.py")
    assert words[-1] == str(tmp_path)


def test_a_change_is_said_where_it_matters_and_nowhere_else():
    (change,) = CHANGES
    assert change.touches(touching(rolling=ROLLING))
    assert change.touches(touching(2, rolling=ROLLING))
    assert not change.touches(touching())
    assert not change.touches(touching(2, spin=0.0, rolling=ROLLING))
    assert not change.touches(touching(gap=1e-3, rolling=ROLLING))


@needs_other
@pytest.mark.parametrize("dim", [2, 3])
def test_the_other_version_does_what_is_said_of_it(dim, tmp_path):
    """A change that is said shows; where none is said the versions are the same to the last bit."""
    other, system = find_engine(f"lammps@{os.environ[OTHER]}"), touching(dim, rolling=ROLLING)
    quiet = touching(dim)
    runs = {e.name: [trajectory(e, s, tmp_path / f"{e.name}-{k}") for k, s in enumerate((system, quiet))]
            for e in (LAMMPS, other)}
    (ours, ours_quiet), (theirs, theirs_quiet) = runs.values()
    shows = column_deviation(ours, theirs, ("wx", "wy", "wz")) > 1e-8
    assert shows == bool(other.changes(system))
    assert displacement_deviation(ours_quiet, theirs_quiet) == 0.0
    assert [s.note for s in other.supports(system) if s.level == "partial"] == list(other.changes(system))
