#!/usr/bin/env bash
# DAQP takes a row that is shorter than the root of its `zero_tol`, 3.2e-6, for a row of zeros and leaves
# it out: the limit x ≤ 0.5, written in a unit in which it reads 3e-6·x ≤ 1.5e-6, is crossed by as much
# again, and the answer is called optimal. Flows in m³/s are such numbers. A smaller `primal_tol` changes
# nothing, a smaller `zero_tol` does. The plugin of CasADi, an older DAQP, does the same, and calls
# 0·x ≤ −1 solved as well, where DAQP by itself says that there is no solution.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check casadi==3.8.2 daqp==0.11.0 numpy==2.4.6
cat >"$folder/compare.py" <<'PYTHON'
import sys
from importlib.metadata import version

import casadi as ca
import daqp
import numpy as np

HESSIAN, LINEAR = np.eye(2), np.array([1.0, -1.0])
plugin = ca.conic(
    "plugin", "daqp", {"h": ca.Sparsity.dense(2, 2), "a": ca.Sparsity.dense(1, 2)},
    {"error_on_fail": False},
)


def by_plugin(row, bound):
    found = plugin(h=HESSIAN, g=LINEAR, a=row, uba=bound, lba=-np.inf)
    return float(found["x"][1]), plugin.stats()["success"]


def alone(row, bound, **tolerances):
    x, _, status, _ = daqp.solve(HESSIAN, LINEAR, row, np.array([bound]), **tolerances)
    return float(x[1]), status == 1


row = np.array([[0.0, 1.0]])
seen = {
    "DAQP, 4e-6·x ≤ 2e-6": alone(4e-6 * row, 2e-6),
    "DAQP, 3e-6·x ≤ 1.5e-6": alone(3e-6 * row, 1.5e-6),
    "the same with primal_tol=1e-14": alone(3e-6 * row, 1.5e-6, primal_tol=1e-14),
    "the same with zero_tol=1e-20": alone(3e-6 * row, 1.5e-6, zero_tol=1e-20),
    "CasADi, 3e-6·x ≤ 1.5e-6": by_plugin(3e-6 * row, 1.5e-6),
    "DAQP, 0·x ≤ -1": alone(0 * row, -1.0),
    "CasADi, 0·x ≤ -1": by_plugin(0 * row, -1.0),
}
print("DAQP", version("daqp"), "CasADi", ca.__version__, "NumPy", np.__version__)
print("expected: x = 0.5 with x ≤ 0.5 in any unit, and no success with 0·x ≤ -1; seen (x, success):")
for case, answer in seen.items():
    print(f"  {case}: {answer}")
crossed = [case for case, (x, success) in seen.items() if success and x > 0.5 + 1e-6]
sys.exit(0 if len(crossed) == 4 and not seen["DAQP, 0·x ≤ -1"][1] else 1)
PYTHON
"$folder/venv/bin/python" "$folder/compare.py" >&2
