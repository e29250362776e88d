"""Which runs are put beside each other, and as what.

`same_conventions`: an engine and the kernel computing in that engine's conventions: they must agree
to round-off until chaos. `codes`: two independent codes, each with its own conventions. Without
tangential forces the conventions do not differ, and one kernel is the partner of all.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

KERNEL_PREFIX = "kernel:"


@dataclass(frozen=True, kw_only=True)
class Pair:
    """Two engines by name; `kind` is "same_conventions" or "codes"."""

    left: str
    right: str
    kind: str


def pairs_of(engines: list[str]) -> list[Pair]:
    """Return the pairs that mean something, engines in the order given."""
    codes = [e for e in engines if not e.startswith(KERNEL_PREFIX)]
    kernels = [e for e in engines if e.startswith(KERNEL_PREFIX)]
    found = [Pair(left=c, right=k, kind="same_conventions") for c in codes if (k := partner(c, kernels))]
    return found + [Pair(left=a, right=b, kind="codes") for a, b in combinations(codes, 2)]


def partner(code: str, kernels: list[str]) -> str | None:
    """Return the kernel in this code's conventions; the only kernel there is where they coincide."""
    own = KERNEL_PREFIX + code
    if own in kernels:
        return own
    return kernels[0] if kernels == [KERNEL_PREFIX + "talk"] else None
