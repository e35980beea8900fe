"""Alarms of a rig: an operator acknowledges them in the page, and Python finds the same ones."""

from pathlib import Path

import numpy as np
import pytest
from page_in_node import answered, source

import clepsydra as cl
from clepsydra.laboratory.page_data import page_data
from clepsydra.laboratory.replay import replayed
from clepsydra.laboratory.rig import Rig
from clepsydra.laboratory.session import session_of

ALARMED = Path(__file__).parents[1] / "alarmed-tank.toml"
SCRIPT = f"""
import {{ unpacked }} from "{source("live/bytes.ts")}";
import {{ Acknowledging }} from "{source("lab/acknowledging.ts")}";
import {{ interlockWords }} from "{source("lab/alarm_states.ts")}";
import {{ AlarmTimes }} from "{source("lab/alarm_times.ts")}";
import {{ Log }} from "{source("lab/log.ts")}";
import {{ Rig }} from "{source("lab/rig.ts")}";
const {{ data }} = given;
const modules = await Promise.all(
  data.modules.map(async (text) => WebAssembly.compile(await unpacked(text))));
const rig = new Rig(data, modules);
const acknowledging = new Acknowledging(rig);
const times = new AlarmTimes(data.alarms);
const log = new Log(data, (name) => name);
const [highHigh, lowLow, flatline] = data.alarms;
const states = [];
const run = (samples) => {{
  for (let sample = 0; sample < samples; ++sample) {{
    acknowledging.step();
    rig.step();
    states.push(data.alarms.map((alarm) => acknowledging.state(alarm)));
  }}
}};
const timesOf = ({{ name }}) => {{
  times.read(rig.run, rig.sample);
  const {{ came, returned, times: count }} = times.of(name);
  return [came, returned ?? null, count];
}};
const lines = () => {{
  log.read(rig.run, rig.sample);
  return log.latest.map(({{ words, isAbnormal, times }}) => [words, isAbnormal, times]);
}};
const held = () => interlockWords("pump_1", data.alarms, (name) => rig.value(name));
const session = () => JSON.parse(JSON.stringify(rig.session()));
// Beyond the high-high alarm, and up to the rim though the pump stands.
const full = () => rig.touch("inflow_1", 20e-6);
const empty = () => {{
  rig.touch("inflow_1", 0);
  rig.touch("pump_1.mode", 0);
  rig.touch("pump_1.manual", 0);
}};
"""
NORMAL, UNACKNOWLEDGED, ACKNOWLEDGED, RETURNED = range(4)


@pytest.fixture(scope="module")
def rig():
    plant = cl.load(ALARMED)
    return Rig(plant.linear, [cl.design.simc(plant)])


@pytest.fixture
def found(rig, tmp_path):
    """Run a script, and return what it answers."""
    return lambda script: answered(SCRIPT + script, {"data": page_data(rig)}, tmp_path)


def again(rig, session):
    return replayed(rig, session_of(session, "session"), "session")


def states_in_python(rig, run):
    columns = [run.values[f"{alarm.name}.state"] for alarm in rig.process.alarms]
    return np.transpose(columns).astype(int).tolist()


def test_an_operator_meets_the_states_of_the_standard(rig, found):
    seen, states, session = found("""
const seen = [];
const see = () => seen.push(acknowledging.state(highHigh));
run(3);
see();
full();
run(60);
see();
acknowledging.press(highHigh);
run(1);
see();
rig.touch("inflow_1", 0);
rig.touch("level_1.setpoint", 0.12);
run(60);
see();
rig.touch("level_1.setpoint", 0.16);
run(200);
rig.touch("level_1.setpoint", 0.12);
run(60);
see();
acknowledging.press(highHigh);
run(1);
see();
answer([seen, states, session()]);
""")
    assert seen == [NORMAL, UNACKNOWLEDGED, ACKNOWLEDGED, NORMAL, RETURNED, NORMAL]
    assert states_in_python(rig, again(rig, session)) == states


def test_a_press_lasts_one_sample(found):
    waiting, touches = found("""
full();
run(60);
const waiting = [acknowledging.waiting.length];
acknowledging.press(highHigh);
acknowledging.press(highHigh);
waiting.push(acknowledging.waiting.length);
run(5);
const asked = (touch) => touch.input === "level_1.high_high.acknowledge";
answer([waiting, rig.run.touches.filter(asked)]);
""")
    assert waiting == [1, 0]
    assert [(touch["sample"], touch["value"]) for touch in touches] == [(60, 1), (61, 0)]


def test_what_latches_holds_the_pump_until_it_is_acknowledged(rig, found):
    seen, session = found("""
const seen = [];
const see = () => seen.push([acknowledging.state(lowLow), rig.value("pump_1.interlock"), held()]);
empty();
run(200);
see();
full();
run(30);
see();
acknowledging.press(lowLow);
run(1);
see();
answer([seen, session()]);
""")
    assert seen == [
        [UNACKNOWLEDGED, 1, "LL of level_1"], [RETURNED, 1, "LL of level_1"], [NORMAL, 0, ""],
    ]  # fmt: skip
    held = again(rig, session).values["pump_1.interlock"]
    assert held[-2:].tolist() == [1, 0]


def test_what_comes_over_and_over_is_one_line(rig, found):
    before, lines, acknowledged, after, session = found("""
rig.touch("level_1.setpoint", 0.16);
run(600);
const before = timesOf(highHigh);
const told = lines();
const first = session();
acknowledging.press(highHigh);
run(1);
const acknowledged = lines()[0];
run(40);
answer([before, told, acknowledged, timesOf(highHigh), first]);
""")
    run = again(rig, session)
    high_high = run.as_dict()["alarms"][0]
    came, _, times = before
    assert times == high_high["count"] > 10
    period = rig.process.sampling_period
    assert came * period == high_high["came"][-1]
    words = "high-high alarm of level_1 at 15 cm"
    of_alarm = sorted(line for line in lines if line[0].startswith("high-high"))
    returned = len(high_high["returned"])
    assert of_alarm == [[words, True, times], [f"{words} returned to normal", False, returned]]
    assert acknowledged == [f"{words} acknowledged", False, 1]
    # Counted anew since it was acknowledged.
    assert 1 <= after[2] < 6


def test_who_goes_back_finds_alarms_as_they_were(found):
    states, times, runs = found("""
full();
run(60);
acknowledging.press(highHigh);
run(9);
const seen = [acknowledging.state(highHigh)];
const at = [timesOf(highHigh)];
rig.goTo(50);
seen.push(acknowledging.state(highHigh));
at.push(timesOf(highHigh));
run(20);
seen.push(acknowledging.state(highHigh));
answer([seen, at, rig.runs.length]);
""")
    assert states == [ACKNOWLEDGED, UNACKNOWLEDGED, UNACKNOWLEDGED]
    assert times[0] == times[1]
    assert runs == 2


def test_an_alarm_in_the_first_sample_of_a_run_is_told(found):
    lines, times = found("""
rig.reset("empty");
rig.touch("pump_1.mode", 0);
rig.touch("pump_1.manual", 0);
run(4);
answer([lines().map(([words]) => words), timesOf(lowLow)]);
""")
    assert "low-low alarm of level_1 at 2 cm" in lines
    assert times == [3, None, 1]
