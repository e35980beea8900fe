"""Named signals: selection, and the way to python-control and back."""

from __future__ import annotations

import control
import numpy as np
import pytest
from refusals import refused

from clepsydra import InputError, LinearModel
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.linear.response import frequency_response


@pytest.fixture
def model(minimum):
    process = minimum.process
    return linearise(find_equilibrium(process))


def test_selection_keeps_the_order_asked_for(model):
    part = model.select(outputs=["level_4", "level_1"], inputs=["pump_2"])
    np.testing.assert_array_equal(part.B, model.B[:, [1]])
    np.testing.assert_array_equal(part.C, model.C[[3, 0]])
    assert part.D.shape == (2, 1)
    assert (part.outputs, part.inputs) == (("level_4", "level_1"), ("pump_2",))
    assert part.point is model.point


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"outputs": ["level_5"]}, "outputs: got 'level_5', expected one of level_1"),
        ({"inputs": ["pump1"]}, "perhaps 'pump_1' was meant"),
        ({"inputs": ["pump_1", "pump_1"]}, "expected each name once"),
    ],
)
def test_unknown_names_are_refused(model, asked, message):
    with pytest.raises(InputError, match=message):
        model.select(**asked)


def test_shapes_that_disagree_with_names_are_refused(model):
    with pytest.raises(ValueError, match=r"B is \(4, 2\), its names make \(4, 1\)"):
        LinearModel(
            model.A, model.B, model.E, model.C, model.D,
            model.states, ("pump_1",), model.disturbances, model.outputs,
        )  # fmt: skip


def test_the_way_to_python_control_and_back_loses_nothing(model):
    system = model.to_control()
    assert isinstance(system, control.StateSpace)
    back = LinearModel.from_control(system, disturbances=("inflow_1", "inflow_2"))
    for name in "ABECD":
        np.testing.assert_array_equal(getattr(back, name), getattr(model, name))
    for name in ("states", "inputs", "disturbances", "outputs"):
        assert getattr(back, name) == getattr(model, name)


def test_a_state_that_nothing_moves_survives(model):
    idle = LinearModel(
        np.diag([-1.0, 0.0]), np.array([[1.0], [0.0]]), np.zeros((2, 0)), np.array([[1.0, 0.0]]),
        np.zeros((1, 1)), ("a", "b"), ("u",), (), ("y",),
    )  # fmt: skip
    assert LinearModel.from_control(idle.to_control()).states == ("a", "b")


def test_python_control_computes_the_same_response(model):
    omegas = np.array([0.0, 1e-3, 0.02, 1.0])
    theirs = model.to_control()(1j * omegas)[:, :2]
    ours = frequency_response(model, omegas)
    assert ours.shape == (4, 4, 2)
    np.testing.assert_allclose(ours, np.moveaxis(theirs, 2, 0), rtol=1e-12, atol=1e-15)


def test_response_equals_the_transfer_function(johansson):
    process = johansson.process
    model = linearise(find_equilibrium(process))
    t1, _, t3, _ = johansson.time_constants(johansson.levels(johansson.voltage))
    (g1, g2), (k1, k2) = johansson.gamma, johansson.gain
    c1, c2 = (t1 * k * johansson.sensor / johansson.area[0] for k in (k1, k2))
    s = 1j * np.logspace(-4, 1, 11)
    response = frequency_response(model, s.imag)
    np.testing.assert_allclose(response[:, 0, 0], g1 * c1 / (1 + s * t1), rtol=1e-12)
    np.testing.assert_allclose(
        response[:, 0, 1], (1 - g2) * c2 / ((1 + s * t1) * (1 + s * t3)), rtol=1e-12
    )


def test_frequencies_that_have_no_response_are_refused(model):
    with refused(expected="finite frequencies"):
        frequency_response(model, [0.1, np.nan])
    one = np.eye(1)
    tank = LinearModel(0 * one, one, one[:, :0], one, 0 * one, ("h",), ("u",), (), ("y",))
    with refused(expected="no pole of the model"):
        frequency_response(tank, [0.1, 0.0])


def test_what_cannot_come_from_python_control():
    with refused(value="TransferFunction", expected="a control.StateSpace"):
        LinearModel.from_control(control.tf([1], [1, 1]))
    with refused(value=0.1, expected="a continuous system"):
        LinearModel.from_control(control.ss(0.5, 1, 1, 0, 0.1))
    through = control.ss(-1.0, 1.0, 1.0, 2.0, inputs=["flow"])
    with refused(expected="zeros in the columns of the disturbances"):
        LinearModel.from_control(through, disturbances=["flow"])
    with refused(value="flw"):
        LinearModel.from_control(through, disturbances=["flw"])
