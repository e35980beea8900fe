"""What a scenario says of its noise is enough to make it again, and to keep it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.linear.analysis import analyse
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.process.reader import load_process
from clepsydra.studies.file.reader import read_study

CATALOGUE = Path(cl.__file__).parent / "process" / "catalogue"
LATE = """
process = "quadruple-tank"
seed = 5
[scenario]
duration = "900 s"
noise = {noise}
[[scenario.setpoint]]
signal = "level_1"
at = "10 s"
by = "0.5 V"
"""


def made_again(scenario, process):
    """Return noise and disturbances of a scenario from what it says of them."""
    noise, disturbances = np.zeros_like(scenario.noise), scenario.quiet_disturbances.copy()
    columns = {signal.name: noise[:, at] for at, signal in enumerate(process.measurements)}
    for at, signal in enumerate(process.disturbances):
        columns[signal.name] = disturbances[:, at]
    for each in scenario.noises:
        columns[each.signal][each.first :][: each.count] += each.values(scenario.seed)
    return noise, disturbances


def test_the_noise_of_a_default_scenario_can_be_made_again():
    process = replace(load_process("quadruple-tank"), noise={"level_3": 0.2, "inflow_2": 1e-7})
    scenario = default_scenario(analyse(process).model, seed=2)
    names = [f"level_{number}" for number in range(1, 5)]
    assert [each.signal for each in scenario.noises] == [*names, "inflow_2"]
    noise, disturbances = made_again(scenario, process)
    assert np.array_equal(scenario.noise, noise) and np.ptp(noise, axis=0).all()
    assert np.array_equal(scenario.disturbances, disturbances)
    quiet = default_scenario(analyse(replace(process, noise={})).model, seed=2).disturbances
    assert np.array_equal(scenario.quiet_disturbances, quiet)
    assert (scenario.disturbances != quiet).any(axis=0).tolist() == [False, True]


@pytest.mark.parametrize(("noise", "first", "count"), [("true", 0, 900), ('"300 s"', 300, 600)])
def test_the_noise_of_a_study_file_can_be_made_again(tmp_path, noise, first, count):
    file = tmp_path / "late.toml"
    file.write_text(LATE.format(noise=noise))
    scenario = read_study(file).scenario
    assert {(each.first, each.count) for each in scenario.noises} == {(first, count)}
    process = load_process("quadruple-tank")
    assert np.array_equal(scenario.noise, made_again(scenario, process)[0])


def test_without_noise_there_is_none_to_make(tmp_path):
    file = tmp_path / "quiet.toml"
    file.write_text(LATE.format(noise="false"))
    scenario = read_study(file).scenario
    assert scenario.noises == () and not scenario.noise.any()


def test_a_later_begin_leaves_the_noise_of_each_sample(tmp_path):
    file = tmp_path / "study.toml"
    found = []
    for noise in ("true", '"300 s"'):
        file.write_text(LATE.format(noise=noise))
        found.append(read_study(file).scenario.noise[300:])
    assert np.array_equal(*found)


def test_a_further_sensor_leaves_the_noise_of_the_others(tmp_path):
    text = (CATALOGUE / "quadruple-tank.toml").read_text("utf-8")
    head = "[sensors.level_1]"
    sensor = '[sensors.first]\ntank = "tank_2"\nrange = ["4 mA", "20 mA"]\nspan = '
    sensor += '["0 cm", "20 cm"]\n\n'
    assert text.count(head) == 1
    path = tmp_path / "more.toml"
    path.write_text(text.replace(head, sensor + head), "utf-8")
    one = default_scenario(analyse(load_process("quadruple-tank")).model)
    other = default_scenario(analyse(load_process(path)).model)
    assert np.array_equal(one.noise, other.noise[:, 1:]) and other.noise[:, 0].any()
