"""What an effect leaves in decks, in the kernel's program and in the output; and what of it is there while it is off.

Decks are compared line by line with their numbers taken out, so that only structure counts. An effect that is off
leaves nothing behind when the deck without it has no word that the deck with it lacks, when the kernel's program has
only operations that are also there with it and none in the effect's name, remembers nothing more, and the output has no
column more. What an engine cannot do without is told with its reason (`harness.engines.whole.in_place`); that is a
known difference, and anything else differs.
"""

from __future__ import annotations

import json
import re
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.engines.protocol import REFUSED, Engine
from harness.engines.whole import in_place
from harness.scene.system import System
from harness.studies.verdict import Verdict

DATA = {".data", ".csv", ".stl"}
"""Files of a deck that hold bodies, not commands."""

NUMBER = re.compile(r"(?<![A-Za-z_\d])[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?", re.IGNORECASE)

OPERATIONS = {"rotation": ("rotation", "relative rotation"), "driven walls": ("driven walls",)}
"""Names under which the kernel's program keeps the operations of an effect, where they are not its own."""


@dataclass(frozen=True, kw_only=True)
class Trace:
    """One engine on one system: lines of its deck, words of them without numbers, operations, memory, columns.

    operations, memory: of the kernel; None of engines whose inside is not told. memory: numbers that a contact keeps,
    by law. columns: of the output; None where no run told.
    """

    lines: tuple[str, ...]
    operations: Counter | None = None
    memory: Counter | None = None
    columns: frozenset[str] | None = None

    @property
    def skeletons(self) -> Counter:
        """Lines without their numbers."""
        return Counter(skeleton(line) for line in self.lines)


@dataclass(frozen=True, kw_only=True)
class Footprint:
    """One effect on one engine.

    added: lines that are there with the effect only. operations: of the kernel, with the effect only, by name and
    number. memory: numbers that a contact keeps more, columns: of the output, more. left: what stands there although
    the effect is off. why: of the verdict.
    """

    effect: str
    engine: str
    verdict: Verdict
    why: str
    added: tuple[str, ...] = ()
    operations: Mapping[str, int] | None = None
    memory: Mapping[str, int] | None = None
    columns: tuple[str, ...] | None = None
    left: tuple[str, ...] = ()


def skeleton(line: str) -> str:
    """Return a line without its numbers.

    >>> skeleton("fix drag grains viscous 0.004"), skeleton("c_pair[3] x2")
    ('fix drag grains viscous #', 'c_pair[#] x2')
    """
    return NUMBER.sub("#", line)


def trace(engine: Engine, system: System, columns: frozenset[str] | None = None) -> Trace:
    """Return what an engine makes of a system."""
    files = {n: t for n, t in engine.render(system).items() if Path(n).suffix not in DATA}
    lines = tuple(line for name, text in files.items() for line in _lines(name, text))
    if not engine.name.startswith("kernel:"):
        return Trace(lines=lines, columns=columns)
    operations, memory = _inside(engine, system)
    return Trace(lines=lines, operations=operations, memory=memory, columns=columns)


def footprint(effect: str, engine: Engine, on: Trace, off: Trace, *, replaced: str = "") -> Footprint:
    """Judge an effect by the traces with it and without it. replaced: why another law stands in its place, if one does.
    """
    added, gone = on.skeletons - off.skeletons, off.skeletons - on.skeletons
    words_on, words_off = (Counter(w for s in lines.elements() for w in s.split()) for lines in (added, gone))
    instead = [w for w in (words_off - words_on) if w != "#"]
    numbers = [] if added else [new for new, old in zip(off.lines, on.lines, strict=False) if new != old]
    inner = _inner(effect, on, off)
    operations = _more(on.operations, off.operations)
    allowed, reason = in_place(engine.name).get(effect, ((), ""))
    unknown = [w for w in instead if not replaced and not any(a in w for a in allowed)]
    unknown += [] if reason or replaced else numbers
    unknown += [w for w in inner if not any(a in w for a in allowed)]
    left = [*instead, *numbers, *inner]
    if not (added or left or operations):
        verdict, why = "differs", "the deck with the effect is the deck without it"
    elif unknown:
        verdict, why = "differs", f"there while it is off: {'; '.join(unknown)}"
    elif left:
        verdict, why = "known_difference", reason or replaced
    else:
        verdict, why = "agrees", "nothing of it is there while it is off"
    return Footprint(
        effect=effect, engine=engine.name, verdict=verdict, why=why, left=tuple(dict.fromkeys(left)),
        added=_picked(on.lines, added), operations=operations, memory=_more(on.memory, off.memory),
        columns=None if on.columns is None or off.columns is None else tuple(sorted(on.columns - off.columns)),
    )


def _picked(lines: Sequence[str], added: Counter) -> tuple[str, ...]:
    """Return the lines behind the skeletons, as many as there are, the last ones, each once."""
    left, found = Counter(added), []
    for line in reversed(lines):
        if left[skeleton(line)] > 0:
            left[skeleton(line)] -= 1
            found.append(line)
    return tuple(dict.fromkeys(reversed(found)))


def refusal(engine: Engine, system: System) -> str:
    """Return why an engine does not take a system, "" if it does."""
    return next((f"{s.effect}: {s.note}" for s in engine.supports(system) if s.level in REFUSED), "")


def _inner(effect: str, on: Trace, off: Trace) -> list[str]:
    """Return what program, memory and output have of the effect while it is off, or more of than with it."""
    found = []
    if off.operations is not None and on.operations is not None:
        named = OPERATIONS.get(effect, (effect,))
        found += [f"operation {name}" for name in off.operations if name.partition(":")[0] in named]
        if off.operations.total() > on.operations.total():
            found += [f"operation {name}" for name in off.operations - on.operations]
        found += [f"memory of {law}" for law in _more(off.memory, on.memory)]
    if off.columns is not None and on.columns is not None:
        found += [f"column {c}" for c in sorted(off.columns - on.columns)]
    return list(dict.fromkeys(found))


def _more(a: Mapping[str, int] | None, b: Mapping[str, int] | None) -> dict[str, int] | None:
    return None if a is None or b is None else dict(Counter(a) - Counter(b))


def _lines(name: str, text: str) -> list[str]:
    """Return the commands of a deck, lines joined, comments left out; the leaves of a JSON file with their path."""
    if name.endswith(".json"):
        return list(_leaves(json.loads(text), ""))
    joined = text.replace("&\n", " ")
    return [" ".join(line.split()) for raw in joined.splitlines() if (line := _bare(raw))]


def _bare(line: str) -> str:
    """Return a line without its comment; a # within quotes is none."""
    inside = False
    for k, character in enumerate(line):
        inside ^= character == '"'
        if character == "#" and not inside:
            return line[:k].strip()
    return line.strip()


def _leaves(value: object, path: str):
    if isinstance(value, dict | list):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, inner in items:
            yield from _leaves(inner, f"{path}.{key}" if path else str(key))
    elif path != "title":
        yield f"{path} = {value}"


def _inside(engine: Engine, system: System) -> tuple[Counter | None, Counter | None]:
    """Return the operations of a step and what a contact remembers; what has no program runs as the textbook does."""
    from reference.kernel.deck import read_deck
    from reference.kernel.program.simulation import ProgramSimulation, fastest

    with tempfile.TemporaryDirectory(prefix="grainproof-deck-") as folder:
        for name, text in engine.render(system).items():
            (Path(folder) / name).write_text(text)
        model, _ = read_deck(Path(folder))
    simulation = fastest(model)
    if not isinstance(simulation, ProgramSimulation):
        return None, None
    return Counter(simulation.operations), Counter({name: len(rows) for name, rows in simulation.history.items()})
