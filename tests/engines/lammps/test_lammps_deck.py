"""The text of decks: what is off is not in it, numbers are whole, nothing can be injected."""

import re

import numpy as np
import pytest

from harness.engines.lammps import LAMMPS
from harness.engines.lammps.law import damping_and_ratio, pair_law
from harness.scene.contact import LinearNormal, SpringSliding
from harness.scene.model import Background
from harness.scene.system import Constant, Cosine, Loaded, Wall


def _deck(system):
    return LAMMPS.render(system)["in.lammps"]


def test_the_same_system_gives_the_same_bytes(make_system):
    assert LAMMPS.render(make_system.biaxial(16)) == LAMMPS.render(make_system.biaxial(16))


def test_effects_that_are_off_leave_no_line(make_system):
    bare = make_system.two(sliding=None, contacts=False)
    words = "linear_history gravity viscous wall region carrier halt restart omega_ nve/sphere limit_damping p1"
    deck = _deck(bare)
    assert [w for w in words.split() if w in deck] == []
    assert set(LAMMPS.render(bare)) == {"in.lammps", "packing.data"}
    packing = LAMMPS.render(bare.with_(particles=make_system.particles([[0.0, 0.0]], [1.0], [1.0])))["packing.data"]
    assert "Velocities" not in packing


@pytest.mark.parametrize(("change", "line"), [
    ({"gravity": (0.0, -9.81)}, "fix gravity grains gravity 9.81 vector 0 -1 0"),
    ({"background": Background(translational_drag=0.1)}, "fix drag grains viscous 0.1"),
    ({"periodic": (1.0, 0.0)}, "boundary p f p"),
    ({"normal": LinearNormal(normal_stiffness=1e4, normal_damping=0.5, attraction="clipped")},
     "pair_coeff * * hooke 10000 0.5 damping velocity tangential linear_history 3000 0.4"
     " 0.4 limit_damping"),
])
def test_effects_that_are_on_have_their_line(change, line, make_system):
    assert line in _deck(make_system.two(**change)).split("\n")
    assert line not in _deck(make_system.two()).split("\n")


def test_the_running_deck_never_asks_for_contacts(make_system):
    """`pair/local` in the running instance cuts the springs."""
    files = LAMMPS.render(make_system.biaxial(9))
    assert "local" not in files["in.lammps"]
    assert "pair/local" in files["contacts.in"]
    assert "compute" not in files["in.lammps"].replace("compute F_", "")


def test_smooth_walls_carry_no_shear_whatever_the_grains_do(make_system):
    smooth = _deck(make_system.on_floor(make_system.floor(friction=False)))
    rough = _deck(make_system.on_floor(make_system.floor(friction=True)))
    law = re.compile(r"fix wall_floor .*tangential (\w+)")
    assert law.search(smooth)[1] == "linear_nohistory"
    assert law.search(rough)[1] == "linear_history"
    nothing = _deck(make_system.on_floor(make_system.floor(friction=True), sliding=None))
    assert law.search(nothing)[1] == "linear_nohistory"


def test_only_moving_walls_have_variables(make_system):
    assert "disp_floor" not in _deck(make_system.on_floor(make_system.floor()))
    moving = make_system.floor(motion=Constant(velocity=(0.5, 0.0)))
    deck = _deck(make_system.on_floor(moving))
    assert "variable move_floor_x equal 0.5*step*dt" in deck
    assert "move v_move_floor_x NULL NULL" in deck


def test_branches_in_time_only_where_the_run_is_longer_than_the_motion(make_system):
    def deck(duration):
        return _deck(make_system.on_floor(make_system.floor(motion=Cosine(travel=1e-4, duration=duration))))

    assert "step*dt<" not in deck(6e-4)  # 300 steps of 2e-6 s
    assert "step*dt<" in deck(5.9e-4)


def test_numbers_survive_the_packing_file(make_system):
    system = make_system.biaxial(16)
    text = LAMMPS.render(system)["packing.data"]
    rows = np.array([r.split() for r in text.split("sphere\n\n")[1].split("\n\n")[0].split("\n")], float)
    masses = np.array([r.split() for r in text.split("GrainMass\n\n")[1].strip().split("\n")], float)
    np.testing.assert_array_equal(rows[:-1, 2] / 2, system.particles.radius)
    np.testing.assert_array_equal(rows[:-1, 4:6], system.particles.x)
    np.testing.assert_array_equal(masses[:-1, 1], system.particles.mass)
    np.testing.assert_array_equal(masses[-1], [17, 1e-3])


def test_titles_cannot_become_commands(make_system):
    evil = make_system.two().with_(scene_name="a", title='x &\nshell "rm *" ${y}\r$(2)')
    lines = _deck(evil).split("\n")
    assert lines[0] == "# a: x shell rm * y (2)"
    assert lines[1].startswith("# LAMMPS")


def test_the_box_holds_all_that_walls_can_reach(make_system):
    def bounds(system, axis):
        text = LAMMPS.render(system)["packing.data"]
        return [float(v) for v in re.search(rf"(\S+) (\S+) {axis}lo", text).groups()]

    box = make_system.biaxial(9)
    length = box.wall("right").point[0]
    low, high = bounds(box, "x")
    assert -0.01 < low < 0  # behind a fixed wall
    assert high > 2 * length  # a loaded wall may be pushed out
    low, high = bounds(make_system.on_floor(make_system.floor()), "y")
    assert -0.01 < low < 0
    assert high > 100  # nothing that flies can leave
    away = make_system.floor(motion=Constant(velocity=(0.0, -7.0)))
    assert bounds(make_system.on_floor(away), "y")[0] < -7.0 * 6e-4


def test_small_grains_around_a_large_one_have_room_in_its_list(make_system):
    many = 3000
    radius = np.full(many, 1e-4)
    radius[0] = 0.1
    system = make_system.any(make_system.particles(np.zeros((many, 2)), radius, np.ones(many)))
    assert f"neigh_modify one {many} page {10 * many}" in _deck(system)
    assert "neigh_modify one" not in _deck(make_system.biaxial(16))


def test_tangential_damping_is_exact_when_it_can_be(make_system):
    for normal, shear in ((2.0, 0.5), (0.0, 0.3), (0.0, 0.0), (1.0, 0.0)):
        c, x = damping_and_ratio(normal, shear)
        assert x * c == shear
        assert c == normal or c < 1e-29 * shear
    bare = LinearNormal(normal_stiffness=1.0, normal_damping=0.0, attraction="allowed")
    words = pair_law(make_system.two(normal=bare, sliding=None))
    assert words == "hooke 1 0 damping velocity tangential linear_nohistory 0 0"


# --- support --------------------------------------------------------------------------------------


def _levels(system):
    return {s.effect: s.level for s in LAMMPS.supports(system)}


def test_every_effect_of_a_full_system_is_judged(make_system):
    walls = make_system.biaxial(9).walls
    system = make_system.biaxial(
        9, gravity=(0.0, -1.0), background=Background(translational_drag=1.0),
        walls=(walls[0], Wall(index=2, name="bottom", point=(0, 0), normal=(0, 1), friction=True), *walls[2:]),
    )
    levels = _levels(system)
    assert set(levels.values()) == {"exact", "equivalent"}
    assert {"normal contact: linear", "sliding friction: spring", "wall friction", "loaded walls"} <= set(levels)
    assert all(s.note for s in LAMMPS.supports(system))


@pytest.mark.parametrize(("q", "dim", "level"), [
    ([0.4, 0.5], 2, None), ([0.5, 0.5], 3, "unsupported"), ([1.0, 0.5], 2, "unsupported"), ([0.4, 0.4], 3, None),
])
def test_moments_of_inertia(q, dim, level, make_system):
    assert _levels(make_system.two(dim, q=q)).get("moment of inertia") == level
    assert "moment of inertia" not in _levels(make_system.two(dim, q=q, sliding=None))


def test_what_is_mapped_and_what_is_not_exact_is_said(make_system):
    undamped = LinearNormal(normal_stiffness=1e4, normal_damping=0.0, attraction="allowed")
    notes = {s.effect: s.note for s in LAMMPS.supports(make_system.two(normal=undamped))}
    assert "2^-100" in notes["tangential damping"]
    no_dashpot = SpringSliding(shear_friction=0.5, shear_stiffness=1e3, shear_damping=0.0)
    assert "tangential damping" not in _levels(make_system.two(sliding=no_dashpot))
    pushed = make_system.floor(motion=Constant(velocity=(0.0, 0.1)))
    assert _levels(make_system.on_floor(pushed))["driven walls"] == "exact"
    grain = make_system.particles([[0.0, 0.99e-3]], [1e-3], [1e-5])
    assert _levels(make_system.any(grain, walls=(pushed,)))["driven walls"] == "partial"


def test_a_wall_across_a_periodic_axis_is_refused(make_system):
    system = make_system.on_floor(make_system.floor((0.0, 1.0)), periodic=(0.0, 0.1))
    assert _levels(system)["walls"] == "unsupported"
    assert "walls" not in _levels(make_system.on_floor(make_system.floor(), periodic=(0.1, 0.0)))


def test_a_period_in_which_a_pair_can_touch_twice_is_refused(make_system):
    assert _levels(make_system.two(periodic=(4.4e-3, 0.0)))["periodic axes"] == "unsupported"
    assert _levels(make_system.two(periodic=(4.5e-3, 0.0)))["periodic axes"] == "exact"


def test_cost_grows_with_particles_walls_and_friction(make_system):
    cost = LAMMPS.microseconds_per_step
    assert cost(make_system.biaxial(16)) > cost(make_system.biaxial(9)) > cost(make_system.biaxial(9, sliding=None))
    assert cost(make_system.biaxial(9)) > cost(make_system.biaxial(9, walls=()))


def test_loads_without_stress_or_damping_have_no_such_term(make_system):
    wall = make_system.floor(motion=Loaded(mass=1.0, load=0.5, stress=0.0, span=None, damping=0.0))
    deck = _deck(make_system.on_floor(wall))
    force = re.search(r"variable force_floor equal \"(.*)\"", deck)[1]
    assert force == "(0.5 + -1*c_F_floor[2])/1048576"
    assert "\n# carried by atom 2: displacement = 2^20 = 1048576 times its coordinate; a power of two\n" in deck
    assert "extent" not in deck.replace("stress*extent", "")
