"""Closed systems: what contacts make of energy is noticed, whatever the reason; what they take, or lend, is not."""

import math
from dataclasses import replace

import numpy as np
import pytest

from reference.kernel import energy_watch
from reference.kernel.conventions import NAMED
from reference.kernel.energy_watch import MOST, WORTH_SAYING, EnergyWatch, energies, is_closed
from reference.kernel.guards import KernelUnstable
from reference.kernel.model import Constant, Loaded
from reference.kernel.program.simulation import ProgramSimulation


def lattice(dem, *, amplitude=0.25, depth=1e-2, step=0.02, normal=None, sliding=None, **more):
    """Sixteen discs on a triangular lattice, pressed in a periodic box and agitated; t_c = pi/sqrt(2 k_n) by KN."""
    apart, rows = 2 * (1 - depth), range(4)
    x = [[apart * (c + 0.5 * (r % 2)), apart * math.sqrt(0.75) * r] for r in rows for c in range(4)]
    rng, speed = np.random.default_rng(2), amplitude * 2 * depth * math.sqrt(2 * dem.KN)
    v = speed * rng.normal(size=(16, 2))
    return dem.model(
        x, v=v - v.mean(axis=0), spin=speed * rng.normal(size=(16, 1)),
        periodic=(4 * apart, 4 * apart * math.sqrt(0.75)),
        normal=normal or dem.table("normal", "linear", normal_damping=0.0), sliding=sliding,
        dt=step * math.pi / math.sqrt(2 * dem.KN), **{"convention": "lammps"} | more)


def spring(dem, stiffness=0.8, **numbers):
    given = {"shear_friction": 10.0, "shear_stiffness": stiffness * dem.KN, "shear_damping": 0.0}
    return dem.table("sliding", "spring", **given | numbers)


def mindlin(dem, restitution):
    return {"normal": dem.table("normal", "hertz", youngs_modulus=1.82 * dem.KN / math.sqrt(0.01), poisson_ratio=0.3,
                                restitution=restitution),
            "sliding": dem.table("sliding", "mindlin", shear_friction=10.0)}


def watched(model, steps, kind=ProgramSimulation):
    """Return the watch after a run."""
    simulation, watch = kind(model), EnergyWatch(model, steps)
    while (look := watch.next_look) is not None:
        simulation.advance(look - simulation.state.step)
        watch.look(simulation)
    return watch


# --- what makes energy --------------------------------------------------------------------------


def test_mindlins_springs_make_energy_and_a_dashpot_spends_it(dem):
    """It is the law, not the step: at half the step the same time makes as much."""
    for step in (0.04, 0.02):
        share = watched(lattice(dem, step=step, amplitude=0.6, **mindlin(dem, 1.0)), int(400 / step)).share
        assert share > WORTH_SAYING
    assert watched(lattice(dem, **mindlin(dem, 0.99)), 10_000).share < 1e-3


def test_the_second_order_scheme_makes_energy_where_contacts_last(dem):
    with pytest.raises(KernelUnstable, match="made energy out of nothing.*second-order scheme"):
        watched(lattice(dem, sliding=spring(dem), step=0.04, convention=NAMED["corrected"]), 20_000)
    damped = spring(dem, shear_damping=0.1 * math.sqrt(dem.KN))
    assert watched(lattice(dem, sliding=damped, step=0.04, convention=NAMED["corrected"]), 20_000).share < 0.01


def test_the_convention_of_a_code_goes_on_and_says_so(dem):
    model = lattice(dem, sliding=spring(dem), step=0.04, convention=NAMED["corrected"])
    other = replace(model, convention=replace(model.convention, name="lammps"))
    watch = watched(other, 20_000)
    assert watch.share > MOST
    assert watch.warning().startswith("contacts have made energy out of nothing")


@pytest.mark.parametrize("carried", [{"v": 30.0}, {"gravity": (0.0, -9.81)}])
def test_who_flies_along_finds_the_same(dem, carried):
    """A lattice that flies, or falls, as a whole: motion that no contact can spend hides nothing."""
    still = lattice(dem, sliding=spring(dem), step=0.04, convention=NAMED["corrected"])
    fast = replace(still, v=still.v + carried.get("v", 0.0), gravity=carried.get("gravity"))
    for model in (still, fast):
        with pytest.raises(KernelUnstable, match="made energy out of nothing"):
            watched(model, 20_000)


# --- what does not ------------------------------------------------------------------------------


@pytest.mark.parametrize("step", [0.02, 0.1])
def test_springs_give_back_what_they_took(dem, step):
    watch = watched(lattice(dem, sliding=spring(dem), step=step), 5000)
    assert watch.share < 0.02
    assert watch.warning() is None


@pytest.mark.parametrize("mutant", ["springs of friction", "what the leapfrog keeps"])
def test_parts_that_were_left_out_would_look_like_energy_made(dem, monkeypatch, mutant):
    model, whole = lattice(dem, sliding=spring(dem), step=0.1), energies
    share = watched(model, 3000).share
    if mutant == "springs of friction":
        monkeypatch.setattr(energy_watch, "_held", lambda interaction, forces, family: np.zeros(1))
    else:
        monkeypatch.setattr(energy_watch, "energies", lambda s: (whole(s)[0], whole(s)[1][:3]))
    assert watched(model, 3000).share > 3 * share


def test_a_slide_on_a_dashpot_ends_without_a_word(dem):
    """While a disc slides its spring is as long as friction and the dashpot together ask for: that is no energy."""
    model = dem.model(
        [[0.0, 1.0 - 1e-5]], v=[[0.1, 0.0]], spin=[[0.4]], gravity=(0.0, -1e-5 * dem.KN), mu=0.5, kt=0.2 * dem.KN,
        gt=30.0, gn=10.0, walls=[dem.wall("floor", (0, 0), (0, 1), friction=True)], dt=2e-4)
    assert watched(model, 20_000).share < 1e-3


def test_a_loaded_wall_trades_its_height_for_motion(dem):
    top = dem.wall("top", (0, 2.2), (0, -1), motion=Loaded(mass=3.0, load=20.0, stress=0.0, span=None, damping=0.0))
    model = dem.model([[0.0, 1.0]], walls=[dem.wall("floor", (0, 0), (0, 1)), top], dt=dem.tc / 100)
    watch = watched(model, 20_000)
    assert 0 < watch.share < 0.05
    assert watch._kinetic > 1.0


def test_rest_under_pressure_is_no_energy_made(dem):
    """Nothing moves but rounding: more than all of the kinetic energy, and next to nothing of what is stored."""
    assert watched(lattice(dem, amplitude=0.0, sliding=spring(dem)), 2000).share == 0.0


# --- its numbers --------------------------------------------------------------------------------


def test_the_energy_is_that_of_the_plain_sums(dem):
    model = dem.cluster(3, 2, squeeze=0.97, mu=0.4, gravity=(0.0, -3.0), gn=0.0)
    simulation = dem.Simulation(model)
    simulation.advance(5)
    kinetic, parts = energies(simulation)
    s = simulation.state
    n = model.particle_count
    whole = 0.5 * (model.mass * (s.v[:, :n] ** 2).sum(axis=0)).sum() + 0.5 * (model.inertia * s.spin[0, :n] ** 2).sum()
    assert parts[0] == pytest.approx(whole)
    carried = (model.mass * s.v[:, :n]).sum(axis=1)
    assert kinetic == pytest.approx(whole - 0.5 * (carried**2).sum() / model.mass.sum())
    stored = sum(float((0.5 * dem.KN * f.contact.overlap**2).sum()) for _, f in simulation.contacts())
    assert parts[1] == pytest.approx(stored)
    assert sum(parts[-1:]) == pytest.approx(3.0 * float((model.mass * s.x[1, :n]).sum()))


def test_what_is_closed(dem):
    floor = dem.wall("floor", (0, 0), (0, 1))
    loaded = Loaded(mass=1.0, load=1.0, stress=0.0, span=None, damping=0.1)
    closed = dem.model([[0.0, 1.0]], walls=[floor, replace(floor, motion=loaded)], mu=0.3, gravity=(0.0, -1.0))
    assert is_closed(closed)
    for motion in (Constant(velocity=(0.0, 0.1)), replace(loaded, stress=1.0)):
        assert not is_closed(replace(closed, walls=(replace(floor, motion=motion),)))
    assert not is_closed(dem.model([[0.0, 1.0]], normal=dem.table("normal", "hysteretic")))


def test_what_it_keeps_is_all_that_it_needs(dem):
    model = lattice(dem, **mindlin(dem, 1.0))
    simulation, watch, other = ProgramSimulation(model), EnergyWatch(model, 1000), EnergyWatch(model, 1000)
    for _ in range(4):
        watch.look(simulation)
        simulation.advance(watch.next_look - simulation.state.step)
    other.take(watch.kept())
    for each in (watch, other):
        each.look(simulation)
    assert vars(watch) == vars(other)


@pytest.mark.parametrize(("steps", "every"), [(5, 1), (400, 20), (10**6, 2000)])
def test_looks_are_few(dem, steps, every):
    simulation = dem.Simulation(dem.model([[0.0, 0.0]]))
    watch = EnergyWatch(simulation.model, steps)
    assert watch.next_look == 0
    watch.look(simulation)
    assert watch.next_look == every
