"""Loops whose warnings have closed forms: an integrating tank, and models written by hand."""

import functools

import casadi as ca
import numpy as np
import pytest
from plain_process import plain_process
from written_plants import plant_of

import clepsydra as cl
from clepsydra import LinearModel, PidForm, Signal
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import family, multiloop_pid_law
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.scenario import Scenario, Segment

# Its level in volts changes by 1e-4 / 1e-2 * 20 = 0.2 V/s for each volt of the pump.
TANK = """
name = "buffer"
title = "Buffer"
sampling_period = "{period} s"
controlled = ["level"]
[reservoirs.basin]
[tanks.tank]
area = "100 cm^2"
height = "0.5 m"
[pumps.pump]
source = "basin"
destination = "{destination}"
gain = "100 cm^3/(s V)"
range = ["0 V", "10 V"]
{trip}
[flows.demand]
source = "tank"
range = ["0 cm^3/s", "1000 cm^3/s"]
nominal = "{demand} cm^3/s"
step = "10 cm^3/s"
[sensors.level]
tank = "tank"
{sensor}
[operating_point]
level = "{rest}"
{more}
"""
VOLTS = 'gain = "0.2 V/cm"\nrange = ["0 V", "10 V"]'


@pytest.fixture(scope="module")
def tank(tmp_path_factory):
    """Return a function that analyses the tank with some of its lines changed."""

    @functools.cache
    def make(**changed):
        lines = {"period": 1, "destination": "tank", "trip": "", "demand": 500}
        lines |= {"sensor": VOLTS, "rest": "5 V", "more": ""}
        return plant_of(tmp_path_factory.mktemp("tank"), TANK.format(**lines | changed)).analysis

    return make


def pid_controller(model, form=None, pairing=None, **values) -> Controller:
    """Return multiloop PID controllers at rest, with given settings, the same in each loop."""
    form = form or PidForm()
    point = model.point
    process, at = point.process, point.as_dict()
    pairs = pairing or list(zip(process.controlled, model.inputs, strict=True))
    outputs, inputs = zip(*pairs, strict=True)
    law = multiloop_pid_law(
        [process.signal(name) for name in outputs], [process.signal(name) for name in inputs], form
    )
    given = {parameter.name: parameter.initial for parameter in law.parameters}
    chosen = {"tracking_time": values.get("integral_time", 60.0), **values}
    given |= {p.name: chosen[p.part] for p in law.parameters if p.part in chosen}
    rest = {f"{name}.tracking": at[name] for name in inputs}
    for name in outputs:
        rest |= {f"{name}.sp": at[name], f"{name}.pv": at[name]}
    return Controller(
        "by hand", family(form), "By hand.", law, given, state_at_rest(law, given, rest),
        outputs, outputs, inputs,
    )  # fmt: skip


@pytest.fixture
def pid():
    return pid_controller


@pytest.fixture
def proportional():
    """Return a function (model, K) that makes a proportional controller."""
    return lambda model, gain: pid_controller(model, PidForm("P"), proportional_gain=gain)


def steps_of(model, size, signal=None, length=50) -> Scenario:
    """Return a scenario in which one setpoint steps by a size after a tenth of the time."""
    point = model.point
    process, at = point.process, point.as_dict()
    name = signal or process.controlled[0]
    setpoints = np.tile([at[each] for each in process.controlled], (length, 1))
    setpoints[length // 10 :, process.controlled.index(name)] += size
    period = process.sampling_period
    segment = Segment("setpoint", name, length // 10 * period, length * period, size)
    return Scenario(
        period,
        setpoints,
        np.tile(point.disturbances, (length, 1)),
        np.zeros((length, len(process.measurements))),
        (segment,),
        seed=1,
    )


@pytest.fixture
def stepped():
    return steps_of


@pytest.fixture(scope="module")
def quadruple():
    return with_pi("quadruple-tank")


@pytest.fixture(scope="module")
def nonminimum():
    return with_pi("quadruple-tank-nonminimum-phase")


def with_pi(name):
    plant = cl.load(name)
    return plant.analysis, cl.design.simc(plant)


@pytest.fixture
def by_matrices():
    """Return a function that makes the model of a process from A, B and C."""
    return model_of


def model_of(A, B, C, period=1.0) -> LinearModel:
    A, B, C = (np.atleast_2d(np.asarray(each, float)) for each in (A, B, C))
    n, m, q = len(A), B.shape[1], len(C)
    x, u, none = ca.SX.sym("x", n), ca.SX.sym("u", m), ca.SX(0, 1)
    states = [f"tank_{i}.level" for i in range(1, n + 1)]
    inputs = tuple(Signal(f"pump_{i}", "V", low=-5.0, high=5.0) for i in range(1, m + 1))
    outputs = tuple(Signal(f"level_{i}", "V", low=-5.0, high=5.0) for i in range(1, q + 1))
    process = plain_process(
        name="by_matrices",
        title="",
        source="",
        state=tuple(Signal(name, "m", low=-1.0, high=1.0) for name in states),
        inputs=inputs,
        disturbances=(),
        measurements=outputs,
        controlled=tuple(signal.name for signal in outputs),
        parameters=(),
        dynamics=ca.Function("f", [x, u, none, none], [ca.mtimes(A, x) + ca.mtimes(B, u)]),
        measure=ca.Function("g", [x, none], [ca.mtimes(C, x)]),
        measured_state={signal.name: states[0] for signal in outputs},
        elements=(),
        nominal_outputs={},
        sampling_period=period,
    )
    point = OperatingPoint(
        process, np.zeros(n), np.zeros(m), np.zeros(0), np.zeros(q), residual=0.0
    )
    return LinearModel(
        A, B, np.zeros((n, 0)), C, np.zeros((q, m)), tuple(states),
        tuple(signal.name for signal in inputs), (), process.controlled, point,
    )  # fmt: skip
