"""LAMMPS in a timing session, with its two pair styles for the same law.

`granular` is what the harness runs: its forces are the scene's to rounding. `hooke` is the older gran/hooke[/history],
about twice as fast. It has dashpots in proportion to the reduced mass only, so that a constant one needs
particles of one mass; its torque acts at the radius. Walls are granular in both: the older wall/gran hooke/history
has a tangential spring that is off by sqrt(R delta), see `defects`.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from harness.engines.child import one_thread_env
from harness.engines.facts import is_rough, walls_across
from harness.engines.lammps.box import simulation_box
from harness.engines.lammps.deck import atom_lines, contact_lines
from harness.engines.lammps.effects import drag_lines, gravity_lines, integration_lines
from harness.engines.lammps.engine import LAMMPS
from harness.engines.lammps.law import wall_law
from harness.engines.lammps.packing import packing_data
from harness.engines.rounds import core_word
from harness.engines.text import number, numbers
from harness.engines.timed import refused, ring_refusal
from harness.scene.contact import LinearNormal, SpringSliding

if TYPE_CHECKING:
    from harness.engines.protocol import Probe
    from harness.scene.system import System

DECK, PACKING = "in.lammps", "packing.data"


@dataclass(frozen=True, kw_only=True)
class TimedLammps:
    """LAMMPS with one of its pair styles."""

    name: str
    style: Literal["hooke", "granular"]
    slow: bool = False
    note: str

    def probe(self) -> Probe:
        """See the engine."""
        return LAMMPS.probe()

    def refusal(self, system: System) -> str:
        """As the engine judges; the older style has the linear laws only."""
        missing = refused(LAMMPS.supports(system)) or _wall_refusal(system) or ring_refusal(system)
        return missing or (_hooke_refusal(system) if self.style == "hooke" else "")

    def render(self, system: System, *, skin: float) -> dict[str, str]:
        """Return a deck without output and the particles."""
        box = simulation_box(system)
        contacts = contact_lines(system, box)
        lines = [
            *atom_lines(system, box),
            *(contacts if self.style == "granular" else _with_hooke(contacts, system)),
            f"neighbor {number(skin)} {'nsq' if box.is_open else 'bin'}",
            *integration_lines(system),
            *gravity_lines(system.gravity),
            *drag_lines(system.background),
            *_wall_lines(system),
            "",
            "thermo 0",
            "thermo_style custom step atoms",
            "thermo_modify lost error",
        ]
        return {DECK: "\n".join(lines) + "\n", PACKING: packing_data(system, box)}

    def command(self, core: int | None) -> list[str]:
        """Return the child's command."""
        return [sys.executable, "-m", "harness.engines.lammps.bench_child", core_word(core)]

    def environment(self) -> dict[str, str]:
        """One thread."""
        return one_thread_env()


HOOKE = TimedLammps(
    name="lammps hooke", style="hooke",
    note="pair gran/hooke, with friction gran/hooke/history; fix wall/gran granular; torque at the radius; its "
    "dashpots go with the reduced mass, so all particles have one mass",
)
GRANULAR = TimedLammps(name="lammps granular", style="granular", note="pair granular; fix wall/gran granular")


def _hooke_refusal(system: System) -> str:
    if system.materials is not None:
        return "gran/hooke[/history] has one set of numbers for all contacts"
    if not isinstance(system.normal, LinearNormal) or not isinstance(system.sliding, SpringSliding | None):
        return "gran/hooke[/history] has the linear laws only"
    if system.rolling is not None or system.torsion is not None:
        return "gran/hooke[/history] has no rolling and no torsion resistance"
    if np.ptp(system.particles.mass) > 0.0:
        return "gran/hooke[/history] has dashpots in proportion to the reduced mass only"
    return ""


def _wall_refusal(system: System) -> str:
    """The session's walls are planes across an axis that stay, one fix an axis: the least LAMMPS can do for them."""
    across = [w for a in range(system.dimension) for s in (1.0, -1.0) for w in walls_across(system, a, s)[:1]]
    fixed = all(w.motion is None for w in system.walls)
    return "" if len(across) == len(system.walls) and fixed else "only fixed walls across an axis are timed"


def _with_hooke(contacts: list[str], system: System) -> list[str]:
    """Replace the pair style; `contact_lines` keeps the rest."""
    first = contacts.index("pair_style granular")
    return [*contacts[:first], *_hooke_lines(system), *contacts[first + 2 :]]


def _hooke_lines(system: System) -> list[str]:
    """pair_style gran/hooke[/history] Kn Kt gamma_n gamma_t mu dampflag: dashpots m* gamma, N/m for the springs."""
    normal, sliding = system.normal, system.sliding
    reduced_mass = 0.5 * float(system.particles.mass[0])
    gamma_n = normal.normal_damping / reduced_mass
    clipped = " limit_damping" if normal.attraction == "clipped" else ""
    if sliding is None:
        words = f"gran/hooke {numbers((normal.normal_stiffness, 0.0, gamma_n, 0.0, 0.0))} 0"
    else:
        gamma_t = sliding.shear_damping / reduced_mass
        constants = (normal.normal_stiffness, sliding.shear_stiffness, gamma_n, gamma_t, sliding.shear_friction)
        words = f"gran/hooke/history {numbers(constants)} 1"
    return [f"pair_style {words}{clipped}", "pair_coeff * *"]


def _wall_lines(system: System) -> list[str]:
    """Return one fix for both walls across an axis, where they have one law."""
    lines = []
    for axis in range(system.dimension):
        low, high = (walls_across(system, axis, sign) for sign in (1.0, -1.0))
        groups = [low + high] if len({is_rough(system, w) for w in low + high}) == 1 else [low, high]
        for k, walls in enumerate(g for g in groups if g):
            ends = " ".join(number(w[0].point[axis]) if w and w[0] in walls else "NULL" for w in (low, high))
            lines.append(
                f"fix wall_{'xyz'[axis]}{k} grains wall/gran granular {wall_law(system, walls[0])}"
                f" {'xyz'[axis]}plane {ends}"
            )
    return lines
