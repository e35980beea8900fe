"""A user's own step law, as its documentation shows it: Python beside expressions, and faults."""

from pathlib import Path

import numpy as np
import pytest
from pages import blocks
from refusals import refused

import clepsydra as cl
from clepsydra import ClepsydraError, InputError, PythonLaw, Signal, StepLaw, load_law, python_law
from clepsydra.controllers.controller import Controller
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario

SLOW, USE, FAST = (block.text for block in blocks("docs/own-law.md", "python"))
WIRES = {"measurements": ["level_1"], "setpoints": ["level_1"], "manipulated": ["pump_1"]}


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("my_pi.py").write_text(SLOW, encoding="utf-8")
    Path("my_fast_pi.py").write_text(FAST, encoding="utf-8")


def loaded(text: str) -> StepLaw:
    Path("law.py").write_text(text, encoding="utf-8")
    return load_law("law.py")


def pi_control(plant: cl.Plant, file: str, gain: float = 2.0) -> cl.Controller:
    return cl.design.own(
        plant, load_law(file), **WIRES, values={"gain": gain}, initial_state={"integral": 3.0}
    )


def loop_of(controller: cl.Controller) -> Loop:
    return Loop(controller, controller.plant.linear)


def hard_scenario(plant: cl.Plant) -> Scenario:
    """Setpoint steps up to 9.5 V and down to 2 V, with noise: the pump goes to both limits."""
    point = plant.point
    setpoints = np.tile(point.measurements[:2], (400, 1))
    setpoints[20:, 0], setpoints[200:, 0] = 9.5, 2.0
    noise = 0.05 * np.random.default_rng(4).normal(size=(400, 4))
    disturbances = np.tile(point.disturbances, (400, 1))
    return Scenario(point.process.sampling_period, setpoints, disturbances, noise, (), 4)


@pytest.mark.thorough
def test_the_documented_use_runs() -> None:
    names: dict = {}
    exec(USE, names)
    level = names["run"].true_measurement("level_1")
    assert level[659] - level[0] == pytest.approx(1.0, abs=1e-9)


def test_python_and_expressions_agree_in_every_bit(plant) -> None:
    scenario = hard_scenario(plant)
    slow, fast = (
        loop_of(pi_control(plant, file)).run(scenario) for file in ("my_pi.py", "my_fast_pi.py")
    )
    assert isinstance(slow.controller.law, PythonLaw)
    assert not isinstance(fast.controller.law, PythonLaw)
    assert {4.0, 8.0} <= {float(int(s) & 12) for s in fast.values["pump_1.status"]}
    for name, values in fast.values.items():
        np.testing.assert_array_equal(slow.values[name], values, err_msg=name)


@pytest.mark.thorough
def test_the_reference_solver_takes_a_law_in_python(plant) -> None:
    scenario = hard_scenario(plant)
    loop = loop_of(pi_control(plant, "my_pi.py"))
    kernel, reference = loop.run(scenario, substeps=20), loop.run(scenario, solver="reference")
    found = reference.values["tank_1.level"] - kernel.values["tank_1.level"]
    assert np.abs(found).max() < 1e-8  # [m]


def beginnings(whole: Scenario, disturbances: tuple[Signal, ...]) -> Scenario:
    """A short rest and 250 samples of each segment, the loads as large as they can be.

    What differs between the loops would differ after each step, and Python takes its time.
    """
    starts = [round(segment.start / whole.sampling_period) for segment in whole.segments]
    kept = np.concatenate([np.arange(20), *(start + np.arange(250) for start in starts)])
    loads, rest = whole.disturbances[kept], whole.disturbances[0]
    for place, signal in enumerate(disturbances):
        loads[loads[:, place] != rest[place], place] = signal.high
    return Scenario(
        whole.sampling_period, whole.setpoints[kept], loads, whole.noise[kept], (), whole.seed
    )


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "pump"), [("equalisation-tank", "outflow"), ("wet-well", "duty"), ("rig", "pump_1")]
)
def test_every_kind_of_process_is_moved_as_by_the_compiled_loop(name, pump) -> None:
    """Switches, lags, components and a transport delay, whose ring lives between the calls."""
    if name == "rig":
        name = str(Path(__file__).parents[1] / "dead-time.toml")
    plant = cl.load(name)
    process = plant.process
    level = process.controlled[0]
    pump = pump if pump in [u.name for u in process.inputs] else process.inputs[0].name
    size = 0.02 * process.signal(level).span
    at = plant.point.as_dict()[pump]
    span = process.signal(pump).span
    loops = []
    for text in (_PROPORTIONAL, _FAST_PROPORTIONAL):
        controller = cl.design.own(
            plant, loaded(text), measurements=[level], setpoints=[level],
            manipulated=[pump], values={"gain": -0.1 * span / size, "bias": at},
        )  # fmt: skip
        loops.append(loop_of(controller))
    scenario = beginnings(default_scenario(plant.linear), process.disturbances)
    slow, fast = (loop.run(scenario) for loop in loops)
    assert np.ptp(fast.values[pump]) > 0.05 * span
    if name == "wet-well":
        assert set(fast.values["standby.runs"]) == {0.0, 1.0}  # its switch acts
    for trajectory, values in fast.values.items():
        np.testing.assert_array_equal(slow.values[trajectory], values, err_msg=trajectory)


_PROPORTIONAL = """
inputs = ["level_1.sp", "level_1.pv"]
outputs = ["pump_1.out"]
parameters = {"gain": 1.0, "bias": 0.0}
def step(state, inputs, parameters, time_step):
    error = inputs["level_1.sp"] - inputs["level_1.pv"]
    return {}, {"pump_1.out": parameters["bias"] + parameters["gain"] * error}
"""
_FAST_PROPORTIONAL = """
from clepsydra import Signal
from clepsydra.program.step_law import Equations, step_law
law = step_law(
    "proportional", inputs=[Signal("level_1.sp"), Signal("level_1.pv")], state=[],
    parameters=[Signal("gain"), Signal("bias")], outputs=[Signal("pump_1.out")],
    equations=lambda s: Equations(
        {}, {"pump_1.out": s["bias"] + s["gain"] * (s["level_1.sp"] - s["level_1.pv"])}),
)
"""


def test_the_sensitivity_by_differences_is_that_of_the_expressions(plant) -> None:
    files = "my_pi.py", "my_fast_pi.py"
    controllers = [pi_control(plant, file, gain=20.0) for file in files]
    peaks = [sampled_loop(each, plant.linear).maximum_sensitivity for each in controllers]
    assert 1.3 < peaks[1] < 3.0
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-8)


def test_modes_limits_and_a_failed_sensor(driven) -> None:
    law = load_law("my_pi.py")
    values = {
        "gain": 2.0,
        "integral_time": 30.0,
        "pump.low_limit": 0.0,
        "pump.high_limit": 10.0,
    }
    pi = driven(law, values, {"integral": 3.0, "pump.last_output": 3.0})
    usual = {
        "level.sp": 5.0,
        "level.pv": 4.0,
        "level.good": 1.0,
        "pump.mode": 1.0,
        "pump.manual": 7.0,
    }
    usual |= {"pump.tracking": 6.0, "time_step": 1.0}
    after = 3.0 + 2.0 / 30.0
    assert pi.scan(**usual) == {"pump.out": 2.0 + after, "pump.status": 1.0}
    assert pi.state["integral"] == after
    for fault in ({"level.good": 0.0}, {"level.pv": np.nan}, {"time_step": 0.0}):
        held = pi.scan(**(usual | fault))
        assert held["pump.out"] == 2.0 + after
        assert int(held["pump.status"]) in (1 + 16, 1 + 32, 1 + 64)
        assert pi.state["integral"] == after
    assert pi.scan(**(usual | {"pump.mode": 0.0}))["pump.out"] == 7.0
    assert pi.scan(**(usual | {"pump.mode": 2.0}))["pump.out"] == 6.0
    assert pi.scan(**(usual | {"level.sp": 50.0}))["pump.out"] == 10.0


def test_a_study_and_a_drawing_show_it_as_one_controller(plant, tmp_path) -> None:
    """Nothing looks into the function: both loops of it are one, and it cannot go to a plant."""
    law = loaded(
        "inputs = ['level_1.sp', 'level_1.pv', 'level_2.sp', 'level_2.pv']\n"
        "outputs = ['pump_1.out', 'pump_2.out']\n"
        "def step(state, inputs, parameters, time_step):\n"
        "    error = inputs['level_1.sp'] - inputs['level_1.pv']\n"
        "    return {}, {'pump_1.out': 3.0 + error, 'pump_2.out': 3.0}\n"
    )
    levels = ["level_1", "level_2"]
    mine = cl.design.own(
        plant, law, measurements=levels, setpoints=levels, manipulated=["pump_1", "pump_2"]
    )
    study = cl.study(plant, [mine], [cl.step("level_1", "0.5 V")], duration="3 min")
    lines = [part.text for part in study.answer().parts if hasattr(part, "text")]
    assert any("A law in Python is not exported" in line for line in lines)
    assert not any("clepsydra export" in line for line in lines)
    cl.draw(plant, tmp_path / "mine.svg", mine)
    drawn = (tmp_path / "mine.svg").read_text("utf-8")
    assert "UIC-101: moves pump_1 and pump_2" in drawn and "UIC-102" not in drawn


def test_a_class_keeps_its_tables_and_the_run_can_be_replayed(plant) -> None:
    law = loaded(
        "from clepsydra import Signal\n"
        "class law:\n"
        "    inputs = [Signal('level_1.pv', 'V', high=10.0)]\n"
        "    outputs = [Signal('pump_1.out', 'V')]\n"
        "    state = ['samples']\n"
        "    def __init__(self):\n"
        "        self.table = [3.0, 3.5, 2.5]\n"
        "    def step(self, state, inputs, parameters, time_step):\n"
        "        wanted = self.table[int(state['samples']) % 3]\n"
        "        state['samples'] += 1\n"
        "        return state, {'pump_1.out': wanted}\n"
    )
    controller = cl.design.own(
        plant, law, measurements=["level_1"], setpoints=[], manipulated=["pump_1"]
    )
    loop, scenario = loop_of(controller), hard_scenario(plant)
    first, second = loop.run(scenario), loop.run(scenario)
    assert first.values["pump_1"][:5].tolist() == [3.0, 3.5, 2.5, 3.0, 3.5]
    np.testing.assert_array_equal(first.values["level_1"], second.values["level_1"])


def test_what_python_cannot_do_is_refused(plant) -> None:
    controller = pi_control(plant, "my_pi.py")
    for use in (controller.program, lambda: closed_loop(plant.process, controller, substeps=1)):
        with pytest.raises(ClepsydraError, match="my_pi: a law in Python has no program"):
            use()
    with refused(value="my_pi, a law in Python", expected="a law of expressions"):
        cl.export(controller, plant)
    exported = cl.export(pi_control(plant, "my_fast_pi.py"), plant)
    assert "FUNCTION_BLOCK" in exported.files[0].read_text(encoding="utf-8")


HEAD = "inputs = ['level_1.pv']\noutputs = ['pump_1.out']\nstate = ['count']\n"
STEP = HEAD + "def step(state, inputs, parameters, time_step):\n    count = state['count'] + 1\n"


@pytest.mark.parametrize(
    ("end", "expected"),
    [
        (
            "    return {'count': count}, {'pump_1.out': 3 / (count - 8)}\n",
            "law.py, line 6, step, sample 7 at 7 s: got 'ZeroDivisionError: float division by "
            "zero', expected a step that works for every input; correct it.",
        ),
        (
            "    return {'count': count}, {'pump_1.out': 3 if count < 4 else float('nan')}\n",
            "law.py, line 4, step, pump_1.out, sample 3 at 3 s: got 'nan', expected a finite "
            "number; return one for every input.",
        ),
        (
            "    return {'count': count}, {'pump_1.out': '3'}\n",
            "law.py, line 4, step, pump_1.out, sample 0 at 0 s: got \"'3'\", expected a finite",
        ),
        (
            "    return {'pump_1.out': 3}\n",
            "law.py, line 4, step, sample 0 at 0 s: got \"{'pump_1.out': 3}\", expected the "
            "next state and the outputs, two dictionaries; write as in return",
        ),
        (
            "    return {}, {'pump_1.out': 3}\n",
            "law.py, line 4, step, next state, sample 0 at 0 s: got 'nothing', expected values "
            "for count; return each of them, and no other.",
        ),
        (
            "    return {'count': count}, {'pump_1.out': 3, 'pump_2.out': 3}\n",
            "law.py, line 4, step, outputs, sample 0 at 0 s: got 'pump_1.out, pump_2.out'",
        ),
        (
            "    return state['count'] + {}[0]\n",
            "law.py, line 6, step, sample 0 at 0 s: got 'KeyError: 0'",
        ),
    ],
)
@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_a_step_that_fails_names_line_sample_and_time(plant, end, expected, solver) -> None:
    controller = cl.design.own(
        plant, loaded(STEP + end), measurements=["level_1"], setpoints=[], manipulated=["pump_1"]
    )
    with pytest.raises(InputError) as caught:
        loop_of(controller).run(hard_scenario(plant), solver=solver)
    assert str(caught.value).startswith(expected)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("law = 3\n", "law.py, law: got '3', expected law = step_law(…), or a function step"),
        ("x = 1\n", "law.py: got no law, expected law = step_law(…), or a function step"),
        ("def step(:\n", "law.py, line 1: got 'SyntaxError: invalid syntax'"),
        ("import no_such_library\n", "law.py, line 1: got \"ModuleNotFoundError: No module named"),
        ("raise SystemExit(3)\n", "law.py, line 1: got 'SystemExit: 3', expected Python that runs"),
        (STEP + "outputs = ['pump_1']\n", "law.py, outputs: got 'pump_1', expected outputs like"),
        (STEP + "outputs = []\n", "law.py, outputs: got 'none', expected outputs like pump.out;"),
        (STEP + "inputs = 'level_1.pv'\n", "law.py, inputs: got \"'level_1.pv'\", expected"),
        (STEP + "parameters = {'gain': 'big'}\n", "law.py, parameters: got \"('gain', 'big')\""),
        (STEP + "parameters = ['count']\n", "law.py: got 'count', expected a name for one input"),
        (STEP + "state = ['a b']\n", "law.py, state: got 'a b', expected a list of names"),
        (STEP + "outputs = ['pump_1.out', 'pump_1.out']\n", "law.py: got 'pump_1.out', expected"),
        (STEP + "inputs = ['level_1.pv', 'level_1.pv']\n", "law.py: got 'level_1.pv', expected"),
        (STEP + "inputs = ['pump_1.out']\n", "law.py: got 'pump_1.out', expected a name for one"),
        (
            _FAST_PROPORTIONAL.replace('outputs=[Signal("pump_1.out")]',
                                       'outputs=[Signal("pump_1.out"), Signal("pump_2.status")]')
            .replace("{}, {", "{}, {'pump_2.status': 0, "),
            "law.py, outputs: got 'pump_1.out, pump_2.status', expected out and status of each",
        ),
        (
            _FAST_PROPORTIONAL.replace('"bias"]', '"no_bias"]'),
            "law.py, line 8: got \"KeyError: 'no_bias'\"",
        ),
        (
            "class law:\n    def __init__(self, table):\n        pass\n",
            "law.py, law: got \"TypeError: law.__init__() missing 1 required",
        ),
    ],
)  # fmt: skip
def test_a_file_without_a_proper_law_is_refused(text, expected) -> None:
    with pytest.raises(InputError) as caught:
        loaded(text)
    assert str(caught.value).startswith(expected)


@pytest.mark.parametrize(
    ("key", "given", "value", "expected"),
    [
        ("manipulated", ["pump_3"], "pump_3", "an input of quadruple-tank: pump_1, pump_2"),
        ("measurements", ["level_9"], "level_9", "a measurement of quadruple-tank: level_1"),
        ("measurements", ["pump_1"], "pump_1", "a measurement of quadruple-tank: level_1"),
        ("measurements", ["level_1", "level_2"], ["level_1", "level_2"], "1 names, one for each"),
        ("setpoints", ["level_3"], "level_3", "a controlled measurement of quadruple-tank: level"),
        ("setpoints", [], [], "1 names, one for each setpoint"),
        ("values", ["gain"], "a list", "names with their numbers"),
        ("initial_state", 3, 3, "names with their numbers"),
        ("free_inputs", ["level.sp"], "a list", "names with their numbers"),
    ],
)
def test_what_does_not_suit_the_plant_is_refused_at_once(plant, key, given, value, expected):
    with refused(place=f"Own law, {key}", value=value, expected=expected):
        cl.design.own(plant, load_law("my_pi.py"), **(WIRES | {key: given}))


def test_a_free_input_is_a_number(plant) -> None:
    with refused(place="Own law, free inputs, level.sp", value="5 V", expected="a finite number"):
        cl.design.own(
            plant, load_law("my_pi.py"), measurements=["level_1"], setpoints=[],
            manipulated=["pump_1"], free_inputs={"level.sp": "5 V"},
        )  # fmt: skip


def test_a_wrong_wire_is_refused(plant) -> None:
    law = load_law("my_pi.py")
    with refused(remedy="add integral_time"):
        Controller("a", "b", "", law, {"gain": 1.0}, {}, ("level_1",), ("level_1",), ("pump_1",))


def test_differences_leave_modes_alone() -> None:
    """A law that squares its measurement: the slope at 3 is 6, and a mode has none."""

    def step(state, inputs, parameters, time_step):
        return {"kept": state["kept"]}, {
            "pump_1.out": inputs["level_1.pv"] ** 2 + 100 * inputs["pump_1.mode"]
        }

    law = python_law(
        "square", step, inputs=[Signal("level_1.pv"), Signal("pump_1.mode")],
        outputs=[Signal("pump_1.out", low=-1e300, high=1e300)], state=[Signal("kept")],
    )  # fmt: skip
    names = [signal.name for signal in law.inputs]
    given = {"level_1.pv": 3.0, "level_1.good": 1.0, "pump_1.mode": 1.0, "time_step": 1.0}
    inputs = [given.get(name, 0.0) for name in names]
    by_state, _, _, by_input = law.jacobians([2.0, 0.0], inputs, [-1e300, 1e300])
    assert by_input[0, names.index("level_1.pv")] == pytest.approx(6.0, rel=1e-9)
    assert by_input[0, names.index("pump_1.mode")] == 0.0
    assert by_state[0, 0] == 1.0  # exactly, as for expressions
