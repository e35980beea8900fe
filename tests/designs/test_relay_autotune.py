"""The ultimate point read off the record of a relay, exact for a sine."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from refusals import refused

from clepsydra import InputError
from clepsydra.designs.relay_autotune import ultimate_point_of_relay


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


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t, u, y: (t, u, y[:-1]), "one length"),
        (lambda t, u, y: (t[:4], u[:4], y[:4]), "at least 8"),
        (lambda t, u, y: (t[::-1], u, y), "rising time"),
        (lambda t, u, y: (t, u, np.where(t == t[50], np.nan, y)), "finite"),
        (lambda t, u, y: (t, u, ["a"] * len(t)), "numbers"),
    ],
)
def test_arrays_that_are_no_record_are_refused(change, words):
    with pytest.raises(InputError, match=words):
        ultimate_point_of_relay(*change(*swing(0.5, 40.0)))
