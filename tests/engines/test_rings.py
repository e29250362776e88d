"""Rings of glued discs in LAMMPS and LIGGGHTS: against the kernel, by hand, and what a run leaves of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.engines.registry import ENGINES
from harness.runs.sanity import find_fault
from harness.scene.contact import (
    ConstantRolling,
    HertzNormal,
    HystereticNormal,
    LinearNormal,
    MindlinSliding,
    SpringRolling,
    SpringSliding,
    VariableHystereticNormal,
    ViscousSliding,
)
from harness.scene.model import Background
from harness.scene.system import Cosine, Loaded, Particles, Ring, System, Wall

GLUED, SMALL, LARGE = 1.25e-3, 3.7e-3, 4.5e-3
INNER, OUTER = 20e-3, 45e-3
NORMAL = LinearNormal(normal_stiffness=352.1, normal_damping=0.19, attraction="allowed")
VISCOUS = ViscousSliding(shear_friction=0.44, shear_damping=0.15)
SPRING = SpringSliding(shear_friction=0.44, shear_stiffness=100.0, shear_damping=0.15)
ROLLING = SpringRolling(rolling_friction=0.1, rolling_stiffness=20.0, rolling_damping=0.02)
GLASS = HertzNormal(youngs_modulus=5e6, poisson_ratio=0.3, restitution=0.6, attraction="allowed", impact_speed=0.1)
PLASTIC = HystereticNormal(
    loading_stiffness=352.1, unloading_stiffness=700.0, adhesion_stiffness=50.0, normal_damping=0.19)


def ring(index: int, name: str, circle: float, omega: float | None, centre=(0.0, 0.0)) -> Ring:
    """Two glued discs more than fit side by side: neighbours overlap, which must not matter."""
    count = int(np.pi * circle / GLUED) + 2
    angle = 2.0 * np.pi * np.arange(count) / count
    x = np.array(centre) + circle * np.column_stack([np.cos(angle), np.sin(angle)])
    radius = np.full(count, GLUED)
    return Ring(index=index, name=name, centre=centre, circle=circle, x=x, radius=radius, omega=omega)


def discs(x, radius, v=None, spin=None) -> Particles:
    x, radius = np.array(x, float), np.array(radius, float)
    return Particles(
        x=x, radius=radius, mass=1060.0 * 6e-3 * np.pi * radius**2, inertia_factor=np.full(len(x), 0.5),
        v=np.zeros_like(x) if v is None else np.array(v, float),
        spin=np.zeros((len(x), 1)) if spin is None else np.array(spin, float),
    )


def couette(omega: float | None = 1.0, outer: float | None = None, *, centre=(0.0, 0.0), **changes) -> System:
    """73 discs in three layers, pressed into each other and the rings, with velocities and spins."""
    rng = np.random.default_rng(0)
    layers = INNER + GLUED + (OUTER - INNER - 2 * GLUED) * (np.arange(3) + 0.5) / 3
    counts = [int(2 * np.pi * r / 8.2e-3) for r in layers]
    polar = [(r, 2 * np.pi * (k + 0.3) / n) for r, n in zip(layers, counts, strict=True) for k in range(n)]
    x = np.array([(r * np.cos(a), r * np.sin(a)) for r, a in polar]) + rng.uniform(-2e-4, 2e-4, (len(polar), 2))
    radius = np.where(rng.uniform(size=len(x)) < 0.7, SMALL, LARGE)
    v, spin = 0.05 * rng.normal(size=x.shape), 20.0 * rng.normal(size=(len(x), 1))
    fields = {
        "dimension": 2, "particles": discs(x + centre, radius, v, spin), "walls": (), "normal": NORMAL,
        "sliding": VISCOUS, "background": None, "gravity": None, "periodic": None, "dt": 1e-4, "steps": 200,
        "sample_every": 10, "frame_every": 100, "contacts": True,
        "rings": (ring(1, "inner", INNER, omega, centre), ring(2, "outer", OUTER, outer, centre)),
    }
    return System(**(fields | changes))


def perform(name: str, system: System, folder, edit=None):
    """Write the deck (`edit` may change the files), run it; return RunResult."""
    folder.mkdir()
    files = ENGINES[name].render(system)
    for file, text in (edit(files) if edit else files).items():
        (folder / file).write_text(text)
    return ENGINES[name].run(folder, time_limit=60)


@pytest.fixture(params=["lammps", "liggghts"])
def code(request):
    probe = ENGINES[request.param].probe()
    if not probe.available:
        pytest.skip(f"{request.param}: {probe.detail}")
    return request.param


@pytest.fixture(name="run")
def _run(tmp_path):
    """Run a system that must come to its end; return its trajectory."""

    def run(name: str, system: System, edit=None):
        folder = tmp_path / f"{name.replace(':', '_')}_{len(list(tmp_path.iterdir()))}"
        result = perform(name, system, folder, edit)
        assert result.status == "completed", result
        found = ENGINES[name].read(folder, system)
        assert find_fault(system, found) is None
        return found

    return run


# --- against the kernel ------------------------------------------------------------------------


def ordered(table):
    """Contacts by i, j and overlap: one particle may touch two glued discs of a ring."""
    order = np.lexsort((table["overlap"], table["j"], table["i"]))
    return {c: values[order] for c, values in table.items()}


def assert_close(found, expected, tolerance: float) -> None:
    """All tables of all frames and the series, every column relative to its largest value (forces: of both)."""
    for a, b in zip(found, expected, strict=True):
        assert_tables(a.particles, b.particles, tolerance)
        assert_tables(a.walls, b.walls, tolerance)
        assert_tables(ordered(a.contacts), ordered(b.contacts), tolerance)
    assert_tables(found.series, expected.series, tolerance)


def assert_tables(a, b, tolerance: float) -> None:
    assert set(a) == set(b)
    for column, values in a.items():
        twin = {"x": "y", "y": "x"}.get(column[-1:])
        sizes = [np.abs(values), np.abs(a[column[:-1] + twin]) if twin and column[:-1] + twin in a else np.abs(values)]
        size = np.nanmax(np.concatenate([*sizes, [np.finfo(float).tiny]]))
        np.testing.assert_allclose(values, b[column], rtol=0, atol=tolerance * size, err_msg=column)


LAWS = {
    "smooth": {"sliding": None},
    "viscous": {"sliding": VISCOUS},
    "spring": {"sliding": SPRING},
    "drag": {"sliding": SPRING, "background": Background(translational_drag=4e-3), "gravity": (0.3, -1.0)},
    "rolling": {"sliding": SPRING, "rolling": ROLLING},
    "constant rolling": {"sliding": SPRING, "rolling": ConstantRolling(rolling_friction=0.1)},
    "mindlin": {"normal": GLASS, "sliding": MindlinSliding(shear_friction=0.4), "dt": 5e-6},
}
TURNS = {"one way": (1.0, None), "the other way": (-5.0, 2.0), "at rest": (None, None)}


def agree(code, run, system: System, tolerance: float) -> None:
    found = run(code, system)
    assert min(frame.contacts["j"].min() for frame in found) == -2
    assert np.isin([-1, -2], found.frames[-1].contacts["j"]).all()
    assert_close(found, run(f"kernel:{code}", system), tolerance)


@pytest.mark.parametrize("law", LAWS)
def test_every_law_acts_at_rings(code, run, law):
    """Discs of infinite mass: reduced masses (they matter in mindlin) are those of the particles."""
    system = couette(-2.0, **LAWS[law])
    refused = [s for s in ENGINES[code].supports(system) if s.level == "unsupported"]
    if refused:
        assert (code, law) == ("lammps", "constant rolling")
        return
    # LAMMPS leaves springs unturned where that matters less than 1e-10 of their limit, by rounding
    agree(code, run, system, 1e-9 if (code, law) == ("lammps", "mindlin") else 3e-11)


@pytest.mark.parametrize("turn", TURNS)
def test_rings_turn_both_ways(code, run, turn):
    agree(code, run, couette(*TURNS[turn], sliding=SPRING), 3e-11)


def test_away_from_the_origin(code, run):
    agree(code, run, couette(3.0, centre=(0.31, -0.23)), 1e-9)


def test_dashpots_by_pairs_of_bodies_know_glued_discs(run):
    """LIGGGHTS takes this dashpot as a table of restitutions: glued discs are a type of their own."""
    if not ENGINES["liggghts"].probe().available:
        pytest.skip("needs LIGGGHTS")
    system = couette(2.0, normal=PLASTIC, sliding=SPRING, contacts=False)
    found, expected = run("liggghts", system), run("kernel:liggghts", system)
    for a, b in zip(found, expected, strict=True):
        assert_tables(a.particles, b.particles, 3e-11)
        assert_tables(a.walls, b.walls, 3e-11)


def test_planes_loads_and_one_ring_together(code, run):
    """Particles outside a ring, in a box with a wall that has a mass: ids of carriers come after glued discs."""
    whole = couette(sliding=SPRING)
    walls = (
        Wall(index=1, name="left", point=(-47e-3, 0.0), normal=(1.0, 0.0), friction=False),
        Wall(index=2, name="bottom", point=(0.0, -46e-3), normal=(0.0, 1.0), friction=True),
        Wall(index=3, name="right", point=(47e-3, 0.0), normal=(-1.0, 0.0), friction=False,
             motion=Loaded(mass=0.5, load=0.0, stress=5.0, span=("bottom", "top"), damping=0.1)),
        Wall(index=4, name="top", point=(0.0, 46e-3), normal=(0.0, -1.0), friction=True,
             motion=Cosine(travel=2e-3, duration=0.1)),
    )
    system = whole.with_(walls=walls, rings=(ring(5, "mill", INNER, -2.0),), steps=200, frame_every=50)
    found, expected = run(code, system), run(f"kernel:{code}", system)
    for a, b in zip(found, expected, strict=True):
        assert_tables(a.particles, b.particles, 3e-11)
    assert_tables(found.series, expected.series, 1e-9)
    last = found.frames[-1].walls
    assert np.isnan(last["nx"]).tolist() == np.isnan(last["ny"]).tolist() == [False] * 4 + [True]
    assert np.isnan(last["radius"]).tolist() == np.isnan(last["torque"]).tolist() == [True] * 4 + [False]
    assert (found.frames[0].contacts["j"] == -5).sum() > 5


@pytest.mark.long
@pytest.mark.parametrize("law", ["viscous", "spring"])
def test_round_off_over_thousands_of_steps(code, run, law):
    drag = Background(translational_drag=4e-3)
    system = couette(-5.0, 2.0, sliding=LAWS[law]["sliding"], background=drag, steps=2000, frame_every=500)
    found, expected = run(code, system), run(f"kernel:{code}", system)
    for a, b in zip(found, expected, strict=True):
        assert np.abs(a.particles["x"] - b.particles["x"]).max() < 1e-8 * SMALL


# --- by hand ---------------------------------------------------------------------------------------


def by_hand(system: System, *, arm: float):
    """One disc at one ring: half-step velocities of the disc, the ring as it is at the end of the step.

    arm: how many half overlaps are taken off the radii in the velocity at the contact, 0 or 1. Returns x, v, spin of
    the end, and rows (torque, fx, fy) of the ring, one a sample.
    """
    p, (body,), dt = system.particles, system.rings, system.dt
    x, v, w, a, m = p.x[0].copy(), p.v[0].copy(), p.spin[0, 0], p.radius[0], p.mass[0]
    inertia, omega, rows = 0.5 * m * a**2, body.omega, []

    def force(angle):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        places, f, couple, load = body.x @ turn, m * np.array(system.gravity), 0.0, np.zeros(3)
        for place in places:
            r = np.linalg.norm(x - place)
            overlap = a + GLUED - r
            if overlap <= 0:
                continue
            n, t = (x - place) / r, np.array([-(x - place)[1], (x - place)[0]]) / r
            moving = v - omega * np.array([-place[1], place[0]])
            f_n = NORMAL.normal_stiffness * overlap - NORMAL.normal_damping * (moving @ n)
            slip = moving @ t - (a - arm * overlap / 2) * w - (GLUED - arm * overlap / 2) * omega
            f_t = -np.sign(slip) * min(VISCOUS.shear_damping * abs(slip), VISCOUS.shear_friction * abs(f_n))
            here = f_n * n + f_t * t
            f, couple = f + here, couple - (a - overlap / 2) * f_t
            own = -(GLUED - overlap / 2) * f_t
            load += [own - (place[0] * here[1] - place[1] * here[0]), *-here]
        return f, couple, load

    f, couple, load = force(0.0)
    rows.append(load)
    for step in range(1, system.steps + 1):
        v, w = v + dt / 2 * f / m, w + dt / 2 * couple / inertia
        x = x + dt * v
        f, couple, load = force(omega * step * dt)
        v, w = v + dt / 2 * f / m, w + dt / 2 * couple / inertia
        if step % system.sample_every == 0:
            rows.append(load)
    return x, v, w, np.array(rows)


@pytest.mark.parametrize("omega", [4.0, -4.0])
def test_one_disc_on_a_ring_by_hand(code, run, omega):
    """It falls on the ring, spinning, and is carried along; LIGGGHTS takes the slip at R - overlap/2, LAMMPS at R."""
    place = (INNER + GLUED + SMALL + 1e-5) * np.array([np.cos(0.4), np.sin(0.4)])
    system = couette(
        gravity=(-2.0, -0.8), particles=discs([place], [SMALL], [[-0.05, 0.02]], [[12.0]]), sample_every=1,
        rings=(ring(1, "mill", INNER, omega),), steps=400, frame_every=400,
    )
    found, (x, v, w, rows) = run(code, system), by_hand(system, arm=int(code == "liggghts"))
    last = found.frames[-1].particles
    for values, expected in ((last.vector("x", "y"), x), (last.vector("vx", "vy"), v), (last["wz"], w)):
        np.testing.assert_allclose(np.ravel(values), np.ravel(expected), rtol=1e-11)
    told = found.series.vector("mill_torque", "mill_fx", "mill_fy")
    assert np.count_nonzero(rows[:, 1]) > 20
    assert (np.abs(told - rows) <= 1e-11 * np.abs(rows).max(axis=0)).all()
    np.testing.assert_allclose(found.series["mill_angle"], omega * 1e-4 * np.arange(401), rtol=1e-15)


def test_the_glued_discs_turn_rigidly_from_the_start_on(code, tmp_path):
    """x, v and omega of every one, at steps 0, 100, 200: the run dumps them here, as it does not by itself."""
    system = couette(-3.0, 0.5, centre=(0.02, -0.01))
    deck = f"in.{code}"

    def dumping(files):
        dump = "dump glued glued custom 100 glued.dump id x y vx vy omegaz\n"
        style = 'dump_modify glued sort id format float %.17g\n' if code == "lammps" else (
            'dump_modify glued sort id format "%d %.17g %.17g %.17g %.17g %.17g"\n')
        return files | {deck: files[deck].replace("\nrun ", f"\n{dump}{style}run ", 1)}

    result = perform(code, system, tmp_path / "run", dumping)
    assert result.status == "completed", result
    rows = [line.split() for line in (tmp_path / "run" / "glued.dump").read_text().splitlines()]
    count = sum(len(r.radius) for r in system.rings)
    table = np.array([r for r in rows if len(r) == 6 and r[0].isdigit()], float).reshape(3, count, 6)
    assert table[0, :, 0].tolist() == list(range(74, 74 + count))
    for k, frame in enumerate(table):
        start = 0
        for body in system.rings:
            part, start = frame[start : start + len(body.radius)], start + len(body.radius)
            angle = body.omega * k * 100 * system.dt
            turned = np.exp(1j * angle) * ((body.x - body.centre) @ [1.0, 1j])
            np.testing.assert_allclose((part[:, 1:3] - body.centre) @ [1.0, 1j], turned, rtol=0, atol=1e-16)
            np.testing.assert_allclose(part[:, 3:5] @ [1.0, 1j], 1j * body.omega * turned, rtol=0, atol=1e-15)
            np.testing.assert_allclose(part[:, 5], body.omega, rtol=1e-15)


# --- what a run leaves -----------------------------------------------------------------------------


def test_forces_at_the_set_up_are_those_of_the_contacts_and_see_all_velocities(code, run):
    """There forces and contact rows see the same, full-step velocities; torque: sum of (p - c) x f, reversed."""
    centre = (0.1, 0.2)
    found = run(code, couette(2.0, centre=centre, sliding=SPRING, steps=100))
    start, contacts = found.series, found.frames[0].contacts
    for k, name in enumerate(("inner", "outer")):
        rows = contacts["j"] == -1 - k
        f, arm = contacts.vector("fx", "fy")[rows], contacts.vector("px", "py")[rows] - centre
        torque = (arm[:, 0] * f[:, 1] - arm[:, 1] * f[:, 0]).sum()
        told = [start[f"{name}_{c}"][0] for c in ("torque", "fx", "fy")]
        np.testing.assert_allclose(told, [-torque, *-f.sum(axis=0)], rtol=1e-11)
        frame = found.frames[0].walls
        np.testing.assert_array_equal([frame[c][k] for c in ("torque", "fx", "fy")], told)
    static = run(code, couette(2.0, centre=centre, sliding=SPRING, steps=100, particles=discs(
        (p := couette(centre=centre).particles).x, p.radius)))
    assert abs(static.series["inner_torque"][0] - start["inner_torque"][0]) > 1e-6


def test_contact_rows_of_rings(code, run):
    """Branch between the centres, overlap and point from it, no contact among glued discs, no glued disc in frames."""
    system = couette(4.0, sliding=SPRING)
    for step, frame in zip((0, 100, 200), run(code, system), strict=True):
        assert frame.particles["id"].tolist() == list(range(1, 74))
        assert frame.box is None
        assert "nx" not in frame.walls
        x, radius, c = frame.particles.vector("x", "y"), frame.particles["radius"], frame.contacts
        expected = []
        for body in system.rings:
            turned = np.exp(1j * (body.omega or 0.0) * step * system.dt) * (body.x @ [1.0, 1j])
            branch = x[:, None] - np.stack([turned.real, turned.imag], axis=-1)
            distance = np.linalg.norm(branch, axis=2)
            i, g = np.nonzero(distance < radius[:, None] + GLUED)
            overlap = (radius[:, None] + GLUED - distance)[i, g]
            n = branch[i, g] / distance[i, g, None]
            point = x[i] - (radius[i] - overlap / 2)[:, None] * n
            expected.append(np.column_stack([i + 1.0, np.full(len(i), -body.index), overlap, point]))
        expected = np.concatenate(expected)
        rows = c.vector("i", "j", "overlap", "px", "py")[c["j"] < 0]
        expected, rows = (t[np.lexsort((t[:, 2], t[:, 1], t[:, 0]))] for t in (expected, rows))
        assert len(rows) > 30
        np.testing.assert_allclose(rows, expected, rtol=0, atol=1e-15)


def test_contact_output_does_not_alter_the_run(code, run):
    system = couette(-1.0, sliding=SPRING, rolling=ROLLING)
    looked, blind = run(code, system), run(code, system.with_(contacts=False))
    for a, b in zip(looked, blind, strict=True):
        for group in ("particles", "walls"):
            for column, values in getattr(a, group).items():
                np.testing.assert_array_equal(values, getattr(b, group)[column], err_msg=column)
    for column, values in looked.series.items():
        np.testing.assert_array_equal(values, blind.series[column], err_msg=column)


def test_a_disc_that_breaks_through_is_an_unstable_run(code, tmp_path):
    start = couette(contacts=False, particles=discs([[35e-3, 0.0], [0.0, 35e-3]], [SMALL] * 2, [[200.0, 0.0], [0, 0]]))
    result = perform(code, start, tmp_path / "run")
    assert result.status == "unstable", result


# --- what a deck says ------------------------------------------------------------------------------


def test_support_and_its_limits():
    turning = couette(1.0)
    boxed = turning.with_(periodic=(1.0, 1.0))
    sticky = couette(1.0, contacts=False, sliding=SPRING, rolling=ROLLING, normal=VariableHystereticNormal(
        loading_stiffness=352.1, largest_unloading_stiffness=700.0, adhesion_stiffness=50.0, plasticity_depth=0.05,
        normal_damping=0.19))
    for name in ("lammps", "liggghts"):
        levels = {s.effect: s.level for s in ENGINES[name].supports(turning)}
        assert levels["glued rings"] == "exact"
        assert "unsupported" not in levels.values()
        assert "unsupported" in [s.level for s in ENGINES[name].supports(boxed) if s.effect == "glued rings"]
        with pytest.raises(ValueError, match="no rings"):
            ENGINES[name].render_prescribed(turning)
    still = sticky.with_(rings=tuple(replace(r, omega=None) for r in sticky.rings),
                         particles=discs(sticky.particles.x, sticky.particles.radius))
    set_up = [[s.note for s in ENGINES["liggghts"].supports(s_) if "set-up" in s.note] for s_ in (sticky, still)]
    assert [len(notes) for notes in set_up] == [1, 0]


@pytest.mark.parametrize("name", ["lammps", "liggghts"])
def test_glued_discs_stand_behind_the_particles(name):
    files = ENGINES[name].render(couette(2.0))
    rows = [line.split() for line in files["packing.data"].splitlines() if line[:1].isdigit()]
    assert ["240", "atoms"] in rows
    first = [row for row in rows if row[0] == "74"]
    assert [float(first[0][2]), *map(float, first[0][4:6])] == [2 * GLUED, INNER, 0.0]
    assert [float(c) for c in first[1][1:]] == [0.0, 2.0 * INNER, 0.0, 0.0, 0.0, 2.0]
    assert "group ring_inner id 74:125" in files[f"in.{name}"]
    assert "group ring_outer id 126:240" in files[f"in.{name}"]
    assert "move rotate" not in ENGINES[name].render(couette(None))[f"in.{name}"]
