"""Whatever value stands in a shipped scene, `grainproof scene` answers with tables or with one line."""

import copy
import math
import random
import tomllib
import warnings
from pathlib import Path

from harness.cli import main

SCENES = sorted((Path(__file__).resolve().parents[2] / "inputs" / "scenes").glob("*.toml"))
VALUES = (
    0, 0.0, -1, -1.5, 1e-3, 2.0, 10**6, 1e12, 1e30, -1e30, 1e-30, 1e300, -1e300, 5e-324, 2**64, 10**400,
    math.inf, -math.inf, math.nan, "", "x", "2", "1e5", "\n", True, False,
    [], [1.0], [0.0, 0.0], [1.0, 2.0, 3.0, 4.0], [1e300, 1e300], [1e30, 1e30, 1e30], {},
)
EDITS = 300


def places(data, before=()):
    """Every place of nested data."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, inner in items:
        yield (*before, key)
        yield from places(inner, (*before, key))


def edited(number):
    """A shipped scene with one to three values replaced; the same for the same number."""
    choose = random.Random(number)
    data = tomllib.loads(choose.choice(SCENES).read_text())
    for _ in range(choose.choice((1, 1, 2, 3))):
        *parents, last = choose.choice(list(places(data)))
        table = data
        for key in parents:
            table = table[key]
        table[last] = copy.deepcopy(choose.choice(VALUES))
    return data


def survived(file, capsys):
    """Return the exit status of `grainproof scene` in this process."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        status = main(["scene", str(file)])
    out, err = capsys.readouterr()
    text = file.read_text()
    assert not [str(w.message) for w in warned], text
    assert status in (0, 2), text
    assert err.count("\n") == (0 if status == 0 else 1), text
    assert (out == "") == (status == 2), text
    assert "Traceback" not in err
    assert err[:-1].isprintable() or not err
    return status


def test_any_value_in_a_shipped_scene(scenes, capsys):
    texts = (scenes.dump(edited(number)) for number in range(EDITS))
    assert {survived(scenes.write(text), capsys) for text in texts} == {0, 2}
