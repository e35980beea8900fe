"""Gain scheduling: tables, filter, and changes of gains that move nothing."""

import casadi as ca
import numpy as np
import pytest
from law_function import function_of
from refusals import refused
from scan_rig import ScannedLaw, at_rest

import clepsydra as cl
from clepsydra import PidForm, Signal
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.gain_scheduling import Schedule, scheduled_law, scheduled_lqi_law
from clepsydra.controllers.pid import multiloop_pid_law

LEVEL, PUMP = Signal("level", "m", low=0.0, high=10.0), Signal("pump", "%", low=0.0, high=100.0)


def followed(schedule, numbers):
    return float(schedule.followed(Sample({name: ca.DM(v) for name, v in numbers.items()})))


@pytest.fixture(scope="module")
def averaging():
    return cl.load("averaging-tank")


def table_of(points, values):
    schedule = Schedule("level.sp", LEVEL, len(points))
    symbols = {f"schedule.point.{k}": ca.DM(p) for k, p in enumerate(points, start=1)}
    symbols |= {f"gain.at.{k}": ca.DM(v) for k, v in enumerate(values, start=1)}
    return lambda at: float(
        schedule.interpolated(Sample(symbols), ca.DM(at), [Signal("gain")])["gain"]
    )


def test_the_table_is_numpys_interpolation():
    random = np.random.default_rng(1)
    points, values = np.sort(random.uniform(0, 10, 7)), random.normal(size=7)
    table = table_of(points, values)
    for at in [*points, *random.uniform(-3, 13, 200)]:
        assert table(at) == pytest.approx(np.interp(at, points, values), rel=1e-12, abs=1e-14)
    # At its points it has the values of the table in every digit.
    assert [table(at) for at in points] == values.tolist()


def test_points_that_do_not_rise_divide_by_nothing():
    table = table_of([2.0, 2.0, 6.0], [1.0, 5.0, 7.0])
    assert np.isfinite([table(at) for at in (1.0, 2.0, 2.5, 6.0, 9.0)]).all()
    assert table(4.0) == 6.0


def scheduled_pi(form=None):
    plain = multiloop_pid_law([LEVEL], [PUMP], form)
    schedule = Schedule("level.pv", LEVEL, 3)
    return scheduled_law(plain, schedule, ["level.proportional_gain", "level.integral_time"])


def test_the_filter_is_of_first_order():
    """s(k) = s(k−1) + Δt/(T + Δt) (y − s(k−1)), to 1 − (T/(T + Δt))^k of a step."""
    schedule = Schedule("level.pv", LEVEL, 2)
    value = 4.0
    for k in range(1, 20):
        symbols = {"level.pv": 9.0, "level.good": 1, "schedule.variable": value,
                   "time_step": 0.5, "schedule.filter_time": 3.0}  # fmt: skip
        value = float(followed(schedule, symbols))
        assert value == pytest.approx(4.0 + 5.0 * (1.0 - (3.0 / 3.5) ** k), rel=1e-12)


@pytest.mark.parametrize("fault", [{"level.pv": np.nan}, {"level.good": 0.0}, {"time_step": 0}])
def test_a_fault_holds_the_scheduling_variable(fault):
    schedule = Schedule("level.pv", LEVEL, 2)
    symbols = {"level.pv": 9.0, "level.good": 1.0, "schedule.variable": 4.0, "time_step": 0.5,
                   "schedule.filter_time": 3.0} | fault  # fmt: skip
    assert float(followed(schedule, symbols)) == 4.0


@pytest.mark.parametrize("form", [
    PidForm(), PidForm("PI", anti_windup="clamping"), PidForm("PID"), PidForm("PI", "series"),
], ids=["isa", "clamping", "PID", "series"])  # fmt: skip
def test_scheduled_gains_move_no_output_by_themselves(form):
    """An error of zero and a setpoint weight of 0.3, while the gains run over their table."""
    law = scheduled_pi(form)
    table = {"level.proportional_gain": [2.0, 11.0, 5.0], "level.integral_time": [40.0, 10.0, 90.0]}
    values = {parameter.name: parameter.initial for parameter in law.parameters}
    values |= {f"{n}.at.{k}": v for n, row in table.items() for k, v in enumerate(row, start=1)}
    values |= {"schedule.point.1": 1.0, "schedule.point.2": 5.0, "schedule.point.3": 9.0,
               "level.setpoint_weight": 0.3, "schedule.filter_time": 20.0}  # fmt: skip
    state = {entry.name: entry.initial for entry in law.state} | {"level.integral": 40.0}
    state |= {"schedule.variable": 1.0, "level.last_proportional_gain": 2.0,
              "level.last_setpoint_weight": 0.3}  # fmt: skip
    if form.has_derivative:
        state |= {"level.filtered_signal": 8.5, "level.last_derivative_time": 0.0}
        state |= {"level.last_derivative_filter": 10.0}
    inputs = {s.name: s.initial for s in law.inputs} | {"level.sp": 8.5, "level.pv": 8.5}
    gains, outputs = [], []
    for _ in range(200):
        following, (output, *_), _ = function_of(law)(
            [state[e.name] for e in law.state],
            [inputs[s.name] for s in law.inputs],
            [values[p.name] for p in law.parameters],
        )
        state = dict(zip((entry.name for entry in law.state), following, strict=True))
        outputs.append(output)
        gains.append(state["level.last_proportional_gain"])
    assert max(gains) > 10.0 and gains[-1] < 6.0
    assert max(outputs) - min(outputs) < 1e-9 * PUMP.span


def test_scheduled_lqi_moves_no_output_by_its_gains():
    controller = cl.design.gain_scheduled_lqi(
        cl.load("quadruple-tank"), over="level_1", points=[3.0, 6.0, 9.0]
    )
    law = ScannedLaw(controller, 1.0)
    shown = {"level_1.pv": 8.5, "level_2.pv": 4.0, "level_3.pv": 2.0, "level_4.pv": 3.0}
    first = law.scan(**shown, level_1_sp=8.5, level_2_sp=4.0)
    gains = []
    for _ in range(300):
        outputs = law.scan(**shown)
        gains.append(law.state["pump_1.feedback.level_1"])
        for i in (1, 2):
            assert outputs[f"pump_{i}.out"] == pytest.approx(first[f"pump_{i}.out"], abs=1e-9)
    assert max(gains) - min(gains) > 1e-3 * abs(gains[0])


@pytest.mark.thorough
def test_scheduled_lqi_at_its_operating_point_is_lqi(averaging):
    """In every sample, for small deviations: the schedule passes through the plain design."""
    pair = (
        cl.design.lqi(averaging),
        cl.design.gain_scheduled_lqi(averaging, over="volume", points=["1 m^3", "2 m^3", "3 m^3"]),
    )
    laws = [ScannedLaw(controller, 0.1) for controller in pair]
    random = np.random.default_rng(4)
    given = at_rest(pair[0], averaging)
    for _ in range(50):
        given["concentration.pv"] = 5000.0 + 20.0 * random.normal()
        found = [law.scan(**given) for law in laws]
        for name, value in found[0].items():
            assert found[1][name] == pytest.approx(value, rel=1e-9, abs=1e-9)


def test_the_linear_model_halfway_is_that_of_the_interpolated_gains(averaging):
    """Whatever the sensors say, the law moves by its gains of the last sample."""
    controller = cl.design.gain_scheduled_pid(
        averaging, over="volume", points=["1 m^3", "2 m^3", "3 m^3"]
    )
    law = ScannedLaw(controller, 0.1)
    given = at_rest(controller, averaging)
    given |= {"volume.pv": 2.5, "volume.sp": 2.5}
    for _ in range(3000):
        first = law.scan(**given)
    given["concentration.pv"] += 1.0
    second = law.scan(**given)
    gain = 0.5 * sum(controller.values[f"concentration.proportional_gain.at.{k}"] for k in (2, 3))
    moved = f"{controller.manipulated[controller.setpoints.index('concentration')]}.out"
    moved = second[moved] - first[moved]
    assert moved == pytest.approx(-gain, rel=1e-6)


def test_what_cannot_be_scheduled_is_refused():
    with refused(value="clamping"):
        scheduled_lqi_law([LEVEL], [PUMP], ["level"], Schedule("level.sp", LEVEL, 2), "clamping")
