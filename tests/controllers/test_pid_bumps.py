"""No bump: every change of mode, gain, setpoint source and sensor in the midst of a transient.

A bump is what the output moves by beyond what control asks for. So the bounds are these, each to
1e-9 of the output's range:

- in the sample of a change of a parameter a positional form moves the output as the unchanged
  law, a twin in the same state, does: the integral takes up what the change does to the rest;
- a velocity form then takes its increments with the new parameters: they stand before what
  moved in this sample and before the error, never before the level itself;
- in the sample of a change of the setpoint's source a positional form stays where it was, and a
  velocity form moves as if the new setpoint had stood in the last sample too;
- automatic goes on from the manual or tracked output by the nonintegral action on what the
  measurement did in that very sample, which is none where the measurement and its filter rest;
- after a fault the law goes on as if the samples of the fault had not been;
- by hand the output is the manual value.

All start far from rest: the measurement moves by up to 2 % of the output's range in a sample.
"""

import math
from dataclasses import replace

import pytest
from pid_rig import (
    AUTOMATIC,
    BUMP,
    MANUAL,
    TRACKING,
    PlainPid,
    forms,
    name_of,
    one_loop,
    settings,
    winding_forms,
)

STEP = 0.5  # [s]
REST = 5.0
TRANSIENT = 37  # samples before the change, with the derivative and the error far from zero

every_form = pytest.mark.parametrize("form", forms(), ids=name_of)
every_winding_form = pytest.mark.parametrize("form", winding_forms(), ids=name_of)


def level(sample):
    """A measurement that never rests."""
    return REST + 2.0 * math.sin(0.11 * sample) + 0.4 * math.sin(0.7 * sample)


def values_of(form, **changed):
    return settings(form, gain=3.0, weight=0.6) | changed


def moving(form, *, before=TRANSIENT, **options):
    """A loop in automatic after a transient, and its last output."""
    law = one_loop(form, values_of(form), rest=REST, time_step=STEP, **options)
    output = math.nan
    for sample in range(before):
        output = law.moved(level_1_sp=REST + 1.0, level_1_pv=level(sample))
    assert 10.0 < output < 90.0, "the transient was to stay between the limits"
    return law, output


def adjustable(form):
    """Parameter and new value: four times and a quarter, within its range."""
    law = one_loop(form, values_of(form))
    for parameter in law.law.parameters:
        if "limit" not in parameter.name:
            for factor in (0.25, 4.0):
                value = factor * law.values[parameter.name]
                yield parameter.name, min(max(value, parameter.low), parameter.high)


@pytest.mark.sampled
@every_winding_form
def test_a_parameter_is_changed_without_a_bump(form):
    changes = list(adjustable(form))
    assert {name for name, _ in changes} == {
        p.name for p in one_loop(form, values_of(form)).law.parameters if "limit" not in p.name
    }
    for name, value in changes:
        law, last = moving(form)
        twin = law.twin()
        unchanged = twin.moved(level_1_pv=level(TRANSIENT))
        assert abs(unchanged - last) > 1000 * BUMP, "the unchanged law was to move"
        law.set(**{name: value})
        changed = law.moved(level_1_pv=level(TRANSIENT))
        expected = last + increment(form, law.values) if velocity(form) else unchanged
        assert changed == pytest.approx(expected, abs=BUMP), name
        # The new value is in force from now on: the two laws part.
        following = [
            instance.moved(level_1_pv=level(TRANSIENT + 1), level_1_sp=REST)
            for instance in (law, twin)
        ]
        if not name.endswith("tracking_time"):  # counts in saturation only
            assert abs((following[0] - changed) - (following[1] - unchanged)) > 1000 * BUMP, name


def velocity(form):
    return form.algorithm == "velocity"


def increment(form, values, setpoint=REST + 1.0):
    """What a velocity form adds in the sample of a change, with the present parameters.

    The derivative turns by what the filter makes of it that was in force up to here.
    """
    former = PlainPid(form, values_of(form), rest=REST)
    rates = []
    for sample in range(TRANSIENT + 1):
        filtered = former.filtered
        former.sample(REST + 1.0, level(sample), STEP)
        rates.append((former.filtered - filtered) / STEP)
    sign = -1.0 if form.derivative_on == "measurement" else 1.0
    turned = sign * (rates[-1] - rates[-2]) if form.has_derivative else 0.0
    gain = values["level_1.proportional_gain"]
    integrated = STEP / values["level_1.integral_time"] * (setpoint - level(TRANSIENT))
    moved = level(TRANSIENT - 1) - level(TRANSIENT)
    return gain * (moved + integrated + values.get("level_1.derivative_time", 0.0) * turned)


@every_form
def test_a_gain_that_changes_in_every_sample_leaves_control_alive(form):
    """Gain scheduling: a gain that is moved a little in every sample does not stop the integral."""
    if not form.has_integral:
        pytest.skip("only an integral goes on by itself")
    law = one_loop(form, values_of(form), rest=REST, time_step=STEP)
    ordinary = law.twin()
    gains = [name for name in law.values if "gain" in name]
    for sample in range(40):
        law.set(**{name: ordinary.values[name] * (1 + 1e-6 * sample) for name in gains})
        scheduled = law.moved(level_1_sp=REST + 1.0)
        expected = ordinary.moved(level_1_sp=REST + 1.0)
    assert expected - 50.0 > 5.0
    # The last gain is larger by 4e-5 than the first, and so is what it made.
    assert scheduled == pytest.approx(expected, abs=4e-5 * (expected - 50.0))


@pytest.mark.sampled
@pytest.mark.parametrize("mode", [MANUAL, TRACKING], ids=["manual", "tracking"])
@every_winding_form
def test_automatic_goes_on_from_the_other_mode(form, mode):
    plain = PlainPid(form, values_of(form), rest=REST)
    law, last = moving(form)
    part = 0.0
    for sample in range(TRANSIENT):
        part, _ = plain.sample(REST + 1.0, level(sample), STEP)
    # Into the other mode: the output is its value, and starting from the present one is smooth.
    for sample in range(TRANSIENT, TRANSIENT + 9):
        last = 60.0 - 2.0 * sample / TRANSIENT
        part, increment = plain.sample(REST + 1.0, level(sample), STEP)
        given = {"pump_1.manual": last} if mode == MANUAL else {"pump_1.tracking": last}
        assert law.moved(level_1_pv=level(sample), pump_1_mode=mode, **given) == last
    sample = TRANSIENT + 9
    following, increment = plain.sample(REST + 1.0, level(sample), STEP)
    found = law.moved(level_1_pv=level(sample), pump_1_mode=AUTOMATIC)
    # A velocity form takes the error of this sample, a positional one from the next on.
    now = increment if form.algorithm == "velocity" else 0.0
    assert found - last == pytest.approx(following - part + now, abs=BUMP)
    assert abs(found - last) > 1000 * BUMP
    sample += 1
    third, later = plain.sample(REST + 1.0, level(sample), STEP)
    now = later if form.algorithm == "velocity" else increment
    assert law.moved(level_1_pv=level(sample)) - found == pytest.approx(
        third - following + now, abs=BUMP
    )


@pytest.mark.sampled
@pytest.mark.parametrize("mode", [MANUAL, TRACKING], ids=["manual", "tracking"])
@every_form
def test_automatic_goes_on_exactly_where_measurement_and_filter_rest(form, mode):
    law, _ = moving(form)
    for _ in range(200):
        law.moved(pump_1_mode=mode, pump_1_manual=41.0, pump_1_tracking=41.0)
    error = law.inputs["level_1.sp"] - law.inputs["level_1.pv"]
    allowed = 3.0 / 10.0 * STEP * abs(error) if form.algorithm == "velocity" else 0.0
    assert abs(law.moved(pump_1_mode=AUTOMATIC) - 41.0) <= allowed + BUMP


@pytest.mark.parametrize("mode", [MANUAL, TRACKING], ids=["manual", "tracking"])
@every_form
def test_leaving_automatic_with_the_value_aligned_moves_nothing(form, mode):
    law, last = moving(form)
    found = law.moved(
        level_1_pv=level(TRANSIENT), pump_1_mode=mode, pump_1_manual=last, pump_1_tracking=last
    )
    assert abs(found - last) <= BUMP


@pytest.mark.parametrize("mode", [3, -1, math.nan])
@every_form
def test_an_unknown_mode_holds_and_automatic_goes_on_from_the_integral(form, mode):
    """The measurement is known all the while, so automatic acts on what it did meanwhile."""
    law, last = moving(form)
    plain = PlainPid(form, values_of(form), rest=REST)
    for sample in range(TRANSIENT):
        before, gained = plain.sample(REST + 1.0, level(sample), STEP)
    for sample in range(TRANSIENT, TRANSIENT + 5):
        plain.sample(REST + 1.0, level(sample), STEP)
        assert law.moved(level_1_pv=level(sample), pump_1_mode=mode) == last
    now, increment = plain.sample(REST + 1.0, level(TRANSIENT + 5), STEP)
    found = law.moved(level_1_pv=level(TRANSIENT + 5), pump_1_mode=AUTOMATIC)
    # A velocity form goes on from the output, as its increments from sample to sample say.
    if velocity(form):
        before, gained = plain_before(form, TRANSIENT + 5), increment
    assert found - last == pytest.approx(now - before + gained, abs=BUMP)


def plain_before(form, samples):
    """The nonintegral part in the last of so many samples."""
    plain = PlainPid(form, values_of(form), rest=REST)
    return [plain.sample(REST + 1.0, level(sample), STEP)[0] for sample in range(samples)][-1]


@pytest.mark.parametrize("fault", [0.0, math.nan])
@every_form
def test_by_hand_a_sample_without_time_step_is_no_bump_afterwards(form, fault):
    law, _ = moving(form)
    for value, time_step in ((50.0, STEP), (49.0, STEP), (48.0, fault)):
        held = law.moved(pump_1_mode=MANUAL, pump_1_manual=value, time_step=time_step)
        assert held == value
    twin = law.twin()
    assert twin.moved(time_step=STEP) == 48.0
    # One more sample by hand, or automatic at once: in both the filter goes on by one sample.
    plain = PlainPid(form, values_of(form), rest=REST)
    parts = [plain.sample(REST + 1.0, level(k), STEP) for k in range(TRANSIENT)]
    parts += [plain.sample(REST + 1.0, level(TRANSIENT - 1), STEP) for _ in range(3)]
    now = parts[-1][1] if velocity(form) else 0.0
    found = law.moved(pump_1_mode=AUTOMATIC, time_step=STEP)
    assert found - 48.0 == pytest.approx(parts[-1][0] - parts[-2][0] + now, abs=BUMP)


FAULTS = {
    "sensor": {"level_1.good": 0.0},
    "measurement": {"level_1.pv": math.nan},
    "measurement-and-sensor": {"level_1.pv": -math.inf, "level_1.good": 0.0},
    "sensor-at-zero": {"level_1.pv": 0.0, "level_1.good": 0.0},
    "setpoint": {"level_1.sp": math.nan},
    "time-step": {"time_step": 0.0},
}


@pytest.mark.sampled
@pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS)
@every_winding_form
def test_after_a_fault_it_goes_on_as_if_the_fault_had_not_been(form, fault):
    law, last = moving(form)
    twin = law.twin()
    before = dict(law.inputs)
    for _ in range(12):
        assert law.moved(**fault) == last
    for sample in range(TRANSIENT, TRANSIENT + 5):
        before["level_1.pv"] = level(sample)
        expected = twin.moved(**before)
        assert law.moved(**before) == pytest.approx(expected, abs=BUMP)
    assert abs(expected - last) > 1000 * BUMP


@every_form
def test_a_repair_by_hand_and_back_to_automatic(form):
    """The sensor fails, the operator moves the output, the sensor comes back, and automatic."""
    law, last = moving(form)
    for value in (last, 30.0, 35.0, 35.0):
        assert (
            law.moved(
                level_1_pv=math.nan, level_1_good=0.0, pump_1_mode=MANUAL, pump_1_manual=value
            )
            == value
        )
    for _ in range(200):
        assert law.moved(level_1_pv=level(TRANSIENT), level_1_good=1.0) == 35.0
    allowed = 3.0 / 10.0 * STEP * 4.0 if form.algorithm == "velocity" else 0.0
    assert abs(law.moved(pump_1_mode=AUTOMATIC) - 35.0) <= allowed + BUMP


@pytest.mark.sampled
@pytest.mark.parametrize("ramp", [False, True], ids=["", "ramp"])
@every_winding_form
def test_the_source_of_the_setpoint_changes_without_a_bump(form, ramp):
    form = replace(form, remote_setpoint=True, setpoint_ramp=ramp)
    law, last = moving(form, level_1_remote_setpoint=REST - 3.0)
    sample = TRANSIENT
    for source in (1, 0, 1):
        for _ in range(3):
            last = law.moved(level_1_pv=level(sample))
            sample += 1
        found = law.moved(level_1_pv=level(sample), level_1_setpoint_source=source)
        expected = last
        if velocity(form):
            setpoint = law.inputs["level_1.remote_setpoint" if source else "level_1.sp"]
            error = setpoint - level(sample)
            expected += 3.0 * (level(sample - 1) - level(sample) + STEP / 10.0 * error)
            if form.has_derivative and form.derivative_on == "measurement":
                rates = rates_of_measurement(sample + 1)
                expected -= 3.0 * 2.0 * (rates[-1] - rates[-2])
        assert found == pytest.approx(expected, abs=BUMP)
        sample += 1
        # The new source is in force: the loop now heeds it, and it only.
        one, other = law.twin(), law.twin()
        heeded, ignored = ("level_1.remote_setpoint", "level_1.sp")[:: 1 if source else -1]
        base = law.twin().moved(level_1_pv=level(sample))
        assert one.moved(level_1_pv=level(sample), **{ignored: 0.0}) == base
        if not ramp:
            moved = other.moved(level_1_pv=level(sample), **{heeded: law.inputs[heeded] + 1})
            assert moved - base == pytest.approx(expected_of_setpoint(form), abs=1e-9)


def rates_of_measurement(samples):
    """The filtered derivative of the level in each sample, by backward differences."""
    filtered, rates = REST, []
    for sample in range(samples):
        rates.append((level(sample) - filtered) / (2.0 / 5.0 + STEP))
        filtered += STEP * rates[-1]
    return rates


def expected_of_setpoint(form):
    """What a unit step of the setpoint moves the output by at once, in the form of these tests."""
    values, step = values_of(form), 1.0
    found = values["level_1.proportional_gain"] * values["level_1.setpoint_weight"] * step
    if form.has_derivative and form.derivative_on == "error":
        found += 3.0 * 2.0 / (2.0 / 5.0 + STEP)
    if form.algorithm == "velocity":
        found += 3.0 / 10.0 * STEP
    return found


@every_form
def test_the_source_changes_by_hand_and_automatic_takes_over_without_a_bump(form):
    form = replace(form, remote_setpoint=True)
    law, _ = moving(form, level_1_remote_setpoint=REST - 3.0)
    for source in (0, 1, 0, 1):
        for _ in range(100):
            assert (
                law.moved(pump_1_mode=MANUAL, pump_1_manual=44.0, level_1_setpoint_source=source)
                == 44.0
            )
    allowed = 3.0 / 10.0 * STEP * 4.5 if form.algorithm == "velocity" else 0.0
    assert abs(law.moved(pump_1_mode=AUTOMATIC) - 44.0) <= allowed + BUMP


@every_form
def test_a_remote_setpoint_that_fails_leaves_the_last_one(form):
    form = replace(form, remote_setpoint=True)
    law, _ = moving(form, level_1_remote_setpoint=REST - 1.0)
    law.moved(level_1_setpoint_source=1)
    law.moved()
    twin = law.twin()
    for sample in range(5):
        found = law.moved(level_1_pv=level(sample), level_1_remote_setpoint=math.nan)
        assert found == twin.moved(level_1_pv=level(sample))


@every_form
def test_a_ramp_starts_at_the_measurement_and_moves_at_its_rate(form):
    form = replace(form, setpoint_ramp=True)
    rate, rest = 0.05, 3.0
    law = one_loop(form, values_of(form), rest=rest, output=40.0, time_step=STEP)
    plain = PlainPid(form, values_of(form), rest=rest)
    law.set(level_1_setpoint_ramp=rate)
    # By hand the setpoint waits one step from the measurement, the one of the first sample in
    # automatic, which so begins without a bump.
    part = math.nan
    for _ in range(60):
        assert law.moved(pump_1_mode=MANUAL, pump_1_manual=40.0, level_1_sp=8.0) == 40.0
        part, _ = plain.sample(rest + rate * STEP, rest, STEP)
    integral, deviations = 40.0 - part, []
    for sample in range(1, 30):
        part, gained = plain.sample(rest + rate * STEP * sample, rest, STEP)
        integral += gained if velocity(form) else 0.0
        output = law.moved(pump_1_mode=AUTOMATIC)
        deviations.append(abs(output - (part + integral)))
        integral += 0.0 if velocity(form) else gained
    assert max(deviations) <= BUMP
    assert output > 40.0 + 1.0


@every_form
def test_a_ramp_ends_at_the_setpoint_and_stays_there(form):
    form = replace(form, setpoint_ramp=True)
    law = one_loop(form, values_of(form), rest=3.0, output=40.0, time_step=STEP)
    law.set(level_1_setpoint_ramp=0.3)
    for setpoint, way in ((4.0, 1.0), (2.5, -1.0)):
        start = law.state["level_1.working_setpoint"]
        for sample in range(1, 20):
            law.moved(level_1_sp=setpoint)
            reached = start + way * 0.3 * STEP * sample
            expected = min(reached, setpoint) if way > 0 else max(reached, setpoint)
            assert law.state["level_1.working_setpoint"] == pytest.approx(expected, abs=1e-12)
        assert law.state["level_1.working_setpoint"] == setpoint
