"""Control valves: flow coefficient, characteristics, actuator, play and stiction."""

import math
import random
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import brentq
from written_plants import plant_of

import clepsydra as cl
from clepsydra.base.units import from_si
from clepsydra.process.elements.control_valve import ControlValve
from clepsydra.process.elements.reservoir import Reservoir
from clepsydra.process.elements.tank import Tank
from clepsydra.process.friction import Backlash, Stiction
from clepsydra.process.reader import load_process
from clepsydra.process.suction import Suction
from clepsydra.process.valve_characteristic import CHARACTERISTICS, opened
from clepsydra.process.vessels.prism import Prism

PLANT = (Path(__file__).parent / "plant.toml").read_text(encoding="utf-8")
KV = 10 / 3600
VESSEL = Prism(4.0, area=1.0)


def tank(name: str, area: float = 1.0, height: float = 4.0) -> Tank:
    return Tank(name, vessel=Prism(height, area=area))


def supplied(**keys: object) -> ControlValve:
    """Return a valve from a reservoir under 1 bar, moved by a pure number."""
    given: dict = {"kv": KV, "low": 0.0, "high": 1.0, "nominal": 0.5, "pressure": 1e5}
    return ControlValve("valve_1", "main", "tank_1", **{**given, **keys})


def flow(valve: ControlValve, signal: float, **levels: float) -> float:
    """Return the flow of a valve without actuator and friction."""
    symbols = {s.name: ca.SX(s.initial) for s in (*valve.parameters(), *valve.memories())}
    symbols |= {f"{name}.level": ca.SX(level) for name, level in levels.items()}
    symbols |= {"valve_1": ca.SX(signal), "gravity": ca.SX(9.81)}
    (caused,) = valve.flows(symbols, ())
    return float(caused.rate)


@pytest.mark.parametrize("characteristic", CHARACTERISTICS)
def test_kv_is_the_flow_at_one_bar(characteristic: str) -> None:
    """Open and at 1 bar it is Kv, at 4 bar twice as much, whatever gravity is."""
    assert flow(supplied(characteristic=characteristic), 1.0) == pytest.approx(KV, rel=1e-14)
    fourfold = supplied(characteristic=characteristic, pressure=4e5)
    assert flow(fourfold, 1.0) == pytest.approx(2 * KV, rel=1e-14)


def test_the_level_drives_the_flow() -> None:
    """Δp = ρ g (h + z) and q = Kv s √(Δp / 1 bar · 1000/ρ): the same for any density."""
    valve = ControlValve(
        "valve_1",
        "tank_1",
        "basin",
        KV,
        0.004,
        0.02,
        None,
        "A",
        elevation=0.7,
        source_vessel=VESSEL,
    )
    for density in (700.0, 1000.0, 1300.0):
        pressure = density * 9.81 * (1.9 + 0.7)
        expected = KV * 0.25 * math.sqrt(pressure / 1e5 * 1000 / density)
        assert flow(valve, 0.008, tank_1=1.9) == pytest.approx(expected, rel=1e-13)
    outlet_above_floor = ControlValve(
        "valve_1", "tank_1", "basin", KV, 0.0, 1.0, None, elevation=-0.5, source_vessel=VESSEL
    )
    assert outlet_above_floor.memories() == ()
    assert flow(outlet_above_floor, 1.0, tank_1=0.49) == 0.0
    assert flow(outlet_above_floor, 1.0, tank_1=0.75) == pytest.approx(
        KV * math.sqrt(9.81 * 0.25 / 100), rel=1e-13
    )


def test_equal_percentage() -> None:
    valve = supplied(characteristic="equal percentage", rangeability=30.0)
    flows = [flow(valve, share) for share in np.linspace(0, 1, 11)]
    # Ten equal increments multiply alike, and together by the rangeability.
    ratios = np.array(flows[1:]) / np.array(flows[:-1])
    assert np.allclose(ratios, 30.0**0.1, rtol=1e-13, atol=0)
    assert flows[0] == pytest.approx(KV / 30.0, rel=1e-13)


def test_quick_opening_has_a_finite_slope() -> None:
    s = ca.SX.sym("s")
    share = ca.Function("share", [s], [opened("quick opening", s)])
    for opening in (0.01, 0.09, 0.25, 1.0):
        assert float(share(opening)) == pytest.approx(math.sqrt(opening), rel=1e-14)
    assert float(share(0.0)) == 0.0
    assert float(share.jacobian()(1e-12, 0.0)) == pytest.approx(45 / 32 / 0.1, rel=1e-9)


@pytest.mark.parametrize("characteristic", CHARACTERISTICS)
def test_installed_characteristic(characteristic: str) -> None:
    """The pressure divides between valve and line so that the same flow runs through both."""
    line, pressure = 0.6 * KV, 2.5
    valve = supplied(characteristic=characteristic, line_kv=line, pressure=pressure * 1e5)
    inherent = {
        "linear": lambda s: s,
        "equal percentage": lambda s: 50 ** (s - 1),
        "quick opening": math.sqrt,
    }[characteristic]
    for opening in (0.1, 0.4, 0.7, 1.0):
        kv = KV * inherent(opening)

        def missing(flow: float, kv: float = kv) -> float:
            return (flow / kv) ** 2 + (flow / line) ** 2 - pressure

        expected = brentq(missing, 0.0, 10 * KV, xtol=1e-18, rtol=1e-14)
        assert flow(valve, opening) == pytest.approx(expected, rel=1e-12)


def test_signals_beyond_the_range_meet_the_stops() -> None:
    assert flow(supplied(), -0.1) == 0.0
    assert flow(supplied(), 1.2) == flow(supplied(), 1.0)


def test_submerged_valve_flows_both_ways(simulate: Callable) -> None:
    valve = ControlValve("valve_1", "tank_1", "tank_2", KV, 0.0, 1.0, 0.5, submerged=True)
    there, back = flow(valve, 0.5, tank_1=2.0, tank_2=1.0), flow(valve, 0.5, tank_1=1.0, tank_2=2.0)
    assert there == -back == pytest.approx(KV * 0.5 * math.sqrt(9.81 / 100), rel=1e-13)
    assert flow(valve, 0.5, tank_1=1.3, tank_2=1.3) == 0.0
    # Two equal tanks: d√Δ/dt = -q₁ / A, straight down to the laminar end.
    elements = [Reservoir("basin"), tank("tank_1", 0.1), tank("tank_2", 0.1), valve]
    course = simulate(elements, {"tank_1.level": 1.0, "tank_2.level": 0.36}, [1.0], 1.0, 500)
    difference = course["tank_1.level"] - course["tank_2.level"]
    expected = 0.8 - KV * math.sqrt(9.81 / 100) / 0.1 * course.time
    # Far from the end, where an integrator of order four needs steps as short as the rest.
    early = expected > 0.4
    assert np.sum(early) > 8
    assert np.allclose(np.sqrt(difference[early]), expected[early], rtol=0, atol=1e-6)
    assert np.allclose(course["tank_1.level"] + course["tank_2.level"], 1.36, rtol=0, atol=1e-14)
    assert abs(difference[-1]) < 1e-6


def test_a_submerged_valve_without_liquid_still_lets_it_back() -> None:
    valve = ControlValve("valve_1", "tank_1", "tank_2", KV, 0.0, 1.0, 0.5, submerged=True,
                         elevation=0.5, source_vessel=VESSEL,
                         suction=Suction("tank_1", VESSEL))  # fmt: skip
    symbols = {"valve_1": ca.SX(1), "valve_1.kv": ca.SX(KV), "gravity": ca.SX(9.81),
               "valve_1.draws": ca.SX(0), "tank_1.level": ca.SX(0)}  # fmt: skip

    def rate(level: float) -> float:
        return float(valve.flows({**symbols, "tank_2.level": ca.SX(level)}, ())[0].rate)

    assert rate(0.2) == 0.0
    assert rate(0.9) == pytest.approx(-KV * math.sqrt(9.81 * 0.4 / 100), rel=1e-13)


def test_nothing_is_drawn_from_an_empty_tank(simulate: Callable) -> None:
    """√(h + z) falls in a straight line; with a hundredth of the tank left the flow breaks off."""
    valve = ControlValve("valve_1", "tank_1", "basin", KV, 0.0, 1.0, 1.0, elevation=1.0,
                         source_vessel=VESSEL, suction=Suction("tank_1", VESSEL))  # fmt: skip
    course = simulate([Reservoir("basin"), tank("tank_1"), valve], {"tank_1.level": 0.44}, [1.0],
                      15.0, 60)  # fmt: skip
    assert course.count["valve_1.runs_dry"] == 1
    empty = 2 * (1.2 - math.sqrt(1.04)) / (KV * math.sqrt(9.81 / 100))
    assert course.last["valve_1.runs_dry"] == pytest.approx(empty, rel=1e-6)
    assert course["tank_1.level"][-1] == pytest.approx(0.04, abs=1e-8)


def test_stroke_time(simulate: Callable) -> None:
    """From shut to open at constant speed; the last per cent decays with T/100."""
    valve = supplied(low=0.004, high=0.02, unit="A", stroke_time=8.0)
    course = simulate(
        [Reservoir("main"), tank("tank_1"), valve],
        {"tank_1.level": 0.0, "valve_1.position": 0.0}, [0.02], 0.01, 1000,
    )  # fmt: skip
    time, position = course.time, course["valve_1.position"]
    expected = np.where(time < 7.92, time / 8, 1 - 0.01 * np.exp(-(time - 7.92) / 0.08))
    assert np.allclose(position, expected, rtol=0, atol=1e-7)
    # What has run in by the middle of a linear stroke: ∫ Kv t/T dt.
    assert course["tank_1.level"][400] == pytest.approx(KV * 4.0**2 / 16, rel=1e-9)


@pytest.mark.parametrize("stroke", [0.0, 8.0])
def test_lag(simulate: Callable, stroke: float) -> None:
    """A first-order lag, from the moment on at which it is slower than the stroke."""
    constant = 2.0
    valve = supplied(stroke_time=stroke, lag=constant)
    course = simulate(
        [Reservoir("main"), tank("tank_1"), valve],
        {"tank_1.level": 0.0, "valve_1.position": 0.0}, [1.0], 0.01, 1500,
    )  # fmt: skip
    ramp = max(stroke - constant, 0.0)
    left = 1.0 - ramp / stroke if stroke else 1.0
    falling = 1.0 - left * np.exp(-(course.time - ramp) / constant)
    expected = np.where(course.time < ramp, course.time / (stroke or 1.0), falling)
    assert np.allclose(course["valve_1.position"], expected, rtol=0, atol=1e-9)


def test_backlash_loop(simulate: Callable) -> None:
    """The stem of a sinus against the play operator, and the width of the loop it runs through."""
    width = 0.06
    valve = supplied(friction=Backlash(width))

    def signal(time: float) -> list[float]:
        return [0.5 + 0.3 * math.sin(2 * math.pi * time / 40)]

    course = simulate(
        [Reservoir("main"), tank("tank_1", 100.0), valve], {"tank_1.level": 0.0}, signal, 0.1, 1200
    )
    asked = np.array([signal(t)[0] for t in course.time[:-1]])
    stem = course["valve_1.stem"][1:]
    expected = [asked[0]]
    for value in asked[1:]:
        gap = value - expected[-1]
        expected.append(expected[-1] + math.copysign(max(abs(gap) - width / 2, 0), gap))
    assert np.allclose(stem, expected, rtol=0, atol=1e-14)
    late = course.time[:-1] > 40
    rising = np.gradient(asked) > 0
    middle = late & (np.abs(asked - 0.5) < 0.1)
    assert np.allclose((asked - stem)[middle & rising], width / 2, rtol=0, atol=1e-14)
    assert np.allclose((asked - stem)[middle & ~rising], -width / 2, rtol=0, atol=1e-14)


def test_backlash_within_a_step(simulate: Callable) -> None:
    """The flow follows the stem inside the steps: opened and shut again, by hand."""
    width = 0.1
    valve = supplied(stroke_time=10.0, friction=Backlash(width))
    course = simulate(
        [Reservoir("main"), tank("tank_1"), valve],
        {"tank_1.level": 0.0, "valve_1.position": 0.2}, [1.0], 0.25, 16,
    )  # fmt: skip
    # The stem begins where the actuator is, without play to cross in the first step, and then
    # keeps half the play behind: 0.2 + (t - 0.5 s) / 10 s.
    assert course["valve_1.stem"][-1] == pytest.approx(0.2 + 0.4 - width / 2, abs=1e-12)


def he(signal: np.ndarray, band: float, jump: float) -> list[float]:
    """The published recursion: a cumulated force, static and dynamic friction."""
    static, dynamic = (band + jump) / 2, (band - jump) / 2
    stem, force = [signal[0]], 0.0
    for before, value in pairwise(signal):
        force += value - before
        if abs(force) > static:
            sign = math.copysign(1.0, force)
            stem.append(stem[-1] + force - sign * dynamic)
            force = sign * dynamic
        else:
            stem.append(stem[-1])
    return stem


def test_stiction_is_the_published_recursion(simulate: Callable) -> None:
    """Without a stroke time every sample is a way to a new standstill."""
    generator = random.Random(5)
    walk = [0.5]
    while len(walk) < 400:
        walk.append(min(max(walk[-1] + generator.uniform(-0.06, 0.06), 0.1), 0.9))
    valve = supplied(friction=Stiction(0.08, 0.03))
    course = simulate(
        [Reservoir("main"), tank("tank_1", 100.0), valve], {"tank_1.level": 0.0},
        lambda time: [walk[round(time)]], 1.0, len(walk),
    )  # fmt: skip
    stem = course["valve_1.stem"][1:]
    assert np.allclose(stem, he(np.array(walk), 0.08, 0.03), rtol=0, atol=1e-12)
    moves = np.count_nonzero(np.diff(stem))
    broken = course.count["valve_1.breaks_away_up"] + course.count["valve_1.breaks_away_down"]
    assert 50 < moves == broken == course.count["valve_1.sticks"]


def test_stiction_on_a_stroke(simulate: Callable) -> None:
    """A slow stroke up, then down: hold, jump by J, follow, and stick again for a way of S."""
    band, jump, stroke, step = 0.10, 0.04, 20.0, 0.1
    valve = supplied(stroke_time=stroke, friction=Stiction(band, jump))
    course = simulate(
        [Reservoir("main"), tank("tank_1"), valve],
        {"tank_1.level": 0.0, "valve_1.position": 0.3},
        lambda time: [0.3] if time < 1.0 else [0.7] if time < 10.95 else [0.2], step, 200,
    )  # fmt: skip
    time = course.time
    static, kinetic = (band + jump) / 2, (band - jump) / 2
    # Up: breaks away when the actuator has moved by the static friction.
    breaks = 1.0 + static * stroke
    # Down: turns within a per cent of the stroke; the stem needs the whole band.
    position = course["valve_1.position"]
    turned = position[np.searchsorted(time, 11.0)]
    assert turned == pytest.approx(0.7, abs=1e-5)
    stem = np.where(
        time < breaks,
        0.3,
        np.where(time <= 11.0, position - kinetic,
                 np.where(position > turned - band, turned - kinetic, position + kinetic)),
    )  # fmt: skip
    moving = course["valve_1.moves"]
    seen = np.where(moving != 0, position - moving * kinetic, course["valve_1.stem"])
    down = 11.0 + stroke * band
    near_corner = (np.abs(time - breaks) < step) | (np.abs(time - down) < step)
    # At the very beginning no stem is remembered yet.
    compared = ~near_corner & (time > 0)
    assert np.allclose(seen[compared], stem[compared], rtol=0, atol=2e-4)
    assert course.last["valve_1.breaks_away_up"] == pytest.approx(breaks, abs=1e-6)
    assert course.last["valve_1.breaks_away_down"] == pytest.approx(down, abs=stroke * 2e-4)
    assert (course.count["valve_1.breaks_away_up"], course.count["valve_1.breaks_away_down"]) == (
        1, 1,
    )  # fmt: skip


INTEGRATING = """
name = "integrating"
sampling_period = "1 s"
controlled = ["level"]
manipulated = ["valve_1"]
[reservoirs.main]
[tanks.tank_1]
area = "0.2 m^2"
height = "4 m"
[valves.valve_1]
source = "main"
destination = "tank_1"
kv = "10 m^3/h"
pressure = "1 bar"
range = ["0 %", "100 %"]
{friction}
[flows.drain]
source = "tank_1"
range = ["0 m^3/h", "10 m^3/h"]
nominal = "4 m^3/h"
[sensors.level]
tank = "tank_1"
range = ["0 m", "4 m"]
[operating_point]
level = "1 m"
"""


@pytest.mark.parametrize(
    "friction",
    [pytest.param("", marks=pytest.mark.thorough), 'stiction = "6 %"\nslip_jump = "3 %"'],
)
def test_limit_cycle(tmp_path: Path, friction: str) -> None:
    """PI control of an integrating level comes to rest, but cycles for ever with stiction."""
    plant = plant_of(tmp_path, INTEGRATING.format(friction=friction))
    controller = cl.design.simc(plant).with_values({"level": {"K": "12 %/%", "Ti": "80 s"}})
    more = [cl.disturbance("drain", to="5 m^3/h", at="1 s")]
    run = cl.simulate(plant, controller, more, duration="5000 s")
    late = run.values["tank_1.level"][-2000:]
    if not friction:
        assert np.ptp(late) < 1e-6
        return
    stem = run.values["valve_1.stem"][-2000:]
    # It never stands at the one opening that balances the drain, but jumps across it.
    assert np.ptp(stem) >= 0.03
    assert np.min(stem) < 0.5 < np.max(stem)
    crossings = np.count_nonzero(np.diff(np.sign(late - np.mean(late))))
    assert crossings >= 12
    earlier = run.values["tank_1.level"][-4000:-2000]
    assert np.ptp(late) == pytest.approx(np.ptp(earlier), rel=0.1)


@pytest.mark.parametrize("friction", ['backlash = "4 %"', 'stiction = "4 %"\nslip_jump = "1 %"'])
def test_linear_model_has_the_gain_of_the_valve(tmp_path: Path, friction: str) -> None:
    """A slow change takes the stem along: play and stiction are not in a linear model."""
    table = (
        '[valves.valve_1]\nsource = "tank_2"\ndestination = "tank_1"\nkv = "200 l/h"\n'
        'range = ["0 %", "100 %"]\nnominal = "50 %"\n'
    )
    slopes = []
    for text in (table, f"{table}{friction}\n"):
        process = plant_of(tmp_path, f"{PLANT}\n{text}").process
        u = ca.SX.sym("u", 2)
        rate = process.dynamics([0.1, 0.1], u, [0.0], process.parameter_values)
        slopes.append(np.asarray(ca.Function("slope", [u], [ca.jacobian(rate, u)])([3.0, 0.5])))
    head = math.sqrt(9.81 * 0.1 / 100)
    assert slopes[0][1, 1] == pytest.approx(-0.2 / 3600 * head / 32e-4, rel=1e-12)
    assert np.array_equal(slopes[0], slopes[1])


def test_all_keys_of_a_file(tmp_path: Path) -> None:
    path = tmp_path / "plant.toml"
    path.write_text(
        PLANT
        + """
[valves.valve_1]
source = "basin"
destination = "tank_1"
kv = "1.2 m^3/h"
characteristic = "equal percentage"
rangeability = 40
range = ["4 mA", "20 mA"]
nominal = "12 mA"
pressure = "0.5 bar"
elevation = "2 m"
line_kv = "3 m^3/h"
stroke_time = "0.5 min"
stiction = "5 %"
slip_jump = "2 %"
""",
        encoding="utf-8",
    )
    process = load_process(path)
    valve = next(element for element in process.elements if isinstance(element, ControlValve))
    assert valve == ControlValve(
        "valve_1", "basin", "tank_1", 1.2 / 3600, 0.004, 0.02, 0.012, "A", "equal percentage",
        rangeability=40.0, elevation=2.0, pressure=5e4, line_kv=3 / 3600, stroke_time=30.0,
        friction=Stiction(0.05, 0.02),
    )  # fmt: skip
    shown = {
        name: (from_si(s.initial, s.unit, s.shown_unit), s.shown_unit)
        for name in ("valve_1", "valve_1.kv", "valve_1.position", "valve_1.stiction")
        for s in (process.signal(name),)
    }
    assert shown == {
        "valve_1": (12.0, "mA"),
        "valve_1.kv": (1.2, "m^3/h"),
        "valve_1.position": (50.0, "%"),
        "valve_1.stiction": (5.0, "%"),
    }
