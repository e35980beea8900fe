"""The relay experiment on three equal lags, against its exact limit cycle."""

import dataclasses
import math

import casadi as ca
import numpy as np
import pytest
from plain_process import plain_process
from scipy.linalg import expm
from scipy.optimize import brentq

from clepsydra import InputError, NotApplicable, Signal
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.relay_experiment import relay_experiment
from clepsydra.process.reader import load_process

A = np.array([[-1.0, 0.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, -1.0]])
B, C = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def three_lags(period, *, sign=1.0, bias=5.0):
    """Return the model of y = sign/(s + 1)³ (u − bias) as a process."""
    x, u, none = ca.SX.sym("x", 3), ca.SX.sym("u"), ca.SX(0, 1)
    levels = tuple(f"tank_{i}.level" for i in (1, 2, 3))
    process = plain_process(
        name="lags", title="", source="",
        state=tuple(Signal(name, "m", low=-10.0, high=10.0) for name in levels),
        inputs=(Signal("pump", "V", low=0.0, high=10.0, initial=bias),),
        disturbances=(),
        measurements=(Signal("level", "V", low=-10.0, high=10.0),),
        controlled=("level",),
        parameters=(),
        dynamics=ca.Function("f", [x, u, none, none], [ca.mtimes(A, x) + B * (u - bias)]),
        measure=ca.Function("g", [x, none], [sign * x[2]]),
        measured_state={"level": levels[2]},
        elements=(), nominal_outputs={}, sampling_period=period,
    )  # fmt: skip
    point = OperatingPoint(process, np.zeros(3), np.array([bias]), np.zeros(0), np.zeros(1), 0.0)
    return linearise(point)


def limit_cycle(hysteresis):
    """Return half period and amplitude under a relay of 1, exact (Tsypkin's condition).

    Half a cycle takes x to −x: x = (I + e^{Ah})⁻¹ ∫ e^{As} B ds under u = −1, and the output is
    ε at the switch.
    """
    identity = np.eye(3)

    def at_switch(h):
        moved = np.linalg.solve(A, (expm(A * h) - identity) @ B)
        return np.linalg.solve(identity + expm(A * h), moved)

    half = brentq(lambda h: C @ at_switch(h) - hysteresis, 0.8, 6.0)
    x = at_switch(half)
    times = np.linspace(0.0, half, 20_001)
    path = [
        C @ (expm(A * t) @ x - np.linalg.solve(A, (expm(A * t) - identity) @ B))
        for t in times[::40]
    ]
    return half, max(np.abs(path))


def swing(record):
    """Return period and amplitude of the last whole cycles of a record."""
    rises = np.flatnonzero(np.diff(record.manipulated) > 0.0)
    first, last = rises[-4], rises[-1]
    return np.mean(np.diff(record.time[rises[-4:]])), np.ptp(record.measured[first:last]) / 2


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("hysteresis", [0.0, 0.03])
def test_three_equal_lags_swing_in_their_exact_limit_cycle(hysteresis, sign):
    half, amplitude = limit_cycle(hysteresis)
    model = three_lags(0.01, sign=sign)
    record = relay_experiment(model, "level", "pump", amplitude=1.0, hysteresis=hysteresis)
    period, reached = swing(record)
    # The relay switches up to one sample late, on the mean half of one: a dead time τ lengthens
    # the period by 4/3 · 2π/√3 · τ.
    assert period == pytest.approx(2 * half + 0.024, abs=0.02)
    assert reached == pytest.approx(amplitude, rel=0.02)
    assert sorted(set(record.manipulated)) == [4.0, 6.0]


def test_the_describing_function_is_near_the_truth_of_three_equal_lags():
    """Ku = 8 and Tu = 2π/√3; the lags let 1 % of the square wave's third harmonic through."""
    half, _ = limit_cycle(0.0)
    assert 2 * half == pytest.approx(2 * math.pi / math.sqrt(3.0), rel=0.02)
    record = relay_experiment(three_lags(0.01), "level", "pump")
    period, reached = swing(record)
    relay = np.ptp(record.manipulated) / 2
    # The describing function errs by 2.4 % in the gain and 1.4 % in the period, and the relay
    # of a sampled loop is half a sample late in each half of the cycle.
    assert 4.0 * relay / (math.pi * reached) == pytest.approx(8.0, rel=0.04)
    assert period == pytest.approx(2 * math.pi / math.sqrt(3.0), rel=0.025)


def test_the_nonlinear_process_is_moved_about_its_operating_point():
    analysis = analyse(load_process("quadruple-tank-nonminimum-phase"))
    record = relay_experiment(analysis.model, "level_1", "pump_2", amplitude=0.3)
    assert record.bias == pytest.approx(3.15)
    assert sorted(set(record.manipulated)) == pytest.approx([2.85, 3.45])
    assert record.measured[0] == pytest.approx(analysis.operating_point.as_dict()["level_1"])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"amplitude": 6.0}, "reduce the amplitude"),
        ({"amplitude": 0.0}, "above 0"),
        ({"hysteresis": -1.0}, "from 0"),
        ({"duration": 0.01}, "at least 0.1 s"),
        ({"duration": "1 h"}, "at least 0.1 s"),
        ({"duration": 1e9}, "at most 1000000"),
    ],
)
def test_wrong_requests_are_refused(options, words):
    with pytest.raises(InputError, match=words):
        relay_experiment(three_lags(0.01), "level", "pump", **options)


def test_an_input_without_effect_is_not_applicable():
    model = three_lags(0.01)
    idle = dataclasses.replace(model, B=0.0 * model.B)
    with pytest.raises(NotApplicable, match="pump does not move level"):
        relay_experiment(idle, "level", "pump")
