"""What a tangential law is composed with."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

from reference.kernel.model import Model
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.laws.normal import NormalOperations
from reference.kernel.program.program import Program


@dataclass(frozen=True, kw_only=True)
class Setting:
    """The program, its contacts, the normal law's operations, and the dimension's `rotation` module."""

    p: Program
    c: Contacts
    model: Model
    normal: NormalOperations
    rotation: ModuleType
