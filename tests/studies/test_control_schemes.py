"""Control schemes written out in a study file: wired, in the right units, and at rest."""

import math
from functools import cache

import numpy as np
import pytest
from flow_cascade import flow_cascade

from clepsydra import InputError
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.linear.linearise import linearise
from clepsydra.loop.loop import Loop
from clepsydra.studies.file.reader import read_study
from clepsydra.studies.tuning.tune import Search

PAIR = """
process = "quadruple-tank"
[controllers.pair.loops.left]
measurement = "level_1"
output = "pump_1"
actions = "PI"
action = "reverse"
gain = "3 V/V"
integral_time = "0.5 min"
[controllers.pair.loops.right]
measurement = "level_2"
output = "pump_2"
actions = "PI"
action = "reverse"
gain = 2.7
integral_time = "40 s"
tracking_time = "10 s"
setpoint_weight = 0.6
"""
BASIN = """
process = "equalisation-tank"
[controllers.a.loops.level]
measurement = "level"
output = "outflow"
actions = "PI"
action = "direct"
"""
CASCADE = flow_cascade("40 min", level_time="10 min")


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("schemes") / "study.toml"

    @cache
    def read(text):
        path.write_text(text, encoding="utf-8")
        return read_study(path)

    return read


def made(found, number=0):
    model = linearise(found.analysis.operating_point)
    return found.controllers[number].make(found.analysis, model), model


def test_loops_that_are_written_out_are_the_law_of_multiloop_control(study):
    controller, _ = made(study(PAIR))
    assert controller.measurements == controller.setpoints == ("level_1", "level_2")
    assert controller.manipulated == ("pump_1", "pump_2")
    loops = (
        {"proportional_gain": 3.0, "integral_time": 30.0, "tracking_time": 30.0},
        {"proportional_gain": 2.7, "integral_time": 40.0, "tracking_time": 10.0},
    )
    values = {
        f"{loop}.{name}": value
        for loop, settings in zip(("left", "right"), loops, strict=True)
        for name, value in settings.items()
    }
    values |= {"left.setpoint_weight": 1.0, "right.setpoint_weight": 0.6}
    for pump in controller.manipulated:
        values |= {f"{pump}.low_limit": 0.0, f"{pump}.high_limit": 10.0}
    assert controller.values == values
    assert set(controller.initial_state) >= {"left.integral", "pump_2.last_output"}
    law = multiloop_pid_law(["level_1", "level_2"], ["pump_1", "pump_2"])
    random = np.random.Generator(np.random.PCG64(5))
    for _ in range(20):
        given = {signal.name: random.uniform(0.0, 10.0) for signal in law.inputs}
        given |= {s.name: 1.0 for s in law.inputs if s.part in ("mode", "good")}
        state = {entry.name: random.uniform(0.0, 10.0) for entry in controller.law.state}
        answers = []
        for each, words in ((law, {"level_1": "left", "level_2": "right"}), (controller.law, {})):

            def of_scheme(signal, words=words):
                return f"{words.get(signal.owner, signal.owner)}.{signal.part}"

            following, outputs, _ = each.function(
                [state[of_scheme(entry)] for entry in each.state],
                [given[signal.name] for signal in each.inputs],
                [values[of_scheme(parameter)] for parameter in each.parameters],
            )
            names = map(of_scheme, each.state)
            answers.append(
                (dict(zip(names, np.array(following).ravel(), strict=True)),
                 np.array(outputs).ravel().tolist())
            )  # fmt: skip
        assert answers[0] == answers[1]


def test_what_was_not_written_is_said(study):
    controller, _ = made(study(PAIR))
    (note,) = controller.notes
    assert "left.setpoint_weight = 1" in note and "left.tracking_time = 30 s" in note
    assert "right" not in note
    assert "level_1 by pump_1, PI, K = 3 %/%, Ti = " in controller.design


@pytest.mark.parametrize(
    ("gain", "value"),
    [
        # The level from 0 to 100 % is 5 m and the pump's range 100 %: all the same here.
        ('"2 %/%"', -2.0),
        ('"2"', -2.0),
        ("2", -2.0),
    ],
)
def test_gains_between_signals_of_one_unit(study, gain, value):
    text = f'{BASIN}gain = {gain}\nintegral_time = "1 h"\n'
    assert made(study(text))[0].values["level.proportional_gain"] == value


@pytest.mark.parametrize(
    ("gain", "value"),
    [
        # 4 mA to 20 mA for the level, 0 to 100 % for the pump.
        ('"2 %/%"', -2.0 / 16e-3),
        ('"125 1/A"', -125.0),
        ('"5 %/mA"', -50.0),
    ],
)
def test_gains_between_signals_of_different_units(study, gain, value):
    text = BASIN.replace("equalisation-tank", "wet-well").replace("outflow", "duty")
    controller, _ = made(study(f'{text}gain = {gain}\nintegral_time = "1 h"\n'))
    assert controller.values["level.proportional_gain"] == pytest.approx(value, rel=1e-14)


def test_the_parallel_form_has_gains_of_its_own(study):
    controller, _ = made(
        study(
            BASIN.replace('"PI"', '"PID"')
            + 'algorithm = "parallel"\ngain = "2 %/%"\nintegral_gain = "0.6 %/%/min"\n'
            'derivative_gain = "3 %/% min"\nfilter_time = "30 s"\n'
        )
    )
    values = controller.values
    assert values["level.proportional_gain"] == -2.0
    assert values["level.integral_gain"] == pytest.approx(-0.01, rel=1e-14)
    assert values["level.derivative_gain"] == pytest.approx(-180.0, rel=1e-14)
    # √(Ti Td) with Ti = K/Ki = 200 s and Td = Kd/K = 90 s.
    assert values["level.tracking_time"] == pytest.approx(math.sqrt(200.0 * 90.0), rel=1e-14)


def test_an_output_may_have_limits_and_a_rate_limit(study):
    text = f'{BASIN}gain = "2 %/%"\nintegral_time = "1 h"\n[controllers.a.outputs.outflow]\n'
    found = study(f'{text}low = "20 %"\nhigh = "90 %"\nrate_limit = "3 %/min"\n')
    values = made(found)[0].values
    assert (values["outflow.low_limit"], values["outflow.high_limit"]) == (0.2, 0.9)
    assert values["outflow.rate_limit"] == pytest.approx(5e-4, rel=1e-14)
    controller, model = made(found)
    moved = np.diff(Loop(controller, model).run(found.scenario).values["outflow"])
    assert np.abs(moved).max() <= 0.03 * (1 + 1e-12)


def test_a_cascade_rests_and_brings_the_level_to_its_setpoint(study):
    found = study(CASCADE)
    controller, model = made(found)
    assert controller.measurements == ("level", "duty_flow")
    assert controller.setpoints == ("level",)
    assert controller.free_inputs["flow.setpoint_source"] == 1.0
    # The outer gain: 3 % of 60 l/s for 1 % of 16 mA.
    assert controller.values["level.proportional_gain"] == pytest.approx(-3.0 * 0.06 / 0.016)
    assert controller.values["flow.setpoint_high_limit"] == pytest.approx(0.035)
    assert controller.values["flow.setpoint_low_limit"] == 0.0
    run = Loop(controller, model).run(found.scenario)
    span, level = 16e-3, run.true_measurement("level")
    assert np.abs(level[:60] - level[0]).max() < 1e-9 * span
    assert level[-1] == pytest.approx(run.values["level.setpoint"][-1], abs=2e-3 * span)
    assert sampled_loop(controller, model).maximum_sensitivity < 2.0


@pytest.mark.thorough
def test_an_inner_loop_alone_is_not_the_cascade(study):
    """With the outer loop away the flow keeps its setpoint, and the level runs off."""
    alone = CASCADE.replace("[controllers.cascade.loops.level]", "[controllers.b.loops.level]")
    alone = alone.replace('output = "flow.setpoint"', 'output = "duty"')
    alone = alone.replace(
        'output = "duty"\nactions = "PI"\naction = "reverse"',
        'setpoint = "20 l/s"\noutput = "duty"\nactions = "PI"\naction = "reverse"',
    )
    found = study(alone.replace('setpoint_high = "35 l/s"\n', ""))
    controller, model = made(found, [r.name for r in found.controllers].index("cascade"))
    run = Loop(controller, model).run(found.scenario)
    level = run.true_measurement("level")
    assert abs(level[-1] - run.values["level.setpoint"][-1]) > 0.04 * 16e-3


OVERRIDE = """
process = "equalisation-tank"
[controllers.override.loops.level]
measurement = "level"
output = "highest"
actions = "PI"
action = "direct"
gain = "0.5 %/%"
integral_time = "10 h"
[controllers.override.loops.flood]
measurement = "level"
setpoint = "80 %"
output = "highest"
actions = "PI"
action = "direct"
gain = "10 %/%"
integral_time = "30 min"
[controllers.override.selectors.highest]
select = "high"
output = "outflow"
"""


def test_an_override_has_a_fixed_setpoint_beside_that_of_the_operator(study):
    found = study(OVERRIDE)
    controller, model = made(found)
    assert controller.setpoints == ("level",)
    assert controller.free_inputs == {"flood.sp": 0.8}
    run = Loop(controller, model).run(found.scenario)
    assert run.values["outflow"][0] == pytest.approx(0.614, rel=1e-12)
    assert not any("does not begin at rest" in note for note in controller.notes)


def test_a_fixed_setpoint_has_another_name_than_that_of_the_operator(study):
    """A loop of the name level, with a fixed setpoint, beside one that follows level.sp."""
    level, flood = "[controllers.override.loops.level]", "[controllers.override.loops.flood]"
    text = OVERRIDE.replace(level, "[controllers.override.loops.usual]").replace(flood, level)
    with pytest.raises(InputError) as refusal:
        study(text)
    assert (refusal.value.value, refusal.value.remedy[:9]) == ("level", "rename it")


def test_the_loop_that_is_selected_at_rest_is_the_one_of_the_linear_model(study):
    """The order of the loops in the file decides nothing."""
    level, flood, selector = OVERRIDE.split("[controllers.override.")[1:]
    head = OVERRIDE.split("[controllers.override.")[0]
    peaks = []
    for parts in ((level, flood), (flood, level)):
        text = head + "".join(f"[controllers.override.{part}" for part in (*parts, selector))
        controller, model = made(study(text))
        peaks.append(sampled_loop(controller, model).maximum_sensitivity)
    alone = head + "[controllers.a." + level.replace('"highest"', '"outflow"')
    controller, model = made(study(alone))
    assert peaks == pytest.approx(
        [sampled_loop(controller, model).maximum_sensitivity] * 2, rel=1e-9
    )


def test_an_override_that_is_active_at_the_operating_point_is_said(study):
    controller, _ = made(study(OVERRIDE.replace('"80 %"', '"40 %"')))
    assert "does not begin at rest" in controller.notes[-1]
    assert "outflow from 61.4 %" in controller.notes[-1]


SPLIT = """
process = "equalisation-tank:relief"
[controllers.split.loops.level]
measurement = "level"
output = "ways"
actions = "PI"
action = "direct"
gain = "4 %/%"
integral_time = "2 h"
[controllers.split.split_ranges.ways]
parts = [
  { output = "outflow", from = "0 %", to = "60 %", at_from = "0 %", at_to = "100 %" },
  { output = "relief", from = "60 %", to = "100 %", at_from = "0 %", at_to = "100 %" },
]
"""


def test_a_split_range_moves_its_actuators_one_after_the_other(study):
    controller, _ = made(study(SPLIT))
    law = controller.law
    assert controller.manipulated == ("outflow", "relief")
    # 4 % of the splitter's 100 % for 1 % of the level, which is 1 inside.
    assert controller.values["level.proportional_gain"] == pytest.approx(-400.0)
    for asked, expected in ((30.0, (0.5, 0.0)), (60.0, (1.0, 0.0)), (80.0, (1.0, 0.5))):
        state = controller.initial_state | {"level.integral": asked}
        given = {signal.name: signal.initial for signal in law.inputs}
        given |= {"level.sp": 0.5, "level.pv": 0.5, "time_step": 1e-9}
        _, outputs, _ = law.function(
            [state[entry.name] for entry in law.state],
            [given[signal.name] for signal in law.inputs],
            [controller.values[parameter.name] for parameter in law.parameters],
        )
        found = dict(zip((s.name for s in law.outputs), np.array(outputs).ravel(), strict=True))
        assert (found["outflow.out"], found["relief.out"]) == pytest.approx(expected), asked


RATIO = """
process = "equalisation-tank:dosing"
[controllers.dosing.loops.level]
measurement = "level"
output = "outflow"
actions = "PI"
action = "direct"
gain = "2 %/%"
integral_time = "3 h"
[controllers.dosing.ratios.acid_ratio]
measurement = "inflow_meter"
output = "acid_flow.setpoint"
ratio = "0.01 m^3/s/(m^3/s)"
[controllers.dosing.loops.acid_flow]
measurement = "acid_meter"
output = "acid"
actions = "PI"
action = "reverse"
gain = "0.2 %/%"
integral_time = "10 s"
"""


def test_a_ratio_moves_the_setpoint_of_a_flow(study):
    found = study(RATIO)
    controller, model = made(found)
    assert controller.values["acid_ratio.ratio"] == pytest.approx(0.01, rel=1e-14)
    assert controller.measurements == ("level", "acid_meter", "inflow_meter")
    assert not any("does not begin at rest" in note for note in controller.notes)
    run = Loop(controller, model).run(found.scenario)
    assert run.values["acid"][0] == pytest.approx(found.analysis.operating_point.as_dict()["acid"])


def test_a_ratio_may_be_trimmed_by_a_loop(study):
    trimmed = RATIO.replace(
        'ratio = "0.01 m^3/s/(m^3/s)"\n', "lowest_ratio = 0\nhighest_ratio = 0.02\n"
    )
    trimmed = trimmed.replace('output = "outflow"', 'output = "acid_ratio"')
    controller, _ = made(study(trimmed))
    # From the whole range of the level to the whole range of the ratio, 0.02.
    assert controller.values["level.proportional_gain"] == pytest.approx(-2.0 * 0.02)
    assert controller.values["acid_ratio.highest_ratio"] == 0.02
    assert controller.manipulated == ("acid",)
    assert any("does not move outflow" in note for note in controller.notes)


FEEDFORWARD = """
process = "wet-well:flow-meters"
[scenario]
duration = "1 min"
noise = false
[[scenario.setpoint]]
signal = "level"
at = "30 s"
by = "5 %"
[controllers.ahead.loops.level]
measurement = "level"
output = "duty"
actions = "PI"
action = "direct"
gain = "3 %/%"
integral_time = "10 min"
[controllers.ahead.feedforward.inflow]
measurement = "inflow_meter"
to = "level"
gain = "1.5 %/(l/s)"
lead = "2 s"
lag = "10 s"
"""


@pytest.mark.thorough
def test_feedforward_adds_to_a_loop_from_the_operating_point_on(study):
    found = study(FEEDFORWARD)
    controller, model = made(found)
    values = controller.values
    assert values["feedforward.inflow.gain"] == pytest.approx(15.0)  # [1/(m³/s)]
    assert values["feedforward.inflow.lead"] == 2.0 and values["feedforward.inflow.lag"] == 10.0
    at = found.analysis.operating_point.as_dict()
    assert values["feedforward.inflow.reference"] == at["inflow_meter"]
    run = Loop(controller, model).run(found.scenario)
    assert run.values["duty"][0] == pytest.approx(at["duty"], rel=1e-9)
    written = study(FEEDFORWARD + 'reference = "18 l/s"\n')
    assert made(written)[0].values["feedforward.inflow.reference"] == pytest.approx(0.018)


START_STOP = """
process = "wet-well:start-stop"
[controllers.pumps.start_stop]
measurement = "level"
pumps = ["duty", "standby"]
start = ["10 mA", "13 mA"]
stop = ["7 mA", "9 mA"]
shortest_rest = "1 min"
alternation = false
stopped = ["0 %", "0 %"]
running = ["90 %", "100 %"]
"""


@pytest.mark.thorough
def test_start_and_stop_levels(study):
    found = study(START_STOP)
    controller, model = made(found)
    values = controller.values
    assert (
        values["stage.2.start_level"] == pytest.approx(13e-3)
        and values["stage.1.stop_level"] == 7e-3
    )
    assert (values["duty.running_value"], values["standby.running_value"]) == (0.9, 1.0)
    assert (values["alternation"], values["shortest_rest"]) == (0.0, 60.0)
    run = Loop(controller, model).run(found.scenario)
    assert set(np.unique(run.values["duty"])) == {0.0, 0.9}


@pytest.mark.sampled
@pytest.mark.parametrize(
    "text", [PAIR, CASCADE, OVERRIDE, SPLIT, RATIO, FEEDFORWARD, START_STOP], ids=range(7)
)
def test_every_scheme_has_a_program_for_the_plant(study, text):
    controller, _ = made(study(text))
    program = controller.program()
    assert {p.name: p.initial for p in program.parameters} == controller.values


TUNE = """
[controllers.a.tune]
objective = "iae"
maximum_sensitivity = 1.7
[controllers.a.tune.parameters]
"""


def test_bounds_of_a_loop_are_written_by_its_keys(study):
    text = f'{BASIN}gain = "2 %/%"\nintegral_time = "1 h"\n{TUNE}'
    found = study(
        f'{text}level.gain = ["1 %/%", "8 %/%"]\nlevel.integral_time = ["10 min", "5 h"]\n'
    )
    controller, _ = made(found)
    tune = found.controllers[0].tune
    gain, time = tune.space(controller, None).parameters
    # The action is direct, so that the law's gain is negative.
    assert (gain.name, gain.low, gain.high) == ("level.proportional_gain", -8.0, -1.0)
    assert (time.low, time.high, time.followers) == (600.0, 18000.0, ("level.tracking_time",))
    assert tune.limits.maximum_sensitivity == 1.7
    assert tune.objective.words == "IAE of level, relative to the start"


def test_bounds_may_be_those_of_the_law_and_weights_those_of_several_scores(study):
    text = (
        'process = "quadruple-tank"\n[controllers.a]\ndesign = "simc"\n[controllers.a.tune]\n'
        'objective = { iae = 1.0, "total_variation[pump_1]" = 0.1 }\novershoot = "15 %"\n'
        'total_variation = { pump_2 = "20 V" }\n[controllers.a.tune.parameters]\n'
    )
    found = study(
        f'{text}level_2.gain = ["1 %/%", "9 %/%"]\nlevel_1.integral_time = ["0.5 min", "60 s"]\n'
    )
    controller, _ = made(found)
    tune = found.controllers[0].tune
    gain, time = tune.space(controller, None).parameters
    assert (gain.name, gain.low, gain.high) == ("level_2.proportional_gain", 1.0, 9.0)
    assert (time.name, time.low, time.high) == ("level_1.integral_time", 30.0, 60.0)
    assert tune.objective.kind == "weighted"
    assert tune.objective.weights == {
        "iae[level_1]": 1.0, "iae[level_2]": 1.0, "total_variation[pump_1]": 0.1,
    }  # fmt: skip
    assert tune.limits.overshoot == pytest.approx(15.0)
    assert tune.limits.total_variation == {"pump_2": 20.0}
    assert tune.limits.maximum_sensitivity == 2.0


@pytest.mark.thorough
def test_a_tuning_finds_a_better_controller_within_its_bounds(study):
    scenario = (
        '[scenario]\nduration = "12 h"\nnoise = false\n[[scenario.setpoint]]\nsignal = "level"\n'
        'at = "10 min"\nby = "10 %"\n'
    )
    # With an integral time of 1 h no such gain keeps the usual damping, or the usual overshoot.
    lifted = TUNE.replace("1.7\n", '1.7\ndamping = 0.0\novershoot = "100 %"\n')
    text = (
        f'{BASIN}gain = "2 %/%"\nintegral_time = "1 h"\n{lifted}level.gain = ["1 %/%", "3 %/%"]\n'
    )
    found = study(text.replace("[controllers.a.loops", f"{scenario}[controllers.a.loops"))
    controller, model = made(found)
    tuned = found.controllers[0].tune.run(controller, model, found.scenario, Search())
    assert tuned.objective < 1.0
    assert -3.0 <= tuned.controller.values["level.proportional_gain"] <= -1.0
    assert tuned.controller.values["level.integral_time"] == 3600.0
