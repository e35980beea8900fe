"""Gain scheduling: tables, filter, and changes of gains that move nothing."""

import casadi as ca
import numpy as np
import pytest
from law_function import function_of
from refusals import refused
from scan_rig import ScannedLaw, at_rest

import clepsydra as cl
from clepsydra import PidForm, Signal
from clepsydra.controllers.blocks.schedule import Schedule
from clepsydra.controllers.gain_scheduling import scheduled_law, scheduled_lqi_law
from clepsydra.controllers.multiloop_pid import multiloop_pid_law

LEVEL, PUMP = Signal("level", "m", low=0.0, high=10.0), Signal("pump", "%", low=0.0, high=100.0)


def followed(schedule, numbers):
    found = schedule.followed({name: ca.DM(value) for name, value in numbers.items()})
    return float(found.outputs["followed"])


@pytest.fixture(scope="module")
def averaging():
    return cl.load("averaging-tank")


def table_of(points, values):
    schedule = Schedule("setpoint_1", LEVEL, len(points))
    symbols = {f"schedule_point_{k}": ca.DM(p) for k, p in enumerate(points, start=1)}
    symbols |= {f"gain_at_{k}": ca.DM(v) for k, v in enumerate(values, start=1)}
    return lambda at: float(schedule.interpolated(symbols, ca.DM(at), ["gain"])["gain"])


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
    plain = multiloop_pid_law(1, form, measured=[LEVEL], manipulated=[PUMP])
    schedule = Schedule("measurement_1", LEVEL, 3)
    return scheduled_law(plain, schedule, ["proportional_gain_1", "integral_time_1"])


def test_the_filter_is_of_first_order():
    """s(k) = s(k−1) + Δt/(T + Δt) (y − s(k−1)), to 1 − (T/(T + Δt))^k of a step."""
    schedule = Schedule("measurement_1", LEVEL, 2)
    value = 4.0
    for k in range(1, 20):
        symbols = {"measurement_1": 9.0, "sensor_1": 1, "scheduling_variable": value,
                   "time_step": 0.5, "schedule_filter_time": 3.0}  # fmt: skip
        value = float(followed(schedule, symbols))
        assert value == pytest.approx(4.0 + 5.0 * (1.0 - (3.0 / 3.5) ** k), rel=1e-12)


@pytest.mark.parametrize("fault", [{"measurement_1": np.nan}, {"sensor_1": 0.0}, {"time_step": 0}])
def test_a_fault_holds_the_scheduling_variable(fault):
    schedule = Schedule("measurement_1", LEVEL, 2)
    symbols = {"measurement_1": 9.0, "sensor_1": 1.0, "scheduling_variable": 4.0, "time_step": 0.5,
                   "schedule_filter_time": 3.0} | fault  # fmt: skip
    assert float(followed(schedule, symbols)) == 4.0


@pytest.mark.parametrize("form", [
    PidForm(), PidForm("PI", anti_windup="clamping"), PidForm("PID"), PidForm("PI", "series"),
], ids=["isa", "clamping", "PID", "series"])  # fmt: skip
def test_scheduled_gains_move_no_output_by_themselves(form):
    """An error of zero and a setpoint weight of 0.3, while the gains run over their table."""
    law = scheduled_pi(form)
    table = {"proportional_gain_1": [2.0, 11.0, 5.0], "integral_time_1": [40.0, 10.0, 90.0]}
    values = {parameter.name: parameter.initial for parameter in law.parameters}
    values |= {f"{n}_at_{k}": v for n, row in table.items() for k, v in enumerate(row, start=1)}
    values |= {"schedule_point_1": 1.0, "schedule_point_2": 5.0, "schedule_point_3": 9.0,
               "setpoint_weight_1": 0.3, "schedule_filter_time": 20.0}  # fmt: skip
    state = {entry.name: entry.initial for entry in law.state} | {"integral_1": 40.0}
    state |= {"scheduling_variable": 1.0, "last_proportional_gain_1": 2.0,
              "last_setpoint_weight_1": 0.3}  # fmt: skip
    if form.has_derivative:
        state |= {"filtered_signal_1": 8.5, "last_derivative_time_1": 0.0}
        state |= {"last_derivative_filter_1": 10.0}
    inputs = {s.name: s.initial for s in law.inputs} | {"setpoint_1": 8.5, "measurement_1": 8.5}
    gains, outputs = [], []
    for _ in range(200):
        following, (output, *_), _ = function_of(law)(
            [state[e.name] for e in law.state],
            [inputs[s.name] for s in law.inputs],
            [values[p.name] for p in law.parameters],
        )
        state = dict(zip((entry.name for entry in law.state), following, strict=True))
        outputs.append(output)
        gains.append(state["last_proportional_gain_1"])
    assert max(gains) > 10.0 and gains[-1] < 6.0
    assert max(outputs) - min(outputs) < 1e-9 * PUMP.span


def test_scheduled_lqi_moves_no_output_by_its_gains():
    controller = cl.design.gain_scheduled_lqi(
        cl.load("quadruple-tank"), over="level_1", points=[3.0, 6.0, 9.0]
    )
    law = ScannedLaw(controller, 1.0)
    shown = {"measurement_1": 8.5, "measurement_2": 4.0, "measurement_3": 2.0, "measurement_4": 3.0}
    first = law.scan(**shown, setpoint_1=8.5, setpoint_2=4.0)
    gains = []
    for _ in range(300):
        outputs = law.scan(**shown)
        gains.append(law.state["feedback_1_1"])
        for i in (1, 2):
            assert outputs[f"manipulated_{i}"] == pytest.approx(first[f"manipulated_{i}"], abs=1e-9)
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
    places = {name: k for k, name in enumerate(pair[0].measurements, start=1)}
    for _ in range(50):
        given[f"measurement_{places['concentration']}"] = 5000.0 + 20.0 * random.normal()
        found = [law.scan(**given) for law in laws]
        for name, value in found[0].items():
            assert found[1][name] == pytest.approx(value, rel=1e-9, abs=1e-9)


def test_the_linear_model_halfway_is_that_of_the_interpolated_gains(averaging):
    """Whatever the sensors say, the law moves by its gains of the last sample."""
    controller = cl.design.gain_scheduled_pid(
        averaging, over="volume", points=["1 m^3", "2 m^3", "3 m^3"]
    )
    loop = controller.setpoints.index("concentration") + 1
    law = ScannedLaw(controller, 0.1)
    given = at_rest(controller, averaging)
    volume = controller.measurements.index("volume") + 1
    given |= {f"measurement_{volume}": 2.5, f"setpoint_{volume}": 2.5}
    for _ in range(3000):
        first = law.scan(**given)
    given[f"measurement_{loop}"] += 1.0
    second = law.scan(**given)
    gain = 0.5 * sum(controller.values[f"proportional_gain_{loop}_at_{k}"] for k in (2, 3))
    moved = second[f"manipulated_{loop}"] - first[f"manipulated_{loop}"]
    assert moved == pytest.approx(-gain, rel=1e-6)


def test_what_cannot_be_scheduled_is_refused():
    plain = multiloop_pid_law(1, measured=[LEVEL], manipulated=[PUMP])
    with refused(value="gian"):
        scheduled_law(plain, Schedule("measurement_1", LEVEL, 2), ["gian"])
    with refused(value="measurement_7"):
        scheduled_law(plain, Schedule("measurement_7", LEVEL, 2), ["proportional_gain_1"])
    with refused(place="points"):
        Schedule("measurement_1", LEVEL, 1)
    with refused(place="variable"):
        Schedule("mode_1", LEVEL, 3)
    with refused(value="clamping"):
        scheduled_lqi_law([LEVEL], [PUMP], [1], Schedule("setpoint_1", LEVEL, 2), "clamping")
