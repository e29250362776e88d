"""Drawn scenes of all kinds, from the file through the decks of every engine to a few steps of the kernel.

What may come out: a scene or an InputError of one line; a deck of finite numbers for every engine that takes the
system; a run whose every number is finite, or KernelUnstable with the reason. Nothing else, and never a NaN.
"""

import re
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st

from harness.engines.protocol import takes
from harness.engines.registry import ENGINES
from harness.errors import InputError
from harness.report.expected import likely_system
from harness.scene.explain import explain
from harness.scene.load import load_scene
from harness.scene.model import Biaxial, Couette
from harness.scene.resolve import known_system, resolve_biaxial, resolve_couette
from reference.kernel.deck import read_deck
from reference.kernel.output import contact_table, particle_table, wall_table
from reference.kernel.program.simulation import fastest
from reference.kernel.simulation import KernelUnstable, Simulation
from reference.kernel.watches import Watches

MOST_STEPS = 24
"""Of the program kernel; the textbook makes a third of them."""

NOT_FINITE = re.compile(r"(?<![\w.])[-+]?(nan|inf)(?![\w.])", re.IGNORECASE)


def fuzz(examples):
    return settings(
        max_examples=examples, deadline=None, database=None, derandomize=examples < 1000,
        suppress_health_check=list(HealthCheck),
    )


def powers(low, high):
    """Numbers of all sizes between 10^low and 10^high."""
    return st.floats(low, high).map(lambda e: float(f"{10.0**e:.6g}"))


def signed(low, high):
    return st.tuples(powers(low, high), st.sampled_from([-1.0, 1.0, 0.0])).map(lambda t: t[0] * t[1])


def maybe(strategy, otherwise=None, often=0.5):
    return st.floats(0, 1).flatmap(lambda p: strategy if p < often else st.just(otherwise))


# --- contact laws ------------------------------------------------------------------------------------

IN_BOXES = ("linear", "hysteretic", "hysteretic_variable")
ANY_LAW = (*IN_BOXES, "linear", "hertz", "dmt", "jkr")
ATTRACTION = st.sampled_from(["allowed", "clipped"])
STIFFNESS = powers(2, 6)


@st.composite
def normals(draw, names):
    law = draw(st.sampled_from(names))
    damping = draw(maybe(powers(-7, -1), 0.0, 0.7))
    if law == "linear":
        table = {"law": law, "normal_stiffness": draw(STIFFNESS), "normal_damping": damping}
        return table | {"attraction": draw(ATTRACTION)}
    if law.startswith("hysteretic"):
        k1, ratio = draw(STIFFNESS), draw(st.sampled_from([1.0, 1.1, 2.0, 5.0, 100.0]))
        table = {"law": law, "loading_stiffness": k1, "adhesion_stiffness": draw(maybe(powers(1, 7), 0.0)),
                 "normal_damping": damping}
        if law == "hysteretic":
            return table | {"unloading_stiffness": ratio * k1}
        depth = draw(st.sampled_from([0.001, 0.05, 0.5, 0.999]))
        return table | {"largest_unloading_stiffness": max(ratio, 1.01) * k1, "plasticity_depth": depth}
    nu = draw(st.sampled_from([-0.9, 0.0, 0.3, 0.5]))
    speed = draw(powers(-3, 0))
    table = {"law": law, "youngs_modulus": draw(powers(4, 10)), "poisson_ratio": nu, "impact_speed": speed}
    if law == "hertz":
        return table | {"restitution": draw(st.sampled_from([1e-6, 0.05, 0.5, 0.999, 1.0])),
                        "attraction": draw(ATTRACTION)}
    return table | {"surface_energy": draw(powers(-6, 1)), "normal_damping": damping}


FRICTION = st.sampled_from([1e-12, 1e-3, 0.3, 1.0, 10.0, 1e6])


@st.composite
def slidings(draw, normal, spring=True):
    names = ["viscous", *(["spring", "spring"] if spring else []), *(["mindlin"] if normal["law"] == "hertz" else [])]
    law, mu = draw(st.sampled_from(names)), draw(FRICTION)
    if law == "mindlin":
        return {"law": law, "shear_friction": mu}
    if law == "viscous":
        return {"law": law, "shear_friction": mu, "shear_damping": draw(powers(-7, -1))}
    table = {"law": law, "shear_friction": mu, "shear_stiffness": draw(STIFFNESS),
             "shear_damping": draw(maybe(powers(-7, -1), 0.0))}
    return table | draw(maybe(st.just({"dynamic_friction": mu / 2}), {}, 0.2))


@st.composite
def contacts(draw, dimension, names=ANY_LAW, spring=True):
    made = {"normal": draw(normals(names))}
    if draw(st.booleans()):
        made["sliding"] = draw(slidings(made["normal"], spring))
    if draw(st.integers(0, 3)) == 0:
        spring_law = {"law": "spring", "rolling_friction": draw(FRICTION), "rolling_stiffness": draw(STIFFNESS),
                      "rolling_damping": draw(maybe(powers(-7, -1), 0.0))}
        made["rolling"] = draw(st.sampled_from([spring_law, {"law": "constant", "rolling_friction": 0.1}]))
    if dimension == 3 and draw(st.integers(0, 2)) == 0:
        made["torsion"] = {"law": "spring", "torsion_friction": draw(FRICTION), "torsion_stiffness": draw(STIFFNESS),
                           "torsion_damping": draw(maybe(powers(-7, -1), 0.0))}
    return made


# --- scenes --------------------------------------------------------------------------------------------


@st.composite
def bodies(draw, dimension, scale):
    """Bodies on a coarse grid, shifted: apart, touching, overlapping, some far larger or heavier than others."""
    count = draw(st.integers(1, 6))
    cells = draw(st.lists(
        st.tuples(*[st.integers(0, 3)] * dimension), min_size=count, max_size=count, unique=draw(st.integers(0, 9)) > 0,
    ))
    spacing = scale * draw(st.sampled_from([1.0, 1.6, 1.9, 1.999999, 2.0, 2.2, 30.0]))
    far = draw(maybe(powers(-3, 3), 0.0, 0.2))
    made = []
    for cell in cells:
        body = {
            "position": [far + spacing * (c + 1) + 0.05 * scale * draw(st.floats(-1, 1)) for c in cell],
            "radius": scale * draw(st.sampled_from([1.0, 1.0, 0.9, 0.5, 0.01])),
            "mass": draw(st.sampled_from([1e-5, 1e-5, 1.3e-5, 1e-9])),
            "velocity": [draw(signed(-3, 1)) for _ in range(dimension)],
        }
        spin = [draw(signed(-1, 4)) for _ in range(1 if dimension == 2 else 3)]
        body |= draw(maybe(st.just({"spin": spin}), {}, 0.4))
        made.append(body | draw(maybe(st.just({"inertia": "disc"}), {}, 0.2)))
    return made


@st.composite
def planes(draw, dimension, scale, rough):
    axis = draw(st.integers(0, dimension - 1))
    normal = [draw(st.sampled_from([0.0, 0.0, 0.3, -0.7])) for _ in range(dimension)]
    normal[axis] = draw(st.sampled_from([1.0, 2.0]))
    plane = {"point": [0.0] * dimension, "normal": normal, "friction": rough and draw(st.booleans())}
    travel = draw(st.sampled_from([-1.0, -0.1, 0.3, 1.0]))
    motions = [
        {"kind": "constant", "velocity": [draw(signed(-3, 0)) for _ in range(dimension)]},
        {"kind": "cosine", "travel": scale * travel, "duration": draw(powers(-6, -2))},
        {"kind": "loaded", "mass": draw(powers(-7, 0)), "load": draw(signed(-3, 2)), "damping": draw(powers(-6, 1))},
    ]
    return plane | draw(maybe(st.sampled_from(motions).map(lambda m: {"motion": m}), {}, 0.4))


@st.composite
def free_scenes(draw):
    dimension, scale = draw(st.sampled_from([2, 2, 3])), draw(st.sampled_from([1e-3, 1e-3, 1.0, 1e-6]))
    contact = draw(contacts(dimension))
    rough = any(k in contact for k in ("sliding", "rolling", "torsion"))
    scene = {
        "kind": "free", "title": "drawn", "dimension": dimension, "duration": draw(powers(-6, -3)), "contact": contact,
        "numerics": {"dt_fraction": draw(st.sampled_from([1e-3, 0.01, 0.03, 0.1]))},
        "outputs": _outputs(draw, dimension == 2 and rough), "bodies": draw(bodies(dimension, scale)),
    }
    walls = draw(st.lists(planes(dimension, scale, rough), max_size=3))
    if walls:
        scene["planes"] = [w | {"name": f"wall{k}"} for k, w in enumerate(walls)]
    elif draw(st.integers(0, 3)) == 0:
        scene["periodic"] = [40 * scale, *(draw(st.sampled_from([0.0, 40 * scale])) for _ in range(dimension - 1))]
    more = {"gravity": st.just([draw(signed(-1, 5)) for _ in range(dimension)]),
            "background": powers(-9, 0).map(lambda c: {"translational_drag": c})}
    for key, strategy in more.items():
        value = draw(maybe(strategy, None, 0.3))
        scene |= {} if value is None else {key: value}
    return scene


@st.composite
def boxes(draw):
    low = 1e-3 * draw(st.sampled_from([0.1, 0.5, 1.0]))
    contact = draw(contacts(2, IN_BOXES))
    pressure = draw(powers(-1, 2))
    scene = {
        "kind": "biaxial", "title": "drawn", "contact": contact,
        "particles": {
            "count": 9, "seed": draw(st.integers(0, 99)), "inertia": draw(st.sampled_from(["disc", "sphere", 0.7])),
            "radius": {"kind": "uniform", "min": low, "max": low * draw(st.sampled_from([1.0, 1.5, 3.0]))},
            "mass": {"kind": "sphere", "density": draw(powers(1, 4))},
        },
        "preparation": {"pressure": pressure, "residual_tolerance": 1e-6},
        "top": {"final_strain": draw(st.sampled_from([0.001, 0.1, 0.3])), "duration": draw(powers(-3, 0))},
        "side": {"pressure": pressure, "mass": draw(powers(-6, 0)), "damping": draw(maybe(powers(-6, 2), 0.0))},
        "numerics": {"dt_fraction": draw(st.sampled_from([1e-3, 0.01, 0.04]))},
        "outputs": _outputs(draw, "sliding" in contact),
    }
    return scene | draw(maybe(powers(-9, 0).map(lambda c: {"background": {"translational_drag": c}}), {}, 0.3))


@st.composite
def ring_scenes(draw):
    contact = draw(contacts(2, ("linear",)))
    return {
        "kind": "couette", "title": "drawn", "duration": draw(powers(-2, 1)), "contact": contact,
        "particles": {
            "seed": 1, "inertia": "disc", "mass": {"kind": "disc", "density": draw(powers(2, 4)), "height": 6e-3},
            "species": [{"count": 12, "radius": 3.7e-3}, {"count": draw(st.integers(1, 5)), "radius": 4.5e-3}],
        },
        "rings": {"inner_radius": 0.02, "outer_radius": 0.065, "grain_radius": draw(st.sampled_from([1.25e-3, 2.5e-3])),
                  "omega": draw(powers(-2, 2)) * draw(st.sampled_from([-1.0, 1.0]))},
        "preparation": {"start_size": 0.5, "grow": 0.2, "settle": 0.05},
        "numerics": {"dt_fraction": draw(st.sampled_from([1e-3, 0.01, 0.04]))},
        "outputs": _outputs(draw, any(k in contact for k in ("sliding", "rolling"))),
        "compare": {"steady_from": 0.0, "band": 0.01},
    }


def _outputs(draw, may_turn):
    return {"samples": draw(st.sampled_from([2, 4, 6, 12])), "frames": draw(st.integers(2, 4)),
            "contacts": draw(st.booleans()), "rotations": may_turn and draw(st.booleans())}


SCENES = st.one_of(free_scenes(), free_scenes(), boxes(), ring_scenes())
SPOILS = st.sampled_from([0, -1, 1e300, 5e-324, 1e-30, -0.0, float("nan"), float("inf"), "x", True, [], {}, 2**70])


@st.composite
def any_scenes(draw):
    """A drawn scene; one in six has a value spoiled."""
    scene = draw(SCENES)
    if draw(st.integers(0, 5)) == 0:
        table, key = draw(st.sampled_from(list(_leaves(scene))))
        table[key] = draw(SPOILS)
    return scene


def _leaves(value):
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield value, key
        yield from _leaves(inner)


# --- what is done with them --------------------------------------------------------------------------


@dataclass
class Flow:
    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    radius: np.ndarray


def a_grid(scene):
    """A packing for a box without making one: nine discs that touch."""
    low, high = scene.particles.radius.min, scene.particles.radius.max
    radius = np.linspace(low, high, 9)
    x = 1.99 * high * np.stack(np.meshgrid(np.arange(3), np.arange(3)), -1).reshape(-1, 2) + 0.999 * high
    return {"x": x, "radius": radius, "box": (6 * high, 6 * high)}


def a_flow(scene):
    """Discs in the gap of two rings, moving and turning."""
    radius = np.concatenate([np.full(s.count, s.radius) for s in scene.particles.species])
    angle = 2 * np.pi * np.arange(len(radius)) / len(radius)
    place = 0.5 * (scene.rings.inner_radius + scene.rings.outer_radius) + 0.004 * np.cos(3 * angle)
    x = place[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Flow(x=x, v=0.01 * x[:, ::-1], spin=np.cos(angle), radius=radius)


def resolved(scene, file):
    if isinstance(scene, Biaxial):
        return resolve_biaxial(scene, **a_grid(scene))
    if isinstance(scene, Couette):
        return resolve_couette(scene, a_flow(scene))
    return known_system(scene, file)


def finite(table):
    return all(np.isfinite(values).all() for values in table.values())


def refuse_nan_in(deck, engine):
    for name, text in deck.items():
        found = NOT_FINITE.search(text)
        assert found is None, f"{engine}: {name}: {text[max(0, found.start() - 60):found.end() + 20]}"


def run_a_little(folder, kernel):
    """Run a deck of the kernel for a few steps, by the program or by the textbook; say how it ended."""
    model, plan = read_deck(folder)
    try:
        simulation = fastest(model) if kernel != "textbook" else Simulation(model)
        steps = min(plan.steps, MOST_STEPS if kernel != "textbook" else MOST_STEPS // 3)
        watched_advance(simulation, steps)
        assert finite(particle_table(simulation)), "a particle's number is not finite"
        assert np.isfinite(simulation.state.wall_force).all(), "a wall's force is not finite"
        if model.walls:
            assert finite(wall_table(simulation)), "a wall's number is not finite"
        assert finite(contact_table(simulation)), "a contact's number is not finite"
    except KernelUnstable as reason:
        return "stopped" if str(reason).isprintable() else pytest.fail("a reason that is no plain line")
    return "ran"


def watched_advance(simulation, steps):
    """Make the steps, and let the watches look, as the command does."""
    watches = Watches(simulation.model, steps)
    while (look := watches.next_look) is not None:
        simulation.advance(look - simulation.state.step)
        watches.look(simulation)
        assert finite(watches.kept()), "what a watch found is not finite"
    simulation.advance(steps - simulation.state.step)


def understood(scenes, data):
    """Return the system of a drawn scene, None if it is refused; a step or outputs that a refusal advises are taken."""
    for _ in range(4):
        file = scenes.write(scenes.dump(data))
        try:
            scene = load_scene(file)
            explain(scene, known_system(scene, file), {})
            likely_system(scene, file)
            return resolved(scene, file)
        except InputError as error:
            assert str(error).isprintable() or pytest.fail("a refusal that is no plain line")  # noqa: PT017
            if not mended(data, error):
                return None
    return None


LARGEST_STEP = re.compile(r": numerics\.dt_fraction: expected at most ([-+.\de]+),")


def mended(data, error):
    """Take the largest time step that a refusal names, or the fewest outputs; say whether anything was changed."""
    step, numerics, outputs = LARGEST_STEP.search(str(error)), data.get("numerics"), data.get("outputs")
    if step:
        before, numerics["dt_fraction"] = numerics["dt_fraction"], 0.99 * float(step[1])
        return numerics["dt_fraction"] < before
    if ": outputs: expected samples and frames" in str(error) and outputs["samples"] != 1:
        outputs |= {"samples": 1, "frames": 1}
        return True
    return False


def survives(scenes, data, textbook):
    """One scene from its file to a few steps; anything but the outcomes above is an error of its own."""
    system = understood(scenes, data)
    if system is None:
        return "refused"
    for name, engine in ENGINES.items():
        if takes(engine, system):
            refuse_nan_in(engine.render(system), name)
    kernel = next((e for n, e in ENGINES.items() if n.startswith("kernel:") and takes(e, system)), None)
    if kernel is None:
        return "no kernel takes it"
    ended = {run_deck(scenes, ENGINES[n], system, textbook) for n in KERNELS if takes(ENGINES[n], system)}
    return "stopped" if "stopped" in ended else "ran"


KERNELS = ("kernel:talk", "kernel:corrected")


def run_deck(scenes, engine, system, textbook):
    folder = scenes.folder / "deck"
    folder.mkdir(exist_ok=True)
    for name, text in engine.render(system).items():
        (folder / name).write_text(text)
    with np.errstate(all="ignore"):
        ended = run_a_little(folder, "program")
        return run_a_little(folder, "textbook") if textbook and ended == "ran" else ended


@fuzz(200)
@given(data=any_scenes(), textbook=st.integers(0, 3).map(lambda k: k == 0))
def test_drawn_scenes_to_the_kernel(shared_scenes, data, textbook):
    event(survives(shared_scenes, data, textbook))


@pytest.mark.long
@fuzz(10_000)
@given(data=any_scenes(), textbook=st.integers(0, 3).map(lambda k: k == 0))
def test_ten_thousand_drawn_scenes(shared_scenes, data, textbook):
    event(survives(shared_scenes, data, textbook))


def test_what_is_drawn_is_mostly_run(shared_scenes):
    """The generator is no use if everything is refused: of 60 scenes at least a third run."""
    ended = []

    @fuzz(60)
    @given(data=SCENES)
    def draw(data):
        ended.append(survives(shared_scenes, data, False))

    draw()
    ran = ended.count("ran") + ended.count("stopped")
    assert ran >= len(ended) / 3, {word: ended.count(word) for word in set(ended)}


def test_what_would_be_found_is_found():
    """A NaN in a table or in a deck, and words that only look like one."""
    assert not finite({"x": np.array([0.0, np.nan])})
    refuse_nan_in({"in.lammps": "fix nano all nve  # finance, infinity, nanometre"}, "lammps")
    for text in ("timestep nan", "region -inf 0", "dt: NaN,"):
        with pytest.raises(AssertionError):
            refuse_nan_in({"deck": text}, "any")
