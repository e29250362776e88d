"""Whole trajectories against the plain DEM of conftest: every effect, both dimensions, every convention."""

import dataclasses

import numpy as np
import pytest

from reference.kernel.conventions import TALK
from reference.kernel.model import Constant, Cosine, Loaded

MIXED = dataclasses.replace(TALK, name="mixed", torque_arm="radius", wall_slip_arm="radius", wall_torque_arm="reduced")
"""No code's own, but all four lever arms differ from their neighbours."""

CONVENTIONS = ("lammps", "liggghts", "talk", MIXED)
MU = 0.4
STIFFNESS = 1e4


def follow(dem, m, steps, *, check_every=50):
    """Run both, compare them on the way; return the plain DEM's contacts of all steps: (key, which laws slide)."""
    kernel, plain, met = dem.Simulation(m), dem.Plain(m), []
    for step in range(1, steps + 1):
        kernel.advance()
        plain.advance()
        met += [(row.key, row.slides) for row in plain.rows]
        if step % check_every == 0:
            same_state(kernel, plain)
    return met


def same_state(kernel, plain):
    s, m = kernel.state, kernel.model
    n, dim = m.particle_count, m.dimension
    spin = np.array(plain.w)[:, 2:] if dim == 2 else np.array(plain.w)
    close(s.x[:, :n].T, np.array(plain.x)[:, :dim])
    close(s.v[:, :n].T, np.array(plain.v)[:, :dim])
    close(s.spin[:, :n].T, spin)
    if m.walls:
        close(s.x[:, n:].T, np.array(plain.wall_x)[:, :dim])
        close(s.wall_force.T / STIFFNESS, np.array(plain.wall_force)[:, :dim] / STIFFNESS)
    for interaction in kernel.interactions:
        for family, memory in interaction.pairs.memory.items():
            same_memory(interaction.pairs, family, memory, plain, n)


def same_memory(pairs, family, memory, plain, n):
    """Springs, whether they slide, largest overlaps; the plain DEM keeps three components and (0, 0, w)."""
    for i, j, kept in zip(pairs.i, pairs.j, memory.T, strict=True):
        other = plain.memory.get((i, j if j < n else n - 1 - j), {}).get(family)
        if other is None:
            assert not kept.any()
        elif family == "normal":
            close(kept, [other])
        else:
            xi, slid = other
            if plain.m.dimension == 2:
                xi = xi[2:] if family == "rolling" and plain.m.rolling.frame == "space" else xi[:2]
            close(kept, [*xi, float(slid)][: len(kept)])


def close(got, expected):
    np.testing.assert_allclose(got, expected, rtol=0, atol=3e-11)


def both_ways(met, *, pairs=True):
    """Contacts stuck and slid, between particles or at walls: else the comparison says little."""
    kinds = {slides["sliding"] for (_, j), slides in met if (j >= 0) == pairs and "sliding" in slides}
    return kinds == {True, False}


@pytest.mark.parametrize("convention", CONVENTIONS, ids=lambda c: getattr(c, "name", c))
@pytest.mark.parametrize("dim", [2, 3])
def test_a_box_of_rough_and_smooth_walls(dem, dim, convention):
    walls = dem.box(5.2 if dim == 2 else 3.4, dim, friction=("x0", "y1", "z0"))
    m = dem.cluster(7, dim, across=3 if dim == 2 else 2, squeeze=0.8, speed=3.0, walls=walls, mu=MU, gn=12.0, gt=5.0,
                    convention=convention)
    met = follow(dem, m, 150)
    assert both_ways(met)
    assert both_ways(met, pairs=False)
    assert any(j < 0 and not slides for (_, j), slides in met)


@pytest.mark.parametrize("convention", CONVENTIONS, ids=lambda c: getattr(c, "name", c))
def test_periodic_axes_gravity_and_drag(dem, convention):
    floor = dem.wall("floor", (0.0, 0.0), (0.0, 1.0), friction=True)
    m = dem.cluster(3, 2, squeeze=0.9, speed=2.0, walls=[floor], mu=MU, gt=3.0, gn=5.0, clip=True,
                    convention=convention, periodic=(5.5, 0.0), gravity=(3.0, -40.0), drag=0.7)
    met = follow(dem, m, 150)
    assert both_ways(met)


def test_periodic_in_three_directions(dem):
    m = dem.cluster(4, 3, across=2, speed=2.0, mu=MU, gt=3.0, periodic=(4.0, 4.2, 4.4), convention="liggghts",
                    gravity=(1.0, -2.0, 3.0), drag=0.2)
    assert both_ways(follow(dem, m, 120))


@pytest.mark.parametrize("convention", CONVENTIONS, ids=lambda c: getattr(c, "name", c))
def test_moving_walls(dem, convention):
    """Smooth and rough, driven and loaded, one of them slanting and one sheared along itself."""
    walls = [
        dem.wall("left", (0.0, 0.0), (1.0, 0.1), friction=True, motion=Constant(velocity=(0.5, 4.0))),
        dem.wall("bottom", (0.0, 0.0), (0.0, 1.0), friction=True),
        dem.wall("right", (5.6, 0.0), (-1.0, 0.0), friction=True,
                 motion=Loaded(mass=3.0, load=50.0, stress=40.0, span=(1, 3), damping=8.0)),
        dem.wall("top", (0.0, 5.4), (0.0, -1.0), motion=Cosine(travel=0.6, duration=0.05)),
    ]
    m = dem.cluster(5, 2, squeeze=0.8, speed=2.0, walls=walls, mu=MU, gn=10.0, gt=4.0, convention=convention)
    met = follow(dem, m, 150)
    assert both_ways(met)
    assert both_ways(met, pairs=False)
    assert {j for (_, j), _ in met if j < 0} == {-1, -2, -3, -4}


def test_loaded_wall_in_three_dimensions(dem):
    lid = dem.wall("lid", (0.0, 0.0, 3.8), (0.2, 0.0, -1.0), friction=True,
                   motion=Loaded(mass=2.0, load=80.0, stress=0.0, span=None, damping=3.0))
    floor = dem.wall("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), friction=True)
    m = dem.cluster(6, 3, across=2, squeeze=0.9, speed=2.0, walls=[lid, floor], mu=MU, gt=2.0, convention="lammps")
    assert both_ways(follow(dem, m, 120), pairs=False)


COMBINED = {
    "elastic spheres": (
        ("normal", "hertz"), ("sliding", "mindlin"), ("rolling", "spring"), ("torsion", "spring")),
    "plastic and adhesive": (
        ("normal", "hysteretic"), ("sliding", "spring", {"dynamic_friction": 0.2}), ("rolling", "spring"),
        ("torsion", "spring")),
    "plastic with growing stiffness": (
        ("normal", "hysteretic_variable"), ("sliding", "viscous"), ("rolling", "constant")),
    "attractive spheres": (("normal", "dmt"), ("sliding", "spring"), ("rolling", "constant"), ("torsion", "spring")),
    "static and dynamic friction": (("normal", "linear"), ("sliding", "spring", {"dynamic_friction": 0.1})),
    "rolling resistance alone": (("normal", "hertz", {"attraction": "clipped"}), ("rolling", "spring")),
}
"""Every law, in company: family, word and changes of its numbers."""


@pytest.mark.parametrize("convention", CONVENTIONS, ids=lambda c: getattr(c, "name", c))
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("name", COMBINED)
def test_every_law_in_a_box(dem, name, dim, convention):
    tables = {family: dem.table(family, word, **(changes[0] if changes else {}))
              for family, word, *changes in COMBINED[name] if (family, dim) != ("torsion", 2)}
    walls = dem.box(5.2 if dim == 2 else 3.4, dim, friction=("x0", "y1", "z0"))
    m = dem.cluster(7, dim, across=3 if dim == 2 else 2, squeeze=0.8, speed=3.0, walls=walls, convention=convention,
                    **tables)
    met = follow(dem, m, 60, check_every=10)
    for family in {"sliding", "rolling", "torsion"} & set(tables):
        kinds = {slides[family] for _, slides in met if family in slides}
        assert kinds == ({None} if tables[family]["law"] == "constant" else {True, False})
    assert any(j < 0 and slides for (_, j), slides in met)


def test_every_law_is_in_company(dem):
    assert {(family, word) for laws in COMBINED.values() for family, word, *_ in laws} == set(dem.tables)
