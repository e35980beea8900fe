"""Where the search over the whole cube begins."""

import numpy as np
from scipy.stats import qmc

from clepsydra.studies.tuning.global_search import latin_hypercube


def test_the_first_population_is_the_one_of_scipy():
    for points, width in ((16, 1), (24, 3), (240, 30)):
        own, other = (np.random.Generator(np.random.PCG64(7)) for _ in range(2))
        expected = qmc.LatinHypercube(width, rng=other).random(points)
        assert np.array_equal(latin_hypercube(own, points, width), expected)
        assert own.random() == other.random()
