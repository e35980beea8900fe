"""Mistakes in schemes, tunings and stations get one message with line, key, value and remedy."""

import pytest
from study_texts import BASIN, LOOP, loop

OTHER = LOOP.replace("loops.level", "loops.other")
HIGHEST = '[controllers.a.selectors.highest]\nselect = "high"\noutput = "outflow"\n'
INNER = """[controllers.a.loops.inner]
measurement = "strength"
output = "outflow"
actions = "P"
action = "reverse"
gain = "1 %/%"
"""
SPLIT_LOOP = LOOP.replace('"outflow"', '"ways"')
SPLIT = """process = "equalisation-tank:relief"
{loop}[controllers.a.split_ranges.ways]
parts = [
  {{ output = "outflow", from = "0 %", to = "60 %", at_from = "0 %", at_to = "100 %" }},
  {{ output = "{second}", from = "{start}", to = "100 %", at_from = "0 %", at_to = "{end}" }},
]
"""


def split(loop=SPLIT_LOOP, second="relief", start="60 %", end="100 %"):
    return SPLIT.format(loop=loop, second=second, start=start, end=end)


SCHEMES = [
    (
        BASIN + LOOP + OTHER,
        "line 11, controllers.a.loops.other.output: got 'outflow', expected something of "
        "its own to "
        "move: loop level moves outflow already; put a selector between the two, or a split range "
        "with a loop for each.",
    ),
    (
        loop(output='"highest"') + HIGHEST,
        "line 10, controllers.a.selectors.highest.select: got '1 loops', expected two or "
        "more parts "
        'that have output = "highest"',
    ),
    (
        loop(output='"highest"', anti_windup='"conditional_integration"')
        + OTHER.replace('"outflow"', '"highest"')
        + HIGHEST,
        "line 9, controllers.a.loops.level.anti_windup: got 'conditional_integration', expected "
        "back_calculation: selector highest selects among several loops",
    ),
    (
        loop(output='"highest"', anti_windup='"none"')
        + OTHER.replace('"outflow"', '"highest"')
        + HIGHEST,
        'write anti_windup = "back_calculation"',
    ),
    (
        BASIN + LOOP + HIGHEST.replace("highest", "outflow"),
        "line 9, controllers.a.selectors: got 'outflow', expected a name of its own for each part; "
        "outflow is a manipulated variable as well",
    ),
    (
        loop(output='"highest"') + HIGHEST.replace('"high"', '"highest"'),
        "got 'highest', expected one of low, high",
    ),
    (
        loop(output='"inner.setpoint"') + INNER + 'setpoint = "300 g/m^3"\n',
        "controllers.a.loops.inner.setpoint: got '300 g/m^3', expected no setpoint: loop "
        "level gives "
        "it",
    ),
    (
        loop(output='"inner.setpoint"') + INNER.replace('"outflow"', '"level.setpoint"'),
        "expected a way from setpoints to manipulated variables without a circle",
    ),
    (
        loop(output='"inner.setpoint"') + INNER + 'setpoint_low = "500 g/m^3"\n',
        "controllers.a.loops.inner.setpoint_low: got '500 g/m^3', expected a limit from 0 to 400",
    ),
    (
        split(start="50 %"),
        "controllers.a.split_ranges.ways.parts.2.from: got '50 %', expected a part "
        "that does not overlap that of outflow, 0 to 60 %",
    ),
    (split(end="120 %"), "controllers.a.split_ranges.ways.parts.2.at_to: got '120 %'"),
    (split(second="drain"), "got 'drain', expected a manipulated variable (outflow, relief)"),
    (split(loop=""), "got 'nothing that moves it'"),
    (split(loop=LOOP), "expected something of its own to move: loop level moves outflow already"),
    (
        split(loop=LOOP.replace('"outflow"', '"relief"'), second="level.setpoint"),
        "controllers.a.split_ranges.ways.parts: got 'nothing that moves it', expected a "
        "loop that has "
        'output = "ways"',
    ),
    (
        BASIN + LOOP + '[controllers.a.ratios.r]\nmeasurement = "strength"\nratio = "1 %/%"\n'
        'output = "outflow"\n',
        "line 12, controllers.a.ratios.r.output: got 'outflow'",
    ),
    (
        loop(output='"r"') + '[controllers.a.ratios.r]\nmeasurement = "strength"\nratio = "1 %/%"\n'
        'output = "outflow"\n',
        "expected lowest_ratio and highest_ratio, since a loop trims it",
    ),
    (
        BASIN + '[controllers.a.ratios.r]\nmeasurement = "strength"\nlowest_ratio = "1 %/%"\n'
        'output = "outflow"\n',
        "expected ratio alone, since no loop trims it",
    ),
    (
        loop() + '[controllers.a.feedforward.f]\nmeasurement = "strength"\nto = "lvl"\n',
        "line 11, controllers.a.feedforward.f.to: got 'lvl', expected a loop, selector or ratio",
    ),
    (
        loop() + '[controllers.a.feedforward.f]\nmeasurement = "strength"\nto = "level"\n'
        'gain = "1 %/%"\nlead = "3 s"\n',
        "got no lag, expected a time; give both lead and lag",
    ),
]


def tuned(*lines):
    return loop() + "[controllers.a.tune]\n" + "\n".join(lines) + "\n"


TUNING = [
    (
        tuned('objective = "iea"'),
        "line 10, controllers.a.tune.objective: got 'iea', expected a score that can be tuned for",
    ),
    (
        tuned('objective = "settling_time"'),
        "got 'settling_time', expected a score that can be tuned",
    ),
    (tuned('objective = "iae[strength]"'), "got 'iae[strength]', expected iae of one of level"),
    (
        tuned("objective = { iae = 0 }"),
        "line 10, controllers.a.tune.objective.iae: got 0, expected a weight above 0",
    ),
    (
        tuned("maximum_sensitivity = 0.9"),
        "line 10, controllers.a.tune.maximum_sensitivity: got 0.9",
    ),
    (tuned('overshoot = "-1 %"'), "line 10, controllers.a.tune.overshoot: got '-1 %'"),
    (tuned('total_variation = { pump = "1 V" }'), "expected one of outflow"),
    (
        tuned('parameters.level.gain = ["3 %/%", "1 %/%"]'),
        'line 10, controllers.a.tune.parameters.level.gain: got \'["3 %/%", "1 %/%"]\', '
        "expected a low "
        "bound below the high bound; exchange or correct them.",
    ),
    (
        tuned('parameters.level.integral_time = ["3 h", "100 min"]'),
        "line 10, controllers.a.tune.parameters.level.integral_time: got "
        '\'["3 h", "100 min"]\', expected a low bound below the high bound',
    ),
    (
        tuned('parameters.level.gain = ["3 %/%", "5 %/%"]'),
        'line 10, controllers.a.tune.parameters.level.gain: got \'["3 %/%", "5 %/%"]\', expected '
        "bounds around where it starts, 2 %/%",
    ),
    (
        tuned('parameters.level.proportional_gain = ["1 %/%", "5 %/%"]'),
        "expected bounds around where it starts, -2 %/%",
    ),
    (
        tuned('parameters.level.integral_time = ["2 h", "5 h"]'),
        "expected bounds around where it starts, 1 h",
    ),
    (
        tuned('parameters.level.gain = ["-5 %/%", "-1 %/%"]'),
        "expected bounds that are not negative: the action of the loop gives the gain its sign",
    ),
    (
        tuned('parameters.level.integral_time = ["0 h", "5 h"]'),
        "got '0 h', expected a value from 1e-06 to 1e+09 s",
    ),
    (
        tuned("overshoot = 10"),
        "overshoot: got 10, expected a limit of the overshoot of every setpoint step, "
        "10 % if left out, a share of the step of at most 1; write as in",
    ),
    (
        tuned('total_variation = { outflow = "0 %" }'),
        "got '0 %', expected a total variation above 0",
    ),
    (tuned('parameters.level.gian = ["1 %/%", "5 %/%"]'), "perhaps 'gain' was meant"),
    (
        tuned('parameters.basin.gain = ["1 %/%", "5 %/%"]'),
        "got 'basin.gain', expected a loop of this controller (level)",
    ),
    (tuned('parameters.integral_time_2 = ["1 s", "5 s"]'), "perhaps 'level.int"),
    (tuned('parameters.integral_time_1 = ["1 s", "5 s"]'), "write level.integral_time"),
    (tuned("parameters.level.gain = 3"), "expected a list of a low and a high bound"),
    (
        tuned('parameters.level.setpoint_weight = ["0.5", "1.5"]'),
        "got '1.5', expected a value from 0 to 1",
    ),
    (tuned("seed = 3"), "line 10, controllers.a.tune.seed: got 'seed', expected one of objective"),
]

STATION = """process = "wet-well:start-stop"
[controllers.a.start_stop]
measurement = "level"
pumps = ["duty", "standby"]
start = ["10 mA", "13 mA"]
stop = ["7 mA", "9 mA"]
"""
STATIONS = [
    (
        STATION.replace('"13 mA"', '"9.5 mA"'),
        "line 5, controllers.a.start_stop.start: got '9.5 mA', expected a level beyond "
        "stage.1.start_level, 10 mA",
    ),
    (
        STATION.replace('"7 mA"', '"11 mA"'),
        "line 5, controllers.a.start_stop.start: got '13 mA', expected a level below "
        "stage.2.stop_level, 9 mA",
    ),
    (
        STATION.replace(', "13 mA"', ""),
        "line 5, controllers.a.start_stop.start: got '[\"10 mA\"]', "
        "expected a list of 2 values, one for each pump",
    ),
    (STATION.replace("standby", "stand_by"), "perhaps 'standby' was meant"),
    (STATION.replace("13 mA", "23 mA"), "expected a value from 4 to 20 mA, the range of level"),
    (
        STATION.replace('"level"', '"lvl"'),
        "line 3, controllers.a.start_stop.measurement: got 'lvl'",
    ),
]


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("text", "said"),
    [*SCHEMES, *TUNING, *STATIONS],
)
def test_the_message(message, text, said):
    found = message(text)
    assert said in found, found
    assert found.startswith("s.toml")
    assert "\n" not in found and "Traceback" not in found
