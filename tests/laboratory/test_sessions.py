"""What hands do in the page is done again in Python, in every bit."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from page_in_node import answered, source

import clepsydra as cl
from clepsydra.laboratory.packed_data import packed_data
from clepsydra.laboratory.page_data import FORM, page_data
from clepsydra.laboratory.page_file import numbers_of_page
from clepsydra.laboratory.replay import replayed
from clepsydra.laboratory.rig import Rig
from clepsydra.laboratory.session import session_of

DEAD_TIME = Path(__file__).parents[1] / "dead-time.toml"
SCRIPT = f"""
import {{ unpacked }} from "{source("live/bytes.ts")}";
import {{ Rig }} from "{source("lab/rig.ts")}";
const modules = await Promise.all(
  given.data.modules.map(async (text) => WebAssembly.compile(await unpacked(text))));
const rig = new Rig(given.data, modules);
const lay = ([what, ...how]) => rig[what](...how);
const shown = () => [...given.data.controlled, ...given.data.inputs].map((name) => rig.value(name));
const found = () => ({{
  session: JSON.parse(JSON.stringify(rig.session())), state: rig.state(), shown: shown(),
  spills: rig.spills(),
}});
answer(given.sessions.map(({{ start, samples, hands, scrubs }}) => {{
  rig.choose(0);
  rig.noise(false);
  rig.reset(start);
  for (let sample = 0; sample < samples; ++sample) {{
    for (const hand of hands[sample] ?? []) lay(hand);
    rig.step();
  }}
  const runs = [found()];
  for (const {{ to, hands, samples }} of scrubs) {{
    rig.goTo(to);
    for (const hand of hands) lay(hand);
    for (let sample = 0; sample < samples; ++sample) rig.step();
    runs.push(found());
  }}
  // Who looks back and forth sees the same, and a run that was saved computes it anew.
  const {{ session, state }} = runs.at(-1);
  rig.goTo(1);
  rig.goTo(session.samples);
  const again = [rig.state()];
  rig.load(session, "again");
  while (rig.due) rig.catchUp(100);
  again.push(rig.state());
  return {{ runs, again: again.map((each) => JSON.stringify(each) === JSON.stringify(state)) }};
}}));
"""
CASES = [
    ("quadruple-tank", ("simc", "amigo")),
    ("quadruple-tank", ("lqi_kalman", "simc")),
    ("equalisation-tank", ("simc", "arrest_time")),
    ("laboratory-four-tanks", ("simc", "amigo", "lambda_")),
    (DEAD_TIME, ("simc", "smith_predictor")),
    (DEAD_TIME.with_name("alarmed-tank.toml"), ("simc", "lqi_kalman")),
    (
        f"{DEAD_TIME.parents[1] / 'docs' / 'examples' / 'analyser.toml'}:seldom",
        ("simc", "lqi_kalman"),
    ),
]


def random_hand(rig, random):
    """Return a hand as the page lays it on: a method of the rig, and what it is told."""
    process, number = rig.process, int(random.integers(0, len(rig.stations)))
    y = process.signal(str(random.choice(process.controlled)))
    u = process.signal(random.choice([u.name for u in process.inputs]))
    m = process.signal(random.choice([m.name for m in process.measurements]))
    tank = rig.tanks[int(random.integers(0, len(rig.tanks)))]
    match int(random.integers(0, 16)):
        case 0:
            return "touch", f"{y.name}.setpoint", random.uniform(y.low, y.high)
        case 1:
            return "touch", f"{u.name}.mode", float(random.integers(0, 2))
        case 2 if rig.point.process.disturbances:
            d = random.choice([d.name for d in rig.point.process.disturbances])
            return "touch", d, rig.inputs[d] * random.uniform(0.5, 1.5)
        case 3 | 4:
            return "choose", number, str(random.choice(["bumpless", "settled", "zero"]))
        case 5:
            return "noise", bool(random.integers(0, 2))
        case 6:
            return "drift", m.name, random.uniform(-1e-3, 1e-3) * m.span
        case 7:
            return "touch", f"{m.name}.forced", float(random.integers(0, 2))
        case 8:
            return "touch", f"{m.name}.reading", random.uniform(m.low, 1.2 * m.high)
        case 9:
            return "touch", f"{u.name}.stopped", float(random.integers(0, 2))
        case 10:
            return "touch", f"{u.name}.stiction", random.uniform(0.0, 0.3) * u.span
        case 11:
            area = tank.area * float(random.integers(0, 2))
            return "parameters", {tank.extra_outlet: area}
        case 12:
            return "touch", tank.pour, tank.full * random.uniform(0.0, 0.1)
        case 13:
            station = rig.stations[number]
            name = str(random.choice(station.settings))
            return (
                "settings",
                number,
                {name: station.numbers.parameters[name] * random.uniform(0.9, 1.1)},
            )
        case 14 | 15 if process.alarms:
            alarm = process.alarms[int(random.integers(0, len(process.alarms)))]
            return "touch", f"{alarm.name}.acknowledge", float(random.integers(0, 2))
        case _:
            return "touch", f"{u.name}.manual", random.uniform(u.low, u.high)


def hands_on(rig, random, samples, count=16):
    """Return random hands by the sample before which they are laid on."""
    found = {}
    for sample in random.integers(0, samples, count).tolist():
        found.setdefault(sample, []).append(random_hand(rig, random))
    return found


def scrubs_of(rig, random, samples):
    """Return moments to go back to, what is done there, and how it goes on."""
    found = []
    for _ in range(2):
        to = int(random.integers(1, samples))
        hands = [random_hand(rig, random) for _ in range(3)]
        found.append({"to": to, "hands": hands, "samples": int(random.integers(20, 200))})
        samples = to + found[-1]["samples"]
    return found


@pytest.mark.parametrize(("process", "designs"), CASES)
def test_a_session_is_run_again_in_every_bit(process, designs, tmp_path):
    plant = cl.load(process)
    rig = Rig(plant.linear, [getattr(cl.design, design)(plant) for design in designs])
    random = np.random.default_rng(len(designs[0]))
    sessions = [
        {
            "start": start, "samples": samples, "hands": hands_on(rig, random, samples),
            "scrubs": scrubs_of(rig, random, samples),
        }
        for start, samples in zip(["rest", "empty"] * 10, random.integers(200, 1500, 20).tolist(),
                                  strict=True)
    ]  # fmt: skip
    given = {"data": page_data(rig), "sessions": sessions}
    for found in answered(SCRIPT, given, tmp_path):
        assert found["again"] == [True, True]
        for each in found["runs"]:
            run = replayed(rig, session_of(each["session"], "session"), "session")
            assert each["session"]["touches"]
            assert list(run.state.values()) == each["state"]
            names = (*rig.process.controlled, *(u.name for u in rig.process.inputs))
            assert [float(run.values[name][-1]) for name in names] == each["shown"]
            assert all(np.isfinite(list(run.levels.values())))


def test_a_session_runs_with_the_numbers_of_its_page(tmp_path):
    """As where a controller was tuned on another machine, in other last digits."""
    plant = cl.load(DEAD_TIME)
    here, there = cl.design.smith_predictor(plant), cl.design.simc(plant)
    moved = {name: value * (1 - 1e-15) for name, value in there.values.items()}
    elsewhere = Rig(plant.linear, [here, replace(there, values=moved)])
    data = page_data(elsewhere)
    page = tmp_path / "lab.html"
    text = f'<script type="application/json" id="data">{json.dumps(packed_data(data, []))}</script>'
    page.write_text(text, encoding="utf-8")
    session = {key: data[key] for key in ("form", "version", "digest", "process", "seed")}
    session |= {"controllers": [here.name, there.name], "start": "empty", "samples": 500}
    session["touches"] = [{"sample": 9, "controller": there.name, "start": "bumpless"}]
    found = session_of(session, "session")
    with pytest.raises(cl.InputError, match="give the page too"):
        replayed(Rig(plant.linear, [here, there]), found, "session")
    rig = Rig(plant.linear, [here, there], numbers_of_page(page))
    run, own = (replayed(each, found, "session") for each in (rig, elsewhere))
    assert run.state == own.state
    assert run.scores == own.scores


def test_spills_are_counted(tmp_path):
    plant = cl.load("equalisation-tank")
    rig = Rig(plant.linear, [cl.design.simc(plant)])
    hands = {
        0: [("touch", "outflow.manual", 0.0), ("touch", "outflow.mode", 0.0)],
        300: [("touch", "outflow.mode", 1.0)],
        500: [("touch", "outflow.mode", 0.0)],
    }
    sessions = [{"start": "rest", "samples": 800, "hands": hands, "scrubs": []}]
    (answer,) = answered(SCRIPT, {"data": page_data(rig), "sessions": sessions}, tmp_path)
    (found,) = answer["runs"]
    run = replayed(rig, session_of(found["session"], "session"), "session")
    spilt = run.values["basin.spilt"]
    starts = np.flatnonzero(np.diff(np.diff(spilt, prepend=0.0) > 0.0, prepend=False))
    (told,) = found["spills"]
    assert told == {"tank": "basin", "times": (len(starts) + 1) // 2, "total": spilt[-1]}
    assert told["times"] == 2


def test_a_regulator_with_new_numbers_takes_over_where_the_process_stands():
    """Away from rest, with every error at zero, its outputs stay where they are."""
    plant = cl.load("quadruple-tank")
    one = np.eye(2)
    regulator = cl.design.regulator(plant, (0.0 * one, one, 0.02 * one, 1.5 * one))
    rig = Rig(plant.linear, [cl.design.simc(plant), regulator])
    name = regulator.name
    gain = next(each for each in rig.stations[1].settings if each.endswith("error_gain.level_1"))
    value = 1.2 * rig.stations[1].numbers.parameters[gain]
    touches = [
        {"sample": 0, "input": "level_1.setpoint", "value": 6.6},
        {"sample": 4000, "settings": {gain: value}, "of": name},
        {"sample": 4000, "controller": name, "start": "settled"},
    ]
    session = {
        "form": FORM, "version": cl.__version__, "digest": rig.digest, "process": plant.name,
        "controllers": [each.name for each in rig.controllers], "start": "rest",
        "samples": 4400, "seed": 1, "touches": touches,
    }  # fmt: skip
    run = replayed(rig, session_of(session, "session"), "session")
    for u in ("pump_1", "pump_2"):
        before, after = run.values[u][3999], run.values[u][4000:]
        assert abs(before - plant.point.as_dict()[u]) > 0.05
        assert np.abs(after - before).max() < 1e-5
