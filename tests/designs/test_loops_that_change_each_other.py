"""Loops of a level and a flow: each is designed with the other closed, as by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import cont2discrete
from written_plants import plant_of

import clepsydra as cl
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.loops.pairing import paired_loops
from clepsydra.designs.models.held_element import held_element

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "level-and-flow.toml"
RIGHT = [("level", "feed_pump"), ("flow_out", "outlet_valve")]
#: 1 m² at 1 m and 0.8 l/s, the pump of 2 l/s, a sensor of flow that lags by 1 s, sampled every 1 s.
AREA, LEVEL, FLOW, PUMP, LAG, PERIOD = 1.0, 1.0, 0.8e-3, 2e-3, 1.0, 1.0
SPANS = np.array([2.0, 2e-3])  # level [m] and flow [m³/s]
#: The opening at which Kv = 16 m³/h passes 0.8 l/s under 1 m of water, and the flow per opening.
OPENING = FLOW * 3600.0 / (16.0 * np.sqrt(1000.0 * 9.81 * LEVEL / 1e5))
VALVE = FLOW / OPENING


@pytest.fixture(scope="module")
def tank():
    return cl.load(EXAMPLE)


def peak_by_hand(level: tuple[float, float], flow: tuple[float, float]) -> float:
    """Return max σ(S) of two sampled PI loops, K [%/%] and Ti [s], on the tank's own equations.

    A dh/dt = P u - q with q = f(v) √h, so ∂q/∂h = q/2h; an integral moves in the next sample.
    """
    slope = FLOW / (2.0 * LEVEL)
    A = np.array([[-slope / AREA, 0.0], [slope / LAG, -1.0 / LAG]])
    B = np.array([[PUMP / AREA, -VALVE / AREA], [0.0, VALVE / LAG]])
    shown = (A, B, np.diag(1.0 / SPANS), np.zeros((2, 2)))
    a, b, c, _, _ = cont2discrete(shown, PERIOD)
    z = np.exp(1j * PERIOD * np.geomspace(1e-5, np.pi, 5001))
    plant = c @ np.linalg.solve(z[:, None, None] * np.eye(2) - a, b.astype(complex))
    gains = np.zeros_like(plant)
    for place, (gain, time) in enumerate((level, flow)):
        gains[:, place, place] = gain * (1.0 + PERIOD / (time * (z - 1.0)))
    return float(np.linalg.norm(np.linalg.inv(np.eye(2) + plant @ gains), 2, axis=(1, 2)).max())


def test_hand_loops_bear_each_other(tank):
    by_hand = {"level": {"K": "8 %/%", "Ti": "15 min"}, "flow_out": {"K": "0.3 %/%", "Ti": "3 s"}}
    loops = cl.design.simc(tank).with_values(by_hand)
    found = cl.margins(loops, tank)["max|S|"].max()
    peak = peak_by_hand((8.0, 900.0), (0.3, 3.0))
    assert peak == pytest.approx(1.09, abs=5e-3)
    assert found == pytest.approx(peak, rel=1e-3)


def test_elements_with_the_other_loop_closed(tank):
    """With the outflow held the level integrates; with the level held the valve is at once."""
    level, flow = paired_loops(tank.analysis.model, None)
    assert (level.others, flow.others) == ((RIGHT[1],), (RIGHT[0],))
    assert level.element.integrators == 1 and not level.element.poles
    assert level.element.gain == pytest.approx(PUMP / AREA, rel=1e-9)
    assert flow.element.integrators == 0
    assert flow.element.poles == pytest.approx([-1.0 / LAG])
    assert flow.element.gain == pytest.approx(VALVE, rel=1e-9)
    # Alone the valve changes the outflow for a while only.
    assert flow.alone.integrators == -1


def test_simc_by_hand(tank):
    """Skogestad's rules on P/(A s) and VALVE/(s + 1), half a sample of delay, steps of a tenth.

    The pump has 0.4 of room, so K = 0.4/0.1; τc = 1/(slope K) - θ and Ti = 4 (τc + θ). The valve
    has 0.425 of room, so that τc = θ and K = T/(gain · 2θ).
    """
    loops = cl.design.simc(tank)
    slope = PUMP / AREA / SPANS[0]
    values = loops.values
    assert values["level.proportional_gain"] * SPANS[0] == pytest.approx(4.0, rel=1e-3)
    assert values["level.integral_time"] == pytest.approx(4.0 / (slope * 4.0), rel=1e-3)
    gain = LAG / (VALVE / SPANS[1] * PERIOD)
    assert values["flow_out.proportional_gain"] * SPANS[1] == pytest.approx(gain, rel=1e-3)
    assert values["flow_out.integral_time"] == pytest.approx(LAG, rel=1e-3)
    found = cl.margins(loops, tank)["max|S|"].max()
    assert found == pytest.approx(peak_by_hand((4.0, 1000.0), (gain, LAG)), rel=2e-3)
    assert "flow_out by outlet_valve with level closed" in " ".join(loops.notes)


@pytest.mark.parametrize(
    "name",
    ["amigo", "disturbance_rejection", "fuzzy_pi", "gain_scheduled_pid", "lambda_", "phase_margin",
     "polynomial", "simc", "tyreus_luyben", "variable_structure_pid", "ziegler_nichols"],
)  # fmt: skip
def test_every_design_of_loops_takes_the_right_pairing(tank, name):
    loops = getattr(cl.design, name)(tank)
    assert cl.margins(loops, tank)["max|S|"].max() < 2.1
    assert tuple(loops.manipulated) == ("feed_pump", "outlet_valve")


def test_a_valve_alone_holds_no_outflow(tank):
    with pytest.raises(NotApplicable, match="its static gain is zero"):
        cl.design.simc(tank, pairing=[("flow_out", "outlet_valve")])


def test_the_slow_pairing_is_designed_as_it_was(tank):
    """Loops that are the same alone and together: λ = 1 at rest, so each is taken alone."""
    loops = paired_loops(
        tank.analysis.model, [("level", "outlet_valve"), ("flow_out", "feed_pump")]
    )
    assert all(loop.element == loop.alone for loop in loops)


def test_dead_time_of_the_flow_stays_in_its_loop(tmp_path):
    """A valve 6 s away: its loop has the dead time, the level, by the feed, has none."""
    text = EXAMPLE.read_text(encoding="utf-8")
    plant = plant_of(
        tmp_path,
        text,
        ('destination = "sink"\nkv', 'destination = "pipe"\nkv'),
        ("[flows.inflow]", '[delays.pipe]\ndestination = "sink"\ntime = "6 s"\n[flows.inflow]'),
        ('flow = "outlet_valve"', 'flow = "pipe"'),
    )
    level, flow = paired_loops(plant.analysis.model, RIGHT)
    assert (level.element.dead_time, flow.element.dead_time) == (0.0, 6.0)
    assert flow.element.gain == pytest.approx(VALVE, rel=1e-9)


def test_an_element_with_another_held_is_a_quotient_of_determinants():
    model = cl.load(EXAMPLE).analysis.model
    found = held_element(model, RIGHT[1], (RIGHT[0],))
    alone = held_element(model, RIGHT[0], (RIGHT[1],))
    # g_kk/λ_kk of two loops is det G over the other element, at any s.
    s = 0.37
    G = np.array([[PUMP / AREA, -VALVE / AREA], [0.0, 0.0]]) / (s + FLOW / (2 * LEVEL * AREA))
    G[1] = (np.array([0.0, VALVE]) + FLOW / (2.0 * LEVEL) * G[0]) / (LAG * s + 1.0)
    determinant = np.linalg.det(G)
    assert at(found, s) == pytest.approx(determinant / G[0, 0], rel=1e-9)
    assert at(alone, s) == pytest.approx(determinant / G[1, 1], rel=1e-9)


def at(element, s: float) -> float:
    value = element.gain / s**element.integrators
    value *= np.prod([1.0 - s / zero for zero in element.zeros])
    return float(np.real(value / np.prod([1.0 - s / pole for pole in element.poles])))
