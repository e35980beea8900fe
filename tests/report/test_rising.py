"""The nearest rising numbers, against SciPy's isotonic regression."""

import numpy as np
import pytest
from scipy.optimize import isotonic_regression

from clepsydra.report.drawing.rising import nearest_rising


@pytest.mark.parametrize("count", [0, 1, 2, 3, 10, 300])
@pytest.mark.parametrize("seed", range(3))
def test_the_numbers_are_those_of_scipy(count, seed):
    random = np.random.default_rng([count, seed])
    wanted = np.round(random.normal(size=count), 1) + 0.01 * np.arange(count)
    found = nearest_rising(wanted.tolist())
    assert len(found) == count and found == sorted(found)
    if count:
        assert found == pytest.approx(isotonic_regression(wanted).x.tolist(), rel=1e-12, abs=1e-12)
