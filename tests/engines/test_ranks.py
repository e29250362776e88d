"""Several MPI processes: the same numbers as one, and a refusal where a code makes others of them."""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.engines.lammps.partition import balance_lines
from harness.engines.ranks import cuts, grid
from harness.engines.registry import CODES
from harness.scene.contact import HystereticNormal, LinearNormal, SpringRolling, SpringSliding
from harness.scene.system import Particles, System, Wall
from harness.studies.compare.growth import column_deviation, displacement_deviation

NORMAL = LinearNormal(normal_stiffness=1e5, normal_damping=0.5, attraction="allowed")
SLIDING = SpringSliding(shear_friction=0.4, shear_stiffness=3e4, shear_damping=0.2)
ROLLING = SpringRolling(rolling_friction=0.1, rolling_stiffness=3e4, rolling_damping=0.1)
PLASTIC = HystereticNormal(
    loading_stiffness=5e4, unloading_stiffness=1e5, adhesion_stiffness=5e4, normal_damping=0.5
)


@pytest.fixture(params=CODES)
def code(request):
    """A code that is installed, with what starts several processes of it."""
    found = CODES[request.param]
    if not found.on(2).probe().available:
        pytest.skip(found.on(2).probe().detail)
    return found


def run(engine, system, folder: Path, **limits):
    folder.mkdir()
    for name, text in engine.render(system).items():
        (folder / name).write_text(text)
    return engine.run(folder, **({"time_limit": 60.0} | limits))


def trajectory(engine, system, folder):
    result = run(engine, system, folder)
    assert result.status == "completed", result
    return engine.read(folder, system)


def stream(dim: int, **laws) -> System:
    """A dense periodic box of spinning bodies that all go through every cut twice, their contacts with them."""
    rng, side, cell, dt, steps = np.random.default_rng(3), 4 if dim == 2 else 3, 1.96e-3, 2e-6, 600
    x = (np.array(np.meshgrid(*[range(side)] * dim, indexing="ij")).reshape(dim, -1).T + 0.5) * cell
    count, length = len(x), side * cell
    speed = np.zeros(dim)
    speed[0] = 2 * length / (steps * dt)
    grains = Particles(
        x=x + rng.uniform(-3e-5, 3e-5, x.shape), radius=np.full(count, 1e-3), mass=np.full(count, 1e-5),
        inertia_factor=np.full(count, 0.5 if dim == 2 else 0.4), v=speed + rng.normal(0, 0.2, x.shape),
        spin=rng.normal(0, 200, (count, 1 if dim == 2 else 3)),
    )
    fields = {"normal": NORMAL, "sliding": SLIDING} | laws
    return System(
        dimension=dim, particles=grains, walls=(), background=None, gravity=None, periodic=(length,) * dim, dt=dt,
        steps=steps, sample_every=60, frame_every=60, contacts=False, **fields,
    )


def flight(**laws) -> System:
    """Two bodies that stick together and fly through the middle of a long box one after the other."""
    x = np.array([[7e-3, 5e-3], [8.96e-3, 5e-3]])
    grains = Particles(
        x=x, radius=np.full(2, 1e-3), mass=np.full(2, 1e-5), inertia_factor=np.full(2, 0.5),
        v=np.array([[5.3, 0.1], [4.7, -0.1]]), spin=np.array([[200.0], [80.0]]),
    )
    ends = {"left": ((0.0, 0.0), (1.0, 0.0)), "right": ((20e-3, 0.0), (-1.0, 0.0)), "low": ((0.0, 0.0), (0.0, 1.0)),
            "high": ((0.0, 10e-3), (0.0, -1.0))}
    walls = tuple(
        Wall(index=k, name=name, point=point, normal=normal, friction=False)
        for k, (name, (point, normal)) in enumerate(ends.items(), start=1)
    )
    return System(
        dimension=2, particles=grains, walls=walls, background=None, gravity=None, periodic=None, dt=1e-6, steps=800,
        sample_every=80, frame_every=80, contacts=True, **({"sliding": SLIDING} | laws),
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_two_processes_compute_what_one_does(code, dim, tmp_path):
    """Sums in another order are all that is left; the bodies have gone through every cut."""
    system = stream(dim)
    one, two = (trajectory(code.on(n), system, tmp_path / str(n)) for n in (1, 2))
    assert displacement_deviation(one, two, system.periodic) < 1e-11
    assert column_deviation(one, two, ("vx", "vy", "vz")) < 1e-10
    assert column_deviation(one, two, ("wx", "wy", "wz")) < 1e-10


def test_walls_and_contacts_are_told_alike(code, tmp_path):
    system = flight(normal=NORMAL)
    one, two = (trajectory(code.on(n), system, tmp_path / str(n)) for n in (1, 2))
    assert displacement_deviation(one, two) < 1e-12
    for a, b in zip(one, two, strict=True):
        assert a.contacts.rows == b.contacts.rows
        for c in a.contacts:
            assert np.allclose(a.contacts[c], b.contacts[c], rtol=1e-9, atol=1e-15), c
    assert any(f.contacts.rows for f in one)


WRONG = {
    "lammps": ("rolling resistance", stream(2, rolling=ROLLING), ("wx", "wy", "wz")),
    "liggghts": ("plastic memory", flight(normal=PLASTIC).with_(contacts=False), ("vx", "vy", "vz")),
}


def test_what_two_processes_get_wrong_is_refused(code, tmp_path):
    """Shown by running it all the same: the day it is right the refusal has to go."""
    effect, system, columns = WRONG[code.name]
    refused = [s for s in code.on(2).supports(system) if s.level == "known_wrong"]
    assert [s.effect for s in refused] == [effect]
    assert not [s for s in code.supports(system) if s.level in ("known_wrong", "unsupported")]
    one, two = (trajectory(code.on(n), system, tmp_path / str(n)) for n in (1, 2))
    assert column_deviation(one, two, columns) > 1e-3


def test_all_processes_of_a_run_end_with_its_time(code, tmp_path):
    system = replace(stream(3), steps=10**8, sample_every=10**6, frame_every=10**7)
    result = run(code.on(2), system, tmp_path / "run", time_limit=1.5)
    assert result.status == "timed_out"
    assert not working_in(tmp_path / "run", patience=10.0)


def working_in(folder: Path, patience: float) -> list[str]:
    """Return the processes that work in a folder, none as soon as there are none."""
    end = time.monotonic() + patience
    while True:
        found = [p.name for p in Path("/proc").glob("[0-9]*") if at(p) == str(folder)]
        if not found or time.monotonic() > end:
            return found
        time.sleep(0.1)


def at(process: Path) -> str:
    try:
        return str((process / "cwd").readlink())
    except OSError:
        return ""


def test_an_error_of_one_is_that_of_the_run(code, tmp_path):
    """The deck is spoilt at its end, when all processes are at work."""
    class Spoilt(type(code)):
        def render(self, system):
            name = f"in.{code.name}"
            files = super().render(system)
            return files | {name: files[name].replace(f"run {system.steps}", f"run {system.steps}\nnonsense", 1)}

    spoilt = Spoilt(ranks=2)
    result = run(spoilt, replace(stream(2), steps=60), tmp_path / "run")
    assert result.status == "crashed"
    assert "nonsense" in result.reason


def test_bodies_lost_on_any_process_are_missed(code, tmp_path):
    """Two bodies leave the box sideways, one on either process."""
    system = flight(normal=NORMAL)
    away = replace(system.particles, x=np.array([[5e-3, 9.5e-3], [15e-3, 9.5e-3]]), v=np.array([[0.0, 900.0]] * 2))
    result = run(code.on(2), system.with_(particles=away, contacts=False), tmp_path / "run")
    assert result.status == "unstable", result


# --- how a box is cut ------------------------------------------------------------------------------


def test_the_grid_cuts_the_long_sides():
    system = flight(normal=NORMAL)
    assert grid(system, 1) == (1, 1, 1)
    assert grid(system, 2) == (2, 1, 1)
    assert grid(stream(3), 8) == (2, 2, 2)
    assert sorted(grid(stream(2), 6)) == [1, 2, 3]
    assert grid(stream(2), 6)[2] == 1
    assert grid(stream(3), 7) in ((7, 1, 1), (1, 7, 1), (1, 1, 7))


def test_cuts_share_bodies_out():
    system = stream(2)
    for count in (2, 3, 4):
        edges = [-np.inf, *cuts(system, 0, count), np.inf]
        shares, _ = np.histogram(system.particles.x[:, 0], edges)
        assert shares.max() - shares.min() <= 1


def test_bodies_in_one_line_leave_the_cut_where_it_is():
    from harness.engines.lammps.box import simulation_box

    system = flight(normal=NORMAL)
    box = simulation_box(system)
    assert balance_lines(system, box, 1) == []
    assert balance_lines(system, box, 2)[0].startswith("balance 1.0 x 0.")
    stacked = system.with_(particles=replace(system.particles, x=np.array([[7e-3, 5e-3], [7e-3, 6.96e-3]])))
    assert grid(stacked, 2) in ((1, 2, 1), (2, 1, 1))


def test_a_deck_for_one_process_says_nothing_of_several(code):
    system = stream(2)
    assert code.on(1).render(system) == code.render(system)
    lines = code.render(system)[f"in.{code.name}"].split("\n")
    assert not any(line.startswith(("processors", "balance")) for line in lines)
