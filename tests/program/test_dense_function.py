"""CasADi functions called with numbers."""

import casadi as ca
import numpy as np

from clepsydra.program.dense_function import DenseFunction, at_rows

x, y = ca.SX.sym("x", 2), ca.SX.sym("y")
POINTS = [np.array([[1.0, 2.0], [5.0, 6.0], [0.1, 0.7]]), np.array([[0.5], [0.0], [-3.0]])]


def test_rows_are_those_of_each_point_in_every_bit():
    function = ca.Function("law", [x, y], [ca.sqrt(x) / (y + 3.7), x[0] * y])
    alone = [np.array(function(*point)[0]).ravel() for point in zip(*POINTS, strict=True)]
    assert at_rows(function, POINTS).tolist() == np.array(alone).tolist()


def test_a_zero_that_casadi_leaves_out_is_a_zero():
    result = ca.SX(3, 1)
    result[2] = x[1] + y
    function = ca.Function("law", [x, y], [result])
    assert at_rows(function, POINTS).tolist() == [
        [0.0, 0.0, 2.5],
        [0.0, 0.0, 6.0],
        [0.0, 0.0, -2.3],
    ]


def test_no_point_has_no_row():
    function = ca.Function("law", [x, y], [x * y])
    assert at_rows(function, [np.zeros((0, 2)), np.zeros((0, 1))]).shape == (0, 2)


def test_matrices_at_each_point_are_those_of_each():
    slopes = DenseFunction("slopes", [x, y], [ca.jacobian(x * x[0] * y, x), ca.jacobian(y, x)])
    stacks = slopes.each(*POINTS)
    for place, point in enumerate(zip(*POINTS, strict=True)):
        for stack, matrix in zip(stacks, slopes(*point), strict=True):
            assert np.array_equal(stack[place], matrix)
