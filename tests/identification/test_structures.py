"""Step and free responses against SciPy's linear systems and finite differences."""

import numpy as np
import pytest
from scipy.signal import lsim, step

from clepsydra.identification.output_error import HeldResponse
from clepsydra.identification.structures import FOPDT, IPDT, SOPDT

TIME = np.linspace(0.0, 80.0, 161)
CASES = [
    (FOPDT, [7.0], ([1.0], [7.0, 1.0])),
    (SOPDT, [7.0, 3.0], ([1.0], [21.0, 10.0, 1.0])),
    (SOPDT, [7.0, 7.0], ([1.0], [49.0, 14.0, 1.0])),
    (SOPDT, [7.0, 7.001], ([1.0], [49.007, 14.001, 1.0])),
    (IPDT, [], ([1.0], [1.0, 0.0])),
]


@pytest.mark.parametrize(("structure", "lags", "system"), CASES)
def test_step_response_is_that_of_the_transfer_function(structure, lags, system):
    found = structure.responses(TIME, TIME, np.array(lags))
    assert found.step == pytest.approx(step(system, T=TIME)[1], abs=1e-9)
    slope = (structure.responses(TIME + 1e-5, TIME, np.array(lags)).step - found.step) / 1e-5
    assert found.impulse == pytest.approx(slope, abs=1e-5)


@pytest.mark.parametrize(("structure", "lags", "system"), CASES[:4])
def test_slopes_by_the_lags_are_those_of_finite_differences(structure, lags, system):
    lags, h = np.array(lags), 1e-5
    found = structure.responses(TIME, TIME, lags)
    for place in range(len(lags)):
        up, down = (lags * np.exp(s * h * (np.arange(len(lags)) == place)) for s in (1, -1))
        above, below = (structure.responses(TIME, TIME, each) for each in (up, down))
        by_step = (above.step - below.step) / (2 * h)
        by_free = (above.free - below.free) / (2 * h)
        assert found.step_slopes[:, place] == pytest.approx(by_step, abs=1e-8), place
        assert found.free_slopes[:, :, place] == pytest.approx(by_free, abs=1e-8), place


@pytest.mark.parametrize("lags", [[7.0, 3.0], [7.0, 7.0]])
def test_free_responses_solve_the_differential_equation(lags):
    """τ1 τ2 y'' + (τ1 + τ2) y' + y is constant for each of them, and two of them decay."""
    time = np.linspace(0.0, 40.0, 40001)
    free = SOPDT.responses(time, time, np.array(lags)).free
    first = np.gradient(free, time, axis=0)
    second = np.gradient(first, time, axis=0)
    left = lags[0] * lags[1] * second + sum(lags) * first + free
    assert np.max(np.abs(left[5:-5] - [1.0, 0.0, 0.0])) <= 2e-5
    assert np.linalg.matrix_rank(free) == 3


@pytest.mark.parametrize(("structure", "lags", "system"), CASES[:2])
def test_a_held_input_is_answered_as_by_fine_integration(structure, lags, system):
    """With 3.4 samples of dead time; SciPy simulates at a tenth of a sample, the input held."""
    random = np.random.default_rng(5)
    u = 2.0 + np.repeat(random.choice([-1.0, 1.0], 20), 5)
    u[0] = 2.0
    period, fine = 2.0, 10
    time = period * np.arange(len(u))
    since = np.maximum(time - 3.4 * period, 0.0)
    response = structure.responses(since, time, np.array(lags)).step
    found = HeldResponse(u).to(response[:, None])[:, 0]
    held = np.concatenate([np.zeros(34), np.repeat(u - u[0], fine)])[: fine * len(u)]
    grid = period / fine * np.arange(len(held))
    expected = lsim(system, held, grid, interp=False)[1][::fine]
    assert found == pytest.approx(expected, abs=1e-9)
