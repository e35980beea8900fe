"""Anti-windup: the integral in saturation in closed form, and how soon the output leaves a limit.

Åström and Hägglund, Advanced PID Control (2006), section 3.5; Visioli, Practical PID Control
(2006), section 3.3. Everything happens at the high limit and, mirrored, at the low one, with a
gain of either sign.
"""

import math

import pytest
from pid_rig import ANTI_WINDUPS, BUMP, HIGH, LOW, forms, name_of, one_loop, settings

from clepsydra import PidForm
from clepsydra.controllers.blocks.status import read_status

GAIN, INTEGRAL_TIME, TRACKING_TIME, STEP = 2.0, 10.0, 20.0, 0.5
REST, ERROR, START = 50.0, 5.0, 95.0
RISE = STEP * GAIN / INTEGRAL_TIME * ERROR  # what the integral gains in a sample: 0.5
SHARE = STEP / TRACKING_TIME
CENTRE = (LOW + HIGH) / 2

#: Towards which limit, and the sign of the gain.
sides = pytest.mark.parametrize("side", [1, -1], ids=["high", "low"])
signs = pytest.mark.parametrize("sign", [1, -1], ids=["reverse-acting", "direct-acting"])
positional = pytest.mark.parametrize("algorithm", ["isa", "series", "parallel"])
every_anti_windup = pytest.mark.parametrize("anti_windup", ANTI_WINDUPS)


class Saturated:
    """A PI loop seen from the high limit: at the low one everything is mirrored."""

    def __init__(self, form, side, sign, start=START, **changed):
        self.side, self.sign = side, sign
        values = settings(form, gain=sign * GAIN, integral_time=INTEGRAL_TIME)
        self.loop = one_loop(
            form, values | {"level_1.tracking_time": TRACKING_TIME}, rest=REST,
            output=self.seen(start), time_step=STEP, rate_limited="pump_1_rate_limit" in changed,
        )  # fmt: skip
        self.loop.set(**changed)

    def seen(self, value):
        return CENTRE + self.side * (value - CENTRE)

    def output(self, error):
        return self.seen(self.loop.moved(level_1_sp=REST + self.side * self.sign * error))

    @property
    def integral(self):
        # With r − y = e and b = 1 the proportional part is K e: nothing else is in the integral.
        return self.seen(self.loop.state["level_1.integral"])


def integral_after(anti_windup, samples):
    """In closed form, from I = 95 at K e = 10: asked for 105 and more where 100 is the limit."""
    if anti_windup == "none":
        return START + samples * RISE
    if anti_windup == "conditional_integration":
        return START
    if anti_windup == "clamping":
        return min(HIGH, START + samples * RISE)
    final = HIGH - GAIN * ERROR + RISE / SHARE  # where share · excess is the increment
    return final + (START - final) * (1 - SHARE) ** samples


@every_anti_windup
@positional
@signs
@sides
def test_the_integral_in_saturation(anti_windup, algorithm, sign, side):
    law = Saturated(PidForm("PI", algorithm, anti_windup=anti_windup), side, sign)
    for samples in range(1, 120):
        assert law.output(ERROR) == HIGH
        assert law.integral == pytest.approx(integral_after(anti_windup, samples), abs=1e-10)


def samples_at_limit(law, error):
    count = 0
    while law.output(error) >= HIGH:
        count += 1
        assert count < 10_000
    return count


@every_anti_windup
@positional
@signs
@sides
def test_recovery_takes_as_long_as_the_integral_stands_too_high(anti_windup, algorithm, sign, side):
    """After 100 samples in saturation the error turns to −1.1: so long does the output stay."""
    law = Saturated(PidForm("PI", algorithm, anti_windup=anti_windup), side, sign)
    for _ in range(100):
        law.output(ERROR)
    wound, turned = integral_after(anti_windup, 100), -1.1
    fall, part = RISE * turned / ERROR, GAIN * turned  # −0.11 a sample, and −2.2
    if anti_windup == "none":
        expected = math.ceil((HIGH - part - wound) / fall)
    elif anti_windup == "back_calculation":
        # I goes to where share · excess is −0.11, which lies below the limit.
        final = HIGH - part + fall / SHARE
        rest = (HIGH - part - final) / (wound - final)
        expected = math.ceil(math.log(rest) / math.log(1 - SHARE))
    else:
        expected = 0
    assert samples_at_limit(law, turned) == expected
    assert (expected > 300) == (anti_windup == "none")


@signs
@sides
def test_no_anti_windup_is_slower_than_another_and_none_is_slowest(sign, side):
    count = {}
    for anti_windup in ANTI_WINDUPS:
        law = Saturated(PidForm(anti_windup=anti_windup), side, sign)
        for _ in range(100):
            law.output(ERROR)
        count[anti_windup] = samples_at_limit(law, -0.5)
    assert count["conditional_integration"] == count["clamping"] == 0
    assert 0 < count["back_calculation"] < count["none"] / 10


@pytest.mark.parametrize(
    "form", [form for form in forms() if form.algorithm == "velocity"], ids=name_of
)
@signs
@sides
def test_a_velocity_form_leaves_the_limit_in_the_sample_in_which_the_error_turns(form, sign, side):
    law = Saturated(form, side, sign)
    for _ in range(100):
        output = law.output(ERROR)
    assert output == HIGH
    # −K (5 − (−1)) and one increment; the derivative of the measurement rests.
    expected = HIGH - GAIN * (ERROR + 1.0) - RISE / ERROR
    if form.has_derivative and form.derivative_on == "error":
        assert law.output(-1.0) < expected
    else:
        assert law.output(-1.0) == pytest.approx(expected, abs=BUMP)


@every_anti_windup
@sides
def test_an_integral_within_reach_is_the_same_under_every_anti_windup(anti_windup, side):
    """No way of anti-windup acts while the output is within its limits."""
    law = Saturated(PidForm("PI", anti_windup=anti_windup), side, 1, start=50.0)
    for samples in range(1, 60):
        law.output(ERROR)
        assert law.integral == pytest.approx(50.0 + RISE * samples, abs=1e-10)


RATE = 4.0  # [1/s], 2 a sample


@every_anti_windup
@signs
@sides
def test_under_a_rate_limit(anti_windup, sign, side):
    """Asked for 60 where 50 stands, 2 a sample: what was not yet applied counts as excess."""
    law = Saturated(PidForm(anti_windup=anti_windup), side, sign, 50.0, pump_1_rate_limit=RATE)
    integral, output, hurried = 50.0, 50.0, 0
    for _ in range(60):
        asked = GAIN * ERROR + integral
        output = min(asked, output + RATE * STEP)
        assert law.output(ERROR) == pytest.approx(output, abs=BUMP)
        excess = asked - output
        hurried += excess > 0
        if anti_windup == "back_calculation":
            integral += RISE - SHARE * excess
        elif anti_windup != "conditional_integration" or excess <= 0:
            integral += RISE
        assert law.integral == pytest.approx(integral, abs=1e-9)
    # Conditional integration waits five samples for 10; the others go on at 0.5 a sample.
    assert hurried == {
        "conditional_integration": 4, "back_calculation": 5, "clamping": 6, "none": 6,
    }[anti_windup]  # fmt: skip


def test_the_status_word_tells_the_rate_limit():
    law = one_loop(PidForm(), settings(PidForm(), gain=2.0), time_step=STEP, rate_limited=True)
    law.set(pump_1_rate_limit=RATE)
    assert read_status(int(law.scan(level_1_sp=5.0)["pump_1.status"])) == ("automatic",)
    assert read_status(int(law.scan(level_1_sp=10.0)["pump_1.status"])) == (
        "automatic",
        "at_rate_limit",
    )


def test_by_hand_the_rate_limit_holds_too_and_the_integral_follows_what_was_applied():
    law = one_loop(PidForm(), settings(PidForm(), gain=2.0), time_step=STEP, rate_limited=True)
    law.set(pump_1_rate_limit=RATE)
    assert [law.moved(pump_1_mode=0, pump_1_manual=55.0) for _ in range(4)] == [
        52.0,
        54.0,
        55.0,
        55.0,
    ]
    assert law.moved(pump_1_manual=90.0) == 57.0
    assert law.moved(pump_1_mode=1) == pytest.approx(57.0, abs=BUMP)
