"""The sampled model with dead time, against the step response in closed form."""

import numpy as np
import pytest
from written_plants import plant_of

from clepsydra import NotApplicable
from clepsydra.designs.sampled.sampled_process import sampled_process

# Three tanks of 1 m² in a row with two inflows, and a pipe behind the first inflow and behind each
# of the first two tanks. What enters the second pipe from the first goes on into it at once.
TANKS = """
name = "three-tanks-and-pipes"
sampling_period = "2 s"
controlled = ["level_2", "level_3"]
manipulated = ["first", "second"]
[reservoirs.drain]
[tanks]
tank_1 = { area = "1 m^2", height = "10 m" }
tank_2 = { area = "1 m^2", height = "10 m" }
tank_3 = { area = "1 m^2", height = "10 m" }
[flows]
first = { destination = "pipe_1", range = ["0 m^3/s", "0.1 m^3/s"], nominal = "0.02 m^3/s" }
second = { destination = "parted_2", range = ["0 m^3/s", "0.1 m^3/s"], nominal = "0.02 m^3/s" }
[delays]
pipe_1 = { destination = "parted_1", time = "TIME_1 s" }
pipe_2 = { destination = "tank_2", time = "TIME_2 s" }
pipe_3 = { destination = "tank_3", time = "TIME_3 s" }
[splitters]
parted_1 = { fractions = { tank_1 = 0.6, pipe_2 = 0.4 } }
parted_2 = { fractions = { tank_2 = 0.8, pipe_2 = 0.2 } }
parted_3 = { fractions = { tank_3 = 0.3, pipe_2 = 0.7 } }
[linear_outlets]
outlet_1 = { source = "tank_1", destination = "parted_3", coefficient = "0.02 m^2/s" }
outlet_2 = { source = "tank_2", destination = "pipe_3", coefficient = "0.05 m^2/s" }
outlet_3 = { source = "tank_3", destination = "drain", coefficient = "0.01 m^2/s" }
[sensors]
level_2 = { tank = "tank_2", range = ["0 m", "10 m"] }
level_3 = { tank = "tank_3", range = ["0 m", "10 m"] }
"""
#: What leaves the third tank goes back to the second in part.
BACK = """
[splitters.parted_4]
fractions = { drain = 0.9, pipe_2 = 0.1 }
"""


@pytest.fixture
def three_tanks(tmp_path):
    def model(*times, looped=False):
        text = TANKS
        if looped:
            text = text.replace(
                '"tank_3", destination = "drain"', '"tank_3", destination = "parted_4"'
            )
            text += BACK
        for number, time in enumerate(times, 1):
            text = text.replace(f"TIME_{number}", str(time))
        return plant_of(tmp_path, text).linear

    return model


def lags(t, *rates):
    """Return the step response of 1/((s + a)(s + b)…), by residues."""
    held = 1.0 / np.prod(rates)
    for a in rates:
        held = held - np.exp(-a * t) / (a * np.prod([b - a for b in rates if b != a]))
    return np.where(t > 0.0, held, 0.0)


def exact_steps(t, first, second, third):
    """Return what a step of each inflow makes of levels 2 and 3 [samples, 2, 2]."""
    a, b, c = 0.02, 0.05, 0.01
    late = t - first - second
    level_2 = [
        0.4 * lags(late, b) + 0.7 * a * 0.6 * lags(late, a, b),
        0.8 * lags(t, b) + 0.2 * lags(t - second, b),
    ]
    late = late - third
    level_3 = [
        0.3 * a * 0.6 * lags(t - first, a, c)
        + b * (0.4 * lags(late, b, c) + 0.7 * a * 0.6 * lags(late, a, b, c)),
        b * (0.8 * lags(t - third, b, c) + 0.2 * lags(t - second - third, b, c)),
    ]
    return np.array([level_2, level_3]).transpose(2, 0, 1)


@pytest.mark.parametrize(
    "times", [(4.0, 6.0, 2.0), (5.0, 3.0, 7.0), (0.5, 11.25, 1.75), (2.0, 2.0, 2.0)]
)
def test_samples_equal_the_exact_step_response(three_tanks, times):
    model, period, samples = three_tanks(*times), 2.0, 120
    sampled = sampled_process(model, period)
    shown = np.hstack([model.C, np.zeros((2, len(sampled.held) - 3))])
    state = np.zeros((len(sampled.held), 2))
    steps = []
    for _ in range(samples):
        steps.append(shown @ state)
        state = sampled.held @ state + sampled.moved
    exact = exact_steps(period * np.arange(samples), *times)
    assert np.abs(exact[-1]).min() > 0.1
    # What adding up rounds: in each of the samples a sum over the states, of up to the largest.
    rounding = samples * len(state) * np.finfo(float).eps * np.abs(exact).max()
    np.testing.assert_allclose(steps, exact, rtol=0.0, atol=rounding)


def test_first_states_are_those_of_the_process_at_the_sampling_instants(three_tanks):
    sampled = sampled_process(three_tanks(3.0, 5.0, 4.0), 2.0)
    slow = np.sort(np.abs(np.linalg.eigvals(sampled.held)))[-3:]
    assert slow == pytest.approx(np.exp(2.0 * np.array([-0.05, -0.02, -0.01])), rel=1e-9)


def test_dead_time_in_a_loop_is_refused(three_tanks):
    with pytest.raises(NotApplicable, match="in a loop"):
        sampled_process(three_tanks(3.0, 5.0, 4.0, looped=True), 2.0)


def test_dead_time_of_very_many_periods_is_refused(three_tanks):
    with pytest.raises(NotApplicable, match="sample more slowly"):
        sampled_process(three_tanks(3.0, 5.0, 4.0), 0.01)
