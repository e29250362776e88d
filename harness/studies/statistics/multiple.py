"""Many checks, one false-alarm rate: Holm's step-down procedure.

Of m checks in which nothing differs each raises a false alarm at its level; at 5 % one of twenty would. Holm's
adjusted p-values are compared with one level for all, and the probability of one false alarm or more among all checks
of a report stays below it, however the checks depend on each other::

    p~_(i) = max_{j <= i} min(1, (m - j + 1) p_(j)),   p_(1) <= ... <= p_(m)

S. Holm, "A simple sequentially rejective multiple test procedure", Scand. J. Statist. 6, 65 (1979).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def holm(p_values: Sequence[float]) -> np.ndarray:
    """Return the adjusted p-values (m,) in the order given. Raises ValueError for what is no probability.

    >>> holm([0.01, 0.04, 0.03]).tolist()
    [0.03, 0.06, 0.06]
    """
    p = np.asarray(p_values, dtype=float)
    if not ((p >= 0.0) & (p <= 1.0)).all():
        raise ValueError(f"p-values lie between 0 and 1, got {p}")
    order = np.argsort(p, kind="stable")
    stepped = np.maximum.accumulate(np.minimum(1.0, np.arange(len(p), 0, -1) * p[order]))
    adjusted = np.empty_like(p)
    adjusted[order] = stepped
    return adjusted
