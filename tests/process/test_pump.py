"""Pumps: curve, affinity laws, actuator, level switches and noise, against closed forms."""

import math
import random
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from written_plants import plant_of

from clepsydra.base.units import from_si
from clepsydra.process.elements.forced_flow import ForcedFlow
from clepsydra.process.elements.pump import Pump
from clepsydra.process.elements.reservoir import Reservoir
from clepsydra.process.elements.tank import Tank
from clepsydra.process.level_switch import LevelLimit, LevelStarter, LevelTrips
from clepsydra.process.process import Process
from clepsydra.process.pump_curve import PumpCurve
from clepsydra.process.suction import Suction
from clepsydra.process.vessels.prism import Prism

PLANT = (Path(__file__).parent / "plant.toml").read_text(encoding="utf-8")
POINTS = ((0.0, 30.0), (5e-3, 27.0), (10e-3, 18.0), (12e-3, 9.0))
INTAKE = Suction("tank_1", Prism(1.0, area=0.01))
CURVE = PumpCurve(POINTS)


def plant(tmp_path: Path, *edits: tuple[str, str]) -> Process:
    return plant_of(tmp_path, PLANT, *edits).process


def tank(name: str, area: float = 0.01, height: float = 1.0) -> Tank:
    return Tank(name, vessel=Prism(height, area=area))


def head(flow: float) -> float:
    """Return the head at full speed, linear in the square of the flow between the points."""
    return float(np.interp(flow**2, [q**2 for q, _ in POINTS], [h for _, h in POINTS]))


def test_curve_runs_through_its_points() -> None:
    for flow, lift in POINTS[1:]:
        assert float(CURVE.flow(ca.SX(1), lift, 0.0)) == pytest.approx(flow, rel=1e-12)


def test_operating_point_is_where_curve_and_pipe_meet() -> None:
    generator = random.Random(11)
    segments = set()
    for _ in range(300):
        speed = generator.uniform(0.6, 1.0)
        static = generator.uniform(0.0, 0.99 * speed**2 * 30.0)
        loss = generator.uniform(1e4, 3e5)

        def spare(
            flow: float, speed: float = speed, static: float = static, loss: float = loss
        ) -> float:
            return speed**2 * head(flow / speed) - static - loss * flow**2

        # Within the curve; what lies beyond its last point is another test.
        if spare(speed * POINTS[-1][0]) > 0:
            continue
        expected = brentq(spare, 0.0, speed * POINTS[-1][0], xtol=1e-16)
        flow = float(CURVE.flow(ca.SX(speed), static, loss))
        if expected > 0.01 * POINTS[-1][0]:
            assert flow == pytest.approx(expected, rel=1e-9)
            segments.add(sum(expected > speed * q for q, _ in POINTS))
    assert segments == {1, 2, 3}


def test_beyond_the_last_point_the_last_segment_goes_on() -> None:
    (q1, h1), (q2, h2) = POINTS[-2:]
    slope = (h1 - h2) / (q2**2 - q1**2)
    expected = math.sqrt((h2 + slope * q2**2 - 2.0) / slope)
    assert expected > q2
    assert float(CURVE.flow(ca.SX(1), 2.0, 0.0)) == pytest.approx(expected, rel=1e-12)


def test_affinity_laws() -> None:
    """At speed n a flow n q meets the head n² H; the loss of a pipe follows the same law."""
    generator = random.Random(12)
    for _ in range(100):
        speed, lift = generator.uniform(0.2, 1.0), generator.uniform(5.0, 29.9)
        loss = generator.uniform(0.0, 1e5)
        full = float(CURVE.flow(ca.SX(1), lift, loss))
        slow = float(CURVE.flow(ca.SX(speed), speed**2 * lift, loss))
        if slow > 0.01 * POINTS[-1][0]:
            assert slow == pytest.approx(speed * full, rel=1e-11)


def test_flow_is_continuous_and_rises_with_speed() -> None:
    speed = ca.SX.sym("speed")
    flow = ca.Function("flow", [speed], [CURVE.flow(speed, 12.0, 1e4)])
    slope = flow.jacobian()
    # The smallest slope is finite at the speed at which the flow begins.
    start = math.sqrt(12.0 / 30.0)
    speeds = np.linspace(0.0, 1.0, 20001)
    flows = np.asarray(flow(speeds[None, :])).ravel()
    assert np.all(flows[speeds <= start] == 0.0)
    assert np.all(np.diff(flows[speeds > start]) > 0.0)
    # At its steepest: dq/dn = 45/32 / (0.01 q_last) · 2 n a/(b + r), by the law of small flows.
    a, b = 30.0, 3.0 / 5e-3**2
    steepest = 45 / 32 / (0.01 * POINTS[-1][0]) * 2 * start * a / (b + 1e4)
    assert np.max(np.diff(flows)) < 1.01 * steepest * (speeds[1] - speeds[0])
    assert float(slope(start + 1e-9, 0.0)) == pytest.approx(steepest, rel=1e-4)


def test_start_against_a_static_head(simulate: Callable) -> None:
    """With a lag the speed is 1 - exp(-t/T); flow begins at n = √(H_s/H_0), not before."""
    lag, static, shutoff, last, area = 4.0, 12.0, 30.0, 10e-3, 2.0
    slope = (shutoff - 18.0) / last**2
    pump = Pump(
        "pump_1", "basin", "tank_1", None, 0.0, 25.0, None, "Hz",
        curve=PumpCurve(((0.0, shutoff), (last, 18.0))), static_head=static, lag=lag,
    )  # fmt: skip
    start = -lag * math.log(1 - math.sqrt(static / shutoff))
    step = 0.05
    course = simulate(
        [Reservoir("basin"), tank("tank_1", area, 3.0), pump],
        {"tank_1.level": 0.0, "pump_1.actual": 0.0}, [25.0], step, 400,
    )  # fmt: skip
    speed = 1 - np.exp(-course.time / lag)
    assert np.allclose(course["pump_1.actual"], 25.0 * speed, rtol=0, atol=1e-7)
    level = course["tank_1.level"]
    assert np.all(level[course.time <= start] == 0.0)
    assert level[np.searchsorted(course.time, start + step)] > 0.0
    volume, _ = quad(
        lambda t: math.sqrt(max((1 - math.exp(-t / lag)) ** 2 * shutoff - static, 0) / slope),
        start, 20.0, epsabs=1e-12,
    )  # fmt: skip
    # The laminar start replaces the root below one per cent of the flow: a few ms of it.
    assert level[-1] * area == pytest.approx(volume, rel=2e-5)


def test_level_of_the_source_helps() -> None:
    pump = Pump(
        "pump_1", "tank_1", "basin", None, 0.0, 1.0, None, "1", curve=CURVE, static_head=12.0,
        suction=Suction("tank_1", Prism(3.0, area=0.01)),
    )  # fmt: skip
    symbols = {
        "pump_1": ca.SX(1), "pump_1.static_head": ca.SX(12.0), "pump_1.pipe_loss": ca.SX(0),
        "tank_1.level": ca.SX(2.5), "pump_1.draws": ca.SX(1),
    }  # fmt: skip
    (flow,) = pump.flows(symbols, ())
    assert head(float(flow.rate)) == pytest.approx(9.5, rel=1e-12)


def test_gain_per_percent_and_dead_band(tmp_path: Path) -> None:
    process = plant(
        tmp_path,
        ('gain = "3.33 cm^3/(s V)"', 'gain = "0.2 cm^3/(s %)"\ndead_band = "15 %"'),
        ('range = ["0 V", "10 V"]\nnominal = "3 V"', 'range = ["0 %", "100 %"]\nnominal = "40 %"'),
    )
    (signal,) = process.inputs
    assert (signal.unit, signal.high, signal.initial, signal.shown_unit) == ("1", 1.0, 0.4, "%")
    gain = process.signal("pump_1.gain")
    assert from_si(gain.initial, gain.unit, gain.shown_unit) == 0.2

    def inflow(signal: float) -> float:
        rate = process.dynamics([0.1, 0.0], [signal], [0.0], process.parameter_values)
        return float(rate[1]) * 32e-4

    assert inflow(0.4) == pytest.approx(0.3 * 0.2e-6 * 25.0, rel=1e-12)
    assert inflow(0.15) == inflow(0.0) == 0.0


@pytest.mark.parametrize(
    ("written", "unit", "low", "high"),
    [
        ('["4 mA", "20 mA"]', "A", 0.004, 0.02),
        ('["0 Hz", "50 Hz"]', "Hz", 0.0, 50.0),
        ('["0 1/min", "1500 1/min"]', "Hz", 0.0, 25.0),
        ("[0, 2]", "1", 0.0, 2.0),
    ],
)
def test_unit_of_the_signal(
    tmp_path: Path, written: str, unit: str, low: float, high: float
) -> None:
    gain = "m^3/s" if unit == "1" else f"m^3/(s {unit})"
    process = plant(
        tmp_path,
        ('gain = "3.33 cm^3/(s V)"', f'gain = "1e-6 {gain}"'),
        ('range = ["0 V", "10 V"]\nnominal = "3 V"', f"range = {written}\nnominal = {low}"
         if unit == "1" else f'range = {written}\nnominal = "{high} {unit}"'),
    )  # fmt: skip
    (signal,) = process.inputs
    assert (signal.unit, signal.low, signal.high) == (unit, low, high)


def test_limited_rate_is_a_ramp(simulate: Callable) -> None:
    """10 V at 0.5 V/s: a straight line until one per cent of the range is left."""
    pump = Pump("pump_1", "basin", "tank_1", 1e-6, 0.0, 10.0, None, rate=0.5)
    course = simulate(
        [Reservoir("basin"), tank("tank_1"), pump],
        {"tank_1.level": 0.0, "pump_1.actual": 0.0}, [10.0], 0.05, 440,
    )  # fmt: skip
    time, actual = course.time, course["pump_1.actual"]
    straight = time <= 19.75
    assert np.allclose(actual[straight], 0.5 * time[straight], rtol=0, atol=1e-12)
    rounded = time >= 19.8
    expected = 10.0 - 0.1 * np.exp(-(time[rounded] - 19.8) / 0.2)
    assert np.allclose(actual[rounded], expected, rtol=0, atol=1e-5)


def test_lag_and_rate_together(simulate: Callable) -> None:
    """The speed is limited while more than rate · lag is missing, then the rest decays."""
    pump = Pump("pump_1", "basin", "tank_1", 1e-6, 0.0, 10.0, None, lag=2.0, rate=1.0)
    course = simulate(
        [Reservoir("basin"), tank("tank_1"), pump],
        {"tank_1.level": 0.0, "pump_1.actual": 0.0}, [8.0], 0.02, 700,
    )  # fmt: skip
    time = course.time
    expected = np.where(time < 6.0, time, 8.0 - 2.0 * np.exp(-(time - 6.0) / 2.0))
    assert np.allclose(course["pump_1.actual"], expected, rtol=0, atol=1e-6)


def test_trip_and_release(simulate: Callable) -> None:
    """A tank that is filled with 3 cm³/s and drained with 1 cm³/s: all moments by hand."""
    limit, hysteresis, area = 0.3, 0.05, 0.01
    trips = LevelTrips((LevelLimit("tank_1", limit, above=True, unit="cm"),), hysteresis)
    elements = [
        Reservoir("basin"),
        tank("tank_1", area),
        Pump("pump_1", "basin", "tank_1", 1e-6, 0.0, 10.0, 3.0, trips=trips),
        ForcedFlow(
            "outflow",
            "tank_1",
            "",
            0.0,
            1e-5,
            1e-6,
            suction=INTAKE,
        ),
    ]
    filling, draining = 2e-6 / area, 1e-6 / area
    trip = (limit - 0.2) / filling
    release = trip + hysteresis / draining
    course = simulate(elements, {"tank_1.level": 0.2}, [3.0], 7.0, 190, [1e-6])
    assert course.time[-1] < release + hysteresis / filling + hysteresis / draining
    assert course.count["pump_1.trips_tank_1_above"] == 2
    assert course.count["pump_1.is_released"] == 1
    assert course.last["pump_1.is_released"] == pytest.approx(release, abs=1e-6)
    again = release + hysteresis / filling
    assert course.last["pump_1.trips_tank_1_above"] == pytest.approx(again, abs=1e-6)
    assert np.max(course["tank_1.level"]) <= limit + 1e-12
    tripped = (course.time > trip) & (course.time < release) | (course.time > again)
    assert np.array_equal(course["pump_1.tripped"] > 0.5, tripped)


def test_off_while_any_level_is_beyond(simulate: Callable) -> None:
    trips = LevelTrips(
        (LevelLimit("tank_1", 0.6, above=True), LevelLimit("tank_2", 0.2, above=False)), 0.1
    )
    elements = [
        Reservoir("basin"),
        tank("tank_1"),
        tank("tank_2"),
        Pump("pump_1", "basin", "tank_1", 1e-6, 0.0, 10.0, 3.0, trips=trips),
        ForcedFlow(
            "drain_1",
            "tank_1",
            "",
            0.0,
            1e-4,
            1e-5,
            suction=INTAKE,
        ),
        ForcedFlow("feed_2", "", "tank_2", 0.0, 1e-4, 1e-5),
    ]
    # Both levels are beyond at first; 1 mm/s each: tank 1 is back at 0.5 after 200 s,
    # tank 2 at 0.3 after 250 s.
    course = simulate(
        elements, {"tank_1.level": 0.7, "tank_2.level": 0.05}, [0.0], 10.0, 30, [1e-5, 1e-5]
    )
    assert course.count["pump_1.is_released"] == 1
    assert course.last["pump_1.is_released"] == pytest.approx(250.0, abs=1e-6)
    assert trips.events("pump_1", {
        "pump_1.tripped": ca.SX(0), "tank_1.level": ca.SX(0), "tank_2.level": ca.SX(0)
    })[-1].words == "pump_1 is released: tank_1 below 0.5 m and tank_2 above 0.3 m"  # fmt: skip


def test_a_tripped_pump_runs_down_with_its_lag(simulate: Callable) -> None:
    trips = LevelTrips((LevelLimit("tank_1", 0.3, above=True),), 0.01)
    pump = Pump("pump_1", "basin", "tank_1", 1e-6, 0.0, 10.0, 4.0, lag=5.0, trips=trips)
    course = simulate(
        [Reservoir("basin"), tank("tank_1"), pump],
        {"tank_1.level": 0.31, "pump_1.actual": 4.0}, [4.0], 0.1, 200,
    )  # fmt: skip
    decay = np.exp(-course.time / 5.0)
    assert np.allclose(course["pump_1.actual"], 4.0 * decay, rtol=0, atol=1e-8)
    risen = 1e-6 * 4.0 * 5.0 * (1 - decay[-1]) / 0.01
    assert course["tank_1.level"][-1] == pytest.approx(0.31 + risen, rel=1e-9)


def test_wet_well(simulate: Callable) -> None:
    """Runs from 1.2 m down to 0.4 m: a cycle is the time to fill and the time to empty."""
    starter = LevelStarter(
        LevelLimit("well", 1.2, above=True), LevelLimit("well", 0.4, above=False), running=False
    )
    area, entering, pumped = 2.0, 0.01, 0.05
    elements = [
        Reservoir("river"),
        tank("well", area, 2.0),
        Pump("pump_1", "well", "river", 0.05, 0.0, 1.0, 1.0, "1", starter=starter,
             suction=Suction("well", Prism(2.0, area=0.01))),
        ForcedFlow("sewer", "", "well", 0.0, 0.1, entering),
    ]  # fmt: skip
    fill, empty = 0.8 * area / entering, 0.8 * area / (pumped - entering)
    first = (1.2 - 0.7) * area / entering
    course = simulate(elements, {"well.level": 0.7}, [1.0], 3.0, 320, [entering])
    assert course.count["pump_1.starts"] == 5
    assert course.last["pump_1.starts"] == pytest.approx(first + 4 * (fill + empty), abs=1e-6)
    assert course.last["pump_1.stops"] == pytest.approx(first + 4 * fill + 5 * empty, abs=1e-6)
    assert np.ptp(course["well.level"]) <= 0.8 + 1e-12


def test_nothing_is_drawn_from_an_empty_tank(simulate: Callable) -> None:
    pump = Pump(
        "pump_1",
        "tank_1",
        "tank_2",
        1e-6,
        0.0,
        10.0,
        5.0,
        suction=INTAKE,
    )
    course = simulate(
        [Reservoir("basin"), tank("tank_1"), tank("tank_2"), pump],
        {"tank_1.level": 0.05, "tank_2.level": 0.1}, [5.0], 7.0, 40,
    )  # fmt: skip
    assert course.count["pump_1.runs_dry"] == 1
    # Suction is lost when a hundredth of the tank is left.
    assert course.last["pump_1.runs_dry"] == pytest.approx(80.0, abs=1e-6)
    assert course["tank_1.level"][-1] == pytest.approx(0.01, abs=1e-12)
    total = course["tank_1.level"] + course["tank_2.level"]
    assert np.allclose(total, 0.15, rtol=0, atol=1e-15)


def test_noise_is_relative_to_the_flow() -> None:
    pump = Pump("pump_1", "basin", "tank_1", 2e-6, 0.0, 10.0, 5.0, noise=0.1)
    (signal,) = pump.disturbances()
    assert (signal.name, signal.initial, signal.unit) == ("pump_1.noise", 0.0, "1")
    assert pump.noises() == {"pump_1.noise": 0.1}

    def flow(noise: float) -> float:
        symbols = {"pump_1": 5.0, "pump_1.gain": 2e-6, "pump_1.noise": ca.SX(noise)}
        (flow,) = pump.flows(symbols, ())
        return float(flow.rate)

    assert flow(0.0) == pytest.approx(1e-5, rel=1e-15)
    assert flow(0.25) == pytest.approx(1.25e-5, rel=1e-15)
    assert flow(-1.5) == 0.0
    quiet = Pump("pump_1", "basin", "tank_1", 2e-6, 0.0, 10.0, 5.0)
    assert (quiet.disturbances(), quiet.noises()) == ((), {})


def test_all_keys_of_a_file(tmp_path: Path) -> None:
    """A dry-run trip names the tank that the pump draws from, which is no circle."""
    process = plant(
        tmp_path,
        ('source = "basin"\n', 'source = "tank_1"\n'),
        ('destination = "valve"', 'destination = "tank_2"'),
        ("[splitters.valve]\nfractions = { tank_1 = 0.7, tank_2 = \"30 %\" }\n", ""),
        ('gain = "3.33 cm^3/(s V)"\nrange = ["0 V", "10 V"]\nnominal = "3 V"',
         'curve = [["0 l/s", "3 m"], ["5 ml/s", "2.7 m"], ["10 ml/s", "1.8 m"]]\n'
         'static_head = "120 cm"\npipe_loss = "1000 s^2/m^5"\n'
         'range = ["0 1/min", "1500 1/min"]\nnominal = "1300 1/min"\nlag = "2 s"\n'
         'rate = "600 1/(min s)"\ntrip_above = { tank_2 = "19 cm" }\n'
         'trip_below = { tank_1 = "2 cm" }\nhysteresis = "5 mm"\nnoise = "3 %"\n'
         'start_above = { tank_1 = "15 cm" }\nstop_below = { tank_1 = "30 mm" }\nrunning = false'),
    )  # fmt: skip
    pump = next(element for element in process.elements if isinstance(element, Pump))
    assert pump == Pump(
        "pump_1", "tank_1", "tank_2", None, 0.0, 25.0, 1300 / 60, "Hz",
        curve=PumpCurve(((0.0, 3.0), (5e-6, 2.7), (10e-6, 1.8))), static_head=1.2,
        pipe_loss=1000.0, lag=2.0, rate=10.0,
        trips=LevelTrips(
            (LevelLimit("tank_2", 0.19, above=True, unit="cm"),
             LevelLimit("tank_1", 0.02, above=False, unit="cm")), 0.005,
        ),
        starter=LevelStarter(
            LevelLimit("tank_1", 0.15, above=True, unit="cm"),
            LevelLimit("tank_1", 0.03, above=False, unit="mm"), running=False,
        ),
        noise=0.03, suction=Suction("tank_1", Prism(0.2, area=28e-4)),
    )  # fmt: skip
    actual = process.signal("pump_1.actual")
    assert from_si(actual.initial, actual.unit, actual.shown_unit) == 1300.0
    assert [event.words for event in process.motion.events if "trips" in event.name] == [
        "pump_1 trips: tank_2 above 19 cm", "pump_1 trips: tank_1 below 2 cm",
    ]  # fmt: skip
    assert dict(process.noise) == {"pump_1.noise": 0.03}
