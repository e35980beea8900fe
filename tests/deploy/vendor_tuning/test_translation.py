"""A controller's tuning for every block, and the check by simulation."""

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from flow_cascade import flow_cascade
from plants import designed, plant
from refusals import refused
from rich.console import Console

import clepsydra as cl
from clepsydra import PidForm
from clepsydra.deploy.vendor_tuning.check import Check
from clepsydra.deploy.vendor_tuning.filling import Applied
from clepsydra.deploy.vendor_tuning.standard_tuning import standard_tunings
from clepsydra.deploy.vendor_tuning.translation import translate
from clepsydra.deploy.vendor_tuning.vendor_block import EVERY_BLOCK
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.studies.file.reader import read_study

#: Steps of 0.01 min, of 0.1 s and of 0.1 % of a band: rounding that can be seen.
COARSE = ("rockwell-micrologix", "omron-pidat")
CASCADE = flow_cascade(level_time="10 min")

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def quadruple():
    return plant("quadruple-tank")


@pytest.fixture(scope="module")
def three():
    return plant("three-tanks")


def row_of(translation, loop, key):
    (row,) = (r for r in translation.rows if (r.tuning.loop, r.block.key) == (loop, key))
    return row


def of_study(text, folder):
    file = folder / "study.toml"
    file.write_text(text, encoding="utf-8")
    request = read_study(file)
    (wanted,) = request.controllers
    return wanted.make(request.analysis, request.analysis.model), request


def test_pi_control_is_the_same_in_every_block_to_the_printed_digits(quadruple):
    found = translate(cl.design.simc(quadruple), "quadruple-tank")
    assert len(found.rows) == 2 * len(EVERY_BLOCK) and not found.refused
    assert found.saturated == 0.0
    for row in found.rows:
        assert row.by_block == row.by_numbers
        assert row.by_numbers < (1e-3 if row.block.key in COARSE else 1e-6)


@pytest.mark.parametrize(
    ("key", "numbers"),
    [
        # K = 3 and Ti = 32.032 s and 42.4544 s, in hundredths of a minute.
        ("rockwell-micrologix",
         {"level_1.integral_time": 0.53 * 60, "level_2.integral_time": 0.71 * 60}),
        # A band of 33.3 %, and tenths of a second.
        ("omron-pidat", {"level_1.proportional_gain": 100 / 33.3,
                         "level_2.proportional_gain": 100 / 33.3,
                         "level_1.integral_time": 32.0, "level_2.integral_time": 42.5}),
    ],
)  # fmt: skip
def test_what_rounding_does_is_what_a_run_with_the_rounded_numbers_shows(quadruple, key, numbers):
    controller = cl.design.simc(quadruple)
    scenario = default_scenario(quadruple.linear)
    rounded = replace(controller, values=controller.values | numbers)
    runs = [Loop(each, quadruple.linear).run(scenario).values for each in (controller, rounded)]
    found = translate(controller, "quadruple-tank")
    for loop, pump in (("level_1", "pump_1"), ("level_2", "pump_2")):
        expected = np.max(np.abs(runs[0][pump] - runs[1][pump])) / 10.0  # of 0 V to 10 V
        assert expected > 1e-5
        assert row_of(found, loop, key).by_numbers == pytest.approx(expected, rel=1e-3)


def test_the_check_sees_one_percent_of_each_number(three):
    controller = cl.design.simc(three, form=PidForm("PID"))
    (tuning,), _ = standard_tunings(controller, three.process)
    check = Check(controller, three.linear, default_scenario(three.linear))
    own = tuning.settings
    assert check.differences({tuning.loop: Applied("isa", own, "measurement")})["feed"] == 0.0
    for name in ("gain", "integral_time", "derivative_time", "filter_time"):
        wrong = own._replace(**{name: 1.01 * getattr(own, name)})
        assert check.differences({tuning.loop: Applied("isa", wrong, "measurement")})["feed"] > 2e-4


@pytest.mark.parametrize("algorithm", ["isa", "parallel", "velocity"])
def test_pid_control_by_its_numbers_is_the_same_and_what_blocks_lack_shows(three, algorithm):
    controller = cl.design.simc(three, form=PidForm("PID", algorithm))
    found = translate(controller, three.process)
    assert [block for _, block, _ in found.refused] == ["Honeywell HC900 PID"]
    for row in found.rows:
        if row.block.key not in (*COARSE, "emerson-deltav-series"):
            # The type TIME rounds the filter of 2.3926 s to 2.393 s.
            assert row.by_numbers < 2e-4, row.block.key
    # Noise through an unfiltered derivative, and setpoint steps through one on the error.
    for key in ("codesys-pid", "iec-61131-3-pid", "yokogawa-fieldbus-pid"):
        assert row_of(found, "level_3", key).by_block > 0.2
    assert row_of(found, "level_3", "siemens-cont-c").by_block > 0.05


def test_the_series_form_differs_by_sampling_alone(three):
    """A quarter of the sampling period, a quarter of the difference, where it is short enough."""
    found = []
    for period in (0.5, 0.125):
        process = replace(three.process, sampling_period=period)
        controller = cl.design.simc(three, form=PidForm("PID", derivative_on="error"))
        scenario = default_scenario(cl.Plant(process).linear)
        quiet = replace(scenario, noise=np.zeros_like(scenario.noise))
        found.append(
            row_of(
                translate(controller, process, quiet), "level_3", "emerson-deltav-series"
            ).by_numbers
        )
    assert found[0] / found[1] == pytest.approx(4.0, rel=0.1)


def test_a_series_controller_is_the_series_block_to_the_printed_digits(three):
    controller = cl.design.simc(three, form=PidForm("PID", "series"))
    found = translate(controller, three.process)
    row = row_of(found, "level_3", "emerson-deltav-series")
    values = controller.values
    expected = {
        "GAIN": values["level_3.proportional_gain"] * 0.7 / 1e-4,
        "RESET": values["level_3.integral_time"],
        "RATE": values["level_3.derivative_time"],
        "ALPHA": 0.1,
    }
    settings = {setting.name: setting.value for setting in row.filled.settings}
    assert {name: settings[name] for name in expected} == pytest.approx(expected, rel=5e-5)
    assert not row.filled.differs and row.by_block < 1e-4
    assert row.by_block == pytest.approx(row.by_numbers, rel=1e-9)


def test_the_time_at_a_limit_is_counted(three):
    controller = cl.design.simc(three, form=PidForm("PID"))
    scenario = default_scenario(three.linear)
    feed = Loop(controller, three.linear).run(scenario).values["feed"]
    share = np.mean((feed == 0.0) | (feed == controller.values["feed.high_limit"]))
    found = translate(controller, three.process, scenario)
    assert 0.0 < share == found.saturated
    assert f"{100 * share:.2g} % of its samples have an output at a limit" in found.as_markdown()


def test_direct_action_of_a_basin():
    controller = designed("arrest_time", "equalisation-tank")
    found = translate(controller, "equalisation-tank")
    assert (
        found.tunings[0].action == "direct" and controller.values["level.proportional_gain"] < 0.0
    )
    for row in found.rows:
        assert row.by_numbers < (5e-3 if row.block.key in COARSE else 1e-4), row.block.key


def test_both_loops_of_a_cascade(tmp_path):
    controller, request = of_study(CASCADE, tmp_path)
    found = translate(controller, request.process)
    assert [tuning.title for tuning in found.tunings] == ["level by duty_flow", "duty_flow by duty"]
    assert [tuning.action for tuning in found.tunings] == ["direct", "reverse"]
    outer = row_of(found, "level", "siemens-pid-compact").filled
    assert [setting.words for setting in outer.settings[:2]] == ["Gain = 3 %/%", "Ti = 600 s"]
    assert found.as_markdown().count("Other blocks stand between it and the outputs.") == 1
    inner = row_of(found, "flow", "siemens-pid-compact").filled
    assert [setting.words for setting in inner.settings[:2]] == ["Gain = 0.3 %/%", "Ti = 6 s"]
    for row in found.rows:
        assert row.by_numbers < (1e-2 if row.block.key in COARSE else 1e-6), row.block.key


@pytest.mark.parametrize("kind", ["static", "dynamic"])
def test_what_decoupling_adds_stands_beside_the_blocks(kind):
    plant = cl.load("quadruple-tank")
    found = translate(cl.design.simc(plant, decoupling=kind), plant.process)
    gains = cl.analyse(plant).static_gain
    for row, words in enumerate(found.beside):
        own, other = f"pump_{row + 1}", f"pump_{2 - row}"
        assert words.startswith(f"Add to {own} what {other} moves from 3 V, times ")
        gain = float(words.partition("times ")[2].split()[0])
        assert gain == pytest.approx(-gains[row, 1 - row] / gains[row, row], rel=1e-4)
        assert ("with a lead of " in words) == (kind == "dynamic")
        shown = found.as_markdown().replace("\\", "")
        assert f"- {words}".replace(" -", " −") in shown
    assert len(found.beside) == 2 == len(found.as_dict()["beside"])


def test_a_loop_with_gap_action_is_left_out_with_its_reason(tmp_path):
    text = CASCADE.replace(
        'setpoint_high = "35 l/s"', 'setpoint_high = "35 l/s"\nerror = "gap"\ngap = "1 l/s"\n'
        "gap_gain = 0.5",
    )  # fmt: skip
    controller, request = of_study(text, tmp_path)
    found = translate(controller, request.process)
    assert [tuning.loop for tuning in found.tunings] == ["level"]
    ((loop, block, why),) = found.refused
    assert (loop, block) == ("duty_flow by duty", "") and "gap action" in why
    assert "gap action on the error" in found.as_markdown()


def test_proportional_control_has_no_integral_time(tmp_path):
    text = """
    process = "equalisation-tank"
    [controllers.p.loops.level]
    measurement = "level"
    output = "outflow"
    actions = "P"
    action = "direct"
    gain = "1 %/%"
    """
    controller, request = of_study(text, tmp_path)
    found = translate(controller, request.process)
    assert len(found.rows) == len(EVERY_BLOCK)
    for row in found.rows:
        assert not any("T" in s.name and s.unit == "s" for s in row.filled.settings)
        assert row.by_numbers < 1e-9, row.block.key


def test_controllers_without_a_pid_of_fixed_gains_are_refused(quadruple, three):
    lqi = cl.design.lqi_kalman(quadruple)
    with refused(expected="at least one PID loop whose gains are constant"):
        translate(lqi, "quadruple-tank")
    scheduled = cl.design.gain_scheduled_pid(three)
    with refused(expected="at least one PID loop whose gains are constant"):
        translate(scheduled, three.process)


def test_the_screen_fits_and_markdown_and_dict_say_the_same(three, tmp_path):
    controller = cl.design.simc(three, form=PidForm("PID"))
    found = translate(controller, three.process)
    written = cl.export(controller, three, tmp_path, "tuning")
    for columns in (80, 100):
        console = Console(width=columns, record=True, file=io.StringIO())
        console.print(written)
        text = console.export_text()
        lines = [line.rstrip() for line in text.splitlines()]
        assert max(map(len, lines)) <= columns
        said = " ".join(text.split())
        assert len(lines) <= 25 and "derivative on the measurement" in said
        assert all(row.block.title.split()[0] in said for row in found.rows)
    markdown, plain = found.as_markdown(), found.as_dict()
    assert json.loads(json.dumps(plain)) == plain
    (loop,) = plain["loops"]
    assert len(loop["blocks"]) == len(found.rows)
    for row, block in zip(found.rows, loop["blocks"], strict=True):
        for setting, entry in zip(row.filled.settings, block["settings"], strict=True):
            assert setting.words in markdown
            assert entry == {"name": setting.name, "value": setting.value, "unit": setting.unit}
        for source in row.block.sources:
            assert source in markdown
    assert "Honeywell HC900 PID: got" in markdown
