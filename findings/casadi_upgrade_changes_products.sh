#!/usr/bin/env bash
# A minor release of CasADi changes the numbers of an unchanged model: 3.8.2 multiplies constants
# together while a*(b*x) is written, 3.7.0 leaves the order that was written. A digest, a cached
# result or a bit-for-bit comparison made with one does not hold with the other.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/products.py" <<'PYTHON'
import random

import casadi

x = casadi.SX.sym("x")
random.seed(1)
apart = 0
for _ in range(1000):
    a, b, at = (random.uniform(0.1, 10.0) for _ in range(3))
    function = casadi.Function("f", [x], [a * (b * x)])
    apart += float(function(at)) != a * (b * at)
print(casadi.CasadiMeta.version(), apart, 0.5 * (3 * x), x / 0.5, x + x)
PYTHON
for version in 3.7.0 3.8.2; do
  python3 -m venv "$folder/$version"
  "$folder/$version/bin/pip" install --quiet --disable-pip-version-check casadi==$version numpy==2.4.6
  "$folder/$version/bin/python" "$folder/products.py" >"$folder/$version.txt"
done
echo "version, products of 1000 that differ from a*(b*x) as written, 0.5*(3*x), x/0.5, x+x"
cat "$folder/3.7.0.txt" "$folder/3.8.2.txt"
echo "expected: the same numbers with both, 0 and 0"
echo "seen:     $(cut -d' ' -f2 "$folder/3.7.0.txt") and $(cut -d' ' -f2 "$folder/3.8.2.txt")"
grep -q '^3.7.0 0 ' "$folder/3.7.0.txt" && grep -q '^3.8.2 344 ' "$folder/3.8.2.txt"
