"""Whatever stands in a scene file, the answer is a scene or an InputError, and never anything else."""

import datetime
import json

import numpy as np
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st

from harness.errors import InputError
from harness.scene.effects import effects
from harness.scene.explain import as_json, explain
from harness.scene.load import load_scene
from harness.scene.model import Biaxial
from harness.scene.resolve import known_system, resolve_biaxial

FUZZ = settings(
    max_examples=250, deadline=None, database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)

NUMBERS = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True),
    st.integers(min_value=-(2**70), max_value=2**70),
    st.sampled_from([0, 0.0, -0.0, 1, -1, 1e-30, 1e30, 1e-3, 5e-324, 2**53, 0.5, 3]),
)
TEXTS = st.one_of(
    st.text(st.characters(exclude_categories=["Cs"]), max_size=12),
    st.sampled_from(["uniform", "spring", "loaded", "${x}", "a\nb", "../../etc/passwd", "/dev/zero", "free", "disc"]),
    st.sampled_from(["linear", "hertz", "hysteretic", "hysteretic_variable", "dmt", "jkr", "viscous", "constant"]),
)
SCALARS = st.one_of(NUMBERS, TEXTS, st.booleans(), st.just(datetime.date(2020, 1, 1)))
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXTS, inner, max_size=3), max_leaves=6
)


def paths(value, prefix=()):
    """All places of nested data, arrays by index."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        here = (*prefix, str(key))
        yield ".".join(here)
        yield from paths(inner, here)


def survives(scenes, text):
    """Load and use a scene; only an InputError of one printable line may come out."""
    file, message = scenes.write(text), ""
    try:
        scene = load_scene(file)
        use(scene, known_system(scene, file))
    except InputError as error:
        message = str(error)
    event("refused" if message else "loaded")
    assert not message or message.isprintable()


def use(scene, system):
    json.dumps(as_json(explain(scene, system, {"kernel": 1.0})), allow_nan=False)
    assert effects(scene, system)
    if system is None and isinstance(scene, Biaxial):
        low = scene.particles.radius.min
        grid = 2.1 * low * np.stack(np.meshgrid(np.arange(3), np.arange(3)), -1).reshape(-1, 2) + low
        system = resolve_biaxial(scene, x=grid, radius=np.full(9, low), box=(7 * low, 7 * low))
    assert len(system.digest()) == 64


def rich(scenes):
    """A free scene that calls for everything."""
    motions = [
        {"kind": "cosine", "travel": 1e-4, "duration": 1e-4},
        {"kind": "loaded", "mass": 1e-3, "load": 2.0, "damping": 0.5},
    ]
    return scenes.edited(scenes.free, {
        "planes": [scenes.floor, scenes.lid | {"motion": motions[0]},
                   scenes.floor | {"name": "low", "motion": motions[1]}],
        "gravity": [0.0, -9.81], "periodic": [1.0, 0.0], "background": {"translational_drag": 1e-3},
        "compare": {"agreements": [{"pairs": "codes", "tolerance": 1e-3}]},
    })


def spheres(scenes, normal, sliding, rolling):
    """Two spheres over a plane with every table of contact laws."""
    floor = scenes.floor | {"point": [0.0, 0.0, 0.0], "normal": [0.0, 1.0, 0.0]}
    contact = {
        "normal": scenes.normals[normal], "sliding": scenes.slidings[sliding], "rolling": scenes.rollings[rolling],
        "torsion": scenes.torsion,
    }
    motion = {"kind": "loaded", "mass": 1e-3, "load": 2.0, "damping": 0.5}
    lid = floor | {"name": "lid", "point": [0.0, 8e-3, 0.0], "normal": [0.0, -1.0, 0.0], "motion": motion}
    changes = {"contact": contact, "planes": [floor, lid], "numerics.dt_fraction": 0.002}
    return scenes.edited(scenes.free, scenes.balls | changes)


def lawful(scenes):
    """Each law in a scene of its own."""
    dynamic = {"contact.sliding.dynamic_friction": 0.3}
    return [
        spheres(scenes, "hertz", "mindlin", "spring"),
        scenes.edited(spheres(scenes, "hysteretic", "spring", "constant"), dynamic),
        spheres(scenes, "hysteretic_variable", "viscous", "spring"),
        spheres(scenes, "dmt", "spring", "constant"),
        spheres(scenes, "jkr", "viscous", "constant"),
        scenes.edited(box(scenes), {"contact.normal": scenes.normals["hysteretic_variable"]}),
        scenes.edited(box(scenes), {"contact.normal": scenes.normals["hysteretic"]}),
    ]


def test_lawful_scenes_load(shared_scenes):
    """What is fuzzed below is right before it is changed."""
    for base in (rich(shared_scenes), box(shared_scenes), *lawful(shared_scenes)):
        shared_scenes.load(base)


def box(scenes):
    windows = [{"pairs": "codes", "strain": 0.01, "tolerance": 1e-2}]
    compare = {"packings": 2, "plateau": [0.05, 0.1], "windows": windows, "published": ["talk_frictionless_100"]}
    return scenes.edited(scenes.biaxial, {"compare": compare, "background": {"translational_drag": 1e-3}})


@FUZZ
@given(data=st.data())
def test_any_value_at_any_place(shared_scenes, data):
    base = data.draw(st.sampled_from([rich(shared_scenes), box(shared_scenes), *lawful(shared_scenes)]))
    for _ in range(data.draw(st.integers(1, 2))):
        place = data.draw(st.sampled_from(list(paths(base))))
        value = data.draw(st.one_of(st.just(shared_scenes.remove), NUMBERS, VALUES))
        base = shared_scenes.edited(base, {place: value})
    survives(shared_scenes, shared_scenes.dump(base))


@FUZZ
@given(data=st.data())
def test_positive_numbers_of_any_size(shared_scenes, data):
    """Sizes that the schema lets through must not overflow on the way."""
    base = data.draw(st.sampled_from([rich(shared_scenes), box(shared_scenes), *lawful(shared_scenes)]))
    sizes = st.floats(-30, 30).map(lambda e: 10.0**e)
    places = [p for p in paths(base) if isinstance(value_at(base, p), float)]
    for place in data.draw(st.lists(st.sampled_from(places), min_size=1, max_size=4)):
        base = shared_scenes.edited(base, {place: data.draw(sizes)})
    survives(shared_scenes, shared_scenes.dump(base))


@FUZZ
@given(text=st.one_of(st.text(st.characters(exclude_categories=["Cs"])), st.binary()))
def test_any_text(shared_scenes, text):
    survives(shared_scenes, text)


@FUZZ
@given(
    table=st.lists(st.lists(st.one_of(NUMBERS.map(str), TEXTS), max_size=5), max_size=4),
    header=st.sampled_from(["x,y,radius,mass", "x,y,radius,mass,vx,vy,wz,inertia", "x,y", ""]),
)
def test_any_table_of_bodies(shared_scenes, table, header):
    rows = "\n".join([header, *(",".join(row) for row in table)])
    shared_scenes.write(rows, "bodies.csv")
    changes = {"bodies": shared_scenes.remove, "bodies_file": "bodies.csv"}
    survives(shared_scenes, shared_scenes.dump(shared_scenes.edited(shared_scenes.free, changes)))


def value_at(data, place):
    for key in place.split("."):
        data = data[int(key)] if isinstance(data, list) else data[key]
    return data
