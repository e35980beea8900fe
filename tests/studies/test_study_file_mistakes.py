"""Every mistake in a study file gets one message with line, key, value and remedy."""

import pytest
from study_texts import BASIN, QUADRUPLE, loop

import clepsydra as cl

WEIGHTS = 'weights = { states = { "tank_1.level" = 4.0 }, inputs = { pump_1 = 0.2, pump_2 = 0.2 } }'


def step(kind="setpoint", *lines):
    return f'{BASIN}[scenario]\nduration = "6 h"\n[[scenario.{kind}]]\n' + "\n".join(lines) + "\n"


def designed(*lines, process="quadruple-tank"):
    return f'process = "{process}"\n[controllers.a]\n' + "\n".join(lines) + "\n"


GENERAL = [
    (
        'process = "a.toml"\ntitel = "b"\n',
        "s.toml, line 2, titel: got 'titel', expected one of process, title, seed, scenario, "
        "ranking, controllers, cases, designs; perhaps 'title' was meant.",
    ),
    (
        "controllers = {}\n",
        "s.toml, line 1, process: got no process, expected a process of the catalogue, ",
    ),
    (
        'process = "quadruple-tonk"\n',
        "s.toml, line 1, process: got 'quadruple-tonk', expected a process of the "
        "catalogue, or the "
        "path of a process file",
    ),
    ('process = "quadruple-tonk"\n', "perhaps 'quadruple-tank' was meant."),
    ('process = "plant.toml"\n', "check the path, which starts in the folder of this file"),
    (QUADRUPLE + "seed = -1\n", "line 2, seed: got -1, expected a whole number from 0"),
    (QUADRUPLE + "seed = true\n", "line 2, seed: got True, expected a whole number from 0"),
    (QUADRUPLE + '[ranking]\nscores = ["iea"]\n', "line 3, ranking.scores: got 'iea', expected "),
    (QUADRUPLE + '[ranking]\nscores = ["iae_setpont"]\n', "perhaps 'iae_setpoint' was meant."),
    (
        QUADRUPLE + '[ranking]\nscores = ["iae[level_9]"]\n',
        "line 3, ranking.scores: got 'iae[level_9]', expected the score of a signal of "
        "quadruple-tank",
    ),
    (QUADRUPLE + '[ranking]\nscores = ["iae", "iae"]\n', "every name once"),
    (
        QUADRUPLE + '[controllers.a]\ndesign = "simc"\n[controllers.a]\ndesign = "simc"\n',
        "s.toml, line 4: got '[controllers.a]', expected every name once",
    ),
    (
        QUADRUPLE
        + '[controllers."PI a"]\ndesign = "simc"\n[controllers."pi  A"]\ndesign = "simc"\n',
        "line 4, controllers.pi  A: got 'pi  A', expected a name of its own, not that of 'PI a'",
    ),
    (QUADRUPLE + "[controllers.a]\n", "line 2, controllers.a: got 'neither a design nor a loop', "),
    (
        QUADRUPLE + '[controllers.a]\ndesign = "simc"\nlaw = "b.py"\n',
        "line 2, controllers.a: got 'design and law', expected one way to make a controller",
    ),
]

#: A scenario whose fourth line says where it begins.
BEGINS = f"{BASIN}[scenario]\nduration = '6 h'\n"
SCENARIO = [
    (
        f'{BEGINS}start = "emtpy"\n',
        "line 4, scenario.start: got 'emtpy', expected one of rest, empty; perhaps 'empty' was ",
    ),
    (
        f'{BEGINS}state = {{ "basin.levle" = "1 m" }}\n',
        "scenario.state.basin.levle: got 'basin.levle', expected a state or an input of "
        "equalisation-tank",
    ),
    (
        f'{BEGINS}state = {{ "basin.level" = "9 m" }}\n',
        "scenario.state.basin.level: got '9 m', expected a value from 0",
    ),
    (
        f'{BEGINS}start = "empty"\ncontroller_start = "clod"\n',
        "line 5, scenario.controller_start: got 'clod', expected one of bumpless, cold; perhaps "
        "'cold' was meant",
    ),
    (
        f"{BASIN}[scenario]\nduration = '6 h'\n",
        "line 2, scenario: got no step, expected at least one step; add a step, as in "
        "[[scenario.setpoint]], or leave [scenario] out for the usual one.",
    ),
    (f"{BASIN}[scenario]\nduration = '0 h'\n", "line 3, scenario.duration: got '0 h', expected a "),
    (f"{BASIN}[scenario]\nduration = '9 years'\n", "expected at most "),
    (f"{BASIN}[scenario]\nduration = '6 h'\nnoise = '6 h'\n", "line 4, scenario.noise: got '6 h'"),
    (
        step("setpoint", 'signal = "level"', 'at = "7 h"', 'to = "60 %"'),
        "line 6, scenario.setpoint.1.at: got '7 h', expected a time before the end of "
        "the steps at 6 h; lengthen the duration, or let it step earlier.",
    ),
    (
        f"{BASIN}[scenario]\nduration = '1 s'\n",
        "line 3, scenario.duration: got '1 s', expected at least",
    ),
    (
        step("setpoint", 'signal = "level"', 'at = "359 min"', 'to = "60 %"'),
        "line 6, scenario.setpoint.1.at: got '359 min', expected a time before the end of "
        "the steps at 6 h, by two samples",
    ),
    (
        step("setpoint", 'signal = "level"', 'at = "1 h"', 'to = "110 %"'),
        "line 7, scenario.setpoint.1.to: got '110 %', expected a setpoint from 0 to 100 "
        "%, the range "
        "of level; stay inside the range.",
    ),
    (
        step("load", 'signal = "inflow"', 'at = "1 h"', 'by = "0.5 m^3/s"'),
        "line 7, scenario.load.1.by: got '0.5 m^3/s, to 0.807 m^3/s', expected a load "
        "from 0 to 0.6 "
        "m^3/s, the range of inflow",
    ),
    (
        step("load", 'signal = "level"', 'at = "1 h"', 'by = "5 %"'),
        "line 5, scenario.load.1.signal: got 'level', expected a disturbance of equalisation-tank "
        "(inflow, inflow.bod)",
    ),
    (
        step("setpoint", 'signal = "strength"', 'at = "1 h"', 'by = "5 %"'),
        "line 5, scenario.setpoint.1.signal: got 'strength', expected a controlled measurement",
    ),
    (
        step("setpoint", 'signal = "level"', 'at = "1 h"'),
        "scenario.setpoint.1.to: got 'neither to nor by'",
    ),
    (
        step("setpoint", 'signal = "level"', 'at = "1 h"', 'to = "60 %"', 'by = "5 %"'),
        "line 8, scenario.setpoint.1.by: got 'both to and by'",
    ),
    (
        step("setpoint", 'signal = "level"', 'at = "1 h"', 'by = "0 %"'),
        "line 7, scenario.setpoint.1.by: got '0 %', expected a change of level",
    ),
    (
        step("setpoint", 'signal = "level"', 'at = "1 h"', 'to = "3 m^2"'),
        "line 7, scenario.setpoint.1.to: got '3 m^2'",
    ),
    (
        step(
            "setpoint",
            'signal = "level"',
            'at = "1 h"',
            'by = "5 %"',
            "[[scenario.load]]",
            'signal = "inflow"',
            'at = "3590 s"',
            'by = "0.1 m^3/s"',
        ),
        "line 10, scenario.load.1.at: got '3590 s', expected a time at which level does "
        "not step as "
        "well",
    ),
    (
        step("setpoint", 'signal = "level"', 'at = "1 h"', 'too = "60 %"'),
        "line 7, scenario.setpoint.1.too: got 'too', expected one of signal, at, to, by",
    ),
    (f"{BASIN}[scenario]\nduration = '6 h'\nsetpoint = 3\n", "line 4, scenario.setpoint: got 3"),
]

DESIGNS = [
    (designed('design = "smic"'), "line 3, controllers.a.design: got 'smic', expected a design ("),
    (designed('design = "smic"'), "perhaps 'simc' was meant."),
    (
        designed('design = "simc"', 'closed_loop_time = "5 min"'),
        "line 4, controllers.a.closed_loop_time: got 'closed_loop_time', expected one of design, ",
    ),
    (
        designed('design = "simc"', 'closed_loop_time = "5 min"'),
        "perhaps 'closed_loop_time_constant' was meant.",
    ),
    (
        designed('design = "simc"', 'closed_loop_time_constant = "0 min"'),
        "line 4, controllers.a.closed_loop_time_constant: got '0 min', expected a time above 0 min",
    ),
    (
        designed('design = "simc"', "closed_loop_time_constant = 300"),
        "the unit is missing: write it as in '1 s'",
    ),
    (
        designed('design = "simc"', 'pairing = { level_1 = "pump_1", level_2 = "pump_1" }'),
        "line 4, controllers.a.pairing.level_2: got 'pump_1', expected an input of its own: pump_1 "
        "moves level_1 already; pair each input once.",
    ),
    (
        designed('design = "simc"', 'pairing = { level_3 = "pump_1" }'),
        "got 'level_3', expected a controlled measurement of quadruple-tank (level_1, level_2)",
    ),
    (
        designed('design = "simc"', 'pairing = { level_1 = "pump_4" }'),
        "got 'pump_4', expected an input of quadruple-tank (pump_1, pump_2)",
    ),
    (
        designed('design = "simc"', 'actions = "P"'),
        "line 4, controllers.a.actions: got 'P', expected a PidForm with the actions PI or PID",
    ),
    (
        designed('design = "simc"', 'anti_windup = "yes"'),
        "line 4, controllers.a.anti_windup: got 'yes', expected one of ",
    ),
    (
        designed('design = "phase_margin"', 'phase_margin = "200 deg"'),
        "line 4, controllers.a.phase_margin: got '200 deg', expected an angle below 180 deg",
    ),
    (
        designed('design = "phase_margin"', "phase_margin = 60"),
        'phase_margin: got 60, expected an angle in deg or rad; write as in "60 deg".',
    ),
    # Shares are numbers, and so are radians: 60 % would be 34 deg.
    (designed('design = "phase_margin"', 'phase_margin = "60 %"'), "expected an angle in deg or"),
    # A hertz would be taken for a radian a second.
    (
        designed('design = "phase_margin"', 'crossover = "0.1 Hz"'),
        "line 4, controllers.a.crossover: got '0.1 Hz', expected an angular frequency in rad/s; "
        "multiply hertz by 2 pi",
    ),
    (
        designed('design = "lqi"', 'maximum_errors = { level_1 = "-5 %" }'),
        "line 4, controllers.a.maximum_errors.level_1: got '-5 %', expected a deviation above 0",
    ),
    (
        designed('design = "lqi_by_weights"'),
        "line 2, controllers.a.weights: got no weights, expected weights of states and inputs, "
        'for LQI of integrals as well; write as in weights = { states = { "tank_1.level" = 4.0 }, ',
    ),
    (
        designed('design = "lqi_by_weights"', WEIGHTS),
        "line 4, controllers.a.weights: got no integrals, expected weights for the integrals of "
        "level_1, level_2",
    ),
    (
        designed('design = "lqr"', WEIGHTS[:-2] + ", integrals = { level_1 = 1, level_2 = 1 } }"),
        "line 4, controllers.a.weights: got 'weights of integrals', expected weights of states and "
        "inputs alone",
    ),
    (
        designed('design = "lqr"', WEIGHTS.replace("4.0", "0")),
        "line 4, controllers.a.weights: got no weight above 0, expected a weight above 0 for one",
    ),
    # An integrator that next to nothing weighs, and a cost beyond all numbers: the usual weights
    # make a regulator of the same process, which therefore is not to blame.
    (
        designed(
            'design = "lqr"',
            'weights = { states = { "basin.level" = 1e-20 }, inputs = { outflow = 1e18 } }',
            process="equalisation-tank",
        ),
        "expected weights that make a stable loop; weigh every state",
    ),
    (
        designed('design = "lqr"', WEIGHTS.replace("4.0", "1e18").replace("0.2", "1e-18")),
        "expected weights that make a stable loop; weigh every state",
    ),
    (
        designed(
            'design = "lqr"',
            'weights = { states = { "tank_1.level" = 1 }, inputs = { pump_1 = 0, pump_2 = 1 } }',
        ),
        "line 4, controllers.a.weights.inputs.pump_1: got 0, expected a weight above 0",
    ),
    (
        designed(
            'design = "lqr"',
            'weights = { states = { "tank_9.level" = 1 }, inputs = { pump_1 = 1, pump_2 = 1 } }',
        ),
        "expected one of tank_1.level, ",
    ),
    (
        designed('design = "pole_placement"', "poles = [0.9, 0.9]", process="three-tanks"),
        "line 4, controllers.a.poles: got [0.9, 0.9], expected 3 numbers",
    ),
    (
        designed('design = "pole_placement"', "poles = [0.9, 0.8, 1.1]", process="three-tanks"),
        "expected numbers inside the unit circle",
    ),
    (
        designed('design = "pole_placement"', 'poles = ["0.9i"]', process="three-tanks"),
        "got '0.9i', expected a pole",
    ),
]

LOOPS = [
    (
        loop(integral_time='"0 s"'),
        "line 8, controllers.a.loops.level.integral_time: got '0 s', expected a time above 0 s; "
        'without this action write actions = "P".',
    ),
    (loop(integral_time=None), 'without this action write actions = "P"'),
    (
        loop(actions='"PID"'),
        'got no derivative_time, expected a time; without this action write actions = "PI"',
    ),
    (
        loop(actions='"I"'),
        "line 5, controllers.a.loops.level.actions: got 'I', expected one of P, ",
    ),
    (
        loop(actions='"P"'),
        "line 8, controllers.a.loops.level.integral_time: got '1 h', expected a "
        "setting of this isa P loop",
    ),
    (
        loop(action=None),
        'got no action, expected reverse or direct; write action = "reverse" if '
        'outflow has to rise when level falls, else action = "direct".',
    ),
    (
        loop(gain='"-2 %/%"'),
        "line 7, controllers.a.loops.level.gain: got '-2 %/%', expected a gain "
        "above 0; write it above zero; its sign is that of the action.",
    ),
    (
        loop(gain='"2 V/V"', measurement='"strength"', setpoint='"300 g/m^3"'),
        "line 7, controllers.a.loops.level.gain: got '2 V/V', expected a gain, in %/(g/m^3), or in "
        "%/% of outflow and strength; 'V/V' does not join outflow in % to strength in g/m^3",
    ),
    (
        loop(gain="2", measurement='"strength"', setpoint='"300 g/m^3"'),
        'the unit is missing: write as in "1 %/%"',
    ),
    (
        loop(measurement='"lvl"'),
        "line 3, controllers.a.loops.level.measurement: got 'lvl', expected a "
        "sensor of equalisation-tank (level, strength); perhaps 'level' was meant.",
    ),
    (
        loop(measurement='"strength"'),
        "got no setpoint, expected a value, since strength is none of the controlled "
        "measurements "
        "(level)",
    ),
    (
        loop(setpoint='"120 %"'),
        "controllers.a.loops.level.setpoint: got '120 %', expected a setpoint from 0 to 100 %",
    ),
    (
        loop(output='"outflw"'),
        "line 4, controllers.a.loops.level.output: got 'outflw', expected a "
        "manipulated variable (outflow)",
    ),
    (loop(output='"outflw"'), "perhaps 'outflow' was meant"),
    (
        loop(output='"flow.setpoint"'),
        "line 4, controllers.a.loops.level.output: got 'flow.setpoint', expected the setpoint of a "
        "loop of this scheme (level.setpoint): a cascade needs an inner loop with a measurement of "
        "its own; add a table loops.flow with its measurement, or move something else.",
    ),
    (
        loop(output='"level.setpoint"'),
        "line 4, controllers.a.loops.level.output: got 'loop level → loop level', expected a way "
        "from setpoints "
        "to manipulated variables without a circle",
    ),
    (loop(output='"level"'), 'write "level.setpoint" for a cascade'),
    (
        loop(gap='"5 %"'),
        "controllers.a.loops.level.gap: got '5 %', expected a setting of this isa PI loop",
    ),
    (loop(gap='"5 %"'), 'remove it, or write error = "gap"'),
    (loop(error='"gap"'), "got no gap"),
    (loop(error='"gap"', algorithm='"series"'), "expected linear error"),
    (
        loop(anti_windup='"clamping"', tracking_time='"5 min"'),
        'remove it, or write anti_windup = "back_calculation"',
    ),
    (loop(algorithm='"velocity"', actions='"P"', integral_time=None), "PI or PID"),
    (loop(setpoint_weight="1.5"), "expected a number of at most 1"),
    (loop(gian='"2 %/%"'), "perhaps 'gain' was meant"),
    (loop(Kp='"2 %/%"', gain=None), "perhaps 'gain' was meant"),
    (loop(Ti='"1 h"', integral_time=None), "perhaps 'integral_time' was meant"),
    (designed('design = "simc"', 'lambda = "9 s"'), "perhaps 'closed_loop_time_constant' was"),
    (loop(setpoint_low='"10 %"'), "it limits what an outer loop may ask for, and here is none"),
    (
        loop() + '[controllers.a.outputs.outflow]\nlow = "60 %"\nhigh = "40 %"\n',
        "line 10, controllers.a.outputs.outflow.low: got '60 %', expected a limit of outflow below "
        "its high limit, 40 %; exchange the two",
    ),
    (
        loop() + '[controllers.a.outputs.outflow]\nhigh = "0 %"\n',
        "line 10, controllers.a.outputs.outflow.high: got '0 %', expected a limit of outflow above "
        "the low end of its range, 0 %",
    ),
    (
        loop(integral_time='"1e9 h"'),
        "line 8, controllers.a.loops.level.integral_time: got '1e9 h', expected a value from "
        "2.778e-10 to 2.778e+05 h",
    ),
    (
        loop(gain='"2e12 %/%"'),
        "line 7, controllers.a.loops.level.gain: got '2e12 %/%', expected a size of at most 1e+09 "
        "%/%",
    ),
    (
        loop(setpoint='"3 m"'),
        "line 9, controllers.a.loops.level.setpoint: got '3 m', expected a setpoint of level "
        "from 0 to 100 %; 'm' is no unit of it: write as in \"50 %\".",
    ),
    (
        step("setpoint", 'signal = "level"', 'at = "1 h"', 'to = "3 m"').replace(
            "equalisation-tank", "wet-well"
        ),
        "expected a value of level from 4 to 20 mA, or in % of its range; 'm' is no unit of it: "
        'write as in "12 mA".',
    ),
    (
        loop() + '[controllers.a.feedforward.ahead]\nmeasurement = "strength"\n',
        "controllers.a.feedforward.ahead.to: got no to, expected the loop, selector or ratio "
        'that it adds to (level); write as in to = "level".',
    ),
    (
        loop()
        + '[controllers.a.feedforward.ahead]\nmeasurement = "level"\nto = "level"\n'
        + 'gain = "1 %/%"\nreference = "120 %"\n',
        "got '120 %', expected a reference from 0 to 100 %, the range of level",
    ),
    (
        loop(output=None),
        "controllers.a.loops.level.output: got no output, expected what it moves; write the name "
        'of one, as in output = "outflow".',
    ),
    (loop() + '[controllers.a.outputs.inflow]\nlow = "60 %"\n', "expected one of outflow"),
]


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("text", "said"),
    [*GENERAL, *SCENARIO, *DESIGNS, *LOOPS],
)
def test_the_message(message, text, said):
    found = message(text)
    assert said in found, found
    assert found.startswith("s.toml")
    assert "\n" not in found and "Traceback" not in found


def test_an_uncontrollable_pair_does_not_apply(tmp_path):
    """A design that cannot work says why; the study lists it with the reason."""
    path = tmp_path / "s.toml"
    path.write_text(
        'process = "averaging-tank"\n[controllers.a]\ndesign = "simc"\n'
        'pairing = { volume = "inflow.impurity", concentration = "inflow" }\n'
    )
    ((name, reason),) = cl.study(path).not_applicable
    assert name == "a" and "inflow.impurity does not move volume" in reason


def test_laws_of_users_that_cannot_be_used(message, tmp_path):
    head = f"{QUADRUPLE}[controllers.a]\n"
    assert (
        "line 3, controllers.a.law: got 'none.py', expected the name of a Python file"
        in message(head + 'law = "none.py"\n')
    )
    (tmp_path / "bad.py").write_text("x = 1\n")
    assert "line 3, controllers.a.law, bad.py: got no law" in message(head + 'law = "bad.py"\n')
    (tmp_path / "bad.py").write_text('inputs = ["level_1.pv"]\ndef step(state, inputs)\n')
    assert (
        "line 3, controllers.a.law, bad.py, line 2: got \"SyntaxError: expected ':'\""
        in message(head + 'law = "bad.py"\n')
    )
    (tmp_path / "good.py").write_text(
        'inputs = ["level_1.pv"]\noutputs = ["pump_1.out"]\nparameters = {"gain": 1.0}\n'
        "def step(state, inputs, parameters, time_step):\n"
        '    return {}, {"pump_1.out": 1.0}\n'
    )
    law = head + 'law = "good.py"\n'
    assert "expected a list of 1 names, one for each measurement of the law" in message(law)
    wired = law + 'measurements = ["level_1"]\nmanipulated = ["pump_1"]\n'
    assert "line 6, controllers.a.parameters.gian: got 'gian'" in message(
        wired + "parameters = { gian = 1.0 }\n"
    )
    assert "controllers.a.tune: got 'a law in Python'" in message(wired + "tune = {}\n")
    assert "got 'level_1, level_2', expected 1 names" in message(
        law + 'measurements = ["level_1", "level_2"]\nmanipulated = ["pump_1"]\n'
    )
