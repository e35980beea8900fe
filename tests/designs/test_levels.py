"""Lambda and arrest-time tuning of levels, against closed loops in closed form."""

import dataclasses
import math

import numpy as np
import pytest
from refusals import refused
from scipy.linalg import expm

import clepsydra as cl
from clepsydra import InputError, NotApplicable, PidForm
from clepsydra.designs.arrest_time import arrest_settings, arrest_time_for, design_arrest_time
from clepsydra.designs.lambda_tuning import design_lambda, lambda_settings
from clepsydra.designs.loops.averaging_room import averaging_room, load_steps
from clepsydra.designs.models.delayed_lags import DelayedLags
from clepsydra.linear.analysis import analyse
from clepsydra.process.reader import load_process

PAIR = [("level", "pump")]


class Vessel:
    """What makes the states of a model of nothing but matrices levels."""

    name, holds_liquid = "tank_1", True

    def __init__(self, states):
        self.states = lambda: states
        self.load_steps = dict


def of_a_vessel(model):
    process = model.point.process
    held = dataclasses.replace(process, elements=(Vessel(process.state),))
    return dataclasses.replace(model, point=dataclasses.replace(model.point, process=held))


def largest_deviation(slope, time_constant, setting, load_rate):
    """Return when and how far a load step moves y in ẏ = −y/τ + k' u + r, by its exact motion."""
    K, Ti = setting.gain, setting.integral_time
    A = np.array([[-1.0 / time_constant - slope * K, slope], [-K / Ti, 0.0]])
    times = np.linspace(0.0, 6.0 * Ti, 60_001)
    step = expm(np.block([[A, np.array([[load_rate], [0.0]])], [np.zeros((1, 3))]]) * times[1])
    state, path = np.array([0.0, 0.0, 1.0]), []
    for _ in times:
        path.append(state[0])
        state = step @ state
    return times[int(np.argmax(path))], max(path), np.linalg.eigvals(A)


@pytest.mark.parametrize("time_constant", [math.inf, 4000.0, 700.0])
@pytest.mark.parametrize("slope", [0.01, -0.004])
def test_a_load_is_arrested_at_the_time_and_deviation_asked(slope, time_constant):
    model = DelayedLags(slope, time_constant, 0.0)
    deviation, rate = 0.3, 0.001
    arrest = arrest_time_for(model, deviation, rate)
    assert arrest == pytest.approx(math.e * deviation / rate, rel=1e-12)
    setting = arrest_settings(model, arrest)
    assert math.copysign(1.0, setting.gain) == math.copysign(1.0, slope)
    at, peak, poles = largest_deviation(slope, time_constant, setting, rate)
    assert at == pytest.approx(arrest, rel=1e-3)
    assert peak == pytest.approx(deviation, rel=1e-6)
    # Damping 1: a double pole, which an eigenvalue routine finds to half its digits.
    assert poles == pytest.approx([-1.0 / arrest] * 2, rel=1e-6)


def test_the_delay_of_first_order_is_in_the_arrest_time():
    """With e^−θs as 1 − θs: s (s + 1/τ) + k'K (1 − θs)(s + 1/Ti) = c (λ s + 1)²."""
    model = DelayedLags(0.02, 900.0, 30.0)
    deviation, rate = 0.4, 0.002
    arrest = arrest_time_for(model, deviation, rate)
    setting = arrest_settings(model, arrest)
    loop = 0.02 * setting.gain
    closed = np.polyadd(
        [1.0, 1.0 / 900.0, 0.0], loop * np.polymul([-30.0, 1.0], [1.0, 1.0 / setting.integral_time])
    )
    c = loop / setting.integral_time
    assert closed == pytest.approx(c * np.array([arrest**2, 2 * arrest, 1.0]), rel=1e-9)
    assert rate / (c * arrest * math.e) == pytest.approx(deviation, rel=1e-9)


def test_arrest_time_of_an_integrator_is_lambda_tuning():
    model = DelayedLags(0.02, math.inf, 3.0)
    assert arrest_settings(model, 50.0) == pytest.approx(lambda_settings(model, 50.0), rel=1e-13)


def test_too_small_a_room_and_too_fast_a_tank_are_refused():
    with pytest.raises(NotApplicable, match="too short beside a delay of 100 s"):
        arrest_time_for(DelayedLags(0.02, math.inf, 100.0), 0.1, 0.001)
    with pytest.raises(NotApplicable, match=r"does not integrate: it settles by itself .* of 50 s"):
        arrest_settings(DelayedLags(0.02, 50.0, 0.0), 101.0)


def test_lambda_cancels_the_lag_and_is_the_time_constant_of_the_closed_loop():
    model = DelayedLags(-0.05, 40.0, 0.0)
    setting = lambda_settings(model, 25.0)
    # g C = −2/(40 s + 1) · K (1 + 1/(40 s)) = 1/(25 s)
    for s in (0.01j, 1j):
        loop = model.gain / (40 * s + 1) * setting.gain * (1 + 1 / (setting.integral_time * s))
        assert loop == pytest.approx(1 / (25 * s), rel=1e-12)


def test_lambda_of_an_integrator_places_a_double_pole():
    """k'K (1 − θs)(s + 1/Ti) + s² has both roots at −1/λ."""
    model = DelayedLags(0.02, math.inf, 5.0)
    K, Ti, _ = lambda_settings(model, 20.0)
    closed = np.polyadd([1.0, 0.0, 0.0], 0.02 * K * np.polymul([-5.0, 1.0], [1.0, 1.0 / Ti]))
    assert closed / closed[-1] == pytest.approx([400.0, 40.0, 1.0], rel=1e-12)


def test_lambda_of_an_integrating_level_uses_the_room_of_its_input(single_tank):
    values = design_lambda(single_tank([[0.0]], [0.02], [1.0]), PAIR).values
    # 5 V of room for a step of 1 V, if that is slower than three delays of 0.5 s.
    gain, Ti = values["level.proportional_gain"], values["level.integral_time"]
    assert gain == pytest.approx(5.0, rel=1e-9)
    time = (Ti - 0.5) / 2
    assert gain == pytest.approx((2 * time + 0.5) / (0.02 * (time + 0.5) ** 2), rel=1e-9)
    slow = single_tank([[0.0]], [2.0], [1.0], period=6.0)
    Ti = design_lambda(slow, PAIR).values["level.integral_time"]
    assert Ti == pytest.approx(2 * 9.0 + 3.0, rel=1e-9)


def test_lambda_of_a_lag_is_no_faster_than_the_lag(single_tank):
    values = design_lambda(single_tank([[-0.02]], [0.04], [1.0]), PAIR).values
    assert values["level.integral_time"] == pytest.approx(50.0, rel=1e-9)
    assert values["level.proportional_gain"] == pytest.approx(50.0 / (2.0 * 50.5), rel=1e-9)


def test_a_lag_much_longer_than_lambda_is_taken_as_an_integrator(single_tank):
    # 1 V/V per 5000 s and 5 V of room: λ ≈ 2/(k' K) = 40 s with k' = 0.01.
    slow = design_lambda(single_tank([[-0.0002]], [0.01], [1.0]), PAIR)
    pure = design_lambda(single_tank([[0.0]], [0.01], [1.0]), PAIR)
    for name in ("level.proportional_gain", "level.integral_time"):
        assert slow.values[name] == pytest.approx(pure.values[name], rel=1e-9)
    assert "taken as integrating" in slow.notes[0]
    assert "taken as integrating" not in pure.notes[0]
    # With a λ that the lag is not long beside, the lag is cancelled.
    given = design_lambda(
        single_tank([[-0.0002]], [0.01], [1.0]), PAIR, closed_loop_time_constant=1000.0
    )
    assert given.values["level.integral_time"] == pytest.approx(5000.0, rel=1e-9)


# The basin of the catalogue: 1000 m², 5 m deep as 0 to 1, half full, load 0.12 m³/s.


@pytest.fixture(scope="module")
def basin():
    return analyse(load_process("equalisation-tank"))


def test_the_basin_lets_its_load_use_the_room(basin):
    (load,) = load_steps(basin.model, "level")
    assert (load.signal, load.size) == ("inflow", 0.12)
    assert load.rate == pytest.approx(0.12 / 1000.0 / 5.0, rel=1e-9)
    level = basin.operating_point.process.signal("level")
    room = averaging_room(basin.operating_point, level)
    assert room.below == room.above == pytest.approx(0.4, rel=1e-12)
    controller = design_arrest_time(basin.model, basin.pairing)
    # span = e · 0.4/r, λ² + (2θ − span) λ + θ² = 0 with θ half of a minute
    span, delay = math.e * 0.4 / load.rate, 30.0
    arrest = max(np.roots([1.0, 2 * delay - span, delay**2]))
    assert controller.values["level.integral_time"] == pytest.approx(2 * arrest + delay, rel=1e-9)
    # The pump draws: it must run faster when the level rises.
    assert controller.values["level.proportional_gain"] < 0.0
    assert "a load step of inflow by 0.12 m^3/s" in controller.notes[0]


def test_half_the_deviation_is_half_the_arrest_time(basin):
    times = [
        design_arrest_time(basin.model, basin.pairing, deviation=d).values["level.integral_time"]
        for d in (0.4, 0.2)
    ]
    # Up to the delay of half a minute in hours.
    assert times[0] / times[1] == pytest.approx(2.0, rel=2e-3)


def test_a_given_arrest_time_is_used(basin):
    values = design_arrest_time(basin.model, basin.pairing, arrest_time=3600.0).values
    assert values["level.integral_time"] == pytest.approx(7230.0, rel=1e-9)


def test_switches_of_pumps_limit_the_room():
    point = analyse(load_process("wet-well")).operating_point
    level = point.process.signal("level")
    # 1.5 m in 4 m: the running duty pump stops at 0.5 m, the standby starts at 2.5 m: 1 m each.
    share = averaging_room(point, level).above / level.span
    assert share == pytest.approx(1.0 / 4.0 - 0.1, rel=1e-9)


def test_what_is_no_level_or_has_no_load_is_not_applicable(single_tank):
    with pytest.raises(NotApplicable, match="names no load step that moves level"):
        design_arrest_time(of_a_vessel(single_tank([[0.0]], [0.02], [1.0])), PAIR)
    tank = analyse(load_process("averaging-tank"))
    pairs = [pair for pair in tank.pairing if pair[0] == "concentration"]
    with pytest.raises(NotApplicable, match="concentration is no level"):
        design_arrest_time(tank.model, pairs)


def test_a_self_regulating_level_is_refused_with_its_time_constant(single_tank):
    model = of_a_vessel(single_tank([[-0.1]], [0.02], [1.0]))
    with pytest.raises(NotApplicable, match="settles by itself with a time constant of 10 s"):
        design_arrest_time(model, PAIR, arrest_time=100.0)


@pytest.mark.parametrize(
    ("options", "key", "value", "expected"),
    [
        ({"arrest_time": 0.0}, "arrest_time", "0.0", "a time above 0 s"),
        ({"arrest_time": "1 h"}, "arrest_time", "1 h", "a time above 0 s"),
        ({"deviation": -1.0}, "deviation", "-1.0", "a deviation above 0"),
        ({"deviation": 0.1, "arrest_time": 10.0}, "arrest_time", "10.0",
         "either an arrest time or a deviation"),
        ({"form": PidForm("PID")}, "form", "PID", "PI: it has no rule for Td"),
    ],
)  # fmt: skip
def test_wrong_requests_are_refused(basin, options, key, value, expected):
    with pytest.raises(InputError) as caught:
        design_arrest_time(basin.model, basin.pairing, **options)
    found = caught.value
    assert (found.place, str(found.value)) == (f"arrest time, {key}", value)
    assert found.expected == expected


def test_lambda_has_no_rule_for_derivative_action(basin):
    with refused(remedy="ask for PI"):
        design_lambda(basin.model, basin.pairing, form=PidForm("PID"))


TWO_DRUMS = """
name = "two-drums"
sampling_period = "20 s"
controlled = ["upper", "lower"]
averaging = ["upper", "lower"]
manipulated = ["transfer", "outflow"]
tanks.first = { area = "10 m^2", height = "2 m" }
tanks.second = { area = "8 m^2", height = "3 m" }
[flows.feed]
destination = "first"
range = ["20 m^3/h", "60 m^3/h"]
nominal = "40 m^3/h"
step = ["10 m^3/h", "-15 m^3/h"]
[flows.transfer]
source = "first"
destination = "second"
range = ["10 m^3/h", "70 m^3/h"]
nominal = "40 m^3/h"
[flows.outflow]
source = "second"
range = ["10 m^3/h", "70 m^3/h"]
nominal = "40 m^3/h"
[sensors.upper]
tank = "first"
range = ["0 m", "2 m"]
band = ["0.6 m", "1.4 m"]
[sensors.lower]
tank = "second"
range = ["0 m", "3 m"]
band = ["1 m", "2.5 m"]
[operating_point]
upper = "1 m"
lower = "1.5 m"
"""


def test_a_load_that_a_drum_upstream_passes_on_moves_the_next_one_too(tmp_path):
    (tmp_path / "two.toml").write_text(TWO_DRUMS, encoding="utf-8")
    plant = cl.load(tmp_path / "two.toml")
    passed = load_steps(plant.linear, "lower", ["transfer"])
    assert [3600.0 * load.rate for load in passed] == pytest.approx([10.0 / 8.0, -15.0 / 8.0])
    with pytest.raises(NotApplicable, match="names no load step that moves lower"):
        load_steps(plant.linear, "lower")
    run = cl.simulate(plant, cl.design.arrest_time(plant))
    for name in ("upper", "lower"):
        assert run.scores[f"time_outside_band[{name}]"] == 0.0
    # Down there is 0.5 m of 1 m, and the first drum makes the step a wave, but no larger one.
    assert 0.7 * 0.5 < 1.5 - run.true_measurement("lower").min() < 0.5
