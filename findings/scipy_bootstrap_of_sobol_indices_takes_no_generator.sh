#!/usr/bin/env bash
# `scipy.stats.sobol_indices` takes a generator, and what it returns has a method `bootstrap` for the
# intervals. The generator reaches the indices alone. Two calls with equal generators give the same
# indices and different intervals: `bootstrap` draws from NumPy's global state and has no argument for
# another, so `numpy.random.seed` is all that repeats it. A second `bootstrap` of the same result adds
# its resamples to those of the first, though by its documentation `n_resamples` form the distribution:
# the interval depends on what was asked for before, even with the global state seeded anew.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check scipy==1.17.1 numpy==2.4.6
"$folder/venv/bin/python" - <<'PYTHON'
import sys

import numpy as np
import scipy
from scipy.stats import sobol_indices, uniform

RESAMPLES = 999


def indices():
    return sobol_indices(
        func=lambda x: x[0] + x[1] ** 2, n=64, dists=[uniform(), uniform()],
        rng=np.random.default_rng(1),
    )


def lower_limits(result):
    """Return the lower limits of the first-order indices, and the number of resamples behind them."""
    found = result.bootstrap(n_resamples=RESAMPLES).first_order
    return found.confidence_interval.low, found.bootstrap_distribution.shape[-1]


def lower_limits_from_seed(result):
    np.random.seed(3)
    return lower_limits(result)


one, other = indices(), indices()
same_indices = np.array_equal(one.first_order, other.first_order)
(low, _), (other_low, _) = lower_limits(one), lower_limits(other)
same_limits = np.array_equal(low, other_low)

one, other = indices(), indices()
(once, _), (other_once, _) = lower_limits_from_seed(one), lower_limits_from_seed(other)
same_seeded = np.array_equal(once, other_once)
again, resamples = lower_limits_from_seed(one)
same_again = np.array_equal(once, again)

print("SciPy", scipy.__version__, "NumPy", np.__version__)
print(f"equal generators: expected equal indices, seen {same_indices}")
print(f"equal generators: expected equal lower limits, seen {same_limits}: {low} and {other_low}")
print(f"the global state seeded as well: equal lower limits, seen {same_seeded}: {once}")
print(f"the same again of one result: expected equal limits, seen {same_again}: {once} and {again}")
print(f"and behind them: expected {RESAMPLES} resamples, seen {resamples}")
seen = same_indices, same_limits, same_seeded, same_again, resamples
sys.exit(0 if seen == (True, False, True, False, 2 * RESAMPLES) else 1)
PYTHON
