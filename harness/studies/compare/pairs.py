"""Which runs are put beside each other, and as what."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal, TypeVar

from harness.engines.registry import KERNEL_PREFIX, kernel_of
from harness.engines.word import code_of

T = TypeVar("T")

Kind = Literal["same_conventions", "same_code", "codes", "other_conventions"]
"""same_conventions: an engine and the kernel computing in that engine's conventions; they agree to
round-off until chaos. same_code: two versions of one code, or one on more processes; the same is declared for them.
codes: two independent codes, each with its own conventions.
other_conventions: an engine and the kernel in conventions of somebody else; shown, nothing is declared
for them."""


@dataclass(frozen=True, kw_only=True)
class Pair:
    """Two engines by name."""

    left: str
    right: str
    kind: Kind

    @property
    def name(self) -> str:
        """What figures and tables call it."""
        return f"{self.left} - {self.right}"

    def missing(self, done: Mapping[str, object]) -> str:
        """Say which of the two has no completed run, "" if both have."""
        absent = [e for e in (self.left, self.right) if e not in done]
        return f"no completed run of {' and '.join(absent)}" if absent else ""

    def both(self, done: Mapping[str, Mapping[int, T]]) -> dict[int, tuple[T, T]]:
        """Return what the two have, by packing, for the packings that both completed."""
        left, right = done.get(self.left, {}), done.get(self.right, {})
        return {number: (left[number], right[number]) for number in left if number in right}


def pairs_of(engines: Sequence[str], *, friction: bool) -> list[Pair]:
    """Return the pairs that mean something, engines in the order given.

    friction: whether there are tangential forces; without them the conventions do not differ, and
    any kernel is the partner of every code.
    """
    codes = [e for e in engines if not e.startswith(KERNEL_PREFIX)]
    kernels = [e for e in engines if e.startswith(KERNEL_PREFIX)]
    beside = [Pair(left=c, right=k, kind=_kind(c, k, friction)) for c in codes for k in _partners(c, kernels)]
    return beside + [Pair(left=a, right=b, kind=_kind_of_codes(a, b)) for a, b in combinations(codes, 2)]


def declared_for(kind: str, pairs: Sequence[Pair]) -> list[Pair]:
    """Return the pairs that a scene means by a kind: what holds for same conventions holds for one code."""
    kinds = ("same_conventions", "same_code") if kind == "same_conventions" else (kind,)
    return [p for p in pairs if p.kind in kinds]


def _partners(code: str, kernels: list[str]) -> list[str]:
    own = kernel_of(code)
    return [own] if own in kernels else kernels


def _kind(code: str, kernel: str, friction: bool) -> Kind:
    return "same_conventions" if not friction or kernel == kernel_of(code) else "other_conventions"


def _kind_of_codes(left: str, right: str) -> Kind:
    return "same_code" if code_of(left) == code_of(right) else "codes"
