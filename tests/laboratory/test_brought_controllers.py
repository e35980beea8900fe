"""Controllers that a reader brings: their numbers are touches, and their sessions run again."""

import numpy as np
import pytest
from page_in_node import answered, source

import clepsydra as cl
from clepsydra.laboratory.free_laws import LoadedMatrices, TypedLoops
from clepsydra.laboratory.page_data import page_data
from clepsydra.laboratory.replay import replayed
from clepsydra.laboratory.rig import Rig
from clepsydra.laboratory.session import session_of

SCRIPT = f"""
import {{ unpacked }} from "{source("live/bytes.ts")}";
import {{ Rig }} from "{source("lab/rig.ts")}";
const modules = await Promise.all(
  given.data.modules.map(async (text) => WebAssembly.compile(await unpacked(text))));
answer(given.cases.map(({{ controller, settings, start, setpoint }}) => {{
  const rig = new Rig(given.data, modules);
  for (let sample = 0; sample < 50; ++sample) rig.step();
  rig.touch(...setpoint);
  for (let sample = 0; sample < 20; ++sample) rig.step();
  rig.settings(controller, settings);
  if (start === "bumpless") rig.step();
  const before = given.data.inputs.map((name) => rig.value(name));
  rig.choose(controller, start);
  rig.step();
  const after = given.data.inputs.map((name) => rig.value(name));
  for (let sample = 0; sample < 300; ++sample) rig.step();
  const session = JSON.parse(JSON.stringify(rig.session()));
  return {{ session, state: rig.state(), before, after }};
}}));
"""
#: PI control of both levels, K = 3 and 2.7, Ti = 30 and 40 s, as four matrices [V/V].
PI = np.zeros((2, 2)), np.diag([0.1, 0.0675]), np.eye(2), np.diag([3.0, 2.7])


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


@pytest.fixture(scope="module")
def rig(plant):
    return Rig(plant.linear, [cl.design.simc(plant)])


def settings_of(rig, place, values):
    names = rig.stations[place].settings
    return {
        f"controller.{name}": value
        for name, value in values.items()
        if f"controller.{name}" in names
    }


def test_what_is_brought_runs_again_in_every_bit_and_takes_over_without_a_bump(
    plant, rig, tmp_path
):
    free = list(enumerate(rig.free, len(rig.controllers)))
    told = cl.design.regulator(plant, PI).values
    deaf = cl.design.regulator(plant, PI, anti_windup="none").values
    cases = [
        {"controller": place, "settings": settings_of(rig, place, values), "start": start}
        for (place, each), (values, start) in zip(
            [pair for pair in free if isinstance(pair[1], LoadedMatrices)],
            [(told, "bumpless"), (deaf, "zero")],
            strict=True,
        )
    ]
    gains = {"proportional_gain": 2.0, "integral_time": 25.0, "integral_gain": 0.08}
    cases += [
        {
            "controller": place, "start": "bumpless",
            "settings": settings_of(rig, place, {
                f"{y}.{part}": value
                for y in ("level_1", "level_2") for part, value in gains.items()
            }),
        }
        for place, each in free if isinstance(each, TypedLoops)
    ]  # fmt: skip
    cases = [each | {"setpoint": ["level_1.setpoint", 6.5]} for each in cases]
    found = answered(SCRIPT, {"data": page_data(rig), "cases": cases}, tmp_path)
    for case, each in zip(cases, found, strict=True):
        assert each["session"]["controllers"] == ["PI, SIMC"]
        run = replayed(rig, session_of(each["session"], "session"), "session")
        assert list(run.state.values()) == each["state"]
        moved = np.abs(np.array(each["after"]) - each["before"]).max()
        if case["start"] == "bumpless":
            assert moved < 0.05
        else:
            # As in the course's app: its integrals begin at zero, wherever the pumps stand.
            assert moved > 0.2


def test_loaded_matrices_do_what_the_design_does(plant, rig):
    """The law with room for twelve states, filled, is the regulator with its two."""
    controller = cl.design.regulator(plant, PI)
    (loaded, _) = [each.controller for each in rig.free if isinstance(each, LoadedMatrices)]
    values = loaded.values | {
        name: value for name, value in controller.values.items() if name in loaded.values
    }
    assert set(controller.values) <= set(loaded.values)
    draw, found = np.random.default_rng(3), {}
    errors = 0.1 * draw.normal(size=(100, 2))
    for name, law, numbers, start in (
        ("own", controller.law, controller.values, controller.initial_state),
        ("loaded", loaded.law, values, loaded.initial_state),
    ):
        state, rows = [start[entry.name] for entry in law.state], []
        for error in errors:
            given = {"level_1.sp": error[0], "level_2.sp": error[1]}
            usual = {"mode": 1, "good": 1, "time_step": 1}
            inputs = [given.get(each.name, usual.get(each.part, 0.0)) for each in law.inputs]
            state, out, _ = law.function(state, inputs, [numbers[p.name] for p in law.parameters])
            state = np.array(state).ravel().tolist()
            named = dict(
                zip((each.name for each in law.outputs), np.array(out).ravel(), strict=True)
            )
            rows.append([named["pump_1.out"], named["pump_2.out"]])
        found[name] = np.array(rows)
    assert np.ptp(found["own"]) > 0.5
    # Additions of zeros change the order of sums, and no digit that counts.
    assert found["loaded"] == pytest.approx(found["own"], abs=1e-12)


def test_a_pairing_is_there_for_every_input_and_what_cannot_be_is_left_out(rig):
    pairs = {each.pairs for each in rig.free if isinstance(each, TypedLoops)}
    straight = (("level_1", "pump_1"), ("level_2", "pump_2"))
    assert pairs == {straight, (("level_1", "pump_2"), ("level_2", "pump_1"))}
    first = next(iter(rig.free))
    assert isinstance(first, TypedLoops) and first.pairs == straight
