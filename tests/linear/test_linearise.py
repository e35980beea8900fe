"""The linear model against Johansson's matrices and against differences."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from brine_station import STATION
from refusals import refused
from written_plants import plant_of

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.linear.static_gain import static_gain


def test_matrices_equal_the_closed_forms(johansson):
    process = johansson.process
    model = linearise(find_equilibrium(process))
    A, B, C = johansson.matrices(johansson.levels(johansson.voltage))
    np.testing.assert_allclose(model.A, A, rtol=1e-9, atol=0)
    np.testing.assert_allclose(model.B, B, rtol=1e-9, atol=0)
    np.testing.assert_allclose(model.C, C, rtol=1e-9, atol=0)
    np.testing.assert_array_equal(model.D, np.zeros((4, 2)))
    E = np.zeros((4, 2))
    E[0, 0], E[1, 1] = 1 / johansson.area[0], 1 / johansson.area[1]
    np.testing.assert_allclose(model.E, E, rtol=1e-15, atol=0)
    assert model.states[2] == "tank_3.level"
    assert model.inputs == ("pump_1", "pump_2")
    assert model.outputs == ("level_1", "level_2", "level_3", "level_4")


def test_matrices_equal_differences(johansson):
    process = johansson.process
    point = find_equilibrium(process, {"pump_1": 2.2, "pump_2": 3.4})
    model = linearise(point)

    def rates(x, u, d):
        return np.array(process.dynamics(x, u, d, process.parameter_values)).ravel()

    place = [point.state, point.inputs, point.disturbances]
    for argument, (matrix, step) in enumerate([(model.A, 1e-5), (model.B, 1e-2), (model.E, 1e-7)]):
        for column in range(matrix.shape[1]):
            # Central differences at h and h/2, extrapolated: the error is of order h⁴.
            slopes = []
            for h in (step, step / 2):
                ahead, behind = [list(map(np.array, place)) for _ in range(2)]
                ahead[argument] = ahead[argument].astype(float)
                behind[argument] = behind[argument].astype(float)
                ahead[argument][column] += h
                behind[argument][column] -= h
                slopes.append((rates(*ahead) - rates(*behind)) / (2 * h))
            expected = (4 * slopes[1] - slopes[0]) / 3
            np.testing.assert_allclose(
                matrix[:, column], expected, rtol=1e-7, atol=1e-9 * np.abs(expected).max()
            )


def test_an_empty_tank_has_no_linear_model(minimum, make_process):
    process = minimum.process
    empty = find_equilibrium(process, {"pump_1": 3.0, "pump_2": 0.0})
    with refused(place="operating point, tank_3.level", value=0.0):
        linearise(empty)
    # The other way of writing the root has a derivative of zero there, which is not true either.
    process = make_process(
        lambda x, u, d: [0.01 * u[0] - ca.if_else(x[0] > 0, 0.1 * ca.sqrt(x[0]), 0)], 1, 1
    )
    with refused(remedy="no tank is empty"):
        linearise(find_equilibrium(process, {"pump_1": 0.0}))


@pytest.mark.parametrize("demand", [12, 15, 18, 20, 21, 24])
def test_a_level_that_drifts_carries_no_concentration_along(demand, tmp_path):
    # c = 200 q_b / (q_b + q_w), and full signals give 40 and 10 l/min.
    edit = ('nominal = "20 l/min"', f'nominal = "{demand} l/min"')
    gains = static_gain(plant_of(tmp_path, STATION, edit).linear.select(["strength"]))
    expected = [[-40.0 / demand * 40.0, 160.0 / demand * 10.0]]
    np.testing.assert_allclose(gains, expected, rtol=1e-9)
