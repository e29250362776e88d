"""CPU time by phase, from clocks of the processor and of the wall."""

from types import SimpleNamespace

import pytest

from harness.runs.phases import cpu_parts


@pytest.mark.parametrize(("timings", "cpu", "wall", "parts"), [
    ({"setup": 0.2, "run": 7.0, "output": 0.5, "read": 9.0}, 8.0, 20.0, {"setup": 0.2, "run": 7.0, "output": 0.5}),
    ({"setup": 1.0, "run": 18.0, "output": 1.0, "write": 9.0}, 8.0, 20.5, {"setup": 0.4, "run": 7.2, "output": 0.4}),
    ({"setup": 2.0, "run": 18.0, "output": 3.0, "forces": 9.0}, 10.0, 20.0, {"setup": 1.0, "run": 7.5, "output": 1.5}),
    ({"run": 20.0}, 8.0, 20.0, {"run": 8.0}),
])
def test_cpu_time_is_shared_out_by_the_engines_own_clock(timings, cpu, wall, parts):
    """Clocks of the processor, of the wall, of the wall with the output inside the run; and nothing but a run."""
    outcome = SimpleNamespace(timings=timings, cpu_seconds=cpu, wall_seconds=wall)
    assert cpu_parts(outcome) == pytest.approx(parts)
