#!/usr/bin/env bash
# CasADi simplifies by the rules of real numbers while an expression is written, so a formula that
# lives by rounding is gone before anything evaluates it: Kahan's compensation is the constant 0,
# and a root outside of its domain comes back as a number.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check casadi==3.8.2 numpy==2.4.6
"$folder/venv/bin/python" - <<'PYTHON'
import math
import sys

import casadi

print("CasADi", casadi.__version__)
changed = False


def compare(words: str, formula, expected: float, seen: float, *at: float) -> None:
    global changed
    for kind in (casadi.SX, casadi.MX):
        symbols = [kind.sym(f"x{number}") for number in range(len(at))]
        function = casadi.Function("f", symbols, [formula(*symbols)], {"cse": False})
        value = float(function(*at))
        print(f"{words}, {kind.__name__} at {at}: expected {expected}, seen {value}")
        changed |= value != seen


compare("what Kahan's sum lost, ((s + v) - s) - v", lambda s, v: ((s + v) - s) - v,
        ((1e16 + 1.0) - 1e16) - 1.0, 0.0, 1e16, 1.0)
compare("(x + y) - y", lambda x, y: (x + y) - y, (1.0 + 1e16) - 1e16, 1.0, 1.0, 1e16)
compare("sqrt(x)**2", lambda x: casadi.sqrt(x) ** 2, math.nan, -1.0, -1.0)
compare("sqrt(x**2)", lambda x: casadi.sqrt(x**2), math.inf, 1e200, 1e200)
sys.exit(1 if changed else 0)
PYTHON
