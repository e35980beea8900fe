"""The joined equations against the same equations written by hand, and the balance of mass."""

import math
import random

import casadi as ca
import numpy as np
import pytest

from clepsydra import Element, Signal
from clepsydra.process.elements.flow_splitter import FlowSplitter
from clepsydra.process.elements.forced_flow import ForcedFlow
from clepsydra.process.elements.orifice import Orifice
from clepsydra.process.elements.pump import Pump
from clepsydra.process.elements.reservoir import Reservoir
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.elements.tank import Tank
from clepsydra.process.equations import join
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.process.vessels.prism import Prism

GRAVITY = Signal("gravity", "m/s^2", initial=9.81)

#: Johansson's table I and section II in centimetres: k1, k2, gamma 1, gamma 2.
JOHANSSON = {
    "quadruple-tank": (3.33, 3.35, 0.70, 0.60),
    "quadruple-tank-nonminimum-phase": (3.14, 3.29, 0.43, 0.34),
}


def root(level: float, laminar: float) -> float:
    """√h; below δ the polynomial √δ s (45 - 18 s² + 5 s⁴)/32 in s = h/δ; 0 below the floor."""
    if level >= laminar:
        return math.sqrt(level)
    share = max(level, 0.0) / laminar
    return math.sqrt(laminar) * (45 * share - 18 * share**3 + 5 * share**5) / 32


def johansson(
    h: list[float], v: list[float], d: list[float], constants: tuple[float, ...]
) -> list[float]:
    """Equation (1) of the paper, with the two disturbance flows, in cm, s and V; films laminar."""
    k1, k2, gamma1, gamma2 = constants
    g = 981.0
    a1, a2, a3, a4 = 0.071, 0.057, 0.071, 0.057
    area1, area2, area3, area4 = 28.0, 32.0, 28.0, 32.0
    holes = zip((a1, a2, a3, a4), h, strict=True)
    out = [a * math.sqrt(2 * g) * root(level, 0.1) for a, level in holes]
    return [
        -out[0] / area1 + out[2] / area1 + gamma1 * k1 / area1 * v[0] + d[0] / area1,
        -out[1] / area2 + out[3] / area2 + gamma2 * k2 / area2 * v[1] + d[1] / area2,
        -out[2] / area3 + (1 - gamma2) * k2 / area3 * v[1],
        -out[3] / area4 + (1 - gamma1) * k1 / area4 * v[0],
    ]


@pytest.mark.parametrize("name", sorted(JOHANSSON))
def test_catalogue_is_johansson(name: str) -> None:
    process = load_process(name)
    generator = random.Random(2000)
    for _ in range(500):
        h = [generator.choice((20.0, 0.2)) * generator.uniform(-0.1, 1.0) for _ in range(4)]
        v = [generator.uniform(0.0, 10.0) for _ in range(2)]
        d = [generator.uniform(0.0, 5.0) for _ in range(2)]
        rate = process.dynamics(
            [level / 100 for level in h], v, [flow * 1e-6 for flow in d], process.parameter_values
        )
        expected = [value / 100 for value in johansson(h, v, d, JOHANSSON[name])]
        # A difference of flows cancels: rounding is measured against the largest flow.
        assert np.allclose(np.asarray(rate).ravel(), expected, rtol=0.0, atol=1e-17)
        measured = process.measure([level / 100 for level in h], process.parameter_values)
        assert np.allclose(np.asarray(measured).ravel(), [0.5 * level for level in h], rtol=1e-15)


def plant_with_everything() -> tuple[Element, ...]:
    """Three tanks, a cascade of splitters, an integrating tank, two outlets of one tank."""
    return (
        Reservoir("basin"),
        Reservoir("drain"),
        Tank("upper", vessel=Prism(0.5, area=0.01)),
        Tank("lower", vessel=Prism(0.4, area=0.02)),
        Tank("store", vessel=Prism(1.0, area=0.03)),
        Orifice("weep", "upper", "drain", 2e-6, 0.6),
        Orifice("fall", "upper", "second", 1e-5, 0.8),
        Orifice("drip", "lower", "drain", 9e-6),
        Pump("lift", "basin", "first", 4e-6, 0.0, 10.0, 5.0),
        # The one that feeds stands after the one that is fed: order must not matter.
        FlowSplitter("second", {"lower": 0.25, "store": 0.75}),
        FlowSplitter("first", {"upper": 0.5, "second": 0.3, "drain": 0.2}),
        ForcedFlow("rain", "", "second", 0.0, 1e-5, 0.0, 1e-6),
        Sensor("shown", "upper", 0.0, 0.5),
    )


def test_mass_balance_of_any_plant() -> None:
    """Σ A dh/dt = what comes in − what reaches a reservoir, for any values of the parameters."""
    joined = join(plant_with_everything(), GRAVITY)
    generator = random.Random(7)
    for _ in range(300):
        p = {s.name: s.initial * generator.uniform(0.5, 1.5) for s in joined.parameters}
        p["first.upper"], p["first.second"] = generator.uniform(0, 0.6), generator.uniform(0, 0.4)
        deepest = generator.choice((1.0, 0.01))
        h = {s.name: deepest * generator.uniform(-0.1, s.high) for s in joined.state}
        v, rain = generator.uniform(0, 10), generator.uniform(0, 1e-5)
        rate = np.asarray(
            joined.dynamics(list(h.values()), [v], [rain], [p[s.name] for s in joined.parameters])
        ).ravel()

        def torricelli(hole: str, tank: str, p: dict = p, h: dict = h) -> float:
            speed = math.sqrt(2 * p["gravity"]) * root(h[f"{tank}.level"], 1e-3)
            return p[f"{hole}.discharge"] * p[f"{hole}.area"] * speed

        pumped = p["lift.gain"] * v
        drained = (
            torricelli("weep", "upper")
            + torricelli("drip", "lower")
            + (1 - p["first.upper"] - p["first.second"]) * pumped
        )
        stored = sum(
            p[f"{tank}.area"] * value
            for tank, value in zip(("upper", "lower", "store"), rate, strict=True)
        )
        assert stored == pytest.approx(pumped + rain - drained, rel=0, abs=1e-18)
        to_store = (1 - p["second.lower"]) * (
            torricelli("fall", "upper") + rain + p["first.second"] * pumped
        )
        assert rate[2] * p["store.area"] == pytest.approx(to_store, rel=1e-12)


def test_no_outflow_at_or_below_the_floor() -> None:
    elements = (
        Reservoir("basin"),
        Tank("tank", vessel=Prism(0.5, area=0.01)),
        Orifice("hole", "tank", "basin", 1e-5),
    )
    joined = join(elements, GRAVITY)
    values = [signal.initial for signal in joined.parameters]
    for level in (0.0, -1e-3):
        assert float(joined.dynamics([level], [], [], values)) == 0.0
    assert float(joined.dynamics([1e-3], [], [], values)) < 0.0


def test_cost_of_a_step() -> None:
    """All that depends on parameters only can leave the time loop, and leaves no division there.

    What is left is one product and one sum for each flow into or out of a tank, and one root law
    for each outlet, counted from its formula: √max(h, δ); the polynomial h (a + h² (b + h² c)) of
    max(h, 0), whose coefficients are numbers, with three products, a square and two sums; and the
    choice between the two, which CasADi writes c·a + (not c)·b.
    """
    process = load_process("quadruple-tank")
    function = process.dynamics
    varying: dict[int, bool] = {}
    left: dict[int, int] = {}
    for k in range(function.n_instructions()):
        code = function.instruction_id(k)
        outputs, inputs = function.instruction_output(k), function.instruction_input(k)
        if code == ca.OP_OUTPUT:
            continue
        if code == ca.OP_INPUT:
            varying[outputs[0]] = inputs[0] != 3
        else:
            varying[outputs[0]] = code != ca.OP_CONST and any(varying[i] for i in inputs)
            if varying[outputs[0]]:
                left[code] = left.get(code, 0) + 1
    root_law = {
        ca.OP_SQRT: 1,
        ca.OP_FMAX: 2,
        ca.OP_MUL: 3,
        ca.OP_SQ: 1,
        ca.OP_ADD: 2 + 1,
        ca.OP_LT: 1,
        ca.OP_NOT: 1,
        ca.OP_IF_ELSE_ZERO: 2,
    }
    expected = {code: 4 * count for code, count in root_law.items()}
    # Flows: 2 of inflows, 4 of pumps, 4 out of tanks, 2 into lower tanks; the first flow into
    # each tank begins its sum.
    expected[ca.OP_MUL] += 12
    expected[ca.OP_ADD] += 2 + 4 + 2 - 4
    expected[ca.OP_SUB] = 4
    assert left == expected


def test_parameters_are_symbolic(johanssons: Process) -> None:
    """A parameter that is changed in the vector changes the rate as the equation says."""
    p = johanssons.parameter_values
    names = [signal.name for signal in johanssons.parameters]
    h, v, d = [0.12, 0.12, 0.02, 0.02], [3.0, 3.0], [0.0, 0.0]
    base = np.asarray(johanssons.dynamics(h, v, d, p)).ravel()
    p[names.index("splitter_1.tank_1")] = 0.8
    moved = np.asarray(johanssons.dynamics(h, v, d, p)).ravel() - base
    assert moved[0] * 28e-4 == pytest.approx(0.1 * 3.33e-6 * 3.0, rel=1e-12)
    assert moved[3] * 32e-4 == pytest.approx(-0.1 * 3.33e-6 * 3.0, rel=1e-12)
    assert moved[1] == moved[2] == 0.0
    sensitivity = johanssons.dynamics.jacobian()
    assert sensitivity.size_in(3) == (len(names), 1)


@pytest.fixture(scope="module")
def johanssons() -> Process:
    return load_process("quadruple-tank")


def test_unit_of_a_sensor_without_gain() -> None:
    joined = join(plant_with_everything(), GRAVITY)
    (shown,) = joined.measurements
    assert (shown.unit, shown.high) == ("m", 0.5)
    values = [signal.initial for signal in joined.parameters]
    assert float(joined.measure([0.31, 0.1, 0.1], values)) == 0.31
    assert joined.measured_state == {"shown": "upper.level"}
