"""Johansson's quadruple tank, written from his equations and closed forms."""

import dataclasses
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from plain_process import plain_process

from clepsydra import LinearModel, Signal
from clepsydra.linear.operating_point import OperatingPoint


@pytest.fixture(scope="module", autouse=True)
def what_the_methods_find():
    """Hold methods against their equations to the last digit, before their numbers are rounded.

    `test_designed_values.py` tests the rounding. A folder without `__init__.py` is no package for
    pytest: with that scope, every later test of the same worker would see unrounded numbers.
    """
    with pytest.MonkeyPatch.context() as patched:
        module = "clepsydra.designs.designed_values"
        patched.setattr(f"{module}.rounded", lambda value, digits, size=0.0: value)
        patched.setattr(f"{module}.rounded_matrix", lambda matrix, digits, sizes: matrix)
        yield


AREAS = np.array([28e-4, 32e-4, 28e-4, 32e-4])
OUTLETS = np.array([0.071e-4, 0.057e-4, 0.071e-4, 0.057e-4])
GRAVITY, SENSOR = 9.81, 50.0


def quadruple_tank(gamma_1, gamma_2, k_1, k_2, voltage):
    """Return the process, its linear model by closed form, and the closed form's numbers."""
    x, u, none = ca.SX.sym("x", 4), ca.SX.sym("u", 2), ca.SX(0, 1)
    flows = [OUTLETS[i] * ca.sqrt(2 * GRAVITY * ca.fmax(x[i], 0)) for i in range(4)]
    dynamics = ca.vertcat(
        (-flows[0] + flows[2] + gamma_1 * k_1 * u[0]) / AREAS[0],
        (-flows[1] + flows[3] + gamma_2 * k_2 * u[1]) / AREAS[1],
        (-flows[2] + (1 - gamma_2) * k_2 * u[1]) / AREAS[2],
        (-flows[3] + (1 - gamma_1) * k_1 * u[0]) / AREAS[3],
    )
    levels = [f"tank_{i}.level" for i in range(1, 5)]
    process = plain_process(
        name="quadruple_tank",
        title="",
        source="",
        state=tuple(Signal(name, "m", low=0.0, high=0.2) for name in levels),
        inputs=tuple(Signal(f"pump_{i}", "V", low=0.0, high=10.0, initial=voltage) for i in (1, 2)),
        disturbances=(),
        measurements=tuple(Signal(f"level_{i}", "V", low=0.0, high=10.0) for i in range(1, 5)),
        controlled=("level_1", "level_2"),
        parameters=(),
        dynamics=ca.Function("f", [x, u, none, none], [dynamics]),
        measure=ca.Function("g", [x, none], [SENSOR * x]),
        measured_state={f"level_{i}": f"tank_{i}.level" for i in range(1, 5)},
        elements=(),
        nominal_outputs={},
        sampling_period=1.0,
    )
    upper = np.array([(1 - gamma_2) * k_2, (1 - gamma_1) * k_1]) * voltage
    lower = np.array([gamma_1 * k_1, gamma_2 * k_2]) * voltage + upper
    outflows = np.concatenate([lower, upper])
    state = (outflows / OUTLETS) ** 2 / (2 * GRAVITY)
    T = AREAS / OUTLETS * np.sqrt(2 * state / GRAVITY)
    A = np.diag(-1 / T)
    A[0, 2], A[1, 3] = AREAS[2] / (AREAS[0] * T[2]), AREAS[3] / (AREAS[1] * T[3])
    B = np.array(
        [
            [gamma_1 * k_1 / AREAS[0], 0.0],
            [0.0, gamma_2 * k_2 / AREAS[1]],
            [0.0, (1 - gamma_2) * k_2 / AREAS[2]],
            [(1 - gamma_1) * k_1 / AREAS[3], 0.0],
        ]
    )
    point = OperatingPoint(process, state, np.full(2, voltage), np.zeros(0), SENSOR * state, 0.0)
    model = LinearModel(
        A=A,
        B=B,
        E=np.zeros((4, 0)),
        C=SENSOR * np.eye(2, 4),
        D=np.zeros((2, 2)),
        states=tuple(levels),
        inputs=("pump_1", "pump_2"),
        disturbances=(),
        outputs=("level_1", "level_2"),
        point=point,
    )
    gains = SENSOR * T[:2] / AREAS[:2]
    return SimpleNamespace(
        process=process,
        model=model,
        T=T,
        direct_gains=gains * [gamma_1 * k_1, gamma_2 * k_2],
        cross_gains=gains * [(1 - gamma_2) * k_2, (1 - gamma_1) * k_1],
    )


@pytest.fixture(scope="session")
def minimum_phase():
    return quadruple_tank(0.70, 0.60, 3.33e-6, 3.35e-6, 3.0)


@pytest.fixture(scope="session")
def nonminimum_phase():
    return quadruple_tank(0.43, 0.34, 3.14e-6, 3.29e-6, 3.15)


@pytest.fixture(scope="session")
def single_tank():
    return one_input_one_output


@pytest.fixture(scope="session")
def linear_law():
    return derivatives_at_rest


@pytest.fixture(scope="session")
def sampled_at():
    return with_sampling_period


def with_sampling_period(model, period):
    """Return the model as one of the same process with another sampling period."""
    process = dataclasses.replace(model.point.process, sampling_period=period)
    return dataclasses.replace(model, point=dataclasses.replace(model.point, process=process))


def one_input_one_output(A, B, C, *, low=0.0, high=10.0, at=5.0, period=1.0, span=10.0):
    """Return the model of a process of one input and one output with the given matrices."""
    A, B, C = np.atleast_2d(A), np.reshape(B, (-1, 1)), np.reshape(C, (1, -1))
    n = len(A)
    x, u, none = ca.SX.sym("x", n), ca.SX.sym("u"), ca.SX(0, 1)
    states = tuple(f"tank_{i + 1}.level" for i in range(n))
    process = plain_process(
        name="tank",
        title="",
        source="",
        state=tuple(Signal(name, "m") for name in states),
        inputs=(Signal("pump", "V", low=low, high=high, initial=at),),
        disturbances=(),
        measurements=(Signal("level", "V", low=0.0, high=span),),
        controlled=("level",),
        parameters=(),
        dynamics=ca.Function("f", [x, u, none, none], [ca.mtimes(A, x) + ca.mtimes(B, u - at)]),
        measure=ca.Function("g", [x, none], [ca.mtimes(C, x)]),
        measured_state={"level": states[-1]},
        elements=(),
        nominal_outputs={},
        sampling_period=period,
    )
    point = OperatingPoint(process, np.zeros(n), np.array([at]), np.zeros(0), np.zeros(1), 0.0)
    model = LinearModel(
        A, B, np.zeros((n, 0)), C, np.zeros((1, 1)), states, ("pump",), (), ("level",), point
    )
    return model


def derivatives_at_rest(controller, point):
    """Return A, B, C and D of the step law at rest, in automatic: x⁺ = A x + B w, u = C x + D w.

    w are the setpoints, then the measurements. States that keep their value are left out.
    """
    law, at = controller.law, point.as_dict()
    inputs = {signal.name: 1.0 for signal in law.inputs}  # automatic, and every sensor is sound
    inputs["time_step"] = point.process.sampling_period
    inputs |= {f"{name}.sp": at[name] for name in controller.setpoints}
    inputs |= {f"{name}.pv": at[name] for name in controller.measurements}
    x, w, p = (ca.SX.sym(name, law.function.numel_in(k)) for k, name in enumerate("xwp"))
    after, outputs, _ = law.function(x, w, p)
    moved = [k for k, signal in enumerate(law.outputs) if signal.part == "out"]
    results = [ca.jacobian(y, v) for y in (after, outputs[moved]) for v in (x, w)]
    A, B, C, D = (
        np.array(matrix)
        for matrix in ca.Function("derivatives", [x, w, p], results)(
            [controller.initial_state[entry.name] for entry in law.state],
            [inputs[signal.name] for signal in law.inputs],
            [controller.values[signal.name] for signal in law.parameters],
        )
    )
    names = [signal.name for signal in law.inputs]
    wanted = [f"{name}.sp" for name in controller.setpoints]
    wanted += [f"{name}.pv" for name in controller.measurements]
    columns = [names.index(name) for name in wanted]
    B, D = B[:, columns], D[:, columns]
    moves = np.any(np.hstack([A - np.eye(len(A)), B]) != 0.0, axis=1)
    return A[np.ix_(moves, moves)], B[moves], C[:, moves], D
