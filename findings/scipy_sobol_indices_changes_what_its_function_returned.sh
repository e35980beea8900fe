#!/usr/bin/env bash
# `scipy.stats.sobol_indices` subtracts the mean of the outputs in place from the arrays that its
# function returned. A function that keeps what it returned, as one does where a value is expensive,
# is left with outputs whose mean is zero. Of outputs handed over as a dictionary it makes copies.
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

kept, copies = [], []


def function(x):
    y = 1.0 + x[0] + x[1] ** 2
    kept.append(y)
    copies.append(y.copy())
    return y


sobol_indices(func=function, n=64, dists=[uniform(), uniform()], rng=np.random.default_rng(1))
returned, left = (float(np.mean(np.concatenate(arrays[:2]))) for arrays in (copies, kept))
shared = [not np.array_equal(now, then) for now, then in zip(kept, copies)]

given = {"f_A": copies[0][None], "f_B": copies[1][None], "f_AB": copies[2].reshape(64, 2).T[:, None]}
before = {key: array.copy() for key, array in given.items()}
sobol_indices(func=given, n=64)
intact = all(np.array_equal(array, before[key]) for key, array in given.items())

print("SciPy", scipy.__version__, "NumPy", np.__version__)
print(f"mean of the kept outputs of A and B: expected {returned:.6f}, seen {left:.6f}")
print(f"calls whose kept outputs were changed: expected 0 of {len(shared)}, seen {sum(shared)}")
print(f"outputs given as a dictionary are as they were: expected True, seen {intact}")
sys.exit(0 if len(shared) == sum(shared) == 3 and abs(left) < 1e-9 and intact else 1)
PYTHON
