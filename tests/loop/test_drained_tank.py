"""A tank that drains through a hole, against Torricelli's closed form."""

from pathlib import Path

import numpy as np
import pytest

from clepsydra.base.signal import Signal
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.runge_kutta import runge_kutta
from clepsydra.process.reader import load_process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Program
from clepsydra.program.reader import inline

AREA, HOLE, HEIGHT, GRAVITY = 28e-4, 0.071e-4, 0.2, 9.81


@pytest.fixture
def drained():
    """Return a function (step [s], samples) → levels, with the pump off, from a full tank."""
    process = load_process(Path(__file__).parents[1] / "one-tank.toml")

    def run(step: float, samples: int) -> np.ndarray:
        names = [p.name for p in process.parameters]
        builder = BlockBuilder(1 + len(names))
        arguments = [builder.constant(step), 0, builder.constant(0.0), *range(1, 1 + len(names))]
        next_state = inline(builder, runge_kutta(process.dynamics, 1), arguments, fused=True)
        block = builder.finish([*next_state, 0])
        program = Program(
            "drain", process.state, (), process.parameters, (Signal("level", "m"),), block
        )
        state = {"tank_1.level": HEIGHT}
        return Kernel(program).run(samples, state=state).output("level")[0]

    return run


def closed_form(time: np.ndarray) -> np.ndarray:
    """h(t) = (√h0 - a/A √(g/2) t)² until the tank is empty."""
    root = np.sqrt(HEIGHT) - HOLE / AREA * np.sqrt(GRAVITY / 2) * time
    return np.maximum(root, 0.0) ** 2


def test_a_draining_tank_follows_torricelli_while_there_is_liquid(drained):
    errors = []
    for step in (0.5, 0.25):
        samples = round(70 / step)
        exact = closed_form(step * np.arange(samples))
        assert exact[-1] > 0.01 * HEIGHT
        errors.append(np.max(np.abs(drained(step, samples) - exact)) / HEIGHT)
    assert errors[0] < 1e-8
    assert 14 < errors[0] / errors[1] < 18


def test_an_emptied_tank_stays_empty(drained):
    """At the last drop the flow has a corner; the error there shrinks with the step."""
    errors = []
    for step in (0.5, 0.05):
        samples = round(200 / step)
        level = drained(step, samples)
        exact = closed_form(step * np.arange(samples))
        assert exact[-1] == 0.0
        assert np.all(np.isfinite(level))
        errors.append(np.max(np.abs(level - exact)) / HEIGHT)
        assert abs(level[-1]) <= errors[-1] * HEIGHT
    assert errors[0] < 1e-4
    assert errors[1] < 1e-6
