"""A study file is read as it is meant."""

import math

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import NotApplicable
from clepsydra.designs.design import DESIGNS
from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.process.catalogue_names import catalogue_file
from clepsydra.process.reader import load_process
from clepsydra.studies.file.kind import is_study_file
from clepsydra.studies.file.reader import read_study

QUADRUPLE = 'process = "quadruple-tank"\n'
BASIN = 'process = "equalisation-tank"\n'


@pytest.fixture
def study(tmp_path):
    def read(text, **given):
        path = tmp_path / "study.toml"
        path.write_text(text, encoding="utf-8")
        return read_study(path, **given)

    return read


def made(request, number=0):
    """Return a controller of a study that has been read."""
    model = linearise(request.analysis.operating_point)
    return request.controllers[number].make(request.analysis, model)


def test_a_process_alone_is_a_study_with_the_usual_scenario_and_every_design(study):
    found = study(QUADRUPLE)
    usual = default_scenario(cl.load("quadruple-tank").linear, seed=1)
    assert (found.controllers, found.scores, found.seed) == ((), (), 1)
    assert found.title == found.process.title
    assert found.scenario.segments == usual.segments
    assert np.array_equal(found.scenario.noise, usual.noise)


def test_general_keys(study):
    found = study('title = "Two loops"\nseed = 7\n' + QUADRUPLE)
    assert (found.title, found.seed, found.scenario.seed) == ("Two loops", 7, 7)
    assert study("seed = 7\n" + QUADRUPLE, seed=9).scenario.seed == 9


def test_a_variant_and_a_file_beside_the_study_name_a_process(study, tmp_path):
    assert study('process = "averaging-tank:inflow-constant"').process.variant == (
        "inflow-constant",
    )
    folder = tmp_path / "plants"
    folder.mkdir()
    source = load_process("three-tanks")
    (folder / "mine.toml").write_bytes(catalogue_file("three-tanks").read_bytes())
    found = study('process = "plants/mine.toml:corrected"').process
    assert found.variant == ("corrected",) and found.name == source.name


def test_steps_come_at_their_times_with_their_sizes(study):
    found = study(
        BASIN
        + """
[scenario]
duration = "6 h"
noise = false
[[scenario.load]]
signal = "inflow"
at = "3 h"
by = "0.1 m^3/s"
[[scenario.setpoint]]
signal = "level"
at = "10 min"
to = "60 %"
[[scenario.setpoint]]
signal = "level"
at = "100 s"
by = "-5 %"
"""
    )
    scenario = found.scenario
    assert scenario.samples == 360
    # 100 s lies between the samples at 60 s and 120 s: the step acts from 120 s on.
    assert [(s.kind, s.signal, s.start, s.stop) for s in scenario.segments] == [
        ("setpoint", "level", 120.0, 600.0),
        ("setpoint", "level", 600.0, 10800.0),
        ("load", "inflow", 10800.0, 21600.0),
    ]
    assert [s.size for s in scenario.segments] == pytest.approx([-0.05, 0.15, 0.1], rel=1e-12)
    level = scenario.setpoints[:, 0]
    assert level[[0, 1, 2, 9, 10, 359]] == pytest.approx([0.5, 0.5, 0.45, 0.45, 0.6, 0.6])
    inflow = scenario.disturbances[:, 0]
    assert inflow[[0, 179, 180, 359]] == pytest.approx([0.307, 0.307, 0.407, 0.407])
    assert not scenario.noise.any()


def test_percent_of_a_signal_in_other_units_are_those_of_its_range(study):
    found = study(
        'process = "wet-well"\n[scenario]\nduration = "1 h"\nnoise = false\n'
        '[[scenario.setpoint]]\nsignal = "level"\nat = "1 min"\nto = "50 %"\n'
        '[[scenario.setpoint]]\nsignal = "level"\nat = "10 min"\nby = "10 %"\n'
    )
    # 4 mA to 20 mA: 50 % is 12 mA, and 10 % are 1.6 mA.
    assert found.scenario.setpoints[-1, 0] == pytest.approx(13.6e-3, rel=1e-12)
    assert found.scenario.segments[1].size == pytest.approx(1.6e-3, rel=1e-12)


def test_noise_is_that_of_the_process_over_the_whole_scenario(study):
    text = '[scenario]\nduration = "5 h"\n[[scenario.setpoint]]\nsignal = "level_1"\nat = "1 min"\n'
    found = study(QUADRUPLE + text + 'by = "1 V"\n')
    noise = found.scenario.noise
    assert noise.shape == (18000, 4)
    # The standard error of a standard deviation of n samples is σ/√(2 n), 0.5 % here.
    assert noise.std(axis=0) == pytest.approx(0.05, rel=0.025)
    again = study(QUADRUPLE + text + 'by = "1 V"\n')
    other = study("seed = 2\n" + QUADRUPLE + text + 'by = "1 V"\n')
    assert np.array_equal(noise, again.scenario.noise)
    assert not np.any(noise == other.scenario.noise)


def test_noise_may_have_a_stretch_of_its_own_after_the_steps(study):
    found = study(
        BASIN + '[scenario]\nduration = "6 h"\nnoise = "5 h"\n[[scenario.setpoint]]\n'
        'signal = "level"\nat = "1 h"\nby = "5 %"\n'
    ).scenario
    assert [(s.kind, s.start, s.stop) for s in found.segments] == [
        ("setpoint", 3600.0, 18000.0),
        ("noise", 18000.0, 21600.0),
    ]
    assert not found.noise[:300].any() and found.noise[300:].all()


def test_scores(study):
    names = ("iae", "total_variation[pump_1]", "energy")
    listed = ", ".join(f'"{name}"' for name in names)
    assert study(f"{QUADRUPLE}[ranking]\nscores = [{listed}]\n").scores == names


def test_a_design_gets_what_its_function_would_get(study):
    found = study(
        QUADRUPLE
        + """
[controllers."slow pair"]
design = "lambda"
closed_loop_time_constant = "2 min"
pairing = { level_2 = "pump_2", level_1 = "pump_1" }
anti_windup = "clamping"
"""
    )
    (request,) = found.controllers
    controller = made(found)
    direct = cl.design.lambda_(
        cl.load("quadruple-tank"),
        [("level_2", "pump_2"), ("level_1", "pump_1")],
        closed_loop_time_constant=120.0,
    )
    assert (request.name, controller.name) == ("slow pair", "slow pair")
    assert request.tune is None
    assert controller.setpoints == ("level_2", "level_1")
    for name in ("level_1.proportional_gain", "level_2.integral_time"):
        assert controller.values[name] == direct.values[name], name
    assert "level_1.tracking_time" not in controller.values  # that is of back-calculation


def test_a_form_is_taken_from_its_own_keys(study):
    found = study(
        'process = "three-tanks"\n[controllers.a]\ndesign = "simc"\n'
        'actions = "PID"\nalgorithm = "series"\n'
    )
    controller = made(found)
    assert controller.family == "multiloop PID"
    # A series form: the ISA form has Ti ≥ 4 Td, this one need not.
    isa = cl.design.simc(cl.load("three-tanks"), [("level_3", "feed")])
    assert controller.values["level_3.derivative_time"] > 0.0
    assert set(isa.values) < set(controller.values)


@pytest.mark.parametrize("name", DESIGNS)
def test_every_argument_of_every_design_can_be_written(name):
    """But for what only a program can give: controllers, models and settings."""
    design = DESIGNS[name]
    of_programs = {"precompensator", "models", "settings"}
    assert set(design.arguments) - of_programs == set(design.declared)
    assert {each.name for each in design.keys} <= set(design.arguments)


@pytest.mark.sampled
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.thorough) if "scheduled" in name else name
        for name, design in DESIGNS.items()
        if "pairing" in design.file_keys
    ],
)
def test_a_pairing_that_is_left_out_is_that_of_the_relative_gains(name, tmp_path):
    """Of the quadruple tank in its minimum-phase setting: each pump with the level below it."""
    made = []
    for pairing in ("", 'pairing = { level_1 = "pump_1", level_2 = "pump_2" }\n'):
        path = tmp_path / "study.toml"
        path.write_text(
            f'process = "quadruple-tank"\n[controllers.a]\ndesign = "{name}"\n{pairing}',
            encoding="utf-8",
        )
        request = read_study(path)
        try:
            made.append(request.controllers[0].make(request.analysis, request.analysis.model))
        except NotApplicable as refusal:  # of the process, as with its pairing
            made.append(refusal)
    without, with_it = made
    if isinstance(with_it, NotApplicable):
        assert str(without) == str(with_it)
    else:
        assert without.values == with_it.values


WEIGHTS = 'weights = { states = { "tank_3.level" = 1.0 }, inputs = { feed = 1e6 }'


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("process", "arguments"),
    [
        ("equalisation-tank", 'design = "arrest_time"\narrest_time = "4 h"'),
        ("equalisation-tank", 'design = "arrest_time"\ndeviation = "20 %"'),
        ("quadruple-tank", 'design = "phase_margin"\nphase_margin = "60 deg"'),
        ("quadruple-tank", 'design = "phase_margin"\ncrossover = "0.02 rad/s"'),
        ("quadruple-tank", 'design = "simc"\ndecoupling = "static"'),
        ("equalisation-tank", 'design = "ziegler_nichols"\nexperiment = "step_response"'),
        ("equalisation-tank", 'design = "amigo"\nas_published = true'),
        ("quadruple-tank", 'design = "lqi"\nmaximum_errors = { level_1 = "5 %", level_2 = "1 V" }'),
        ("quadruple-tank", 'design = "lqi"\nmaximum_moves = { pump_1 = "2 V", pump_2 = "20 %" }'),
        (
            "three-tanks",
            f'design = "lqi_by_weights"\n{WEIGHTS}, integrals = {{ level_3 = 1e-5 }} }}',
        ),
        ("three-tanks", f'design = "lqr"\n{WEIGHTS} }}'),
        ("three-tanks", 'design = "lqi_kalman"\nmeasurements = ["level_3"]'),
        ("three-tanks", 'design = "pole_placement"\npoles = [0.97, "0.95+0.01j", "0.95 - 0.01j"]'),
        ("three-tanks", 'design = "pole_placement"\nbandwidth = "0.01 rad/s"'),
        ("wet-well:start-stop", 'design = "start_stop_levels"\nstarts_per_hour = 12'),
    ],
)
def test_every_kind_of_argument_makes_a_controller(study, process, arguments):
    controller = made(study(f'process = "{process}"\n[controllers.a]\n{arguments}\n'))
    assert controller.name == "a" and all(math.isfinite(v) for v in controller.values.values())


def test_poles_are_read_as_complex_numbers(study):
    found = study(
        'process = "three-tanks"\n[controllers.a]\ndesign = "pole_placement"\n'
        'poles = [0.97, "0.95+0.01j", "0.95 - 0.01j"]\n'
    )
    direct = cl.design.pole_placement(
        cl.load("three-tanks"), poles=[0.97, 0.95 + 0.01j, 0.95 - 0.01j]
    )
    assert made(found).values == direct.values


@pytest.mark.thorough
def test_starts_an_hour_may_have_a_unit(study):
    text = 'process = "wet-well:start-stop"\n[controllers.a]\ndesign = "start_stop_levels"\n'
    bare, hours, minutes = (
        made(study(f"{text}starts_per_hour = {value}\n")).values
        for value in ("6", '"6 1/h"', '"0.1 1/min"')
    )
    assert bare == hours == minutes


def test_controllers_keep_the_order_of_the_file(study):
    found = study(QUADRUPLE + "".join(f'[controllers.{name}]\ndesign = "simc"\n' for name in "cab"))
    assert [request.name for request in found.controllers] == ["c", "a", "b"]


def test_an_own_law_is_wired_with_its_numbers(study, tmp_path):
    (tmp_path / "my_pi.py").write_text(
        'inputs = ["level_1.sp", "level_1.pv"]\n'
        'outputs = ["pump_1.out"]\n'
        'parameters = {"gain": 3.0, "integral_time": 30.0}\n'
        'state = {"integral": 0.0}\n'
        "def step(state, inputs, parameters, time_step):\n"
        '    error = inputs["level_1.sp"] - inputs["level_1.pv"]\n'
        '    integral = state["integral"] + parameters["gain"] / parameters["integral_time"]'
        " * error * time_step\n"
        '    return {"integral": integral}, '
        '{"pump_1.out": parameters["gain"] * error + integral}\n',
        encoding="utf-8",
    )
    found = study(
        QUADRUPLE
        + """
[controllers.mine]
law = "my_pi.py"
measurements = ["level_2"]
setpoints = ["level_2"]
manipulated = ["pump_2"]
parameters = { gain = 2.0 }
initial_state = { integral = 3.0 }
"""
    )
    controller = made(found)
    assert controller.values == {
        "gain": 2.0, "integral_time": 30.0, "pump_1.low_limit": 0.0, "pump_1.high_limit": 10.0,
    }  # fmt: skip
    assert controller.initial_state == {"integral": 3.0, "pump_1.last_output": 3.0}
    assert controller.output_wires["pump_1.out"] == "pump_2"


def test_which_files_are_studies(tmp_path):
    (tmp_path / "a.toml").write_text(QUADRUPLE)
    (tmp_path / "b.toml").write_text("[tanks.a]\n")
    (tmp_path / "c.toml").write_text("[tanks.a\n")
    found = [
        is_study_file(str(tmp_path / name)) for name in ("a.toml", "b.toml", "c.toml", "d.toml")
    ]
    assert found == [True, False, False, False]
    assert not is_study_file("quadruple-tank")


def test_a_study_is_no_process_and_a_process_no_study(tmp_path):
    path = tmp_path / "a.toml"
    path.write_text(QUADRUPLE)
    with refused(value="a study file", remedy="clepsydra study"):
        load_process(path)
    path.write_text('name = "a"\n[tanks.tank_1]\n')
    with refused(value="a process file", remedy="clepsydra new --study"):
        read_study(path)
    path.write_text("")
    with refused(value="an empty file", expected="a study", remedy="clepsydra new --study"):
        read_study(path)


FROM_EMPTY = """
process = "quadruple-tank"
[scenario]
duration = "20 min"
noise = false
start = "empty"
controller_start = "cold"
state = { pump_1 = "0 V", "tank_3.level" = "1 cm" }
[[scenario.setpoint]]
signal = "level_1"
at = "0 s"
to = "60 %"
[[scenario.setpoint]]
signal = "level_2"
at = "10 min"
to = "60 %"
[controllers.simc]
design = "simc"
"""


def test_a_study_begins_empty_as_a_simulation_does(study, tmp_path):
    path = tmp_path / "empty.toml"
    path.write_text(FROM_EMPTY, encoding="utf-8")
    plant = cl.load("quadruple-tank")
    found = cl.study(path)["simc"]
    steps = [cl.step("level_1", to="60 %", at=0), cl.step("level_2", to="60 %", at="10 min")]
    state = {"pump_1": "0 V", "tank_3.level": "1 cm"}
    run = cl.simulate(
        plant, cl.design.simc(plant), steps, duration="20 min", start="empty", state=state,
        controller_start="cold",
    )  # fmt: skip
    assert found.run.values["tank_3.level"][0] == 0.01
    for name, values in run.values.items():
        # A study takes other integration steps: 1e-5 of the range of what moves at all.
        assert found.run.values[name] == pytest.approx(values, abs=1e-4), name
    parts = [(s.kind, s.signal, s.start, s.stop) for s in found.run.scenario.segments]
    assert parts == [
        ("setpoint", "level_1", 0.0, 600.0),
        ("setpoint", "level_2", 0.0, 600.0),
        ("setpoint", "level_2", 600.0, 1200.0),
    ]
    assert found.run.scenario.segments[0].size == 6.0  # [V], from nothing


def test_no_step_is_needed_where_a_study_begins_elsewhere(study):
    text = FROM_EMPTY.partition("[[scenario.setpoint]]")[0]
    scenario = study(text).scenario
    assert [(s.signal, s.start, s.stop) for s in scenario.segments] == [
        ("level_1", 0.0, 1200.0), ("level_2", 0.0, 1200.0)
    ]  # fmt: skip


def test_a_tank_that_begins_empty_is_no_warning(tmp_path):
    path = tmp_path / "empty.toml"
    path.write_text(FROM_EMPTY, encoding="utf-8")
    found = cl.study(path)["simc"]
    assert not any("runs empty" in warning for warning in found.warnings)
    assert found.standing != "unsafe"


def test_the_report_says_where_a_study_begins(tmp_path):
    path, page = tmp_path / "empty.toml", tmp_path / "empty.html"
    path.write_text(FROM_EMPTY, encoding="utf-8")
    cl.study(path).report(page)
    said = "begins empty, but for pump_1 and tank_3.level, controllers cold"
    assert said in page.read_text(encoding="utf-8")


def test_a_tuning_from_empty_is_that_of_runs_from_empty(tmp_path):
    """What the tuning says of its best controller is what a run of it comes to."""
    path = tmp_path / "tuned.toml"
    tune = '[controllers.tuned]\ndesign = "simc"\n[controllers.tuned.tune]\nobjective = "iae"\n'
    path.write_text(FROM_EMPTY + tune, encoding="utf-8")
    study = cl.study(path)
    tuned, start = study["tuned"], study["simc"]
    share = max(
        tuned.scores[f"iae[{name}]"] / start.scores[f"iae[{name}]"]
        for name in ("level_1", "level_2")
    )
    assert share < 0.9
    assert tuned.tuning.objective == pytest.approx(share, rel=1e-3)
