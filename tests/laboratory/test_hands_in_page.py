"""What the panel of hands does to the rig, and what the log tells of it."""

import pytest
from page_in_node import answered, source

import clepsydra as cl
from clepsydra.laboratory.page_data import page_data
from clepsydra.laboratory.rig import Rig

SCRIPT = f"""
import {{ unpacked }} from "{source("live/bytes.ts")}";
import * as faults from "{source("lab/faults.ts")}";
import {{ Log }} from "{source("lab/log.ts")}";
import {{ Pours }} from "{source("lab/pours.ts")}";
import {{ Rig }} from "{source("lab/rig.ts")}";
const {{ actuatorFault, breakActuator, breakSensor, sensorFault }} = faults;
const {{ data }} = given;
const modules = await Promise.all(
  data.modules.map(async (text) => WebAssembly.compile(await unpacked(text))));
const rig = new Rig(data, modules);
const pours = new Pours(rig);
const log = new Log(data, (name) => name);
const signal = (name) => data.signals.find((each) => each.name === name);
const tank = (name) => data.tanks.find((each) => each.tank === name);
const run = (samples) => {{
  for (let sample = 0; sample < samples; ++sample) {{
    pours.step();
    rig.step();
  }}
}};
const lines = () => {{
  log.read(rig.run, rig.sample);
  return log.latest.map((each) => {{
    const {{ words, isAbnormal, first, sample, times }} = each;
    return [words, isAbnormal, first, sample, times];
  }});
}};
"""


def lab(name):
    plant = cl.load(name)
    return {"data": page_data(Rig(plant.linear, [cl.design.simc(plant), cl.design.amigo(plant)]))}


@pytest.fixture(scope="module")
def tanks():
    return lab("laboratory-four-tanks")


def poured(touches, period):
    """Return the time [s] for which water was poured."""
    times = [(touch["sample"], touch["value"] > 0) for touch in touches if "input" in touch]
    (begins, is_on), (ends, is_off) = times
    assert (is_on, is_off) == (True, False)
    return (ends - begins) * period


@pytest.mark.parametrize(
    ("hand", "seconds"),
    [
        ("pours.press(one); pours.release(one); run(50)", 1.0),
        ("pours.press(one); run(50); pours.release(one); run(50)", 2.5),
        # Another click ends it.
        ("pours.press(one); pours.release(one); run(8); pours.press(one); run(9)", 0.4),
        # Who goes back into a quarter and on from there still gets one that ends.
        ("pours.press(one); pours.release(one); run(40); rig.goTo(9); run(60)", 1.2),
    ],
)
def test_a_click_pours_a_quarter_and_a_hand_that_holds_pours_on(tanks, hand, seconds, tmp_path):
    script = f"""{SCRIPT}
const one = tank("tank_1");
run(5);
{hand}
answer(rig.run.touches);
"""
    touches = answered(script, tanks, tmp_path)
    assert poured(touches, 0.05) == pytest.approx(seconds)


def test_faults_are_told_as_they_were_made_and_end(tanks, tmp_path):
    script = f"""{SCRIPT}
const level = signal("level_1"), pump = signal("pump_1");
const found = [];
rig.touch("level_1.setpoint", 0.6);
run(3);
for (const fault of ["stuck", "drifting", "out of range", "dead", "OK"]) {{
  breakSensor(rig, level, fault);
  const asked = sensorFault(rig, level);
  run(200);
  found.push([asked, sensorFault(rig, level), rig.value("level_1"), rig.value("level_1.true")]);
}}
for (const fault of ["stopped", "stuck", "sticking", "OK"]) {{
  breakActuator(rig, pump, fault);
  run(50);
  found.push([fault, actuatorFault(rig, pump), rig.value("pump_1"), rig.value("pump_1.applied")]);
}}
answer(found);
"""
    found = answered(script, tanks, tmp_path)
    assert all(asked == told for asked, told, *_ in found)
    stuck, drifting, beyond, dead, sound = found[:5]
    assert abs(stuck[2] - stuck[3]) > 1e-9
    # A tenth of its range in 1000 samples.
    assert drifting[2] - drifting[3] == pytest.approx(0.1 * 1.2 * 0.199, rel=1e-9)
    assert beyond[2] == pytest.approx(1.05 * 1.2)
    assert dead[2] == 0.0
    assert sound[2] == pytest.approx(sound[3], abs=1e-12)
    stopped, held, *_, free = found[5:]
    assert stopped[3] == 0.0 < stopped[2]
    assert held[3] != held[2]
    assert free[3] == free[2]


def test_the_log_tells_hands_and_what_happened_with_its_times(tanks, tmp_path):
    script = f"""{SCRIPT}
run(4);
for (let turn = 0; turn < 9; ++turn) {{
  rig.touch("level_1.setpoint", 0.5 + 0.01 * turn);
  run(1);
}}
rig.touch("pump_1.manual", 1.0);
rig.touch("pump_1.mode", 0);
rig.parameters({{ "outlet_4.area": 0 }});
rig.choose(1);
run(6000);
rig.parameters({{ "extra_outlet_of_tank_4.area": tank("tank_4").area }});
const before = lines();
run(2000);
const after = lines();
rig.goTo(8);
const back = lines();
run(1);
answer([before, after, back, lines()]);
"""
    before, after, back, branch = answered(script, tanks, tmp_path)
    words = {words: times for words, *_, times in before}
    assert words["setpoint of level_1 to 58.0 %"] == 1
    assert words["pump_1 by hand to 100.0 %"] == words["pump_1 to manual"] == 1
    assert words["outlet_4 plugged"] == words["PI, AMIGO is now in control"] == 1
    trips = {words: (abnormal, times) for words, abnormal, *_, times in before if "trips" in words}
    assert trips["pump_1 trips: tank_4 above 27.5 cm"] == (True, 1)
    assert "extra outlet of tank_4 opened" not in words
    assert "extra outlet of tank_4 opened" in {words for words, *_ in after}
    firsts = [first for _, _, first, *_ in after]
    assert firsts == sorted(firsts, reverse=True)
    assert back == branch == [["setpoint of level_1 to 53.0 %", False, 4, 7, 1]]


def test_what_a_tank_does_over_and_over_is_one_line(tmp_path):
    script = f"""{SCRIPT}
for (let turn = 0; turn < 3; ++turn) {{
  rig.touch("outflow.mode", 0);
  rig.touch("outflow.manual", 0);
  run(400);
  rig.touch("outflow.manual", 1);
  run(2500);
}}
answer(lines());
"""
    plant = cl.load("equalisation-tank")
    given = {"data": page_data(Rig(plant.linear, [cl.design.simc(plant)]))}
    found = [(words, times) for words, *_, times in answered(script, given, tmp_path)]
    # A hand is between one time and the next.
    assert found.count(("basin spills", 1)) == found.count(("basin is full", 1)) == 3
    dry = [times for words, times in found if words.startswith("outflow runs dry")]
    assert len(dry) == 3
    assert max(dry) > 1


def test_a_trip_that_comes_again_and_again_is_told_all_the_while(tmp_path):
    """It stands for the time between two trips, twice, and for no longer; one alone does not."""
    script = f"""
import {{ TripTimes }} from "{source("lab/trips.ts")}";
const trip = (sample) => ({{ sample, kind: "event", of: "pump_1.trips.1.count" }});
const other = {{ sample: 5, kind: "level", of: "tank_1" }};
const run = {{ happened: [other, ...[100, 110, 120, 5000].map(trip)] }};
const times = new TripTimes({{ inputs: ["pump_1"] }});
answer(given.samples.map((sample) => (times.read(run, sample), times.repeated("pump_1"))));
"""
    samples = [90, 101, 105, 111, 115, 121, 140, 141, 5001, 112]
    found = answered(script, {"samples": samples}, tmp_path)
    assert found == [0, 0, 0, 2, 2, 3, 3, 0, 0, 2]
