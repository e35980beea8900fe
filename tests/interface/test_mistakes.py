"""A mistake of a caller names place, value, what was expected and what to do."""

import pytest
from refusals import refused

import clepsydra as cl

#: What is wrong: the call, its place, its value, a part of what was expected, a part of the remedy.
MISTAKES = {
    "process": (
        lambda plant, pi: cl.load("quadruple-tnak"),
        ("process", "quadruple-tnak", "quadruple-tank", "'quadruple-tank' was meant"),
    ),
    "plant as text": (
        lambda plant, pi: cl.design.simc("quadruple-tnak"),
        ("process", "quadruple-tnak", "quadruple-tank", "'quadruple-tank' was meant"),
    ),
    "name as process": (
        lambda plant, pi: cl.Plant("quadruple-tank"),
        ("plant", "quadruple-tank", "a process", "cl.load"),
    ),
    "package as function": (
        lambda plant, pi: cl.designs(plant),
        ("clepsydra", "designs", "design, disturbance", "'design' was meant"),
    ),
    "all designs as function": (
        lambda plant, pi: cl.design(plant),
        ("cl.design", "a call", "simc", "dir(cl.design)"),
    ),
    "controller as text": (
        lambda plant, pi: cl.simulate(plant, "PI"),
        ("controller", "PI", "a controller", "cl.design"),
    ),
    "other plant": (
        lambda plant, pi: cl.simulate(cl.load("three-tanks"), pi),
        ("controller", "PI, SIMC of quadruple-tank", "three-tanks", "design one for this plant"),
    ),
    "export to other plant": (
        lambda plant, pi: cl.export(pi, cl.load("three-tanks")),
        ("controller", "PI, SIMC of quadruple-tank", "three-tanks", "design one for this plant"),
    ),
    "unit of an output": (
        lambda plant, pi: plant.at(outputs={"level_1": "4 cm", "level_2": "4 V"}),
        ("operating point, outputs, level_1", "4 cm", "0 to 10 V", '"5 V"'),
    ),
    "text without its unit": (
        lambda plant, pi: plant.at(outputs={"level_1": "4", "level_2": "4 V"}),
        ("operating point, outputs, level_1", "4", "0 to 10 V", "the unit is missing"),
    ),
    "unknown input": (
        lambda plant, pi: plant.at(inputs={"pmup_1": 3}),
        ("operating point, inputs", "pmup_1", "pump_1, pump_2", "'pump_1' was meant"),
    ),
    "one of several inputs, of a file that gives measurements": (
        lambda plant, pi: cl.load("averaging-tank:all-inputs").at(inputs={"inflow": "10 %"}).point,
        ("operating point, inputs", "no outflow, inflow.impurity", "every input", "give outflow"),
    ),
    "unknown parameter": (
        lambda plant, pi: plant.with_values({"tank_1.aera": "1 m^2"}),
        ("plant, values", "tank_1.aera", "a parameter of quadruple-tank", "'tank_1.area' was"),
    ),
    "parameter below nothing": (
        lambda plant, pi: plant.with_values({"tank_1.area": "-35 cm^2"}),
        ("plant, values, tank_1.area", "-35 cm^2", "a value of 0 cm^2 or more", "inside the range"),
    ),
    "symbol of an argument": (
        lambda plant, pi: cl.design.simc(plant, tau_c="10 s"),
        ("simc", "tau_c", "pairing, form", "'closed_loop_time_constant' was meant"),
    ),
    "setting without its loop": (
        lambda plant, pi: pi.with_values(K=2),
        ("Controller.with_values", "K", "values, name", '{"level_1": {"K": 6.0}}'),
    ),
    "output without its table": (
        lambda plant, pi: plant.at(level_1="4 V"),
        ("Plant.at", "level_1", "inputs, outputs", 'outputs={"level_1": "4 V"}'),
    ),
    "keyword of a verb": (
        lambda plant, pi: cl.tune(pi, plant, limit={"overshoot": "5 %"}),
        ("tune", "limit", "goal, limits", "'limits' was meant"),
    ),
    "keyword of a fuzzy file": (
        lambda plant, pi: cl.design.fuzzy(plant, "a.toml", nmae="a"),
        ("fuzzy", "nmae", "plant, path, name", "'name' was meant"),
    ),
    "time without its unit": (
        lambda plant, pi: cl.design.simc(plant, closed_loop_time_constant="20"),
        ("simc, closed_loop_time_constant", "20", "convertible to s", "the unit is missing"),
    ),
    "time in volts": (
        lambda plant, pi: cl.design.simc(plant, closed_loop_time_constant="20 V"),
        ("simc, closed_loop_time_constant", "20 V", "convertible to s", "measures something else"),
    ),
    "signal of a weight": (
        lambda plant, pi: cl.design.lqi(plant, maximum_errors={"level_9": 1.0}),
        ("lqi, maximum_errors, level_9", "level_9", "level_1, level_2", "was meant"),
    ),
    "unknown loop": (
        lambda plant, pi: pi.with_values({"level_3": {"K": 1.0}}),
        ("values", "level_3", "level_1, level_2", "was meant"),
    ),
    "unknown setting": (
        lambda plant, pi: pi.with_values({"level_1": {"Tii": 1.0}}),
        ("values, level_1", "Tii", "K, Ti, b, tracking_time", "'Ti' was meant"),
    ),
    "setting of another unit": (
        lambda plant, pi: pi.with_values({"level_1": {"Ti": "3 m"}}),
        ("values, level_1, Ti", "3 m", "in s", "'m' is no unit of it"),
    ),
    "gain with a sign": (
        lambda plant, pi: pi.with_values({"level_1": {"K": -3.0}}),
        ("values, level_1, K", -3.0, "a gain from 0", "leave the sign out"),
    ),
    "integral time of nothing": (
        lambda plant, pi: pi.with_values({"level_1": {"Ti": 0.0}}),
        ("values, level_1, Ti", "0.0 s", "s", ""),
    ),
    "settings without a loop": (
        lambda plant, pi: pi.with_values({"level_1": 3.0}),
        ("values, level_1", 3.0, "settings with their values", '{"K": 6.0}'),
    ),
    "a scenario of no length": (
        lambda plant, pi: cl.simulate(plant, pi, duration=0),
        ("simulation, duration", 0, "above 0 s", "'20 min'"),
    ),
    "a study of one sample": (
        lambda plant, pi: cl.study(plant, [pi], duration="0.9 s"),
        ("duration", "0.9 s", "at least 2 s, two samples", "lengthen it"),
    ),
    "a simulation of no length": (
        lambda plant, pi: cl.simulate(plant, duration="0 s"),
        ("duration", "0 s", "above 0 s", "'20 min'"),
    ),
    "step after the end": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.step("level_1", 1.0, at="1 h")], duration=60),
        ("step of level_1", "60 min", "within the duration", "lengthen the duration"),
    ),
    "step of an unknown signal": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.step("level_9", "1 V")]),
        ("step of level_9", "level_9", "level_1, level_2, inflow_1, inflow_2", "was meant"),
    ),
    "step of what the controller moves": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.step("pump_1", "1 V")]),
        ("step of pump_1", "pump_1", "the controller moves the inputs", "without a controller"),
    ),
    "setpoint without a controller": (
        lambda plant, pi: cl.simulate(plant, None, [cl.step("level_1", "1 V")]),
        ("step of level_1", "level_1", "pump_1, pump_2, inflow_1", "give a controller"),
    ),
    "step in another unit": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.step("level_1", "+1 cm")]),
        ("step of level_1, by", "+1 cm", "a change of level_1 in V", "'cm' is no unit of it"),
    ),
    "step out of the range": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.step("level_1", "+9 V")]),
        ("step of level_1, by", "+9 V, to 15.1315 V", "0 to 10 V", "stay inside the range"),
    ),
    "step of nothing": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.step("level_1", 0.0)]),
        ("step of level_1, by", 0.0, "a change of level_1", "leave it out"),
    ),
    "step to nowhere": (
        lambda plant, pi: cl.step("level_1"),
        ("step of level_1", "neither by nor to", "the size of the change", 'to="50 %"'),
    ),
    "ramp of no length": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.ramp("level_1", "1 V", over=0)]),
        ("ramp of level_1, over", 0, "above 0 s", "a step instead"),
    ),
    "time before the start": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.step("level_1", "1 V", at=-5)]),
        ("step of level_1, at", -5, "from 0 s on", "0 s or more"),
    ),
    "disturbance of a level": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.disturbance("level_1", "1 V")]),
        ("disturbance of level_1", "level_1", "inflow_1, inflow_2", "choose one"),
    ),
    "one event and no list": (
        lambda plant, pi: cl.simulate(plant, pi, cl.step("level_1", "1 V")),
        ("events", "an Event", "a list of events", "[cl.step("),
    ),
    "state of another unit": (
        lambda plant, pi: cl.simulate(plant, state={"tank_1.level": "5 V"}),
        ("state, tank_1.level", "5 V", "convertible to m", "measures something else"),
    ),
    "name of a state": (
        lambda plant, pi: cl.simulate(plant, state={1: "5 cm"}),
        ("state", "1", "a state of quadruple-tank (tank_1.level", "choose one of them"),
    ),
    "states as text": (
        lambda plant, pi: cl.simulate(plant, state="tank_1.level=5cm"),
        ("state", "tank_1.level=5cm", "states with their values", '"tank_1.level": "5 cm"'),
    ),
    "solver under a controller": (
        lambda plant, pi: cl.simulate(plant, pi, solver="euler"),
        ("solver", "euler", "kernel, reference", "correct the name"),
    ),
    "no controllers": (
        lambda plant, pi: cl.study(plant, []),
        ("study, controllers", "none", "at least one controller", "every design"),
    ),
    "name of a design": (
        lambda plant, pi: cl.study(plant, only="PI, SIMK"),
        ("controller", "PI, SIMK", "name of a controller", "'PI, SIMC' was meant"),
    ),
    "goal": (
        lambda plant, pi: cl.tune(pi, plant, goal="iaf"),
        ("tuning, objective", "iaf", "iae, iae_setpoint", "'iae' was meant"),
    ),
    "limit": (
        lambda plant, pi: cl.tune(pi, plant, limits={"overshot": "10 %"}),
        ("tuning, limits", "overshot", "overshoot", "'overshoot' was meant"),
    ),
    "limit of max|S|": (
        lambda plant, pi: cl.tune(pi, plant, limits={"max|S|": 0.9}),
        ("tuning, maximum_sensitivity", 0.9, "above 1", "1.4 to 2"),
    ),
    "no draws": (
        lambda plant, pi: cl.tune(pi, plant, draws=0),
        ("tuning, draws", 0, "a whole number from 1 to 10,000", "64 will do"),
    ),
    "draws as text": (
        lambda plant, pi: cl.tune(pi, plant, draws="64"),
        ("tuning, draws", "64", "a whole number from 1 to 10,000", "64 will do"),
    ),
    "quantile of all draws": (
        lambda plant, pi: cl.tune(pi, plant, draws=64, quantile="100 %"),
        ("tuning, quantile", "100 %", "above 0 and below 1", 'as in 0.95 or "95 %"'),
    ),
    "quantile of nothing": (
        lambda plant, pi: cl.tune(pi, plant, quantile=0.95),
        ("tuning, quantile", 0.95, "draws beside it", "draws = 64, or leave quantile out"),
    ),
    "parameter to tune": (
        lambda plant, pi: cl.tune(pi, plant, parameters={"level_1": {"Tii": ("1 s", "9 s")}}),
        ("tuning, parameters, level_1", "Tii", "K, Ti, b", "'Ti' was meant"),
    ),
    "score that is no text": (
        lambda plant, pi: cl.tune(pi, plant, goal={3: 1.0}),
        ("tuning, objective", 3, "names as text", "write as in"),
    ),
    "loop that is no text": (
        lambda plant, pi: cl.tune(pi, plant, parameters={3: (1.0, 9.0)}),
        ("tuning, parameters", 3, "names as text", "write as in"),
    ),
    "input that is no text": (
        lambda plant, pi: cl.tune(pi, plant, limits={"total_variation": {3: 1.0}}),
        ("tuning, total_variation", 3, "names as text", "write as in"),
    ),
    "pulse of no time": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.disturbance("inflow_1", "+1 %", lasts=0)]),
        ("disturbance of inflow_1, lasts", 0, "a time above 0 s", "leave it out"),
    ),
    "noise of a process without": (
        lambda plant, pi: cl.simulate(plant, pi, [cl.step("level_1", "1 V")], noise=True),
        ("noise", True, "a process whose file gives a noise", "give one to a sensor or a pump"),
    ),
    "noise of the default scenario": (
        lambda plant, pi: cl.simulate(plant, pi, noise=True),
        ("noise", True, "no noise beside the default scenario", "give events or a start"),
    ),
    "noise without a controller": (
        lambda plant, pi: cl.simulate(plant, None, noise=True),
        ("noise", True, "a controller that meets it", "give one, or leave it out"),
    ),
    "record": (
        lambda plant, pi: cl.identify("no-such-record.csv"),
        ("no-such-record.csv", "no such file", "a CSV file", "check the path"),
    ),
    "target": (
        lambda plant, pi: cl.export(pi, plant, to="sts"),
        ("export, to", "sts", "c, st, fmu, wasm, tuning", "'st' was meant"),
    ),
    "process as text": (
        lambda plant, pi: cl.export(None, plant, to="st"),
        ("export, controller", "none", "a controller", "give a controller"),
    ),
    "fail-safe value": (
        lambda plant, pi: cl.export(pi, plant, fail_safe={"pump_1": "1 m"}),
        ("fail_safe, pump_1", "1 m", "a value of pump_1 from 0 to 10 V", "'m' is no unit of it"),
    ),
    "parameter of a matrix in another unit": (
        lambda plant, pi: cl.design.lqi(plant).with_values({"pump_1.bias": "1 m"}),
        ("values, pump_1.bias", "1 m", "a setting in V", "or a number in V"),
    ),
    "too few scans": (
        lambda plant, pi: cl.verify(pi, plant, scans=10),
        ("proof, scans", 10, "at least 10,000", "choose more"),
    ),
    "scans as text": (
        lambda plant, pi: cl.verify(pi, plant, scans="10000"),
        ("proof, scans", "10000", "a whole number", "choose more"),
    ),
    "plant and controller in the other order": (
        lambda plant, pi: cl.verify(plant, pi),
        ("plant", "a Controller", "a plant", "cl.load"),
    ),
    "no controller to verify": (
        lambda plant, pi: cl.verify(None, plant),
        ("controller", None, "a controller", "cl.design"),
    ),
    "plant of an export": (
        lambda plant, pi: cl.export(pi, None),
        ("plant", None, "the name or path of a process", "cl.load"),
    ),
    "scenario as text": (
        lambda plant, pi: cl.verify(pi, plant, scenario="default"),
        ("scenario", "default", "a Scenario", "that of a study"),
    ),
    "values as a list": (
        lambda plant, pi: plant.with_values(["tank_1.area"]),
        ("plant, values", "a list", "parameters with their values", '"tank_1.area": "30 cm^2"'),
    ),
    "a system of nothing": (
        lambda plant, pi: cl.zeros([1.0]),
        ("python-control system", "list", "a control.StateSpace", "control.ss"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", MISTAKES)
def test_a_mistake_names_what_is_wrong_and_what_to_do(case, plant, pi, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call, (place, value, expected, remedy) = MISTAKES[case]
    with pytest.raises(cl.InputError) as error:
        call(plant, pi)
    found = error.value
    assert (found.place, found.value) == (place, value)
    assert expected in found.expected and remedy in found.remedy
    assert not list(tmp_path.iterdir())


def test_an_unknown_keyword_is_a_type_error_too(plant, pi):
    calls = (
        lambda: cl.design.lqi(plant, Q=1.0),
        lambda: cl.simulate(plant, pi, time=1.0),
        lambda: cl.load("quadruple-tank", inputs_=1.0),
        lambda: cl.step("level_1", size="1 V"),
    )
    for call in calls:
        with pytest.raises(TypeError) as error:
            call()
        assert isinstance(error.value, cl.InputError) and error.value.remedy


def test_an_unknown_score_is_a_key_error_that_names_the_signals(plant, pi):
    scores = cl.simulate(plant, pi, [cl.step("level_1", "1 V")], duration="5 min").scores
    with pytest.raises(KeyError) as error:
        scores["overshoot"]
    assert isinstance(error.value, cl.InputError)
    assert error.value.expected == "one of overshoot[level_1]"
    assert str(error.value).startswith("scores: got 'overshoot', expected one of overshoot[")
    with pytest.raises(KeyError, match=r"one of .*iae\[level_2\]"):
        scores["iaf"]
    assert scores.get("overshoot") is None and "overshoot" not in scores


def test_a_design_that_does_not_suit_says_why(plant):
    with pytest.raises(cl.NotApplicable, match="does not integrate"):
        cl.design.arrest_time(plant)


def test_a_plant_that_cannot_rest_as_asked_says_why(plant):
    with pytest.raises(cl.NoEquilibrium):
        cl.analyse(plant.at(outputs={"level_1": "9.9 V", "level_2": "0.2 V"}))


@pytest.fixture(scope="module")
def well():
    """A level in mA and pumps in percent."""
    return cl.load("wet-well:start-stop")


@pytest.mark.parametrize(
    ("values", "place", "value", "expected"),
    [
        ({"stage.1.start_level": "-1 mA"}, "stage.1.start_level", "-1 mA", "from 4 to 20 mA"),
        ({"stage.1.start_level": "0 mA"}, "stage.1.start_level", "0 mA", "from 4 to 20 mA"),
        ({"stage.1.start_level": 12}, "stage.1.start_level", "12.0 A", "from 0.004 to 0.02 A"),
        ({"duty.running_value": "120 %"}, "duty.running_value", "120 %", "from 0 to 100 %"),
        (
            {"stage.2.start_level": "8 mA", "stage.2.stop_level": "6 mA"},
            "stage.2.start_level", "8 mA", "beyond stage.1.start_level, 8.43527 mA",
        ),
    ],
)  # fmt: skip
def test_a_level_that_no_pump_could_start_at_is_refused(well, values, place, value, expected):
    controller = cl.design.start_stop_levels(well)
    with refused(place=f"values, {place}", value=value, expected=expected):
        controller.with_values(values)


@pytest.mark.parametrize(
    ("setting", "value", "shown", "expected"),
    [
        ("setpoint_rate", "-1 mA/s", "-1 mA/s", "a rate above 0 mA/s"),
        ("setpoint_rate", -1, "-1.0 mA/s", "a rate above 0 mA/s"),
        ("setpoint_rate", "1 m/s", "1 m/s", "a rate of level, in mA/min or %/min"),
        ("sensor_delay", "-1 min", "-1 min", "a time of at least 0 min"),
        ("fail_safe", 200, "200 %", "from 0 to 100 %, the limits of duty"),
    ],
)
def test_a_setting_on_the_plant_is_refused_in_its_unit(well, setting, value, shown, expected):
    signal = "duty" if setting == "fail_safe" else "level"
    with refused(place=f"{setting}, {signal}", value=shown, expected=expected):
        cl.export(cl.design.simc(well), well, **{setting: {signal: value}})
