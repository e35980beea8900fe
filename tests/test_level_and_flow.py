"""The feed tank of docs/examples under two loops set by hand, computed by SciPy alone.

A dh/dt = P u + d − q with q = Kv x √(ρ g h / 1 bar) through a valve of opening x, and the sensor of
the outflow lags: T dy/dt = q − y. Both PI loops go on once a second.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import clepsydra as cl

FILE = Path(__file__).parents[1] / "docs" / "examples" / "level-and-flow.toml"
AREA, PUMP, LAG, PERIOD = 1.0, 2e-3, 1.0, 1.0  # [m²], [m³/s] at full speed, [s], [s]
LEVEL, FLOW, LOAD = 1.0, 0.8e-3, 1e-4  # [m], [m³/s], [m³/s]
#: Level by pump and outflow by valve: span [m] and [m³/s], gain [%/%], integral time [s].
SPANS, GAIN, TIME = np.array([2.0, 2e-3]), np.array([8.0, 0.3]), np.array([900.0, 3.0])


def outflow(level, opening):
    return 16.0 / 3600.0 * opening * np.sqrt(1000.0 * 9.81 * level / 1e5)


@pytest.fixture(scope="module")
def by_hand():
    """Return level, outflow as measured, pump and valve at every sample of a quarter of an hour."""

    def rates(time, state, pump, opening, load):
        out = outflow(state[0], opening)
        return (PUMP * pump + load - out) / AREA, (out - state[1]) / LAG

    state = np.array([LEVEL, FLOW])
    integral = np.array([FLOW / PUMP, FLOW / outflow(LEVEL, 1.0)])
    kept = []
    for k in range(900):
        setpoint = np.array([LEVEL + 0.1 * (k >= 30), FLOW + 2e-4 * (k >= 300)])
        error = (setpoint - state) / SPANS
        moved = GAIN * error + integral
        assert np.all((moved > 0.0) & (moved < 1.0))  # no limit, so that no anti-windup acts
        integral = integral + GAIN * PERIOD / TIME * error
        kept.append([*state, *moved])
        acting = (*moved, LOAD * (k >= 600))
        state = solve_ivp(
            rates, (0.0, PERIOD), state, args=acting, method="DOP853", rtol=1e-9, atol=1e-12
        ).y[:, -1]
    return np.array(kept).T


@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_the_loops_set_by_hand_move_level_and_flow_as_computed(by_hand, solver):
    plant = cl.load(FILE)
    loops = cl.design.simc(plant).with_values(
        {"level": {"K": "8 %/%", "Ti": "15 min"}, "flow_out": {"K": "0.3 %/%", "Ti": "3 s"}}
    )
    events = [cl.step("level", "10 cm", at="30 s"), cl.step("flow_out", "0.2 l/s", at="5 min"),
              cl.disturbance("inflow", "0.1 l/s", at="10 min")]  # fmt: skip
    run = cl.simulate(plant, loops, events, duration="15 min", solver=solver)
    level, flow, pump, valve = by_hand
    for name, expected, span in (
        ("tank.level", level, SPANS[0]),
        ("flow_out", flow, SPANS[1]),
        ("feed_pump", pump, 1.0),
        ("outlet_valve", valve, 1.0),
    ):
        assert np.abs(run.values[name] - expected).max() < 1e-8 * span, name
    # The flow is there within a minute, while the level, which both disturb, takes its time.
    assert flow[360] == pytest.approx(1e-3, rel=5e-3) and np.ptp(valve) > 0.1
    assert level.max() > LEVEL + 0.1 and np.abs(level[60] - level[360]) > 0.02
