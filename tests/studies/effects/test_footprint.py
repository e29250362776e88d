"""Off leaves nothing behind: every effect of the registry on every engine, and engines that cheat."""

import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pytest

from harness.engines.registry import ENGINES
from harness.scene.effects import EFFECTS
from harness.scene.load import load_scene
from harness.scene.resolve import resolve
from harness.studies.effects import footprint as module
from harness.studies.effects.footprint import Trace, footprint, refusal, skeleton, trace
from harness.studies.effects.pairs import on_and_off
from harness.studies.effects.switches import SWITCHES
from harness.studies.effects.variants import variants_of
from harness.studies.prepare import Prepared

SCENES = Path(__file__).resolve().parents[3] / "inputs" / "scenes"
WALKED = ("oblique", "oblique_impact", "hertz_impact", "hysteretic_impact", "rolling_incline", "spinning_sphere")
"""Between them every effect that has a switch is on, or can be switched on."""

NEVER = {"normal contact", "rotation", "periodic axes", "driven walls", "loaded walls", "glued rings", "materials"}
"""Effects that are part of the experiment, or follow from others."""


def pairs_of(name):
    file = SCENES / f"{name}.toml"
    scene = load_scene(file)
    start = Prepared(number=0, system=resolve(scene, file), packing=None)
    return on_and_off(scene, file, start, variants_of(scene, file, [start]))


@pytest.fixture(scope="module")
def walked():
    found = []
    for name in WALKED:
        for pair in pairs_of(name):
            for engine in ENGINES.values():
                if not (refusal(engine, pair.on) or refusal(engine, pair.off)):
                    traces = (trace(engine, system) for system in (pair.on, pair.off))
                    found.append((name, footprint(pair.effect, engine, *traces, replaced=pair.replaced)))
    return found


def test_every_effect_has_a_switch():
    assert list(SWITCHES) == list(EFFECTS)


def test_off_leaves_nothing_behind_on_any_engine(walked):
    bad = [(name, f.effect, f.engine, f.why) for name, f in walked if f.verdict not in ("agrees", "known_difference")]
    assert not bad


def test_every_effect_was_walked(walked):
    assert {f.effect for _, f in walked} == set(EFFECTS) - NEVER


def test_known_differences_are_few_and_have_reasons(walked):
    known = {(f.effect, f.engine.partition(":")[0]) for _, f in walked if f.verdict == "known_difference"}
    assert ("sliding friction", "kernel") not in known
    assert ("background drag", "lammps") not in known
    assert ("gravity", "liggghts") not in known
    assert all(len(f.why) > 20 for _, f in walked if f.verdict == "known_difference")


def test_operations_of_an_effect_are_counted(walked):
    (drag,) = {tuple(f.operations.items()) for n, f in walked if (n, f.effect) == ("oblique", "background drag")
               and f.engine == "kernel:talk"}
    assert dict(drag) == {"background drag: multiply": 1, "background drag: subtract": 1}
    friction = next(f for n, f in walked if (n, f.effect, f.engine) == ("oblique", "sliding friction", "kernel:talk"))
    assert friction.memory == {"sliding": 1}


# --- engines that cheat --------------------------------------------------------------------------------


@dataclass(frozen=True)
class Engine:
    """A name is all that is asked."""

    name: str = "liggghts"


WITH, WITHOUT = ("units si", "fix drag grains viscous 0.004", "run 5"), ("units si", "run 5")


def judged(off_lines, effect="background drag", on_lines=WITH, **more):
    on, off = ({k: v[which] for k, v in more.items()} for which in (0, 1))
    return footprint(effect, Engine(), Trace(lines=on_lines, **on), Trace(lines=off_lines, **off))


def test_a_clean_deck_agrees():
    found = judged(WITHOUT)
    assert (found.verdict, found.added, found.left) == ("agrees", ("fix drag grains viscous 0.004",), ())


def test_a_coefficient_that_is_written_as_zero_is_found():
    found = judged(("units si", "fix drag grains viscous 0", "run 5"))
    assert found.verdict == "differs"
    assert found.left == ("fix drag grains viscous 0",)


def test_a_word_in_its_place_is_found():
    found = judged(("units si", "fix nothing grains idle", "run 5"))
    assert found.verdict == "differs"
    assert "idle" in found.left


def test_a_word_with_a_reason_is_a_known_difference_and_only_that_word():
    on, off = ("law hooke tangential history",), ("law hooke limitForce on tangential history",)
    assert judged(off, "damping attraction", on).verdict == "known_difference"
    assert judged((*off, "compute rest all sum"), "damping attraction", on).verdict == "differs"


def test_a_deck_that_ignores_the_effect_is_found():
    assert judged(WITHOUT, on_lines=WITHOUT).verdict == "differs"


@pytest.mark.parametrize(
    ("more", "left"),
    [
        ({"operations": (Counter({"a: add": 2, "background drag: add": 1}), Counter({"background drag: add": 1})),
          "memory": (Counter(), Counter())}, "operation background drag: add"),
        ({"operations": (Counter({"a: add": 1}), Counter({"a: add": 1, "b: add": 1})),
          "memory": (Counter(), Counter())}, "operation b: add"),
        ({"operations": (Counter({"a: add": 1}), Counter({"a: add": 1})),
          "memory": (Counter(), Counter({"sliding": 1}))}, "memory of sliding"),
        ({"columns": (frozenset({"particles.x"}), frozenset({"particles.x", "contacts.ux"}))}, "column contacts.ux"),
    ],
)  # fmt: skip
def test_what_program_memory_and_output_keep_is_found(more, left):
    found = judged(WITHOUT, **more)
    assert found.verdict == "differs"
    assert left in found.left


def test_a_kernel_that_always_drags_is_found():
    """A mutant: the deck writer adds a drag of zero to every deck."""
    pair = next(p for p in pairs_of("oblique") if p.effect == "background drag")
    kernel = ENGINES["kernel:talk"]
    honest = footprint(pair.effect, kernel, trace(kernel, pair.on), trace(kernel, pair.off))
    assert honest.verdict == "agrees"

    class Dragging:
        name = kernel.name

        def render(self, system):
            files = kernel.render(system)
            deck = json.loads(files["kernel.json"])
            return files | {"kernel.json": json.dumps({"drag": 0.0} | deck)}

    cheat = Dragging()
    found = footprint(pair.effect, cheat, trace(cheat, pair.on), trace(cheat, pair.off))
    assert found.verdict == "differs"
    assert "operation background drag: multiply" in found.left


@pytest.mark.parametrize(
    ("line", "expected"),
    [("fix a b 1e-5 -2.0", "fix a b # #"), ("type1 f_wall[3]", "type1 f_wall[#]"), ("0.5*vx[12]", "#*vx[#]")],
)
def test_skeletons_have_no_numbers(line, expected):
    assert skeleton(line) == expected


def test_comments_and_continued_lines():
    text = 'fix a all x 1 &\n   2   # why\n# alone\nprint "# kept"\n'
    assert module._lines("in.any", text) == ["fix a all x 1 2", 'print "# kept"']
