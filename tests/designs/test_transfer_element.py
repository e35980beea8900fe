"""Elements of a linear model, against systems with known roots."""

import numpy as np
import pytest
from scipy.signal import zpk2ss

from clepsydra import LinearModel
from clepsydra.designs.models.transfer_element import transfer_element
from clepsydra.linear.response import frequency_response


def model_of(zeros, poles, high_frequency_gain):
    A, B, C, D = zpk2ss(zeros, poles, high_frequency_gain)
    n = len(A)
    return LinearModel(
        A, B, np.zeros((n, 0)), C, D, tuple(f"x{i}" for i in range(n)), ("u",), (), ("y",)
    )


@pytest.mark.parametrize(
    ("zeros", "poles"),
    [
        ([], [-0.1, -0.5]),
        ([0.3], [-0.1, -0.5, -2.0]),
        ([-0.3, 1.5], [-0.1, -0.5, -2.0, -3.0]),
        ([], [-0.2 + 1j, -0.2 - 1j, -3.0]),
        ([-1 + 0.4j, -1 - 0.4j], [-0.3, -0.7, -1.1]),
        ([0.7], [0.0, -0.4]),
        ([0.0], [-0.4, -3.0]),
    ],
)
@pytest.mark.parametrize("gain", [2.0, -0.5])
def test_response_is_that_of_the_model(zeros, poles, gain):
    model = model_of(zeros, poles, gain)
    found = transfer_element(model, "y", "u")
    omegas = np.logspace(-3, 2, 200)
    response = frequency_response(model, omegas)[:, 0, 0]
    assert [found.magnitude(w) for w in omegas] == pytest.approx(np.abs(response), rel=1e-8)
    angles = np.unwrap(np.angle(found.sign * response))
    phases = np.array([found.phase(w) for w in omegas])
    # The continuous phase starts at −90° for each integrator and loses no turn on the way.
    start = -0.5 * np.pi * found.integrators
    angles += 2 * np.pi * np.round((start - angles[0]) / (2 * np.pi))
    assert phases == pytest.approx(angles, abs=1e-6)
    away = [z for z in zeros if z != 0]
    assert sorted(np.real(found.zeros)) == pytest.approx(sorted(np.real(away)), rel=1e-6)


def test_quadruple_tank_elements_have_johanssons_gains_and_time_constants(minimum_phase):
    tank = minimum_phase
    direct = transfer_element(tank.model, "level_1", "pump_1")
    assert direct.gain == pytest.approx(tank.direct_gains[0], rel=1e-10)
    assert -1 / np.real(direct.poles) == pytest.approx([tank.T[0]], rel=1e-10)
    cross = transfer_element(tank.model, "level_2", "pump_1")
    assert cross.gain == pytest.approx(tank.cross_gains[1], rel=1e-10)
    assert -1 / np.real(cross.poles) == pytest.approx([tank.T[1], tank.T[3]], rel=1e-9)
    assert (direct.zeros, cross.zeros) == ((), ())


def test_an_input_without_effect_is_none(minimum_phase):
    model = minimum_phase.model
    idle = LinearModel(
        model.A, model.B * [1.0, 0.0], model.E, model.C, model.D,
        model.states, model.inputs, model.disturbances, model.outputs,
    )  # fmt: skip
    assert transfer_element(idle, "level_1", "pump_2") is None
    assert transfer_element(idle, "level_1", "pump_1") is not None
