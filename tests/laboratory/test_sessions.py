"""What hands do in the page is done again in Python, in every bit."""

from pathlib import Path

import numpy as np
import pytest
from page_in_node import answered, source

import clepsydra as cl
from clepsydra.laboratory.page_data import page_data
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
answer(given.sessions.map(({{ start, samples, hands }}) => {{
  rig.choose(0);
  rig.noise(false);
  rig.reset(start);
  for (let sample = 0; sample < samples; ++sample) {{
    for (const hand of hands.filter((each) => each.sample === sample))
      if (hand.noise !== undefined) rig.noise(hand.noise);
      else if (hand.controller === undefined) rig.touch(hand.input, hand.value);
      else rig.choose(hand.controller);
    rig.step();
  }}
  const shown = [...given.data.controlled, ...given.data.inputs].map((name) => rig.value(name));
  const session = JSON.parse(JSON.stringify(rig.session()));
  return {{ session, state: rig.state(), shown, spills: rig.spills() }};
}}));
"""
CASES = [
    ("quadruple-tank", ("simc", "amigo")),
    ("quadruple-tank", ("lqi_kalman", "simc")),
    ("equalisation-tank", ("simc", "arrest_time")),
    (DEAD_TIME, ("simc", "smith_predictor")),
]


def hands_on(rig, random, samples, count=12):
    """Return random hands: setpoints, modes, manual values, loads, a sensor, and takeovers."""
    process, found = rig.process, []
    for sample in sorted(random.integers(0, samples, count).tolist()):
        hand = {"sample": sample}
        match int(random.integers(0, 6)):
            case 0 if len(process.controlled):
                y = process.signal(str(random.choice(process.controlled)))
                hand |= {"input": f"{y.name}.setpoint", "value": random.uniform(y.low, y.high)}
            case 1:
                u = random.choice([u.name for u in process.inputs])
                hand |= {"input": f"{u}.mode", "value": float(random.integers(0, 2))}
            case 2 if len(process.disturbances):
                d = process.signal(random.choice([d.name for d in process.disturbances]))
                at = rig.stations[0].at_rest[d.name]
                hand |= {"input": d.name, "value": at * random.uniform(0.5, 1.5)}
            case 3:
                hand |= {"controller": int(random.integers(0, len(rig.stations)))}
            case 4:
                hand |= {"noise": bool(random.integers(0, 2))}
            case _:
                u = process.signal(random.choice([u.name for u in process.inputs]))
                hand |= {"input": f"{u.name}.manual", "value": random.uniform(u.low, u.high)}
        found.append(hand)
    return found


@pytest.mark.parametrize(("process", "designs"), CASES)
def test_a_session_is_run_again_in_every_bit(process, designs, tmp_path):
    plant = cl.load(process)
    rig = Rig(plant.linear, [getattr(cl.design, design)(plant) for design in designs])
    random = np.random.default_rng(len(designs[0]))
    sessions = [
        {"start": start, "samples": samples, "hands": hands_on(rig, random, samples)}
        for start, samples in zip(["rest", "empty"] * 5, random.integers(200, 600, 10).tolist(),
                                  strict=True)
    ]  # fmt: skip
    given = {"data": page_data(rig), "sessions": sessions}
    for found in answered(SCRIPT, given, tmp_path):
        run = replayed(rig, session_of(found["session"], "session"), "session")
        assert found["session"]["touches"]
        assert list(run.state.values()) == found["state"]
        names = (*rig.process.controlled, *(u.name for u in rig.process.inputs))
        assert [float(run.values[name][-1]) for name in names] == found["shown"]
        assert all(np.isfinite(list(run.levels.values())))


def test_spills_are_counted(tmp_path):
    plant = cl.load("equalisation-tank")
    rig = Rig(plant.linear, [cl.design.simc(plant)])
    hands = [
        {"sample": sample, "input": f"outflow.{what}", "value": value}
        for sample, what, value in [
            (0, "manual", 0.0), (0, "mode", 0.0), (300, "mode", 1.0), (500, "mode", 0.0),
        ]
    ]  # fmt: skip
    sessions = [{"start": "rest", "samples": 800, "hands": hands}]
    (found,) = answered(SCRIPT, {"data": page_data(rig), "sessions": sessions}, tmp_path)
    run = replayed(rig, session_of(found["session"], "session"), "session")
    spilt = run.values["basin.spilt"]
    starts = np.flatnonzero(np.diff(np.diff(spilt, prepend=0.0) > 0.0, prepend=False))
    (told,) = found["spills"]
    assert told == {"tank": "basin", "times": (len(starts) + 1) // 2, "total": spilt[-1]}
    assert told["times"] == 2
