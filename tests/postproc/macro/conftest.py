"""One quantity of a state, by name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from postproc.averaging.registry import make_cells
from postproc.fields import IN_CELLS, Subject
from postproc.results import Unavailable
from postproc.snapshot import MissingColumn, Snapshot


@pytest.fixture(scope="session")
def measure() -> Callable[..., np.ndarray]:
    """Return measure(state, name, cells="box", frame=None, **settings) -> (K, ...); MissingColumn with the reason."""

    def measured(state: Snapshot, name: str, cells: str = "box", frame: str | None = None, **settings) -> np.ndarray:
        field = next(field for field in IN_CELLS if field.name == name)
        result = field.evaluate(Subject(cells=make_cells(cells, state, frame=frame), **settings))
        if isinstance(result, Unavailable):
            raise MissingColumn(result.reason)
        return result.values

    return measured
