"""What takes part in `grainproof bench`. Adding one: an object that follows `Timed`, and a word here."""

from __future__ import annotations

from harness.engines.kernel.bench import PROGRAM, TEXTBOOK
from harness.engines.lammps.bench import GRANULAR, HOOKE
from harness.engines.liggghts.bench import TIMED as LIGGGHTS
from harness.engines.timed import Timed

KERNEL: Timed = PROGRAM
"""What all others are compared with."""

BENCHES: tuple[Timed, ...] = (PROGRAM, TEXTBOOK, HOOKE, GRANULAR, LIGGGHTS)
