"""Shared by the tests of closed forms: integration to an event at full accuracy."""

import pytest
from scipy.integrate import solve_ivp


@pytest.fixture
def integrate_until():
    """Integrate y' = rates(t, y) to where `event` changes sign; returns time and state, or None if it never does."""

    def run(rates, start, event, *, span, direction=0, rtol=1e-12, atol=1e-14):
        def stop(t, y):
            return event(t, y)

        stop.terminal, stop.direction = True, direction
        result = solve_ivp(rates, (0, span), start, method="DOP853", rtol=rtol, atol=atol, events=stop)
        assert result.success
        return None if result.t_events[0].size == 0 else (result.t_events[0][0], result.y_events[0][0])

    return run
