"""Two unlike pumps on one header: their flows meet at one head, and the weaker may give nothing."""

import casadi as ca
import numpy as np
import pytest
from refusals import refused
from scipy.optimize import brentq
from written_plants import plant_of

from clepsydra.process.header_pump import PumpBeside, seen_curve
from clepsydra.process.pump_curve import PumpCurve
from clepsydra.process.unlike_pumps import LikePumps, flow_of_unlike_pumps

FILE = """
name = "header"
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
range = ["0 %", "100 %"]
nominal = "50 %"
[valves.LV.pump]
curve = [["0 m^3/h", "32 m"], ["10 m^3/h", "30 m"], ["20 m^3/h", "24 m"], ["30 m^3/h", "13 m"]]
static_head = "8.2 m"
minimum_flow = "4 m^3/h"
[valves.LV.pump.beside]
curve = [["0 m^3/h", "25 m"], ["12 m^3/h", "17 m"]]
[sensors.LT1]
tank = "T"
range = ["0 m", "3 m"]
"""
OPEN = 'recirculation = "open line"\nrecirculation_kv = "1 m^3/h"\nminimum_flow'
BESIDE = '[valves.LV.pump.beside]\ncurve = [["0 m^3/h", "25 m"], ["12 m^3/h", "17 m"]]'


def drawn_curve(random):
    """Return a curve of one to four segments [m³/h], [m]."""
    count = int(random.integers(1, 5))
    flows = [0.0, *np.sort(random.uniform(1.0, 30.0, count))]
    heads = np.sort(random.uniform(5.0, 60.0, count + 1))[::-1]
    return PumpCurve(tuple(zip(map(float, flows), map(float, heads), strict=True)))


def given(curve, head):
    """Return what one pump gives at a head: its curve read from there, 0 above where it begins."""
    ends = [(0.0, curve.head(0.0)), *curve.points[1:]]
    if head >= ends[0][1]:
        return 0.0
    return brentq(lambda flow: curve.head(flow) - head, 0.0, 1e4, xtol=1e-13, rtol=1e-14)


@pytest.mark.parametrize("automatic", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_both_give_what_their_curves_have_at_one_head(seed, automatic):
    random = np.random.default_rng(seed)
    bare = [drawn_curve(random) for _ in range(2)]
    least = [random.uniform(0.1, 0.9) * curve.points[-1][0] for curve in bare]
    pumps = [PumpBeside(*each) for each in zip(bare, (1.0, 1.0), least, strict=True)]
    curves = [seen_curve(pump, automatic=automatic) for pump in pumps]
    symbols = [ca.SX.sym(name) for name in ("G", "lift", "N", "M")]
    kinds = (LikePumps(*each) for each in zip(curves, symbols[2:], strict=True))
    flows = flow_of_unlike_pumps(*kinds, *symbols[:2])
    found = ca.Function("found", symbols, [*flows, ca.jacobian(flows[0], symbols[0])])
    seen = set()
    for _ in range(40):
        conductance, lift = 10.0 ** random.uniform(-2, 2), random.uniform(-30.0, 55.0)
        numbers = random.integers(1, 4, 2)

        def taken(head, conductance=conductance, lift=lift):
            return conductance * np.sqrt(max(head - lift, 0.0))

        def excess(head, numbers=numbers, taken=taken):
            each = (given(curve, head) for curve in curves)
            return sum(n * flow for n, flow in zip(numbers, each, strict=True)) - taken(head)

        head = brentq(excess, -1000.0, 70.0, xtol=1e-12, rtol=1e-14)
        told = (conductance, lift, *map(float, numbers))
        into, one, other, slope = (float(each) for each in found(*told))
        # Where less than a millimetre is to spare the flow is laminar.
        if head - lift > 2e-3 or head < lift:
            assert into == pytest.approx(taken(head), rel=1e-9, abs=1e-9)
        assert numbers @ [one, other] == pytest.approx(into, rel=1e-12, abs=1e-12)
        begun = [curve.head(0.0) for curve in curves]
        if min(abs(head - each) for each in begun) > 1e-6 and into > 0.0:
            expected = [given(curve, head) for curve in curves]
            assert [one, other] == pytest.approx(expected, rel=1e-8, abs=1e-8)
            step = 1e-6 * conductance
            ends = [float(found(told[0] + way * step, *told[1:])[0]) for way in (-1, 1)]
            assert slope == pytest.approx((ends[1] - ends[0]) / (2 * step), rel=1e-4, abs=1e-4)
        seen.add((one > 0.0, other > 0.0))
    assert len(seen) > 1


def test_like_pumps_beside_each_other_are_two_of_them(tmp_path):
    curve = FILE[FILE.index("curve") : FILE.index("\nstatic")]
    twice = plant_of(tmp_path, FILE, (BESIDE, f"[valves.LV.pump.beside]\n{curve}"))
    two = plant_of(tmp_path, FILE, (BESIDE, ""), ("static_head", "pumps = 2\nstatic_head"))
    level, same = (each.point.as_dict()["T.level"] for each in (twice, two))
    assert level == pytest.approx(same, rel=1e-12)
    gains, expected = twice.linear.B, two.linear.B
    assert gains == pytest.approx(expected, rel=1e-9)


def test_a_pump_that_the_other_one_shuts_off_is_told(tmp_path):
    shut = plant_of(
        tmp_path, FILE, ('nominal = "50 %"', 'nominal = "10 %"'),
        (BESIDE, BESIDE + '\nminimum_flow = "2 m^3/h"'),
    )  # fmt: skip
    said = " ".join(shut.point.warnings)
    assert "the pump beside that of LV gives 0 m³/h at rest, left of its minimum flow" in said


def test_how_many_run_is_a_parameter_of_each_kind(tmp_path):
    plant = plant_of(tmp_path, FILE, ('nominal = "50 %"', 'nominal = "75 %"'))
    more = plant.with_values({"LV.beside.pumps": 2})
    assert more.point.as_dict()["T.level"] > plant.point.as_dict()["T.level"]


@pytest.mark.parametrize(
    ("edit", "key", "expected"),
    [
        (("minimum_flow", 'recirculation = "automatic"\nminimum_flow'), "beside", "minimum_flow"),
        (("minimum_flow", OPEN), "beside", "no unlike pump"),
        (('"17 m"', '"25 m"'), "beside.curve", "a head that falls"),
        (
            (BESIDE, BESIDE + '\nminimum_flow = "12 m^3/h"'),
            "beside.minimum_flow", "below the end of the curve",
        ),
        ((BESIDE, BESIDE + '\nstatic_head = "8 m"'), "beside.static_head", "one of curve, pumps"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_in_its_place(tmp_path, edit, key, expected):
    with refused(place=f"valves.LV.pump.{key}", expected=expected):
        plant_of(tmp_path, FILE, edit)
