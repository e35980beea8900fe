"""Step and free responses against SciPy's linear systems and finite differences."""

import numpy as np
import pytest
from scipy.signal import lsim, step

from clepsydra.identification.output_error import held_response
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


@pytest.mark.parametrize(("structure", "lags", "system"), CASES[:4])
def test_slopes_by_an_imaginary_step_are_those_of_finite_differences(structure, lags, system):
    """By the logarithm of each lag, and by the time since the end of the dead time."""
    lags, h = np.array(lags), 1e-5
    for place in range(len(lags) + 1):
        factors = [np.exp(step * (np.arange(len(lags)) == place)) for step in (1e-20j, h, -h)]
        late = [step * (place == len(lags)) for step in (1e-20j, h, -h)]
        found, above, below = (
            structure.responses(TIME + each, TIME, lags * factor)
            for each, factor in zip(late, factors, strict=True)
        )
        for part in ("step", "free"):
            by_step = (getattr(above, part) - getattr(below, part)) / (2 * h)
            assert getattr(found, part).imag / 1e-20 == pytest.approx(by_step, abs=1e-8), place


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
    found = held_response(u, response)
    held = np.concatenate([np.zeros(34), np.repeat(u - u[0], fine)])[: fine * len(u)]
    grid = period / fine * np.arange(len(held))
    expected = lsim(system, held, grid, interp=False)[1][::fine]
    assert found == pytest.approx(expected, abs=1e-9)
