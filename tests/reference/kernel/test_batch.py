"""Replicas side by side move as each does alone."""

import dataclasses

import numpy as np
import pytest

from reference.kernel.batch import batch
from reference.kernel.program.simulation import ProgramSimulation


@pytest.mark.parametrize("dim", [2, 3])
def test_each_replica_moves_as_alone(dem, dim):
    models = [dem.cluster(seed, dim, squeeze=0.97, gn=5.0, mu=0.4, gt=2.0) for seed in range(5)]
    together = batch(models, room=60.0)
    simulation = ProgramSimulation(together.model)
    simulation.advance(300)
    for k, m in enumerate(models):
        alone = ProgramSimulation(m)
        alone.advance(300)
        assert np.abs(together.x(simulation.state, k) - alone.state.x).max() < 1e-10
        assert np.abs(together.v(simulation.state, k) - alone.state.v).max() < 1e-8
        assert np.abs(together.spin(simulation.state, k) - alone.state.spin).max() < 1e-8


def test_what_would_meet_or_differs_is_refused(dem):
    free = dem.cluster(1, 2)
    with pytest.raises(ValueError, match="no walls, no rings and no periodic axes"):
        batch([free, dem.cluster(1, 2, walls=dem.box(9, 2))], room=1.0)
    with pytest.raises(ValueError, match="expected the same normal"):
        batch([free, dataclasses.replace(free, dt=2 * free.dt)], room=1.0)
