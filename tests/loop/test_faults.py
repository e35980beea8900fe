"""Faults of sensors and final elements in a loop's program."""

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.engine.kernel import Kernel
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.loop import Loop

SAMPLES = 40
MANUAL = 0.0


@pytest.fixture(scope="module")
def run():
    """Return what the quadruple tank records with some inputs of its program."""
    plant = cl.load("quadruple-tank")
    loop = Loop(cl.design.simc(plant), plant.linear)
    program = closed_loop(loop.process, loop.controller, substeps=2, readings=True, faults=True)
    sound = {s.name: loop.at_rest().get(s.name, s.initial) for s in program.inputs}
    state = loop.initial_state() | {"pump_1.held": 3.0, "pump_2.held": 3.0}
    own = loop.law_parameters()
    parameters = {p.name: own.get(p.name, p.initial) for p in program.parameters}
    kernel = Kernel(program, fuse=False)

    def of(**given):
        told = {name.replace("__", "."): value for name, value in given.items()}
        found = kernel.run(SAMPLES, inputs=sound | told, parameters=parameters, state=state)
        names = [signal.name for signal in program.outputs]
        return dict(zip(names, found.record_of(0).T, strict=True))

    return of


def test_a_sound_loop_does_as_without_faults(run):
    plant = cl.load("quadruple-tank")
    loop = Loop(cl.design.simc(plant), plant.linear)
    program = closed_loop(loop.process, loop.controller, substeps=2)
    setpoint = np.full(SAMPLES, 6.5)
    found = Kernel(program, fuse=False).run(
        SAMPLES, inputs=loop.at_rest() | {"level_1.setpoint": setpoint},
        parameters={p.name: p.initial for p in program.parameters} | loop.law_parameters(),
        state=loop.initial_state(),
    )  # fmt: skip
    names = [signal.name for signal in program.outputs]
    bare = dict(zip(names, found.record_of(0).T, strict=True))
    failing = run(level_1__setpoint=setpoint)
    for name in ("level_1", "pump_1", "tank_4.level"):
        assert np.array_equal(failing[name], bare[name])
    assert np.array_equal(failing["pump_1.applied"], failing["pump_1"])


def test_a_transmitter_shows_what_it_is_forced_to(run):
    found = run(level_1__forced=np.arange(SAMPLES) >= 10, level_1__reading=2.5)
    assert np.all(found["level_1"][10:] == 2.5)
    # The controller believes it, and the level rises.
    assert found["level_1.true"][-1] > found["level_1.true"][9] + 0.1
    assert found["pump_1"][-1] > 5.0


def test_a_pump_that_stopped_moves_nothing_whatever_is_asked(run):
    found = run(pump_2__stopped=np.arange(SAMPLES) >= 5)
    assert np.all(found["pump_2.applied"][5:] == 0.0)
    assert found["pump_2"][-1] > 3.0
    assert found["tank_2.level"][-1] < found["tank_2.level"][5]


def test_a_final_element_sticks_until_it_is_asked_to_go_further(run):
    manual = 3.0 + 0.125 * np.arange(SAMPLES)
    found = run(
        pump_1__mode=MANUAL, pump_1__manual=manual, pump_1__stiction=0.5
    )  # 0.125 V are exact: it jumps in each fifth sample, when 0.625 V are asked for
    expected = manual[(np.arange(SAMPLES) // 5) * 5]
    assert np.array_equal(found["pump_1.applied"], expected)
    stuck = run(pump_1__mode=MANUAL, pump_1__manual=manual, pump_1__stiction=100.0)
    assert np.all(stuck["pump_1.applied"] == 3.0)
