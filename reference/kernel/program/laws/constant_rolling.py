"""couple = mu_r a* f w/|w| with w = a* (omega_i - omega_j) across the normal; LIGGGHTS divides by all of it."""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.constant_rolling import ConstantRolling
from reference.kernel.program.buffers import lined_up
from reference.kernel.program.components import TINY
from reference.kernel.program.laws.setting import Setting


def constant_rolling(law: ConstantRolling, s: Setting) -> None:
    """f: elastic force counted from the strongest pull; in LIGGGHTS that of first loading. No history."""
    p, c, size, work = s.p, s.c, s.c.buffer("size"), s.c.buffer("strength")
    across = s.rotation.across(p, c, c.rolling)
    if law.algorithm == "liggghts":
        force = s.normal.loading(p, work)
        c.tangents.size(p, c.rolling, size)
    else:
        force = s.normal.gripping(p, s.normal.elastic_force, work)
        c.tangents.size(p, across, size)
    p.effect("rolling resistance")
    p(np.maximum, size, TINY, out=size)
    p(np.divide, force, size, out=size)
    p(np.multiply, size, lined_up(law.rolling_friction * c.reduced_radius), out=size)
    p(np.multiply, across, size, out=c.couple)
