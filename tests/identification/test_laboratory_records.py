"""The records of a four-tank laboratory: filling, draining, rest, and plugged outlets."""

from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import InputError
from clepsydra.identification.orifice_areas import orifice_areas_at_rest
from clepsydra.identification.record import record_of

HOLES = [f"outlet_{number}.area" for number in (1, 2, 3, 4)]
GAINS = ["pump_1.gain", "pump_2.gain"]
#: cm², as the variant `fitted` has them, and cm³/(s V) of exercise 2.1.7.
AREAS, PUMPS = [0.1333, 0.1114, 0.0548, 0.0487], [4.32, 3.74]
PLUGGED = dict.fromkeys(HOLES, 0.0)


@pytest.fixture(scope="module")
def laboratory():
    """Return the plant in volts, sampled each second as a logger does."""
    process = cl.load("laboratory-four-tanks:fitted,volts").process
    return cl.Plant(replace(process, sampling_period=1.0))


def begun(plant, names, factor=1.2):
    """Return the plant as a file has it before anything was identified."""
    own = (plant.process.signal(name) for name in names)
    return plant.with_values({p.name: f"{factor * p.initial} {p.unit}" for p in own})


def fitted(plant, names, volts=None, *, noise=0.01, **run):
    """Return the fit to a record of constant inputs with noise of half a millimetre."""
    pumps = ("pump_1", "pump_2") if volts is not None else ()
    events = [cl.step(pump, to=volts, at=0.0) for pump in pumps]
    record = record_of(
        cl.simulate(plant, None, events, **run), {f"level_{k}": noise for k in (1, 2, 3, 4)}
    )
    return cl.identify(record, plant=begun(plant, names), parameters=names)


def check(fit, names, truth):
    for estimate, value in zip(fit.estimates, truth, strict=True):
        assert estimate.signal.name in names, estimate.signal.name
        _, low, high = estimate.shown
        middle, half = (low + high) / 2.0, (high - low) / 2.0
        # A 95 % interval lies within twice its half width of the truth in all but 1 of 10,000.
        assert abs(middle - value) < 2.0 * half, (estimate.signal.name, low, high, value)
        assert half < 0.05 * value, estimate.signal.name


@pytest.mark.thorough  # a fast one is in tests/cli/test_identify.py
def test_filling_from_empty_at_constant_input_tells_the_holes(laboratory):
    fit = fitted(laboratory, HOLES, 6.0, start="empty", duration="4 min")
    check(fit, HOLES, AREAS)
    assert any("no input moved" in note for note in fit.notes)


@pytest.mark.thorough
def test_draining_tells_the_holes(laboratory):
    fit = fitted(laboratory, HOLES, 0.0, duration="90 s")
    check(fit, HOLES, AREAS)


def test_rest_at_constant_input_tells_the_holes(laboratory):
    """Nothing moves but the noise: where it rests tells the holes by what the pumps bring."""
    fit = fitted(laboratory, HOLES, duration="3 min")
    check(fit, HOLES, AREAS)


@pytest.mark.thorough  # a fast one is in tests/cli/test_identify.py
def test_plugged_outlets_tell_the_pumps(laboratory):
    """Exercise 2.1.7: with every outlet closed, A dh/dt is what the pump brings."""
    plugged = laboratory.with_values(PLUGGED)
    fit = fitted(plugged, GAINS, 3.0, start="empty", duration="40 s")
    check(fit, GAINS, PUMPS)


def test_a_plugged_outlet_is_no_parameter_to_fit(laboratory):
    record = record_of(cl.simulate(laboratory, duration="40 s"))
    with pytest.raises(InputError) as refusal:
        cl.identify(record, plant=laboratory.with_values(PLUGGED), parameters=["outlet_1.area"])
    assert refusal.value.place == "parameters, outlet_1.area" and refusal.value.value == "0 cm^2"


@pytest.mark.thorough
def test_a_sensor_at_the_end_of_its_range_is_noted(laboratory):
    record = record_of(cl.simulate(laboratory, duration="40 s"))
    high = laboratory.process.signal("level_4").high
    values = {**record.values, "level_4": np.linspace(4.9, 1.1, record.samples).clip(None, high)}
    values["level_4"][:5] = high
    fit = cl.identify(replace(record, values=values), plant=laboratory, parameters=HOLES[:1])
    assert any(
        note.startswith("level_4 stands at the end of its range in 5 rows") for note in fit.notes
    )


def test_levels_at_rest_by_the_balance_agree_with_the_fit(laboratory):
    """Two routes: the balance of Table 1's kind, and the simulation of a record at rest."""
    run = cl.simulate(laboratory, duration="3 min")
    rest = {s.name: float(run.values[s.name][-1]) for s in run.signals}
    found = orifice_areas_at_rest(laboratory.process, [rest])
    fit = cl.identify(record_of(run), plant=begun(laboratory, HOLES), parameters=HOLES)
    for name, value in fit.values.items():
        assert value == pytest.approx(found[name.removesuffix(".area")], rel=1e-3), name
