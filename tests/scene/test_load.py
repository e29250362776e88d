"""What is wrong with a file is said in one line: file, place, expected, got, fix."""

import os
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.scene.load import load_scene
from harness.scene.model import Biaxial, Free


def test_good_scenes_load(scenes):
    assert isinstance(scenes.load(scenes.biaxial), Biaxial)
    free = scenes.load(scenes.free, {"planes": [scenes.floor]})
    assert isinstance(free, Free)
    assert free.bodies[0].position == (0.0, 2e-3)
    assert free.planes[0].friction


@pytest.mark.parametrize(
    ("name", "got"),
    [("none.toml", "no such file or directory"), ("", "a folder"), ("pipe", "no regular"), ("a\0b", "null byte")],
)
def test_what_is_no_file(scenes, name, got):
    os.mkfifo(scenes.folder / "pipe")
    with pytest.raises(InputError) as caught:
        load_scene(str(scenes.folder / name) if "\0" not in name else name)
    message = scenes.message(caught)
    assert "expected a scene file (TOML), got" in message
    assert got in message


def test_unreadable_file(scenes, monkeypatch):
    def refuse(self):
        raise PermissionError(13, "Permission denied")

    path = scenes.write("a = 1")
    monkeypatch.setattr(Path, "read_bytes", refuse)
    with pytest.raises(InputError, match="expected a scene file .TOML., got permission denied"):
        load_scene(path)


def test_huge_file(scenes):
    assert "at most 1000000 bytes, got 1000001 bytes" in scenes.refused_text(b"#" * 1_000_001)


@pytest.mark.parametrize(
    ("raw", "place", "got"),
    [
        (b"a = 1\nb = '\xe4'\n", "line 2", "the byte 0xe4"),
        (b"\xff\xfea\0=\0", "line 1", "the byte 0xff"),
        (b"\xef\xbb\xbfa = 1", "line 1", "a byte order mark"),
    ],
)
def test_wrong_encoding(scenes, raw, place, got):
    assert scenes.refused_text(raw).startswith(f"scene.toml: {place}: expected UTF-8 text, got {got}")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a = 1\nb = = 2\n", 'scene.toml: line 2: expected TOML, got "b = = 2"; Invalid value'),
        ("a = 1\na = 2\n", 'scene.toml: line 2: expected TOML, got "a = 2"; Cannot overwrite a value'),
        ("a = [1,", "scene.toml: last line: expected TOML, got an error: Invalid value"),
        ("a = " + "[" * 3000, "scene.toml: expected a scene, got arrays nested too deeply"),
        ("[" + ".".join("a" * 2000) + "]\nx = 1", "scene.toml: expected a scene, got tables nested too deeply"),
        ("a = 0x" + "F" * 9000, "scene.toml: a: expected an integer of at most 2^53, got an integer of 36000 bits"),
    ],
)
def test_not_toml(scenes, text, message):
    assert scenes.refused_text(text).startswith(message)


def test_integer_too_long_to_read(scenes):
    assert scenes.refused_text("a = " + "9" * 5000).startswith("scene.toml: expected TOML, got an error: Exceeds")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"contact.sliding.shear_stifness": 1.0},
            "contact.sliding.shear_stifness: expected one of law, shear_friction, shear_stiffness, shear_damping, "
            'dynamic_friction, got the unknown key "shear_stifness"; did you mean shear_stiffness?',
        ),
        ({"colour": "red"}, 'colour: expected one of kind, title, particles, preparation, contact, top, side,'),
        ({"top": 3}, "top: expected a table, got 3"),
        ({"top.duration": "long"}, 'top.duration: expected a number > 0, got "long"'),
        ({"top.duration": True}, "top.duration: expected a number > 0, got true"),
        ({"top.duration": -1.5}, "top.duration: expected a number > 0, got -1.5"),
        ({"top.duration": float("nan")}, "top.duration: expected a finite number, got nan"),
        ({"side.damping": float("inf")}, "side.damping: expected a finite number, got inf"),
        (
            {"side.mass": 1e200},
            "side.mass: expected a magnitude of at most 1e+30 in SI units, got 1e+200; out of range: check the number",
        ),
        ({"side.mass": 1e-200}, "side.mass: expected a magnitude of at least 1e-30 in SI units, got 1e-200; out of"),
        ({"top.duration": "0.06"}, 'top.duration: expected a number > 0, got "0.06"; write it without quotes: 0.06'),
        ({"outputs.contacts": "true"}, 'outputs.contacts: expected true or false, got "true"; write it without quotes'),
        ({"outputs.frames": 2**60}, "outputs.frames: expected an integer of at most 2^53, got an integer of 61 bits"),
        ({"outputs.frames": 1.5}, "outputs.frames: expected an integer >= 1, got 1.5"),
        ({"outputs.contacts": 1}, "outputs.contacts: expected true or false, got 1"),
        ({"particles.count": 0}, "particles.count: expected an integer >= 1 and <= 1000000, got 0"),
        ({"preparation.residual_tolerance": 0.5}, "preparation.residual_tolerance: expected a number > 0 and <= 0"),
        (
            {"particles.inertia": "rung"},
            'particles.inertia: expected "disc", "ring" or "sphere" or a number > 0 and <= 1, got "rung"; '
            "did you mean ring?",
        ),
        ({"contact.normal.law": "hooke"}, 'contact.normal.law: expected "linear", "hertz", "hysteretic", '),
        (
            {"contact.normal.law": "hertz"},
            "contact.normal.normal_stiffness: expected one of law, youngs_modulus, poisson_ratio, restitution, "
            'attraction, impact_speed, got the unknown key "normal_stiffness"; did you mean '
            'contact.normal.normal_stiffness with law = "linear"?',
        ),
        ({"particles.mass.kind": "dics"}, 'particles.mass.kind: expected "sphere" or "disc", got "dics"; did'),
        ({"particles.mass": [1]}, 'particles.mass: expected a table with kind = "sphere" or "disc", got [1]'),
        ({"compare.plateau": [0.05]}, "compare.plateau: expected two numbers, a range of strains, got [0.05]"),
        ({"compare.packings": 1000000}, "compare.packings: expected an integer >= 1 and <= 1000, got 1000000"),
        ({"compare.windows": 2}, "compare.windows: expected an array of tables, got 2"),
        ({"compare.windows": [{}]}, 'compare.windows[0].pairs: expected "codes" or "same_conventions", got nothing'),
    ],
)
def test_schema(scenes, changes, message):
    assert scenes.refusal(scenes.biaxial, changes).startswith(f"scene.toml: {message}")


@pytest.mark.parametrize(
    ("changes", "place"),
    [
        ({"packing": "p.csv"}, "particles.packing"),
        ({"duration": 1.0}, "top.duration"),
        ({"mass": 1.0}, "particles.mass or side.mass"),
        ({"contact.shear_friction": 0.5}, "contact.sliding.shear_friction"),
        ({"top.tolerance": 1.0}, "compare.windows[].tolerance"),
        ({"periodic": [1.0, 1.0]}, 'periodic of a scene with kind = "free"'),
    ],
)
def test_a_key_at_the_wrong_place_is_told_where_it_belongs(scenes, changes, place):
    assert f"; did you mean {place}" in scenes.refusal(scenes.biaxial, changes)


def test_a_key_of_another_kind_of_table_is_told_its_kind(scenes):
    moving = scenes.floor | {"motion": {"kind": "constant", "velocity": [1.0, 0.0], "travel": 1.0}}
    message = scenes.refusal(scenes.free, {"planes": [moving]})
    assert message.endswith('; did you mean planes[].motion.travel with kind = "cosine"?')
    message = scenes.refusal(scenes.free, {"planes": [scenes.floor | {"travel": 1.0}]})
    assert message.endswith('; did you mean planes[].motion.travel with kind = "cosine"?')


@pytest.mark.parametrize(
    ("missing", "expected"),
    [
        ("kind", '"biaxial", "couette" or "free"'),
        ("title", "one line of up to"),
        ("contact", "a table"),
        ("contact.normal", 'a table with law = "linear"'),
        ("contact.normal.law", '"linear"'),
        ("numerics.dt_fraction", "a number > 0"),
    ],
)
def test_missing_key(scenes, missing, expected):
    message = scenes.refusal(scenes.biaxial, {missing: scenes.remove})
    assert message.startswith(f"scene.toml: {missing}: expected {expected}")
    assert message.endswith(f"got nothing; add {missing.split('.')[-1]}")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kind": "freee"}, 'kind: expected "biaxial", "couette" or "free", got "freee"; did you mean free?'),
        ({"dimension": 4}, "dimension: expected 2 or 3, got 4"),
        ({"dimension": "2"}, 'dimension: expected 2 or 3, got "2"; write it without quotes: 2'),
        ({"dimension": "two"}, 'dimension: expected 2 or 3, got "two"'),
        ({"bodies.1.position": [1.0]}, "bodies[1].position: expected an array of 2 or 3 numbers, got [1.0]"),
        ({"bodies.1.position.1": "up"}, 'bodies[1].position[1]: expected a number, got "up"'),
        ({"planes": [{"name": "a"}]}, "planes[0].point: expected an array of 2 or 3 numbers, got nothing; add point"),
        ({"bodies": {}}, "bodies: expected an array of tables, got a table"),
    ],
)
def test_schema_of_free_scenes(scenes, changes, message):
    assert scenes.refusal(scenes.free, changes) == f"scene.toml: {message}"


def test_place_counts_arrays_and_names_the_motion(scenes):
    planes = [scenes.floor, scenes.lid | {"motion": {"kind": "cosinus", "travel": 1e-4, "duration": 1.0}}]
    assert scenes.refusal(scenes.free, {"planes": planes}) == (
        'scene.toml: planes[1].motion.kind: expected "constant", "cosine" or "loaded", got "cosinus"; '
        "did you mean cosine?"
    )
    planes = [scenes.floor, scenes.lid | {"motion": {"kind": "cosine", "travel": 1e-4}}]
    assert scenes.refusal(scenes.free, {"planes": planes}).startswith(
        "scene.toml: planes[1].motion.duration: expected a number > 0, got nothing"
    )


HOSTILE = ["a\nshell rm -rf x", "a\n", "${HOME}", "`id`", "a &", "a # b", "<b>", "\x1b[2J", "a\u2028b", "", "x" * 101]


@pytest.mark.parametrize("text", HOSTILE)
def test_titles_cannot_carry_commands(scenes, text):
    assert scenes.refusal(scenes.biaxial, {"title": text}).startswith("scene.toml: title: expected one line of up to")


@pytest.mark.parametrize("text", [*HOSTILE, "Floor", "a b", "9a", "../a", "a;b", "a$b"])
def test_wall_names_are_plain_words(scenes, text):
    message = scenes.refusal(scenes.free, {"planes": [scenes.floor | {"name": text}]})
    assert message.startswith("scene.toml: planes[0].name: expected a word of up to 24 lower-case letters")


def test_hostile_keys_and_file_names_are_shown_harmlessly(scenes):
    assert scenes.refusal(scenes.biaxial, {"a\nb\x1b": 1}).startswith('scene.toml: "a\\nb\\x1b": expected one of')
    with pytest.raises(InputError) as caught:
        load_scene(scenes.folder / "no\n\x1b[2Jthing.toml")
    assert scenes.message(caught).startswith("no\\n\\x1b[2Jthing.toml: expected a scene file")
