"""The step law of a Mamdani controller: limits, modes, faults, rates and dead zones."""

import math

import pytest
from fuzzy_rig import DOCUMENT, plain_heights, summed_centroid
from refusals import refused

from clepsydra import Signal
from clepsydra.controllers.blocks.status import read_status
from clepsydra.controllers.fuzzy.kinds import FuzzyInput, FuzzyOutput
from clepsydra.controllers.fuzzy.law import fuzzy_law
from clepsydra.controllers.fuzzy.membership import left_shoulder, right_shoulder
from clepsydra.controllers.fuzzy.rule import parse_rule
from clepsydra.controllers.fuzzy.system import FuzzySystem, LinguisticVariable
from clepsydra.controllers.linear_step_law import StepLawDerivatives

HALVES = {"N": left_shoulder(-1, 1), "P": right_shoulder(-1, 1)}


def two_outputs():
    """x of measurement 1 moves u by position, the rate of measurement 2 moves v by increment."""
    x, d = (LinguisticVariable(name, -1.0, 1.0, HALVES) for name in "xd")
    u = LinguisticVariable("u", 0.0, 10.0, {"N": left_shoulder(0, 10), "P": right_shoulder(0, 10)})
    v = LinguisticVariable("v", -1.0, 1.0, HALVES)
    rules = tuple(
        parse_rule(f"{a}{s}", f"if {a} is {s} then {b} is {s}")
        for a, b in ("xu", "dv")
        for s in "NP"
    )
    system = FuzzySystem((x, d), (u, v), rules)
    law = fuzzy_law(
        system,
        [FuzzyInput("error", 1), FuzzyInput("measurement_rate", 2)],
        [FuzzyOutput(), FuzzyOutput("increment", rate_limited=True)],
        measured=[Signal("level", "m"), Signal("strength", "mol/m^3")],
        manipulated=[Signal("pump", "V", low=0, high=10), Signal("valve", "%", low=0, high=100)],
    )
    return system, law


VALUES = {
    "input_gain_1": 0.5, "dead_zone_1": 0.0, "input_gain_2": 0.2, "dead_zone_2": 0.0,
    "filter_time_2": 0.0,
    "output_gain_1": 1.0, "fading_time_1": 10.0, "low_limit_1": 0.0, "high_limit_1": 10.0,
    "output_gain_2": 5.0, "low_limit_2": 0.0, "high_limit_2": 100.0, "rate_limit_2": 1e9,
}  # fmt: skip
STATE = {"filtered_2": 0.0, "offset_1": 0.0, "last_output_1": 5.0, "last_output_2": 40.0}
GOOD = {
    "setpoint_1": 0.0, "measurement_1": 0.0, "measurement_2": 0.0, "sensor_1": 1, "sensor_2": 1,
    "mode_1": 1, "mode_2": 1, "manual_1": 0, "manual_2": 0, "tracking_1": 0,
    "tracking_2": 0, "time_step": 1.0,
}  # fmt: skip


@pytest.fixture
def scanned(driven):
    system, law = two_outputs()

    def start(**changed):
        values = VALUES | {k: v for k, v in changed.items() if k in VALUES}
        state = STATE | {k: v for k, v in changed.items() if k in STATE}
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
    assert (units["output_gain_1"], units["output_gain_2"]) == ("V", "%/s")


def test_position_and_increment(scanned):
    rig = scanned()
    found = rig.scan(**GOOD | {"setpoint_1": 1.2, "measurement_1": 0.2, "measurement_2": 2.0})
    assert found["manipulated_1"] == pytest.approx(centroid(scanned.system, 0, 0.5), rel=1e-14)
    assert found["manipulated_2"] == pytest.approx(
        40.0 + 5.0 * centroid(scanned.system, 1, 0.4), rel=1e-14
    )
    before = found["manipulated_2"]
    found = rig.scan(**GOOD | {"measurement_2": 3.0, "time_step": 0.5})  # a rate of 2 in 0.5 s
    expected = before + 0.5 * 5.0 * centroid(scanned.system, 1, 0.4)
    assert found["manipulated_2"] == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("error", "effective"), [(0.3, 0.0), (-0.3, 0.0), (1.0, 0.6), (-1.0, -0.6)]
)
def test_the_dead_zone_takes_its_width_off(scanned, error, effective):
    found = scanned(dead_zone_1=0.4).scan(**GOOD | {"setpoint_1": error})
    expected = centroid(scanned.system, 0, 0.5 * effective)
    assert found["manipulated_1"] == pytest.approx(expected, rel=1e-14)


def test_the_filtered_rate_follows_a_ramp_and_the_error_of_its_step_response(scanned):
    """Behind the filter a step of 1 is the rate (1/(Tf + Δt)) (Tf/(Tf + Δt))^k."""
    rig = scanned(filter_time_2=3.0)
    last = 40.0
    for k in range(6):
        found = rig.scan(**GOOD | {"measurement_2": 1.0})
        rate = (found["manipulated_2"] - last) / 5.0
        last = found["manipulated_2"]
        assert rate == pytest.approx(centroid(scanned.system, 1, 0.2 * 0.25 * 0.75**k), abs=1e-12)


def test_an_input_beyond_its_range_counts_as_its_end(scanned):
    ends = [scanned().scan(**GOOD | {"setpoint_1": e})["manipulated_1"] for e in (2.0, 50.0, 1e200)]
    assert ends[0] == ends[1] == ends[2]


def test_a_position_starts_from_hand_without_a_bump_and_the_offset_fades(scanned):
    rig = scanned()
    by_hand = rig.scan(**GOOD | {"mode_1": 0, "manual_1": 8.0})
    assert by_hand["manipulated_1"] == 8.0
    outputs = [rig.scan(**GOOD)["manipulated_1"] for _ in range(4)]
    law = centroid(scanned.system, 0, 0.0)
    for k, value in enumerate(outputs):
        assert value - law == pytest.approx((8.0 - law) * 0.9**k, rel=1e-12)


def test_an_increment_goes_on_from_where_hand_or_a_limit_left_it(scanned):
    rig = scanned()
    rig.scan(**GOOD | {"mode_2": 2, "tracking_2": 77.0})
    assert rig.scan(**GOOD)["manipulated_2"] == pytest.approx(77.0, abs=1e-12)
    rate = 0.0
    for _ in range(100):  # far into the high limit: it does not wind up
        rate += 4.0
        found = rig.scan(**GOOD | {"measurement_2": rate})
    assert found["manipulated_2"] == 100.0
    assert "at_high_limit" in read_status(int(found["status_2"]))
    assert rig.scan(**GOOD | {"measurement_2": rate - 4.0})["manipulated_2"] < 100.0


def test_the_rate_limit_holds_the_step(scanned):
    rig = scanned(rate_limit_2=0.3)
    found = rig.scan(**GOOD | {"measurement_2": 5.0})
    assert found["manipulated_2"] == pytest.approx(40.3)
    assert "at_rate_limit" in read_status(int(found["status_2"]))


@pytest.mark.parametrize(
    ("fault", "bit"),
    [
        ({"measurement_2": math.nan}, "invalid_input"),
        ({"measurement_2": math.inf}, "invalid_input"),
        ({"sensor_2": 0}, "sensor_fault"),
    ],
)
def test_a_fault_holds_only_the_outputs_whose_rules_read_it(scanned, fault, bit):
    rig = scanned(filtered_2=1.0)
    found = rig.scan(**GOOD | {"setpoint_1": 1.0, "measurement_2": 9.0} | fault)
    assert found["manipulated_2"] == 40.0 and bit in read_status(int(found["status_2"]))
    assert found["manipulated_1"] == pytest.approx(centroid(scanned.system, 0, 0.5))
    assert read_status(int(found["status_1"])) == ("automatic",)
    assert rig.state["filtered_2"] == 1.0


@pytest.mark.parametrize("time_step", [0.0, -1.0, math.nan, math.inf])
def test_an_unusable_time_step_holds_everything(scanned, time_step):
    rig = scanned(offset_1=1.0)
    before = dict(rig.state)
    found = rig.scan(**GOOD | {"setpoint_1": 1.0, "measurement_2": 3.0, "time_step": time_step})
    assert (found["manipulated_1"], found["manipulated_2"]) == (5.0, 40.0)
    assert rig.state == before


@pytest.mark.parametrize("name", ["input_gain_1", "dead_zone_1", "output_gain_1"])
def test_a_parameter_that_became_no_number_holds_the_output(scanned, name):
    rig = scanned()
    rig.values[name] = math.nan
    found = rig.scan(**GOOD | {"setpoint_1": 1.0})
    assert found["manipulated_1"] == 5.0 and math.isfinite(rig.state["offset_1"])


def test_where_no_rule_fires_the_output_is_held(driven):
    system, _ = two_outputs()
    object.__setattr__(system, "rules", system.rules[1:])  # no file is read that has such a gap
    law = fuzzy_law(
        system,
        [FuzzyInput("error", 1), FuzzyInput("measurement_rate", 2)],
        [FuzzyOutput(), FuzzyOutput("increment", rate_limited=True)],
        measured=[Signal("level", "m"), Signal("strength", "mol/m^3")],
        manipulated=[Signal("pump", "V"), Signal("valve", "%")],
    )
    rig = driven(law, VALUES, STATE)
    assert rig.scan(**GOOD | {"setpoint_1": -9.0})["manipulated_1"] == 5.0
    assert rig.scan(**GOOD | {"setpoint_1": 9.0})["manipulated_1"] > 5.5


def test_the_linear_model_has_the_slopes_of_the_surface():
    system, law = two_outputs()
    inputs = {"setpoint_1": 0.7, "measurement_1": 0.3, "measurement_2": 0.0, "time_step": 1.0}
    model = StepLawDerivatives(law).at(VALUES, STATE, inputs)
    step = 1e-4
    slope = (centroid(system, 0, 0.2 + step) - centroid(system, 0, 0.2 - step)) / (2 * step)
    assert model.D_setpoint[0, 0] == pytest.approx(0.5 * slope, rel=1e-4)
    assert model.D_measurement[0, 0] == pytest.approx(-0.5 * slope, rel=1e-4)
    assert abs(slope) > 1.0


def test_descriptions_that_do_not_match_are_refused():
    measured, manipulated = [Signal("y")], [Signal("u")] * 3
    inputs, outputs = [FuzzyInput("error", 1)] * 4, [FuzzyOutput()] * 3
    fuzzy_law(DOCUMENT, inputs, outputs, measured=measured, manipulated=manipulated)
    for wrong in (
        {"inputs": inputs[:3]},
        {"outputs": outputs[:2]},
        {"manipulated": manipulated[:2]},
        {"inputs": [*inputs[:3], FuzzyInput("error", 2)]},
    ):
        given = {
            "inputs": inputs,
            "outputs": outputs,
            "measured": measured,
            "manipulated": manipulated,
        }
        with refused(place="fuzzy law"):
            fuzzy_law(DOCUMENT, **given | wrong)
