"""What several numbers must obey together: each check refuses, with its own line, and lets the rest pass."""

import pytest

from harness.scene.model import Biaxial, Free

BOX_REFUSALS = [
    (
        {"contact.sliding.shear_friction": 0.0},
        "contact.sliding.shear_friction: expected a number > 0, got 0; "
        "remove the table contact.sliding: an effect that is off does not exist",
    ),
    (
        {"particles.radius.min": 2e-3},
        "particles.radius.max: expected a number >= particles.radius.min = 0.002, got 0.0015",
    ),
    (
        {"compare": {"windows": [{"pairs": "codes", "strain": 0.2, "tolerance": 0.1}]}},
        "compare.windows[0].strain: expected a number <= top.final_strain = 0.1, got 0.2",
    ),
    (
        {"compare.plateau": [0.05, 0.2]},
        "compare.plateau: expected two rising numbers from 0 to top.final_strain = 0.1, got [0.05, 0.2]",
    ),
    (
        {"compare.plateau": [0.05, 0.05]},
        "compare.plateau: expected two rising numbers from 0 to top.final_strain = 0.1, got [0.05, 0.05]",
    ),
    (
        {"compare.strains": [0.05, 0.2]},
        "compare.strains: expected rising numbers up to top.final_strain = 0.1, got [0.05, 0.2]",
    ),
    (
        {"compare.strains": [0.05, 0.01]},
        "compare.strains: expected rising numbers up to top.final_strain = 0.1, got [0.05, 0.01]",
    ),
    (
        {"compare.published": ["talk_frictionless_100"]},
        "compare.plateau: expected a strain range for plateau sigma_zz, got nothing; "
        "add plateau, or remove talk_frictionless_100 from compare.published",
    ),
    (
        {"preparation.pressure": 1e12},
        "preparation.pressure: expected a pressure of at most 25000 N/m, a quarter of the normal stiffness, "
        "at which discs overlap by half their radius, got 1e+12; lower it, or stiffen the contacts",
    ),
    (
        {"side.pressure": 2.6e4},
        "side.pressure: expected a pressure of at most 25000 N/m, a quarter of the normal stiffness, "
        "at which discs overlap by half their radius, got 26000; lower it, or stiffen the contacts",
    ),
]


def test_pressures_up_to_a_quarter_of_the_stiffness_of_first_loading_pass(scenes):
    pressures = {"preparation.pressure": 2.5e4, "side.pressure": 2.5e4}
    scenes.load(scenes.biaxial, pressures)
    hysteretic = pressures | {"contact.normal": scenes.normals["hysteretic"]}
    assert "at most 12500 N/m" in scenes.refusal(scenes.biaxial, hysteretic)


@pytest.mark.parametrize(("changes", "message"), BOX_REFUSALS)
def test_box(scenes, changes, message):
    assert scenes.refusal(scenes.biaxial, changes) == f"scene.toml: {message}"


def test_unknown_published_value(scenes):
    message = scenes.refusal(scenes.biaxial, {"compare.published": ["talk_frictionless_10"]})
    assert message == (
        "scene.toml: compare.published[0]: expected the name of a published value in reference/values, "
        'got "talk_frictionless_10"; did you mean talk_frictionless_100?'
    )


@pytest.mark.parametrize("missing", ["count", "radius", "seed"])
def test_random_particles_are_given_whole(scenes, missing):
    message = scenes.refusal(scenes.biaxial, {f"particles.{missing}": scenes.remove})
    assert message == (
        f"scene.toml: particles.{missing}: expected count, radius and seed, or packing, got nothing; add {missing}"
    )


def test_packing_file_and_drawn_particles_exclude_each_other(scenes):
    scenes.write("id,x,y,radius\n1,0,0,1e-3\n", "p.csv")
    message = scenes.refusal(scenes.biaxial, {"particles.packing": "p.csv"})
    assert message == (
        "scene.toml: particles.count: expected nothing beside particles.packing, got 100; "
        "remove it, or remove packing"
    )


def test_one_packing_of_a_file(scenes):
    drawn = {f"particles.{k}": scenes.remove for k in ("count", "radius", "seed")}
    message = scenes.refusal(scenes.biaxial, {**drawn, "particles.packing": "p.csv", "compare.packings": 3})
    assert message.startswith("scene.toml: compare.packings: expected 1, as particles.packing is one packing, got 3")


FREE_REFUSALS = [
    (
        {"bodies_file": "b.csv"},
        "bodies: expected one of bodies, bodies_file and bodies_from, got bodies and bodies_file",
    ),
    ({"bodies": []}, "bodies: expected one of bodies, bodies_file and bodies_from, got none of them"),
    ({"gravity": [0.0, 0.0, -9.81]}, "gravity: expected 2 components, as dimension = 2, got 3: [0.0, 0.0, -9.81]"),
    (
        {"gravity": [0.0, 0.0]},
        "gravity: expected a vector other than zero, got [0.0, 0.0]; "
        "remove it: an effect that is off does not exist",
    ),
    ({"periodic": [1.0]}, "periodic: expected 2 components, as dimension = 2, got 1: [1.0]"),
    (
        {"periodic": [0.0, 0.0]},
        "periodic: expected a length > 0 for at least one axis, got [0.0, 0.0]; "
        "remove it: without a periodic axis there is no box",
    ),
    (
        {"dimension": 3, "bodies": [{"position": [0.0, 0.0], "radius": 1.0, "mass": 1.0}]},
        "bodies[0].position: expected 3 components, as dimension = 3, got 2: [0.0, 0.0]",
    ),
    ({"bodies.1.velocity": [1.0, 0.0, 0.0]}, "bodies[1].velocity: expected 2 components, as dimension = 2, got 3:"),
    ({"bodies.0.spin": [0.0, 0.0, 1.0]}, "bodies[0].spin: expected 1 component, as dimension = 2, got 3:"),
]


@pytest.mark.parametrize(("changes", "message"), FREE_REFUSALS)
def test_free(scenes, changes, message):
    assert scenes.refusal(scenes.free, changes).startswith(f"scene.toml: {message}")


def test_spin_has_three_components_in_space(scenes):
    bodies = [{"position": [0.0, 0.0, 0.0], "radius": 1e-3, "mass": 1e-5, "spin": [1.0]}]
    message = scenes.refusal(scenes.free, {"dimension": 3, "bodies": bodies})
    assert message == "scene.toml: bodies[0].spin: expected 3 components, as dimension = 3, got 1: [1.0]"


def planes_refused(scenes, *planes, **changes):
    return scenes.refusal(scenes.free, {"planes": list(planes), **changes}).removeprefix("scene.toml: ")


def moving(plane, **motion):
    return plane | {"motion": motion}


def test_plane_vectors(scenes):
    assert planes_refused(scenes, scenes.floor | {"normal": [0.0, 0.0, 1.0]}).startswith(
        "planes[0].normal: expected 2 components"
    )
    assert planes_refused(scenes, scenes.floor | {"point": [0.0, 0.0, 1.0]}).startswith(
        "planes[0].point: expected 2 components"
    )
    velocity = moving(scenes.floor, kind="constant", velocity=[0.0, 0.0, 1.0])
    assert planes_refused(scenes, velocity).startswith("planes[0].motion.velocity: expected 2 components")
    assert planes_refused(scenes, scenes.floor | {"normal": [0.0, 0.0]}).startswith(
        "planes[0].normal: expected a vector other than zero that points to the particles, got [0.0, 0.0]"
    )


def test_plane_names_differ(scenes):
    assert planes_refused(scenes, scenes.floor, scenes.lid | {"name": "floor"}) == (
        'planes[1].name: expected a name of its own, got "floor" again; planes[0] has it'
    )


@pytest.mark.parametrize(
    "motion", [{"kind": "constant", "velocity": [0.0, 0.0]}, {"kind": "cosine", "travel": 0.0, "duration": 1.0}]
)
def test_motion_zero_is_no_motion(scenes, motion):
    assert planes_refused(scenes, moving(scenes.floor, **motion)) == (
        "planes[0].motion: expected a motion other than zero, got zero; "
        "remove the table: a plane without motion is fixed"
    )


def test_rough_plane_needs_sliding(scenes):
    changes = {"contact.sliding": scenes.remove}
    assert planes_refused(scenes, scenes.floor, **changes).startswith(
        "planes[0].friction: expected false, as there is no table contact.sliding, rolling or torsion, got true"
    )


def test_plane_across_a_periodic_axis(scenes):
    assert planes_refused(scenes, scenes.floor, periodic=[0.0, 1.0]).startswith(
        "planes[0].normal: expected no component along the periodic axis y"
    )
    assert isinstance(scenes.load(scenes.free, {"planes": [scenes.floor], "periodic": [1.0, 0.0]}), Free)


@pytest.mark.parametrize(
    "motion",
    [
        {"kind": "cosine", "travel": 6e-3, "duration": 1e-4},
        {"kind": "constant", "velocity": [3.0, -60.0]},
    ],
)
def test_walls_that_would_cross(scenes, motion):
    message = planes_refused(scenes, scenes.floor, moving(scenes.lid, **motion))
    assert message == (
        'planes[1].motion: expected a gap > 0 to the facing plane planes[0] "floor" at all times, '
        "got -0.001 m at t = 0.0001 s"
    )


@pytest.mark.parametrize(
    "motion",
    [
        {"kind": "cosine", "travel": 6e-3, "duration": 3e-4},
        {"kind": "cosine", "travel": -6e-3, "duration": 1e-4},
        {"kind": "constant", "velocity": [60.0, -10.0]},
    ],
)
def test_walls_that_stay_apart(scenes, motion):
    assert isinstance(scenes.load(scenes.free, {"planes": [scenes.floor, moving(scenes.lid, **motion)]}), Free)


def test_walls_that_move_apart_before_they_meet(scenes):
    """Both move: the gap is that of both at the same time."""
    up = moving(scenes.floor, kind="constant", velocity=[0.0, 60.0])
    away = moving(scenes.lid, kind="constant", velocity=[0.0, 60.0])
    assert isinstance(scenes.load(scenes.free, {"planes": [up, away]}), Free)


def test_walls_that_start_crossed(scenes):
    low = scenes.lid | {"point": [0.0, -1e-3]}
    assert planes_refused(scenes, scenes.floor, low).startswith(
        'planes[1].point: expected a gap > 0 to the facing plane planes[0] "floor" at all times, got -0.001 m'
    )


def test_particle_behind_a_plane(scenes):
    assert planes_refused(scenes, scenes.floor | {"point": [0.0, 3e-3]}) == (
        'bodies[0].position: expected a centre in front of the wall "floor", got [0.0, 0.002], 0.001 m behind it; '
        "move the particle or turn the normal round"
    )


DEEP = "expected an overlap with bodies[0] of at most half the smaller radius, 0.0005 m, got"


def test_bodies_inside_each_other(scenes):
    assert scenes.refusal(scenes.free, {"bodies.1.position": [1.4e-3, 2e-3]}) == (
        f"scene.toml: bodies[1].position: {DEEP} 0.0006 m; move them apart"
    )
    small = {"bodies.1.position": [1.2e-3, 2e-3], "bodies.1.radius": 0.5e-3}
    assert "half the smaller radius, 0.00025 m, got 0.0003 m" in scenes.refusal(scenes.free, small)


def test_bodies_inside_each_other_across_the_periodic_box(scenes):
    changes = {"periodic": [0.01, 0.0], "bodies.1.position": [0.009, 2e-3]}
    assert f"{DEEP} 0.001 m" in scenes.refusal(scenes.free, changes)


def test_body_deep_in_a_wall(scenes):
    assert planes_refused(scenes, scenes.floor | {"point": [0.0, 1.6e-3]}) == (
        'bodies[0].position: expected an overlap with the wall "floor" of at most half the smaller radius, 0.0005 m, '
        "got 0.0006 m; move them apart"
    )


def test_shallow_overlaps_are_allowed(scenes):
    changes = {"bodies.1.position": [1.6e-3, 2e-3], "planes": [scenes.floor | {"point": [0.0, 1.4e-3]}]}
    assert isinstance(scenes.load(scenes.free, changes), Free)


def test_particle_outside_the_periodic_box(scenes):
    assert scenes.refusal(scenes.free, {"periodic": [0.0, 0.01], "bodies.1.position": [2.1e-3, -1e-3]}) == (
        "scene.toml: bodies[1].position: expected y from 0 to below the periodic length 0.01, got -0.001"
    )


def test_periodic_box_too_small(scenes):
    assert scenes.refusal(scenes.free, {"periodic": [0.0, 3e-3]}).startswith(
        "scene.toml: periodic: expected a length >= 0.004 (twice the largest diameter) along y, got 0.003"
    )


def test_equal_radii_are_in_order(scenes):
    assert isinstance(scenes.load(scenes.biaxial, {"particles.radius.min": 1.5e-3}), Biaxial)
