"""Timing sessions: the two ends of the line, and every code that can stand at the far one."""

import re
import sys
import time

import numpy as np
import pytest

from harness.engines.benches import BENCHES
from harness.engines.child import one_thread_env
from harness.engines.session import Lost, Session
from harness.scene.contact import HertzNormal, LinearNormal, SpringRolling, SpringSliding
from harness.studies.bench.cases import MEAN_RADIUS, find_case
from harness.studies.bench.measure import SAME, WARM_STEPS, distance
from harness.studies.bench.problem import problem

CHILD = """
import sys, os, time
import numpy as np
from harness.engines.rounds import core_of, serve
class Running:
    def __init__(self):
        print("the engine talks", flush=True)
        os.system("echo and its libraries too")
        self.steps = 0
    def advance(self, steps):
        {advance}
        self.steps += steps
    def places(self):
        return np.full((2, 2), float(self.steps))
    def facts(self):
        return {{"held": 7}}
sys.exit(serve(Running, core_of(sys.argv)))
"""


class Scripted:
    """A code whose child is a few lines of Python."""

    name, slow, note = "scripted", False, ""

    def __init__(self, text: str):
        self.text = text

    def command(self, core):
        return [sys.executable, "-c", self.text, "-" if core is None else str(core)]

    def environment(self):
        return one_thread_env()


def scripted(advance: str) -> Scripted:
    return Scripted(CHILD.format(advance=advance))


def test_requests_are_answered_whatever_the_engine_prints(tmp_path):
    with Session(scripted("print('noise')"), tmp_path, core=None, time_limit=30) as session:
        assert session.run(5) >= 0.0
        session.run(3)
        assert np.array_equal(session.places(), np.full((2, 2), 8.0))
        facts = session.facts()
        assert facts["held"] == 7
        assert facts.get("resident", 1) > 0
    assert {"the engine talks", "and its libraries too"} <= set((tmp_path / "child.log").read_text().splitlines())


def test_what_is_timed_is_cpu_time(tmp_path):
    """Sleeping costs none; the figure does not depend on who else is busy."""
    with Session(scripted("time.sleep(0.2)"), tmp_path, core=None, time_limit=30) as session:
        assert session.run(1) < 0.1


def test_the_child_stays_on_its_core(tmp_path):
    import os

    if not hasattr(os, "sched_getaffinity"):
        pytest.skip("this system cannot pin")
    core = max(os.sched_getaffinity(0))
    told = scripted("self.steps = sum(os.sched_getaffinity(0)) + 1000 * len(os.sched_getaffinity(0)) - steps")
    with Session(told, tmp_path, core=core, time_limit=30) as session:
        session.run(1)
        assert session.places()[0, 0] == core + 1000


@pytest.mark.parametrize(("advance", "why"), [
    ("raise ValueError('no luck')", "ValueError: no luck"),
    ("print('bad end', file=sys.stderr); sys.stderr.flush(); os._exit(7)", "ended with status 7: bad end"),
    ("os.abort()", "ended by SIGABRT"),
])
def test_a_child_that_fails_says_how(tmp_path, advance, why):
    with Session(scripted(advance), tmp_path, core=None, time_limit=30) as session, pytest.raises(Lost, match=why):
        session.run(1)


def test_a_child_that_cannot_begin_is_lost_at_once(tmp_path):
    with pytest.raises(Lost, match="NameError"):
        Session(Scripted("no_python"), tmp_path, core=None, time_limit=30)
    nobody = Scripted("")
    nobody.command = lambda core: ["no-such-program"]
    with pytest.raises(Lost, match="no-such-program"):
        Session(nobody, tmp_path, core=None, time_limit=30)


def test_a_child_that_hangs_is_lost_and_gone(tmp_path):
    start = time.monotonic()
    with Session(scripted("time.sleep(600)"), tmp_path, core=None, time_limit=10) as session:
        session._time_limit = 0.3
        with pytest.raises(Lost, match="no answer within"):
            session.run(1)
    assert session._child.returncode is not None
    assert time.monotonic() - start < 60


# --- every code ----------------------------------------------------------------------------------


@pytest.fixture(params=BENCHES, ids=lambda t: t.name)
def timed(request):
    if not request.param.probe().available:
        pytest.skip(f"{request.param.name}: {request.param.probe().detail}")
    return request.param


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    def system(case: str, count: int = 24, **changes):
        cache = tmp_path_factory.mktemp("packings")
        return problem(find_case(case), count, cache=cache)[0].with_(**changes)

    return system


def moved(timed, system, folder, steps) -> np.ndarray:
    """Positions after the steps, made in two parts."""
    for name, text in timed.render(system, skin=0.05 * MEAN_RADIUS).items():
        (folder / name).write_text(text)
    with Session(timed, folder, core=None, time_limit=120) as session:
        assert session.run(steps - 30) > 0.0
        session.run(30)
        return session.places()


def textbook(system, steps) -> np.ndarray:
    """The same by the textbook evaluation in this process."""
    import tempfile
    from pathlib import Path

    from harness.engines.kernel.deck import render_deck
    from reference.kernel.deck import read_deck
    from reference.kernel.simulation import Simulation

    with tempfile.TemporaryDirectory() as folder:
        for name, text in render_deck(system, "lammps").items():
            (Path(folder) / name).write_text(text)
        simulation = Simulation(read_deck(Path(folder))[0])
    simulation.advance(steps)
    return simulation.state.x[:, : len(system.particles)].T


@pytest.mark.parametrize("case", ["2D dashpot", "3D dashpot", "2D friction, periodic"])
def test_every_code_solves_the_problem(timed, system, tmp_path, case):
    """Without friction to rounding; with it up to the code's own convention. Rounds are one run, not several."""
    of_case = system(case)
    off = distance(of_case, textbook(of_case, 120), moved(timed, of_case, tmp_path, 120))
    assert off < (1e-7 if "dashpot" in case else 0.02)


def test_another_problem_would_be_noticed(system):
    """The bound of the study is below what a forgotten wall, dashpot or friction, or half a spring does."""
    from dataclasses import replace as changed

    from msgspec.structs import replace

    whole = system("2D friction", 200)
    p, sliding, normal = whole.particles, whole.sliding, whole.normal
    others = {
        "no wall": whole.with_(walls=whole.walls[:3]), "no friction": whole.with_(sliding=None),
        "no dashpot": whole.with_(normal=replace(normal, normal_damping=0.0)),
        "half a spring": whole.with_(sliding=replace(sliding, shear_stiffness=0.5 * sliding.shear_stiffness)),
        "other inertia": whole.with_(particles=changed(p, inertia_factor=0.8 * p.inertia_factor)),
    }
    expected = textbook(whole, WARM_STEPS)
    off = {name: distance(whole, expected, textbook(other, WARM_STEPS)) for name, other in others.items()}
    assert min(off.values()) > SAME, off


def test_drag_and_gravity_reach_every_code(timed, system, tmp_path):
    drag = find_case("2D friction, drag").background
    of_case = system("2D dashpot", gravity=(0.0, -500.0), background=drag)
    expected = textbook(of_case, 120)
    assert distance(of_case, expected, moved(timed, of_case, tmp_path, 120)) < 1e-7
    assert distance(of_case, expected, textbook(of_case.with_(gravity=None), 120)) > 1e-3
    assert distance(of_case, expected, textbook(of_case.with_(background=None), 120)) > 1e-6


def test_decks_write_nothing_and_are_the_same_every_time(timed, system):
    files = timed.render(system("3D friction"), skin=1e-4)
    assert files == timed.render(system("3D friction"), skin=1e-4)
    for text in files.values():
        assert not re.search(r"^(dump|compute|run|write_|fix \S+ \S+ ave/)|store_force|region", text, re.MULTILINE)


def test_an_effect_that_is_off_is_in_no_deck(timed, system):
    smooth = "\n".join(timed.render(system("2D dashpot"), skin=1e-4).values())
    rough = "\n".join(timed.render(system("2D friction"), skin=1e-4).values())
    words = r"linear_history|hooke/history|tangential history|shear_friction|coefficientFriction"
    assert not re.search(words, smooth)
    assert re.search(words, rough)


def test_what_a_code_cannot_compute_is_refused_with_a_reason(timed, system):
    assert timed.refusal(system("2D friction")) == ""
    hertz = HertzNormal(
        youngs_modulus=1e7, poisson_ratio=0.3, restitution=0.8, attraction="allowed", impact_speed=0.1
    )
    spring = SpringSliding(shear_friction=0.5, shear_stiffness=1e4, shear_damping=0.0)
    rolling = SpringRolling(rolling_friction=0.1, rolling_stiffness=1e4, rolling_damping=0.0)
    if timed.name in ("lammps hooke", "liggghts"):
        assert timed.refusal(system("2D friction", normal=hertz, sliding=spring))
    if timed.name == "lammps hooke":
        assert "no rolling" in timed.refusal(system("2D friction", rolling=rolling))
        plain = system("2D friction")
        plain.particles.mass[0] *= 2.0
        assert "dashpots" in timed.refusal(plain)


def test_the_older_lammps_style_clips_attraction_where_the_scene_does(system):
    hooke = next(t for t in BENCHES if t.name == "lammps hooke")
    if not hooke.probe().available:
        pytest.skip(hooke.probe().detail)
    clipped = LinearNormal(normal_stiffness=1e5, normal_damping=0.1, attraction="clipped")
    assert "limit_damping" in hooke.render(system("2D dashpot", normal=clipped), skin=1e-4)["in.lammps"]
    assert "limit_damping" not in hooke.render(system("2D dashpot"), skin=1e-4)["in.lammps"]
