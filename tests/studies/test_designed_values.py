"""A design's numbers are rounded as they are read, and its loop does not notice."""

from contextlib import suppress
from functools import cache

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.studies.designs import DESIGNS


def percent_of(signal):
    """Return how many units of a signal are 1 %."""
    return (signal.from_percent(100.0) - signal.from_percent(0.0)) / 100.0


@pytest.mark.parametrize("process", ["wet-well", "laboratory-four-tanks-nonminimum-phase"])
def test_what_is_read_of_a_loop_is_what_runs(process):
    """Six digits of K in %/% and of Ti in s are the whole number."""
    plant = cl.load(process)
    controller = cl.design.simc(plant)
    pairs = zip(controller.measurements, controller.manipulated, strict=True)
    for measured, moved in pairs:
        gain = controller.values[f"{measured}.proportional_gain"]
        signal = plant.process.signal
        percent = gain * percent_of(signal(measured)) / percent_of(signal(moved))
        assert percent == pytest.approx(float(f"{percent:.5e}"), rel=1e-14), measured
        time = controller.values[f"{measured}.integral_time"]
        assert time == float(f"{time:.5e}"), measured


#: Of the usual designs; what switches or is scheduled jumps by a sample or with its points.
NAMES = [name for name in DESIGNS if name != "Start/stop levels" and "scheduling" not in name]


@cache
def plant_of(process):
    return cl.load(process)


def where_it_applies(name):
    """Return a design's controllers of two processes, of others than the next design's."""
    catalogue = [entry.name for entry in cl.catalogue()]
    first = 2 * NAMES.index(name) % len(catalogue)
    found = {}
    for process in (*catalogue[first:], *catalogue[:first]):
        with suppress(cl.ClepsydraError):
            found[process] = DESIGNS[name](plant_of(process).analysis)
        if len(found) == 2:
            break
    return found


def judged(controller, process):
    """Return max|S|, errors and moves of a controller's loop."""
    plant = plant_of(process)
    run = Loop(controller, plant.measured).run(default_scenario(plant.linear))
    found = {"max|S|": sampled_loop(controller, plant.measured).maximum_sensitivity}
    for output in plant.process.controlled:
        error = run.values[f"{output}.setpoint"] - run.true_measurement(output)
        found[f"error of {output}"] = float(np.sum(np.abs(error)))
    for signal in plant.process.inputs:
        found[f"moves of {signal.name}"] = float(np.sum(np.abs(np.diff(run.values[signal.name]))))
    return found


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_no_loop_and_no_score_changes_by_a_thousandth(name, monkeypatch):
    """max|S|, errors and moves of the law as it is and as the design found it."""
    rounded = where_it_applies(name)
    assert len(rounded) == 2
    module = "clepsydra.designs.designed_values"
    monkeypatch.setattr(f"{module}.rounded", lambda value, digits, size=0.0: value)
    monkeypatch.setattr(f"{module}.rounded_matrix", lambda matrix, digits, sizes: matrix)
    for process, controller in rounded.items():
        numbers = judged(controller, process)
        exactly = DESIGNS[name](plant_of(process).analysis)
        for key, exact in judged(exactly, process).items():
            assert numbers[key] == pytest.approx(exact, rel=1e-3), f"{process}, {key}"
