"""The operations of every law of the textbook. A new law is one file and one line here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from reference.kernel.laws import by_pair
from reference.kernel.laws.constant_rolling import ConstantRolling
from reference.kernel.laws.dmt import DmtNormal
from reference.kernel.laws.hertz import HertzNormal
from reference.kernel.laws.hysteretic import HystereticNormal
from reference.kernel.laws.hysteretic_variable import VariableHystereticNormal
from reference.kernel.laws.law import Law
from reference.kernel.laws.linear import LinearNormal
from reference.kernel.laws.mindlin import MindlinSliding
from reference.kernel.laws.rolling import SpringRolling
from reference.kernel.laws.sliding import SpringSliding
from reference.kernel.laws.torsion import SpringTorsion
from reference.kernel.laws.viscous import ViscousSliding
from reference.kernel.model import Model
from reference.kernel.program.laws.by_pair import LinearByPair, spring_sliding_by_pair
from reference.kernel.program.laws.constant_rolling import constant_rolling
from reference.kernel.program.laws.dmt import Dmt
from reference.kernel.program.laws.hertz import Hertz
from reference.kernel.program.laws.hysteretic import Hysteretic
from reference.kernel.program.laws.hysteretic_variable import VariableHysteretic
from reference.kernel.program.laws.linear import Linear
from reference.kernel.program.laws.mindlin import mindlin_sliding
from reference.kernel.program.laws.normal import NormalOperations
from reference.kernel.program.laws.rolling import spring_rolling
from reference.kernel.program.laws.setting import Setting
from reference.kernel.program.laws.sliding import spring_sliding
from reference.kernel.program.laws.torsion import spring_torsion
from reference.kernel.program.laws.viscous import viscous_sliding
from reference.kernel.program.slider import lags

NORMAL: dict[type[Law], type[NormalOperations]] = {
    LinearNormal: Linear, HertzNormal: Hertz, HystereticNormal: Hysteretic,
    VariableHystereticNormal: VariableHysteretic, DmtNormal: Dmt, by_pair.LinearByPair: LinearByPair,
}


@dataclass(frozen=True, kw_only=True)
class Tangential:
    """act adds the operations of a law.

    stiffness: the law's field by which the history, a tension, is the textbook's elongation; None: history is what
    the textbook remembers. friction: the field with the coefficient that limits a spring, if the law has one.
    limited: whether the law asks for the base of limits. takes_elastic_force: whether it asks for f_el as well.
    compares_spins: whether it asks if two spins are equal.
    """

    act: Callable[[Law, Setting], None]
    stiffness: str | None = None
    friction: str | None = None
    limited: bool = True
    takes_elastic_force: bool = False
    compares_spins: bool = False

    def unit(self, law: Law) -> float:
        """Return history over the textbook's memory; of laws by pair the least one."""
        return 1.0 if self.stiffness is None else np.min(getattr(law, self.stiffness)).item()

    def lags(self, law: Law) -> bool:
        """Whether springs may lag behind their contact: `program.slider`."""
        turns = getattr(law, "frame", "contact") == "contact"
        return self.friction is not None and lags(law.algorithm, np.max(getattr(law, self.friction)), turns=turns)


TANGENTIAL: dict[str, dict[type[Law], Tangential]] = {
    "sliding": {
        SpringSliding: Tangential(act=spring_sliding, stiffness="shear_stiffness", friction="shear_friction"),
        by_pair.SpringByPair: Tangential(
            act=spring_sliding_by_pair, stiffness="shear_stiffness", friction="shear_friction"),
        MindlinSliding: Tangential(act=mindlin_sliding, friction="shear_friction"),
        ViscousSliding: Tangential(act=viscous_sliding),
    },
    "rolling": {
        SpringRolling: Tangential(act=spring_rolling, stiffness="rolling_stiffness", friction="rolling_friction"),
        ConstantRolling: Tangential(
            act=constant_rolling, limited=False, takes_elastic_force=True, compares_spins=True),
    },
    "torsion": {SpringTorsion: Tangential(act=spring_torsion, stiffness="torsion_stiffness")},
}


def tangential_laws(model: Model) -> dict[str, tuple[Law, Tangential | None]]:
    """Return the laws that a model has besides the normal one, by family, with their operations, None if unknown."""
    made = {family: getattr(model, family) for family in TANGENTIAL}
    return {k: (law, TANGENTIAL[k].get(type(law))) for k, law in made.items() if law is not None}


def has_operations(model: Model) -> bool:
    """Return whether every law of the model has operations.

    Not so: a spring without stiffness, whose elongation the program does not know, and springs in a plane that
    slide as `lammps_twisting` does, whose answer would depend on the axes.
    """
    laws = tangential_laws(model)
    if type(model.normal) not in NORMAL or any(operations is None for _, operations in laws.values()):
        return False
    twisting = {k for k, (law, _) in laws.items() if getattr(law, "algorithm", "") == "lammps_twisting"}
    return all(operations.unit(law) > 0 for law, operations in laws.values()) and twisting <= {"torsion"}
