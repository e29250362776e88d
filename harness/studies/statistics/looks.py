"""How often the same comparison was looked at with more and more replicates: each further look costs level.

Whoever adds replicates until something passes looks several times, and each look has its own chance of a false alarm.
The k-th number of replicates that one comparison (same start, same engines) is judged with below one folder is its k-th
look, made at the declared rate times FURTHER^(k - 1), which keeps all looks together below twice the declared rate. The
same number again is the same look: the runs are the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import msgspec

from harness.runs.atomic import write_json_atomic

FILE = "looks.json"
FURTHER = 0.5
"""Of the level of the look before."""


class Looks(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Numbers of replicates in the order in which they were looked at, by comparison."""

    looks: dict[str, list[int]] = {}


def which_look(out: Path, start: str, engines: Sequence[str], count: int) -> tuple[int, ...]:
    """Return the numbers of replicates of all looks up to this one, and keep it in ``out/looks.json``.

    start: digest of the first start; count: replicates, of which one alone is no look: an empty tuple.
    A file that is damaged is begun anew.
    """
    if count < 2:
        return ()
    known = _read(out / FILE)
    key = " ".join([start, *sorted(engines)])
    before = known.get(key, [])
    if count not in before:
        before = [*before, count]
        out.mkdir(parents=True, exist_ok=True)
        write_json_atomic(out / FILE, {"looks": known | {key: before}})
    return tuple(before[: before.index(count) + 1])


def level_of(declared: float, looks: Sequence[int]) -> float:
    """Return the rate of false alarms of the last of `looks`.

    >>> level_of(0.05, ()), level_of(0.05, (8,)), level_of(0.05, (8, 16, 32))
    (0.05, 0.05, 0.0125)
    """
    return declared * FURTHER ** max(len(looks) - 1, 0)


def _read(path: Path) -> dict[str, list[int]]:
    try:
        return msgspec.json.decode(path.read_bytes(), type=Looks).looks
    except (OSError, msgspec.MsgspecError):
        return {}
