"""Models read off recorded runs: the parameters that made the record come back."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from refusals import refused

from clepsydra import InputError
from clepsydra.designs.integrating_delay import integrating_delay
from clepsydra.designs.models.step_record import step_record
from clepsydra.designs.relay_autotune import ultimate_point_of_relay
from clepsydra.designs.two_point_fopdt import SHARES, two_point_fopdt

TIME = np.arange(0.0, 400.0, 1.0)


def first_order(gain, time_constant, delay, *, at=20.0, step=2.0, start=5.0):
    after = np.maximum(TIME - at - delay, 0.0)
    output = start + step * gain * (1.0 - np.exp(-after / time_constant))
    return 1.0 + step * (at <= TIME), output


@pytest.mark.parametrize("points", list(SHARES))
@pytest.mark.parametrize("step", [2.0, -0.7])
@pytest.mark.parametrize(
    ("gain", "time_constant", "delay"), [(1.5, 16.0, 7.0), (-0.2, 10.0, 0.4), (3.0, 15.0, 11.3)]
)
def test_an_exact_first_order_step_comes_back(gain, time_constant, delay, step, points):
    moved, output = first_order(gain, time_constant, delay, step=step)
    found = two_point_fopdt(TIME, moved, output, points=points)
    # What is left is the 1e-9 or so that the record has not settled at its end.
    assert found.gain == pytest.approx(gain, rel=1e-8)
    assert found.time_constant == pytest.approx(time_constant, rel=1e-8)
    assert found.delay == pytest.approx(delay, abs=1e-8 * time_constant)


def test_published_coefficients_are_the_rounded_closed_forms():
    """Smith: 28.3 and 63.2 %, τ = 1.5 Δt. Sundaresan and Krishnaswamy: 0.675 Δt, 1.294, 0.294."""
    assert SHARES["smith"] == pytest.approx((0.283, 0.632), abs=5e-4)
    for points, slope, share in (("smith", 1.5, 0.5), ("sundaresan_krishnaswamy", 0.675, 0.294)):
        first, second = SHARES[points]
        span = math.log1p(-first) - math.log1p(-second)
        assert 1.0 / span == pytest.approx(slope, abs=2e-3)
        # θ = t2 + τ ln(1 − p2): the weight of t1 less one.
        assert -math.log1p(-second) / span - 1.0 == pytest.approx(share, abs=2e-3)


def test_a_noisy_step_comes_back_near():
    moved, output = first_order(1.5, 40.0, 7.0)
    noise = np.random.default_rng(4).normal(0.0, 0.01, len(TIME))
    found = two_point_fopdt(TIME, moved, output + noise)
    assert found.gain == pytest.approx(1.5, rel=0.01)
    assert found.time_constant == pytest.approx(40.0, rel=0.05)
    assert found.delay == pytest.approx(7.0, abs=1.5)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t, u, y: (t, u, y[:-1]), "one length"),
        (lambda t, u, y: (t[:4], u[:4], y[:4]), "at least 8"),
        (lambda t, u, y: (t[::-1], u, y), "rising time"),
        (lambda t, u, y: (t, u, np.where(t == 50, np.nan, y)), "finite"),
        (lambda t, u, y: (t, 0 * u, y), "0 changes"),
        (lambda t, u, y: (t, u + (t > 90), y), "2 changes"),
        (lambda t, u, y: (t, u, 0 * y), "five times the noise"),
        (lambda t, u, y: (t, u, y + 0.05 * t), "come to rest"),
        (lambda t, u, y: (t, u, ["a"] * len(t)), "numbers"),
    ],
)
def test_records_that_show_no_step_are_refused(change, words):
    moved, output = first_order(1.5, 16.0, 7.0)
    with pytest.raises(InputError, match=words):
        two_point_fopdt(*change(TIME, moved, output))


def test_unknown_points_are_refused():
    with refused(expected="smith"):
        two_point_fopdt(TIME, *first_order(1.0, 10.0, 1.0), points="half")


def test_time_counts_from_the_step():
    record = step_record(TIME, 3.0 * (TIME >= 20.0), TIME, "test")
    assert (record.since[0], record.output[0], record.step) == (0.0, 20.0, 3.0)


def ramp(slope, delay, moved, *, drift=0.0, start=2.0):
    """Return ẏ = slope · Δu(t − delay) + drift, by the exact integral of a held input."""
    volume = np.concatenate([[0.0], np.cumsum((moved[:-1] - moved[0]) * np.diff(TIME))])
    return start + drift * TIME + slope * np.interp(TIME - delay, TIME, volume, left=0.0)


@pytest.mark.parametrize("drift", [0.0, -0.004])
@pytest.mark.parametrize(
    "moved",
    [
        1.0 + 2.0 * (TIME >= 30.0),
        1.0 - 0.5 * ((TIME >= 30.0) & (TIME < 90.0)),
        1.0 + 0.3 * ((TIME >= 30.0) & (TIME < 60.0)) - 0.3 * ((TIME >= 120.0) & (TIME < 150.0)),
    ],
)
@pytest.mark.parametrize(("slope", "delay"), [(0.02, 12.0), (-0.3, 4.7), (0.02, 0.0)])
def test_slope_and_delay_come_back(slope, delay, moved, drift):
    found = integrating_delay(TIME, moved, ramp(slope, delay, moved, drift=drift))
    assert math.isinf(found.time_constant)
    assert found.slope == pytest.approx(slope, rel=1e-6)
    # The sum of squares is flat to rounding within the root of it.
    assert found.delay == pytest.approx(delay, abs=1e-4)


def test_a_noisy_pulse_comes_back_near():
    moved = 1.0 + 2.0 * ((TIME >= 30.0) & (TIME < 90.0))
    noise = np.random.default_rng(7).normal(0.0, 0.02, len(TIME))
    found = integrating_delay(TIME, moved, ramp(0.02, 12.0, moved) + noise)
    assert found.slope == pytest.approx(0.02, rel=0.01)
    assert found.delay == pytest.approx(12.0, abs=1.0)


@pytest.mark.parametrize(
    ("moved", "output", "words"),
    [
        (np.ones_like(TIME), TIME, "no change"),
        (1.0 * (TIME >= 1.0), TIME, "at least three"),
        (1.0 * (TIME >= 30.0), np.random.default_rng(1).normal(size=len(TIME)), "unexplained"),
        (1.0 * (TIME >= 30.0), np.ones_like(TIME), "unexplained"),
    ],
)
def test_records_of_no_integrator_are_refused(moved, output, words):
    with pytest.raises(InputError, match=words):
        integrating_delay(TIME, moved, output)


# The relay: a sine as the output makes the describing function exact.


def swing(amplitude, period, *, hysteresis=0.0, relay=2.0, sign=1.0, middle=3.0, cycles=6.0):
    time = np.arange(0.0, cycles * period, period / 5000.0)
    output = amplitude * np.sin(2 * math.pi * time / period)
    up, states = False, []
    for value in output:
        up = value < -hysteresis or (up and value <= hysteresis)
        states.append(up)
    return time, middle + sign * relay * (2.0 * np.array(states) - 1.0), 7.0 + output


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("hysteresis", [0.0, 0.3])
def test_a_sine_gives_the_describing_function(hysteresis, sign):
    record = swing(0.5, 40.0, hysteresis=hysteresis, sign=sign)
    found = ultimate_point_of_relay(*record, hysteresis=hysteresis)
    expected = sign * 4 * 2.0 / (math.pi * math.sqrt(0.25 - hysteresis**2))
    assert found.gain == pytest.approx(expected, rel=1e-5)
    # Switching is seen to the sample, of which three cycles have 15 000.
    assert found.period == pytest.approx(40.0, rel=1e-4)


def test_a_record_is_taken_as_the_experiment_returns_it():
    time, moved, output = swing(0.5, 40.0, hysteresis=0.2)
    record = SimpleNamespace(time=time, manipulated=moved, measured=output, hysteresis=0.2)
    by_hand = ultimate_point_of_relay(time, moved, output, hysteresis=0.2)
    assert ultimate_point_of_relay(record) == by_hand
    # Its own hysteresis counts where none is given.
    assert ultimate_point_of_relay(record, hysteresis=0.0).gain < by_hand.gain
    for arguments in ((time,), (time, moved), (record, moved)):
        with pytest.raises(InputError, match="relay experiment: got"):
            ultimate_point_of_relay(*arguments)


@pytest.mark.parametrize(
    ("record", "options", "words"),
    [
        (swing(0.5, 40.0, cycles=3.2), {}, "full cycles"),
        (swing(0.5, 40.0), {"hysteresis": 0.6}, "beyond the hysteresis"),
        (swing(0.5, 40.0), {"hysteresis": -0.1}, "number from 0"),
        ((np.arange(9.0), np.ones(9), np.ones(9)), {}, "full cycles"),
    ],
)
def test_records_of_no_relay_are_refused(record, options, words):
    with pytest.raises(InputError, match=words):
        ultimate_point_of_relay(*record, **options)


def test_a_growing_swing_is_refused():
    time, moved, output = swing(0.5, 40.0)
    with refused(expected="differ by at most 5%"):
        ultimate_point_of_relay(time, moved, 7.0 + (output - 7.0) * (1.0 + time / 200.0))
    with refused(value="more than two values"):
        ultimate_point_of_relay(time, moved + 0.1 * np.sign(np.sin(time)), output)
