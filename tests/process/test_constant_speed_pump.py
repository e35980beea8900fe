"""A pump at constant speed with a control valve in its discharge."""

import math
import re
from itertools import pairwise
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import clepsydra as cl
from clepsydra.process.constant_speed_pump import AUTOMATIC, NONE, OPEN_LINE, ConstantSpeedPump
from clepsydra.process.pump_curve import PumpCurve

HOUR = 3600.0
#: m³/h over m.
POINTS = ((0.0, 32.0), (10.0, 30.0), (20.0, 24.0), (30.0, 13.0))
CURVE = PumpCurve(tuple((flow / HOUR, head) for flow, head in POINTS))
LIFT, MINIMUM = 8.2, 5.0
#: m³/h at 1 bar to m³/h per root of a metre.
PER_ROOT = math.sqrt(9.81 / 100.0)
FILE = """
name = "lifted"
sampling_period = "5 s"
controlled = ["LT1"]
[reservoirs.sump]
[tanks.T]
area = "2 m^2"
height = "3 m"
[orifices.drain]
source = "T"
destination = "sump"
area = "10 cm^2"
[valves.LV]
source = "sump"
destination = "T"
kv = "25 m^3/h"
characteristic = "equal percentage"
rangeability = 50
range = ["0 %", "100 %"]
nominal = "70 %"
[valves.LV.pump]
curve = [["0 m^3/h", "32 m"], ["10 m^3/h", "30 m"], ["20 m^3/h", "24 m"], ["30 m^3/h", "13 m"]]
static_head = "8.2 m"
[sensors.LT1]
tank = "T"
range = ["0 m", "3 m"]
"""


def head(flow):
    """Return the head of one pump [m] at its flow [m³/h], between points as a - b q²."""
    ends = [*pairwise(POINTS)]
    (q1, h1), (q2, h2) = next((each for each in ends if flow <= each[1][0]), ends[-1])
    return h1 - (h1 - h2) * (flow**2 - q1**2) / (q2**2 - q1**2)


def root(value):
    """Return φ as an orifice has it: above 1 mm the root."""
    if value >= 1e-3:
        return math.sqrt(value)
    share = max(value, 0.0) / 1e-3
    return math.sqrt(1e-3) * (45 * share - 18 * share**3 + 5 * share**5) / 32


def balance(kind, conductance, source_head, pumps, line):
    """Return flows of valve and pump [m³/h] by a search for the balance of the header."""

    def lifted(flow):
        return head(max(flow, MINIMUM)) if kind == AUTOMATIC else head(flow)

    def excess(flow):
        back = line * math.sqrt(max(lifted(flow), 0.0)) if kind == OPEN_LINE else 0.0
        return conductance * throttled(lifted(flow) - LIFT + source_head) + back - pumps * flow

    # With a line back the flow has a slope wherever it begins, and needs no laminar law.
    throttled = (lambda spare: math.sqrt(max(spare, 0.0))) if kind == OPEN_LINE else root
    flow = 0.0 if excess(0.0) <= 0.0 else brentq(excess, 0.0, 300.0, xtol=1e-13, rtol=1e-14)
    into = conductance * throttled(lifted(flow) - LIFT + source_head)
    return into, max(flow, MINIMUM) if kind == AUTOMATIC else flow


@pytest.mark.parametrize("kind", [NONE, AUTOMATIC, OPEN_LINE])
def test_the_flow_is_where_curve_lift_and_losses_meet(kind):
    pump = ConstantSpeedPump(
        CURVE, LIFT, recirculation=kind, minimum_flow=MINIMUM / HOUR,
        recirculation_kv=1.0 if kind == OPEN_LINE else 0.0, name="LV",
    )  # fmt: skip
    given = [ca.SX.sym(name) for name in ("G", "head", "N", "kv")]
    symbols = {
        "LV.static_head": LIFT, "LV.pumps": given[2], "LV.recirculation_kv": given[3],
        "gravity": 9.81,
    }  # fmt: skip
    into, (flow,) = pump.flow(*given[:2], symbols), pump.pump_flows(*given[:2], symbols)
    found = ca.Function("found", given, [into, flow, ca.jacobian(into, given[0])])
    random = np.random.default_rng(3)
    for _ in range(400):
        conductance, line = 10.0 ** random.uniform(-2, 1.3), 10.0 ** random.uniform(-1, 0.5)
        level, pumps = random.uniform(-30.0, 25.0), int(random.integers(1, 4))
        told = (conductance / HOUR, level, pumps, line / PER_ROOT / HOUR)
        expected = balance(kind, conductance, level, pumps, line)
        got = [float(each) * HOUR for each in found(*told)[:2]]
        assert got == pytest.approx(expected, rel=1e-10, abs=1e-9)
        # Its slope is that of the flow: central differences know six digits of it.
        step = 1e-6 * told[0]
        ends = [float(found(told[0] + way * step, *told[1:])[0]) for way in (-1, 1)]
        slope = (ends[1] - ends[0]) / (2 * step)
        assert float(found(*told)[2]) == pytest.approx(slope, rel=1e-5, abs=1e-5)


@pytest.fixture
def plant(tmp_path):
    def of(*changes):
        text = FILE
        for before, after in changes:
            assert before in text
            text = text.replace(before, after)
        path = tmp_path / "lifted.toml"
        path.write_text(text, encoding="utf-8")
        return cl.load(path)

    return of


def test_the_gain_is_less_than_behind_a_fixed_pressure(plant):
    """At 15 m³/h: ln 50 · 15 m³/h a stroke at a fixed pressure, times 19.3/23.8 with the pump."""
    behind = plant().at(outputs={"LT1": (15.0 / HOUR / 1e-3) ** 2 / (2 * 9.81)})
    gain = behind.linear.B[0, 0] * 2.0 * HOUR
    assert gain == pytest.approx(math.log(50.0) * 15.0 * 19.3 / 23.8, rel=1e-6)
    # The opening at which 19.3 m drive 15 m³/h through a Kv of 25.
    share = 15.0 / (25.0 * PER_ROOT * math.sqrt(19.3))
    assert behind.point.as_dict()["LV"] == pytest.approx(1 + math.log(share) / math.log(50.0))


def test_a_run_agrees_with_a_second_solver(plant):
    """Two pumps on the header, one of which the valve opens to more than it can give."""
    tank = plant(("static_head", "pumps = 2\nstatic_head"), ("10 cm^2", "20 cm^2"))
    run = cl.simulate(tank, None, [cl.step("LV", "25 %", at="1 min")], duration="20 min")

    def rate(time, level, opening):
        conductance = 25.0 * PER_ROOT * 50.0 ** (opening - 1.0)
        into, _ = balance(NONE, conductance, 0.0, 2, 0.0)
        return into / HOUR / 2.0 - 20e-4 / 2.0 * root(level[0]) * math.sqrt(2 * 9.81)

    start = tank.point.as_dict()["T.level"]
    stepped = solve_ivp(
        rate, (0.0, 1135.0), [start], args=(0.95,), rtol=1e-11, atol=1e-12,
        t_eval=[0.0, 300.0, 1135.0],
    )  # fmt: skip
    level = run.values["T.level"]
    assert [float(level[12 + place]) for place in (0, 60, 227)] == pytest.approx(
        stepped.y[0], abs=3e-6
    )


def test_rest_that_a_pump_does_not_bear_is_told(plant):
    said = plant(("static_head", 'minimum_flow = "15 m^3/h"\nstatic_head')).point.warnings
    assert "left of its minimum flow of 15 m³/h" in said[0]
    said = plant(("static_head", 'npsh_required = "9 m"\nnpsh_available = "1 m"\nstatic_head'))
    assert "needs an NPSH of" in said.point.warnings[0]
    assert "it cavitates" in said.point.warnings[0]
    wide = plant(('kv = "25', 'kv = "400'), ('"8.2 m"', '"0.2 m"'), ('"10 cm^2"', '"30 cm^2"'))
    assert "beyond the end of its curve at 30 m³/h" in "".join(wide.point.warnings)


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ('"8.2 m"', '"33 m"', r"static_head: got '33 m', expected a height below the head at no"),
        ('"8.2 m"', '"130 ft"', r"static_head: got '130 ft', .* the head at no flow, 104\.987 ft"),
        ('"24 m"', '"30 m"', "curve: .* a head that falls from point to point"),
        ('static_head = "8.2 m"', "", r"static_head: got no static_head, expected a height"),
        ("static_head", 'recirculation = "automatic"\nstatic_head', "minimum_flow beside it"),
        ("static_head", 'recirculation = "open line"\nstatic_head', "a recirculation_kv with"),
        ("static_head", 'recirculation_kv = "2 m^3/h"\nstatic_head', "a recirculation_kv with"),
        ("static_head", 'minimum_flow = "31 m^3/h"\nstatic_head', "below the end of the curve"),
        ("static_head", "pumps = 0\nstatic_head", "pumps: got 0, expected a number of pumps"),
        ("kv =", 'elevation = "2 m"\nkv =', "elevation: .* no such key beside a pump"),
        (
            "static_head",
            "speed = 1\nstatic_head",
            "speed: got .*expected one of curve, static_head",
        ),
    ],
)
def test_what_is_wrong_is_told_in_its_place(plant, before, after, words):
    with pytest.raises(cl.InputError, match=words) as refused:
        plant((before, after))
    assert "lifted.toml, line" in str(refused.value)


def test_the_example_of_its_page_is_a_plant(tmp_path):
    page = Path(cl.__file__).parents[2] / "docs" / "elements" / "pumped-valve.md"
    example, _ = re.findall(r"```toml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    rest = FILE[: FILE.index("[valves")] + FILE[FILE.index("[sensors") :]
    for before, after in (
        ("sump", "basin"), ('"T"', '"tank_1"'), ("tanks.T]", "tanks.tank_1]"),
        ("10 cm^2", "18 cm^2"),
    ):  # fmt: skip
        rest = rest.replace(before, after)
    path = tmp_path / "plant.toml"
    path.write_text(rest + example, encoding="utf-8")
    plant = cl.load(path)
    assert plant.point.warnings == ()
    assert plant.point.as_dict()["LV101"] == 0.6
