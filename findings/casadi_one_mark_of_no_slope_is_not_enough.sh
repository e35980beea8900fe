#!/usr/bin/env bash
# CasADi can be told that a function has no slope: by its inputs, `is_diff_in`, or by its outputs,
# `is_diff_out`. Either should do. Of a function that stays a call in an expression (`never_inline`),
# marked by its outputs, the Jacobian and the forward derivative are right, and the reverse derivative
# of a sum with it is not-a-number where the function's own slope is not finite, though nothing of it
# is asked for. Marked by its inputs the reverse derivative is right, and the Jacobian keeps a call of
# its forward derivative. Marked by both, all are right.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check casadi==3.8.2 numpy==2.4.6
cat >"$folder/slopes.py" <<'PYTHON'
import math
import sys

import casadi as ca

BY_INPUTS, BY_OUTPUTS = {"is_diff_in": [False, False]}, {"is_diff_out": [False]}
seen = {}
for name, marks in (
    ("inputs", BY_INPUTS), ("outputs", BY_OUTPUTS), ("both", BY_INPUTS | BY_OUTPUTS),
):
    on, x = ca.SX.sym("on"), ca.SX.sym("x", 2)
    kept = {"never_inline": True}
    # Its own slope is not finite at zero, where it is off.
    root = ca.Function("root", [x], [ca.sqrt(x) / x[0]], kept)
    where = ca.Function("where", [on, x], [ca.if_else(on, root(x), 0)], {**kept, **marks})
    y = ca.SX.sym("y", 2)
    total = where(y[0] > 1, y)[0] + y[0]
    reverse = ca.Function("reverse", [y], [ca.jtimes(total, y, 1, True)])(ca.DM([0, 0]))
    seen[name] = ca.jacobian(total, y).__str__().count("fwd"), float(reverse[0])
print("CasADi", ca.__version__)
for name, (calls, slope) in seen.items():
    print(f"marked by {name}: expected no call of a derivative and a slope of 1, seen {calls} and {slope}")
same = seen["inputs"] == (1, 1.0) and seen["both"] == (0, 1.0)
sys.exit(0 if same and seen["outputs"][0] == 0 and math.isnan(seen["outputs"][1]) else 1)
PYTHON
"$folder/venv/bin/python" "$folder/slopes.py"
