"""Process files with fitted parameters: what is written is what was found."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.identification.record import record_of

ONE_TANK = Path(__file__).parents[1] / "one-tank.toml"
STEPS = {"60 s": "1.8 V", "300 s": "1.2 V"}


def fitted(plant, steps, names, *, factor=1.1, duration="10 min", noise=None):
    """Fit parameters of a plant whose file has other numbers than the real one.

    Its pump 1 steps to each of some voltages at a time.
    """
    own = (plant.process.signal(name) for name in names)
    real = plant.with_values(
        {p.name: f"{factor * p.initial} {p.unit}".removesuffix(" 1") for p in own}
    )
    events = [cl.step("pump_1", to=to, at=at) for at, to in steps.items()]
    run = cl.simulate(real, None, events, duration=duration)
    return cl.identify(record_of(run, noise), plant=plant, parameters=names)


def test_the_file_gives_back_what_was_fitted(tmp_path):
    names = ["outlet_1.area", "pump_1.gain", "splitter_1.tank_1"]
    plant = cl.load("quadruple-tank")
    steps = {"60 s": "3.6 V", "300 s": "2.6 V"}
    fit = fitted(plant, steps, names, noise={"level_1": 0.01, "level_4": 0.01})
    path = tmp_path / "fitted.toml"
    fit.write(path)
    found = cl.load(path).process
    assert found.variant == ("identified",)
    assert found.parameter_values == pytest.approx(fit.process.parameter_values, rel=1e-7)
    assert found.signal("pump_1.gain").initial == pytest.approx(1.1 * 3.33e-6, rel=0.02)
    # The sampling period is the file's, the comments are there, and so are the old numbers.
    assert found.sampling_period == plant.process.sampling_period
    assert path.read_text().count("# The holes in the floors") == 1
    splitter = next(e for e in found.elements if e.name == "splitter_1")
    assert sum(splitter.destinations.values()) == pytest.approx(1.0, abs=1e-12)
    assert cl.load(path, variant=[]).process.signal("outlet_1.area").initial == 7.1e-6


@pytest.fixture(scope="module")
def laboratory():
    """Return the plant in volts, sampled each second."""
    process = cl.load("laboratory-four-tanks:fitted,volts").process
    return cl.Plant(replace(process, sampling_period=1.0))


VOLTS = {"5 s": "7.2 V", "60 s": "6 V"}


@pytest.mark.thorough
def test_variants_in_force_stay_in_force(laboratory, tmp_path):
    fit = fitted(laboratory, VOLTS, ["outlet_1.area"], duration="2 min")
    path = tmp_path / "fitted.toml"
    fit.write(path)
    found = cl.load(path).process
    assert found.variant == ("fitted", "volts", "identified")
    assert found.parameter_values == pytest.approx(fit.process.parameter_values, rel=1e-7)
    assert tomllib.loads(path.read_text())["default_variant"] == list(found.variant)


def test_a_second_identification_adds_a_second_variant(tmp_path):
    """Also where the variants in force stand on several lines."""
    first = fitted(cl.load(ONE_TANK), STEPS, ["outlet_1.area"])
    first.write(tmp_path / "first.toml")
    text = (tmp_path / "first.toml").read_text()
    assert '["identified"]' in text
    (tmp_path / "first.toml").write_text(text.replace('["identified"]', '[\n  "identified",\n]'))
    second = fitted(cl.load(tmp_path / "first.toml"), STEPS, ["pump_1.gain"])
    second.write(tmp_path / "second.toml")
    found = cl.load(tmp_path / "second.toml").process
    assert found.variant == ("identified", "identified-2")
    assert np.allclose(found.parameter_values, second.process.parameter_values, rtol=1e-7)


def test_gravity_and_a_default_are_written_too(tmp_path):
    fit = fitted(cl.load(ONE_TANK), STEPS, ["outlet_1.discharge"], factor=0.9)
    fit.write(tmp_path / "worn.toml")
    text = (tmp_path / "worn.toml").read_text(encoding="utf-8")
    assert "orifices.outlet_1.discharge = 0.9" in text
    fit = fitted(cl.load(ONE_TANK), STEPS, ["gravity"], factor=0.9)
    fit.write(tmp_path / "moon.toml")
    moon = cl.load(tmp_path / "moon.toml").process
    assert moon.signal("gravity").initial == pytest.approx(8.829)


def test_a_gain_that_follows_from_a_span_is_refused(laboratory, tmp_path):
    fit = fitted(laboratory, VOLTS, ["level_1.gain"], duration="2 min")
    with refused(place="sensors.level_1", value="level_1.gain"):
        fit.write(tmp_path / "fitted.toml")
    assert not list(tmp_path.iterdir())


def test_only_toml_is_written(tmp_path):
    fit = fitted(cl.load(ONE_TANK), STEPS, ["outlet_1.area"])
    with refused(expected="a file that ends in .toml"):
        fit.write(tmp_path / "fitted.csv")
    assert not list(tmp_path.iterdir())
