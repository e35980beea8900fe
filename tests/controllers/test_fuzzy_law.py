"""The step law of a Mamdani controller: limits, modes, faults, rates and dead zones."""

import copy
import math

import pytest
from fuzzy_rig import plain_heights, summed_centroid

from clepsydra import Signal
from clepsydra.controllers.blocks.status import read_status
from clepsydra.controllers.fuzzy.law import fuzzy_law
from clepsydra.controllers.fuzzy.membership import left_shoulder, right_shoulder
from clepsydra.controllers.fuzzy.rule import parse_rule
from clepsydra.controllers.fuzzy.system import FuzzySystem, LinguisticVariable
from clepsydra.controllers.fuzzy.variables import FuzzyInput, FuzzyOutput
from clepsydra.controllers.linear_step_law import StepLawDerivatives

HALVES = {"N": left_shoulder(-1, 1), "P": right_shoulder(-1, 1)}


def two_outputs():
    """x of the level moves u by position, the rate of the strength moves v by increment."""
    x, d = (LinguisticVariable(name, -1.0, 1.0, HALVES) for name in "xd")
    u = LinguisticVariable("u", 0.0, 10.0, {"N": left_shoulder(0, 10), "P": right_shoulder(0, 10)})
    v = LinguisticVariable("v", -1.0, 1.0, HALVES)
    rules = tuple(
        parse_rule(f"{a}{s}", f"if {a} is {s} then {b} is {s}")
        for a, b in ("xu", "dv")
        for s in "NP"
    )
    system = FuzzySystem((x, d), (u, v), rules)
    return system, law_of(system)


def law_of(system):
    level, strength = Signal("level", "m"), Signal("strength", "mol/m^3")
    pump, valve = Signal("pump", "V", low=0, high=10), Signal("valve", "%", low=0, high=100)
    return fuzzy_law(
        system,
        [FuzzyInput("error", level), FuzzyInput("measurement_rate", strength)],
        [FuzzyOutput(pump), FuzzyOutput(valve, "increment", rate_limited=True)],
    )


VALUES = {
    "x.gain": 0.5, "x.dead_zone": 0.0, "d.gain": 0.2, "d.dead_zone": 0.0, "d.filter_time": 0.0,
    "pump.output_gain": 1.0, "pump.fading_time": 10.0,
    "pump.low_limit": 0.0, "pump.high_limit": 10.0, "valve.output_gain": 5.0,
    "valve.low_limit": 0.0, "valve.high_limit": 100.0, "valve.rate_limit": 1e9,
}  # fmt: skip
STATE = {"d.filtered": 0.0, "pump.offset": 0.0, "pump.last_output": 5.0, "valve.last_output": 40.0}
GOOD = {
    "level.sp": 0.0, "level.pv": 0.0, "strength.pv": 0.0, "level.good": 1, "strength.good": 1,
    "pump.mode": 1, "valve.mode": 1, "pump.manual": 0, "valve.manual": 0, "pump.tracking": 0,
    "valve.tracking": 0, "time_step": 1.0,
}  # fmt: skip


@pytest.fixture
def scanned(driven):
    system, law = two_outputs()

    def start(changed=()):
        values = VALUES | {k: changed[k] for k in changed if k in VALUES}
        state = STATE | {k: changed[k] for k in changed if k in STATE}
        return driven(law, values, state)

    start.system = system
    return start


def centroid(system, number, value):
    output = system.outputs[number]
    values = {v.name: value for v in system.inputs}
    return summed_centroid(output, plain_heights(system, values)[output.name],
                           system.points_of(output))  # fmt: skip


def test_the_gain_of_an_increment_is_one_to_a_rate():
    _, law = two_outputs()
    units = {parameter.name: parameter.unit for parameter in law.parameters}
    assert (units["pump.output_gain"], units["valve.output_gain"]) == ("V", "%/s")


def test_position_and_increment(scanned):
    rig = scanned()
    found = rig.scan(**GOOD | {"level.sp": 1.2, "level.pv": 0.2, "strength.pv": 2.0})
    assert found["pump.out"] == pytest.approx(centroid(scanned.system, 0, 0.5), rel=1e-14)
    assert found["valve.out"] == pytest.approx(
        40.0 + 5.0 * centroid(scanned.system, 1, 0.4), rel=1e-14
    )
    before = found["valve.out"]
    found = rig.scan(**GOOD | {"strength.pv": 3.0, "time_step": 0.5})  # a rate of 2 in 0.5 s
    expected = before + 0.5 * 5.0 * centroid(scanned.system, 1, 0.4)
    assert found["valve.out"] == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("error", "effective"), [(0.3, 0.0), (-0.3, 0.0), (1.0, 0.6), (-1.0, -0.6)]
)
def test_the_dead_zone_takes_its_width_off(scanned, error, effective):
    found = scanned({"x.dead_zone": 0.4}).scan(**GOOD | {"level.sp": error})
    expected = centroid(scanned.system, 0, 0.5 * effective)
    assert found["pump.out"] == pytest.approx(expected, rel=1e-14)


def test_the_filtered_rate_follows_a_ramp_and_the_error_of_its_step_response(scanned):
    """Behind the filter a step of 1 is the rate (1/(Tf + Δt)) (Tf/(Tf + Δt))^k."""
    rig = scanned({"d.filter_time": 3.0})
    last = 40.0
    for k in range(6):
        found = rig.scan(**GOOD | {"strength.pv": 1.0})
        rate = (found["valve.out"] - last) / 5.0
        last = found["valve.out"]
        assert rate == pytest.approx(centroid(scanned.system, 1, 0.2 * 0.25 * 0.75**k), abs=1e-12)


def test_an_input_beyond_its_range_counts_as_its_end(scanned):
    ends = [scanned().scan(**GOOD | {"level.sp": e})["pump.out"] for e in (2.0, 50.0, 1e200)]
    assert ends[0] == ends[1] == ends[2]


def test_a_position_starts_from_hand_without_a_bump_and_the_offset_fades(scanned):
    rig = scanned()
    by_hand = rig.scan(**GOOD | {"pump.mode": 0, "pump.manual": 8.0})
    assert by_hand["pump.out"] == 8.0
    outputs = [rig.scan(**GOOD)["pump.out"] for _ in range(4)]
    law = centroid(scanned.system, 0, 0.0)
    for k, value in enumerate(outputs):
        assert value - law == pytest.approx((8.0 - law) * 0.9**k, rel=1e-12)


def test_an_increment_goes_on_from_where_hand_or_a_limit_left_it(scanned):
    rig = scanned()
    rig.scan(**GOOD | {"valve.mode": 2, "valve.tracking": 77.0})
    assert rig.scan(**GOOD)["valve.out"] == pytest.approx(77.0, abs=1e-12)
    rate = 0.0
    for _ in range(100):  # far into the high limit: it does not wind up
        rate += 4.0
        found = rig.scan(**GOOD | {"strength.pv": rate})
    assert found["valve.out"] == 100.0
    assert "at_high_limit" in read_status(int(found["valve.status"]))
    assert rig.scan(**GOOD | {"strength.pv": rate - 4.0})["valve.out"] < 100.0


def test_the_rate_limit_holds_the_step(scanned):
    rig = scanned({"valve.rate_limit": 0.3})
    found = rig.scan(**GOOD | {"strength.pv": 5.0})
    assert found["valve.out"] == pytest.approx(40.3)
    assert "at_rate_limit" in read_status(int(found["valve.status"]))


@pytest.mark.parametrize(
    ("fault", "bit"),
    [
        ({"strength.pv": math.nan}, "invalid_input"),
        ({"strength.pv": math.inf}, "invalid_input"),
        ({"strength.good": 0}, "sensor_fault"),
    ],
)
def test_a_fault_holds_only_the_outputs_whose_rules_read_it(scanned, fault, bit):
    rig = scanned({"d.filtered": 1.0})
    found = rig.scan(**GOOD | {"level.sp": 1.0, "strength.pv": 9.0} | fault)
    assert found["valve.out"] == 40.0 and bit in read_status(int(found["valve.status"]))
    assert found["pump.out"] == pytest.approx(centroid(scanned.system, 0, 0.5))
    assert read_status(int(found["pump.status"])) == ("automatic",)
    assert rig.state["d.filtered"] == 1.0


@pytest.mark.parametrize("time_step", [0.0, -1.0, math.nan, math.inf])
def test_an_unusable_time_step_holds_everything(scanned, time_step):
    rig = scanned({"pump.offset": 1.0})
    before = dict(rig.state)
    found = rig.scan(**GOOD | {"level.sp": 1.0, "strength.pv": 3.0, "time_step": time_step})
    assert (found["pump.out"], found["valve.out"]) == (5.0, 40.0)
    assert rig.state == before


@pytest.mark.parametrize("name", ["x.gain", "x.dead_zone", "pump.output_gain"])
def test_a_parameter_that_became_no_number_holds_the_output(scanned, name):
    rig = scanned()
    rig.values[name] = math.nan
    found = rig.scan(**GOOD | {"level.sp": 1.0})
    assert found["pump.out"] == 5.0 and math.isfinite(rig.state["pump.offset"])


def test_where_no_rule_fires_the_output_is_held(driven):
    system = copy.copy(two_outputs()[0])
    object.__setattr__(system, "rules", system.rules[1:])  # no file is read that has such a gap
    rig = driven(law_of(system), VALUES, STATE)
    assert rig.scan(**GOOD | {"level.sp": -9.0})["pump.out"] == 5.0
    assert rig.scan(**GOOD | {"level.sp": 9.0})["pump.out"] > 5.5


def test_the_linear_model_has_the_slopes_of_the_surface():
    system, law = two_outputs()
    inputs = {"level.sp": 0.7, "level.pv": 0.3, "strength.pv": 0.0, "time_step": 1.0}
    model = StepLawDerivatives(law).at(VALUES, STATE, inputs)
    step = 1e-4
    slope = (centroid(system, 0, 0.2 + step) - centroid(system, 0, 0.2 - step)) / (2 * step)
    assert model.D_setpoint[0, 0] == pytest.approx(0.5 * slope, rel=1e-4)
    assert model.D_measurement[0, 0] == pytest.approx(-0.5 * slope, rel=1e-4)
    assert abs(slope) > 1.0
