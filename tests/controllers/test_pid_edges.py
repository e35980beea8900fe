"""The PID at the edges of its settings, changed at run time to everything that can arrive."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as limits_of
from hypothesis import strategies as st
from pid_rig import (
    ANTI_WINDUPS,
    BUMP,
    HIGH,
    LOW,
    PlainPid,
    forms,
    name_of,
    one_loop,
    settings,
    winding_forms,
)

from clepsydra import PidForm
from clepsydra.controllers.blocks.status import read_status

STEP, REST = 0.5, 5.0
every_form = pytest.mark.parametrize("form", forms(), ids=name_of)
every_winding_form = pytest.mark.parametrize("form", winding_forms(), ids=name_of)
WITH_INTEGRAL = [form for form in forms() if form.has_integral]
with_integral = pytest.mark.parametrize("form", WITH_INTEGRAL, ids=name_of)
WITH_DERIVATIVE = [form for form in forms() if form.has_derivative]
with_derivative = pytest.mark.parametrize("form", WITH_DERIVATIVE, ids=name_of)


def level(sample):
    return REST + 1.5 * math.sin(0.2 * sample)


def trajectory(law, samples, start=0):
    return [
        law.moved(level_1_sp=REST + 0.5, level_1_pv=level(sample))
        for sample in range(start, start + samples)
    ]


@pytest.mark.sampled
@pytest.mark.parametrize("gain", [3.0, -3.0])
@pytest.mark.parametrize("weight", [1.0, 0.3])
@every_form
def test_positive_gain_raises_the_output_when_the_measurement_falls(form, gain, weight):
    """Reverse action for a positive gain, direct action for a negative one, in every part."""
    sign = math.copysign(1.0, gain)
    for given_inputs in ({"level_1.pv": REST - 1.0}, {"level_1.sp": REST + 1.0}):
        law = one_loop(form, settings(form, gain=gain, weight=weight), time_step=STEP)
        first = law.moved(**given_inputs)
        assert sign * (first - 50.0) > 0.2
        for _ in range(60):
            last = law.moved()
        if form.has_integral:  # and the integral goes the same way
            assert sign * (last - 50.0) > abs(gain) * 1.5
        if form.has_derivative:  # a level that falls faster and faster is met with more and more
            law = one_loop(form, settings(form, gain=gain, weight=weight), time_step=STEP)
            falling = [law.moved(level_1_pv=REST - 0.01 * k**2) for k in range(12)]
            assert all(sign * (after - before) > 0 for before, after in pairwise(falling[1:]))
            without = PidForm("PI" if form.has_integral else "P", form.algorithm)
            law = one_loop(without, settings(without, gain=gain, weight=weight), time_step=STEP)
            slower = [law.moved(level_1_pv=REST - 0.01 * k**2) for k in range(12)]
            assert sign * (falling[-1] - slower[-1]) > 0.5


@pytest.mark.parametrize("shape", ["gap", "squared"])
@pytest.mark.parametrize("gain", [3.0, -3.0])
@pytest.mark.parametrize("algorithm", ["isa", "parallel"])
@pytest.mark.parametrize("error", [0.4, 1.0, 1.6])
def test_gap_and_squared_action_have_the_sign_of_the_gain_and_their_shape(
    shape, gain, algorithm, error
):
    form = PidForm("PI", algorithm, error=shape)
    values = settings(form, gain=gain) | {"level_1.gap": 1.0, "level_1.gap_gain": 0.2}
    for way in (1.0, -1.0):
        law = one_loop(form, values | {"level_1.squared_error_scale": 2.0}, time_step=STEP)
        acting = (
            0.2 * error if error <= 1.0 else error - 0.8
        ) if shape == "gap" else error**2 / 2.0  # fmt: skip
        first = law.moved(level_1_pv=REST - way * error)
        assert first - 50.0 == pytest.approx(gain * way * acting, abs=BUMP)
        second = law.moved()
        expected = STEP * gain / 10.0 * way * acting
        assert second - first == pytest.approx(expected, abs=BUMP)


@pytest.mark.sampled
@with_integral
def test_the_shortest_integral_time_drives_to_the_limit_and_back(form):
    law = one_loop(form, settings(form, gain=3.0, integral_time=1e-6), time_step=STEP)
    for way, end in ((1.0, HIGH), (-1.0, LOW), (1.0, HIGH)):
        for _ in range(400):
            output = law.moved(level_1_sp=REST + way)
            assert LOW <= output <= HIGH
        assert output == end
        assert all(map(math.isfinite, law.state.values()))


@with_integral
def test_the_longest_integral_time_leaves_its_slope_and_nothing_else(form):
    samples = 200
    slow = one_loop(form, settings(form, gain=3.0, integral_time=1e9), time_step=STEP)
    rest = trajectory(slow, samples)
    off = one_loop(form, settings(form, gain=3.0), time_step=STEP)
    off.set(
        **{
            "level_1.integral_gain"
            if form.algorithm == "parallel"
            else "level_1.integral_time": 0.0
        }
    )
    difference = np.array(rest) - trajectory(off, samples)
    # K/Ti ∫ e: at most 3e-9 · 100 s · 2.
    assert 0 < np.max(np.abs(difference)) < 6e-7


@with_integral
def test_without_integral_time_integral_action_is_off(form):
    """Then it is the form without I, exactly; and it comes back without a bump."""
    name = "level_1.integral_gain" if form.algorithm == "parallel" else "level_1.integral_time"
    off = (0.0,) if form.algorithm == "parallel" else (0.0, -5.0)
    for value in off:
        law = one_loop(form, settings(form, gain=3.0), time_step=STEP)
        law.set(**{name: value})
        found = trajectory(law, 80)
        algorithm = "isa" if form.algorithm == "velocity" else form.algorithm
        actions = form.actions.replace("I", "")
        without = PidForm(actions, algorithm, form.derivative_on)
        plain = one_loop(without, settings(without, gain=3.0), time_step=STEP)
        assert found == pytest.approx(trajectory(plain, 80), abs=BUMP)
        ordinary = settings(form, gain=3.0)[name]
        twin = law.twin()
        law.set(**{name: ordinary})
        back, stays = (trajectory(instance, 1, start=80)[0] for instance in (law, twin))
        gained = 0.0
        if form.algorithm == "velocity":
            gained = STEP * 3.0 / 10.0 * (REST + 0.5 - level(80))
        assert back - stays == pytest.approx(gained, abs=BUMP)


@with_derivative
def test_without_derivative_time_it_is_the_form_without_derivative(form):
    name = "level_1.derivative_gain" if form.algorithm == "parallel" else "level_1.derivative_time"
    without = PidForm(form.actions.replace("D", ""), form.algorithm)
    plain = trajectory(one_loop(without, settings(without, gain=3.0), time_step=STEP), 80)
    off = (0.0,) if form.algorithm == "parallel" else (0.0, -1.0)
    for value in off:
        law = one_loop(form, settings(form, gain=3.0), time_step=STEP)
        law.set(**{name: value})
        law.state |= {name.replace(".", ".last_"): value}
        found = trajectory(law, 80)
        if value == 0.0:
            assert found == pytest.approx(plain, abs=BUMP)
        assert all(LOW <= output <= HIGH for output in found)


@pytest.mark.parametrize("ratio", [1.0, 1000.0])
@with_derivative
def test_the_filter_at_its_ends(form, ratio):
    """N = 1 and N = 1000, against the equations by backward differences."""
    values = settings(form, gain=3.0, derivative_time=2.0, derivative_filter=ratio)
    law = one_loop(form, values, time_step=STEP)
    plain = PlainPid(form, values, rest=REST)
    start, _ = plain.sample(REST, REST, STEP)
    expected, integral = [], 50.0 - start
    for sample in range(60):
        part, gained = plain.sample(REST + 0.5, level(sample), STEP)
        integral += gained if form.algorithm == "velocity" else 0.0
        expected.append(part + integral)
        integral += 0.0 if form.algorithm == "velocity" else gained
    assert trajectory(law, 60) == pytest.approx(expected, abs=BUMP)


@pytest.mark.parametrize("algorithm", ["isa", "series", "parallel"])
def test_without_a_filter_the_derivative_is_the_difference_quotient(algorithm):
    form = PidForm("PD", algorithm)
    law = one_loop(form, settings(form, gain=3.0, derivative_time=2.0), time_step=STEP)
    # An endless ratio of times is no filter.
    law.set(
        **{"level_1.filter_time" if algorithm == "parallel" else "level_1.derivative_filter": 0.0}
    )
    if algorithm != "parallel":
        law.set(level_1_derivative_filter=1e300)
    law.moved()
    found = law.moved(level_1_pv=REST - 0.25)
    assert found - 50.0 == pytest.approx(3.0 * (0.25 + 2.0 * 0.25 / STEP), abs=BUMP)
    assert law.moved() - 50.0 == pytest.approx(3.0 * 0.25, abs=BUMP)


@pytest.mark.sampled
@pytest.mark.parametrize("time_step", [0.0, -1.0, math.nan, math.inf])
@every_form
def test_without_a_time_step_everything_is_held_and_told(form, time_step):
    law = one_loop(form, settings(form, gain=3.0), time_step=STEP)
    last = trajectory(law, 20)[-1]
    state = dict(law.state)
    found = law.scan(level_1_pv=REST - 1.0, time_step=time_step)
    assert found["pump_1.out"] == last
    assert read_status(int(found["pump_1.status"])) == ("automatic", "invalid_time_step")
    assert law.state == state


@pytest.mark.sampled
@pytest.mark.parametrize("time_step", [1e9, 1e300])
@every_winding_form
def test_a_huge_time_step_leaves_numbers_within_the_limits(form, time_step):
    law = one_loop(form, settings(form, gain=3.0), time_step=STEP)
    trajectory(law, 20)
    for given_inputs in ({"time_step": time_step}, {"time_step": STEP}, {}, {}):
        for measured in (REST - 1.0, REST + 2.0):
            assert LOW <= law.moved(level_1_pv=measured, **given_inputs) <= HIGH
            assert all(math.isfinite(value) for value in law.state.values())


NONSENSE = (math.nan, math.inf, -math.inf, 1e308, -1e308, 0.0, 5e-324)


@pytest.mark.thorough
@every_winding_form
def test_a_parameter_changed_to_nonsense_and_back(form):
    """A gain that is no number holds the output; afterwards the law is as good as before."""
    names = one_loop(form, settings(form, gain=3.0)).values
    for name in names:
        for value in NONSENSE:
            law = one_loop(form, settings(form, gain=3.0), time_step=STEP)
            last = trajectory(law, 20)[-1]
            law.set(**{name: value})
            for sample in range(20, 24):
                output = law.moved(level_1_pv=level(sample))
                assert math.isfinite(output)
                if "limit" not in name:
                    assert LOW <= output <= HIGH
                if name == "level_1.proportional_gain" and not math.isfinite(value):
                    assert output == last
                assert all(abs(kept) <= 1e300 for kept in law.state.values())
            law.set(**{name: names[name]})
            following = trajectory(law, 60, start=24)
            assert all(LOW <= output <= HIGH for output in following)
            assert all(abs(kept) <= 1e300 for kept in law.state.values())
            # Alive: the output still moves with the level.
            assert max(following[-32:]) - min(following[-32:]) > 1.0, (name, value)


@pytest.mark.parametrize("rate", [-1.0, -1.0000000000000002e300])
def test_a_ramp_below_zero_leaves_the_setpoint_where_it_is(rate):
    form = PidForm("PI", setpoint_ramp=True)
    law = one_loop(form, settings(form, gain=3.0), time_step=STEP)
    trajectory(law, 20)
    before = law.state["level_1.working_setpoint"]
    law.set(level_1_setpoint_ramp=rate)
    law.moved(level_1_sp=REST + 2.0)
    assert law.state["level_1.working_setpoint"] == before


anything = st.floats()
scan = st.fixed_dictionaries(
    {
        "level_1.sp": anything,
        "level_1.pv": anything,
        "level_1.remote_setpoint": anything,
        "level_1.setpoint_source": st.sampled_from([0.0, 1.0, 2.0, math.nan]),
        "level_1.good": st.sampled_from([0.0, 1.0]),
        "pump_1.mode": st.sampled_from([0.0, 1.0, 1.0, 2.0, 3.0]),
        "pump_1.manual": anything,
        "pump_1.tracking": anything,
        "time_step": st.one_of(anything, st.sampled_from([0.1, 1.0])),
    }
)


@pytest.mark.thorough
@limits_of(max_examples=400, deadline=None)
@given(
    form=st.sampled_from(forms()),
    anti_windup=st.sampled_from(ANTI_WINDUPS),
    ramp=st.booleans(),
    data=st.data(),
    scans=st.lists(scan, min_size=1, max_size=8),
)
def test_outputs_stay_within_limits_and_states_numbers_whatever_comes(
    form, anti_windup, ramp, data, scans
):
    form = PidForm(
        form.actions, form.algorithm, form.derivative_on,
        anti_windup=anti_windup, setpoint_ramp=ramp, remote_setpoint=True,
    )  # fmt: skip
    law = one_loop(form, settings(form, gain=3.0), rate_limited=data.draw(st.booleans()))
    for inputs in scans:
        changed = data.draw(st.sampled_from([name for name in law.values if "limit" not in name]))
        law.set(**{changed: data.draw(anything)})
        outputs = law.scan(**inputs)
        assert LOW <= outputs["pump_1.out"] <= HIGH
        assert outputs["pump_1.status"] in range(256)
        assert all(abs(value) <= 1e300 for value in law.state.values()), law.state
