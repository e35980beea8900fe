"""A function along trajectories, against CasADi's own evaluation."""

import casadi as ca
import numpy as np
import pytest

from clepsydra.engine.many_points import at_many_points
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process


@pytest.mark.parametrize("name", catalogue_names())
def test_readings_and_flows_of_a_process_are_those_of_casadi_in_every_bit(name):
    process = load_process(name)
    motion, parameters = process.motion, process.parameter_values
    random = np.random.default_rng(1)

    def within(signals):
        lows = [max(s.low, 0.0) for s in signals]
        highs = [s.high if np.isfinite(s.high) else 1.0 for s in signals]
        return random.uniform(lows, highs, (50, len(signals))).T if signals else np.zeros((0, 50))

    states = within(process.state)
    read = np.array(process.measure(states, parameters)).reshape(-1, 50)
    assert np.array_equal(at_many_points(process.measure, [states, parameters]), read)
    contents = at_many_points(motion.to_contents, [states, parameters])
    delayed, memories = np.zeros((len(motion.delays), 50)), within(motion.memories)
    held = [contents, delayed, memories, within(process.inputs), within(process.disturbances)]
    flows = np.array(motion.flows(*held, parameters)).reshape(-1, 50)
    found = at_many_points(motion.flows, [*held, parameters])
    # An equal-percentage valve has a power, whose last digit differs.
    assert found == pytest.approx(flows, rel=1e-14, abs=1e-16)


def test_each_argument_may_move_or_stand():
    x, y = ca.SX.sym("x"), ca.SX.sym("y", 2)
    function = ca.Function("f", [x, y], [x + y[0], x * y])
    line = np.array([[1.0, 2.0]])
    assert at_many_points(function, [line, [3.0, 5.0]], 1).tolist() == [[3.0, 6.0], [5.0, 10.0]]
    table = [[1.0, 2.0], [3.0, 4.0]]
    assert at_many_points(function, [[10.0], table]).tolist() == [[11.0, 12.0]]


def test_functions_of_one_shape_are_told_apart():
    x = ca.SX.sym("x")
    double, square = (ca.Function("f", [x], [value]) for value in (2 * x, x * x))
    assert at_many_points(double, [[[3.0]]]).item() == 6.0
    assert at_many_points(square, [[[3.0]]]).item() == 9.0
