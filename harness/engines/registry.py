"""The engines that there are. Adding one: a package with the protocol, and a line here."""

from __future__ import annotations

from harness.engines.kernel import KERNELS
from harness.engines.lammps import LAMMPS
from harness.engines.liggghts import LIGGGHTS
from harness.engines.protocol import Engine
from harness.errors import InputError
from harness.scene.describe import nearest

ENGINES: dict[str, Engine] = {e.name: e for e in (LAMMPS, LIGGGHTS, *KERNELS)}

KERNEL_PREFIX = "kernel:"

USUAL = ("lammps", "liggghts", "kernel")
"""What `grainproof compare` compares unless told otherwise."""


def choose_engines(words: list[str]) -> tuple[Engine, ...]:
    """Return the engines a user named; `kernel` stands for the kernel in the others' conventions.

    The kernel is run once for every other chosen engine that is installed, in that engine's own
    conventions, so that each code meets its match; alone it computes as the talks do.
    Raises InputError for an unknown name.
    """
    if not words:
        raise _unknown("--engines", "nothing")
    chosen: list[Engine] = []
    for word in dict.fromkeys(words):
        if word == "kernel":
            chosen += _kernels_for(words)
        elif word in ENGINES:
            chosen.append(ENGINES[word])
        else:
            raise _unknown("--engines", word)
    return tuple(dict.fromkeys(chosen))


def find_engine(name: str) -> Engine:
    """Return one engine by name (`kernel` alone is `kernel:talk`); raises InputError."""
    if name == "kernel":
        return ENGINES[KERNEL_PREFIX + "talk"]
    if name not in ENGINES:
        raise _unknown("--engine", name)
    return ENGINES[name]


def _unknown(option: str, word: str) -> InputError:
    names = ["kernel", *ENGINES]
    return InputError(
        file=option, expected=f"names out of {', '.join(names)}", got=word or "nothing", fix=nearest(word, names)
    )


def _kernels_for(words: list[str]) -> list[Engine]:
    matches = [ENGINES[KERNEL_PREFIX + w] for w in words if KERNEL_PREFIX + w in ENGINES and w in ENGINES]
    installed = [k for k in matches if ENGINES[k.name.removeprefix(KERNEL_PREFIX)].probe().available]
    return installed or [ENGINES[KERNEL_PREFIX + "talk"]]
