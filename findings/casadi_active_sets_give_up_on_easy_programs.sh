#!/usr/bin/env bash
# The quadratic programming method that CasADi brings itself, `qrqp`, gives up on about a tenth of
# small, strictly feasible programs whose cost is as well conditioned as can be, H = I: the nearest
# point of a polytope of 20 faces in 5 dimensions. It says so; no tolerance or number of iterations
# changes it. qpOASES, which comes in the same package, solves every one.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check casadi==3.8.2 numpy==2.4.6
cat >"$folder/compare.py" <<'PYTHON'
import sys

import casadi as ca
import numpy as np

UNKNOWNS, ROWS, PROGRAMS = 5, 20, 200
structure = {"h": ca.Sparsity.dense(UNKNOWNS, UNKNOWNS), "a": ca.Sparsity.dense(ROWS, UNKNOWNS)}
silent = {"print_iter": False, "print_header": False, "print_info": False, "max_iter": 10000}
solvers = {
    "qrqp": ca.conic("qrqp_solver", "qrqp", structure, {**silent, "error_on_fail": False}),
    "qpoases": ca.conic("qpoases_solver", "qpoases", structure, {"printLevel": "none", "error_on_fail": False}),
}
solved = dict.fromkeys(solvers, 0)
for seed in range(PROGRAMS):
    random = np.random.default_rng(seed)
    wanted = random.normal(size=UNKNOWNS)
    faces = random.normal(size=(ROWS, UNKNOWNS))
    inside = random.normal(size=UNKNOWNS)
    beyond = faces @ inside + random.uniform(0.01, 1.0, size=ROWS)
    for name, solver in solvers.items():
        found = solver(h=np.eye(UNKNOWNS), g=-wanted, a=faces, uba=beyond, lba=-np.inf)
        point = np.array(found["x"]).ravel()
        slope, pulls = point - wanted, np.array(found["lam_a"]).ravel()
        optimal = (
            solver.stats()["success"]
            and np.abs(slope + faces.T @ pulls).max() < 1e-6
            and (faces @ point - beyond).max() < 1e-6
        )
        solved[name] += bool(optimal)
print("CasADi", ca.__version__, "NumPy", np.__version__, file=sys.stderr)
print(f"nearest points of polytopes found, of {PROGRAMS}: expected all, seen {solved}", file=sys.stderr)
sys.exit(0 if solved["qrqp"] < 0.95 * PROGRAMS and solved["qpoases"] == PROGRAMS else 1)
PYTHON
# Each call of qpOASES prints whose it is.
"$folder/venv/bin/python" "$folder/compare.py" >"$folder/banners"
