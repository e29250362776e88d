"""Numbers by pair of materials on every engine: each pair moves as if its numbers were those of all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.engines.kernel import KERNELS
from harness.engines.lammps import LAMMPS
from harness.engines.liggghts import LIGGGHTS
from harness.engines.protocol import takes
from harness.engines.registry import ENGINES
from harness.scene.contact import Between, Contact, LinearNormal, NormalNumbers, SlidingNumbers, SpringSliding
from harness.scene.materials import materials_of
from harness.scene.system import Constant, Loaded, Particles, System, Wall

BASE = Contact(
    normal=LinearNormal(normal_stiffness=1e3, normal_damping=0.01, attraction="allowed"),
    sliding=SpringSliding(shear_friction=0.3, shear_stiffness=3e2, shear_damping=0.02),
    between=(
        Between(
            materials=("stiff", "stiff"), normal=NormalNumbers(normal_stiffness=1e6, normal_damping=0.5),
            sliding=SlidingNumbers(shear_friction=0.5, shear_stiffness=2e5, shear_damping=0.2),
        ),
        Between(
            materials=("stiff", "soft"), normal=NormalNumbers(normal_stiffness=2e4, normal_damping=0.0),
            sliding=SlidingNumbers(shear_friction=0.4, shear_stiffness=4e3, shear_damping=0.05),
        ),
    ),
)
WORDS = ("stiff", "stiff", "stiff", "soft", "soft", "soft", "soft", "")
PAIRS = [("stiff", "stiff"), ("stiff", "soft"), ("soft", "soft"), ("soft", "")]
PLAIN = {"lammps": LAMMPS, "liggghts": LIGGGHTS}


def collisions(*, friction: bool, dim: int = 2) -> System:
    """Four oblique collisions beside each other, one a pair of materials, with spins."""
    row = np.arange(4)[:, None] * np.array([0.0, 0.01, 0.0][:dim])
    apart = np.array([2.02e-3, 3e-4, 2e-4][:dim])
    x = np.stack([row, row + apart], axis=1).reshape(8, dim)
    v = np.tile([[0.4, 0.05, 0.01][:dim], [-0.4, -0.1, 0.0][:dim]], (4, 1))
    spin = np.tile([[30.0], [-10.0]] if dim == 2 else [[30.0, 3.0, -5.0], [-10.0, 8.0, 20.0]], (4, 1))
    particles = Particles(
        x=x, radius=np.full(8, 1e-3), mass=np.tile([1e-5, 2e-5], 4), v=v, spin=spin,
        inertia_factor=np.full(8, 0.5 if dim == 2 else 0.4), material=np.array(WORDS),
    )
    contact = replace_contact(friction)
    return System(
        dimension=dim, particles=particles, walls=(), normal=contact.normal, sliding=contact.sliding, background=None,
        gravity=None, periodic=None, dt=2e-7, steps=2000, sample_every=500, frame_every=500, contacts=True,
        materials=materials_of(contact, WORDS), scene_name="materials",
    )


def replace_contact(friction: bool) -> Contact:
    if friction:
        return BASE
    bare = tuple(Between(materials=b.materials, normal=b.normal) for b in BASE.between)
    return Contact(normal=BASE.normal, between=bare)


def boxed(*, friction: bool, moving: bool) -> System:
    """Discs of all materials in a box of walls of two materials and one of none; with friction one wall is smooth."""
    rng = np.random.default_rng(4)
    x = np.stack(np.meshgrid([1e-3, 3.1e-3, 5.2e-3], [1e-3, 3.1e-3, 5.2e-3]), -1).reshape(-1, 2)
    words = ("soft", "stiff", "soft", "stiff", "", "stiff", "soft", "stiff", "")
    particles = Particles(
        x=x + rng.uniform(-2e-5, 2e-5, x.shape), radius=np.full(9, 1e-3), mass=np.full(9, 1e-5),
        v=0.3 * rng.normal(size=x.shape), spin=np.zeros((9, 1)), inertia_factor=np.full(9, 0.5),
        material=np.array(words),
    )
    loaded = Loaded(mass=1e-4, load=0.05, stress=0.0, span=None, damping=0.0) if moving else None
    walls = (
        Wall(index=1, name="floor", point=(0.0, -1e-5), normal=(0.0, 1.0), friction=friction, material="stiff"),
        Wall(index=2, name="left", point=(-1e-5, 0.0), normal=(1.0, 0.0), friction=False, material="soft",
             motion=Constant(velocity=(0.05, 0.0)) if moving else None),
        Wall(index=3, name="right", point=(6.21e-3, 0.0), normal=(-1.0, 0.0), friction=friction, material=""),
        Wall(index=4, name="lid", point=(0.0, 6.3e-3), normal=(0.0, -1.0), friction=friction, material="stiff",
             motion=loaded),
    )
    contact = replace_contact(friction)
    return replace(
        collisions(friction=friction), particles=particles, walls=walls, dt=1e-7, steps=2000, sample_every=100,
        frame_every=100, materials=materials_of(contact, (*words, *(w.material for w in walls))),
    )


@pytest.fixture(params=ENGINES.values(), ids=ENGINES)
def engine(request):
    if not request.param.probe().available:
        pytest.skip(f"{request.param.name}: {request.param.probe().detail}")
    return request.param


@pytest.fixture(params=PLAIN)
def both(request):
    """A code, and the kernel in its conventions."""
    code = PLAIN[request.param]
    if not code.probe().available:
        pytest.skip(f"{code.name}: {code.probe().detail}")
    return code, next(k for k in KERNELS if k.convention == request.param)


def perform(engine, system, folder):
    folder.mkdir()
    for name, text in engine.render(system).items():
        (folder / name).write_text(text)
    result = engine.run(folder, time_limit=60.0)
    assert result.status == "completed", (result.reason, result.last_lines)
    return engine.read(folder, system)


def only_pair(system: System, number: int) -> System:
    """The pair of a row alone, under laws that have its numbers for all."""
    rows = slice(2 * number, 2 * number + 2)
    alone = system.between(*PAIRS[number])
    return alone.with_(particles=alone.particles.rows(rows))


def columns(trajectory, names, rows=slice(None)):
    return np.array([[frame.particles[name][rows] for name in names] for frame in trajectory.frames])


def test_pairs_move_as_with_their_numbers_for_all(engine, tmp_path):
    system = collisions(friction=True)
    assert takes(engine, system)
    found = perform(engine, system, tmp_path / "all")
    for number in (0, 1, 3):
        alone = perform(engine, only_pair(system, number), tmp_path / f"pair{number}")
        for names, size in ((("x", "y"), 1e-3), (("vx", "vy"), 0.4), (("wz",), 100.0)):
            apart = columns(found, names, slice(2 * number, 2 * number + 2)) - columns(alone, names)
            apart -= apart[0]
            assert np.abs(apart).max() < 1e-9 * size
        assert np.abs(columns(alone, ("vx",)) - columns(alone, ("vx",))[0]).max() > 0.1


@pytest.mark.parametrize("friction", [False, True])
def test_spheres_as_in_the_kernel(both, tmp_path, friction):
    system = collisions(friction=friction, dim=3)
    found, wanted = (perform(e, system, tmp_path / e.name.replace(":", "_")) for e in both)
    assert columns(found, ("vx", "vy", "vz")) == pytest.approx(columns(wanted, ("vx", "vy", "vz")), abs=1e-11)
    assert columns(found, ("wx", "wy", "wz")) == pytest.approx(columns(wanted, ("wx", "wy", "wz")), abs=1e-8)


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("friction", [False, True])
def test_walls_of_materials_as_in_the_kernel(both, tmp_path, friction, moving):
    """Places, forces on walls and contacts; between walls and bodies every pair of materials meets."""
    system = boxed(friction=friction, moving=moving)
    found, wanted = (perform(e, system, tmp_path / e.name.replace(":", "_")) for e in both)
    assert columns(found, ("x", "y")) == pytest.approx(columns(wanted, ("x", "y")), abs=1e-12)
    assert columns(found, ("vx", "vy")) == pytest.approx(columns(wanted, ("vx", "vy")), abs=1e-7)
    for name in ("floor_fx", "floor_fy", "left_fx", "right_fx", "right_fy", "lid_fy"):
        assert found.series[name][1:] == pytest.approx(wanted.series[name][1:], abs=1e-5)
    touched = [_pressed(system, frame) for frame in wanted.frames]
    assert found.series["floor_fy"].min() < -0.1
    assert [_pressed(system, frame).keys() for frame in found.frames] == [t.keys() for t in touched]
    for a, b in zip((_pressed(system, frame) for frame in found.frames), touched, strict=True):
        assert a == pytest.approx(b, abs=1e-5)
    words, walls = system.particles.material.tolist(), [w.material for w in system.walls]
    met = {(words[i - 1], walls[-j - 1]) for t in touched for i, j in t if j < 0}
    assert met >= {("stiff", "stiff"), ("soft", "stiff"), ("soft", "soft"), ("stiff", "")}


def _pressed(system, frame):
    """Size of the force of every contact, by its partners."""
    c = frame.contacts
    size = np.hypot(c["fx"], c["fy"])
    return {(int(i), int(j)): float(f) for i, j, f in zip(c["i"], c["j"], size, strict=True)}


def test_materials_and_moments_of_inertia_make_types_of_their_own(both, tmp_path):
    """Spheres among discs in a plane, which LAMMPS alone takes."""
    system = collisions(friction=True)
    q = np.where(np.arange(8) % 3 == 0, 0.4, 0.5)
    system = system.with_(particles=replace(system.particles, inertia_factor=q))
    if not takes(both[0], system):
        pytest.skip("spheres among discs")
    found, wanted = (perform(e, system, tmp_path / e.name.replace(":", "_")) for e in both)
    assert columns(found, ("vx", "vy")) == pytest.approx(columns(wanted, ("vx", "vy")), abs=1e-11)
    assert columns(found, ("wz",)) == pytest.approx(columns(wanted, ("wz",)), abs=1e-8)


def test_springs_of_contacts_are_told(both, tmp_path):
    """Of pairs of all stiffnesses, though they come from forces: u by the kernel's."""
    system = replace(collisions(friction=True), steps=300, frame_every=5, sample_every=5)
    found, wanted = (perform(e, system, tmp_path / e.name.replace(":", "_")) for e in both)
    frame = next(k for k, f in enumerate(wanted.frames) if len(f.contacts["i"]) == 4 and np.abs(f.contacts["ux"]).all())
    told, exact = found.frames[frame].contacts, wanted.frames[frame].contacts
    assert told["i"].tolist() == exact["i"].tolist() == [1, 3, 5, 7]
    assert np.hypot(told["ux"], told["uy"]) == pytest.approx(np.hypot(exact["ux"], exact["uy"]), rel=1e-6)


def test_decks_name_every_two_types():
    lines = LAMMPS.render(collisions(friction=True))["in.lammps"].splitlines()
    given = [line.split()[1:3] for line in lines if line.startswith("pair_coeff")]
    assert "# atom types: 1 without a material, 2 soft, 3 stiff" in lines
    assert sorted(given) == [["1", "1"], ["1", "2"], ["1", "3"], ["2", "2"], ["2", "3"], ["3", "3"]]
    lines = LIGGGHTS.render(collisions(friction=True))["in.liggghts"].splitlines()
    assert "# atom types: 1 without a material, 2 soft, 3 stiff" in lines
    tables = [line for line in lines if " kn " in line]
    assert tables[0].endswith(" peratomtypepair 3 1000 1000 1000 1000 1000 20000 1000 20000 1000000")
