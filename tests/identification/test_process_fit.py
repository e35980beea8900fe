"""Physical parameters: several tanks, dead time, and what a record cannot tell."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import InputError
from clepsydra.identification.process_batch import ProcessBatch
from clepsydra.identification.record import Record, record_of

TESTS = Path(__file__).parents[1]
STEPS = {
    "pump_1": {"60 s": "3.6 V", "300 s": "2.6 V", "560 s": "3.3 V", "800 s": "2.8 V"},
    "pump_2": {"150 s": "2.6 V", "430 s": "3.4 V", "700 s": "2.7 V"},
}


def simulated(plant, steps, **run):
    """Simulate a plant whose inputs step to each of some values at a time."""
    events = [
        cl.step(name, to=to, at=at) for name, values in steps.items() for at, to in values.items()
    ]
    return cl.simulate(plant, None, events, **run)


def scaled(plant, names, factor):
    """Return a plant whose file would have other numbers."""
    own = (plant.process.signal(name) for name in names)
    return plant.with_values(
        {p.name: f"{factor * p.initial} {p.unit}".removesuffix(" 1") for p in own}
    )


def fitted(plant, record, names):
    return cl.identify(record, plant=plant, parameters=names)


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


@pytest.fixture(scope="module")
def four_tanks(plant):
    return simulated(plant, STEPS, duration="16 min", state={"tank_1.level": "9 cm"})


NAMES = ["outlet_1.area", "outlet_2.area", "outlet_3.area", "pump_1.gain", "splitter_1.tank_1"]


def test_without_noise_the_truth_is_found(plant, four_tanks):
    """Five parameters of four tanks, and a start that is not at rest."""
    began = scaled(plant, NAMES, 1.15)
    fit = fitted(began, record_of(four_tanks), NAMES)
    for name in NAMES:
        assert fit.values[name] == pytest.approx(plant.process.signal(name).initial, rel=1e-6), name
    assert fit.start[0].value == pytest.approx(0.09, rel=1e-6)
    assert all(output.validated > 99.99 for output in fit.outputs)
    assert [p.initial for p in fit.process.parameters] == pytest.approx(
        [p.initial for p in plant.process.parameters], rel=1e-6
    )


def test_measurements_are_weighed_by_their_noise(plant, four_tanks):
    """A sensor that is a hundred times as noisy as another spoils nothing."""
    noise = {"level_1": 0.005, "level_2": 0.5, "level_3": 0.005, "level_4": 0.005}
    fit = fitted(plant, record_of(four_tanks, noise), NAMES)
    for estimate in fit.estimates:
        truth = plant.process.signal(estimate.signal.name).initial
        four_deviations = estimate.high - estimate.low
        assert abs(estimate.value - truth) < four_deviations, estimate.signal.name
    area = fit.estimates[0]
    assert (area.high - area.low) / area.value < 0.02
    rms = [np.sqrt(np.mean((o.measured - o.simulated) ** 2)) for o in fit.outputs]
    assert rms == pytest.approx(list(noise.values()), rel=0.1)


def test_unmeasured_tanks_start_where_the_record_says(plant, four_tanks):
    whole = record_of(four_tanks, {"level_1": 0.002, "level_2": 0.002})
    kept = [s for s in whole.signals if s.name in ("pump_1", "pump_2", "level_1", "level_2")]
    record = replace(whole, signals=tuple(kept))
    fit = fitted(plant, record, ["outlet_1.area", "outlet_3.area"])
    start = {estimate.signal.name: estimate for estimate in fit.start}
    for name in ("tank_1.level", "tank_2.level", "tank_3.level", "tank_4.level"):
        truth = four_tanks.values[name][0]
        margin = start[name].high - start[name].value
        assert abs(start[name].value - truth) < 2.0 * margin < 0.02, name


def test_a_batch_is_the_simulation_lane_by_lane(plant, four_tanks):
    process = plant.process
    given = {name: four_tanks.values[name][:-1] for name in ("pump_1", "pump_2")}
    start = np.array([four_tanks.values[s.name][0] for s in process.state])
    batch = ProcessBatch(process, given)
    areas = np.array([7.1e-6, 6.5e-6, 8.0e-6])
    found = batch.measured({"outlet_1.area": areas}, np.tile(start[:, None], (1, 3)))
    assert found[0, 0] == pytest.approx(four_tanks.values["level_1"][:-1], abs=1e-7)
    for lane, area in enumerate(areas):
        other = plant.with_values({"outlet_1.area": f"{area} m^2"})
        alone = simulated(other, STEPS, duration="16 min", state={"tank_1.level": "9 cm"})
        assert found[lane, 0] == pytest.approx(alone.values["level_1"][:-1], abs=1e-6), lane


def test_a_channel_with_dead_time_and_another_sampling_period():
    """The record has a row each 4 s, the file a sampling period of 2 s, the channel 5 s."""
    channel = cl.load(TESTS / "dead-time.toml")
    feed = {"100 s": "4 l/min", "900 s": "2.2 l/min", "1900 s": "3.4 l/min", "2600 s": "2.6 l/min"}
    run = simulated(channel, {"feed": feed}, duration="60 min")
    whole = record_of(run)
    every = {name: values[::2] for name, values in whole.values.items()}
    record = Record("channel", whole.signals, every, 4.0)
    names = ["outlet_1.area", "outlet_2.area"]
    fit = fitted(scaled(channel, names, 0.9), record, names)
    assert [fit.values[name] for name in names] == pytest.approx([3e-5, 2.5e-5], rel=1e-4)


@pytest.mark.parametrize("variant", ["", ":seldom"])
def test_a_late_sensor_tells_of_parameters_what_a_prompt_one_tells(variant):
    plant = cl.load(f"{TESTS.parent / 'docs' / 'examples' / 'analyser.toml'}{variant}")
    steps = {"brine": {"60 s": "50 %", "12 min": "30 %"}, "water": {"6 min": "30 %"}}
    record, names = record_of(simulated(plant, steps, duration="20 min")), ["brine.gain"]
    fit = fitted(scaled(plant, names, 1.1), record, names)
    assert fit.values["brine.gain"] == pytest.approx(1e-3, rel=1e-6)
    assert all(output.validated > 99.99 for output in fit.outputs)


def test_parameters_that_act_alike_are_named(plant, four_tanks):
    with pytest.raises(InputError) as refusal:
        fitted(plant, record_of(four_tanks), ["outlet_1.area", "outlet_1.discharge"])
    message = str(refusal.value)
    assert "outlet_1.area and outlet_1.discharge, which move the measurements alike" in message


def test_gain_hole_and_area_of_one_tank_act_alike():
    """All flows and the cross-section of a tank by one factor: its level stays the same."""
    tank = cl.load(TESTS / "one-tank.toml")
    run = simulated(tank, {"pump_1": {"30 s": "1.8 V"}})
    names = ["tank_1.area", "outlet_1.area", "pump_1.gain"]
    with pytest.raises(InputError, match="which move the measurements alike"):
        fitted(tank, record_of(run), names)


def test_a_parameter_without_a_trace_is_named(plant, four_tanks):
    whole = record_of(four_tanks)
    kept = [s for s in whole.signals if s.name in ("pump_1", "pump_2", "level_3")]
    record = replace(whole, signals=tuple(kept))
    with pytest.raises(InputError, match=r"parameters, outlet_1\.area: got no trace"):
        fitted(plant, record, ["outlet_3.area", "outlet_1.area"])


def test_a_plant_that_does_more_than_the_file_is_told(plant, four_tanks):
    """The record's upper tank has a smaller hole than the file, and nobody fits it."""
    began = scaled(plant, ["outlet_4.area"], 1.4)
    noise = {f"level_{k}": 0.01 for k in (1, 2, 3, 4)}
    fit = fitted(began, record_of(four_tanks, noise), ["outlet_1.area"])
    words = fit.verdict
    assert "level_4" in words
    assert "the plant does more than the file says" in words or "Do not use this fit" in words


def test_what_still_depends_on_the_inputs_is_named_and_nothing_else(plant, four_tanks):
    """A pump gives more than in the file; what the other pump alone feeds is as the fit says."""
    began = scaled(plant, ["pump_2.gain"], 1.05)
    noise = {f"level_{k}": 0.01 for k in (1, 2, 3, 4)}
    fit = fitted(began, record_of(four_tanks, noise), ["outlet_1.area", "outlet_3.area"])
    named = fit.verdict.partition("what is left of ")[2].partition(" still depends")[0]
    assert "level_2" in named and "level_4" not in named


def test_a_still_measurement_with_noise_spoils_no_verdict(plant, four_tanks):
    run = simulated(plant, {"pump_1": STEPS["pump_1"]}, duration="16 min")
    noise = {f"level_{k}": 0.01 for k in (1, 2, 3, 4)}
    fit = fitted(plant, record_of(run, noise), ["outlet_1.area"])
    still = fit.outputs[2]
    assert still.signal.name == "level_3" and still.validated < 10.0 and still.is_still
    assert fit.verdict.startswith("With these parameters quadruple-tank explains 9")
    for count in (1, 2):
        told = replace(fit, outputs=fit.outputs[:count]).verdict
        assert ("the worst of its measurements" in told) == (count == 2)


REFUSED = {
    "none": ([], {}, "parameters: got none, expected parameters of quadruple-tank"),
    "unknown": (["outlet_9.area"], {}, "perhaps 'outlet_"),
    "twice": (["pump_1.gain", "pump_1.gain"], {}, "each parameter once"),
    "no input": (["pump_1.gain"], ("level_1",), "an input of quadruple-tank, which may stand"),
    "no output": (["pump_1.gain"], ("pump_1",), "a measurement of quadruple-tank"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_fitted_is_refused(case, plant, four_tanks):
    names, columns, message = REFUSED[case]
    record = record_of(four_tanks)
    if columns:
        kept = tuple(s for s in record.signals if s.name in columns)
        record = replace(record, signals=kept)
    with pytest.raises(InputError, match=message):
        fitted(plant, record, names)
