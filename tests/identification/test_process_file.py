"""Process files with fitted parameters: what is written is what was found."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refusals import refused

from clepsydra.identification.process_file import fitted_process_text, write_fitted_process
from clepsydra.identification.process_fit import fit_process
from clepsydra.identification.simulated_record import record_of
from clepsydra.loop.simulation import simulate
from clepsydra.process.reader import load_process

ONE_TANK = Path(__file__).parents[1] / "one-tank.toml"


def fitted(process, inputs, names, *, factor=1.1, duration="10 min", noise=None):
    """Fit a process whose file has other numbers than the plant."""
    plant = replace(process, parameters=tuple(
        replace(p, initial=factor * p.initial) if p.name in names else p
        for p in process.parameters
    ))  # fmt: skip
    run = simulate(plant, inputs, duration=duration)
    return fit_process(process, record_of(run, noise), names)


def test_the_file_gives_back_what_was_fitted(tmp_path):
    names = ["outlet_1.area", "pump_1.gain", "splitter_1.tank_1"]
    inputs = {"pump_1": ["3.6 V @ 60 s", "2.6 V @ 300 s"]}
    process = load_process("quadruple-tank")
    fit = fitted(process, inputs, names, noise={"level_1": 0.01, "level_4": 0.01})
    path = tmp_path / "fitted.toml"
    write_fitted_process(fit, path)
    found = load_process(path)
    assert found.variant == ("identified",)
    assert found.parameter_values == pytest.approx(fit.process.parameter_values, rel=1e-7)
    assert found.signal("pump_1.gain").initial == pytest.approx(1.1 * 3.33e-6, rel=0.02)
    # The sampling period is the file's, the comments are there, and so are the old numbers.
    assert found.sampling_period == process.sampling_period
    assert path.read_text().count("# The holes in the floors") == 1
    splitter = next(e for e in found.elements if e.name == "splitter_1")
    assert sum(splitter.destinations.values()) == pytest.approx(1.0, abs=1e-12)
    assert load_process(path, variant=[]).signal("outlet_1.area").initial == 7.1e-6


@pytest.mark.thorough
def test_variants_in_force_stay_in_force(tmp_path):
    process = load_process("laboratory-four-tanks:fitted,volts")
    names = ["outlet_1.area"]
    fit = fitted(process, {"pump_1": ["7.2 V @ 5 s", "6 V @ 60 s"]}, names, duration="2 min")
    path = tmp_path / "fitted.toml"
    write_fitted_process(fit, path)
    found = load_process(path)
    assert found.variant == ("fitted", "volts", "identified")
    assert found.parameter_values == pytest.approx(fit.process.parameter_values, rel=1e-7)
    assert tomllib.loads(path.read_text())["default_variant"] == list(found.variant)


def test_a_second_identification_adds_a_second_variant(tmp_path):
    inputs = {"pump_1": ["1.8 V @ 60 s", "1.2 V @ 300 s"]}
    first = fitted(load_process(ONE_TANK), inputs, ["outlet_1.area"])
    write_fitted_process(first, tmp_path / "first.toml")
    second = fitted(load_process(tmp_path / "first.toml"), inputs, ["pump_1.gain"])
    write_fitted_process(second, tmp_path / "second.toml")
    found = load_process(tmp_path / "second.toml")
    assert found.variant == ("identified", "identified-2")
    assert np.allclose(found.parameter_values, second.process.parameter_values, rtol=1e-7)


def test_gravity_and_a_default_are_written_too(tmp_path):
    inputs = {"pump_1": ["1.8 V @ 60 s", "1.2 V @ 300 s"]}
    fit = fitted(load_process(ONE_TANK), inputs, ["outlet_1.discharge"], factor=0.9)
    assert "orifices.outlet_1.discharge = 0.9" in fitted_process_text(fit)
    fit = fitted(load_process(ONE_TANK), inputs, ["gravity"], factor=0.9)
    write_fitted_process(fit, tmp_path / "moon.toml")
    assert load_process(tmp_path / "moon.toml").signal("gravity").initial == pytest.approx(8.829)


@pytest.mark.thorough
def test_a_gain_that_follows_from_a_span_is_refused():
    process = load_process("laboratory-four-tanks:fitted,volts")
    inputs = {"pump_1": ["7.2 V @ 5 s", "6 V @ 60 s"]}
    fit = fitted(process, inputs, ["level_1.gain"], duration="2 min")
    with refused(place="sensors.level_1", value="level_1.gain"):
        fitted_process_text(fit)


def test_only_toml_is_written(tmp_path):
    fit = fitted(load_process(ONE_TANK), {"pump_1": "1.8 V @ 60 s"}, ["outlet_1.area"])
    with refused(expected="a file that ends in .toml"):
        write_fitted_process(fit, tmp_path / "fitted.csv")
    assert not list(tmp_path.iterdir())
