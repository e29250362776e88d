"""Law words of a deck and their classes. A new law is one file and one line here."""

from __future__ import annotations

import numpy as np

from reference.kernel.conventions import Convention
from reference.kernel.laws.by_pair import with_tables
from reference.kernel.laws.constant_rolling import ConstantRolling
from reference.kernel.laws.dmt import DmtNormal
from reference.kernel.laws.hertz import HertzNormal
from reference.kernel.laws.hysteretic import HystereticNormal
from reference.kernel.laws.hysteretic_variable import VariableHystereticNormal
from reference.kernel.laws.law import Law, NormalLaw
from reference.kernel.laws.linear import LinearNormal
from reference.kernel.laws.mindlin import MindlinSliding
from reference.kernel.laws.rolling import SpringRolling
from reference.kernel.laws.sliding import SpringSliding
from reference.kernel.laws.torsion import SpringTorsion
from reference.kernel.laws.viscous import ViscousSliding

LAWS: dict[str, dict[str, type[Law]]] = {
    "normal": {
        "linear": LinearNormal,
        "hertz": HertzNormal,
        "hysteretic": HystereticNormal,
        "hysteretic_variable": VariableHystereticNormal,
        "dmt": DmtNormal,
    },
    "sliding": {"spring": SpringSliding, "mindlin": MindlinSliding, "viscous": ViscousSliding},
    "rolling": {"spring": SpringRolling, "constant": ConstantRolling},
    "torsion": {"spring": SpringTorsion},
}


def build_law(
    family: str, table: dict, convention: Convention, normal: NormalLaw | None = None, kind: np.ndarray | None = None
) -> Law:
    """Return the law that `table` names, with the convention's choices.

    A law that leans on the normal law (field `normal`: Mindlin's stiffness is Hertz's) is given it. kind: the number of
    each node's material, (nodes,), where the numbers of the table are tables over pairs of materials.
    Raises ValueError for a law that the kernel does not have, or not with tables.
    """
    parameters = dict(table)
    word = parameters.pop("law")
    if word not in LAWS[family]:
        raise ValueError(f"{family}: expected one of {', '.join(LAWS[family])}, got the law '{word}'")
    law = LAWS[family][word]
    parameters |= {field: getattr(convention, choice) for field, choice in law.choices.items()}
    if "normal" in law.__dataclass_fields__:
        parameters["normal"] = normal
    if kind is not None:
        return with_tables(law, kind, parameters)
    return law(**parameters)
